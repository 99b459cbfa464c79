# SPDX-License-Identifier: MIT
"""Edges between disks of which one nearly lies in the other: thin hyperbolas, polylines, their number of points."""

from __future__ import annotations

import numpy as np
import pytest

import saddleback as sb
from tests.native.cancelling import check_progress_and_cancel
from tests.native.weighted_sites import KINDS
from tests.truth import disks

SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]


@pytest.mark.parametrize("nearness", [2.0**-k for k in (1, 5, 10, 20, 30)])
@pytest.mark.parametrize("tolerance", [1e-5, 1e-2, 0.3, 2.0, 300.0])
def test_the_whole_curve_is_near_the_polyline(nearness, tolerance):
    """Whatever ends it at both sides of its turn."""
    count = 0
    for seed in range(20):
        others = 5 * np.random.default_rng(seed).normal(size=(2, 2))
        sites, weights = np.vstack([[(0, 0), (1, 0)], others]), np.array([0, -1 + nearness, 0, 0])
        diagram = sb.voronoi_2d(sites, weights)
        for edge in np.flatnonzero((np.sort(diagram.edge_sites) == (0, 1)).all(axis=1)):
            line = diagram.edge_polyline(edge, tolerance)
            curve = disks.curve_between(sites[1], sites[0], 1 - nearness, line[[0, -1]])
            count += len(curve)
            assert disks.distances_to_polyline(curve, line).max(initial=0) <= tolerance + 1e-8
            assert len(line) < 3000
    assert count > 1000


def test_a_coarse_polyline_still_turns():
    diagram = sb.voronoi_2d([[0, 0], [1, 0], [0.1, 0.8], [1.4, -3.7]], [0, -1 + 1e-6, 0, 0])
    line = diagram.edge_polyline(3, 0.3)
    assert len(line) == 3
    assert abs(line[1] - (1, 0)).max() < 0.3


@pytest.mark.parametrize("nearness", [2.0**-10, 2.0**-30, 2.0**-50])
def test_points_of_a_thin_curve_are_on_it(nearness):
    """As far from the light disk as from the heavy one, to a few roundings."""
    sites, weights = np.array([(0.0, 0.0), (1.0, 0.0)]), np.array([0.0, -1 + nearness])
    for point in sb.voronoi_2d(sites, weights).edge_polyline(0, 1e-3, 5.0):
        first, second = disks.scaled_distances(point, sites, weights)
        assert abs(float(first - second)) < 1e-15 * 5


@pytest.mark.parametrize("tolerance", [1e-12, 1e-300])
def test_no_tolerance_takes_more_points_than_a_curve_can_show(tolerance):
    sites, weights = KINDS["random_disks"](100, np.random.default_rng(1))
    diagram = sb.voronoi_2d(sites, weights)
    clipped = diagram.clip(SQUARE, tolerance=tolerance)
    assert len(clipped.points) < 2_000_000
    assert abs(clipped.areas.sum() - 1) < 1e-12
    assert max(len(diagram.edge_polyline(edge, tolerance)) for edge in range(5)) < 500_000
    sweep = sb.SweepCircle(sites, (0.5, 0.5), weights)
    sweep.grow(2)
    assert sum(map(len, sweep.edge_polylines(tolerance))) < 500_000


def test_clipping_finely_stops_within_a_moment():
    rng = np.random.default_rng(2)
    sites = np.vstack([[(0.5, 0.5)], 0.5 + 0.4 * rng.normal(size=(20_000, 2))])
    diagram = sb.voronoi_2d(sites, np.where(np.arange(len(sites)) == 0, 0.2, 0.0))
    check_progress_and_cancel(lambda job: diagram.clip(SQUARE, tolerance=1e-12, job=job), 0.2)

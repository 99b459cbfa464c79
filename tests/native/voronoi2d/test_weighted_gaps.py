# SPDX-License-Identifier: MIT
"""Cells of weighted sites a gap apart: true offsets of hyperbolas, in domains of every sort."""

from __future__ import annotations

import time
from itertools import pairwise

import numpy as np
import pytest

import saddleback as sb
from tests.native.cancelling import check_progress_and_cancel
from tests.native.weighted_sites import KINDS, weighted_distances

SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1]]
HOLED = [SQUARE, [[0.3, 0.3], [0.6, 0.3], [0.5, 0.7]]]


def loops_of(cells, site):
    return [
        cells.points[cells.loop_offsets[k] : cells.loop_offsets[k + 1]]
        for k in np.flatnonzero(cells.loop_sites == site)
    ]


def distances_to_sides(points, loops):
    """(m,) of the nearest side."""
    best = np.full(len(points), np.inf)
    for loop in loops:
        for a, b in zip(loop, np.roll(loop, -1, axis=0), strict=True):
            share = np.clip((points - a) @ (b - a) / max((b - a) @ (b - a), 1e-300), 0, 1)
            best = np.minimum(best, np.linalg.norm(points - a - share[:, None] * (b - a), axis=1))
    return best


@pytest.mark.parametrize("domain", [SQUARE, HOLED])
def test_loops_are_a_gap_apart(domain):
    rng = np.random.default_rng(1)
    sites, weights = rng.random((25, 2)), 0.12 * rng.random(25)
    gap, tolerance = 0.03, 1e-5
    diagram = sb.voronoi_2d(sites, weights)
    whole, apart = (diagram.clip(domain, gap=g, tolerance=tolerance) for g in (0.0, gap))
    assert diagram.clip(domain, gap=0.0, tolerance=tolerance).points.tobytes() == whole.points.tobytes()
    assert (apart.areas <= whole.areas).all() and apart.areas.sum() < 0.95 * whole.areas.sum()
    assert not np.isin(apart.loop_sites, diagram.hidden).any()
    owners = np.repeat(apart.loop_sites, np.diff(apart.loop_offsets))
    distances = weighted_distances(apart.points, sites, weights)
    assert (distances.argmin(axis=1) == owners).all()
    for site in np.unique(owners):
        others = [loop for other in np.unique(owners) if other != site for loop in loops_of(apart, other)]
        assert distances_to_sides(apart.points[owners == site], others).min() >= gap - 2 * tolerance


@pytest.mark.parametrize("heavier", [0, 1])
@pytest.mark.parametrize("half", [0.01, 0.3, 1.0, 3.0])
def test_both_sides_of_one_hyperbola(heavier, half):
    """Foci at 1 and -1, |x - a| - |x - b| = 1: points beside the branch x = -cosh t / 2, y = sqrt(3) / 2 sinh t."""
    sites, weights = np.array([[1.0, 0], [-1.0, 0]]), np.zeros(2)
    weights[heavier] = 1
    domain = 4 * np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])
    cells = sb.voronoi_2d(sites, weights).clip(domain, gap=2 * half, tolerance=1e-6)
    t = np.linspace(-4, 4, 80_001)
    sign = -1 if heavier == 0 else 1
    curve = np.column_stack([sign * 0.5 * np.cosh(t), np.sqrt(0.75) * np.sinh(t)])
    inner = cells.points[(np.abs(cells.points) < 4 - 1e-9).all(axis=1)]
    assert len(inner) > 3
    for point in inner[:: len(inner) // 60]:
        assert np.hypot(*(curve - point).T).min() == pytest.approx(half, abs=3e-6 if half > 0.1 else 3e-5)
    # The lighter site's cell has a corner on the axis where the gap is more than the least radius of curvature.
    middle = [(x - half * sign) if site == heavier else None for site, x in ((0, sign * 0.5), (1, sign * 0.5))]
    assert np.abs(inner - [middle[heavier], 0]).sum(axis=1).min() < 2e-6


def test_cells_fall_apart_and_vanish():
    """A light site between two heavy ones, with a waist, and one in a corner of theirs."""
    sites = np.array([[0.5, 0.12], [0.5, 0.5], [0.5, 0.88], [0.08, 0.5]])
    weights = np.array([0.3, 0.0, 0.3, 0.0])
    diagram = sb.voronoi_2d(sites, weights)
    whole, apart = (diagram.clip(SQUARE, gap=gap, tolerance=1e-6) for gap in (0.0, 0.2))
    assert np.count_nonzero(whole.loop_sites == 1) == 1 and whole.areas[1] > 0
    assert np.count_nonzero(apart.loop_sites == 1) != 1
    for gap in (9.0, 1e9, 1e300):  # no more points far out than near by
        gone = diagram.clip(SQUARE, gap=gap)
        assert gone.areas.sum() == 0 and len(gone.loop_sites) == 0 and np.isnan(gone.centroids).all()


def test_one_cell_stays_whole():
    """It has no neighbor to keep off from: alone, beside a hidden site, beside an equal one."""
    for sites, weights in (
        ([[0.2, 0.3]], [1.0]),
        ([[0.2, 0.3], [0.3, 0.3]], [1.0, 0.5]),
        ([[0.2, 0.3], [0.2, 0.3]], [1.0, 0.5]),
    ):
        cells = sb.voronoi_2d(sites, weights).clip(HOLED, gap=0.4)
        assert cells.loop_sites.tolist() == [0, 0] and cells.areas[0] == pytest.approx(1 - 0.06)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("n", [2, 7, 40])
def test_every_kind_of_disks(kind, n):
    sites, weights = KINDS[kind](n, np.random.default_rng(n))
    low, high = sites.min(axis=0), sites.max(axis=0)
    side = (high - low).max() or 1.0
    domain = low + side * (1.2 * np.array(SQUARE) - 0.1)
    diagram = sb.voronoi_2d(sites, weights)
    if kind in ("huge", "tiny"):
        with pytest.raises(sb.InputError, match=r"wanted numbers up to|less than any number"):
            diagram.clip(domain, gap=0.1 * side)
        return
    areas = [diagram.clip(domain, gap=share * side).areas for share in (0, 1e-9, 1e-2, 0.1, 0.5, 2.0)]
    mean = side * side * 1.44
    assert np.abs(areas[0] - areas[1]).max() <= 1e-3 * mean
    for more, less in pairwise(areas):
        assert (less <= more + 1e-3 * mean).all()


@pytest.mark.parametrize("unit", [2.0**-300, 2.0**-40, 2.0**150])
def test_only_ratios_of_lengths_count(unit):
    rng = np.random.default_rng(4)
    sites, weights = rng.random((30, 2)), 0.1 * rng.random(30)
    plain = sb.voronoi_2d(sites, weights).clip(SQUARE, gap=0.03)
    other = sb.voronoi_2d(unit * sites, unit * weights).clip(unit * np.array(SQUARE), gap=0.03 * unit)
    assert (other.points == unit * plain.points).all() and len(plain.points) > 100


def test_any_number_of_threads_gives_the_same():
    rng = np.random.default_rng(5)
    diagram = sb.voronoi_2d(rng.random((900, 2)), 0.03 * rng.random(900))
    one, three = (diagram.clip(HOLED, gap=0.004, threads=threads) for threads in (1, 3))
    assert one.points.tobytes() == three.points.tobytes()


@pytest.mark.parametrize("gap", [-1.0, np.inf, np.nan])
def test_gaps_that_are_none(gap):
    with pytest.raises(sb.InputError, match="gap"):
        sb.voronoi_2d([[0.2, 0.3], [0.6, 0.6]], [0.1, 0.0]).clip(SQUARE, gap=gap)


def test_holes_far_from_a_cell_take_no_time():
    turn = 2 * np.pi * np.arange(16) / 16
    ring = 0.3 * np.column_stack([np.cos(turn), np.sin(turn)])
    domain = [30 * np.array(SQUARE), *(ring + [i + 0.5, j + 0.5] for i in range(30) for j in range(30))]
    rng = np.random.default_rng(7)
    diagram = sb.voronoi_2d(30 * rng.random((3000, 2)), 0.2 * rng.random(3000))
    start = time.perf_counter()
    areas = diagram.clip(domain).areas
    assert time.perf_counter() - start < 1.5  # was 5
    assert areas.sum() == pytest.approx(900 * (1 - 8 * 0.09 * np.sin(np.pi / 8)), rel=1e-9)


def test_progress_and_cancel():
    rng = np.random.default_rng(6)
    diagram = sb.voronoi_2d(rng.random((20_000, 2)), 0.01 * rng.random(20_000))
    check_progress_and_cancel(lambda job: diagram.clip(SQUARE, gap=0.001, job=job), 0.1)

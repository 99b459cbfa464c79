# SPDX-License-Identifier: MIT
"""Sites that nearly coincide: vertices, areas and everything cut from them stay right to a few roundings."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.native import plane_sites
from tests.truth import plane as truth

Floats = truth.Floats
SQUARE = np.array([(0.0, 0), (1, 0), (1, 1), (0, 1)])


def pairs(apart: float, rng: truth.Random) -> Floats:
    sites = rng.random((6, 2))
    return np.vstack([sites, sites[:3] + apart * rng.normal(size=(3, 2))])


def crowd(apart: float, rng: truth.Random) -> Floats:
    """Many about one place."""
    return np.vstack([rng.random((4, 2)), rng.random(2) + apart * rng.normal(size=(6, 2))])


def closed_ring(apart: float, rng: truth.Random) -> Floats:
    """A ring whose last point is the first but for rounding."""
    angle = np.arange(9) * (2 * np.pi / 8)
    ring = 0.5 + 0.4 * np.column_stack([np.cos(angle), np.sin(angle)])
    ring[-1] = ring[0] + (0, -apart)
    return ring


def row(apart: float, rng: truth.Random) -> Floats:
    """Nearly on one line: vertices far away."""
    x = rng.random(8)
    return np.column_stack([x, 0.3 * x + apart * rng.random(8)])


KINDS: list[Callable[[float, truth.Random], Floats]] = [pairs, crowd, closed_ring, row]
APART = [1e-6, 1e-9, 1e-12, 1e-14, 1e-16]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("apart", APART)
def test_they_are_where_fractions_say(kind, apart):
    rng = np.random.default_rng(1)
    for _ in range(2):
        sites = kind(apart, rng)
        truth.vertices_of_points(sites, rng)
        truth.areas_of_points(sites, rng)
        truth.clipped_cells(sites, rng)
        truth.lifted_cells(sites, rng)


@pytest.mark.parametrize("unit", [1e-30, 1e30])
@pytest.mark.parametrize("kind", KINDS)
def test_in_any_unit(kind, unit):
    rng = np.random.default_rng(2)
    sites = unit * kind(1e-13, rng)
    truth.vertices_of_points(sites, rng)
    truth.clipped_cells(sites, rng)


@pytest.mark.parametrize("apart", APART)
def test_far_from_the_origin(apart):
    rng = np.random.default_rng(3)
    sites = 1e6 + pairs(apart, rng)
    truth.vertices_of_points(sites, rng)
    truth.clipped_cells(sites, rng)


def test_two_of_three_sites_that_nearly_coincide():
    diagram = sb.voronoi_2d([[0.73, 0.42], [0.73000000000002, 0.42000000000001997], [0.01, 0.53]])
    assert np.allclose(diagram.vertices, [[0.41042169, 0.73957831]], rtol=0, atol=1e-8)
    assert diagram.clip(SQUARE).points.tolist().count(diagram.vertices[0].tolist()) == 3


@pytest.mark.parametrize("apart", [1e-7, 1e-11, 1e-15])
def test_cells_of_large_diagrams_share_their_vertices(apart):
    """Every vertex within the domain is a corner of all cells about it, to the bit."""
    rng = np.random.default_rng(4)
    sites = rng.random((300, 2))
    sites = np.vstack([sites, sites + apart * rng.normal(size=sites.shape)])
    diagram = sb.voronoi_2d(sites)
    clipped = diagram.clip(SQUARE)
    assert abs(clipped.areas.sum() - 1) < 1e-13
    corners = {point.tobytes() for point in clipped.points}
    owners = np.repeat(clipped.loop_sites, np.diff(clipped.loop_offsets))
    of_cells = {(site, point.tobytes()) for site, point in zip(owners.tolist(), clipped.points, strict=True)}
    for about, vertex in zip(truth.sites_about_vertices(diagram), diagram.vertices, strict=True):
        if ((vertex > 1e-9) & (vertex < 1 - 1e-9)).all():
            assert vertex.tobytes() in corners
            assert all((site, vertex.tobytes()) in of_cells for site in about)


@pytest.mark.parametrize("apart", [1e-9, 1e-12, 1e-16])
def test_gaps_between_cells_of_near_twins(apart):
    """Corners keep half the gap from all sides, where these are nearly in line too."""
    rng = np.random.default_rng(5)
    sites, gap = pairs(apart, rng), 0.01
    cells = sb.voronoi_2d(sites).clip(SQUARE, gap=gap)
    for k, site in enumerate(cells.loop_sites):
        points = cells.points[cells.loop_offsets[k] : cells.loop_offsets[k + 1]]
        for other in range(len(sites)):
            across = sites[other] - sites[site]
            if across.any():
                depth = (0.5 * sites[site] + 0.5 * sites[other] - points) @ (across / np.hypot(*across))
                assert depth.min() > 0.5 * gap - 1e-14


def test_a_lifted_diagram_of_near_twins_is_tight():
    """Pieces of the cut mesh meet side to side, whatever lies within rounding of what."""
    rng = np.random.default_rng(6)
    vertices, triangles = meshes.grid(7, 7, jitter=0.1)
    uv = vertices[:, :2] / vertices[:, :2].max()
    for apart in APART:
        sites = np.vstack([pairs(apart, rng), uv[rng.integers(len(uv), size=3)]])
        lifted = sb.Chart(sb.Mesh(vertices, triangles), uv).lift(sb.voronoi_2d(sites))
        split = lifted.split()
        mesh = sb.Mesh(split.vertices, split.triangles)
        assert len(mesh.boundary_loops) == 1
        assert mesh.genus == 0
        assert abs(mesh.area - lifted.areas.sum()) < 1e-12 * mesh.area


def test_a_sweep_tells_the_vertices_of_the_diagram():
    sites = pairs(1e-13, np.random.default_rng(7))
    sweep, found = sb.SweepCircle(sites, [0.5, 0.5]), []
    while event := sweep.step():
        if event.kind == "vanish":
            found.append(event.point)
    right = truth.rounded(list(truth.voronoi_vertices(sites).values()))
    near = np.abs(np.array(found)[:, None] - right).max(axis=2) / np.maximum(1, np.abs(right).max(axis=1))
    assert near.min(axis=0).max() < 1e-14
    assert near.min(axis=1).max() < 1e-14


def test_slivers_have_no_negative_area_and_a_center_within():
    for seed in range(100):
        rng = np.random.default_rng(seed)
        line = rng.random(2) + np.outer(rng.random(6) * 1e-14, rng.normal(size=2))
        diagram = sb.voronoi_2d(np.vstack([line, plane_sites.circle(8, rng)]))
        clipped = diagram.clip(2 * SQUARE - 0.5)
        assert (clipped.areas >= 0).all()
        assert np.isfinite(clipped.centroids[clipped.areas > 0]).all()
        assert (np.abs(clipped.centroids[clipped.areas > 0] - 0.5) <= 1).all()
        assert (diagram.areas >= 0).all()
        for site in np.flatnonzero(np.isfinite(diagram.areas)):
            corners = diagram.vertices[diagram.cell_vertices(site)]
            assert (diagram.centroids[site] >= corners.min(axis=0) - 1e-15).all()
            assert (diagram.centroids[site] <= corners.max(axis=0) + 1e-15).all()

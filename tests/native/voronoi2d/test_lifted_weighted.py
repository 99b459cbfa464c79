# SPDX-License-Identifier: MIT
"""Diagrams of weighted sites on surfaces: each point against all sites, sides along the curves, nothing lost."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_progress_and_cancel
from tests.native.voronoi2d.test_charts import ALL, DISKS, chart_of, hard_sites, mesh_of, sites_in
from tests.native.weighted_sites import KINDS, weighted_distances


def weighted(name: str, count: int) -> tuple[sb.Chart, np.ndarray, np.ndarray, float]:
    """A map, sites in it, their weights, and a mean cell's width."""
    chart, sites = chart_of(name), sites_in(name, count)
    width = np.sqrt(chart.area / count)
    return chart, sites, 0.6 * width * np.random.default_rng(3).random(count), width


def behind(places: np.ndarray, cells: np.ndarray, sites: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """How much nearer another site is than that of the cell."""
    blocks = np.array_split(np.arange(len(places)), 20)
    found = [
        (d := weighted_distances(places[b], sites, weights))[np.arange(len(b)), cells[b]] - d.min(1) for b in blocks
    ]
    return np.concatenate(found)


@pytest.mark.parametrize("name", ALL)
def test_each_point_of_the_surface_has_its_nearest_site(name):
    chart, sites, weights, width = weighted(name, 150)
    for tolerance in (1e-6 * width, 0.02 * width):
        lifted = chart.lift(sb.voronoi_2d(sites, weights), tolerance=tolerance)
        points = sb.sample(mesh_of(name), 30_000, seed=8)
        cells = lifted.locate(points)
        lag = behind(chart.places(points), cells, sites, weights)
        assert lag.max() <= 2.001 * tolerance and np.count_nonzero(lag) < 0.02 * len(lag)
        assert lifted.areas.sum() == pytest.approx(mesh_of(name).area, rel=1e-12)
        shares = np.bincount(cells, minlength=len(sites)) / len(points)
        np.testing.assert_allclose(lifted.areas / lifted.areas.sum(), shares, atol=4e-3)


@pytest.mark.parametrize("name", ALL)
def test_edges_follow_the_curves_on_the_surface(name):
    chart, sites, weights, width = weighted(name, 60)
    mesh, diagram, tolerance = mesh_of(name), sb.voronoi_2d(sites, weights), 1e-4 * width
    lifted = chart.lift(diagram, tolerance=tolerance)
    offsets, surface = lifted.edge_offsets, lifted.edge_surface
    assert (lifted.edge_cells == diagram.edge_sites[lifted.edge_of]).all() and (np.diff(lifted.edge_of) >= 0).all()
    for begin, end in itertools.pairwise(offsets):
        sb.SurfaceCurve(mesh, surface[begin:end])  # refuses what leaves the faces that points share
    corners = chart.corners.reshape(-1, 3, 2)[surface.faces]
    places = (np.asarray(surface.barycentric)[:, :, None] * corners).sum(axis=1)
    cells = np.repeat(lifted.edge_cells, np.diff(offsets), axis=0)
    to_sites = [np.linalg.norm(places - sites[cells[:, k]], axis=1) - weights[cells[:, k]] for k in (0, 1)]
    np.testing.assert_allclose(to_sites[0], to_sites[1], atol=2.001 * tolerance)


def sides_between_cells(split: sb.SplitMesh) -> float:
    """Length of the sides of triangles where the cell beyond is another."""
    ends = np.concatenate([split.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    ends.sort(axis=1)
    order = np.lexsort(ends.T)
    ends, cells = ends[order], np.tile(split.triangle_cell, 3)[order]
    between = np.flatnonzero((ends[1:] == ends[:-1]).all(axis=1) & (cells[1:] != cells[:-1]))
    return float(np.linalg.norm(split.vertices[ends[between, 0]] - split.vertices[ends[between, 1]], axis=1).sum())


def edge_length(lifted: sb.LiftedVoronoi) -> float:
    steps = np.linalg.norm(np.diff(lifted.edge_points, axis=0), axis=1)
    steps[lifted.edge_offsets[1:-1] - 1] = 0
    return float(steps.sum())


@pytest.mark.parametrize("name", list(DISKS))
def test_the_cut_mesh_is_the_surface(name):
    chart, sites, weights, _width = weighted(name, 80)
    lifted = chart.lift(sb.voronoi_2d(sites, weights))
    split = lifted.split()
    a, b, c = (split.vertices[split.triangles[:, k]] for k in range(3))
    areas = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    np.testing.assert_allclose(np.bincount(split.triangle_cell, areas, minlength=80), lifted.areas, atol=1e-12)
    used, triangles = np.unique(split.triangles, return_inverse=True)
    whole = sb.Mesh(split.vertices[used], triangles.reshape(-1, 3))
    assert (whole.genus, len(whole.boundary_loops), whole.components.max()) == (0, 1, 0)
    assert sides_between_cells(split) == pytest.approx(edge_length(lifted), rel=1e-9)


SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]


def test_a_flat_map_of_a_flat_mesh_gives_the_diagram_itself():
    vertices, triangles = meshes.grid(9, 9, jitter=0.3, seed=5)
    rng = np.random.default_rng(1)
    diagram = sb.voronoi_2d(rng.random((70, 2)), 0.1 * rng.random(70))
    clipped = diagram.clip(SQUARE, tolerance=1e-7)
    lifted = sb.Chart(sb.Mesh(vertices, triangles), vertices[:, :2]).lift(diagram, tolerance=1e-7)
    np.testing.assert_allclose(lifted.areas, clipped.areas, atol=1e-6)
    alive = clipped.areas > 0
    assert not alive[diagram.hidden].any()
    np.testing.assert_allclose(lifted.centroids[alive], clipped.centroids[alive], atol=1e-4)
    assert np.isnan(lifted.centroids[~alive]).all()


@pytest.mark.parametrize(
    "kind", ["vertices", "on edges", "grid", "small_integers", "circle", "regular_polygon", "duplicates", *KINDS]
)
def test_whatever_edges_run_along(kind):
    """Edges along mesh edges and through vertices, corners on mesh edges, cells narrower than any number."""
    for seed, size, jitter in itertools.product(range(3), (2, 3, 5), (0.0, 0.2)):
        rng = np.random.default_rng(seed)
        vertices, triangles = meshes.grid(size, size, jitter=jitter, seed=seed)
        if kind in KINDS:
            sites, weights = KINDS[kind](30, rng)
            extent = np.ptp(sites, axis=0).max()
            sites, weights = (sites - sites.min(axis=0)) / extent, weights / extent
        else:
            sites = hard_sites(kind, vertices[:, :2], triangles, rng)
            weights = rng.integers(0, 3, len(sites)) / 8 / (size - 1)
        mesh = sb.Mesh(vertices, triangles)
        lifted = sb.Chart(mesh, vertices[:, :2]).lift(sb.voronoi_2d(sites, weights), tolerance=1e-4)
        points = sb.sample(mesh, 2000, seed=1)
        places = points.positions(mesh)[:, :2]
        assert behind(places, lifted.locate(points), sites, weights).max() <= 2.001e-4
        assert lifted.areas.sum() == pytest.approx(1, rel=1e-12)
        split = lifted.split()
        ends = np.sort(np.concatenate([split.triangles[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
        edges, counts = np.unique(ends, axis=0, return_counts=True)
        rim = edges[counts == 1]
        assert counts.max() <= 2
        assert len(np.unique(split.triangles)) - len(edges) + len(split.triangles) == 1
        along = np.linalg.norm(split.vertices[rim[:, 0]] - split.vertices[rim[:, 1]], axis=1).sum()
        assert along == pytest.approx(4, rel=1e-9)


def test_one_cell_and_faces_that_no_edge_comes_to():
    chart = chart_of("saddle")
    lifted = chart.lift(sb.voronoi_2d([(0.1, 0.2), (0.15, 0.2)], [1.0, 0.5]))
    assert (lifted.face_cell == 0).all() and len(lifted.edge_of) == 0 and lifted.areas[1] == 0


def test_a_coarse_tolerance_leaves_straight_sides():
    vertices, triangles = meshes.grid(2, 2)
    chart = sb.Chart(sb.Mesh(vertices, triangles), vertices[:, :2])
    diagram = sb.voronoi_2d([(0.25, 0.5), (0.75, 0.5)], [0.0, 0.25])
    coarse, fine = (len(chart.lift(diagram, tolerance=t).edge_points) for t in (1.0, 1e-6))
    assert coarse <= 6 < 100 < fine
    with pytest.raises(sb.InputError, match="tolerance: wanted a length of 0 or more, got -1"):
        chart.lift(diagram, tolerance=-1)


def test_any_number_of_threads_gives_the_same():
    chart, sites, weights, _width = weighted("torus", 200)
    diagram = sb.voronoi_2d(sites, weights)
    one, two = (chart.lift(diagram, threads=threads) for threads in (1, 2))
    for name in ("areas", "centroids", "edge_points", "edge_offsets", "edge_of", "face_cell"):
        assert getattr(one, name).tobytes() == getattr(two, name).tobytes()
    assert one.split().triangles.tobytes() == two.split().triangles.tobytes()


def test_lifting_can_be_cancelled():
    vertices, triangles = meshes.grid(400, 400)
    chart = sb.Chart(sb.Mesh(vertices, triangles), vertices[:, :2])
    rng = np.random.default_rng(0)
    diagram = sb.voronoi_2d(rng.random((50_000, 2)), 0.002 * rng.random(50_000))
    check_progress_and_cancel(lambda job: chart.lift(diagram, job=job), 0.3)

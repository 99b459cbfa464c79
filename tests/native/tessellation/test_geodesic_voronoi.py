# SPDX-License-Identifier: MIT
"""Cells: they partition the surface, their boundaries are equidistant, nothing is lost in degenerate cases."""

from __future__ import annotations

import time

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import saddleback as sb
from tests import meshes
from tests.native.cell_checks import check, triangle_areas
from tests.native.exact import exact_distances, random_points


def graph_of(case: meshes.Case, k: int = 40) -> sb.SaddleVertexGraph:
    return sb.SaddleVertexGraph(case.mesh, k=min(k, len(case.vertices)))


@pytest.mark.parametrize("count", [1, 2, 3, 17])
@pytest.mark.parametrize("case", [c for c in meshes.good() if c.components == 1], ids=str)
def test_cells_partition_the_surface(case: meshes.Case, count: int) -> None:
    graph = graph_of(case)
    if count > len(case.vertices):
        count = len(case.vertices)
    check(case.mesh, sb.geodesic_voronoi(graph, random_points(case.mesh, count, seed=count)))
    vertices = np.random.default_rng(count).choice(len(case.vertices), count, replace=False)
    check(case.mesh, sb.geodesic_voronoi(graph, vertices))


@pytest.mark.parametrize("case", [c for c in meshes.good() if len(c.vertices) <= 200 and c.components == 1], ids=str)
def test_every_vertex_a_site(case: meshes.Case) -> None:
    cells = sb.geodesic_voronoi(graph_of(case), np.arange(len(case.vertices)))
    check(case.mesh, cells)
    assert np.array_equal(cells.vertex_cell, np.arange(len(case.vertices)))


@pytest.mark.parametrize("jitter", [0.0, 0.3])
def test_the_plane_has_euclidean_cells(jitter: float) -> None:
    """Sites anywhere, disks that see everything: bisectors of the plane to the rounding of single-precision arcs."""
    mesh = sb.Mesh(*meshes.grid(15, 15, jitter))
    sites = random_points(mesh, 30, seed=5)
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=225), sites)
    check(mesh, cells)
    centers = sites.positions(mesh)

    def distances(points: np.ndarray) -> np.ndarray:
        return np.linalg.norm(points[:, None] - centers[None], axis=2)

    from_vertices = distances(mesh.vertices)
    assert np.array_equal(cells.vertex_cell, from_vertices.argmin(axis=1))
    np.testing.assert_allclose(cells.vertex_distance, from_vertices.min(axis=1), atol=1e-6)
    for edge in cells.edges:
        table = distances(edge.points)
        np.testing.assert_allclose(table[:, edge.cells[0]], table.min(axis=1), atol=1e-5)
        np.testing.assert_allclose(table[:, edge.cells[1]], table.min(axis=1), atol=1e-5)
    nearest_three = np.sort(distances(cells.branch_points.positions(mesh)), axis=1)[:, :3]
    np.testing.assert_allclose(nearest_three[:, 0], nearest_three[:, 2], atol=1e-5)


def test_the_left_cell_lies_on_the_left() -> None:
    mesh = sb.Mesh(*meshes.grid(15, 15))
    sites = random_points(mesh, 12, seed=2)
    centers = sites.positions(mesh)
    for edge in sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=225), sites).edges:
        along = edge.points[-1] - edge.points[0]
        to_left = centers[edge.cells[0]] - centers[edge.cells[1]]
        assert along[0] * to_left[1] - along[1] * to_left[0] > 0


@pytest.mark.parametrize(
    "case", [c for c in meshes.closed() if 100 < len(c.vertices) <= 1200 and c.components == 1], ids=str
)
def test_labels_against_exact_distances(case: meshes.Case) -> None:
    """Where the two nearest sites differ by more than 1 %, the label is the exact one."""
    sites = np.random.default_rng(4).choice(len(case.vertices), 8, replace=False)
    table = np.array([exact_distances(case.mesh, int(s)) for s in sites])
    cells = sb.geodesic_voronoi(graph_of(case, 80), sites)
    ordered = np.sort(table, axis=0)
    clear = ordered[1] > 1.01 * ordered[0] + 1e-12
    assert np.array_equal(cells.vertex_cell[clear], table.argmin(axis=0)[clear])
    np.testing.assert_allclose(cells.vertex_distance, ordered[0], rtol=0.02, atol=1e-9)


def test_symmetric_sites_tie_at_mesh_vertices() -> None:
    """Two and four mirrored sites on a regular grid: bisectors run through vertices and along edges."""
    mesh = sb.Mesh(*meshes.grid(9, 9))
    graph = sb.SaddleVertexGraph(mesh, k=81)
    two = sb.geodesic_voronoi(graph, [4 * 9, 4 * 9 + 8])
    check(mesh, two)
    np.testing.assert_allclose(two.areas, 0.5, rtol=1e-6)
    four = sb.geodesic_voronoi(graph, [0, 8, 72, 80])
    check(mesh, four)
    np.testing.assert_allclose(four.areas, 0.25, rtol=1e-6)
    assert four.vertex_cell[4 * 9 + 4] == 0  # ties go to the smaller site


def test_two_circles_round_a_tube() -> None:
    vertices, triangles = meshes.torus(60, 16)
    mesh = sb.Mesh(vertices, triangles)
    opposite = [int(np.argmax(vertices[:, 0])), int(np.argmin(vertices[:, 0]))]
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=60), opposite)
    check(mesh, cells)
    assert cells.edge_closed.tolist() == [True, True]
    assert len(cells.branch_points) == 0
    np.testing.assert_allclose(cells.areas, mesh.area / 2, rtol=0.01)


def test_many_sites_in_one_face_and_cells_without_vertices() -> None:
    mesh = sb.Mesh(*meshes.grid(6, 6))
    weights = np.random.default_rng(1).dirichlet([1, 1, 1], 12)
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=36), sb.SurfacePoints(np.full(12, 25), weights))
    check(mesh, cells)
    assert (cells.areas > 0).all()
    assert len(np.unique(cells.vertex_cell)) < 12


@pytest.mark.parametrize("case", [c for c in meshes.good() if len(c.vertices) <= 200 and c.components == 1], ids=str)
def test_more_sites_than_triangles(case: meshes.Case) -> None:
    cells = sb.geodesic_voronoi(graph_of(case), random_points(case.mesh, 3 * len(case.triangles), seed=4))
    check(case.mesh, cells)
    assert (cells.areas > 0).mean() > 0.99


def test_of_two_sites_in_one_place_the_smaller_has_the_cell() -> None:
    mesh = sb.Mesh(*meshes.torus())
    graph = sb.SaddleVertexGraph(mesh, k=30)
    cells = sb.geodesic_voronoi(graph, [7, 200, 7, 200])
    check(mesh, cells)
    assert cells.areas[2] == 0
    assert cells.areas[3] == 0


@pytest.mark.parametrize("case", [c for c in meshes.good() if c.components == 1], ids=str)
def test_points_lie_in_the_cell_that_holds_their_piece(case: meshes.Case) -> None:
    """Where the split mesh says a point is, there it is located; at vertices the distances are the same."""
    count = min(25, len(case.vertices))
    cells = sb.geodesic_voronoi(graph_of(case), random_points(case.mesh, count, seed=9))
    split = cells.split()
    middles = split.vertices[split.triangles].mean(axis=1)
    large = triangle_areas(split.vertices, split.triangles) > 1e-6 * case.mesh.area / len(case.triangles)
    cell, distance = cells.locate(sb.project(case.mesh, middles[large]))
    wrong = cell != split.triangle_cell[large]
    assert wrong.mean() < 0.002  # a middle may project to the other side of a fold
    assert np.isfinite(distance).all()
    cell, distance = cells.locate(np.arange(len(case.vertices)))
    np.testing.assert_allclose(distance, cells.vertex_distance, rtol=1e-7, atol=1e-9)


def test_corners_go_round_the_cell() -> None:
    mesh = sb.Mesh(*meshes.grid(15, 15))
    sites = random_points(mesh, 30, seed=5)
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=225), sites)
    border = {
        cell for edge in cells.edges for cell in edge.cells if np.isclose(edge.points[[0, -1]][:, :2] % 1, 0).any()
    }
    inner = set(range(30)) - border
    assert inner
    for cell in inner:
        x, y, _ = cells.corners(cell).positions(mesh).T
        shoelace = (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2
        assert shoelace == pytest.approx(cells.areas[cell], rel=1e-4)


def test_each_component_needs_a_site() -> None:
    mesh = sb.Mesh(*meshes.two_components())
    graph = sb.SaddleVertexGraph(mesh, k=20)
    with pytest.raises(sb.InputError, match="separate parts has no site"):
        sb.geodesic_voronoi(graph, [0])
    other = int(np.flatnonzero(np.isinf(graph.distances([0])))[0])
    check(mesh, sb.geodesic_voronoi(graph, [0, other]))


@pytest.mark.parametrize("count", [60, 3000])
def test_the_same_for_any_number_of_threads(count: int) -> None:
    """Also where divided faces fill many blocks."""
    mesh = sb.Mesh(*meshes.torus(120, 40))
    graph = sb.SaddleVertexGraph(mesh, k=30)
    sites = random_points(mesh, count)
    found = [sb.geodesic_voronoi(graph, sites, threads=threads) for threads in (1, 2, 5, 8)]
    for other in found[1:]:
        assert found[0] == other
        assert found[0].edge_points.tobytes() == other.edge_points.tobytes()
        assert found[0].areas.tobytes() == other.areas.tobytes()
        assert found[0].split().triangles.tobytes() == other.split().triangles.tobytes()


def test_cells_reach_through_every_threads_part_of_the_mesh() -> None:
    """Large meshes are divided among threads: cells that lie in all parts are put together from all."""
    mesh = sb.Mesh(*meshes.grid(160, 160, jitter=0.3))
    graph = sb.SaddleVertexGraph(mesh, k=12)
    sites = random_points(mesh, 5)
    found = [sb.geodesic_voronoi(graph, sites, threads=threads) for threads in (1, 2, 3, 8)]
    for other in found[1:]:
        assert found[0].vertex_cell.tobytes() == other.vertex_cell.tobytes()
        assert found[0].vertex_distance.tobytes() == other.vertex_distance.tobytes()
        assert found[0].areas.tobytes() == other.areas.tobytes()


GOOD = [c for c in meshes.good() if len(c.vertices) <= 400 and c.components == 1]
GRAPHS = {case.name: graph_of(case) for case in GOOD}
WEIGHT = st.sampled_from([0.0, 1e-12, 1e-3, 0.25, 1 / 3, 0.5, 1.0])


@given(st.data())
def test_any_sites_partition_any_mesh(data: st.DataObject) -> None:
    """Points on vertices, on edges, next to them, in one place: whatever comes."""
    case = data.draw(st.sampled_from(GOOD), label="mesh")
    point = st.tuples(st.integers(0, len(case.triangles) - 1), WEIGHT, WEIGHT, WEIGHT).filter(lambda p: sum(p[1:]) > 0)
    points = data.draw(st.lists(point, min_size=1, max_size=min(20, len(case.vertices))), label="sites")
    weights = np.array([p[1:] for p in points])
    sites = sb.SurfacePoints([p[0] for p in points], weights / weights.sum(axis=1, keepdims=True))
    check(case.mesh, sb.geodesic_voronoi(GRAPHS[case.name], sites))


@pytest.mark.parametrize(
    ("sites", "words"),
    [
        ([], "at least one"),
        ([0, 99], "99"),
        ([[0, 1]], "sites"),
        ([0.5], "sites"),
        (None, "sites"),
    ],
)
def test_bad_sites(sites: object, words: str) -> None:
    graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.cube()))
    with pytest.raises(sb.InputError, match=words):
        sb.geodesic_voronoi(graph, sites)


@pytest.mark.parametrize("cell", [-1, 2])
def test_corners_of_no_cell(cell: int) -> None:
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(sb.Mesh(*meshes.cube())), [0, 6])
    with pytest.raises(sb.InputError, match=str(cell)):
        cells.corners(cell)


def test_cancelled() -> None:
    job = sb.Job()
    job.cancel()
    with pytest.raises(sb.Cancelled):
        sb.geodesic_voronoi(sb.SaddleVertexGraph(sb.Mesh(*meshes.cube())), [0], job=job)


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_edges_seen_end_on_do_not_make_the_scale_matter(scale: float) -> None:
    """Ways along edges are common; what lies beyond such an edge once was where the roundings of lengths put it."""
    vertices, triangles = meshes.torus(72, 30)
    x, y, z = vertices.T
    vertices = vertices * (1 + 0.15 * np.sin(7 * x) * np.cos(5 * y + 1) * np.cos(6 * z))[:, None]
    mesh, scaled = sb.Mesh(vertices, triangles), sb.Mesh(scale * vertices, triangles)
    graph, scaled_graph = sb.SaddleVertexGraph(mesh, k=40), sb.SaddleVertexGraph(scaled, k=40)
    for seed in (4, 8, 17):
        sites = sb.sample(mesh, 40, seed=seed)
        areas = sb.geodesic_voronoi(graph, sites).areas
        found = sb.geodesic_voronoi(scaled_graph, sites).areas / scale**2
        np.testing.assert_allclose(found, areas, atol=1e-6 * mesh.area / 40)


@pytest.mark.parametrize("scale", [1, 0.77, 1e-3, 1e3])
@pytest.mark.parametrize(("columns", "rows"), [(12, 12), (20, 16)])
def test_ties_on_a_regular_grid_do_not_harm_areas(columns: int, rows: int, scale: float) -> None:
    """Bisectors run through vertices and along edges, and four of them meet in points: roundings decide everywhere."""
    vertices, triangles = meshes.grid(columns, rows)
    mesh = sb.Mesh(scale * vertices, triangles)
    graph = sb.SaddleVertexGraph(mesh, k=len(vertices))
    square = [(0, 0), (scale, 0), (scale, scale), (0, scale)]
    for count in (12, 30):
        for seed in range(12):
            sites = np.random.default_rng(seed).choice(len(vertices), count, replace=False)
            cells = sb.geodesic_voronoi(graph, sites)
            check(mesh, cells)
            expected = sb.voronoi_2d(mesh.vertices[sites, :2]).clip(square).areas
            np.testing.assert_allclose(cells.areas, expected, atol=1e-6 * mesh.area / count)


def test_rays_through_many_vertices_are_followed_once() -> None:
    # On the spokes of a wheel each vertex parts what is seen along them in two, and so does the next one.
    mesh = sb.Mesh(*meshes.graded_disk())
    graph = sb.SaddleVertexGraph(mesh, accuracy=5e-3)
    sites = np.random.default_rng(5).integers(0, len(mesh.vertices), 5).astype(np.int32)
    start = time.process_time()
    cells = sb.geodesic_voronoi(graph, sites)
    assert time.process_time() - start < 5  # 0.1 on a slow machine, 18 without the rule
    assert cells.areas.sum() == pytest.approx(mesh.area, rel=1e-9)
    np.testing.assert_array_equal(cells.vertex_cell[sites], np.arange(len(sites)))


@pytest.mark.parametrize("count", [100, 1000, 3000])
@pytest.mark.parametrize(("around", "radius", "height"), [(48, 0.9, 0.5), (48, 0.9, 0.05), (24, 0.95, 0.2)])
def test_long_faces_beside_a_hole(around: int, radius: float, height: float, count: int) -> None:
    """What a site sees the long way round a hole is not where its cell goes on; a fifth of the surface was lost."""
    mesh = sb.Mesh(*meshes.bored_plate(around, radius, height))
    graph = sb.SaddleVertexGraph(mesh, accuracy=5e-3)
    sites, points = sb.sample(mesh, count, seed=3), sb.sample(mesh, 20_000, seed=9)
    cells, exact = sb.geodesic_voronoi(graph, sites), sb.geodesic_voronoi(graph, sites, exact=True)
    apart = np.abs(cells.areas - exact.areas)
    assert apart.max() <= 0.6 * exact.areas.mean()
    assert apart.sum() <= 2 * 0.05 * mesh.area
    assert np.count_nonzero(cells.cells_at(points) != exact.cells_at(points)) <= 0.06 * len(points)
    if count >= 1000:  # cells that are no longer than the hole is wide
        assert apart.max() <= 0.25 * exact.areas.mean()
        assert np.count_nonzero(cells.cells_at(points) != exact.cells_at(points)) <= 0.0025 * len(points)


def test_even_cells_of_long_faces() -> None:
    mesh = sb.Mesh(*meshes.bored_plate())
    cells = sb.centroidal_voronoi(sb.SaddleVertexGraph(mesh, accuracy=5e-3), count=1000, max_iterations=60).cells
    assert 0.75 * cells.areas.mean() <= cells.areas.min()
    assert cells.areas.max() <= 1.3 * cells.areas.mean()
    assert not cells.dual("strict").issues

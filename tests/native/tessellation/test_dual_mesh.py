# SPDX-License-Identifier: MIT
"""The dual of cells: a triangulation of the surface, or the truth about why not."""

from __future__ import annotations

import gc

import numpy as np
import pytest
from scipy.spatial import Delaunay  # type: ignore[import-untyped]

import saddleback as sb
from tests import meshes


def relaxed_cells(mesh: sb.Mesh, count: int, iterations: int = 10) -> sb.GeodesicVoronoi:
    graph = sb.SaddleVertexGraph(mesh, k=min(60, len(mesh.vertices)))
    return sb.centroidal_voronoi(graph, count=count, max_iterations=iterations, seed=2).cells


def characteristic(mesh: sb.Mesh) -> int:
    return len(mesh.vertices) - mesh.edge_count + len(mesh.triangles)


def check_triangulation(mesh: sb.Mesh, dual: sb.DualMesh) -> None:
    """As a mesh it is accepted, and it has the topology of the surface, part by part."""
    assert dual.issues == []
    assert dual.euler_characteristic == characteristic(mesh)
    made = sb.Mesh(dual.vertices, dual.triangles)
    assert characteristic(made) == characteristic(mesh)
    assert made.components.max() == mesh.components.max()
    assert made.genus == mesh.genus
    assert len(made.boundary_loops) == len(mesh.boundary_loops)
    np.testing.assert_allclose(dual.sites.positions(mesh), dual.vertices, atol=1e-12)
    chords = np.linalg.norm(np.diff(dual.vertices[dual.edges], axis=1)[:, 0], axis=1)
    assert (dual.edge_lengths >= chords * (1 - 1e-9)).all()


@pytest.mark.parametrize(
    "arrays",
    [meshes.icosphere(4), meshes.torus(72, 30), meshes.double_torus(), meshes.two_components()],
    ids=["sphere", "torus", "double torus", "two parts"],
)
@pytest.mark.parametrize("count", [4, 150])
def test_repair_makes_a_triangulation(arrays: meshes.Arrays, count: int) -> None:
    vertices, triangles = arrays
    while len(triangles) < 3000:
        vertices, triangles = meshes.subdivide(vertices, triangles)
    mesh = sb.Mesh(vertices, triangles)
    cells = relaxed_cells(mesh, count)
    dual = cells.dual()
    check_triangulation(mesh, dual)
    assert dual.added == len(dual.vertices) - count
    np.testing.assert_array_equal(dual.vertices[:count], cells.sites.positions(mesh))  # what was there has not moved


@pytest.mark.parametrize("count", [30, 200])
def test_a_plane_with_a_border(count: int) -> None:
    mesh = sb.Mesh(*meshes.grid(40, 40))
    dual = relaxed_cells(mesh, count).dual()
    check_triangulation(mesh, dual)


def test_the_sphere_by_many_cells_needs_no_repair() -> None:
    mesh = sb.Mesh(*meshes.icosphere(4))
    cells = relaxed_cells(mesh, 100)
    vertices, triangles, issues = cells.dual("strict")
    assert issues == []
    assert len(vertices) == 100
    assert len(triangles) == 2 * 100 - 4
    # Counter-clockwise seen from outside.
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), a + b + c) > 0).all()
    np.testing.assert_array_equal(cells.dual("fail").triangles, triangles)


def test_in_the_plane_it_is_delaunays_triangulation() -> None:
    mesh = sb.Mesh(*meshes.grid(30, 30))
    points = np.random.default_rng(5).uniform(0.02, 0.98, (80, 2))
    sites = sb.project(mesh, np.column_stack([points, np.zeros(80)]))
    graph = sb.SaddleVertexGraph(mesh, k=900)
    dual = sb.geodesic_voronoi(graph, sites).dual("strict")
    delaunay = Delaunay(points)
    inside = {
        tuple(sorted(t))
        for t, x in zip(delaunay.simplices.tolist(), circumcenters(points[delaunay.simplices]), strict=True)
        if (x > 0.001).all() and (x < 0.999).all()
    }
    assert len(inside) > 80
    made = {tuple(sorted(t)) for t in dual.triangles.tolist()}
    assert inside <= made
    # Flat: a geodesic is the chord, wherever the bisector is met inside the square.
    chords = np.linalg.norm(points[dual.edges[:, 0]] - points[dual.edges[:, 1]], axis=1)
    np.testing.assert_allclose(dual.edge_lengths, chords, rtol=1e-5)


def circumcenters(corners: np.ndarray) -> np.ndarray:
    a, b, c = (corners[:, i] for i in range(3))
    d = 2 * np.linalg.det(np.stack([b - a, c - a], axis=1))
    b2, c2 = ((b - a) ** 2).sum(axis=1), ((c - a) ** 2).sum(axis=1)
    u = np.stack([(c - a)[:, 1] * b2 - (b - a)[:, 1] * c2, (b - a)[:, 0] * c2 - (c - a)[:, 0] * b2], axis=1)
    return a + u / d[:, None]


def test_strict_tells_what_is_wrong() -> None:
    """Two sites on a torus: two annuli that meet along two circles."""
    vertices, triangles = meshes.torus(60, 16)
    mesh = sb.Mesh(vertices, triangles)
    opposite = [int(np.argmax(vertices[:, 0])), int(np.argmin(vertices[:, 0]))]
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=60), opposite)
    dual = cells.dual("strict")
    assert sorted(issue.kind for issue in dual.issues) == ["closed_boundary"] * 2 + ["not_a_disk"] * 2
    assert {issue.other for issue in dual.issues if issue.kind == "closed_boundary"} == {1}
    assert "closed curve" in str(dual.issues[-1])
    assert len(dual.triangles) == 0
    with pytest.raises(sb.InputError, match=r"cell 0 is not a disk.*policy='repair'"):
        cells.dual("fail")
    check_triangulation(mesh, cells.dual("repair"))


@pytest.mark.parametrize("count", [1, 2, 3])
def test_very_few_cells(count: int) -> None:
    mesh = sb.Mesh(*meshes.icosphere(3))
    cells = relaxed_cells(mesh, count, iterations=3)
    assert len(cells.dual("strict").issues) > 0
    check_triangulation(mesh, cells.dual())


def test_an_unknown_policy() -> None:
    cells = relaxed_cells(sb.Mesh(*meshes.icosphere(2)), 20)
    with pytest.raises(sb.InputError, match="policy: wanted 'strict', 'repair' or 'fail', got 'guess'"):
        cells.dual("guess")  # type: ignore[arg-type]


def test_the_same_for_any_number_of_threads() -> None:
    cells = relaxed_cells(sb.Mesh(*meshes.torus(60, 24)), 6)
    one, eight = cells.dual(threads=1), cells.dual(threads=8)
    assert one.added > 0
    assert one.vertices.tobytes() == eight.vertices.tobytes()
    assert one.triangles.tobytes() == eight.triangles.tobytes()
    assert one.edge_lengths.tobytes() == eight.edge_lengths.tobytes()


def test_quality_of_known_triangles() -> None:
    """An equilateral triangle, half a square, and one without area."""
    root = np.sqrt(3)
    vertices = np.array([(0, 0, 0), (2, 0, 0), (1, root, 0), (0, 2, 0), (4, 0, 0)], dtype=float)
    quality = sb.triangle_quality(vertices, [(0, 1, 2), (0, 1, 3), (0, 1, 4)])
    side = 2 * np.sqrt(2)
    half = 6 * 2 / (root * (2 + 2 + side) / 2 * side)
    np.testing.assert_allclose(quality.quality, [1, half, 0], atol=1e-15)
    np.testing.assert_allclose(quality.least_angle, np.radians([60, 45, 0]), atol=1e-15)
    np.testing.assert_allclose(quality.greatest_angle, np.radians([60, 90, 180]), atol=1e-15)
    assert quality.min_quality == 0
    assert quality.mean_quality == pytest.approx((1 + half) / 3)
    assert quality.mean_angle == pytest.approx(np.radians(35))


def test_valences() -> None:
    ico = sb.triangle_quality(*meshes.icosphere(1))
    assert np.bincount(ico.valence).tolist() == [0, 0, 0, 0, 0, 12, 30]
    assert ico.irregular == pytest.approx(12 / 42)
    plane = sb.triangle_quality(*meshes.grid(6, 6))  # on the border 4, but 2 or 3 at the corners
    assert plane.irregular == pytest.approx(4 / 36)


@pytest.mark.parametrize(
    ("vertices", "triangles", "words"),
    [
        (np.zeros((3, 3)), [(0, 1, 3)], "triangle 0 names vertex 3"),
        (np.zeros((3, 3)), [(0, 1, -1)], "-1"),
        (np.full((3, 3), np.nan), [(0, 1, 2)], "vertex 0"),
    ],
)
def test_quality_of_bad_input(vertices: np.ndarray, triangles: list[tuple[int, int, int]], words: str) -> None:
    with pytest.raises(sb.InputError, match=words):
        sb.triangle_quality(vertices, triangles)


@pytest.mark.parametrize("arrays", [meshes.torus(60, 24), meshes.grid(20, 20, 0.3), meshes.icosphere(3)])
def test_dual_edges_as_paths(arrays: meshes.Arrays) -> None:
    mesh = sb.Mesh(*arrays)
    graph = sb.SaddleVertexGraph(mesh, k=60)
    cells = sb.centroidal_voronoi(graph, count=60, max_iterations=8).cells
    dual, paths = cells.dual("strict"), cells.dual_paths()
    assert len(paths) == len(dual.edges)
    for path, (a, b), length in zip(paths, dual.edges, dual.edge_lengths, strict=True):
        np.testing.assert_allclose(path.points[[0, -1]], dual.vertices[[a, b]], atol=1e-12)
        np.testing.assert_allclose(path.surface.positions(mesh), path.points, atol=1e-9)
        assert np.linalg.norm(np.diff(path.points, axis=0), axis=1).sum() == pytest.approx(path.length, rel=1e-8)
        assert path.length == pytest.approx(length, rel=0.05)
        assert path.length >= graph.distance(cells.sites[int(a)], cells.sites[int(b)]) * (1 - 0.01)
    again = cells.dual_paths(threads=1)
    assert all(np.array_equal(p.points, q.points) for p, q in zip(paths, again, strict=True))


def noisy_torus() -> meshes.Arrays:
    vertices, triangles = meshes.torus(30, 15)
    return vertices + 0.02 * np.random.default_rng(1).normal(size=vertices.shape), triangles


ROUGH = [meshes.tetrahedron(), meshes.cube(), meshes.icosphere(1), noisy_torus()]


@pytest.mark.parametrize("arrays", ROUGH, ids=["tetrahedron", "cube", "icosphere", "noisy torus"])
@pytest.mark.parametrize("seed", range(3))
def test_dual_edges_are_as_long_as_ways_on_the_surface(arrays: meshes.Arrays, seed: int) -> None:
    """By exact cells: never below the distance of the two sites, never above the shortest way over their boundary."""
    mesh = sb.Mesh(*arrays)
    graph = sb.SaddleVertexGraph(mesh, k=min(60, len(mesh.vertices) - 1))
    cells = sb.geodesic_voronoi(graph, sb.sample(mesh, 12, seed=seed), exact=True)
    dual, paths = cells.dual("strict"), cells.dual_paths()
    fields = [sb.ExactField(mesh, cells.sites[i]) for i in range(12)]
    open_ones = [edge for edge in cells.edges if not edge.closed]
    for path, (a, b), length, edge in zip(paths, dual.edges, dual.edge_lengths, open_ones, strict=True):
        assert np.linalg.norm(np.diff(path.points, axis=0), axis=1).sum() == pytest.approx(path.length, rel=1e-12)
        distance = fields[a].distance_to(cells.sites[int(b)])[0]
        over = (fields[a].distance_to(edge.surface) + fields[b].distance_to(edge.surface)).min()
        assert path.length >= distance * (1 - 1e-9)
        assert distance * (1 - 1e-4) <= length <= over * (1 + 1e-4)


@pytest.mark.parametrize("seed", range(4))
def test_dual_edges_are_the_same_from_either_side(seed: int) -> None:
    """With all faces turned over left and right change places: whichever site is aimed from, the other is met."""
    vertices, triangles = meshes.torus(36, 15)
    vertices *= 1 + 0.04 * np.random.default_rng(1).random((len(vertices), 1))
    mesh, over = sb.Mesh(vertices, triangles), sb.Mesh(vertices, triangles[:, [0, 2, 1]])
    sites = sb.sample(mesh, 20, seed=seed)
    turned = sb.SurfacePoints(sites.faces, sites.barycentric[:, [0, 2, 1]])
    lengths, ways = [], []
    for there, points in ((mesh, sites), (over, turned)):
        cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(there), points, exact=True)
        lengths.append(np.sort(cells.dual("strict").edge_lengths))
        ways.append(np.sort([path.length for path in cells.dual_paths()]))
    np.testing.assert_allclose(lengths[0], lengths[1], rtol=1e-3)
    np.testing.assert_allclose(ways[0], ways[1], rtol=1e-3)


def strip(width: float) -> sb.Mesh:
    vertices, triangles = meshes.grid(20, 3)
    return sb.Mesh(vertices * (19.0, 2 * width, 1.0), triangles)


def test_repair_of_a_strip_ends() -> None:
    """Cells must be as narrow as it is: a wide one is mended; a narrow one would need so many that it is told."""
    mesh = strip(0.1)
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh), sb.sample(mesh, 12, seed=1))
    dual = cells.dual()
    check_triangulation(mesh, dual)
    assert len(np.unique(dual.vertices, axis=0)) == len(dual.vertices) == len(np.unique(dual.triangles))
    for width in (1e-3, 1e-5):
        mesh = strip(width)
        cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh), sb.sample(mesh, 12, seed=1))
        with pytest.raises(
            sb.InputError, match=r"no dual mesh after \d+ more sites, of at most 1120: cell .*subdivide"
        ):
            cells.dual()


@pytest.mark.parametrize("along", [2, 40])
def test_around_the_tip_of_a_spike_few_sites_are_added(along: int) -> None:
    """Cells near the tip close around it, however small they are: a site alone would be such a cell again."""
    mesh = sb.Mesh(*meshes.cone(32, along, 1.0, 20.0))
    cells = relaxed_cells(mesh, 400)
    assert any(issue.kind == "closed_boundary" for issue in cells.dual("strict").issues)  # else nothing is tested
    dual = cells.dual()
    check_triangulation(mesh, dual)
    assert dual.added < 60


@pytest.mark.parametrize("count", [1, 2])
def test_a_disk_with_too_few_cells_for_a_triangle(count: int) -> None:
    mesh = sb.Mesh(*meshes.grid(9, 9))
    graph = sb.SaddleVertexGraph(mesh)
    cells = sb.geodesic_voronoi(graph, np.array([20, 60][:count]))
    dual = cells.dual("strict")
    assert len(dual.triangles) == 0
    assert [issue.kind for issue in dual.issues] == ["few_corners"] * count
    check_triangulation(mesh, cells.dual())
    assert sb.centroidal_voronoi(graph, count=count, closed_ball=True, max_iterations=5).issues


@pytest.mark.parametrize("scale", [1e-300, 1e-80, 1e78, 1e300])
def test_quality_at_any_size(scale: float) -> None:
    vertices, triangles = noisy_torus()
    at_one, at_scale = (sb.triangle_quality(vertices * s, triangles) for s in (1.0, scale))
    np.testing.assert_allclose(at_scale.quality, at_one.quality, rtol=1e-10)
    np.testing.assert_allclose(at_scale.least_angle, at_one.least_angle, rtol=1e-10)


def test_double_edges_go_both_ways_round() -> None:
    """Sites above and below one another on a tube meet on its outside and on its inside."""
    mesh = sb.Mesh(*meshes.torus(48, 12))
    graph = sb.SaddleVertexGraph(mesh, k=60)
    angles = 2 * np.pi * np.arange(4) / 4
    places = [(np.cos(a), np.sin(a), z) for a in angles for z in (0.35, -0.35)]
    sites = [int(np.argmin(np.linalg.norm(mesh.vertices - p, axis=1))) for p in places]
    cells = sb.geodesic_voronoi(graph, sites)
    dual, paths = cells.dual("strict"), cells.dual_paths()
    pairs: dict[tuple[int, int], list[sb.GeodesicPath]] = {}
    for path, edge in zip(paths, dual.edges, strict=True):
        pairs.setdefault((int(min(edge)), int(max(edge))), []).append(path)
    double = [both for both in pairs.values() if len(both) > 1]
    assert double
    for first, second, *_ in double:
        gap = np.linalg.norm(first.points[len(first.points) // 2] - second.points[len(second.points) // 2])
        assert gap > 0.2


def double_sheet(size: int, gap: float) -> meshes.Arrays:
    """Two square sheets that almost touch, joined along their border: a closed surface."""
    vertices, triangles = meshes.grid(size, size)
    count = len(vertices)
    border = sb.Mesh(vertices, triangles).boundary_loops[0]
    after = np.roll(border, -1)
    rim = np.concatenate(
        [np.stack([after, border, border + count], axis=1), np.stack([after, border + count, after + count], axis=1)]
    )
    places = np.concatenate([vertices + [0, 0, gap / 2], vertices - [0, 0, gap / 2]])
    return places, np.concatenate([triangles, triangles[:, ::-1] + count, rim]).astype(np.int32)


def test_sheets_that_almost_touch_stay_apart() -> None:
    """Nearest through space is the other sheet; on the surface it is far away, but for what lies about the border."""
    mesh = sb.Mesh(*double_sheet(24, 0.002))
    assert characteristic(mesh) == 2
    cells = relaxed_cells(mesh, 80)
    dual = cells.dual("repair")
    check_triangulation(mesh, dual)
    heights, places = dual.vertices[:, 2], dual.vertices[:, :2]
    for a, b in dual.edges:
        if heights[a] * heights[b] < 0:  # over the border: no longer than two cells are wide
            to_border = np.minimum(places[[a, b]], 1 - places[[a, b]]).min(axis=1)
            assert to_border.sum() < 0.4
    from_site = np.linalg.norm(mesh.vertices[:, :2] - cells.sites.positions(mesh)[cells.vertex_cell, :2], axis=1)
    assert (from_site <= cells.vertex_distance * 1.02 + 1e-9).all()
    inner = (np.minimum(mesh.vertices[:, :2], 1 - mesh.vertices[:, :2]) > 0.3).all(axis=1)
    sheet = cells.sites.positions(mesh)[cells.vertex_cell, 2]
    assert (sheet[inner] * mesh.vertices[inner, 2] > 0).all()


def sieve(holes: int = 6, bridge: int = 1) -> meshes.Arrays:
    """A square full of square holes, with bridges between them that are as narrow as so many faces."""
    step = 3 + bridge
    vertices, triangles = meshes.grid(holes * step + bridge + 1, holes * step + bridge + 1)
    middle = vertices[triangles].mean(axis=1)[:, :2] * (holes * step + bridge)
    inside = ((middle % step) > bridge).all(axis=1)
    return meshes.without_unused(vertices, triangles[~inside])


def test_bridges_as_narrow_as_a_face_are_parted_by_sites_on_their_borders() -> None:
    mesh = sb.Mesh(*sieve())
    assert len(mesh.boundary_loops) == 37
    cells = relaxed_cells(mesh, 100)
    on_border = np.zeros(len(mesh.vertices), bool)
    on_border[np.concatenate(mesh.boundary_loops)] = True
    meets_twice = [issue for issue in cells.dual("strict").issues if issue.kind == "two_borders"]
    assert len(meets_twice) > 20
    for issue in meets_twice:
        corners = issue.place.barycentric[0] > 0
        assert on_border[mesh.triangles[issue.place.faces[0]][corners]].all()
        assert cells.locate(issue.place)[0][0] == issue.cell
    dual = cells.dual()
    check_triangulation(mesh, dual)
    assert dual.added < 400  # 761 where they are far from the sites and settle
    np.testing.assert_array_equal(dual.vertices[:100], cells.sites.positions(mesh))


def test_lengths_outlive_the_cells() -> None:
    """Lengths are found when asked for: of the repaired cells, whatever has been forgotten meanwhile."""
    mesh = sb.Mesh(*meshes.torus(60, 24))
    cells = relaxed_cells(mesh, 6)
    kept, strict = cells.dual(threads=1), cells.dual("strict", threads=1)
    assert kept.added > 0
    again = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=60), kept.sites).dual("strict")
    del cells
    gc.collect()
    assert len(strict.edge_lengths) == len(strict.edges)
    np.testing.assert_allclose(kept.edge_lengths, again.edge_lengths, rtol=1e-9)
    assert kept.edge_lengths.ctypes.data == kept.edge_lengths.ctypes.data  # found once

# SPDX-License-Identifier: MIT
"""A polygon for each cell, and the quads between cells and their dual: whole meshes with the surface's topology."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes


def even_cells(mesh: sb.Mesh, count: int, **options: object) -> sb.GeodesicVoronoi:
    graph = sb.SaddleVertexGraph(mesh, k=min(60, mesh.vertex_count))
    return sb.centroidal_voronoi(graph, count=count, max_iterations=15, seed=2, **options).cells  # type: ignore[arg-type]


def cells_about(mesh: sb.Mesh, places: object) -> sb.GeodesicVoronoi:
    sites = sb.project(mesh, np.asarray(places, float))
    return sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=min(200, mesh.vertex_count)), sites)


def loops(polygons: sb.CellPolygons) -> list[list[int]]:
    return [part.tolist() for part in np.split(polygons.corners, polygons.offsets[1:-1])]


def sides(faces: list[list[int]]) -> Counter[tuple[int, int]]:
    return Counter((a, b) for face in faces for a, b in zip(face, face[1:] + face[:1], strict=True))


def characteristic(faces: list[list[int]]) -> int:
    vertices = {v for face in faces for v in face}
    edges = {(min(side), max(side)) for side in sides(faces)}
    return len(vertices) - len(edges) + len(faces)


def check_mesh(mesh: sb.Mesh, faces: list[list[int]], points: sb.SurfacePoints, vertices: NDArray[np.float64]) -> None:
    """Each side runs once in each direction, but at the border, and the topology is the surface's."""
    once = sides(faces)
    assert max(once.values()) == 1
    border = [side for side in once if side[::-1] not in once]
    assert bool(border) == bool(mesh.boundary_loops)
    assert all(len(set(face)) == len(face) >= 3 for face in faces)
    assert characteristic(faces) == mesh.vertex_count - mesh.edge_count + mesh.face_count
    np.testing.assert_allclose(points.positions(mesh), vertices, atol=1e-12)
    assert sorted({v for face in faces for v in face}) == list(range(len(vertices)))


SURFACES = {
    "sphere": meshes.icosphere(4),
    "torus": meshes.torus(72, 30),
    "double torus": meshes.subdivide(*meshes.subdivide(*meshes.double_torus())),
    "two parts": meshes.subdivide(*meshes.two_components()),
    "plane": meshes.grid(40, 40),
    "cylinder": meshes.cylinder(48, 24),
}


@pytest.mark.parametrize("name", SURFACES)
@pytest.mark.parametrize("count", [4, 9, 150])
def test_polygons_are_the_surface_over_again(name: str, count: int) -> None:
    mesh = sb.Mesh(*SURFACES[name])
    cells = even_cells(mesh, count)
    polygons = cells.polygons()
    check_mesh(mesh, loops(polygons), polygons.points, polygons.vertices)
    assert len(polygons) == count + polygons.added == len(polygons.sites)
    assert len(polygons.missing) == 0
    np.testing.assert_array_equal(polygons.polygon_cell, np.arange(len(polygons)))
    if count == 150 and name in ("sphere", "torus", "plane"):
        assert polygons.added == 0
        pairs = {tuple(sorted(pair)) for pair in cells.edge_cells.tolist()}
        owner = {side: cell for cell, face in enumerate(loops(polygons)) for side in sides([face])}
        met = {tuple(sorted((cell, owner[b, a]))) for (a, b), cell in owner.items() if (b, a) in owner}
        assert met == pairs


@pytest.mark.parametrize("name", SURFACES)
@pytest.mark.parametrize("count", [4, 150])
def test_quads_are_the_dual_mesh_over_again(name: str, count: int) -> None:
    mesh = sb.Mesh(*SURFACES[name])
    dual = even_cells(mesh, count).dual()
    points, quads = dual.quads()
    assert len(quads) == 3 * len(dual.triangles)
    made = sb.Mesh(dual.vertices, dual.triangles)
    used = np.unique(quads)
    faces = np.searchsorted(used, quads).tolist()
    assert max(sides(faces).values()) == 1
    assert characteristic(faces) == made.vertex_count - made.edge_count + made.face_count
    places = points.positions(mesh)
    np.testing.assert_array_equal(places[: len(dual.vertices)], dual.vertices)
    # Each goes from a branch point over a middle to a site and back: middles are those of the dual's edges.
    sites, edges = len(dual.vertices), len(dual.edges)
    assert (quads[:, 0] >= sites + edges).all()
    assert (quads[:, 2] < sites).all()
    for column in (1, 3):
        ends = dual.edges[quads[:, column] - sites]
        assert (ends == quads[:, [2]]).any(axis=1).all()
    at = dual.cells.locate(points)[1]
    for middle, (a, b) in enumerate(dual.edges.tolist()):
        to_sites = np.linalg.norm(places[sites + middle] - places[[a, b]], axis=1)
        assert (to_sites <= 1.02 * at[sites + middle]).all()  # the nearest, as the graph measures


def test_corners_of_a_plane_are_those_of_the_diagram() -> None:
    mesh = sb.Mesh(*meshes.grid(30, 30))
    sites = np.random.default_rng(5).uniform(0.02, 0.98, (60, 2))
    polygons = cells_about(mesh, np.column_stack([sites, np.zeros(60)])).polygons(bend=np.inf)
    clipped = sb.voronoi_2d(sites).clip([(0, 0), (1, 0), (1, 1), (0, 1)])
    corners = {0.0 + 0j, 1.0 + 0j, 0.0 + 1j, 1.0 + 1j}
    for cell, face in enumerate(loops(polygons)):
        part = clipped.points[clipped.loop_offsets[cell] : clipped.loop_offsets[cell + 1]]
        wanted = [point for point in part if complex(*np.round(point, 9)) not in corners]
        made = polygons.vertices[face][:, :2]
        assert len(made) == len(wanted)  # without a bend the corners of the square are cut off
        for point in wanted:
            assert np.linalg.norm(made - point, axis=1).min() < 1e-9
    area = 0.0
    whole = cells_about(mesh, np.column_stack([sites, np.zeros(60)])).polygons()
    for face in loops(whole):
        x, y = whole.vertices[face].T[:2]
        area += (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2  # counter-clockwise
    assert area == pytest.approx(1, rel=1e-9)  # with it they are there


def test_three_lunes_of_a_sphere_are_three_polygons() -> None:
    mesh = sb.Mesh(*meshes.icosphere(4))
    angle = 2 * np.pi * np.arange(3) / 3
    cells = cells_about(mesh, np.column_stack([np.cos(angle), np.sin(angle), np.zeros(3)]))
    assert len(cells.corners(0)) == 2
    polygons = cells.polygons("fail", bend=np.inf)
    check_mesh(mesh, loops(polygons), polygons.points, polygons.vertices)
    assert [len(face) for face in loops(polygons)] == [4, 4, 4]
    assert polygons.added == 0
    middles = polygons.vertices[np.abs(polygons.vertices[:, 2]) < 0.5]
    assert len(middles) == 3
    assert abs(middles[:, 2]).max() < 0.05


def test_a_side_leaves_its_boundary_by_no_more_than_the_bend() -> None:
    mesh = sb.Mesh(*meshes.icosphere(5))
    cells = even_cells(mesh, 4)
    counts = []
    for bend in (np.inf, 0.15, 0.02, 0.0):
        polygons = cells.polygons(bend=bend)
        check_mesh(mesh, loops(polygons), polygons.points, polygons.vertices)
        counts.append(len(polygons.vertices))
        ends = {frozenset(side) for face in loops(polygons) for side in sides([face])}
        chords = polygons.vertices[np.array([sorted(pair) for pair in ends])]
        a, way = chords[:, 0], chords[:, 1] - chords[:, 0]
        for points in (edge.points for edge in cells.edges):
            share = np.clip(np.einsum("pej,ej->pe", points[:, None] - a, way) / (way * way).sum(axis=1), 0, 1)
            off = np.linalg.norm(points[:, None] - a - share[..., None] * way, axis=2).min(axis=1)
            assert off.max() <= bend * np.sqrt(cells.areas.max()) + 1e-12
    assert counts[0] == 4
    assert counts == sorted(counts)
    assert counts[-1] > 100


def test_cells_that_are_no_disks() -> None:
    mesh = sb.Mesh(*meshes.cylinder(48, 40, height=6.0))
    cells = cells_about(mesh, [(1, 0, 0.5), (1, 0, 3), (1, 0, 5.5)])
    strict = cells.polygons("strict")
    assert len(strict) == 0
    np.testing.assert_array_equal(strict.missing, [0, 1, 2])
    with pytest.raises(sb.InputError, match="3 cells have no polygon, the first is 0"):
        cells.polygons("fail")
    repaired = cells.polygons()
    assert repaired.added > 0
    check_mesh(mesh, loops(repaired), repaired.points, repaired.vertices)
    two = cells_about(sb.Mesh(*meshes.icosphere(3)), [(0, 0, 1), (0, 0, -1)])
    np.testing.assert_array_equal(two.polygons("strict").missing, [0, 1])  # two disks, but no solid
    assert two.polygons().added > 0
    alone = cells_about(sb.Mesh(*meshes.icosphere(3)), [(0, 0, 1)])
    np.testing.assert_array_equal(alone.polygons("strict").missing, [0])


def test_one_cell_of_a_disk_is_its_border() -> None:
    mesh = sb.Mesh(*meshes.grid(12, 9))
    polygons = cells_about(mesh, [(0.4, 0.6, 0)]).polygons()
    assert len(polygons) == 1
    assert sorted(polygons.vertices[:, :2].tolist()) == [[0, 0], [0, 1], [1, 0], [1, 1]]


def test_sites_at_one_place_and_several_in_one_face() -> None:
    mesh = sb.Mesh(*meshes.tetrahedron())
    places = mesh.vertices[mesh.triangles[0]].mean(axis=0)
    sites = sb.project(mesh, [places, places, *mesh.vertices])
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, exact=True), sites)
    polygons = cells.polygons("strict")
    assert len(polygons) + len(polygons.missing) == int((cells.areas > 0).sum()) == 5
    assert 1 not in polygons.polygon_cell


def test_quads_keep_curves_and_the_border() -> None:
    mesh = sb.Mesh(*meshes.grid(31, 31))
    middle = np.flatnonzero(abs(mesh.vertices[:, 1] - 0.5) < 1e-9)
    middle = middle[np.argsort(mesh.vertices[middle, 0])]
    assert len(middle) == 31
    curves = sb.feature_curves(mesh, np.pi, edges=np.column_stack([middle[:-1], middle[1:]]), boundary=True)
    graph = sb.SaddleVertexGraph(mesh, k=60)
    dual = sb.centroidal_voronoi(graph, count=80, max_iterations=15, curves=curves).cells.dual()
    points, quads = dual.quads(curves)
    places = points.positions(mesh)[:, :2]
    a, b, c, d = (places[quads[:, i]] for i in range(4))
    area = ((c - a)[:, 0] * (d - b)[:, 1] - (c - a)[:, 1] * (d - b)[:, 0]) / 2
    assert (area > 0).all()
    assert area.sum() == pytest.approx(1, rel=1e-9)  # to the border, and with its corners
    on_line = np.flatnonzero(abs(places[:, 1] - 0.5) < 1e-12)
    once = sides(quads.tolist())
    along = [side for side in once if set(side) <= set(on_line.tolist())]
    length = sum(np.linalg.norm(places[p] - places[q]) for p, q in along) / 2
    assert length == pytest.approx(1, rel=1e-9)  # edges lead all along it
    other = sb.feature_curves(sb.Mesh(*meshes.grid(5, 5)), np.pi, boundary=True)
    with pytest.raises(sb.InputError, match="curves: wanted curves of the mesh"):
        dual.quads(other)
    with pytest.raises(sb.InputError, match="curves: wanted SurfaceCurves, got a int"):
        dual.quads([1])  # type: ignore[list-item]


def test_bad_input() -> None:
    cells = even_cells(sb.Mesh(*meshes.icosphere(2)), 12)
    for bend in (-0.1, np.nan):
        with pytest.raises(sb.InputError, match="bend: wanted a number of 0 or more"):
            cells.polygons(bend=bend)
    with pytest.raises(sb.InputError, match="policy: wanted 'strict', 'repair' or 'fail'"):
        cells.polygons("mend")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="is made by the calls that return one"):
        sb.CellPolygons()
    job = sb.Job()
    job.cancel()
    with pytest.raises(sb.Cancelled):
        cells.polygons(job=job)

# SPDX-License-Identifier: MIT
"""Cells by exact distances: against closed forms, and against fields of every site alone."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_progress_and_cancel
from tests.native.cell_checks import check, lag, points_of_cells
from tests.native.exact import random_points
from tests.truth.families import stretched

Chart = Callable[[np.ndarray], np.ndarray]  # from places in space to what the closed form is told
Distance = Callable[[np.ndarray, np.ndarray], np.ndarray]  # from one of those to several


def exact_cells(mesh: sb.Mesh, sites: sb.SurfacePoints) -> sb.GeodesicVoronoi:
    return sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=3), sites, exact=True)


def sites_at(mesh: sb.Mesh, places: list[tuple[float, float, float]]) -> sb.SurfacePoints:
    return sb.project(mesh, places)


def boundaries(cells: sb.GeodesicVoronoi) -> tuple[np.ndarray, np.ndarray]:
    """Points of the boundaries with the middles between them, and the two cells of each."""
    places = [np.concatenate([edge.points, (edge.points[1:] + edge.points[:-1]) / 2]) for edge in cells.edges]
    sides = [np.tile(edge.cells, (len(p), 1)) for edge, p in zip(cells.edges, places, strict=True)]
    return np.concatenate(places), np.concatenate(sides)


def check_bisectors(
    mesh: sb.Mesh, cells: sb.GeodesicVoronoi, chart: Chart, distance: Distance, within: float = 1e-5
) -> np.ndarray:
    """Boundaries are as far from both sites, and no farther than from any other: to a share of a cell's size. Returns
    them in the chart.
    """
    check(mesh, cells)
    within *= np.sqrt(mesh.area / len(cells.sites))
    places, sides = boundaries(cells)
    charted = chart(places)
    table = np.array([distance(site, charted) for site in chart(cells.sites.positions(mesh))])
    rows = np.arange(len(places))
    for side in (0, 1):
        np.testing.assert_allclose(table[sides[:, side], rows], table.min(axis=0), rtol=0, atol=within)
    return charted


SMALL = [c for c in meshes.good() if c.components == 1 and len(c.vertices) <= 700]


@pytest.mark.parametrize("case", SMALL, ids=str)
def test_no_other_site_is_nearer(case: meshes.Case) -> None:
    cells = exact_cells(case.mesh, random_points(case.mesh, min(7, len(case.triangles)), seed=6))
    check(case.mesh, cells)
    for by_area in (True, False):
        assert lag(case.mesh, cells, *points_of_cells(cells, 4000, 1, by_area)).max() <= 1e-5


@pytest.mark.parametrize("arrays", [meshes.tetrahedron(), meshes.cube(), meshes.grid(5, 5, 0.3)])
def test_more_sites_than_triangles(arrays: meshes.Arrays) -> None:
    mesh = sb.Mesh(*arrays)
    cells = exact_cells(mesh, random_points(mesh, 3 * len(mesh.triangles), seed=2))
    check(mesh, cells)
    assert (cells.areas > 0).all()
    for by_area in (True, False):
        assert lag(mesh, cells, *points_of_cells(cells, 4000, 1, by_area)).max() <= 1e-5


@pytest.mark.parametrize("height", [1e-9, 1e-11, 3e-12])
def test_hyperbolas_across_slivers(height: float) -> None:
    """An L whose bisector, a hyperbola behind the corner, crosses a face that is nearly as low as meshes may have."""
    outline = [(0, 0, 0), (1, 0, 0), (1, -1, 0), (-1, -1, 0), (-1, 1, 0), (0, 1, 0)]
    triangles = [(0, 3, 2), (0, 2, 1), (0, 4, 3), (0, 6, 4), (0, 5, 6), (6, 5, 4)]
    mesh = sb.Mesh([*outline, (height - 0.5, height + 0.5, 0)], triangles)
    cells = exact_cells(mesh, sites_at(mesh, [(0.9, -0.05, 0), (-0.9, -0.6, 0)]))
    check(mesh, cells)
    np.testing.assert_array_equal(cells.edge_points, cells.edge_surface.positions(mesh))
    for by_area in (True, False):
        assert lag(mesh, cells, *points_of_cells(cells, 4000, 1, by_area)).max() <= 1e-5


def sees(place: np.ndarray, others: np.ndarray, low: float, high: float) -> np.ndarray:
    """Whether straight lines pass beside the open square from low to high."""
    step = others - place
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.stack([(low + 1e-9 - place) / step, (high - 1e-9 - place) / step])
    outside = (step == 0) & ((place <= low + 1e-9) | (place >= high - 1e-9))
    enter = np.where(step == 0, np.where(outside, np.inf, -np.inf), ends.min(axis=0)).max(axis=1)
    leave = np.where(step == 0, np.inf, ends.max(axis=0)).min(axis=1)
    return np.asarray((enter >= leave) | (leave <= 0) | (enter >= 1))


def test_hyperbolas_behind_an_obstacle() -> None:
    """The plane with a square hole: ways lead straight or over corners of the hole."""
    size, low, high = 13, 4 / 12, 8 / 12
    vertices, triangles = meshes.grid(size, size)
    middles = vertices[triangles].mean(axis=1)[:, :2]
    keep = ((middles < low) | (middles > high)).any(axis=1)
    mesh = sb.Mesh(*meshes.without_unused(vertices, triangles[keep]))
    corners = np.array([(low, low), (high, low), (high, high), (low, high)])
    side = high - low
    along = side * np.array([[0, 1, 2, 1], [1, 0, 1, 2], [2, 1, 0, 1], [1, 2, 1, 0]])

    def over_corners(site: np.ndarray) -> np.ndarray:
        straight = np.where(sees(site, corners, low, high), np.linalg.norm(corners - site, axis=1), np.inf)
        return np.asarray((straight[:, None] + along).min(axis=0))

    def distance(site: np.ndarray, places: np.ndarray) -> np.ndarray:
        best = np.where(sees(site, places, low, high), np.linalg.norm(places - site, axis=1), np.inf)
        for corner, before in zip(corners, over_corners(site), strict=True):
            seen = sees(corner, places, low, high)
            best = np.minimum(best, np.where(seen, before + np.linalg.norm(places - corner, axis=1), np.inf))
        return best

    cells = exact_cells(mesh, sites_at(mesh, [(0.2, 0.52, 0), (0.61, 0.9, 0), (0.95, 0.3, 0)]))
    places = check_bisectors(mesh, cells, lambda xyz: xyz[:, :2], distance)
    a, b = cells.sites.positions(mesh)[:2, :2]
    behind = sees(b, places, low, high) & ~sees(a, places, low, high)
    on_both = np.abs(distance(a, places) - distance(b, places)) < 1e-5
    assert (behind & on_both).sum() > 20
    bent = places[behind & on_both]
    assert np.linalg.svd(bent - bent.mean(axis=0))[1][1] > 1e-3  # no straight line


@pytest.mark.parametrize("turn", [0.0, np.pi, 2.1])
def test_the_tube(turn: float) -> None:
    """Two sites on a prism; rolled out, a strip that repeats. At the same angle their bisector is a closed curve."""
    around, radius = 24, 1.0
    mesh = sb.Mesh(*meshes.cylinder(around, 9, radius, 2.0))
    step, apothem = 2 * np.pi / around, radius * np.cos(np.pi / around)
    width = 2 * radius * np.sin(np.pi / around)

    def chart(xyz: np.ndarray) -> np.ndarray:
        angle = np.arctan2(xyz[:, 1], xyz[:, 0]) % (2 * np.pi)
        side = np.minimum(np.floor(angle / step), around - 1)
        return np.column_stack([width * (side + 0.5) + apothem * np.tan(angle - step * (side + 0.5)), xyz[:, 2]])

    def distance(site: np.ndarray, places: np.ndarray) -> np.ndarray:
        along = np.abs(places[:, 0] - site[0])
        return np.hypot(np.minimum(along, around * width - along), places[:, 1] - site[1])

    middle = mesh.vertices[:, 2].mean()
    places = [(np.cos(a), np.sin(a), middle + z) for a, z in ((0.3, -0.31), (0.3 + turn, 0.37))]
    cells = exact_cells(mesh, sites_at(mesh, places))
    check_bisectors(mesh, cells, chart, distance, 1e-9)
    if turn == 0:
        assert cells.edge_closed.tolist() == [True]
        heights = cells.edge_points[:, 2]
        np.testing.assert_allclose(heights, cells.sites.positions(mesh)[:, 2].mean(), atol=1e-9)


def fan(sides: int, total: float) -> meshes.Arrays:
    """Isosceles triangles about the origin, in all `total` radians there; each divided into 16."""
    corner, turn = total / sides, 2 * np.pi / sides
    # Rim points at height +-h (or all at h where the angle is below 2 pi): their scalar products give the corner.
    zigzag = total > 2 * np.pi
    squared = (np.cos(turn) - np.cos(corner)) / (1 + np.cos(corner))
    if not zigzag:
        squared = (np.cos(corner) - np.cos(turn)) / (1 - np.cos(corner))
    height = np.sqrt(squared) * np.where(zigzag, (-1.0) ** np.arange(sides), np.full(sides, -1.0))
    angle = turn * np.arange(sides)
    rim = np.column_stack([np.cos(angle), np.sin(angle), height]) / np.sqrt(1 + squared)
    triangles = [(0, 1 + i, 1 + (i + 1) % sides) for i in range(sides)]
    arrays = np.vstack([np.zeros((1, 3)), rim]), np.array(triangles, dtype=np.int32)
    return meshes.subdivide(*meshes.subdivide(*arrays))


@pytest.mark.parametrize(("total", "sides"), [(4.0, 12), (2 * np.pi * 1.4, 16)], ids=["cone", "saddle"])
def test_about_an_apex(total: float, sides: int) -> None:
    """A cone, and an apex with more than a full turn: there shortest ways bend and bisectors are hyperbolas."""
    mesh = sb.Mesh(*fan(sides, total))
    rim = mesh.vertices[1 : 1 + sides]
    corner = total / sides

    def chart(xyz: np.ndarray) -> np.ndarray:
        """Distance from the apex, and the angle there."""
        at = np.floor(np.arctan2(xyz[:, 1], xyz[:, 0]) % (2 * np.pi) / (2 * np.pi / sides)).astype(int) % sides
        basis = np.stack([rim[at], rim[(at + 1) % sides]], axis=2)
        shares = np.array([np.linalg.lstsq(b, p, rcond=None)[0] for b, p in zip(basis, xyz, strict=True)])
        inside = np.arctan2(shares[:, 1] * np.sin(corner), shares[:, 0] + shares[:, 1] * np.cos(corner))
        return np.column_stack([np.linalg.norm(xyz, axis=1), corner * at + inside])

    def distance(site: np.ndarray, places: np.ndarray) -> np.ndarray:
        turn = np.abs(places[:, 1] - site[1])
        turn = np.minimum(np.minimum(turn, total - turn), np.pi)
        return np.sqrt(site[0] ** 2 + places[:, 0] ** 2 - 2 * site[0] * places[:, 0] * np.cos(turn))

    angles = np.array([0.35, 2.2, 3.6]) * (1.0 if total < 6 else 1.2)
    sites = sites_at(mesh, [(r * np.cos(a), r * np.sin(a), 0) for r, a in zip((0.7, 0.45, 0.3), angles, strict=True)])
    cells = exact_cells(mesh, sites)
    charted = check_bisectors(mesh, cells, chart, distance)
    if total < 6:
        return
    straight = np.array([np.abs(charted[:, 1] - site[1]) % total for site in chart(cells.sites.positions(mesh))])
    straight = np.minimum(straight, total - straight) < np.pi
    assert (straight.any(axis=0) & ~straight.all(axis=0)).sum() > 20


def test_mirrored_sites_on_a_sphere() -> None:
    mesh = sb.Mesh(*meshes.icosphere(2))
    x, y = mesh.vertices.T[:2]
    site = int(np.argmax(x - 0.3 * y))
    mirrored = int(np.argmin(np.linalg.norm(mesh.vertices - mesh.vertices[site] * [-1, 1, 1], axis=1)))
    cells = exact_cells(mesh, sb.SurfacePoints(*corner_points(mesh, [site, mirrored])))
    check(mesh, cells)
    assert cells.edge_closed.tolist() == [True]
    places, _ = boundaries(cells)
    np.testing.assert_allclose(places[:, 0], 0, atol=1e-6)
    np.testing.assert_allclose(cells.areas, mesh.area / 2, rtol=1e-6)


def corner_points(mesh: sb.Mesh, vertices: list[int]) -> tuple[np.ndarray, np.ndarray]:
    faces, corners = zip(*(np.argwhere(mesh.triangles == v)[0] for v in vertices), strict=True)
    return np.array(faces, dtype=np.int32), np.eye(3)[list(corners)]


def test_the_graph_comes_near() -> None:
    """Within its accuracy, and with straight bisectors inside faces."""
    mesh = sb.Mesh(*meshes.torus(60, 24))
    sites = random_points(mesh, 9, seed=3)
    near = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, accuracy=5e-3), sites)
    exact = exact_cells(mesh, sites)
    np.testing.assert_allclose(near.areas, exact.areas, rtol=0.03)
    np.testing.assert_allclose(near.vertex_distance, exact.vertex_distance, rtol=0.01, atol=1e-9)
    pairs = [sorted(map(tuple, np.sort(cells.edge_cells, axis=1))) for cells in (near, exact)]
    assert pairs[0] == pairs[1]


def rough_torus(around: int, across: int, noise: float, seed: int = 0) -> sb.Mesh:
    vertices, triangles = meshes.torus(around, across)
    return sb.Mesh(vertices + noise * np.random.default_rng(seed).normal(size=vertices.shape), triangles)


def test_bent_bisectors_have_some_points_a_face() -> None:
    """Behind saddle vertices nearly all are hyperbolas; each face is crossed by one piece of some."""
    mesh = rough_torus(40, 20, 0.02)
    cells = exact_cells(mesh, random_points(mesh, 6, seed=1))
    crossed = sum(1 + np.count_nonzero(np.diff(edge.surface.faces)) for edge in cells.edges)
    assert len(cells.edge_points) < 50 * crossed


@pytest.mark.parametrize("seed", range(6))
def test_straight_bisectors_are_straight(seed: int) -> None:
    """On a flat sheet however it is divided, of near sites, too: breaks where edges are crossed or three cells meet."""
    random = np.random.default_rng(seed)
    vertices, triangles = meshes.grid(5, 5)
    inner = (vertices[:, :2] > 0).all(axis=1) & (vertices[:, :2] < 1).all(axis=1)
    vertices[inner, :2] += random.uniform(-0.05, 0.05, (inner.sum(), 2))
    mesh = sb.Mesh(vertices, triangles)
    places = random.random((6, 2))
    places[5] = places[4] + 10.0 ** -random.integers(2, 8) * random.normal(size=2)
    cells = exact_cells(mesh, sites_at(mesh, np.column_stack([places, np.zeros(6)]).tolist()))
    check(mesh, cells)
    points = [len(edge.points) for edge in cells.edges]
    crossed = [1 + np.count_nonzero(np.diff(edge.surface.faces)) for edge in cells.edges]
    assert sum(points) <= 2 * sum(crossed) + 2 * len(points)
    at = cells.sites.positions(mesh)
    for edge in cells.edges:
        a, b = at[list(edge.cells)]
        off = (edge.points - (a + b) / 2) @ (b - a) / np.linalg.norm(b - a)
        np.testing.assert_allclose(off, 0, atol=1e-12 / np.linalg.norm(b - a) + 1e-10)


@pytest.mark.parametrize("ratio", [1e-6, 1e-9, 4.6e-12])
@pytest.mark.parametrize("seed", range(3))
def test_needles_about_a_point(ratio: float, seed: int) -> None:
    """Rings of faces that shrink: rounding left boundaries through vertices of parts, which were no points."""
    angle = np.arange(12) * np.pi / 6
    ring = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    inner, i = np.arange(12), np.roll(np.arange(12), -1)
    outer, o = inner + 12, i + 12
    triangles = np.concatenate(
        [
            np.stack(t, axis=1)
            for t in ((0 * inner, inner + 1, i + 1), (i + 1, inner + 1, o + 1), (inner + 1, outer + 1, o + 1))
        ]
    )
    mesh = sb.Mesh(np.concatenate([np.zeros((1, 3)), ratio * ring, ring]), triangles.astype(np.int32))
    cells = exact_cells(mesh, random_points(mesh, 5, seed))
    assert cells.areas.sum() == pytest.approx(mesh.area, rel=1e-9)
    assert cells.dual("strict").edge_lengths.min() > 0
    assert ((cells.edge_points**2).sum(axis=1) <= 1 + 1e-9).all()
    assert max(path.length for path in cells.dual_paths()) < 4


def characteristics(split: sb.SplitMesh, count: int) -> list[int]:
    """Of each cell by its triangles: vertices - edges + triangles."""
    result = []
    for cell in range(count):
        t = split.triangles[split.triangle_cell == cell]
        edges = np.unique(np.sort(t[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
        result.append(len(np.unique(t)) - len(edges) + len(t))
    return result


@pytest.mark.parametrize("seed", range(3))
def test_divided_faces_leave_cells_what_they_are(seed: int) -> None:
    vertices, triangles = meshes.icosphere(2)
    mesh = sb.Mesh(vertices * (1 + 0.03 * np.random.default_rng(seed).normal(size=(len(vertices), 1))), triangles)
    relaxed = sb.centroidal_voronoi(sb.SaddleVertexGraph(mesh, k=40), count=16, max_iterations=20, seed=seed)
    cells = exact_cells(mesh, relaxed.sites)
    assert characteristics(cells.split(), 16) == [1] * 16
    assert cells.dual("strict").issues == []
    assert cells.dual("repair").added == 0
    few = exact_cells(rough_torus(16, 8, 0.02, seed), random_points(rough_torus(16, 8, 0.02, seed), 5, seed))
    told = {issue.cell for issue in few.dual("strict").issues if issue.kind == "not_a_disk"}
    assert told == {cell for cell, c in enumerate(characteristics(few.split(), 5)) if c != 1}


def test_sites_at_one_place_are_one() -> None:
    """Told in several faces, at a vertex, on an edge, inside: the first has the cell."""
    mesh = sb.Mesh(*meshes.tetrahedron())
    faces = [3, 3, 3, *np.flatnonzero((mesh.triangles == 0).any(axis=1))[:2]]
    inside, other = (0.52, 0.46, 0.02), (0.23, 0.19, 0.58)
    at_vertex = [np.eye(3)[list(mesh.triangles[face]).index(0)] for face in faces[3:]]
    sites = sb.SurfacePoints(np.array(faces, dtype=np.int32), np.array([inside, other, inside, *at_vertex]))
    cells = exact_cells(mesh, sites)
    check(mesh, cells)
    firsts = [0, 1, 3]
    alone = exact_cells(mesh, sb.SurfacePoints(sites.faces[firsts], sites.barycentric[firsts]))
    np.testing.assert_allclose(cells.areas, [*alone.areas[:2], 0, alone.areas[2], 0], rtol=1e-4)
    assert cells.areas[2] == cells.areas[4] == 0
    np.testing.assert_array_equal(cells.vertex_cell, np.array(firsts)[alone.vertex_cell])
    np.testing.assert_array_equal(cells.locate(sites)[0], [0, 1, 0, 3, 3])
    np.testing.assert_allclose(cells.locate(sites)[1], 0, atol=1e-9)


@pytest.mark.parametrize("gap", [1e-2, 1e-5, 1e-7, 1e-9])
def test_sites_beside_each_other_have_half_each(gap: float) -> None:
    """In a square: what lies on either side of the straight line between them."""
    mesh = sb.Mesh(*meshes.grid(7, 7))
    middle, turn = np.array([0.45, 0.53]), 0.3
    step = gap / 2 * np.array([np.cos(turn), np.sin(turn)])
    cells = exact_cells(mesh, sb.project(mesh, [[*(middle - step), 0], [*(middle + step), 0]]))
    check(mesh, cells)
    ends = middle[0] - np.tan(turn) * (np.array([0, 1]) - middle[1])  # of the line, below and above
    np.testing.assert_allclose(cells.areas, [ends.mean(), 1 - ends.mean()], rtol=0, atol=1e-6)
    assert len(cells.edge_points) < 5000


@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-8, 1e-13])
def test_near_sites_on_a_rough_surface(gap: float) -> None:
    mesh = rough_torus(16, 8, 0.02)
    points = random_points(mesh, 4, seed=2)
    beside = points.barycentric[0] + gap * np.array([1, -0.7, -0.3]) * (1 if points.barycentric[0, 0] < 0.5 else -1)
    sites = sb.SurfacePoints(
        np.append(points.faces, points.faces[0]), np.concatenate([points.barycentric, beside[None]])
    )
    cells = exact_cells(mesh, sites)
    check(mesh, cells)
    alone = exact_cells(mesh, points)
    assert cells.areas[0] + cells.areas[4] == pytest.approx(alone.areas[0], rel=100 * gap + 1e-4)
    assert len(cells.edge_points) < 3 * len(alone.edge_points)


@pytest.mark.parametrize(
    ("arrays", "vertices"),
    [
        (meshes.icosphere(1), [17, 24, 31, 18, 11, 29, 36, 3, 37, 33]),
        (meshes.icosphere(1), [21, 22, 33, 14, 30, 24, 41, 10, 9, 1, 18, 36, 3]),
        (meshes.icosphere(1), [23, 32, 28, 31, 20, 16, 18, 38, 8, 11]),
        (meshes.torus(12, 6), [34, 0, 46, 7, 68, 65, 1, 58, 30, 15, 18, 33, 32, 64, 26, 21, 14, 17, 61]),
    ],
)
def test_sites_that_tie_along_whole_edges(arrays: meshes.Arrays, vertices: list[int]) -> None:
    """On regular meshes: a rounding in what a face beside an edge knew gave up to a quarter of a cell's width away."""
    mesh = sb.Mesh(*arrays)
    split = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=3), vertices, exact=True).split()
    corners = split.vertices[split.triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    is_wide = areas > 1e-7 * mesh.area  # beside the edges themselves
    points = sb.project(mesh, corners[is_wide].mean(axis=1))
    distances = np.array([sb.ExactField(mesh, [vertex]).distance_to(points) for vertex in vertices])
    own = distances[split.triangle_cell[is_wide], np.arange(len(points))]
    assert (own - distances.min(axis=0)).max() < 1e-5 * np.sqrt(mesh.area / len(vertices))


@pytest.mark.parametrize(("vertices", "most"), [([33, 36], 100), ([54, 20], 100), ([36, 53, 16], 5000)])
def test_ties_along_the_edges_of_a_frame_take_few_points(vertices: list[int], most: int) -> None:
    """Behind a corner both sites are as far along a whole edge: 20 to 80 times as many bits told rounding apart."""
    cell = np.stack(np.meshgrid(*3 * [np.arange(3)], indexing="ij"), axis=-1)
    corners, triangles = meshes.voxels((cell % 2 == 1).sum(axis=-1) <= 1)
    mesh = sb.Mesh(stretched(corners, 0.44), triangles)
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=3), vertices, exact=True)
    check(mesh, cells)
    assert len(cells.edge_points) < most


def test_progress_rises_and_cancel_is_quick() -> None:
    mesh = sb.Mesh(*meshes.torus(90, 40))
    graph, sites = sb.SaddleVertexGraph(mesh, k=3), random_points(mesh, 20, seed=1)
    check_progress_and_cancel(lambda job: sb.geodesic_voronoi(graph, sites, exact=True, job=job), 0.05)


def test_no_site_on_a_part() -> None:
    mesh = sb.Mesh(*meshes.two_components())
    with pytest.raises(sb.InputError, match="no site"):
        exact_cells(mesh, random_points(mesh, 1))


def test_all_parts_about_a_vertex_agree_whose_it_is() -> None:
    """Where rounding decides between two sites, the boundary led through vertices, which crashed."""
    width, height = 6e-7, 0.4
    vertices = np.array([[0, 0, 0], [width, 0, 0], [0, height, 0], [width, height, 0]]) + [1.06, 1, 0]
    mesh = sb.Mesh(vertices, [[0, 1, 3], [0, 3, 2]])
    rng = np.random.default_rng(2)
    for _ in range(20):
        twin = np.array([0.505, 0.4723, 0.0227]) + rng.normal(size=3) * 1e-9
        places = [[0.07, 0.75, 0.18], [0.93, 0.05, 0.02], [0.505, 0.4723, 0.0227], twin]
        sites = sb.SurfacePoints([1, 0, 0, 0], [np.array(b) / np.sum(b) for b in places])
        cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=3), sites, exact=True)
        assert cells.areas.sum() == pytest.approx(width * height, rel=1e-9)
        split = cells.split()
        a, b, c = (split.vertices[split.triangles[:, i]] for i in range(3))
        parts = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
        assert parts.sum() == pytest.approx(width * height, rel=1e-6)


@pytest.mark.parametrize("width", [8.475040635358044e-06, 1e-4, 1e-2])
def test_a_strip_stays_whole(width: float) -> None:
    """A part that knows one site only is divided where its neighbor sees a second one on their edge."""
    x, y = np.meshgrid(np.arange(3) * width, np.arange(3) / 2)
    triangles = [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [3, 4, 7], [3, 7, 6], [4, 5, 8], [4, 8, 7]]
    mesh = sb.Mesh(np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()]), triangles)
    random = np.random.default_rng(5)
    for _ in range(10):
        faces, weights = random.integers(8, size=6), random.dirichlet([1.0, 1.0, 1.0], 6)
        twin = weights[5] + 1e-12 * (1 / 3 - weights[5])
        sites = sb.SurfacePoints(np.append(faces, faces[5]).astype(np.int32), np.vstack([weights, twin]))
        cells = exact_cells(mesh, sites)
        check(mesh, cells)


@pytest.mark.parametrize("ratio", [1e-3, 1e-12])
def test_a_part_beside_a_large_one_is_divided_as_it_is_alone(ratio: float) -> None:
    vertices, triangles = meshes.icosphere(1)
    vertices = ratio * (vertices + 0.05 * np.random.default_rng(2).normal(size=vertices.shape))
    large = meshes.icosphere(2)
    alone = sb.Mesh(vertices, triangles)
    both = sb.Mesh(*meshes.merge((vertices, triangles), (large[0] + [5.0, 0, 0], large[1])))
    beside, expected = (
        sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=3), sites, exact=True).areas
        for mesh, sites in ((both, [0, 7, 20, len(vertices)]), (alone, [0, 7, 20]))
    )
    np.testing.assert_allclose(beside[:3], expected, rtol=1e-9)

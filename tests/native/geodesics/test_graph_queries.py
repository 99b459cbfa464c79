# SPDX-License-Identifier: MIT
"""The graph's queries: batches, A*, points inside faces, curves; and that all of them agree to the bit."""

from __future__ import annotations

import contextlib
import itertools
import threading
import time
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_progress_and_cancel
from tests.native.exact import random_points
from tests.truth.families import delaunay, square, two_lines
from tests.truth.graph import shortness

Floats = NDArray[np.float64]
GOOD = meshes.good()
# Arcs keep 32 bits of a length or fewer: straight lines may come out shorter by this share, and no more.
ROUNDING = 1e-8


def graph_of(case: meshes.Case, k: int = 20) -> sb.SaddleVertexGraph:
    return sb.SaddleVertexGraph(case.mesh, k=min(k, len(case.vertices)))


def whole_graph(vertices: Floats, triangles: NDArray[np.int32]) -> sb.SaddleVertexGraph:
    """All see all: exact but for rounding."""
    return sb.SaddleVertexGraph(sb.Mesh(vertices, triangles), k=len(vertices))


def one(points: sb.SurfacePoints, i: int) -> sb.SurfacePoints:
    return points[i : i + 1]


def to_segments(points: Floats, polyline: Floats) -> Floats:
    """Distance of each point to a polyline, in space or in a plane."""
    best = np.full(len(points), np.inf)
    for a, b in itertools.pairwise(polyline):
        along = b - a
        part = np.clip((points - a) @ along / (along @ along), 0, 1)
        best = np.minimum(best, np.linalg.norm(points - a - part[:, None] * along, axis=1))
    return best


# --- many fields ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("case", GOOD, ids=str)
def test_fields_are_distances_of_each_source_for_any_number_of_threads(case: meshes.Case) -> None:
    graph = graph_of(case)
    last = len(case.vertices) - 1
    for sources in (np.array([0, last, last, 1], dtype=np.int32), random_points(case.mesh, 5)):
        rows = graph.fields(sources, threads=1)
        assert rows.shape == (len(sources), len(case.vertices))
        for i, row in enumerate(rows):
            assert np.array_equal(row, graph.distances(sources[i : i + 1]))
        for threads in (2, 8):
            assert graph.fields(sources, threads=threads).tobytes() == rows.tobytes()
        distance, nearest = graph.nearest(sources)
        assert np.array_equal(distance, rows.min(axis=0))
        assert np.array_equal(nearest, np.where(np.isinf(distance), -1, rows.argmin(axis=0)))  # ties: the smaller


@pytest.mark.parametrize("limit", [0.0, 0.3, 1.0, np.inf])
def test_limit_leaves_what_is_farther(limit: float) -> None:
    mesh = sb.Mesh(*meshes.torus())
    graph = sb.SaddleVertexGraph(mesh, k=20)
    curve = sb.SurfaceCurve(mesh, sb.trace(mesh, random_points(mesh, 1), 1.0, 1.5).surface)
    for sources in (np.array([7, 90]), random_points(mesh, 3), curve, [curve, curve]):
        whole, whole_nearest = graph.nearest(sources)
        within = np.where(whole <= limit, whole, np.inf)
        assert np.array_equal(graph.distances(sources, limit=limit), within)
        distance, nearest = graph.nearest(sources, limit)
        assert np.array_equal(distance, within)
        assert np.array_equal(nearest, np.where(whole <= limit, whole_nearest, -1))
        assert np.array_equal(graph.fields(sources, limit).min(axis=0), within)


@pytest.mark.parametrize("case", GOOD, ids=str)
def test_it_is_a_metric(case: meshes.Case) -> None:
    graph = graph_of(case)
    rng = np.random.default_rng(2)
    chosen = rng.choice(len(case.vertices), min(150, len(case.vertices)), replace=False)
    table = graph.fields(chosen)[:, chosen]
    assert np.array_equal(table, table.T)  # to the bit
    assert np.array_equal(table == 0, np.eye(len(chosen), dtype=bool))
    through = rng.integers(len(chosen), size=(3, 100_000))
    whole, first, second = table[through[0], through[2]], table[through[0], through[1]], table[through[1], through[2]]
    assert (whole <= first + second).all()  # sums of arcs are exact: no rounding to forgive


# --- between two points -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("case", GOOD, ids=str)
def test_one_distance_has_the_bits_of_the_field_in_both_directions(case: meshes.Case) -> None:
    graph = graph_of(case)
    rng = np.random.default_rng(3)
    for a, b in rng.integers(len(case.vertices), size=(60, 2)):
        found = graph.distance(a, b)
        assert found == graph.distance(b, a) == graph.distances([a])[b] == graph.distances_to([a], [b])[0]
    points = random_points(case.mesh, 12, seed=4)
    for i in range(len(points)):
        a, b, vertex = one(points, i), one(points, (5 * i + 3) % len(points)), int(rng.integers(len(case.vertices)))
        assert graph.distance(a, b) == graph.distance(b, a)
        assert graph.distance(a, b) == graph.distances_to(a, b)[0] == graph.distances_to(b, a)[0]
        assert graph.distance(a, vertex) == graph.distance(vertex, a) == graph.distances(a)[vertex]
        assert graph.distance(vertex, a) == graph.distances_to([vertex], a)[0] == graph.distances_to(a, [vertex])[0]


@pytest.mark.parametrize(
    "arrays",
    [meshes.grid(60, 60), meshes.grid(50, 50, 0.2), meshes.icosphere(4), meshes.needles(4, 400)],
    ids=["regular", "jittered", "sphere", "needles"],
)
def test_a_star_returns_what_a_whole_field_says(arrays: meshes.Arrays) -> None:
    """On regular meshes very many ways are equally long; on needles arcs are long and short by a factor of 1000."""
    mesh, rng = sb.Mesh(*arrays), np.random.default_rng(5)
    for graph in (sb.SaddleVertexGraph(mesh, k=30), sb.SaddleVertexGraph(mesh)):
        for a in rng.integers(len(arrays[0]), size=6):
            field = graph.distances([a])
            for b in rng.integers(len(arrays[0]), size=25):
                assert graph.distance(a, b) == field[b]


def test_a_star_looks_at_a_small_part_of_the_mesh() -> None:
    vertices, triangles = meshes.icosphere(5)
    graph = sb.SaddleVertexGraph(sb.Mesh(vertices, triangles), k=50)
    pairs = np.random.default_rng(6).integers(len(vertices), size=(60, 2))
    settled = [graph._distance_and_settled(a, b)[1] for a, b in pairs]
    assert np.mean(settled) <= 0.1 * len(vertices)


def test_points_in_one_face_and_on_its_border() -> None:
    mesh = sb.Mesh(*meshes.grid(7, 7, 0.2))
    graph = sb.SaddleVertexGraph(mesh, k=49)
    inside = sb.SurfacePoints(
        [20] * 6,
        [(0.2, 0.3, 0.5), (0.6, 0.3, 0.1), (0.5, 0.5, 0), (0, 0.1, 0.9), (0, 1, 0)] + [(1 - 1e-9, 5e-10, 5e-10)],
    )
    places = inside.positions(mesh)
    for i in range(len(inside)):
        np.testing.assert_allclose(
            graph.distances_to(one(inside, i), inside),
            np.linalg.norm(places - places[i], axis=1),
            rtol=ROUNDING,
            atol=1e-12,
        )
        assert graph.distance(one(inside, i), one(inside, i)) == 0


@pytest.mark.parametrize("jitter", [0.0, 0.2])
def test_exact_graphs_from_points_on_edges(jitter: float) -> None:
    """Windows across the edge that the source lies on were dropped as narrow ones: 40 % too long."""
    mesh = sb.Mesh(*meshes.grid(5, 5, jitter))
    graph = sb.SaddleVertexGraph(mesh, exact=True)
    for face in range(mesh.face_count):
        for weights in ((0, 0.5, 0.5), (0.25, 0.75, 0), (0.3, 0, 0.7)):
            point = sb.SurfacePoints([face], [weights])
            straight = np.linalg.norm(mesh.vertices - point.positions(mesh), axis=1)
            np.testing.assert_allclose(graph.distances(point), straight, rtol=1e-7, atol=1e-12)


def test_exact_graphs_are_exact_from_points_of_rough_faces() -> None:
    """Fans from points ended at twice as many vertices as one sees in the mean: up to 5 % too long."""
    for seed in range(5):
        mesh = sb.Mesh(*meshes.spikes(9, 10.0, seed))
        graph = sb.SaddleVertexGraph(mesh, exact=True)
        for point in random_points(mesh, 20, seed):
            exact = sb.exact_distances(mesh, point)
            np.testing.assert_allclose(graph.distances(point), exact, rtol=1e-7, atol=1e-12)


def test_other_components_are_infinitely_far() -> None:
    mesh = sb.Mesh(*meshes.two_components())
    graph = sb.SaddleVertexGraph(mesh, k=20)
    other = np.isinf(graph.distances([0]))
    assert 0 < other.sum() < len(other)
    far, near = int(np.flatnonzero(other)[0]), int(np.flatnonzero(~other)[-1])
    assert graph.distance(0, far) == graph.distance(far, 0) == np.inf
    assert np.array_equal(graph.distances_to([0], [far, near]), [np.inf, graph.distance(0, near)])
    face_there = int(np.flatnonzero(other[mesh.triangles].all(axis=1))[0])
    point = sb.SurfacePoints([face_there], [(0.2, 0.3, 0.5)])
    assert graph.distance(point, 0) == graph.distance(0, point) == np.inf
    assert np.array_equal(np.isinf(graph.distances(point)), ~other)
    curve = sb.SurfaceCurve(mesh, mesh.triangles[face_there], closed=True)
    distance, source = graph.nearest([curve])
    assert np.array_equal(np.isinf(distance), ~other)
    assert np.array_equal(source, np.where(other, 0, -1))
    assert np.array_equal(np.isinf(graph.distances_to(curve, [0, far])), [True, False])


# --- any point to any point against what is known ---------------------------------------------------------------------


def test_plane_between_any_points() -> None:
    vertices, triangles = meshes.grid(12, 12, 0.2)
    graph = whole_graph(vertices, triangles)
    points = random_points(graph_mesh := sb.Mesh(vertices, triangles), 40)
    places = points.positions(graph_mesh)
    for i in range(0, 40, 4):
        straight = np.linalg.norm(places - places[i], axis=1)
        np.testing.assert_allclose(graph.distances_to(one(points, i), points), straight, rtol=ROUNDING)


@pytest.mark.parametrize("case", [case for case in GOOD if case.components == 1], ids=str)
def test_between_any_points_never_too_short_and_little_too_long(case: meshes.Case) -> None:
    graph = graph_of(case, 50)
    points, targets = random_points(case.mesh, 3, seed=7), random_points(case.mesh, 100, seed=8)
    for i in range(len(points)):
        exact = sb.ExactField(case.mesh, one(points, i)).distance_to(targets)
        error = graph.distances_to(one(points, i), targets) / exact - 1
        assert error.min() >= -ROUNDING
        if case.name != "needles":  # 50 vertices are a thin strip there: k says nothing of accuracy
            assert error.mean() <= 0.006


def test_any_point_to_any_point_on_a_locally_refined_mesh() -> None:
    """1,000 pairs against exact distances: edges of two lengths, a factor of 40 apart."""
    vertices, triangles = meshes.icosphere(3)
    x, y, z = vertices.T
    vertices = vertices * (1 + 0.15 * np.sin(5 * x) * np.sin(4 * y) * np.sin(3 * z))[:, None]
    center = vertices[7]
    for level in range(5):
        near = np.linalg.norm(vertices - center, axis=1) < 0.8 / 1.7**level
        vertices, triangles = meshes.refined(vertices, triangles, near)
    mesh = sb.Mesh(vertices, triangles)
    graph = sb.SaddleVertexGraph(mesh, accuracy=5e-3)
    rng = np.random.default_rng(1)
    # Any face is as likely as another: most points lie where the mesh is fine.
    faces, weights = rng.integers(0, mesh.face_count, 65).astype(np.int32), rng.dirichlet([1, 1, 1], 65)
    sources, targets = sb.SurfacePoints(faces[:25], weights[:25]), sb.SurfacePoints(faces[25:], weights[25:])
    exact = np.array([sb.ExactField(mesh, one(sources, i)).distance_to(targets) for i in range(len(sources))])
    found = np.array([graph.distances_to(one(sources, i), targets) for i in range(len(sources))])
    error = found / exact - 1
    assert error.min() >= -1e-7  # stored lengths are rounded
    assert error.max() <= 5e-3 + 0.003
    assert error.mean() <= 8e-4


@pytest.mark.parametrize("jitter", [0.0, 0.2])
@pytest.mark.parametrize("accuracy", [2e-2, 5e-3])
def test_points_and_curves_keep_to_the_accuracy(accuracy: float, jitter: float) -> None:
    """Points by their own fans may add 0.3 %; a curve's strip is exact, so that it adds nothing."""
    mesh = sb.Mesh(*meshes.grid(40, 40, jitter))
    graph = sb.SaddleVertexGraph(mesh, accuracy=accuracy)
    points, targets = random_points(mesh, 6, seed=13), random_points(mesh, 500, seed=14)
    for i in range(len(points)):
        straight = np.linalg.norm(targets.positions(mesh) - points.positions(mesh)[i], axis=1)
        error = graph.distances_to(one(points, i), targets) / straight - 1
        assert error.min() >= -ROUNDING
        assert error.max() <= accuracy + 0.003
        assert error.mean() <= 0.4 * accuracy
    curve = traced(mesh, 2 * 39 * 16 + 30, 0.4, 0.45)
    straight = to_segments(mesh.vertices, curve.points.positions(mesh)[[0, -1]])
    found = graph.distances(curve)
    assert (found <= (1 + accuracy) * straight + 1e-12).all()
    assert (found >= (1 - ROUNDING) * straight - 1e-12).all()


@pytest.mark.parametrize("options", [{"k": 36 * 14}, {"exact": True}, {"k": 20}])
def test_near_points_see_each_other_however_wide_the_disks(options: dict[str, object]) -> None:
    mesh = sb.Mesh(*meshes.torus())
    graph = sb.SaddleVertexGraph(mesh, **options)
    points = sb.SurfacePoints(np.arange(30), np.random.default_rng(0).dirichlet([1, 1, 1], 30))
    for i in range(len(points)):
        exact = sb.ExactField(mesh, one(points, i)).distance_to(points)
        near = exact < 0.2
        np.testing.assert_allclose(graph.distances_to(one(points, i), points)[near], exact[near], rtol=1e-8, atol=1e-12)


@pytest.mark.parametrize("width", [1e-1, 1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize("seed", range(3))
def test_points_across_needles_are_as_near_as_they_are(width: float, seed: int) -> None:
    """On a strip cut into needles points see no vertex that is as near as they are to each other."""
    vertices, triangles = meshes.grid(12 + 7 * seed, 2 + seed % 2, jitter=0.3, seed=seed)
    mesh = sb.Mesh(vertices * [width, 1, 1], triangles)
    graph = sb.SaddleVertexGraph(mesh, accuracy=5e-3)
    sources, targets = sb.sample(mesh, 4, seed=seed), sb.sample(mesh, 40, seed=seed + 1)
    right = np.linalg.norm(sources.positions(mesh)[:, None] - targets.positions(mesh), axis=2)
    for i in range(len(sources)):
        found = graph.distances_to(sources[i : i + 1], targets)
        assert (found >= right[i] * (1 - 1e-12)).all()
        assert (found <= right[i] * (1 + 1e-2)).all()
        for k in range(5):
            assert graph.distance(sources[i], targets[k]) == found[k]
            assert abs(graph.path(sources[i], targets[k], shorten=False).length - found[k]) <= 1e-9 * found[k]
    np.testing.assert_array_equal(
        graph.distances_to(sources, targets),
        np.min([graph.distances_to(sources[i : i + 1], targets) for i in range(len(sources))], axis=0),
    )


@pytest.mark.parametrize("width", [1e-3, 2e-6, 1e-8])
@pytest.mark.parametrize("seed", [1, 2, 3, 4, 12])
def test_vertices_across_needles_are_as_near_as_they_are(width: float, seed: int) -> None:
    """From the blunt end of a needle the far corner of the next one is on both rays in single precision, which knows
    nothing of what is near across faces that are thin enough.
    """
    vertices, triangles = meshes.grid(12 + 7 * (seed % 7), 2 + seed % 5, jitter=0.3, seed=seed)
    mesh = sb.Mesh(vertices * [width, 1, 1], triangles)
    graph = sb.SaddleVertexGraph(mesh, accuracy=5e-3)
    for source in range(0, mesh.vertex_count, 3):
        right = np.linalg.norm(mesh.vertices - mesh.vertices[source], axis=1)
        found = graph.distances(source)
        assert (found >= right * (1 - shortness(mesh))).all()
        assert (found <= right * (1 + 5e-3)).all()


@pytest.mark.parametrize("gap", [1e-5, 1e-7, 1e-9])
def test_points_in_needles_beside_needles_see_across(gap: float) -> None:
    """In single precision a point of so thin a face is on its long edge, and so is the far corner of the next one."""
    for seed in range(3):
        rng = np.random.default_rng(seed)
        sites = rng.random((15, 2))
        twins = sites + gap * rng.normal(size=sites.shape)
        mesh = sb.Mesh(*delaunay(square(np.clip(np.vstack([sites, twins]), 0, 1))))
        corner = mesh.vertices[mesh.triangles]
        shortest = np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2).min(axis=1)
        needles = np.flatnonzero(shortest < 3 * gap).astype(np.int32)
        points = sb.SurfacePoints(needles, rng.dirichlet([1, 1, 1], len(needles)))
        graph = sb.SaddleVertexGraph(mesh, accuracy=5e-3)
        right = np.linalg.norm(points.positions(mesh)[:, None] - mesh.vertices, axis=2)
        far = right > 1e-3
        assert (graph.fields(points)[far] <= right[far] * (1 + 6e-3)).all()


def test_many_sources_in_one_face() -> None:
    """Sources that all see each other: only the nearest few are looked at, and nothing is lost."""
    mesh = sb.Mesh(*meshes.grid(20, 20, 0.2))
    graph = sb.SaddleVertexGraph(mesh, k=20)
    rng = np.random.default_rng(9)
    sources = sb.SurfacePoints(rng.integers(300, 304, size=2000), rng.dirichlet([1, 1, 1], 2000))
    targets = sb.SurfacePoints(rng.integers(300, 304, size=300), rng.dirichlet([1, 1, 1], 300))
    straight = np.linalg.norm(targets.positions(mesh)[:, None] - sources.positions(mesh)[None], axis=2).min(axis=1)
    start = time.process_time()
    np.testing.assert_allclose(graph.distances_to(sources, targets), straight, rtol=1e-9, atol=1e-15)
    assert time.process_time() - start < 5


# --- curves -----------------------------------------------------------------------------------------------------------


def traced(mesh: sb.Mesh, face: int, angle: float, length: float) -> sb.SurfaceCurve:
    start = sb.SurfacePoints([face], [(0.3, 0.3, 0.4)])
    return sb.SurfaceCurve(mesh, sb.trace(mesh, start, angle, length).surface)


@pytest.mark.parametrize("jitter", [0.0, 0.2])
@pytest.mark.parametrize("k", [20, 50])
def test_plane_from_a_segment(jitter: float, k: int) -> None:
    mesh = sb.Mesh(*meshes.grid(50, 50, jitter))
    graph = sb.SaddleVertexGraph(mesh, k=k)
    curve = traced(mesh, 2 * 49 * 20 + 40, 0.4, 0.45)
    ends = curve.points.positions(mesh)[[0, -1]]
    targets = random_points(mesh, 1500)
    cases = (
        (graph.distances(curve), to_segments(mesh.vertices, ends)),
        (graph.distances_to(curve, targets), to_segments(targets.positions(mesh), ends)),
    )
    for found, straight in cases:
        error = found - straight
        assert (error >= -ROUNDING * straight - 1e-12).all()
        assert (error <= (0.025 if k == 20 else 0.006) * straight + 1e-12).all()
        assert np.mean(error / np.maximum(straight, 1e-9)) <= (0.005 if k == 20 else 0.001)
        near = straight <= 2.5 / 49  # inside the strip: exact
        assert (error[near] <= ROUNDING * straight[near] + 1e-13).all()


def test_plane_from_closed_and_bent_curves() -> None:
    mesh = sb.Mesh(*meshes.grid(40, 40))
    graph = sb.SaddleVertexGraph(mesh, k=50)
    square = [40 * 10 + i for i in range(10, 20)] + [40 * i + 20 for i in range(10, 20)]
    square += [40 * 20 + i for i in range(20, 10, -1)] + [40 * i + 10 for i in range(20, 10, -1)]
    hook = square[:25]
    for points, closed in (
        (square, True),
        (hook, False),
        (hook + hook[::-1], False),
        (hook[:1] + hook + hook[-1:], False),
    ):
        curve = sb.SurfaceCurve(mesh, points, closed=closed)
        places = mesh.vertices[points + points[:1]] if closed else mesh.vertices[points]
        places = places[np.r_[True, (np.diff(places, axis=0) != 0).any(axis=1)]]
        straight = to_segments(mesh.vertices, places)
        found = graph.distances(curve)
        assert (found[np.unique(points)] == 0).all()
        assert (found >= straight * (1 - ROUNDING) - 1e-12).all()
        assert (found <= straight * 1.012 + 1e-12).all()


def test_cylinder_from_a_ring_and_from_a_line() -> None:
    """Unrolled a strip; a prism's own sides count, not the circle's."""
    around, along, height = 48, 30, 3.0
    vertices, triangles = meshes.cylinder(around, along, 1.0, height)
    mesh = sb.Mesh(vertices, triangles)
    graph = sb.SaddleVertexGraph(mesh, k=60)
    ring = sb.SurfaceCurve(mesh, np.arange(around) + 12 * around, closed=True)
    up = np.abs(vertices[:, 2] - vertices[12 * around, 2])
    np.testing.assert_allclose(graph.distances(ring), up, rtol=0.003, atol=1e-12)
    line = sb.SurfaceCurve(mesh, np.arange(along) * around)
    index = np.arange(len(vertices)) % around
    sideways = np.minimum(index, around - index) * 2 * np.sin(np.pi / around)
    np.testing.assert_allclose(graph.distances(line), sideways, rtol=0.003, atol=1e-12)
    # The sides are flat, so that between ring and line the one whose distance is less is the nearest.
    distance, nearest = graph.nearest([ring, line])
    clear = np.abs(up - sideways) > 0.003 * np.maximum(up, sideways)
    assert np.array_equal(nearest[clear], (sideways < up)[clear])
    np.testing.assert_allclose(distance, np.minimum(up, sideways), rtol=0.003, atol=1e-12)


@pytest.mark.parametrize("case", [case for case in GOOD if case.components == 1], ids=str)
def test_curves_against_points_all_along_them(case: meshes.Case) -> None:
    mesh = case.mesh
    size = float(np.linalg.norm(mesh.vertices.max(axis=0) - mesh.vertices.min(axis=0)))
    curve = sb.SurfaceCurve(mesh, sb.trace(mesh, random_points(mesh, 1, seed=10), 0.7, 0.4 * size).surface)
    corners = curve.points.positions(mesh)
    share = np.linspace(0, 1, 40)[:, None]  # chords of a segment lie in its face
    places = np.concatenate([(1 - share) * a + share * b for a, b in itertools.pairwise(corners)])
    exact = sb.exact_distances(mesh, sb.project(mesh, places))  # at most half a gap too long
    gap = float(np.linalg.norm(np.diff(places, axis=0), axis=1).max())
    found = graph_of(case, 50).distances(curve)
    assert (found + gap / 2 >= exact * (1 - ROUNDING) - 1e-9).all()
    if case.name != "needles":
        assert (found <= exact * 1.02 + 1e-9).all()


@pytest.mark.parametrize("seed", [7, 8, 82, 109, 141, 150, 194, 231])
def test_curves_beside_long_and_short_edges_keep_to_the_accuracy(seed: int) -> None:
    """From the border of a square whose vertices lie on two near lines, by faces as long as they are thin."""
    mesh = sb.Mesh(*two_lines(np.random.default_rng(seed)))
    border = sb.SurfaceCurve(mesh, mesh.boundary_loops[0], closed=True)
    expected = np.minimum(mesh.vertices[:, :2], 1 - mesh.vertices[:, :2]).min(axis=1)
    for accuracy in (5e-3, 2e-2):
        found = sb.SaddleVertexGraph(mesh, accuracy=accuracy).distances(border)
        np.testing.assert_allclose(found, expected, rtol=accuracy, atol=1e-12)


def test_a_very_short_curve_is_a_point() -> None:
    mesh = sb.Mesh(*meshes.icosphere(3))
    graph = sb.SaddleVertexGraph(mesh, k=50)
    start = random_points(mesh, 1, seed=11)
    curve = sb.SurfaceCurve(mesh, sb.trace(mesh, start, 0.2, 1e-7).surface)
    targets = random_points(mesh, 200, seed=12)
    field = sb.ExactField(mesh, start)
    np.testing.assert_allclose(graph.distances(curve), field.distances, rtol=0.012, atol=1e-6)
    np.testing.assert_allclose(graph.distances_to(curve, targets), field.distance_to(targets), rtol=0.012, atol=1e-6)


def test_curve_fields_are_the_same_for_any_number_of_threads() -> None:
    mesh = sb.Mesh(*meshes.torus())
    graph = sb.SaddleVertexGraph(mesh, k=30)
    curves = [traced(mesh, face, 0.3 * face, 0.9) for face in range(0, 300, 60)]
    rows = graph.fields(curves, threads=1)
    for row, curve in zip(rows, curves, strict=True):
        assert np.array_equal(row, graph.distances(curve))
        assert np.array_equal(row, graph.distances(curve, method="dijkstra"))
    assert graph.fields(curves, threads=2).tobytes() == graph.fields(curves, threads=8).tobytes() == rows.tobytes()
    distance, nearest = graph.nearest(curves)
    assert np.array_equal(distance, rows.min(axis=0))
    assert np.array_equal(nearest, rows.argmin(axis=0))


# --- what is refused, and long work -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda g, _: g.fields([]), "sources: wanted at least one source, got none"),
        (lambda g, _: g.fields([0, 8]), r"sources: vertex 8 at \[1\]"),
        (lambda g, _: g.fields([0], -1.0), "limit: wanted a distance of 0 or more, got -1"),
        (lambda g, _: g.fields([0], threads=-2), "threads: wanted 0"),
        (lambda g, _: g.nearest([]), "sources: wanted at least one source, got none"),
        (lambda g, _: g.nearest([0], float("nan")), "limit: wanted a distance of 0 or more"),
        (lambda g, _: g.distance([0, 1], 2), "a: wanted one point, got 2"),
        (lambda g, _: g.distance(0, 8), "b: vertex 8"),
        (lambda g, _: g.distance(0, sb.SurfacePoints([12], [(1, 0, 0)])), "b: point 0 has face 12"),
        (lambda g, _: g.distances_to([], [0]), "sources: wanted at least one source"),
        (lambda g, _: g.distances_to([0], [-1]), "targets: vertex -1"),
        (lambda g, _: g.distances_to([0], [0.5]), "targets: wanted vertex indices"),
        (lambda g, c: g.distances([c, 3]), r"sources\[1\]: wanted a SurfaceCurve like the others, got a int"),
        (lambda g, _: g.distances(other_curve()), "sources: the curve lies on another mesh than the graph's"),
        (lambda g, c: g.nearest([c, other_curve()]), r"sources\[1\]: the curve lies on another mesh"),
    ],
)
def test_bad_queries(ask: object, words: str) -> None:
    mesh = sb.Mesh(*meshes.cube())
    with pytest.raises(sb.InputError, match=words):
        ask(sb.SaddleVertexGraph(mesh, k=8), sb.SurfaceCurve(mesh, mesh.triangles[0]))


def other_curve() -> sb.SurfaceCurve:
    mesh = sb.Mesh(*meshes.tetrahedron())
    return sb.SurfaceCurve(mesh, [0, 1])


def test_no_targets_no_distances() -> None:
    graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.cube()), k=8)
    assert graph.distances_to([0], np.empty(0, dtype=np.int32)).shape == (0,)


def test_more_fields_than_memory_are_refused() -> None:
    graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.icosphere(5)), k=3)
    with pytest.raises(sb.InputError, match=r"sources: 20000000 fields of 10242 vertices take .* GB"):
        graph.fields(np.zeros(20_000_000, dtype=np.int32))


@pytest.mark.parametrize("what", ["fields", "points", "curves", "landmarks"])
def test_progress_rises_and_cancel_is_quick(what: str) -> None:
    mesh = sb.Mesh(*meshes.icosphere(6))
    graph, points = sb.SaddleVertexGraph(mesh, k=20), random_points(mesh, 20_000)
    graphs = [graph]

    def find_landmarks(job: sb.Job) -> float:
        graphs.append(sb.SaddleVertexGraph(mesh, k=20))  # which finds them once
        return graphs[-1].distance(0, 1, job=job)

    asks = {
        "fields": lambda job: graph.fields(np.arange(600), threads=1, job=job),
        "points": lambda job: graph.distances_to(points, points, job=job),
        "curves": lambda job: graph.distances([traced(mesh, 100 * i, 0.1, 3.0) for i in range(600)], job=job),
        "landmarks": find_landmarks,
    }
    check_progress_and_cancel(asks[what], 0.2)
    assert np.isfinite(graphs[-1].distance(0, 1))  # what was stopped leaves nothing behind


def test_a_query_after_stopped_ones_is_as_if_they_had_not_been() -> None:
    mesh = sb.Mesh(*meshes.icosphere(6))
    graph = sb.SaddleVertexGraph(mesh, k=20)
    curve, points = traced(mesh, 0, 0.1, 10.0), random_points(mesh, 1000)
    asks = [
        lambda job=None: graph.distances(curve, job=job),
        lambda job=None: graph.distances_to(curve, points, job=job),
        lambda job=None: graph.nearest(points, job=job),
        lambda job=None: graph.distances_to(points, points, job=job),
    ]
    for ask in asks:
        start = time.perf_counter()
        expected = ask()
        seconds = time.perf_counter() - start
        for share in np.linspace(0.1, 0.9, 5):
            job = sb.Job()
            stop = threading.Timer(share * seconds, job.cancel)
            stop.start()
            with contextlib.suppress(sb.Cancelled):
                ask(job)
            stop.join()
        assert np.array_equal(np.asarray(ask()), np.asarray(expected))


@pytest.mark.parametrize("rule", [{"exact": True}, {"accuracy": 1e-3}, {"accuracy": 1e-2}], ids=str)
@pytest.mark.parametrize(
    "disk", [meshes.graded_disk(1e-2, 12, 10), meshes.graded_disk(1e-6, 14, 12)], ids=["few", "fine"]
)
def test_from_curves_where_edges_are_of_all_sizes(disk: meshes.Arrays, rule: dict[str, Any]) -> None:
    """Rays from a curve go on through small faces, whose vertices do not see it through large ones."""
    mesh = sb.Mesh(*disk)
    graph = sb.SaddleVertexGraph(mesh, **rule)
    for seed in range(5):
        ends = sb.sample(mesh, 2, seed=seed)
        curve = sb.SurfaceCurve(mesh, sb.ExactField(mesh, ends[0]).path(ends[1]).surface)
        begin, end = ends.positions(mesh)
        share = np.clip((mesh.vertices - begin) @ (end - begin) / ((end - begin) @ (end - begin)), 0, 1)
        right = np.linalg.norm(mesh.vertices - begin - share[:, None] * (end - begin), axis=1)
        np.testing.assert_allclose(graph.distances(curve), right, rtol=rule.get("accuracy", 1e-11), atol=1e-13)


def test_from_a_curve_that_ends_at_a_tip() -> None:
    """Rays at right angles to an edge that ends at a needle's tip have not gone round it yet."""
    mesh = sb.Mesh(*meshes.spike_on_a_plate(5.0))
    tip = mesh.vertex_count - 1
    found = sb.SaddleVertexGraph(mesh, exact=True).distances(sb.SurfaceCurve(mesh, [0, tip]))
    line = mesh.vertices[[0, tip]]
    share = np.linspace(0, 1, 2001)[:, None]
    dense = sb.project(mesh, (1 - share) * line[0] + share * line[1])
    right = sb.exact_distances(mesh, dense)
    np.testing.assert_allclose(found, right, rtol=1e-5, atol=1e-9)

# SPDX-License-Identifier: MIT
"""Exact distances and paths: closed forms, another exact library, geodesics by their definition."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_progress_and_cancel
from tests.native.exact import exact_distances, random_points, with_vertex_at
from tests.native.surface_angles import worst_bend

Floats = NDArray[np.float64]
CONNECTED = [case for case in meshes.good() if case.components == 1]


def assert_exact(found: Floats, expected: Floats, tolerance: float = 1e-12) -> None:
    np.testing.assert_allclose(found, expected, rtol=tolerance, atol=1e-15)


def fields(mesh: sb.Mesh, sources: object) -> list[Floats]:
    """The same distances by all three ways to ask for them."""
    vertices = np.arange(len(mesh.vertices))
    field = sb.ExactField(mesh, sources)
    return [
        sb.exact_distances(mesh, sources),
        sb.exact_nearest(mesh, sources)[0],
        np.array(field.distances),
        field.distance_to(vertices),
    ]


# --- closed forms -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("source", [0, 37, 40 * 20 + 20, 40 * 40 - 1])
@pytest.mark.parametrize("jitter", [0.0, 0.3])
def test_plane_from_vertices(source: int, jitter: float) -> None:
    """On a regular grid nearly every ray runs through vertices: where fast exact methods go wrong."""
    mesh = sb.Mesh(*meshes.grid(40, 40, jitter))
    for found in fields(mesh, [source]):
        assert_exact(found, np.linalg.norm(mesh.vertices - mesh.vertices[source], axis=1))


@pytest.mark.parametrize("weights", [(0.2, 0.3, 0.5), (0.5, 0.5, 0.0), (0.0, 0.25, 0.75), (1 - 1e-9, 5e-10, 5e-10)])
def test_plane_from_faces_and_edges(weights: tuple[float, float, float]) -> None:
    mesh = sb.Mesh(*meshes.grid(20, 20))
    for face in (0, 399, 721):
        source = sb.SurfacePoints([face], [weights])
        expected = np.linalg.norm(mesh.vertices - source.positions(mesh), axis=1)
        for found in fields(mesh, source):
            assert_exact(found, expected)
        targets = random_points(mesh, 200)
        straight = np.linalg.norm(targets.positions(mesh) - source.positions(mesh), axis=1)
        assert_exact(sb.ExactField(mesh, source).distance_to(targets), straight)


@pytest.mark.parametrize("finest", [1e-3, 1e-6, 1e-12])
def test_a_disk_whose_rings_shrink(finest: float) -> None:
    """Seen from the rim the finest ring is less than the rounding of where rays cross the coarse ones."""
    vertices, triangles = meshes.graded_disk(finest)
    mesh = sb.Mesh(vertices, triangles)
    for source in (0, 1, len(vertices) // 2, len(vertices) - 7, len(vertices) - 1):
        for found in fields(mesh, [source]):
            assert_exact(found, np.linalg.norm(vertices - vertices[source], axis=1))


def test_a_few_huge_faces_cost_nothing() -> None:
    """The order of windows stays fine though the mean edge is longer than the rest of the mesh."""
    sphere = meshes.icosphere(3)
    far = np.array([(5, 0, 0), (5 + 1e9, 0, 0), (5, 1e9, 0)], dtype=float), np.array([(0, 1, 2)], dtype=np.int32)
    windows = [sb.ExactField(sb.Mesh(*arrays), [0]).window_count for arrays in (sphere, meshes.merge(sphere, far))]
    assert windows[1] <= 1.1 * windows[0]


def test_needles_of_the_plane() -> None:
    mesh = sb.Mesh(*meshes.needles())
    for source in (0, 1, 402, 799):
        assert_exact(sb.exact_distances(mesh, [source]), np.linalg.norm(mesh.vertices - mesh.vertices[source], axis=1))


@pytest.mark.parametrize("source", [0, 11, 30 * 24 + 7])
def test_cylinder(source: int) -> None:
    """Unrolled, a prism is a strip: the shorter way round counts."""
    around, along = 24, 61
    mesh = sb.Mesh(*meshes.cylinder(around, along, 1.0, 4.0))
    side = 2 * np.sin(np.pi / around)
    step = np.abs(np.arange(around * along) % around - source % around)
    gap = np.minimum(step, around - step) * side
    for found in fields(mesh, [source]):
        assert_exact(found, np.hypot(gap, mesh.vertices[:, 2] - mesh.vertices[source, 2]))


@pytest.mark.parametrize("source", [0, 1, 100, 150])
def test_cone(source: int) -> None:
    """Unrolled, a pyramid is a sector; its apex, less than 2 pi, bends no path."""
    around, along = 24, 8
    mesh = sb.Mesh(*meshes.cone(around, along))
    index = np.arange(len(mesh.vertices))
    slant = np.linalg.norm(mesh.vertices - mesh.vertices[0], axis=1)
    corner = mesh.total_angles[0] / around
    step = np.abs((index - 1) % around - (source - 1) % around)
    turn = np.minimum(step, around - step) * corner
    expected = np.sqrt(np.maximum(0, slant**2 + slant[source] ** 2 - 2 * slant * slant[source] * np.cos(turn)))
    for found in fields(mesh, [source]):
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("length", [1.0, 1e3, 1e7])
def test_a_spike_of_needles(length: float) -> None:
    """Rays that miss the tip would go round it pi / (its angle) times, crossing every needle each time."""
    count = 12
    mesh = sb.Mesh(*meshes.spike_on_a_plate(length, count))
    vertices, ring = mesh.vertices, mesh.vertices[:count]
    field = sb.ExactField(mesh, [count])
    edge, on_plate = np.linalg.norm(vertices[-1] - ring, axis=1), np.linalg.norm(vertices[count] - ring[0])
    assert_exact(field.distances[[0, -1]], np.array([on_plate, on_plate + edge[0]]))
    up = np.array([0.1, 0.3, 0.9])
    for i in range(count):
        places = sb.SurfacePoints([2 * count + i] * 3, np.column_stack([up, 1 - up, 0 * up]))
        found, to_tip = field.distance_to(places), (1 - up) * edge[i]
        assert (found >= (field.distances[-1] - to_tip) * (1 - 1e-12)).all()
        assert (found <= (field.distances[i] + edge[i] - to_tip) * (1 + 1e-12)).all()


@pytest.mark.parametrize("width", [1e-4, 1e-6])
def test_sources_above_each_other_on_a_spike(width: float) -> None:
    """No ray of the middle one meets the others or a corner: it would go round the spike as often as that is thin."""
    count = 8
    angle = 2 * np.pi / count * np.arange(count)
    ring = width * np.column_stack([np.cos(angle), np.sin(angle)])
    vertices = np.vstack([np.column_stack([ring, np.zeros(count)]), [[0, 0, 1]]])
    face = np.arange(count)
    mesh = sb.Mesh(vertices, np.column_stack([face, (face + 1) % count, np.full(count, count)]))
    up = np.array([0.3, 0.5, 0.7])
    field = sb.ExactField(mesh, sb.SurfacePoints([0, 2, 5], np.column_stack([(1 - up) / 2, (1 - up) / 2, up])))
    assert field.window_count <= 200 * mesh.face_count
    np.testing.assert_allclose(field.distances, 0.3, rtol=0, atol=2 * width)


@pytest.mark.parametrize("level", [0, 1, 3])
def test_cube_from_a_corner(level: int) -> None:
    vertices, triangles = meshes.cube()
    for _ in range(level):
        vertices, triangles = meshes.subdivide(vertices, triangles)
    mesh = sb.Mesh(vertices, triangles)
    source = int(np.flatnonzero((vertices == 0).all(axis=1))[0])
    x, y, z = np.sort(vertices, axis=1).T  # by symmetry the largest coordinate tells the side
    over_an_edge = np.hypot(1 + x, y), np.hypot(x, 1 + y)
    expected = np.where(x == 0, np.hypot(y, z), np.minimum(*over_an_edge))
    for found in fields(mesh, [source]):
        assert_exact(found, expected)


def test_a_single_triangle() -> None:
    mesh = sb.Mesh([(0, 0, 0), (3, 0, 0), (0, 4, 0)], [(0, 1, 2)])
    assert_exact(sb.exact_distances(mesh, [1]), np.array([3.0, 0.0, 5.0]))
    field = sb.ExactField(mesh, sb.SurfacePoints([0], [[0, 0.5, 0.5]]))
    assert_exact(np.array(field.distances), np.array([2.5, 2.5, 2.5]))
    assert_exact(field.path(0).points, np.array([(1.5, 2, 0), (0, 0, 0)]))


# --- another exact library --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("case", CONNECTED, ids=str)
def test_from_vertices_as_pygeodesic(case: meshes.Case) -> None:
    for source in (0, len(case.vertices) // 2):
        expected = exact_distances(case.mesh, source)
        for found in fields(case.mesh, [source]):
            assert_exact(found, expected, 1e-9)


@pytest.mark.parametrize("case", CONNECTED, ids=str)
def test_from_faces_as_pygeodesic(case: meshes.Case) -> None:
    point = random_points(case.mesh, 1, seed=3)
    expected = exact_distances(with_vertex_at(case.mesh, point), len(case.vertices))[:-1]
    for found in fields(case.mesh, point):
        assert_exact(found, expected, 1e-9)


@pytest.mark.parametrize("case", CONNECTED, ids=str)
def test_to_faces_as_pygeodesic(case: meshes.Case) -> None:
    field = sb.ExactField(case.mesh, [0])
    targets = random_points(case.mesh, 6, seed=4)
    for i in range(len(targets)):
        expected = exact_distances(with_vertex_at(case.mesh, targets[i : i + 1]), 0)[-1]
        assert field.distance_to(targets[i : i + 1])[0] == pytest.approx(expected, rel=1e-9)


# --- several sources, limit, components -------------------------------------------------------------------------------


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_nearest_is_the_least_of_the_fields(case: meshes.Case) -> None:
    sources = random_points(case.mesh, 7, seed=5)
    alone = np.array([sb.exact_distances(case.mesh, sources[i : i + 1]) for i in range(len(sources))])
    distance, nearest = sb.exact_nearest(case.mesh, sources)
    assert_exact(distance, alone.min(axis=0), 1e-11)
    reached = np.isfinite(distance)
    assert np.array_equal(nearest >= 0, reached)
    at_nearest = alone[nearest[reached], np.flatnonzero(reached)]
    np.testing.assert_allclose(at_nearest, distance[reached], rtol=1e-11, atol=1e-15)
    field = sb.ExactField(case.mesh, sources)
    assert np.array_equal(field.nearest, nearest)


@pytest.mark.parametrize("shape", ["needles", "grid", "square"])
@pytest.mark.parametrize("count", [2, 5, 60])
def test_many_sources_in_one_face(shape: str, count: int) -> None:
    """Some lie in the light of others, some on edges and corners."""
    shapes = {"needles": meshes.needles(), "grid": meshes.grid(12, 12, 0.3), "square": meshes.grid(2, 2)}
    mesh = sb.Mesh(*shapes[shape])
    rng = np.random.default_rng(count)
    for face in rng.integers(len(mesh.triangles), size=15):
        weights = rng.dirichlet([0.6] * 3, count)
        weights[:: 4 + count // 5] = (1, 0, 0)
        weights[1 :: 5 + count // 5, 0] = 0
        weights /= weights.sum(axis=1)[:, None]
        sources = sb.SurfacePoints(np.full(count, face), weights)
        gaps = np.linalg.norm(mesh.vertices[:, None] - sources.positions(mesh), axis=2)
        for found in fields(mesh, sources):
            assert_exact(found, gaps.min(axis=1), 1e-11)
        nearest = sb.exact_nearest(mesh, sources)[1]
        assert np.allclose(gaps[np.arange(len(gaps)), nearest], gaps.min(axis=1), rtol=1e-11, atol=1e-15)


def all_over(shape: str, count: int) -> tuple[sb.Mesh, sb.SurfacePoints]:
    """A flat mesh and sources inside faces, on edges and at vertices."""
    shapes = {
        "needles": meshes.needles(8, 60),
        "grid": meshes.grid(12, 12, 0.3),
        "graded": meshes.graded_disk(1e-4, 40),
    }
    mesh = sb.Mesh(*shapes[shape])
    rng = np.random.default_rng(count)
    weights = rng.dirichlet([0.6] * 3, count)
    weights[::5, 0] = 0
    weights[::11] = (0, 1, 0)
    weights /= weights.sum(axis=1)[:, None]
    return mesh, sb.SurfacePoints(rng.integers(len(mesh.triangles), size=count).astype(np.int32), weights)


@pytest.mark.parametrize("shape", ["needles", "grid", "graded"])
@pytest.mark.parametrize("count", [30, 1000])
def test_many_sources_all_over_a_plane(shape: str, count: int) -> None:
    """What sources leave of each other's windows is what they are nearest to."""
    mesh, sources = all_over(shape, count)
    targets = random_points(mesh, 300, seed=2)
    places = np.concatenate([mesh.vertices, targets.positions(mesh)])
    gaps = np.linalg.norm(places[:, None] - sources.positions(mesh), axis=2)
    expected = gaps.min(axis=1)
    for found in fields(mesh, sources):
        assert_exact(found, expected[: len(mesh.vertices)], 1e-11)
    assert_exact(sb.ExactField(mesh, sources).distance_to(targets), expected[len(mesh.vertices) :], 1e-11)
    nearest = sb.exact_nearest(mesh, sources)[1]
    assert_exact(gaps[np.arange(len(nearest)), nearest], expected[: len(nearest)], 1e-11)


def test_sources_end_the_windows_of_others_inside_needles() -> None:
    """Far from all vertices nothing else does: windows would be the more, the more sources there are, in square."""
    mesh = sb.Mesh(*meshes.needles(8, 200))
    few, many = (sb.ExactField(mesh, sb.sample(mesh, count)).window_count for count in (100, 1500))
    assert many < 4 * few


@pytest.mark.parametrize("pair", [(0, 24), (24, 0), (0, 600), (12, 612), (300, 324)])
def test_ties_go_to_the_smaller_index(pair: tuple[int, int]) -> None:
    mesh = sb.Mesh(*meshes.grid(25, 25))
    alone = np.array([np.linalg.norm(mesh.vertices - mesh.vertices[v], axis=1) for v in pair])
    _, nearest = sb.exact_nearest(mesh, pair)
    assert np.array_equal(nearest, np.where(alone[0] <= alone[1] * (1 + 1e-12), 0, 1))


@pytest.mark.parametrize("shift", [1e-16, 1e-15, 1e-13, 1e-11, 1e-9, 1e-7])
@pytest.mark.parametrize("case", CONNECTED, ids=str)
def test_a_source_beside_a_vertex(case: meshes.Case, shift: float) -> None:
    """As projections of vertices are: rays go round the vertex through next to nothing."""
    mesh = case.mesh
    rng = np.random.default_rng(1)
    for vertex in rng.integers(len(mesh.vertices), size=4):
        face, corner = np.argwhere(mesh.triangles == vertex)[0]
        weights = shift * rng.dirichlet([1, 1, 1])
        weights[corner] = 1 - weights[(corner + 1) % 3] - weights[(corner + 2) % 3]
        source = sb.SurfacePoints([face], [weights])
        moved = 2 * float(np.linalg.norm(mesh.vertices[vertex] - source.positions(mesh)[0]))
        at_vertex = sb.exact_distances(mesh, [vertex])
        targets = rng.integers(len(mesh.vertices), size=5)
        field = sb.ExactField(mesh, source)
        assert np.abs(field.distances - at_vertex).max() <= moved + 1e-12 * at_vertex.max()
        for target, path in zip(targets, field.paths(targets), strict=True):
            assert path.length == pytest.approx(field.distances[target], rel=1e-9, abs=moved + 1e-12)


def test_a_source_given_twice_counts_once() -> None:
    mesh = sb.Mesh(*meshes.torus())
    _, nearest = sb.exact_nearest(mesh, [5, 100, 100, 5])
    assert set(nearest) == {0, 1}
    inside = random_points(mesh, 1)
    twice = sb.SurfacePoints(np.repeat(inside.faces, 3), np.repeat(inside.barycentric, 3, axis=0))
    distance, nearest = sb.exact_nearest(mesh, twice)
    assert (nearest == 0).all()
    assert np.array_equal(distance, sb.exact_distances(mesh, inside))


@pytest.mark.parametrize("limit", [0.0, 0.3, 0.8, 1e9])
def test_limit_leaves_what_is_farther(limit: float) -> None:
    mesh = sb.Mesh(*meshes.torus())
    whole, part = sb.exact_distances(mesh, [7]), sb.exact_distances(mesh, [7], limit)
    assert np.array_equal(part, np.where(whole <= limit, whole, np.inf))
    distance, nearest = sb.exact_nearest(mesh, [7, 7], limit)
    assert np.array_equal(distance, part)
    assert np.array_equal(nearest, np.where(np.isfinite(part), 0, -1))


def test_another_component_is_infinitely_far() -> None:
    mesh = sb.Mesh(*meshes.two_components())
    field = sb.ExactField(mesh, [0])
    here = mesh.components == mesh.components[0]
    assert np.array_equal(np.isfinite(field.distances), here)
    assert np.array_equal(field.nearest >= 0, here)
    elsewhere = sb.SurfacePoints([len(mesh.triangles) - 1], [[0.2, 0.3, 0.5]])
    assert np.isinf(field.distance_to(elsewhere)).all()
    with pytest.raises(sb.InputError, match="which no source reaches"):
        field.path(elsewhere)
    with pytest.raises(sb.InputError, match="point 1"):
        field.paths([0, len(mesh.vertices) - 1])


def test_parts_that_no_source_reaches_are_not_laid_out() -> None:
    ball = meshes.icosphere(4)
    alone = sb.ExactField(sb.Mesh(*ball), [0])
    among = sb.ExactField(sb.Mesh(*meshes.merge(*(ball for _ in range(5)))), [0])
    assert among.nbytes < 1.2 * alone.nbytes
    assert np.array_equal(among.distances[: len(alone.distances)], alone.distances)


# --- paths ------------------------------------------------------------------------------------------------------------


def share_a_face(mesh: sb.Mesh, a: sb.SurfacePoints, b: sb.SurfacePoints) -> bool:
    held = {
        int(v)
        for point in (a, b)
        for v, weight in zip(mesh.triangles[point.faces[0]], point.barycentric[0], strict=True)
        if weight > 0
    }
    return (
        len(held) <= 3
        and bool(np.isin(list(held), mesh.triangles).all())
        and any(held <= set(triangle) for triangle in mesh.triangles.tolist())
    )


@pytest.mark.parametrize("from_face", [False, True], ids=["vertex", "face"])
@pytest.mark.parametrize("case", CONNECTED, ids=str)
def test_paths_are_geodesics_as_long_as_the_distance(case: meshes.Case, from_face: bool) -> None:
    mesh = case.mesh
    source = random_points(mesh, 1, seed=6) if from_face else sb.SurfacePoints([0], [[0, 1, 0]])
    field = sb.ExactField(mesh, source)
    rng = np.random.default_rng(7)
    vertices = rng.integers(len(mesh.vertices), size=12)
    inside = random_points(mesh, 12, seed=8)
    for path, distance, end in [
        *zip(field.paths(vertices), field.distances[vertices], mesh.vertices[vertices], strict=True),
        *zip(field.paths(inside), field.distance_to(inside), inside.positions(mesh), strict=True),
    ]:
        assert_exact(path.points[0], source.positions(mesh)[0])
        assert_exact(path.points[-1], end)
        np.testing.assert_allclose(path.surface.positions(mesh), path.points, atol=1e-14)
        steps = np.linalg.norm(np.diff(path.points, axis=0), axis=1)
        assert path.length == pytest.approx(steps.sum(), rel=1e-12, abs=1e-15)
        assert path.length == pytest.approx(distance, rel=1e-9)
        pairs = range(len(path.points) - 1)
        assert all(share_a_face(mesh, path.surface[i : i + 1], path.surface[i + 1 : i + 2]) for i in pairs)
        if case.name != "needles":  # there the angle at an edge is beyond what its points' rounding tells
            assert worst_bend(mesh, path) <= 1e-7


def test_a_path_runs_along_the_edges_and_through_the_vertices_of_a_grid() -> None:
    mesh = sb.Mesh(*meshes.grid(9, 9))
    field = sb.ExactField(mesh, [0])
    for target in (8, 72, 80, 40):
        path = field.path(target)
        assert path.length == pytest.approx(np.linalg.norm(mesh.vertices[target]), rel=1e-12)
        assert np.isin(path.surface.barycentric, (0.0, 1.0)).all()
        assert len(path.points) == (9 if target != 40 else 5)
    assert len(field.path(0).points) == 1
    assert field.path(0).length == 0


def test_a_path_starts_at_its_own_source() -> None:
    mesh = sb.Mesh(*meshes.torus())
    sources = random_points(mesh, 5, seed=9)
    field = sb.ExactField(mesh, sources)
    for vertex in range(0, len(mesh.vertices), 37):
        start = field.path(vertex).points[0]
        assert_exact(start, sources.positions(mesh)[field.nearest[vertex]])


# --- the call ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("scale", [1e-40, 1e-9, 1e9, 1e40])
def test_scale_changes_nothing_else(scale: float) -> None:
    vertices, triangles = meshes.saddle()
    small = sb.exact_distances(sb.Mesh(vertices, triangles), [5])
    assert_exact(sb.exact_distances(sb.Mesh(vertices * scale, triangles), [5]) / scale, small)


def test_the_order_of_vertices_changes_nothing_else() -> None:
    vertices, triangles = meshes.torus()
    order = np.random.default_rng(2).permutation(len(vertices))
    place = np.argsort(order)
    mixed = sb.Mesh(vertices[order], place[triangles][np.random.default_rng(3).permutation(len(triangles))])
    assert_exact(sb.exact_distances(mixed, [place[4]]), sb.exact_distances(sb.Mesh(vertices, triangles), [4])[order])


def test_the_same_bits_again() -> None:
    mesh = sb.Mesh(*meshes.double_torus())
    sources = random_points(mesh, 3)
    assert sb.exact_distances(mesh, sources).tobytes() == sb.exact_distances(mesh, sources).tobytes()
    assert sb.exact_distances(mesh, sources).tobytes() == np.array(sb.ExactField(mesh, sources).distances).tobytes()


def test_a_field_keeps_its_mesh_alive_and_its_arrays_are_views() -> None:
    field = sb.ExactField(sb.Mesh(*meshes.torus()), [0])
    assert np.isfinite(field.distances).all()
    assert not field.distances.flags.writeable
    assert not field.nearest.flags.writeable
    assert field.nbytes > 36 * field.window_count / 4
    assert field.path(7).length == pytest.approx(field.distances[7])


@pytest.mark.parametrize("measure", [sb.exact_distances, sb.exact_nearest, sb.ExactField])
@pytest.mark.parametrize(
    ("sources", "words"),
    [
        ([], "sources: wanted at least one source, got none"),
        ([99], "sources: vertex 99 at .0. is out of range"),
        ([0, -1], "-1"),
        ([0.5], "sources"),
        (sb.SurfacePoints([500], [[1, 0, 0]]), "500"),
    ],
)
def test_bad_sources(measure: object, sources: object, words: str) -> None:
    with pytest.raises(sb.InputError, match=words):
        measure(sb.Mesh(*meshes.cube()), sources)  # type: ignore[operator]


@pytest.mark.parametrize("limit", [-1.0, float("nan"), "far"])
def test_bad_limits(limit: object) -> None:
    mesh = sb.Mesh(*meshes.cube())
    with pytest.raises(sb.InputError, match="limit"):
        sb.exact_distances(mesh, [0], limit)  # type: ignore[arg-type]
    with pytest.raises(sb.InputError, match="limit"):
        sb.exact_nearest(mesh, [0], limit)  # type: ignore[arg-type]


def test_bad_targets() -> None:
    field = sb.ExactField(sb.Mesh(*meshes.cube()), [0])
    with pytest.raises(sb.InputError, match="points: vertex 8"):
        field.distance_to([8])
    with pytest.raises(sb.InputError, match="target: wanted one point, got 2"):
        field.path([1, 2])  # type: ignore[arg-type]
    with pytest.raises(sb.InputError, match="targets"):
        field.paths([0.5])


def test_progress_rises_and_cancel_is_quick() -> None:
    mesh = sb.Mesh(*meshes.icosphere(6))
    for share in (0.05, 0.5):
        check_progress_and_cancel(lambda job: sb.exact_distances(mesh, [0], job=job), share)

# SPDX-License-Identifier: MIT
"""Paths: as long as the distance, on the surface, straight in faces and over edges, legal at saddles."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes

Floats = NDArray[np.float64]


def graph_of(case: meshes.Case, k: int = 30) -> sb.SaddleVertexGraph:
    return sb.SaddleVertexGraph(case.mesh, k=min(k, case.mesh.vertex_count))


def polyline_length(points: Floats) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def vertices_of(mesh: sb.Mesh, surface: sb.SurfacePoints) -> NDArray[np.int32]:
    """The vertex that each point is exactly at, -1 for the others."""
    corner = surface.barycentric.argmax(axis=1)
    is_vertex = surface.barycentric.max(axis=1) == 1
    return np.where(is_vertex, mesh.triangles[surface.faces, corner], -1).astype(np.int32)


def side_angles(mesh: sb.Mesh, vertex: int, before: Floats, after: Floats) -> tuple[float, float]:
    """Surface angles left and right of a path through a vertex; inf for a side that crosses the boundary."""
    ring = np.argwhere(mesh.triangles == vertex)
    following = {int(mesh.triangles[f, (c + 1) % 3]): int(mesh.triangles[f, (c + 2) % 3]) for f, c in ring}
    starts = sorted(set(following) - set(following.values())) or [min(following)]
    order, where = [starts[0]], {}
    while order[-1] in following and (len(order) == 1 or order[-1] != order[0]):
        order.append(following[order[-1]])
    angle = 0.0
    for first, second in itertools.pairwise(order):
        a, b = (mesh.vertices[v] - mesh.vertices[vertex] for v in (first, second))
        corner = between(a, b)
        for name, point in (("before", before), ("after", after)):
            p = point - mesh.vertices[vertex]
            if between(a, p) + between(p, b) <= corner + 1e-7:
                where.setdefault(name, angle + between(a, p))
        angle += corner
    turn = where["before"] - where["after"]
    if len(starts) and order[0] != order[-1]:
        return (turn, np.inf) if turn >= 0 else (np.inf, -turn)
    left = turn % angle
    return left, angle - left


def between(a: Floats, b: Floats) -> float:
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))


def assert_straight(mesh: sb.Mesh, path: sb.GeodesicPath, legal: bool) -> None:
    """Straight where it crosses edges; a legal path has at least pi on either side of every vertex."""
    at = vertices_of(mesh, path.surface)
    for i in range(1, len(path.points) - 1):
        before, here, after = path.points[i - 1 : i + 2]
        step = min(np.linalg.norm(after - here), np.linalg.norm(here - before))
        if step < 1e-9:  # a vertex passed by no more than rounding: no direction to speak of
            continue
        tolerance = 1e-9 + 1e-13 / step  # directions are as good as points are
        if at[i] >= 0:
            if legal:
                assert min(side_angles(mesh, int(at[i]), before, after)) >= np.pi - tolerance
            continue
        weights = path.surface.barycentric[i]
        along = np.diff(mesh.vertices[mesh.triangles[path.surface.faces[i]]][weights > 0], axis=0)[0]
        assert between(after - here, along) == pytest.approx(between(here - before, along), abs=tolerance)


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_a_path_is_as_long_as_the_distance(case: meshes.Case) -> None:
    graph = graph_of(case)
    targets = np.arange(case.mesh.vertex_count, dtype=np.int32)
    distance = graph.distances([0])
    paths = graph.paths([0], targets)
    assert len(paths) == len(targets)
    for target, path in zip(targets, paths, strict=True):
        if np.isinf(distance[target]):
            assert np.isinf(path.length) and len(path.points) == 0 and paths.sources[target] == -1
            continue
        assert path.length == pytest.approx(distance[target], rel=1e-9)
        assert polyline_length(path.points) == pytest.approx(path.length, rel=1e-9)
        assert np.allclose(path.points[[0, -1]], case.mesh.vertices[[0, target]], atol=1e-15)
        assert np.allclose(path.surface.positions(case.mesh), path.points, atol=1e-14)
        if len(path.points) > 1:
            assert sb.SurfaceCurve(case.mesh, path.surface).length == pytest.approx(path.length, rel=1e-9)


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_paths_of_a_graph_of_given_accuracy(case: meshes.Case) -> None:
    graph = sb.SaddleVertexGraph(case.mesh, accuracy=5e-3)
    targets = np.arange(0, case.mesh.vertex_count, 1 + case.mesh.vertex_count // 80, dtype=np.int32)
    distance = graph.distances([0])[targets]
    for shorten in (False, True):
        for length, path in zip(distance, graph.paths([0], targets, shorten), strict=True):
            if np.isinf(length):
                continue
            assert path.length <= length * (1 + 1e-9)
            assert shorten or path.length >= length * (1 - 1e-9)
            assert_straight(case.mesh, path, legal=shorten)


@pytest.mark.parametrize("case", meshes.good(), ids=str)
@pytest.mark.parametrize("shorten", [False, True])
def test_paths_are_straight_and_shortened_ones_legal(case: meshes.Case, shorten: bool) -> None:
    mesh, graph = case.mesh, graph_of(case)
    targets = np.arange(0, mesh.vertex_count, 1 + mesh.vertex_count // 60, dtype=np.int32)
    for path in graph.paths([0], targets, shorten):
        assert_straight(mesh, path, legal=shorten)


@pytest.mark.parametrize("case", [c for c in meshes.good() if c.name in ("saddle", "holes", "two_components")], ids=str)
def test_paths_of_the_exact_graph_are_legal(case: meshes.Case) -> None:
    graph = graph_of(case, case.mesh.vertex_count)
    for path in graph.paths([0], np.arange(0, case.mesh.vertex_count, 3, dtype=np.int32)):
        if np.isfinite(path.length):
            assert_straight(case.mesh, path, legal=True)


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_shortening_never_lengthens_and_keeps_the_ends(case: meshes.Case) -> None:
    graph = graph_of(case, 12)
    sources = sb.sample(case.mesh, 3, seed=2)
    targets = sb.sample(case.mesh, 40, seed=3)
    plain, short = graph.paths(sources, targets), graph.paths(sources, targets, shorten=True)
    assert (short.sources == plain.sources).all()
    for before, after in zip(plain, short, strict=True):
        if np.isinf(before.length):
            continue
        assert after.length <= before.length * (1 + 1e-12)
        assert polyline_length(after.points) == pytest.approx(after.length, rel=1e-9)
        assert np.allclose(after.points[[0, -1]], before.points[[0, -1]], atol=1e-14)
        if len(after.points) > 1 and after.length > 0:
            sb.SurfaceCurve(case.mesh, after.surface)


@pytest.mark.parametrize("k", [3, 8, 20])
def test_shortened_paths_on_the_plane_are_straight_lines(k: int) -> None:
    """Also where they run through vertices or along edges exactly."""
    for arrays in (meshes.grid(15, 15), meshes.grid(15, 15, jitter=0.3, seed=4), meshes.needles(4, 60)):
        mesh = sb.Mesh(*arrays)
        graph = sb.SaddleVertexGraph(mesh, k=k)
        paths = graph.paths([17], np.arange(mesh.vertex_count, dtype=np.int32), shorten=True)
        direct = np.linalg.norm(mesh.vertices - mesh.vertices[17], axis=1)
        assert np.allclose(paths.lengths, direct, rtol=1e-12, atol=1e-15)


def test_shortened_paths_bend_round_holes_only() -> None:
    mesh = sb.Mesh(*meshes.holes())
    exact = sb.SaddleVertexGraph(mesh, k=mesh.vertex_count).distances([0])
    paths = sb.SaddleVertexGraph(mesh, k=10).paths([0], np.arange(mesh.vertex_count, dtype=np.int32), shorten=True)
    assert (paths.lengths >= exact * (1 - 1e-9)).all()
    assert np.median(paths.lengths / np.maximum(exact, 1e-9)) == pytest.approx(1, abs=1e-9)


def test_shortened_paths_on_a_cylinder_and_over_a_cube() -> None:
    cube = sb.Mesh(*meshes.cube())
    corner = {tuple(v): i for i, v in enumerate(cube.vertices.tolist())}
    path = sb.SaddleVertexGraph(cube, k=3).path(corner[0, 0, 0], corner[1, 1, 1], shorten=True)
    assert path.length == pytest.approx(np.sqrt(5), rel=1e-12)
    around, along = 24, 9
    tube = sb.Mesh(*meshes.cylinder(around, along, radius=1, height=2))
    facet = 2 * np.sin(np.pi / around)
    target = 4 * around + 7
    path = sb.SaddleVertexGraph(tube, k=12).path(0, target, shorten=True)
    assert path.length == pytest.approx(np.hypot(7 * facet, 1.0), rel=1e-12)


def test_ends_anywhere_on_the_surface() -> None:
    for case in meshes.good():
        mesh, graph = case.mesh, graph_of(case)
        a = sb.SurfacePoints([0, 0, 0], [[0.2, 0.3, 0.5], [0.5, 0.5, 0], [0, 0.25, 0.75]])
        b = sb.SurfacePoints([0, 0, mesh.face_count // 3], [[0.6, 0.2, 0.2], [0, 0, 1], [0.3, 0, 0.7]])
        for start in a:
            for end in b:
                if mesh.components[mesh.triangles[end.faces[0], 0]] != mesh.components[mesh.triangles[0, 0]]:
                    continue
                path = graph.path(start, end)
                assert np.allclose(path.points[0], start.positions(mesh)[0], atol=1e-15)
                assert np.allclose(path.points[-1], end.positions(mesh)[0], atol=1e-15)
                assert polyline_length(path.points) == pytest.approx(path.length, rel=1e-9)
                direct = float(np.linalg.norm(path.points[0] - path.points[-1]))
                assert path.length >= direct * (1 - 1e-12)
                if end.faces[0] == 0:  # the same face
                    assert path.length == pytest.approx(direct, rel=1e-12)
                assert_straight(mesh, path, legal=False)
                sb.SurfaceCurve(mesh, path.surface)


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_a_path_between_points_that_see_each_other_is_straight_and_as_long_as_their_distance(case: meshes.Case) -> None:
    mesh, graph, rng = case.mesh, graph_of(case), np.random.default_rng(5)
    for _ in range(20):
        start = sb.SurfacePoints([rng.integers(len(mesh.triangles))], [rng.dirichlet([1, 1, 1])])
        line = sb.trace(mesh, start, rng.uniform(0, 6), rng.uniform(0.1, 3) * mesh.mean_edge_length)
        end = line.surface[len(line.surface) - 1 :]
        path = graph.path(start, end)
        assert path.length == pytest.approx(graph.distance(start, end), rel=1e-9)
        assert path.length == pytest.approx(polyline_length(path.points), rel=1e-9)
        if case.name != "needles":  # there an edge is farther than a fan of k vertices reaches
            assert path.length <= line.length * (1 + 1e-8)  # fans are rounded as arcs are
        assert np.allclose(path.points[[0, -1]], line.points[[0, -1]], atol=1e-14)
        assert_straight(mesh, path, legal=False)


def test_of_equal_sources_the_first_is_the_path_s() -> None:
    mesh = sb.Mesh(*meshes.grid())
    graph = sb.SaddleVertexGraph(mesh, k=20)
    for point in (sb.SurfacePoints([7] * 3, [[0.2, 0.3, 0.5]] * 3), np.array([5, 5, 5], dtype=np.int32)):
        targets = sb.SurfacePoints([7, 90, 0], [[0.5, 0.3, 0.2], [0.2, 0.3, 0.5], [1, 0, 0]])
        assert graph.paths(point, targets).sources.tolist() == [0, 0, 0]


def test_a_point_to_itself_is_one_point() -> None:
    mesh = sb.Mesh(*meshes.grid())
    graph = sb.SaddleVertexGraph(mesh, k=12)
    inside = sb.SurfacePoints([7], [[0.2, 0.3, 0.5]])
    for point in (5, inside):
        path = graph.path(point, point)
        assert path.length == 0
        assert len(path.points) == 1


def test_same_bytes_for_any_number_of_threads() -> None:
    mesh = sb.Mesh(*meshes.torus())
    graph = sb.SaddleVertexGraph(mesh, k=20)
    targets = sb.sample(mesh, 300, seed=1)
    one = graph.paths([3, 77], targets, True, threads=1)
    for threads in (2, 8):
        many = graph.paths([3, 77], targets, True, threads=threads)
        assert many.points.tobytes() == one.points.tobytes()
        assert many.lengths.tobytes() == one.lengths.tobytes()
        assert many.surface.barycentric.tobytes() == one.surface.barycentric.tobytes()
        assert many.offsets.tobytes() == one.offsets.tobytes()


def test_a_collection_of_paths_is_a_sequence() -> None:
    mesh = sb.Mesh(*meshes.two_components())
    paths = sb.SaddleVertexGraph(mesh, k=12).paths([0], [0, 5, len(mesh.vertices) - 1])
    assert len(paths) == 3 and paths.offsets.tolist()[-1] == len(paths.points) == len(paths.surface)
    assert paths[-1].length == np.inf and len(paths[-1].surface) == 0
    assert paths.sources.tolist() == [0, 0, -1]
    assert [path.length for path in paths] == paths.lengths.tolist()
    with pytest.raises(IndexError, match="index 3 is out of range for 3 paths"):
        paths[3]
    with pytest.raises(ValueError, match="read-only"):
        paths.points[0, 0] = 1


def test_what_cannot_be_joined_is_refused() -> None:
    mesh = sb.Mesh(*meshes.two_components())
    graph = sb.SaddleVertexGraph(mesh, k=12)
    with pytest.raises(sb.InputError, match="a is on component 0 and b on component 1"):
        graph.path(0, len(mesh.vertices) - 1)
    with pytest.raises(sb.InputError, match="a: wanted one point, got 2"):
        graph.path([0, 1], 2)
    with pytest.raises(sb.InputError, match="b: vertex 9999 at"):
        graph.path(0, 9999)
    with pytest.raises(sb.InputError, match="sources: wanted at least one"):
        graph.paths(np.zeros(0, dtype=np.int32), [1])
    with pytest.raises(sb.InputError, match="threads"):
        graph.paths([0], [1], threads=-1)
    assert len(graph.paths([0], np.zeros(0, dtype=np.int32))) == 0
    job = sb.Job()
    job.cancel()
    with pytest.raises(sb.Cancelled):
        graph.paths([0], [1], job=job)


@pytest.mark.parametrize("radii", [(1e-2, 0.1, 1), (1e-5, 1e-3, 1), (1e-8, 1e-4, 1), (3e-10, 1.7e-5, 1)])
def test_ways_along_edges_are_no_longer_than_they_say(radii: tuple[float, float, float]) -> None:
    """Where a way runs along an edge, it must not be crossed beyond where the way ends."""
    turn = 0.5 * np.pi * np.arange(4)
    rings = np.array(radii)[:, None] * (np.cos(turn) + 1j * np.sin(turn))
    places = np.append(0, rings.ravel())
    triangles = meshes.graded_disk(1e-2, 3, 4)[1]
    mesh = sb.Mesh(np.column_stack([places.real, places.imag, 0 * places.real]), triangles)
    targets = np.arange(mesh.vertex_count, dtype=np.int32)
    for rule in ({"exact": True}, {"accuracy": 5e-3}):
        graph = sb.SaddleVertexGraph(mesh, threads=1, **rule)
        for source in targets:
            for path in graph.paths([source], targets):
                length = np.linalg.norm(np.diff(path.points, axis=0), axis=1).sum()
                assert length == pytest.approx(path.length, rel=1e-9, abs=1e-14)

# SPDX-License-Identifier: MIT
"""Nearest points against brute force over all faces, exact snapping, ties, threads."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes

Floats = NDArray[np.float64]


def brute_force_distance(corners: Floats, query: Floats) -> float:
    """Distance to the nearest of the triangles (F,3,3): the least over all edges and all feet inside."""
    a, b, c = (corners[:, i] - query for i in range(3))
    best = np.inf
    for start, end in ((a, b), (b, c), (c, a)):
        edge = end - start
        share = np.clip(-(start * edge).sum(axis=1) / (edge * edge).sum(axis=1), 0, 1)
        best = min(best, float(np.linalg.norm(start + share[:, None] * edge, axis=1).min()))
    normal = np.cross(b - a, c - a)
    inside = np.ones(len(a), dtype=bool)
    for start, end in ((a, b), (b, c), (c, a)):
        inside &= (normal * np.cross(start, end)).sum(axis=1) >= 0
    heights = np.abs((normal * a).sum(axis=1)) / np.linalg.norm(normal, axis=1)
    return min(best, float(heights[inside].min(initial=np.inf)))


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_no_face_is_nearer(case: meshes.Case) -> None:
    mesh = case.mesh
    rng = np.random.default_rng(5)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    size = float((high - low).max())
    queries = np.concatenate(
        [
            rng.uniform(low - size / 2, high + size / 2, (120, 3)),
            rng.uniform(low - 1e5 * size, high + 1e5 * size, (10, 3)),
            sb.sample(mesh, 40).positions(mesh) + rng.normal(0, 1e-7 * size, (40, 3)),
        ]
    )
    points = sb.project(mesh, queries)
    found = np.linalg.norm(points.positions(mesh) - queries, axis=1)
    corners = mesh.vertices[mesh.triangles]
    for query, distance in zip(queries, found, strict=True):
        assert distance == pytest.approx(brute_force_distance(corners, query), rel=1e-12, abs=1e-14 * size)


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_vertices_and_edges_are_hit_exactly_in_their_smallest_face(case: meshes.Case) -> None:
    mesh = case.mesh
    at_vertices = sb.project(mesh, mesh.vertices)
    assert (np.sort(at_vertices.barycentric, axis=1) == [0, 0, 1]).all()
    assert (at_vertices.positions(mesh) == mesh.vertices).all()
    smallest = np.full(len(mesh.vertices), len(mesh.triangles))
    np.minimum.at(smallest, mesh.triangles.ravel(), np.repeat(np.arange(len(mesh.triangles)), 3))
    assert (at_vertices.faces == smallest).all()

    edges: dict[frozenset[int], int] = {}
    for face, (a, b, c) in enumerate(mesh.triangles.tolist()):
        for pair in ((a, b), (b, c), (c, a)):
            edges.setdefault(frozenset(pair), face)
    ends = np.array([sorted(edge) for edge in edges])
    middles = mesh.vertices[ends].mean(axis=1)
    on_edges = sb.project(mesh, middles)
    assert ((on_edges.barycentric == 0).sum(axis=1) == 1).all()
    assert (on_edges.faces == list(edges.values())).all()


def test_equally_near_faces_give_the_smallest() -> None:
    vertices, triangles = meshes.merge(*[meshes.icosphere(1)] * 3)
    shifted = vertices + np.repeat([[4.0, 0, 0], [-4.0, 0, 0], [0, 4.0, 0]], len(vertices) // 3, axis=0)
    mesh = sb.Mesh(shifted, triangles)
    points = sb.project(mesh, [[0.0, 0.0, 0.0]])
    distances = np.linalg.norm(mesh.vertices, axis=1)
    nearest = np.flatnonzero(distances == distances.min())
    assert points.faces[0] == min(int(np.flatnonzero((triangles == v).any(axis=1))[0]) for v in nearest)


def test_the_answer_does_not_depend_on_threads_order_or_company() -> None:
    mesh = sb.Mesh(*meshes.torus())
    queries = np.random.default_rng(0).normal(size=(5000, 3))
    one = sb.project(mesh, queries, threads=1)
    for threads in (2, 8):
        other = sb.project(mesh, queries, threads=threads)
        assert (one.faces == other.faces).all()
        assert (one.barycentric == other.barycentric).all()
    backwards = sb.project(mesh, queries[::-1])
    assert (backwards.faces[::-1] == one.faces).all()
    assert (backwards.barycentric[::-1] == one.barycentric).all()
    alone = [sb.project(mesh, query[None]) for query in queries[:50]]
    assert [int(point.faces[0]) for point in alone] == one.faces[:50].tolist()


@pytest.mark.parametrize("scale", [1e-50, 1e-6, 1e9, 1e50])
def test_scale_does_not_matter(scale: float) -> None:
    vertices, triangles = meshes.torus()
    queries = np.random.default_rng(1).normal(size=(200, 3))
    plain = sb.project(sb.Mesh(vertices, triangles), queries)
    scaled = sb.project(sb.Mesh(vertices * scale, triangles), queries * scale)
    assert (plain.faces == scaled.faces).mean() > 0.99
    same = plain.faces == scaled.faces
    assert np.abs(plain.barycentric - scaled.barycentric)[same].max() < 1e-9


def test_far_from_the_origin_the_boxes_still_hold_their_faces() -> None:
    vertices, triangles = meshes.icosphere(3)
    mesh = sb.Mesh(vertices * 0.01 + 1e6, triangles)
    queries = mesh.vertices.mean(axis=0) + np.random.default_rng(2).normal(0, 0.02, (60, 3))
    found = np.linalg.norm(sb.project(mesh, queries).positions(mesh) - queries, axis=1)
    corners = mesh.vertices[mesh.triangles]
    wanted = [brute_force_distance(corners, query) for query in queries]
    assert np.allclose(found, wanted, rtol=0, atol=1e-9)


@given(st.lists(st.tuples(*[st.floats(allow_nan=False, allow_infinity=False)] * 3), min_size=1, max_size=8))
def test_every_finite_query_has_an_answer(queries: list[tuple[float, float, float]]) -> None:
    mesh = sb.Mesh(*meshes.needles(2, 20))
    points = sb.project(mesh, queries)
    assert (points.faces >= 0).all() and (points.faces < len(mesh.triangles)).all()
    assert (points.barycentric >= 0).all()
    assert np.allclose(points.barycentric.sum(axis=1), 1)


def test_no_queries_give_no_points() -> None:
    assert len(sb.project(sb.Mesh(*meshes.cube()), np.zeros((0, 3)))) == 0


@pytest.mark.parametrize(
    ("xyz", "sentence"),
    [
        ([[0, 0, 0], [0, np.nan, 0]], r"xyz: value nan at \[1, 1\] is not finite"),
        ([[0, 0, np.inf]], r"xyz: value inf at \[0, 2\] is not finite"),
        ([[0, 0]], r"xyz: wanted shape \(n, 3\)"),
        ([0, 0, 0], r"xyz: wanted shape \(n, 3\)"),
        ("here", "xyz: wanted"),
    ],
)
def test_bad_input_is_named(xyz: object, sentence: str) -> None:
    with pytest.raises(sb.InputError, match=sentence):
        sb.project(sb.Mesh(*meshes.cube()), xyz)  # type: ignore[arg-type]


def test_a_cancelled_job_stops_it() -> None:
    job = sb.Job()
    job.cancel()
    with pytest.raises(sb.Cancelled):
        sb.project(sb.Mesh(*meshes.cube()), np.zeros((10, 3)), job=job)

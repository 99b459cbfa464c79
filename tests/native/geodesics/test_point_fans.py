# SPDX-License-Identifier: MIT
"""Arcs of points inside faces and on edges: found by the rule of the graph's own, and as accurate."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.native.exact import random_points

GOOD = meshes.good()
ROUNDING = 1e-8  # arcs keep 32 bits of a length or fewer


def awkward_points(mesh: sb.Mesh, count: int = 12, seed: int = 3) -> sb.SurfacePoints:
    """Points inside faces, on edges, and so near to edges and vertices that only rounding tells them apart."""
    rng = np.random.default_rng(seed)
    coordinates = rng.dirichlet([1.0, 1.0, 1.0], count)
    special = [
        (0.5, 0.5, 0.0), (0.25, 0.0, 0.75), (1 - 1e-3, 6e-4, 4e-4), (1e-8, 1 - 3e-8, 2e-8),
        (0.3, 0.7 - 1e-12, 1e-12), (1 - 2e-15, 1e-15, 1e-15), (1e-14, 0.0, 1 - 1e-14),
    ]  # fmt: skip
    coordinates[: len(special)] = special
    return sb.SurfacePoints(rng.integers(mesh.face_count, size=count), coordinates)


@pytest.mark.parametrize("accuracy", [2e-2, 2e-3])
@pytest.mark.parametrize("case", [case for case in GOOD if case.components == 1], ids=str)
def test_points_are_as_accurate_as_vertices(case: meshes.Case, accuracy: float) -> None:
    graph = sb.SaddleVertexGraph(case.mesh, accuracy=accuracy)
    points = awkward_points(case.mesh)
    for i in range(len(points)):
        exact = sb.exact_distances(case.mesh, points[i : i + 1])
        found = graph.distances(points[i : i + 1])
        shortest = 1e-11 * exact.max()  # arcs are no shorter
        assert (found >= exact * (1 - ROUNDING) - shortest).all()
        assert (found <= exact * (1 + accuracy) + shortest).all()


@pytest.mark.parametrize("k", [1, 8, 60])
def test_the_k_nearest_of_the_plane_are_at_their_straight_distances(k: int) -> None:
    mesh = sb.Mesh(*meshes.grid(24, 24, 0.2))
    graph = sb.SaddleVertexGraph(mesh, k=k)
    points = awkward_points(mesh)
    straight = np.linalg.norm(mesh.vertices - points.positions(mesh)[:, None], axis=2)
    fields = graph.fields(points)
    nearest = np.argsort(straight, axis=1)[:, :k]
    np.testing.assert_allclose(
        np.take_along_axis(fields, nearest, 1), np.take_along_axis(straight, nearest, 1), rtol=ROUNDING, atol=1e-12
    )


@pytest.mark.parametrize("how", [{"accuracy": 5e-3}, {"k": 30}], ids=str)
def test_what_a_point_sees_depends_on_nothing_but_the_point(how: dict[str, float], tmp_path: Path) -> None:
    """Not on the instructions, the threads, the points found with it, nor on whether the graph comes from a file."""
    mesh = sb.Mesh(*meshes.torus())
    points = random_points(mesh, 30, seed=5)
    graph = sb.SaddleVertexGraph(mesh, **how)
    expected = graph.fields(points, threads=1)
    for i in (0, 11, 29):
        assert np.array_equal(graph.distances(points[i : i + 1]), expected[i])
    assert np.array_equal(graph.fields(points[7:23], threads=3), expected[7:23])
    assert np.array_equal(sb.SaddleVertexGraph(mesh, instructions="plain", **how).fields(points), expected)
    graph.save(tmp_path / "torus.svg")
    assert np.array_equal(sb.SaddleVertexGraph.load(tmp_path / "torus.svg", mesh).fields(points), expected)


def test_points_among_vertices() -> None:
    """Sources of both kinds, in any order: labels are those of the same points alone."""
    mesh = sb.Mesh(*meshes.icosphere(4))
    graph = sb.SaddleVertexGraph(mesh)
    rng = np.random.default_rng(2)
    coordinates = rng.dirichlet([1.0, 1.0, 1.0], 50)
    coordinates[::3] = (0, 1, 0)
    points = sb.SurfacePoints(rng.integers(mesh.face_count, size=50), coordinates)
    distance, source = graph.nearest(points)
    each = graph.fields(points)
    assert np.array_equal(distance, each.min(axis=0))
    assert np.array_equal(source, each.argmin(axis=0))


def test_needles_about_one_vertex_end() -> None:
    """So many faces about a vertex that windows would run for long: they are stopped, each point's on its own."""
    around = 3000
    angle = np.linspace(0, 2 * np.pi, around, endpoint=False)
    rim = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    i = np.arange(around)
    mesh = sb.Mesh(
        np.vstack([[0, 0, 0], rim, 1.5 * rim]),
        np.vstack(
            [
                np.column_stack([0 * i, 1 + i, 1 + (i + 1) % around]),
                np.column_stack([1 + i, 1 + around + i, 1 + (i + 1) % around]),
                np.column_stack([1 + (i + 1) % around, 1 + around + i, 1 + around + (i + 1) % around]),
            ]
        ).astype(np.int32),
    )
    graph = sb.SaddleVertexGraph(mesh, accuracy=2e-2)
    points = random_points(mesh, 9, seed=1)
    fields = graph.fields(points)
    straight = np.linalg.norm(mesh.vertices - points.positions(mesh)[:, None], axis=2)
    assert (fields >= straight * (1 - ROUNDING)).all()
    assert np.array_equal(graph.distances(points[4:5]), fields[4])

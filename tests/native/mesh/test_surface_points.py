# SPDX-License-Identifier: MIT
"""SurfacePoints as a container, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import saddleback as sb
from tests import meshes


@given(st.lists(st.tuples(st.integers(0, 241), st.floats(0, 1), st.floats(0, 1)), max_size=20))
def test_positions_are_the_weighted_corners(rows: list[tuple[int, float, float]]) -> None:
    vertices, triangles = meshes.grid(jitter=0.2)
    mesh = sb.Mesh(vertices, triangles)
    faces = np.array([row[0] for row in rows], dtype=np.int64)
    r = np.sqrt([row[1] for row in rows])
    t = np.array([row[2] for row in rows])
    weights = np.column_stack([1 - r, r * (1 - t), r * t]) if rows else np.zeros((0, 3))
    points = sb.SurfacePoints(faces, weights)
    assert len(points) == len(rows)
    assert points.faces.dtype == np.int32
    assert points.faces.tolist() == faces.tolist()
    assert np.abs(points.barycentric - weights).max(initial=0) < 1e-15
    wanted = (weights[:, :, None] * vertices[triangles[faces]]).sum(axis=1)
    assert np.abs(points.positions(mesh) - wanted).max(initial=0) < 1e-15


def test_it_is_indexed_sliced_and_iterated_like_a_sequence() -> None:
    points = sb.SurfacePoints([4, 5, 6, 7], np.eye(3)[[0, 1, 2, 0]])
    assert points[1].faces.tolist() == [5]
    assert points[-1].faces.tolist() == [7]
    assert points[1:3].faces.tolist() == [5, 6]
    assert points[::-2].faces.tolist() == [7, 5]
    assert points[np.int64(2)].barycentric.tolist() == [[0, 0, 1]]
    assert [len(point) for point in points] == [1, 1, 1, 1]
    assert len(points[2:2]) == 0
    assert points[2:2].faces.shape == (0,)
    assert points[2:2].barycentric.shape == (0, 3)
    for index in (4, -5):
        with pytest.raises(IndexError, match=f"index {index} is out of range for 4 points"):
            points[index]
    assert repr(points) == "<SurfacePoints: 4 points>"
    assert repr(points[0]) == "<SurfacePoints: 1 point>"


def test_its_arrays_are_read_only_views_that_outlive_it() -> None:
    points = sb.SurfacePoints([1, 2], np.array([[1, 0, 0], [0, 0.5, 0.5]]))
    faces, weights = points.faces, points.barycentric
    with pytest.raises(ValueError, match="read-only"):
        faces[0] = 3
    with pytest.raises(ValueError, match="read-only"):
        weights[0] = 0
    del points
    assert faces.tolist() == [1, 2]
    assert weights.tolist() == [[1, 0, 0], [0, 0.5, 0.5]]


def test_float32_rounding_is_removed() -> None:
    weights = np.array([[0.1, 0.2, 0.7], [1 / 3, 1 / 3, 1 / 3]], dtype=np.float32)
    assert np.allclose(sb.SurfacePoints([0, 0], weights).barycentric.sum(axis=1), 1, rtol=0, atol=2e-16)
    assert (sb.SurfacePoints([0], [[1.0, -1e-9, 0.0]]).barycentric == [[1, 0, 0]]).all()


def test_points_that_were_given_out_come_back_to_the_bit() -> None:
    points = sb.sample(sb.Mesh(*meshes.torus(20, 10)), 1000, seed=1)
    moved = sb.centroidal_voronoi(
        sb.SaddleVertexGraph(sb.Mesh(*meshes.torus(20, 10)), k=20), count=100, max_iterations=3
    ).sites
    for out in (points, moved):
        again = sb.SurfacePoints(out.faces, out.barycentric)
        assert again.barycentric.tobytes() == out.barycentric.tobytes()


@pytest.mark.parametrize(
    ("faces", "weights", "sentence"),
    [
        ([0, 1], [[1, 0, 0]], "barycentric: 1 rows, but faces has 2"),
        ([0, -2], [[1, 0, 0]] * 2, r"faces: face -2 at \[1\] is negative"),
        ([0], [[1, 0]], r"barycentric: wanted shape \(n, 3\)"),
        ([0.5], [[1, 0, 0]], "faces: wanted shape"),
        ([[0]], [[1, 0, 0]], "faces: wanted shape"),
        (
            [0, 1],
            [[1, 0, 0], [np.nan, 0, 1]],
            "barycentric: point 1 has barycentric coordinate 0 = nan, which is not finite",
        ),
        ([0], [[np.inf, 0, 0]], "not finite"),
        ([0], [[1.5, -0.5, 0]], "point 0 has barycentric coordinate 1 = -0.5, which is negative"),
        ([0], [[0.5, 0.5, 0.5]], "sum to 1.5 instead of 1"),
        ([2**31], [[1, 0, 0]], "does not fit a 32-bit index"),
        (None, [[1, 0, 0]], "faces: wanted"),
    ],
)
def test_bad_input_is_named(faces: object, weights: object, sentence: str) -> None:
    with pytest.raises(sb.InputError, match=sentence):
        sb.SurfacePoints(faces, weights)  # type: ignore[arg-type]


def test_a_face_beyond_the_mesh_is_named() -> None:
    points = sb.SurfacePoints([0, 700], [[1, 0, 0]] * 2)
    with pytest.raises(sb.InputError, match="point 1 has face 700, but the mesh has 242 faces"):
        points.positions(sb.Mesh(*meshes.grid()))

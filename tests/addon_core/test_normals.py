# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals at surface points."""

import numpy as np

from saddleback_blender.core.surfaces.normals import normals_at, upright_normals
from tests import meshes

OCTAHEDRON = (
    np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float),
    np.array(
        [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]],
        np.int32,
    ),
)


def test_vertex_and_face_normals_of_an_octahedron():
    vertices, triangles = OCTAHEDRON
    faces = np.arange(8, dtype=np.int32)
    centers = normals_at(vertices, triangles, faces, np.full((8, 3), 1 / 3))
    np.testing.assert_allclose(centers, vertices[triangles].sum(axis=1) / np.sqrt(3), atol=1e-12)
    corners = normals_at(vertices, triangles, faces, np.tile([0.0, 1.0, 0.0], (8, 1)))
    np.testing.assert_allclose(corners, vertices[triangles[:, 1]], atol=1e-12)


def test_where_normals_cancel_the_face_decides():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], float)
    both_sides = np.array([[0, 1, 2], [0, 2, 1]], np.int32)
    normals = normals_at(vertices, both_sides, np.array([0, 1], np.int32), np.full((2, 3), 1 / 3))
    np.testing.assert_allclose(normals, [[0, 0, 1], [0, 0, -1]])


def test_what_stands_on_a_large_flat_face_stands_upright_but_not_on_its_edges():
    vertices, triangles = OCTAHEDRON
    faces = np.arange(8, dtype=np.int32)
    weights = np.tile([0.8, 0.15, 0.05], (8, 1))
    flat = vertices[triangles].sum(axis=1) / np.sqrt(3)
    np.testing.assert_allclose(upright_normals(vertices, triangles, faces, weights), flat, atol=1e-12)
    assert ((normals_at(vertices, triangles, faces, weights) * flat).sum(axis=1) < 0.95).all()
    edges = np.tile([0.5, 0.5, 0.0], (8, 1))
    mixed = normals_at(vertices, triangles, faces, edges)
    np.testing.assert_array_equal(upright_normals(vertices, triangles, faces, edges), mixed)


def test_on_small_faces_normals_stay_smooth():
    vertices, triangles = meshes.icosphere(4)
    faces = np.arange(len(triangles), dtype=np.int32)
    weights = np.tile([0.7, 0.2, 0.1], (len(faces), 1))
    smooth = normals_at(vertices, triangles, faces, weights)
    np.testing.assert_array_equal(upright_normals(vertices, triangles, faces, weights), smooth)

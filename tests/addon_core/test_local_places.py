# SPDX-License-Identifier: GPL-3.0-or-later
"""Coordinates within a cell."""

import numpy as np

from saddleback_blender.core.shapes.local_places import _axes, local_uv
from saddleback_blender.core.surfaces.centers import euler_to_normal


def test_axes_are_those_of_the_instances():
    normals = np.random.default_rng(0).normal(size=(50, 3))
    normals = np.concatenate([normals / np.linalg.norm(normals, axis=1)[:, None], [(0, 0, 1), (0, 0, -1), (1, 0, 0)]])
    across, up = _axes(normals)
    for euler, x_axis, y_axis, normal in zip(euler_to_normal(normals), across, up, normals, strict=True):
        (cx, cy, cz), (sx, sy, sz) = np.cos(euler), np.sin(euler)
        turn = (
            np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
            @ np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
            @ np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
        )
        np.testing.assert_allclose(turn, np.column_stack([x_axis, y_axis, normal]), atol=1e-9)


def test_the_site_is_in_the_middle_and_the_farthest_corner_on_the_circle():
    corners = np.array([(0, 0, 0), (4, 0, 0), (0, 2, 0), (10, 10, 0), (11, 10, 0), (10, 11, 0)], float)
    triangles = np.array([(0, 1, 2), (3, 4, 5)], np.int32)
    sites, normals = np.array([(0, 0, 0), (10, 10, 0)], float), np.array([(0, 0, 1), (0, 0, -1)], float)
    places = local_uv(corners, triangles, np.array([0, 1], np.int32), sites, normals)
    expected = [(0.5, 0.5), (1, 0.5), (0.5, 0.75), (0.5, 0.5), (1, 0.5), (0.5, 0)]
    np.testing.assert_allclose(places, expected, atol=1e-12)

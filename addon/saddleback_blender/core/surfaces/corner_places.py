# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the corners of polygons that lie on a surface are, each seen from its own polygon."""

from __future__ import annotations

from typing import Any

import numpy as np

from .. import native
from ..results import Indices, Reals

# Of the way from a corner to the middle of its polygon: so far in, a corner on a seam or between two materials is on
# the side of its polygon.
INWARDS = 1e-3


def corner_places(mesh: Any, vertices: Reals, corners: Indices, offsets: Indices) -> tuple[Indices, Reals]:
    """Faces (m,) of the library's mesh and barycentric places (m, 3) of all corners of polygons, polygon i being
    corners[offsets[i]:offsets[i + 1]] of the vertices (n, 3). O(m log F).
    """
    if not len(corners):
        return np.empty(0, np.int32), np.empty((0, 3))
    counts = np.diff(offsets)
    places = vertices[corners]
    middles = np.add.reduceat(places, offsets[:-1]) / counts[:, None]
    inside = places + INWARDS * (np.repeat(middles, counts, axis=0) - places)
    faces = np.asarray(native.load().project(mesh, inside).faces, np.int32)
    around = mesh.vertices[mesh.triangles[faces]]
    normals = np.cross(around[:, 1] - around[:, 0], around[:, 2] - around[:, 0])
    away = around - places[:, None]
    opposite = np.cross(np.roll(away, -1, axis=1), np.roll(away, -2, axis=1))
    weights = np.maximum(np.einsum("nij,nj->ni", opposite, normals), 0.0)
    return faces, weights / weights.sum(axis=1, keepdims=True)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals of a surface at its points."""

from __future__ import annotations

import numpy as np

from ..results import Indices, Reals


def normals_at(vertices: Reals, triangles: Indices, faces: Indices, barycentric: Reals) -> Reals:
    """(n, 3) unit normals at surface points: vertex normals (area-weighted) mixed as the points lie in their faces.

    Only the faces around the points are looked at. O(F) for finding them, without arithmetic on the rest.
    """
    corners = triangles[faces]
    wanted = np.zeros(len(vertices), bool)
    wanted[corners.ravel()] = True
    near: Indices = triangles[wanted[triangles].any(axis=1)]
    a, b, c = (vertices[near[:, i]] for i in range(3))
    face_normals = np.cross(b - a, c - a)  # length = twice the area, so the sum below is weighted by area
    vertex_normals: Reals = np.stack(
        [np.bincount(near.ravel(), np.repeat(face_normals[:, i], 3), minlength=len(vertices)) for i in range(3)], axis=1
    )
    normals = _unit((barycentric[:, :, None] * _unit(vertex_normals[corners])).sum(axis=1))
    # Where the normals around a point cancel out (a fold, a needle's tip) its own face's normal stands.
    lost = ~normals.any(axis=1)
    if lost.any():
        a, b, c = (vertices[corners[lost, i]] for i in range(3))
        normals[lost] = _unit(np.cross(b - a, c - a))
    return normals


def _unit(vectors: Reals) -> Reals:
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    units: Reals = np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0)
    return units

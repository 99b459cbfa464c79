# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals of a surface at its points."""

from __future__ import annotations

import numpy as np

from ..results import Indices, Reals

FLAT = np.cos(np.radians(8.0))  # a face that leaves the mixed normal by more is seen as flat
ON_EDGE = 1e-6  # barycentric: what is nearer to an edge stands on all the faces there


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


def upright_normals(vertices: Reals, triangles: Indices, faces: Indices, barycentric: Reals) -> Reals:
    """(n, 3) unit normals as `normals_at`, but of the faces themselves where these are so large that it matters.

    What is flat would stand aslant on a face of a cube by its mixed normals, one half of it below the face.
    """
    normals = normals_at(vertices, triangles, faces, barycentric)
    a, b, c = (vertices[triangles[faces, i]] for i in range(3))
    own = _unit(np.cross(b - a, c - a))
    is_flat = own.any(axis=1) & ((own * normals).sum(axis=1) < FLAT) & (barycentric.min(axis=1) > ON_EDGE)
    normals[is_flat] = own[is_flat]
    return normals


def _unit(vectors: Reals) -> Reals:
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    units: Reals = np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0)
    return units

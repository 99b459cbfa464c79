# SPDX-License-Identifier: GPL-3.0-or-later
"""Directions in which a surface is raised: normals that turn slowly, so that neighboring columns do not cross."""

from __future__ import annotations

import numpy as np

from .. import native
from ..progress import Progress
from ..results import Indices, Reals
from .cell_solid import vertex_normals
from .mesh_edges import directed_edges

MOST_SMOOTHING = 200
# The direction and the normal of a triangle may differ by so much: the cosine.
LEAST_COSINE = 0.05


def smooth_directions(
    vertices: Reals, triangles: Indices, thickness: float, progress: Progress, most: int = MOST_SMOOTHING
) -> Reals:
    """Unit normals (n, 3), smoothed over about the thickness, but not turned away from a triangle beside them.

    In so many rounds at `most`. O(t) for each.
    """
    normals = vertex_normals(vertices, triangles)
    progress.check()
    start, end = directed_edges(triangles)
    progress.check()
    mean_edge = float(np.linalg.norm(vertices[end] - vertices[start], axis=1).mean())
    progress.check()
    rounds = int(np.clip(4 * (thickness / mean_edge) ** 2, 1, most))
    with progress.stage(progress.fraction, "smoothing directions") as job:
        smooth: Reals = native.load().smoothed_directions(triangles, normals, rounds, job=job)
    corners = vertices[triangles]
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    face = _unit(face, face)
    progress.check()
    turned = (np.einsum("tij,tj->ti", smooth[triangles], face) < LEAST_COSINE).any(axis=1)
    own = np.zeros(len(vertices), bool)
    own[triangles[turned]] = True
    return np.where(own[:, None], normals, smooth)


def _unit(vectors: Reals, otherwise: Reals) -> Reals:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    unit: Reals = np.where(length > 0, vectors / np.where(length > 0, length, 1.0), otherwise)
    return unit

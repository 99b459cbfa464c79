# SPDX-License-Identifier: GPL-3.0-or-later
"""Directions in which a surface is raised: normals that turn slowly, so that neighboring columns do not cross."""

from __future__ import annotations

import numpy as np

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
    neighbors = Neighbors(triangles, len(vertices), progress)
    smooth = normals
    for _ in range(int(np.clip(4 * (thickness / mean_edge) ** 2, 1, most))):
        progress.check()
        smooth = _unit(0.2 * smooth + neighbors.mean(smooth), normals)
    progress.check()
    corners = vertices[triangles]
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    face = _unit(face, face)
    progress.check()
    turned = (np.einsum("tij,tj->ti", smooth[triangles], face) < LEAST_COSINE).any(axis=1)
    own = np.zeros(len(vertices), bool)
    own[triangles[turned]] = True
    return np.where(own[:, None], normals, smooth)


class Neighbors:
    """Corners of the triangles around each vertex but itself, sorted by vertex: one on two triangles counts twice."""

    def __init__(self, triangles: Indices, count: int, progress: Progress) -> None:
        start, end = directed_edges(triangles)
        progress.check()
        both, other = np.concatenate([start, end]), np.concatenate([end, start])
        order = np.argsort(both, kind="stable")
        progress.check()
        self.other = other[order]
        times = np.bincount(both, minlength=count)
        self.used = np.flatnonzero(times)
        self.times = times[self.used]
        self.first = (np.cumsum(times) - times)[self.used]
        self.count = count

    def mean(self, values: Reals) -> Reals:
        """Mean (n, k) of the neighbors' values; zero where there are none."""
        means = np.zeros((self.count, values.shape[1]))
        for axis in range(values.shape[1]):
            means[self.used, axis] = np.add.reduceat(values[:, axis][self.other], self.first) / self.times
        return means


def _unit(vectors: Reals, otherwise: Reals) -> Reals:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    unit: Reals = np.where(length > 0, vectors / np.where(length > 0, length, 1.0), otherwise)
    return unit

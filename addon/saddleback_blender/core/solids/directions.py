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
    neighbors = Neighbors(triangles, len(vertices))
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
    """Corners of the triangles around each vertex but itself: one on two triangles counts twice."""

    def __init__(self, triangles: Indices, count: int) -> None:
        self.start, self.end = (ends.astype(np.intp) for ends in directed_edges(triangles))  # as numpy counts
        self.count = count
        self.times = np.maximum(np.bincount(self.start, minlength=count) + np.bincount(self.end, minlength=count), 1)

    def mean(self, values: Reals) -> Reals:
        """Mean (n, k) of the neighbors' values; zero where there are none. O(t)."""
        return np.column_stack([self._mean(np.ascontiguousarray(column)) for column in values.T])

    def _mean(self, values: Reals) -> Reals:
        ways = ((self.start, self.end), (self.end, self.start))
        sums = (np.bincount(to, values.take(of), minlength=self.count) for to, of in ways)
        mean: Reals = sum(sums) / self.times
        return mean


def _unit(vectors: Reals, otherwise: Reals) -> Reals:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    unit: Reals = np.where(length > 0, vectors / np.where(length > 0, length, 1.0), otherwise)
    return unit

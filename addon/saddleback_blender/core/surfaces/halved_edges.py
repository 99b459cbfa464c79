# SPDX-License-Identifier: GPL-3.0-or-later
"""A surface with every edge halved, some times: for what is not linear over its faces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..results import Indices, Reals


@dataclass(frozen=True)
class HalvedEdges:
    """Vertices, those of the surface first, and triangles; where vertices are on the surface's triangles."""

    vertices: Reals
    triangles: Indices
    parent: Indices  # (t,) the surface's triangle that a triangle is part of
    faces: Indices  # (v,)
    barycentric: Reals  # (v, 3)

    @classmethod
    def of(cls, vertices: Reals, triangles: Indices, times: int) -> HalvedEdges:
        """Every triangle in four, as often as that. O(4^times F)."""
        count, parent = len(vertices), np.arange(len(triangles), dtype=np.int32)
        weights = np.tile(np.eye(3), (len(triangles), 1, 1))  # of the corners
        made = triangles
        for _ in range(times):
            ends = np.stack([made, np.roll(made, -1, axis=1)], axis=2)
            keys = ends.min(axis=2).astype(np.int64) * count + ends.max(axis=2)
            number, middle = np.unique(keys, return_inverse=True)
            middle = (count + middle.reshape(-1, 3)).astype(np.int32)
            count += len(number)
            a, b, c = made.T
            ab, bc, ca = middle.T
            parts = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
            made = np.concatenate([np.stack(part, axis=1) for part in parts])
            half = 0.5 * (weights + np.roll(weights, -1, axis=1))
            wa, wb, wc = weights.transpose(1, 0, 2)
            wab, wbc, wca = half.transpose(1, 0, 2)
            halves = ((wa, wab, wca), (wab, wb, wbc), (wca, wbc, wc), (wab, wbc, wca))
            weights = np.concatenate([np.stack(part, axis=1) for part in halves])
            parent = np.tile(parent, 4)
        faces, barycentric = np.zeros(count, np.int32), np.zeros((count, 3))
        faces[made.ravel()] = np.repeat(parent, 3)
        barycentric[made.ravel()] = weights.reshape(-1, 3)
        places = np.einsum("vi,vij->vj", barycentric, vertices[triangles[faces]])
        places[: len(vertices)] = vertices
        return cls(places, made, parent, faces, barycentric)

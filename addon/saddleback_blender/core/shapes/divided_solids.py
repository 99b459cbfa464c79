# SPDX-License-Identifier: GPL-3.0-or-later
"""Cuts faces along a grid, so that they can be bent."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..progress import Progress
from ..results import Indices, Reals
from .shape_templates import Solid

ON_LINE = 1e-6  # of the distance of two lines: vertices nearer to one are on it


def divided(solid: Solid, steps: tuple[float, float], progress: Progress) -> Solid:
    """The solid with its faces cut along lines in x and y, `steps` apart; polygons that no line crosses stay whole."""
    parts = _Parts(solid)
    for axis, step in enumerate(steps):
        low, high = solid.vertices[:, axis].min(), solid.vertices[:, axis].max()
        count = max(round((high - low) / step), 1)
        for level in np.linspace(low, high, count + 1)[1:-1]:
            progress.check()
            parts.cut(axis, float(level), ON_LINE * step)
    return parts.joined()


class _Parts:
    """The triangles of a solid while they are cut."""

    def __init__(self, solid: Solid) -> None:
        self._solid = solid
        self._vertices = solid.vertices
        parted = solid.parted()
        self._triangles: Indices = solid.corners[parted]
        self._uv: Reals = solid.uv[parted]
        self._polygon = np.searchsorted(solid.offsets, parted[:, 0], "right") - 1
        self._is_whole = np.ones(len(solid.offsets) - 1, bool)

    def cut(self, axis: int, level: float, tolerance: float) -> None:
        """Cuts all triangles along a line. O(n log n)."""
        heights = self._vertices[:, axis] - level
        heights[np.abs(heights) < tolerance] = 0.0
        crossed = self._crossed(heights)
        if not crossed.any():
            return
        row, side = np.nonzero(crossed)
        self._is_whole[self._polygon[row]] = False
        ends = np.stack([self._triangles[row, side], self._triangles[row, (side + 1) % 3]], axis=1)
        edges = np.unique(np.sort(ends, axis=1), axis=0)
        share = heights[edges[:, 0]] / (heights[edges[:, 0]] - heights[edges[:, 1]])
        low, high = self._vertices[edges[:, 0]], self._vertices[edges[:, 1]]
        first = len(self._vertices)
        keys = edges[:, 0].astype(np.int64) * first + edges[:, 1]
        self._vertices = np.concatenate([self._vertices, low + share[:, None] * (high - low)])
        heights = np.concatenate([heights, np.zeros(len(edges))])
        for _ in range(2):  # a line crosses two sides of a triangle at most
            self._split(heights, keys, first)

    def _crossed(self, heights: Reals) -> NDArray[np.bool_]:
        """(t, 3) whether the ends of the side that begins at a corner are on both sides of the line."""
        signs = np.sign(heights)[self._triangles]
        found: NDArray[np.bool_] = signs * np.roll(signs, -1, axis=1) < 0
        return found

    def _split(self, heights: Reals, keys: NDArray[np.int64], first: int) -> None:
        """Cuts each triangle that is crossed in two, from the middle of one crossed side to the corner opposite."""
        crossed = self._crossed(heights)
        rows = np.flatnonzero(crossed.any(axis=1))
        turn = (crossed[rows].argmax(axis=1)[:, None] + np.arange(3)) % 3
        a, b, c = np.take_along_axis(self._triangles[rows], turn, axis=1).T
        uv = np.take_along_axis(self._uv[rows], turn[:, :, None], axis=1)
        key = np.minimum(a, b).astype(np.int64) * first + np.maximum(a, b)
        middle = (first + np.searchsorted(keys, key)).astype(np.int32)
        share = heights[a] / (heights[a] - heights[b])
        uv_middle = uv[:, 0] + share[:, None] * (uv[:, 1] - uv[:, 0])
        self._triangles[rows] = np.stack([a, middle, c], axis=1)
        self._uv[rows] = np.stack([uv[:, 0], uv_middle, uv[:, 2]], axis=1)
        self._triangles = np.concatenate([self._triangles, np.stack([middle, b, c], axis=1)])
        self._uv = np.concatenate([self._uv, np.stack([uv_middle, uv[:, 1], uv[:, 2]], axis=1)])
        self._polygon = np.concatenate([self._polygon, self._polygon[rows]])

    def joined(self) -> Solid:
        """The polygons that are whole, and then the triangles of the others."""
        solid = self._solid
        sizes = np.diff(solid.offsets)
        kept = np.repeat(self._is_whole, sizes)
        cut = ~self._is_whole[self._polygon]
        of_cut = self._polygon[cut]
        new_sizes = np.concatenate([sizes[self._is_whole], np.full(len(of_cut), 3)])
        return replace(
            solid,
            vertices=self._vertices,
            corners=np.concatenate([solid.corners[kept], self._triangles[cut].ravel()]).astype(np.int32),
            offsets=np.concatenate([[0], np.cumsum(new_sizes)]).astype(np.int32),
            uv=np.concatenate([solid.uv[kept], self._uv[cut].reshape(-1, 2)]),
            smooth=np.concatenate([solid.smooth[self._is_whole], solid.smooth[of_cut]]),
            material=np.concatenate([solid.material[self._is_whole], solid.material[of_cut]]),
            triangles=None,
        )

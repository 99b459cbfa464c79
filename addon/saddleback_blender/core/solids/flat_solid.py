# SPDX-License-Identifier: GPL-3.0-or-later
"""Cells of a flat mesh with gaps, raised, with sloping rims: exact polygons, whatever the mesh's triangles."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..results import CellPolygons, Indices, Reals
from ..surfaces.plane_frame import PlaneFrame
from .cell_mesh import CellShape


def raised_cells(
    base: Any, plateau: Any | None, frame: PlaneFrame, shape: CellShape, count: int | None = None
) -> CellPolygons:
    """Walls or rims from the cells' feet up to their tops, by two ClippedCells of the library.

    `base`: where cells begin, half the gap from their edges. `plateau`: where their tops begin, an inset farther in;
    None for upright walls. Loops must be outlines: no cell lies around a hole. A cell too narrow for a plateau ends in
    a point, lower in proportion. Each loop is an island of its own. Of cells with rims the first `count` are made.
    """
    build = _Polygons(frame, shape)
    tops = _loops(plateau) if plateau is not None else {}
    if plateau is None:
        build.add_boxes(base.points, base.loop_offsets, base.loop_sites)
        return build.done()
    for site, loops in _loops(base).items():
        if count is not None and site >= count:
            continue
        for loop in loops:
            mine = tops.get(site, [])
            ring = None
            if len(loops) == 1 and len(mine) <= 1:
                ring = _slope(loop, mine[0] if mine else None, shape)
            if ring is None:  # a cell that the border cuts into odd parts: upright
                build.add_boxes(loop, np.array([0, len(loop)]), np.array([site], np.int32))
            else:
                build.add_sloped(loop, *ring, site)
    return build.done()


def _loops(clipped: Any) -> dict[int, list[Reals]]:
    found: dict[int, list[Reals]] = {}
    offsets = clipped.loop_offsets
    for number, site in enumerate(clipped.loop_sites.tolist()):
        found.setdefault(site, []).append(clipped.points[offsets[number] : offsets[number + 1]])
    return found


def _slope(foot: Reals, top: Reals | None, shape: CellShape) -> tuple[Reals, Reals, Indices] | None:
    """Top corners (m, 2), their heights (m,), and triangles of the rim: foot corners count first, then top corners.

    None where the foot is not seen whole from the middle of the top.
    """
    if top is None:
        center = _center(foot)
        sides = np.roll(foot, -1, axis=0) - foot
        away = (sides[:, 0] * (center - foot)[:, 1] - sides[:, 1] * (center - foot)[:, 0]) / np.hypot(*sides.T)
        top = center[None]
        heights = np.array([shape.thickness * min(1.0, max(0.0, float(away.min()) / shape.inset))])
        number = np.arange(len(foot), dtype=np.int32)
        triangles = np.column_stack([number, np.roll(number, -1), np.full(len(foot), len(foot), np.int32)])
    else:
        heights = np.full(len(top), shape.thickness)
        triangles = _zipped(foot, top, _center(top))
    corners = np.concatenate([foot, top])[triangles]
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    turn = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    if turn.min() < -1e-9 * float(np.ptp(foot, axis=0).max()) ** 2:
        return None
    return top, heights, triangles


def _zipped(foot: Reals, top: Reals, center: Reals) -> Indices:
    """Triangles between two loops about a point, in the order of their corners' directions from there."""
    outer, inner = _by_direction(foot, center), _by_direction(top, center)
    n, m = len(foot), len(top)
    triangles = []
    i = j = 0
    while i < n or j < m:
        here, there = outer[0][i % n], len(foot) + inner[0][j % m]
        onward = outer[1][(i + 1) % n] + (2 * np.pi if i + 1 >= n else 0.0)
        beyond = inner[1][(j + 1) % m] + (2 * np.pi if j + 1 >= m else 0.0)
        if j == m or (i < n and onward <= beyond):
            triangles.append((here, outer[0][(i + 1) % n], there))
            i += 1
        else:
            triangles.append((here, len(foot) + inner[0][(j + 1) % m], there))
            j += 1
    return np.array(triangles, np.int32)


def _by_direction(loop: Reals, center: Reals) -> tuple[list[int], list[float]]:
    """Numbers of the corners and their angles, beginning with the least."""
    angle = np.arctan2(*(loop - center).T[::-1])
    order = np.roll(np.arange(len(loop)), -int(angle.argmin()))
    return order.tolist(), angle[order].tolist()


def _center(loop: Reals) -> Reals:
    """Center of mass of a polygon."""
    from_first = loop - loop[0]
    onward = np.roll(from_first, -1, axis=0)
    cross = from_first[:, 0] * onward[:, 1] - from_first[:, 1] * onward[:, 0]
    center: Reals = loop[0] + (cross[:, None] * (from_first + onward)).sum(axis=0) / (3 * cross.sum())
    return center


class _Polygons:
    """Collects polygons and their vertices."""

    def __init__(self, frame: PlaneFrame, shape: CellShape) -> None:
        self._frame, self._shape = frame, shape
        self._vertices: list[Reals] = []
        self._corners: list[Indices] = []
        self._counts: list[Indices] = []
        self._cells: list[Indices] = []
        self._size = 0

    def add_boxes(self, points: Reals, offsets: Indices, cells: Indices) -> None:
        """Tops, walls and, where wanted, undersides of loops."""
        count, sizes = len(points), np.diff(offsets)
        foot = self._add(points, np.zeros(count)) + np.arange(count)
        top = self._add(points, np.full(count, self._shape.thickness)) + np.arange(count)
        onward = np.arange(1, count + 1)
        onward[offsets[1:] - 1] = offsets[:-1]
        self._put(top, sizes, cells)
        walls = np.column_stack([foot, foot[onward], top[onward], top])
        self._put(walls.ravel(), np.full(count, 4), np.repeat(cells, sizes))
        if self._shape.underside:
            back = np.repeat(offsets[:-1] + offsets[1:] - 1, sizes) - np.arange(count)
            self._put(foot[back], sizes, cells)

    def add_sloped(self, foot: Reals, top: Reals, heights: Reals, triangles: Indices, site: int) -> None:
        """A rim, the plateau within it and, where wanted, the underside of one loop."""
        first = self._add(np.concatenate([foot, top]), np.concatenate([np.zeros(len(foot)), heights]))
        self._put(first + triangles.ravel(), np.full(len(triangles), 3), np.full(len(triangles), site))
        if len(top) > 2:
            self._put(first + len(foot) + np.arange(len(top)), np.array([len(top)]), np.array([site]))
        if self._shape.underside:
            self._put(first + np.arange(len(foot))[::-1], np.array([len(foot)]), np.array([site]))

    def done(self) -> CellPolygons:
        """All of them."""
        counts = np.concatenate([np.zeros(1, np.int64), *self._counts])
        return CellPolygons(
            vertices=np.concatenate([np.empty((0, 3)), *self._vertices]),
            corners=np.concatenate([np.empty(0, np.int32), *self._corners]).astype(np.int32),
            offsets=np.cumsum(counts).astype(np.int32),
            polygon_cell=np.concatenate([np.empty(0, np.int32), *self._cells]).astype(np.int32),
        )

    def _add(self, places: Reals, heights: Reals) -> int:
        first = self._size
        self._vertices.append(self._frame.to_space(places) + heights[:, None] * self._frame.axes[2])
        self._size += len(places)
        return first

    def _put(self, corners: Any, counts: Any, cells: Any) -> None:
        self._corners.append(corners)
        self._counts.append(counts)
        self._cells.append(cells)

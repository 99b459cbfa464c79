# SPDX-License-Identifier: GPL-3.0-or-later
"""Clipped cells of the plane as one polygon mesh: equal corners become one vertex, sides become edges."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..results import FlatCells, Indices, Reals
from ..surfaces.plane_frame import PlaneFrame

# Corners nearer than this part of the extent are one: neighbors at the border compute theirs each for themselves.
SAME_CORNER = 2.0**-30


def flat_cells(clipped: Any, frame: PlaneFrame) -> FlatCells:
    """The library's ClippedCells -> polygons and edges in space. O(n log n)."""
    points, offsets, sites = clipped.points, clipped.loop_offsets, clipped.loop_sites
    vertices, corners = _welded(points)
    loop = np.repeat(np.arange(len(sites), dtype=np.int32), np.diff(offsets))
    onward = np.arange(1, len(corners) + 1)
    onward[offsets[1:] - 1] = offsets[:-1]
    is_side = corners != corners[onward]  # a side of no length goes, and the loop's corner with it
    turns = np.bincount(loop, _cross(points, points[onward]), minlength=len(sites))
    corners, loop, ends = corners[is_side], loop[is_side], corners[onward][is_side]
    counts = np.bincount(loop, minlength=len(sites))
    alive = counts >= 3
    kept = alive[loop]
    corners, ends, cells = corners[kept], ends[kept], sites[loop[kept]]
    edges, edge_cells = _edges(corners, ends, cells, len(vertices))
    return FlatCells(
        vertices=frame.to_space(vertices),
        corners=corners,
        offsets=np.concatenate([[0], np.cumsum(counts[alive])]).astype(np.int32),
        polygon_cell=sites[alive],
        edges=edges,
        edge_cells=edge_cells,
        has_holes=bool((turns[alive] < 0).any()),
    )


def _cross(a: Reals, b: Reals) -> Reals:
    cross: Reals = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return cross


def _welded(points: Reals) -> tuple[Reals, Indices]:
    """Different places (n, 2), and the number (m,) of each point's. One number for both coordinates sorts fast."""
    if not len(points):
        return points, np.empty(0, np.int32)
    low = points.min(axis=0)
    step = max(float(np.ptp(points, axis=0).max()), np.finfo(np.float64).tiny) * SAME_CORNER
    cells = np.rint((points - low) / step).astype(np.int64)
    _, first, number = np.unique(cells[:, 0] << 31 | cells[:, 1], return_index=True, return_inverse=True)
    return points[first], number.ravel().astype(np.int32)


def _edges(starts: Indices, ends: Indices, cells: Indices, vertex_count: int) -> tuple[Indices, Indices]:
    """Each edge once, in the direction in which the cell of its left side goes round."""
    low, high = np.minimum(starts, ends).astype(np.int64), np.maximum(starts, ends).astype(np.int64)
    _, first, number = np.unique(low * vertex_count + high, return_index=True, return_inverse=True)
    number = number.ravel()
    right = np.full(len(first), -1, np.int32)
    second = np.ones(len(starts), bool)
    second[first] = False
    right[number[second]] = cells[second]
    edges = np.column_stack([starts[first], ends[first]]).astype(np.int32)
    return edges, np.column_stack([cells[first], right]).astype(np.int32)

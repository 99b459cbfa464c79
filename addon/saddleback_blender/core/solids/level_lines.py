# SPDX-License-Identifier: GPL-3.0-or-later
"""Level lines of a function that is linear over every triangle: the exact ones, as few long polylines.

A vertex exactly on a level counts as below it. So every triangle that a level crosses is crossed along one segment,
whose ends lie on two of its edges; an edge that is crossed passes the line on to the triangle on its other side, until
the line closes or reaches a border.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import BadInputError
from ..settings import DistanceSettings
from .mesh_edges import edge_keys

Reals = NDArray[np.float64]
Indices = NDArray[np.int32]

MOST_LEVELS = 2000  # more lines than that are a gray surface, and would fill the memory


@dataclass(frozen=True)
class LevelLines:
    """Polylines: line i runs through points[offsets[i]:offsets[i + 1]] and, where closed, back to its first point."""

    points: Reals  # (n, 3)
    faces: Indices  # (n,) a triangle that the point lies on
    offsets: Indices  # (m + 1,)
    closed: NDArray[np.bool_]  # (m,)
    level: Reals  # (m,)

    def lines(self) -> list[tuple[slice, bool]]:
        """Returns where each line's points are, and whether it is closed."""
        ends = zip(self.offsets[:-1], self.offsets[1:], self.closed, strict=True)
        return [(slice(int(begin), int(end)), bool(closed)) for begin, end, closed in ends]


def isoline_spacing(settings: DistanceSettings, farthest: float) -> float:
    """The distance from one isoline to the next."""
    return settings.isoline_spacing if settings.isolines_by == "SPACING" else farthest / (settings.isoline_count + 1)


def isoline_levels(settings: DistanceSettings, farthest: float, name: str) -> Reals:
    """The distances (n,) of the isolines, above 0 and below `farthest`.

    Raises BadInputError, which names the object `name`, for more of them than can be looked at.
    """
    spacing = isoline_spacing(settings, farthest)
    if farthest <= 0.0:
        return np.empty(0)
    if spacing * MOST_LEVELS < farthest:
        raise BadInputError(
            f"'{name}': isolines every {spacing:.4g} up to {farthest:.4g} would be more than {MOST_LEVELS:,} lines; "
            f"choose a spacing above {farthest / MOST_LEVELS:.4g}"
        )
    # A level at the farthest point itself is a dot, not a line.
    levels: Reals = spacing * np.arange(1, int(np.ceil(farthest / spacing * (1 - 1e-9))), dtype=np.float64)
    return levels


def level_lines(vertices: Reals, triangles: Indices, values: Reals, levels: Reals) -> LevelLines:
    """Level lines of values (V,) on the triangles (F, 3); nothing where a value is not finite.

    O(F log F + the points). Every line has its higher values on its left.
    """
    finite = np.isfinite(values[triangles]).all(axis=1)
    faces = np.flatnonzero(finite).astype(np.int32)
    corners = triangles[faces]
    lowest, highest = values[corners].min(axis=1), values[corners].max(axis=1)
    order = np.argsort(lowest, kind="stable")
    faces, corners, lowest, highest = faces[order], corners[order], lowest[order], highest[order]
    pieces: list[tuple[Reals, Indices, Indices, NDArray[np.bool_]]] = []
    for level in levels:
        begun = int(np.searchsorted(lowest, level, side="right"))
        crossed = np.flatnonzero(highest[:begun] > level)
        pieces.append(_lines_of_level(vertices, corners[crossed], faces[crossed], values, float(level)))
    return _joined(pieces, levels)


def _lines_of_level(
    vertices: Reals, corners: Indices, faces: Indices, values: Reals, level: float
) -> tuple[Reals, Indices, Indices, NDArray[np.bool_]]:
    """Points, the face of each, the number of points of each line, whether each line is closed."""
    above = values[corners] > level
    rows = np.arange(len(corners))
    # Along its edges 0-1, 1-2, 2-0 a triangle goes up once and down once: with the higher values on the left the line
    # enters where it goes down and leaves where it goes up.
    downward = np.argmax(above & ~above[:, [1, 2, 0]], axis=1)
    upward = np.argmax(~above & above[:, [1, 2, 0]], axis=1)
    enter = np.stack([corners[rows, downward], corners[rows, (downward + 1) % 3]], axis=1)
    leave = np.stack([corners[rows, upward], corners[rows, (upward + 1) % 3]], axis=1)
    sides = np.concatenate([enter, leave])
    keys = edge_keys(sides[:, 0], sides[:, 1], len(vertices))
    unique, node = np.unique(keys, return_inverse=True)
    enter_node, leave_node = np.split(node.ravel(), 2)
    ends = np.stack([unique // len(vertices), unique % len(vertices)], axis=1)
    low, high = values[ends].T
    share = np.clip((level - low) / (high - low), 0.0, 1.0)[:, None]
    places = vertices[ends[:, 0]] * (1.0 - share) + vertices[ends[:, 1]] * share
    face_of = np.empty(len(unique), np.int32)
    face_of[leave_node] = faces
    face_of[enter_node] = faces
    onward = np.full(len(unique), -1, np.int64)
    onward[enter_node] = leave_node
    chain, counts, closed = _chains(onward)
    return places[chain], face_of[chain], counts, closed


def _chains(onward: NDArray[np.int64]) -> tuple[NDArray[np.int64], Indices, NDArray[np.bool_]]:
    """Nodes in the order of their chains, the length of each chain and whether it is a ring; -1 ends a chain."""
    is_first = np.ones(len(onward), bool)
    is_first[onward[onward >= 0]] = False
    following = onward.tolist()
    visited = [False] * len(following)
    chain: list[int] = []
    counts: list[int] = []
    closed: list[bool] = []
    for start in [*np.flatnonzero(is_first).tolist(), *range(len(following))]:
        if visited[start]:
            continue
        before, node = len(chain), start
        while node >= 0 and not visited[node]:
            visited[node] = True
            chain.append(node)
            node = following[node]
        counts.append(len(chain) - before)
        closed.append(node == start)
    return np.array(chain, np.int64), np.array(counts, np.int32), np.array(closed, bool)


def _joined(pieces: list[tuple[Reals, Indices, Indices, NDArray[np.bool_]]], levels: Reals) -> LevelLines:
    """All levels one after another; points on one place are one, and lines that are dots are none."""
    points = np.concatenate([np.empty((0, 3)), *(piece[0] for piece in pieces)])
    faces = np.concatenate([np.empty(0, np.int32), *(piece[1] for piece in pieces)]).astype(np.int32)
    counts = np.concatenate([np.empty(0, np.int32), *(piece[2] for piece in pieces)])
    closed = np.concatenate([np.empty(0, bool), *(piece[3] for piece in pieces)]).astype(bool)
    level = np.repeat(levels, [len(piece[2]) for piece in pieces])
    line = np.repeat(np.arange(len(counts)), counts)
    kept = np.ones(len(points), bool)
    kept[1:] = (line[1:] != line[:-1]) | (points[1:] != points[:-1]).any(axis=1)
    first = np.cumsum(counts) - counts
    last = first + counts - 1
    ring_seam = closed & (counts > 1) & (points[first] == points[last]).all(axis=1) if len(counts) else closed
    kept[last[ring_seam]] = False
    counts = np.bincount(line[kept], minlength=len(counts))
    alive = counts >= np.where(closed, 3, 2)
    kept &= np.repeat(alive, np.bincount(line, minlength=len(alive)))
    offsets = np.concatenate([[0], np.cumsum(counts[alive])]).astype(np.int32)
    return LevelLines(points[kept], faces[kept], offsets, closed[alive], level[alive])

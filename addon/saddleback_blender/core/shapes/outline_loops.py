# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed lines in a plane -> outlines with their holes; and the border of a flat mesh as such lines."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..results import Indices, Reals
from .shape_templates import Parts


def twice_area(loop: Reals) -> float:
    """Positive for a loop (n, 2) that runs counter-clockwise."""
    x, y = (loop - loop[0]).T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())


def parts_of_loops(loops: Sequence[Reals]) -> Parts:
    """Loops within an odd number of others are holes of the smallest of them, as even-odd filling draws it."""
    order = sorted(loops, key=lambda loop: -abs(twice_area(loop)))
    parts: list[list[Reals]] = []
    for number, loop in enumerate(order):
        around = [other for other in order[:number] if _contains(other, loop[0])]
        if len(around) % 2 == 0:
            parts.append([loop])
            continue
        owner = next(part for part in reversed(parts) if part[0] is around[-1] or _contains(part[0], loop[0]))
        owner.append(loop)
    return tuple(tuple(part) for part in parts)


def is_seen_once(places: Reals, triangles: Indices) -> bool:
    """Tells whether all triangles (t, 3) of places (n, 2) lie the same way up and none on its edge."""
    a, b, c = (places[triangles[:, i]] for i in range(3))
    areas = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    return bool((areas > 0).all() or (areas < 0).all())


def border_loops(triangles: Indices) -> list[Indices] | None:
    """The borders of a mesh as rows of its vertices; None where they meet in a vertex or there is none."""
    begin, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    size = int(triangles.max(initial=0)) + 1
    lone = ~np.isin(begin.astype(np.int64) * size + end, end.astype(np.int64) * size + begin)
    onward = dict(zip(begin[lone].tolist(), end[lone].tolist(), strict=True))
    if not onward or len(onward) != int(lone.sum()):
        return None
    loops = []
    while onward:
        first = next(iter(onward))
        loop, here = [first], onward.pop(first)
        while here != first:
            loop.append(here)
            if here not in onward:
                return None
            here = onward.pop(here)
        loops.append(np.array(loop, np.int32))
    return loops


def _contains(loop: Reals, point: Reals) -> bool:
    """Even-odd rule; a point on the loop counts as either."""
    here, onward = loop, np.roll(loop, -1, axis=0)
    is_across = (here[:, 1] > point[1]) != (onward[:, 1] > point[1])
    rise = np.where(is_across, onward[:, 1] - here[:, 1], 1.0)
    x = here[:, 0] + (point[1] - here[:, 1]) / rise * (onward[:, 0] - here[:, 0])
    return bool((is_across & (x > point[0])).sum() % 2)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a surface: a choice of its triangles, as a surface of its own."""

from __future__ import annotations

import numpy as np

from ..results import Indices


def part_at_pinches(triangles: Indices, count: int) -> tuple[Indices, Indices]:
    """Gives a vertex at which parts of the surface meet in nothing but that vertex to each of them.

    A choice of faces of a whole surface is no surface at such a vertex. Returns (F, 3) triangles whose vertices from
    `count` on are new, and (n,) the vertex that each of those is a copy of. O(F log F).
    """
    starts, ends = triangles.ravel(), triangles[:, (1, 2, 0)].ravel()
    keys = np.minimum(starts, ends).astype(np.int64) * count + np.maximum(starts, ends)
    _, inverse, uses = np.unique(keys, return_inverse=True, return_counts=True)
    at_border = uses[inverse.ravel()] == 1
    ways = np.bincount(starts[at_border], minlength=count) + np.bincount(ends[at_border], minlength=count)
    parted = triangles.copy()
    copies: list[int] = []
    around = np.isin(triangles, np.flatnonzero(ways > 2))
    for vertex in np.unique(triangles[around]).tolist():
        rows = np.flatnonzero((triangles == vertex).any(axis=1) & around.any(axis=1))
        for fan in _fans(triangles[rows].tolist(), vertex)[1:]:
            chosen = rows[fan]
            parted[chosen] = np.where(triangles[chosen] == vertex, count + len(copies), parted[chosen])
            copies.append(vertex)
    return parted, np.array(copies, np.int32)


def _fans(triangles: list[list[int]], vertex: int) -> list[list[int]]:
    """Rows of the triangles around a vertex that hang together by edges at it."""
    left, fans = dict(enumerate({*corners} - {vertex} for corners in triangles)), []
    while left:
        row, rim = left.popitem()
        fan = [row]
        while found := [other for other, corners in left.items() if corners & rim]:
            for other in found:
                rim |= left.pop(other)
            fan += found
        fans.append(sorted(fan))
    return sorted(fans)

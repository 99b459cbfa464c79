# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a surface: a choice of its triangles, as a surface of its own, and surfaces parted along barriers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..results import Indices

Longs = NDArray[np.int64]
NO_EDGES: Indices = np.empty((0, 2), np.int32)


def part(triangles: Indices, count: int, barriers: Indices = NO_EDGES) -> tuple[Indices, Indices]:
    """Gives a vertex to each of the parts of a surface that meet in nothing but that vertex.

    A choice of faces of a whole surface is no surface at such a vertex, and barriers (n, 2), edges that nothing
    crosses, make parts of what is beside them. Returns (F, 3) triangles whose vertices from `count` on are new, and
    (n,) the vertex that each of those is a copy of. O(F log F).
    """
    starts, ends = triangles.ravel().astype(np.int64), triangles[:, (1, 2, 0)].ravel().astype(np.int64)
    keys = np.minimum(starts, ends) * count + np.maximum(starts, ends)
    order = np.argsort(keys, kind="stable")
    is_same = keys[order[1:]] == keys[order[:-1]]
    one, other = order[:-1][is_same], order[1:][is_same]
    is_border = np.ones(len(keys), bool)
    is_border[one] = is_border[other] = False
    ways = np.bincount(starts[is_border], minlength=count) + np.bincount(ends[is_border], minlength=count)
    is_met = ways > 2
    is_met[barriers.ravel()] = True
    walls = barriers.astype(np.int64)
    crossed = ~np.isin(keys[one], walls.min(axis=1) * count + walls.max(axis=1))
    labels = _joined(starts, ends, one[crossed], other[crossed], is_met)
    corners = np.flatnonzero(is_met[starts])
    pairs, inverse = np.unique(starts[corners] * len(starts) + labels[corners], return_inverse=True)
    vertex = pairs // len(starts)
    is_copy = np.zeros(len(pairs), bool)
    is_copy[1:] = vertex[1:] == vertex[:-1]
    number = np.where(is_copy, count + np.cumsum(is_copy) - 1, vertex)
    parted = triangles.ravel().copy()
    parted[corners] = number[inverse.ravel()]
    return parted.reshape(-1, 3).astype(np.int32), vertex[is_copy].astype(np.int32)


def _joined(starts: Longs, ends: Longs, one: Longs, other: Longs, is_met: NDArray[np.bool_]) -> Longs:
    """(3 F,) the first of the corners of each vertex in question that hang together over the half-edges given twice."""
    following = np.arange(len(starts)).reshape(-1, 3)[:, (1, 2, 0)].ravel()
    links = []
    for corner, vertex in ((one, starts[one]), (following[one], ends[one])):
        beyond = np.where(starts[other] == vertex, other, following[other])
        links.append(np.column_stack([corner, beyond])[is_met[vertex]])
    a, b = np.concatenate(links).T
    labels = np.arange(len(starts))
    while (labels[a] != labels[b]).any():
        least = np.minimum(labels[a], labels[b])
        np.minimum.at(labels, labels[a], least)  # whole trees at once
        np.minimum.at(labels, labels[b], least)
        labels = labels[labels]
    return labels


def lonely_edge(triangles: Indices, count: int, barriers: Indices) -> tuple[int, int] | None:
    """A barrier that ends within the surface on both sides, and joins no other: nothing would part it."""
    starts, ends = triangles.ravel(), triangles[:, (1, 2, 0)].ravel()
    corners = np.bincount(starts, minlength=count)  # a border vertex has an edge more than corners
    keys = np.unique(np.minimum(starts, ends).astype(np.int64) * count + np.maximum(starts, ends))
    degree = np.bincount(keys // count, minlength=count) + np.bincount(keys % count, minlength=count)
    is_loose = (np.bincount(barriers.ravel(), minlength=count) == 1) & (degree == corners)
    lonely = np.flatnonzero(is_loose[barriers].all(axis=1))
    return (int(barriers[lonely[0], 0]), int(barriers[lonely[0], 1])) if len(lonely) else None

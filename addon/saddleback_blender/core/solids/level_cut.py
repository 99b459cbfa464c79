# SPDX-License-Identifier: GPL-3.0-or-later
"""Cut a triangle mesh along a level line of a function that is linear over every triangle (marching triangles).

A mesh is carried as `fields` (V,k), all the numbers of a vertex side by side (position, normal, the function, ...), so
that a new vertex gets all of them by one interpolation. New vertices are shared by the triangles on both sides of an
edge: a cut never opens a crack.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import native
from .mesh_edges import edge_keys

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Cut:
    """A refined mesh: fields (W,k), triangles (U,3), the triangle each comes from (U,), whether it is above (U,)."""

    fields: Floats
    triangles: Ints
    parent: Ints
    above: Bools


def shared_midpoints(pairs: Ints, vertex_count: int) -> tuple[Ints, Ints]:
    """Number the different edges in pairs (n,2): edges (m,2), lower vertex first, and the edge of each pair (n,)."""
    key, index = np.unique(edge_keys(pairs[:, 0], pairs[:, 1], vertex_count), return_inverse=True)
    edges = np.stack([key // vertex_count, key % vertex_count], axis=1).astype(np.int32)
    return edges, index.astype(np.int32)


def _rotate(triangles: Ints, first: NDArray[np.int64]) -> Ints:
    """Turn each triangle so that corner `first` comes first; the orientation stays."""
    rows = np.arange(len(triangles))[:, None]
    turned: Ints = triangles[rows, (first[:, None] + np.arange(3)) % 3]
    return turned


def cut_at_level(fields: Floats, triangles: Ints, column: int, level: float) -> Cut:
    """Cut all triangles along the line where fields[:, column] equals level.

    fields (V,k), triangles (T,3). A triangle that lies wholly on the level counts as below. O(T).
    """
    return Cut(*native.load().cut_at_level(fields, triangles, column, level))


def _split_quads(fields: Floats, a: Ints, b: Ints, c: Ints, d: Ints) -> tuple[Ints, Ints]:
    """Split quads a b c d into two triangles along the shorter diagonal; positions are the first three fields."""
    ac = np.square(fields[a, :3] - fields[c, :3]).sum(axis=1)
    bd = np.square(fields[b, :3] - fields[d, :3]).sum(axis=1)
    use_ac = (ac <= bd)[:, None]
    first = np.where(use_ac, np.stack([a, b, c], axis=1), np.stack([a, b, d], axis=1))
    second = np.where(use_ac, np.stack([a, c, d], axis=1), np.stack([b, c, d], axis=1))
    return first, second


def split_edges(fields: Floats, triangles: Ints, marked: Bools) -> Cut:
    """Put a vertex in the middle of the marked edges and split the triangles on both sides.

    marked (T,3) says whether the edge from corner i to corner i+1 of a triangle is split; both triangles of an edge
    must agree. Every field of the new vertex is the mean of the two ends. All `above` are False.
    """
    count = marked[:, 0].astype(np.int8) + marked[:, 1] + marked[:, 2]
    rows, sides = np.nonzero(marked)
    pairs = np.stack([triangles[rows, sides], triangles[rows, (sides + 1) % 3]], axis=1)
    edges, edge_of_pair = shared_midpoints(pairs, len(fields))
    added = 0.5 * (fields[edges[:, 0]] + fields[edges[:, 1]])
    middle = np.full(triangles.shape, -1, dtype=np.int32)
    middle[rows, sides] = len(fields) + edge_of_pair
    fields = np.concatenate([fields, added])

    whole = np.flatnonzero(count == 0)
    pieces: list[Ints] = [triangles[whole]]
    parents = [whole]

    def add(parent: NDArray[np.int64], *corners: Ints) -> None:
        pieces.append(np.stack(corners, axis=1))
        parents.append(parent)

    one = np.flatnonzero(count == 1)
    turn = np.argmax(marked[one], axis=1)
    (a, b, c), m = _rotate(triangles[one], turn).T, middle[one, turn]
    add(one, a, m, c)
    add(one, m, b, c)

    two = np.flatnonzero(count == 2)
    turn = (np.argmin(marked[two], axis=1) + 1) % 3
    (a, b, c), (m, n, _) = _rotate(triangles[two], turn).T, _rotate(middle[two], turn).T
    add(two, m, b, n)
    for quad in _split_quads(fields, a, m, n, c):
        add(two, *quad.T)

    three = np.flatnonzero(count == 3)
    (a, b, c), (m, n, o) = triangles[three].T, middle[three].T
    add(three, a, m, o)
    add(three, m, b, n)
    add(three, o, n, c)
    add(three, m, n, o)
    out = np.concatenate(pieces).astype(np.int32)
    return Cut(fields, out, np.concatenate(parents).astype(np.int32), np.zeros(len(out), dtype=np.bool_))


def open_chords(fields: Floats, triangles: Ints, line: Ints) -> Cut:
    """Give every piece of surface beside a line a vertex of its own, off the line. All `above` are False.

    line (B,2) holds edges of the mesh. An edge that is not on the line although both its ends are gets a vertex in the
    middle, and so does a triangle whose three edges all are on the line; a function that is zero on the line could not
    rise there otherwise.
    """
    size = len(fields)
    touches = np.zeros(size, dtype=np.bool_)
    touches[line.ravel()] = True
    touching = touches[triangles]
    rows, sides = np.nonzero(touching & touching[:, [1, 2, 0]])
    keys = edge_keys(triangles[rows, sides], triangles[rows, (sides + 1) % 3], size)
    is_line = np.isin(keys, edge_keys(line[:, 0], line[:, 1], size))
    chord = np.zeros(triangles.shape, dtype=np.bool_)
    chord[rows, sides] = ~is_line
    enclosed = np.bincount(rows[is_line], minlength=len(triangles)) == 3
    cut = split_edges(fields, triangles, chord)
    return _split_at_center(cut, enclosed[cut.parent])


def _split_at_center(cut: Cut, chosen: Bools) -> Cut:
    """Split the chosen triangles into three at their center."""
    if not chosen.any():
        return cut
    corners, parent = cut.triangles[chosen], cut.parent[chosen]
    center = (len(cut.fields) + np.arange(len(corners))).astype(np.int32)
    thirds = [np.stack([corners[:, i], corners[:, (i + 1) % 3], center], axis=1) for i in range(3)]
    triangles = np.concatenate([cut.triangles[~chosen], *thirds])
    return Cut(
        np.concatenate([cut.fields, cut.fields[corners].mean(axis=1)]),
        triangles,
        np.concatenate([cut.parent[~chosen], parent, parent, parent]),
        np.zeros(len(triangles), dtype=np.bool_),
    )

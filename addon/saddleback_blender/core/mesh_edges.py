"""Edges of a triangle mesh given as an index array: all of them, and those on its border."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int32]
Bools = NDArray[np.bool_]


def directed_edges(triangles: Ints) -> tuple[Ints, Ints]:
    """Start and end vertex (3T,) of the edges of each triangle, in its orientation: edge 3t+i leaves corner i."""
    return triangles.ravel(), triangles[:, [1, 2, 0]].ravel()


def edge_keys(a: Ints, b: Ints, vertex_count: int) -> NDArray[np.int64]:
    """One number (n,) for each edge between a (n,) and b (n,), whatever its direction."""
    return np.minimum(a, b).astype(np.int64) * vertex_count + np.maximum(a, b)


def border_vertices(triangles: Ints, vertex_count: int) -> Bools:
    """Which vertices (V,) are on the border of a consistently oriented mesh. O(T), without sorting.

    Around an inner vertex each neighbour is met once coming in and once going out, so a sum of numbers given to the
    neighbours cancels; at a border it does not. The numbers are random so that nothing cancels by chance.
    """
    number = np.random.default_rng(0).random(vertex_count) + 0.5
    start, end = directed_edges(triangles)
    out = np.bincount(start, number[end], minlength=vertex_count)
    back = np.bincount(end, number[start], minlength=vertex_count)
    rounding = 1e-12 * (out + back)
    return np.asarray(np.abs(out - back) > rounding)


def border_edges(triangles: Ints, vertex_count: int) -> tuple[Ints, Ints, Ints]:
    """Start, end and triangle (b,) of the edges that only one triangle uses, oriented as in that triangle."""
    start, end = directed_edges(triangles)
    is_border = border_vertices(triangles, vertex_count)
    candidate = np.flatnonzero(is_border[start] & is_border[end])
    key = edge_keys(start[candidate], end[candidate], vertex_count)
    order = np.argsort(key, kind="stable")
    key = key[order]
    differs = np.ones(len(key) + 1, dtype=np.bool_)
    differs[1:-1] = key[1:] != key[:-1]
    single = candidate[np.sort(order[differs[1:] & differs[:-1]])]
    return start[single], end[single], (single // 3).astype(np.int32)

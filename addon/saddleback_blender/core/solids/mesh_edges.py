# SPDX-License-Identifier: GPL-3.0-or-later
"""Edges of a triangle mesh given as an index array: all of them, and those on its border."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import native

Ints = NDArray[np.int32]


def directed_edges(triangles: Ints) -> tuple[Ints, Ints]:
    """Start and end vertex (3T,) of the edges of each triangle, in its orientation: edge 3t+i leaves corner i."""
    return triangles.ravel(), triangles[:, [1, 2, 0]].ravel()


def edge_keys(a: Ints, b: Ints, vertex_count: int) -> NDArray[np.int64]:
    """One number (n,) for each edge between a (n,) and b (n,), whatever its direction."""
    return np.minimum(a, b).astype(np.int64) * vertex_count + np.maximum(a, b)


def triangle_edges(triangles: Ints, vertex_count: int) -> tuple[Ints, Ints]:
    """The edges (e,2), and the one from each corner (3T,) to the next."""
    ends, corner_edges = native.load().triangle_edges(triangles, vertex_count)
    return ends, corner_edges


def border_edges(triangles: Ints, vertex_count: int) -> tuple[Ints, Ints, Ints]:
    """Start, end and triangle (b,) of the edges that only one triangle uses, oriented as in that triangle."""
    ends, owners = native.load().border_edges(triangles, vertex_count)
    return ends[:, 0], ends[:, 1], owners

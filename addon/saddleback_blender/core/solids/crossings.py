# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds where a triangle mesh passes through itself, as Blender will store it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import native
from ..results import Indices, Reals

# Of the farthest coordinate: what rounding both triangles to single precision may move them against each other.
ROUNDING = 4.0 * float(np.finfo(np.float32).eps)


def find_crossings(
    vertices: Reals, triangles: Indices, among: Indices | None = None, job: Any = None, owners: Indices | None = None
) -> Indices:
    """Pairs (k, 2) of triangles that pass through each other, neighbors along an edge left out; only those of which one
    is `among` the n named, and of different `owners` (m,), if given. Coordinates are rounded to single precision.
    O(m log n).
    """
    rounded = vertices.astype(np.float32)
    found: Indices = native.load().self_crossings(rounded, triangles, among, owners=owners, job=job)
    return found


def is_deep(vertices: Reals, triangles: Indices, pairs: Indices) -> NDArray[np.bool_]:
    """Tells which pairs (k, 2) that `find_crossings` found pass through each other by more than rounding explains: each
    triangle reaches farther beyond the other's plane than coordinates may be off, and before they are rounded, too.
    Needles turn over when rounded, and the planes of two needles tell nothing.
    """
    first, second = (vertices[triangles[side]].astype(np.float32).astype(np.float64) for side in pairs.T)
    off = ROUNDING * np.abs(vertices).max(initial=0.0)
    deep: NDArray[np.bool_] = np.minimum(_depth(first, second), _depth(second, first)) > off
    chosen, places = np.unique(pairs[deep], return_inverse=True)
    rows = places.reshape(-1, 2)  # ascending, as all pairs
    found = native.load().self_crossings(np.ascontiguousarray(vertices), triangles[chosen]).astype(np.int64)
    deep[deep] = np.isin(rows[:, 0] * len(chosen) + rows[:, 1], found[:, 0] * len(chosen) + found[:, 1])
    return deep


def _depth(plane: Reals, of: Reals) -> Reals:
    """How far (k,) the triangles `of` (k, 3, 3) reach to the side of planes (k, 3, 3) on which less of them is."""
    normal = np.cross(plane[:, 1] - plane[:, 0], plane[:, 2] - plane[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), np.finfo(np.float64).tiny)
    height = np.einsum("kij,kj->ki", of - plane[:, :1], normal)
    depth: Reals = np.minimum(height.max(axis=1), -height.min(axis=1))
    return depth

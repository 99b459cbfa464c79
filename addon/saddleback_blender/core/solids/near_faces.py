"""Tells which triangles can touch some that have moved: a search for crossings need not look at the others again."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from ..progress import Progress
from ..results import Indices, Reals


def largest_extent(vertices: Reals, triangles: Indices) -> float:
    """The longest side of any triangle's box. O(t)."""
    extent = np.zeros(3)
    for axis in range(3):
        corner = vertices[:, axis][triangles]
        extent[axis] = (corner.max(axis=1) - corner.min(axis=1)).max(initial=0.0)
    return float(extent.max())


def near_faces(
    vertices: Reals, triangles: Indices, moved: NDArray[np.bool_], extent: float, progress: Progress
) -> Indices:
    """Numbers, rising, of all triangles whose boxes may overlap that of a `moved` one (t,), themselves among them.

    `extent` bounds every box's sides. O(t log t).
    """
    if not extent or not moved.any():
        return np.flatnonzero(moved).astype(np.int32)
    # Where boxes overlap, first corners are apart by two sides at most along each axis: neighbors in this grid.
    cells = np.floor(vertices[triangles[:, 0]] / (2.0 * extent)).astype(np.int64)
    cells -= cells.min(axis=0) - 1
    size = cells.max(axis=0) + 2
    key = (cells[:, 0] * size[1] + cells[:, 1]) * size[2] + cells[:, 2]
    progress.check()
    steps = [(x * size[1] + y) * size[2] + z for x, y, z in product((-1, 0, 1), repeat=3)]
    wanted = np.unique(np.unique(key[moved])[:, None] + np.array(steps))
    progress.check()
    place = np.minimum(np.searchsorted(wanted, key), len(wanted) - 1)
    return np.flatnonzero(wanted[place] == key).astype(np.int32)

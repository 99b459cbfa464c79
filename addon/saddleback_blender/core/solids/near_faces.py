"""Tells which triangles can touch some that have moved: a search for crossings need not look at the others again."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from ..progress import Progress
from ..results import Indices, Reals

# Triangles with longer boxes than this share of all have are always told, so that a few large ones do not coarsen the
# search for the others.
USUAL = 0.95


def extents(vertices: Reals, triangles: Indices) -> Reals:
    """The longest side (t,) of each triangle's box. O(t)."""
    longest = np.zeros(len(triangles))
    for axis in range(3):
        corners = vertices[:, axis][triangles]
        np.maximum(longest, corners.max(axis=1) - corners.min(axis=1), out=longest)
    return longest


def near_faces(vertices: Reals, triangles: Indices, moved: NDArray[np.bool_], progress: Progress) -> Indices:
    """Numbers, rising, of all triangles whose boxes may overlap that of a `moved` one (t,), themselves among them.

    O(t log t).
    """
    if not moved.any() or moved.all():
        return np.flatnonzero(moved).astype(np.int32)
    extent = extents(vertices, triangles)
    progress.check()
    usual = float(np.quantile(extent, USUAL))
    is_near: NDArray[np.bool_] = moved | (extent > usual)
    if usual:
        # Where boxes overlap, first corners are apart by two sides at most along each axis: neighbors in this grid.
        origin = vertices.min(axis=0)
        size = np.floor((vertices.max(axis=0) - origin) / (2.0 * usual)).astype(np.int64) + 3

        def keys(points: Reals) -> NDArray[np.int64]:
            cells = np.floor((points - origin) / (2.0 * usual)).astype(np.int64) + 1
            key: NDArray[np.int64] = (cells[:, 0] * size[1] + cells[:, 1]) * size[2] + cells[:, 2]
            return key

        steps = [(x * size[1] + y) * size[2] + z for x, y, z in product((-1, 0, 1), repeat=3)]
        wanted = np.unique(np.unique(keys(_small(vertices[triangles[moved]], usual)))[:, None] + np.array(steps))
        progress.check()
        key = keys(vertices[triangles[:, 0]])
        is_near |= wanted[np.minimum(np.searchsorted(wanted, key), len(wanted) - 1)] == key
    return np.flatnonzero(is_near).astype(np.int32)


def _small(corners: Reals, most: float) -> Reals:
    """First corners (k, 3) of the triangles (t, 3, 3), those with sides of their boxes over `most` halved before."""
    points = []
    while len(corners):
        points.append(corners[:, 0])
        corners = corners[(np.ptp(corners, axis=1) > most).any(axis=1)]
        a, b, c = corners.swapaxes(0, 1)
        d, e, f = 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)
        corners = np.concatenate([np.stack(part, axis=1) for part in ((a, d, f), (d, b, e), (f, e, c), (d, e, f))])
    return np.concatenate(points)

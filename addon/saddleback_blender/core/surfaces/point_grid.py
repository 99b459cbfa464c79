# SPDX-License-Identifier: GPL-3.0-or-later
"""Points in space that keep their distance."""

from __future__ import annotations

from itertools import product
from math import floor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import native
from ..results import Reals

CANDIDATES = 6  # drawn for each point that is wanted
# Points that keep this times the side of their mean square fill a surface with about as many as wanted.
SPACING = 0.8

Cell = tuple[int, int, int]
Place = tuple[float, float, float]
EVERY_WAY: Place = (0.0, 0.0, 0.0)  # the axis of points that have none
HALF_RIGHT = 0.5**0.5  # cosine
NEIGHBORS: tuple[Cell, ...] = tuple((i, j, k) for i, j, k in product((-1, 0, 1), repeat=3))


class PointGrid:
    """Tells which places are at least `radius` from all points that were taken in.

    Points may have an axis (a unit vector): then only those count whose axes are less than half a right angle apart.
    Plain numbers: questions about one point after another are many times faster so than with arrays.
    """

    def __init__(self, radius: float) -> None:
        self._radius, self._square = radius, radius * radius
        self._cells: dict[Cell, list[tuple[Place, Place]]] = {}

    def add(self, points: Reals, axes: Reals | None = None) -> None:
        """Takes points (n, 3) in."""
        for point, axis in zip(points.tolist(), _listed(axes, len(points)), strict=True):
            self._cells.setdefault(self._cell_of(point), []).append((point, axis))

    def is_free(self, points: Reals, axes: Reals | None = None) -> NDArray[np.bool_]:
        """(n,) for points (n, 3)."""
        asked = zip(points.tolist(), _listed(axes, len(points)), strict=True)
        return np.array([self._is_free(point, axis) for point, axis in asked], bool)

    def take_free(self, points: Reals) -> list[int]:
        """Takes in each of points (n, 3) that is free when its turn comes; returns the numbers of those."""
        taken = []
        for number, point in enumerate(points.tolist()):
            if self._is_free(point, EVERY_WAY):
                self._cells.setdefault(self._cell_of(point), []).append((point, EVERY_WAY))
                taken.append(number)
        return taken

    def _is_free(self, point: Place, axis: Place) -> bool:
        x, y, z = point
        i, j, k = axis
        cx, cy, cz = self._cell_of(point)
        for dx, dy, dz in NEIGHBORS:
            for (a, b, c), (u, v, w) in self._cells.get((cx + dx, cy + dy, cz + dz), ()):
                if (x - a) * (x - a) + (y - b) * (y - b) + (z - c) * (z - c) < self._square and (
                    axis is EVERY_WAY or abs(i * u + j * v + k * w) > HALF_RIGHT
                ):
                    return False
        return True

    def _cell_of(self, point: Place) -> Cell:
        radius = self._radius
        return floor(point[0] / radius), floor(point[1] / radius), floor(point[2] / radius)


def _listed(axes: Reals | None, count: int) -> list[Place]:
    return [EVERY_WAY] * count if axes is None else axes.tolist()


def even_points(mesh: Any, count: int, seed: int) -> Any:
    """Returns about `count` points of a surface that keep their distance, as the library's SurfacePoints."""
    sb = native.load()
    points = sb.sample(mesh, CANDIDATES * count, seed=seed)
    kept = PointGrid(SPACING * float(np.sqrt(mesh.area / count))).take_free(points.positions(mesh))
    return sb.SurfacePoints(points.faces[kept], points.barycentric[kept])

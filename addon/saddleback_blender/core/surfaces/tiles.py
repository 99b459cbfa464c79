# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat rectangles whose opposite sides are one: tiles that repeat without a seam."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from .. import native
from ..errors import BadInputError
from ..progress import Progress
from ..results import Reals

# Sides may be off their right angles, and corners from the sides, by this part: single precision leaves 1e-7.
STRAIGHT = 1e-5


@dataclass(frozen=True)
class Tile:
    """A rectangle of the plane: a corner (2,), the directions of two sides (2, 2), counter-clockwise, their lengths."""

    corner: Reals
    axes: Reals
    size: Reals

    def relaxed(self, places: Reals, iterations: int, threads: int, end: float, progress: Progress) -> Reals:
        """Even cells that go on from each side to the opposite one: (n, 2) places in the rectangle."""
        local, begin = self.seen(places), progress.fraction
        for number in range(iterations):
            with progress.stage(begin + (end - begin) * (number + 1) / iterations, "relaxing the sites") as job:
                local = self._diagram(local, threads, job).centroids
        return self.shown(self._diagram(local, threads, None).sites)

    def copies(self, places: Reals) -> Reals:
        """(9 n, 2): the sites, and those of the eight rectangles around."""
        shifts = np.array([(0, 0), *(shift for shift in product((-1, 0, 1), repeat=2) if shift != (0, 0))])
        found: Reals = (places + ((shifts * self.size) @ self.axes)[:, None]).reshape(-1, 2)
        return found

    @property
    def with_neighbors(self) -> Reals:
        """(4, 2) corners of the rectangle with the eight around it."""
        corners: Reals = self.corner + (np.array([(-1, -1), (2, -1), (2, 2), (-1, 2)]) * self.size) @ self.axes
        return corners

    def seen(self, places: Reals) -> Reals:
        """Places (n, 2) by the rectangle's corner and sides."""
        local: Reals = (places - self.corner) @ self.axes.T
        return local

    def shown(self, local: Reals) -> Reals:
        """The other way."""
        places: Reals = self.corner + local @ self.axes
        return places

    def _diagram(self, local: Reals, threads: int, job: Any) -> Any:
        return native.load().periodic_voronoi_2d(local, [(0, 0), self.size], threads=threads, job=job)


def tile_of(loops: list[Reals], name: str) -> Tile:
    """The rectangle that an outline is. Raises BadInputError where it is none."""
    outline = loops[0]
    before, after = outline - np.roll(outline, 1, axis=0), np.roll(outline, -1, axis=0) - outline
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    lengths = np.hypot(*before.T) * np.hypot(*after.T)
    corners = outline[np.abs(turn) > STRAIGHT * lengths]
    sides = np.roll(corners, -1, axis=0) - corners
    if len(corners) == 4 and len(loops) == 1:
        size = np.hypot(*sides[:2].T)
        if abs(float(sides[0] @ sides[1])) <= STRAIGHT * float(size.prod()) and (
            np.abs(sides[0] + sides[2]).max() <= STRAIGHT * size.max()
        ):
            axes = sides[:2] / size[:, None]
            if axes[0, 0] * axes[1, 1] < axes[0, 1] * axes[1, 0]:  # clockwise
                return Tile(corners[0], axes[::-1], size[::-1])
            return Tile(corners[0], axes, size)
    raise BadInputError(f"'{name}' is no rectangle, so that its sides do not fit each other; switch Seamless off")

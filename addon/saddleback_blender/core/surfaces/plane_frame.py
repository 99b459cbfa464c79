# SPDX-License-Identifier: GPL-3.0-or-later
"""The plane of a flat surface: to its coordinates and back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import BadInputError
from ..requests import Surface
from ..results import Reals

# A flat mesh is flat up to this part of its extent: Blender's single precision, after a turn, leaves about 1e-7.
FLATNESS = 1e-4


@dataclass(frozen=True)
class PlaneFrame:
    """An origin (3,) and the rows x, y, normal of (3, 3); x is the surface's X where the plane lets it."""

    origin: Reals
    axes: Reals

    def to_plane(self, points: Reals) -> Reals:
        """(n, 3) -> (n, 2), along the normal."""
        flat: Reals = (points - self.origin) @ self.axes[:2].T
        return flat

    def to_space(self, places: Reals) -> Reals:
        """(n, 2) -> (n, 3)."""
        points: Reals = self.origin + places @ self.axes[:2]
        return points


FLAT_FRAME = PlaneFrame(np.zeros(3), np.eye(3))  # whose plane is z = 0


def is_flat(surface: Surface) -> bool:
    """Tells whether it lies in a plane."""
    try:
        plane_of(surface)
    except BadInputError:
        return False
    return True


def plane_of(surface: Surface) -> PlaneFrame:
    """The plane that a surface lies in. Raises BadInputError naming the vertex that is farthest from it."""
    vertices = surface.vertices
    a, b, c = (vertices[surface.triangles[:, k]] for k in range(3))
    doubled = np.cross(b - a, c - a)
    normal = doubled.sum(axis=0)
    extent = float(np.ptp(vertices, axis=0).max())
    length = float(np.linalg.norm(normal))
    origin = vertices.mean(axis=0)
    if length <= FLATNESS * np.linalg.norm(doubled, axis=1).sum():
        raise BadInputError(
            f"'{surface.name}' is not flat: its faces look in all directions; choose UV Map or Disk as its space"
        )
    normal = normal / length
    heights = np.abs((vertices - origin) @ normal)
    worst = int(heights.argmax())
    if heights[worst] > FLATNESS * extent:
        number = worst if surface.used is None else int(surface.used[worst])
        raise BadInputError(
            f"'{surface.name}' is not flat: vertex {number} is {heights[worst]:.3g} off its plane; "
            "flatten it, or choose UV Map or Disk as its space"
        )
    x = np.eye(3)[0] if abs(normal[0]) < 0.9 else np.eye(3)[1]
    x = x - (x @ normal) * normal
    x /= np.linalg.norm(x)
    return PlaneFrame(origin, np.array([x, np.cross(normal, x), normal]))

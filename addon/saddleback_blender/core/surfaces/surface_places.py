# SPDX-License-Identifier: GPL-3.0-or-later
"""Leads from the numbers and places that an artist chose to points of the library's mesh."""

from __future__ import annotations

from typing import Any

import numpy as np

from .. import native
from ..errors import BadInputError
from ..requests import Points, Surface


def compact_points(surface: Surface, points: Points, what: str) -> Points:
    """Vertex numbers of the Blender mesh -> numbers of the surface; places in the world stay."""
    if points.ndim == 2:
        return points
    vertices = surface.compact(np.asarray(points, np.int32))
    loose = np.nonzero(vertices < 0)[0]
    if len(loose):
        where = "no face; choose one of the surface" if surface.kept is None else "no face of the layer's region"
        raise BadInputError(f"'{surface.name}': the {what} at vertex {points[loose[0]]} belongs to {where}")
    return vertices


def surface_points(mesh: Any, points: Points) -> Any:
    """Vertex numbers as they are; places in the world -> the nearest points of the surface."""
    return points if points.ndim == 1 else native.load().project(mesh, points)

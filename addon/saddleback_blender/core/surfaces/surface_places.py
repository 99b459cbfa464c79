# SPDX-License-Identifier: GPL-3.0-or-later
"""Leads from the numbers and places that an artist chose to points of the library's mesh."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from .. import native
from ..errors import BadInputError
from ..requests import Points, Surface
from ..results import Dual, SurfacePolygons

Placed = TypeVar("Placed", Dual, SurfacePolygons)


def compact_points(surface: Surface, points: Points, what: str) -> Points:
    """Vertex numbers of the Blender mesh -> numbers of the surface; places stay."""
    if points.ndim == 2:
        return points
    vertices = surface.compact(np.asarray(points, np.int32))
    loose = np.nonzero(vertices < 0)[0]
    if len(loose):
        where = "no face; choose one of the surface" if surface.kept is None else "no face of the layer's region"
        raise BadInputError(f"'{surface.name}': the {what} at vertex {points[loose[0]]} belongs to {where}")
    if surface.has_copies:
        copies = surface.copies(points.astype(np.int32))
        if what == "source":  # on all sides
            return copies
        used = np.bincount(surface.used[copies], minlength=surface.vertex_count)  # type: ignore[index]
        several = np.nonzero(used[points] > 1)[0]
        if len(several):
            raise BadInputError(
                f"'{surface.name}': the {what} at vertex {points[several[0]]} is on both sides of a barrier; choose "
                "one beside it"
            )
    return vertices


def surface_points(mesh: Any, points: Points) -> Any:
    """Vertex numbers as they are; places -> the nearest points of the surface."""
    return points if points.ndim == 1 else native.load().project(mesh, points)


def on_whole_surface(made: Placed, surface: Surface) -> Placed:
    """The same with triangles numbered as in the Blender mesh, of which the surface may be a part."""
    corners = None if made.corner_faces is None else surface.of_mesh(made.corner_faces)
    return replace(made, faces=surface.of_mesh(made.faces), corner_faces=corners)

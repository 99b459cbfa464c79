# SPDX-License-Identifier: GPL-3.0-or-later
"""The lines that a remesh shall keep: sharp edges, marked ones, the border."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...looks import NO_LOOK
from .. import native
from ..requests import Surface
from ..results import Indices
from ..settings import TessellateSettings
from ..solids.mesh_edges import directed_edges, edge_keys

# Of a cell's size: sharp lines that are shorter in all are noise, or more than cells of that size can show.
SEEN_LENGTH = 2.0
# Of all sites: where lines need more, looks leave some out.
MOST_ON_LINES = 0.8


def feature_lines(surface: Surface, mesh: Any, settings: TessellateSettings, marked: Indices | None) -> list[Any]:
    """Curves on the library's mesh; none where none are wanted. `marked` (n, 2) speaks of the Blender mesh."""
    if not (settings.hold_sharp or settings.hold_boundary or marked is not None):
        return []
    sharp = settings.sharp_angle if settings.hold_sharp else math.pi
    edges = None if marked is None else _edges_of_faces(surface, marked)
    smaller_by = settings.density_smaller_by if settings.density_source != "UNIFORM" else 1.0
    size = math.sqrt(mesh.area / max(settings.count, 1)) / max(smaller_by, 1.0)
    curves: list[Any] = []
    # Who asks for a picture gets one: of terraces without their edges, of hundreds of cards without their borders.
    for angle, boundary in ((sharp, settings.hold_boundary), (math.pi, settings.hold_boundary), (sharp, False)):
        curves = native.load().feature_curves(
            mesh, angle, boundary=boundary, edges=edges, least_length=SEEN_LENGTH * size
        )
        needed = sum(max(curve.length / size, 3.0) for curve in curves)
        if settings.look == NO_LOOK or needed < MOST_ON_LINES * settings.count:
            return curves
    return curves if marked is not None else []


def _edges_of_faces(surface: Surface, marked: Indices) -> Indices:
    """Numbers in the surface of the edges that faces have; loose ones are left out."""
    edges = surface.compact(marked.ravel()).reshape(-1, 2)
    count = len(surface.vertices)
    known = edge_keys(*directed_edges(surface.triangles), count)
    return edges[np.isin(edge_keys(edges[:, 0], edges[:, 1], count), known) & (edges >= 0).all(axis=1)]

# SPDX-License-Identifier: GPL-3.0-or-later
"""The vertex of an object that is nearest to a place in the world."""

from __future__ import annotations

import bpy
import numpy as np

from ...core.results import Reals
from .mesh_in import read_surface, to_world, unscaled


def nearest_vertex(source: bpy.types.Object, place: Reals) -> Reals:
    """(3,) its place in the world, measured there. Raises BadInputError for an object without faces."""
    surface = read_surface(source, source.data)
    vertices = to_world(source, unscaled(source, surface.vertices))
    nearest: Reals = vertices[np.linalg.norm(vertices - place, axis=1).argmin()]
    return nearest

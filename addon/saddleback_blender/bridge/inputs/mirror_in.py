# SPDX-License-Identifier: GPL-3.0-or-later
"""The mirror of an object."""

from __future__ import annotations

import bpy
import numpy as np

from ... import compat
from ...core.requests import Surface
from ...core.surfaces.mirrors import Mirror
from .mesh_in import read_surface, scale_of


def read_mirror(source: bpy.types.Object, mesh: bpy.types.Mesh, part: Surface) -> Mirror:
    """The mirror of a part of the surface that was read from `mesh`. Raises BadInputError where it has none."""
    whole = part if part.kept is None else read_surface(source, mesh)
    places = compat.read_positions(mesh).astype(np.float64)
    return Mirror.of(whole, part, places, scale_of(source))

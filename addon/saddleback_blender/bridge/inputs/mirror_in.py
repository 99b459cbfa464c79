"""The mirror of an object."""

from __future__ import annotations

import bpy
import numpy as np

from ... import compat
from ...core.requests import Surface
from ...core.surfaces.mirrors import Mirror
from ..outputs.out_collection import level_place


def read_mirror(source: bpy.types.Object, mesh: bpy.types.Mesh, surface: Surface) -> Mirror:
    """The mirror of a surface that was read from `mesh`. Raises BadInputError where it has none."""
    places = compat.read_positions(mesh).astype(np.float64)
    matrices = (np.array(matrix, np.float64) for matrix in (source.matrix_world, level_place(source)))
    return Mirror.of(surface, places, *matrices)

"""Vector attributes -> directions in the world."""

from __future__ import annotations

import bpy
import numpy as np

from ...core.errors import BadInputError
from ...core.requests import GivenDirections
from ..outputs.out_field import SYMMETRY
from .density import to_vertices
from .mesh_in import read_triangle_polygons


def read_directions(source: bpy.types.Object, mesh: bpy.types.Mesh, name: str) -> GivenDirections:
    """A vector attribute of vertices, faces or corners. Raises BadInputError where there is none of this name."""
    attribute = mesh.attributes.get(name) if name else None
    if attribute is None:
        raise BadInputError(
            f"'{source.name}' has no attribute '{name}' for directions; press Direction Field, or check its name"
        )
    if attribute.data_type != "FLOAT_VECTOR" or attribute.domain == "EDGE":
        raise BadInputError(
            f"'{source.name}': attribute '{name}' holds no vectors of vertices or faces; choose another"
        )
    own = np.empty(3 * len(attribute.data), np.float32)
    attribute.data.foreach_get("vector", own)
    vectors = own.reshape(-1, 3).astype(np.float64) @ np.array(source.matrix_world, np.float64)[:3, :3].T
    polygons = None
    if attribute.domain == "FACE":
        polygons = read_triangle_polygons(mesh)
    elif attribute.domain == "CORNER":
        vectors = np.stack([to_vertices(mesh, column, "CORNER") for column in vectors.T], axis=1)
    symmetry = int(mesh.get(SYMMETRY, source.data.get(SYMMETRY, 1)))
    return GivenDirections(vectors, symmetry if symmetry in (1, 2, 4) else 1, f"attribute '{name}'", polygons)

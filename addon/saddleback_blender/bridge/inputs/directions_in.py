# SPDX-License-Identifier: GPL-3.0-or-later
"""Vector attributes and flow maps -> directions as the surface has them."""

from __future__ import annotations

import bpy
import numpy as np

from ... import compat
from ...blocks import find
from ...core.errors import BadInputError
from ...core.fields.given_fields import flow_of_polygons
from ...core.requests import GivenDirections
from ...core.results import Reals
from ...core.settings import DirectionFieldSettings
from ..outputs.out_attributes import symmetry_of
from .density import colors_of_tiles, no_attribute, to_vertices
from .mesh_in import read_triangle_polygons, scale_of, scaled
from .voronoi_in import read_triangle_corners

INSTEAD = "choose another field"


def read_painted(
    source: bpy.types.Object, mesh: bpy.types.Mesh, settings: DirectionFieldSettings
) -> GivenDirections | None:
    """What the field shall follow; None for nothing. Raises BadInputError."""
    if settings.painted == "ATTRIBUTE":
        if settings.painted_attribute == settings.direction_attribute:
            raise BadInputError(
                f"'{source.name}': the field would be written over attribute '{settings.painted_attribute}', which it "
                "follows; give one of them another name"
            )
        return read_directions(source, mesh, settings.painted_attribute)
    if settings.painted == "COLOR":
        return read_painted_flow(source, mesh, settings.painted_color)
    if settings.painted == "IMAGE":
        return read_image_flow(source, mesh, settings.painted_image)
    return None


def read_directions(source: bpy.types.Object, mesh: bpy.types.Mesh, name: str) -> GivenDirections:
    """A vector attribute of vertices, faces or corners. Raises BadInputError where there is none of this name."""
    attribute = mesh.attributes.get(name) if name else None
    if attribute is None:
        raise BadInputError(f"{no_attribute(source, name, 'directions')}; press Direction Field, or check its name")
    if attribute.data_type != "FLOAT_VECTOR" or attribute.domain == "EDGE":
        raise BadInputError(
            f"'{source.name}': attribute '{name}' holds no vectors of vertices or faces; choose another"
        )
    own = np.empty(3 * len(attribute.data), np.float32)
    attribute.data.foreach_get("vector", own)
    vectors = own.reshape(-1, 3).astype(np.float64) @ scale_of(source).T
    polygons = None
    if attribute.domain == "FACE":
        polygons = read_triangle_polygons(mesh)
    elif attribute.domain == "CORNER":
        vectors = np.stack([to_vertices(mesh, column, "CORNER") for column in vectors.T], axis=1)
    symmetry = symmetry_of(mesh, name) or symmetry_of(source.data, name)
    return GivenDirections(vectors, symmetry if symmetry in (1, 2, 4) else 1, f"attribute '{name}'", polygons)


def read_painted_flow(source: bpy.types.Object, mesh: bpy.types.Mesh, name: str) -> GivenDirections:
    """A color attribute as a flow map, by the active UV map. Raises BadInputError where there is none of this name."""
    name = name or compat.active_color_name(mesh)
    attribute = mesh.color_attributes.get(name)
    if attribute is None:
        missing = f"no color attribute '{name}'" if name else "no color attribute"
        raise BadInputError(f"'{source.name}' has {missing} for directions; paint one or {INSTEAD}")
    # Bytes are what was painted; as colors they would be made linear.
    element = "color_srgb" if attribute.data_type == "BYTE_COLOR" else "color"
    colors = compat.read_floats(attribute.data, element, 4).astype(np.float64)
    if attribute.domain == "POINT":
        colors = colors[compat.read_corner_vertices(mesh)]
    return _flow(source, mesh, colors, f"color attribute '{name}'")


def read_image_flow(source: bpy.types.Object, mesh: bpy.types.Mesh, name: str) -> GivenDirections:
    """An image as a flow map, by the active UV map. Raises BadInputError where there is none of this name."""
    image = find(bpy.data.images, name)
    if image is None:
        missing = f"there is no image '{name}'" if name else "no image is chosen"
        raise BadInputError(f"'{source.name}': {missing} for directions; choose one")
    colors = colors_of_tiles(source, mesh, image, _uv_places(source, mesh), as_stored=True)
    return _flow(source, mesh, colors, f"image '{name}'")


def _uv_places(source: bpy.types.Object, mesh: bpy.types.Mesh) -> Reals:
    layer = mesh.uv_layers.active
    if layer is None:
        raise BadInputError(
            f"'{source.name}' has no UV map to tell directions by; unwrap it (UV > Unwrap) or {INSTEAD}"
        )
    return compat.read_floats(layer.data, "uv", 2).astype(np.float64)


def _flow(source: bpy.types.Object, mesh: bpy.types.Mesh, colors: Reals, label: str) -> GivenDirections:
    corners, polygons = read_triangle_corners(mesh), read_triangle_polygons(mesh)
    places = scaled(source, compat.read_positions(mesh))[compat.read_corner_vertices(mesh)[corners]]
    uv = _uv_places(source, mesh)[corners.ravel()]
    vectors = flow_of_polygons(places, uv, colors[corners.ravel()], polygons)
    return GivenDirections(vectors, 1, label, polygons)

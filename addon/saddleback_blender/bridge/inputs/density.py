# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads what was painted on a mesh, from any of its sources, as one number a vertex."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ... import compat
from ...blocks import find
from ...core.errors import BadInputError
from ...core.fields import density as density_maths
from ...core.fields.density import DensityError
from ...core.fields.image_colors import colors_at
from ...core.requests import CellPaint, CurvatureDensity, Density, DistanceDensity, SpreadDensity
from ...core.settings import DensitySettings, TessellateSettings
from .curves_in import read_curves
from .groups_in import group_numbers
from .images_in import read_tiles

# How each number type of attribute is read: the property's name and the exact type that Blender copies in one go.
NUMBER_TYPES = {
    "FLOAT": ("value", np.float32),
    "INT": ("value", np.int32),
    "INT8": ("value", np.int8),
    "BOOLEAN": ("value", np.bool_),
}
ANOTHER_DENSITY = "choose another density"
ANOTHER_NAME = "choose another name"


def read_density(source: bpy.types.Object, mesh: bpy.types.Mesh, settings: DensitySettings) -> Density | None:
    """(V,) density of all vertices of `mesh` (the object's own or evaluated one), or what it is made from.

    None for uniform. Raises BadInputError naming the object and what is missing or wrong.
    """
    if settings.density_source == "UNIFORM":
        return None
    if settings.density_source == "CURVATURE":
        return CurvatureDensity()
    if settings.density_source == "DISTANCE":
        return DistanceDensity(read_curves(source, settings.density_object, settings.density_collection))
    if settings.density_source == "SPREAD":
        return read_spread(source, mesh, settings.density_name)
    upper: float | None = 1.0
    if settings.density_source == "VERTEX_GROUP":
        values, label = read_vertex_group(source, mesh, settings.density_name)
    elif settings.density_source == "ATTRIBUTE":
        values, label = read_attribute(source, mesh, settings.density_name)
        upper = None
    elif settings.density_source == "IMAGE":
        values, label = read_image(source, mesh, settings)
    elif settings.density_source == "COLOR":
        values, label = read_color(source, mesh, settings.density_name, settings.density_channel)
    else:
        values, label = read_mask(source, mesh)
    try:
        return density_maths.shape(
            values, settings.density_invert, settings.density_contrast, upper, settings.density_smaller_by
        )
    except DensityError as error:
        raise BadInputError(f"'{source.name}': {label} {error}") from error


def read_vertex_group(
    source: bpy.types.Object, mesh: bpy.types.Mesh, name: str, otherwise: str = ANOTHER_DENSITY
) -> tuple[NDArray[np.float64], str]:
    """(V,) weights, 0 for vertices outside the group, and its name for messages. About 0.7 s a million vertices."""
    vertices, weights, label = _read_members(source, mesh, name, otherwise)
    values = np.zeros(len(mesh.vertices))
    values[vertices] = weights
    return values, label


def read_spread(source: bpy.types.Object, mesh: bpy.types.Mesh, name: str) -> SpreadDensity:
    """The vertices of a group with their weights, those of weight 0 among them."""
    vertices, weights, label = _read_members(source, mesh, name, ANOTHER_DENSITY)
    if not vertices:
        raise BadInputError(f"'{source.name}': no vertex is in {label}; paint a few places")
    return SpreadDensity(np.array(vertices, np.int32), np.array(weights, np.float64), label)


def _read_members(
    source: bpy.types.Object, mesh: bpy.types.Mesh, name: str, otherwise: str
) -> tuple[list[int], list[float], str]:
    """The vertices of a group, their weights, and the group's name for messages. `otherwise` is what else helps."""
    group = source.vertex_groups.get(name) if name else source.vertex_groups.active
    if group is None:
        missing = f"no vertex group '{name}'" if name else "no vertex group"
        raise BadInputError(f"'{source.name}' has {missing}; paint one or {otherwise}")
    label = f"vertex group '{group.name}'"
    numbers = group_numbers(source, mesh)
    if group.name not in numbers:
        return *_read_former_group(source, mesh, group.name, otherwise), label
    index = numbers[group.name]
    vertices: list[int] = []
    weights: list[float] = []
    for number, vertex in enumerate(mesh.vertices):
        for element in vertex.groups:
            if element.group == index:
                vertices.append(number)
                weights.append(element.weight)
    return vertices, weights, label


def _read_former_group(
    source: bpy.types.Object, mesh: bpy.types.Mesh, name: str, otherwise: str
) -> tuple[list[int], list[float]]:
    """Geometry nodes may leave a vertex group as an attribute, or without members, as plain numbers of all vertices."""
    attribute = mesh.attributes.get(name)
    if attribute is None or attribute.data_type not in NUMBER_TYPES:
        raise BadInputError(
            f"'{source.name}': its modifiers leave no vertex group '{name}'; {otherwise}, or run without them"
        )
    values, _ = read_attribute(source, mesh, name)
    members = np.flatnonzero(values)
    return members.tolist(), values[members].tolist()


def no_attribute(source: bpy.types.Object, name: str, purpose: str) -> str:
    """Says that the mesh has no attribute of this name, or that none is named yet."""
    what = f"has no attribute '{name}'" if name else "needs the name of an attribute"
    return f"'{source.name}' {what} for {purpose}"


def read_attribute(source: bpy.types.Object, mesh: bpy.types.Mesh, name: str) -> tuple[NDArray[np.float64], str]:
    """(V,) values of a number attribute of any domain, averaged to the vertices, and its name for messages."""
    attribute = mesh.attributes.get(name) if name else None
    if attribute is None:
        raise BadInputError(f"{no_attribute(source, name, 'the density')}; check its name or choose another density")
    label = f"attribute '{name}'"
    if attribute.data_type not in NUMBER_TYPES:
        kind = attribute.data_type.lower().replace("_", " ")
        raise BadInputError(
            f"'{source.name}': {label} holds {kind}s, not numbers; choose a number attribute, or Color Attribute"
        )
    prop, dtype = NUMBER_TYPES[attribute.data_type]
    values: NDArray[np.generic] = np.zeros(len(attribute.data), dtype)
    attribute.data.foreach_get(prop, compat.as_copied(values))
    return to_vertices(mesh, values, attribute.domain), label


def read_color(
    source: bpy.types.Object, mesh: bpy.types.Mesh, name: str, channel: str
) -> tuple[NDArray[np.float64], str]:
    """(V,) one channel of a color attribute, in linear space, and its name for messages."""
    name = name or compat.active_color_name(mesh)
    attribute = mesh.color_attributes.get(name)
    if attribute is None:
        missing = f"no color attribute '{name}'" if name else "no color attribute"
        raise BadInputError(f"'{source.name}' has {missing}; paint one or choose another density")
    colors = np.empty(4 * len(attribute.data), np.float32)
    attribute.data.foreach_get("color", colors)
    values = density_maths.channel(colors.reshape(-1, 4), channel)
    return to_vertices(mesh, values, attribute.domain), f"color attribute '{name}'"


def read_cell_paint(source: bpy.types.Object, mesh: bpy.types.Mesh, settings: TessellateSettings) -> CellPaint:
    """By what the lengths of cells are multiplied. Raises BadInputError."""
    names = {"gap": settings.gap_by, "inset": settings.inset_by, "thickness": settings.thickness_by}
    return CellPaint(**{what: _read_factors(source, mesh, name) for what, name in names.items() if name})


def _read_factors(source: bpy.types.Object, mesh: bpy.types.Mesh, name: str) -> NDArray[np.float64]:
    if name in source.vertex_groups:
        values, label = read_vertex_group(source, mesh, name, ANOTHER_NAME)
    elif name in mesh.color_attributes:
        values, label = read_color(source, mesh, name, "LUMINANCE")
    elif name in mesh.attributes:
        values, label = read_attribute(source, mesh, name)
    else:
        raise BadInputError(
            f"'{source.name}' has no vertex group and no attribute '{name}' for the cells' lengths; paint one, or "
            f"{ANOTHER_NAME}"
        )
    wrong = np.flatnonzero(~((values >= 0.0) & np.isfinite(values)))
    if len(wrong):
        raise BadInputError(
            f"'{source.name}': {label} is {values[wrong[0]]:g} at vertex {wrong[0]}, and lengths can be multiplied by "
            f"0 and more only; paint it anew, or {ANOTHER_NAME}"
        )
    return values


def read_mask(source: bpy.types.Object, mesh: bpy.types.Mesh) -> tuple[NDArray[np.float64], str]:
    """(V,) sculpt mask, and its name for messages."""
    values = compat.read_sculpt_mask(mesh)
    if values is None:
        raise BadInputError(f"'{source.name}' has no sculpt mask; paint one in Sculpt Mode or choose another density")
    return values.astype(np.float64), "the sculpt mask"


def read_image(
    source: bpy.types.Object, mesh: bpy.types.Mesh, settings: DensitySettings
) -> tuple[NDArray[np.float64], str]:
    """(V,) one channel of an image seen through a UV map, averaged to the vertices, and its name for messages."""
    name = settings.density_image
    image = find(bpy.data.images, name)
    if image is None:
        missing = f"there is no image '{name}'" if name else "there is no image chosen"
        raise BadInputError(f"'{source.name}': {missing} for the density; choose one")
    layer = mesh.uv_layers.get(settings.density_name) if settings.density_name else mesh.uv_layers.active
    if layer is None:
        missing = f"no UV map '{settings.density_name}'" if settings.density_name else "no UV map"
        raise BadInputError(f"'{source.name}' has {missing} to see image '{name}' through; unwrap it (UV > Unwrap)")
    places = np.empty(2 * len(mesh.loops), np.float32)
    layer.data.foreach_get("uv", places)
    colors = colors_of_tiles(source, mesh, image, places.reshape(-1, 2).astype(np.float64))
    values = density_maths.channel(colors, settings.density_channel)
    return to_vertices(mesh, values, "CORNER"), f"image '{name}'"


def colors_of_tiles(
    source: bpy.types.Object,
    mesh: bpy.types.Mesh,
    image: bpy.types.Image,
    places: NDArray[np.float64],
    as_stored: bool = False,
) -> NDArray[np.float64]:
    """Colors (L, 4) at the UV places (L, 2) of face corners, linear ones or the numbers that the image stores.

    A polygon lies on the UDIM tile of its middle.
    """
    tiles = {
        number: (pixels, is_encoded and not as_stored)
        for number, (pixels, is_encoded) in read_tiles(source, image).items()
    }
    if list(tiles) == [0]:
        return colors_at(tiles[0][0], places, tiles[0][1])
    totals = compat.read_numbers(mesh.polygons, "loop_total")
    middles = np.add.reduceat(places, np.cumsum(totals) - totals) / totals[:, None]
    squares = np.repeat(np.floor(middles), totals, axis=0)
    numbers = (1001 + squares[:, 0] + 10 * squares[:, 1]).astype(np.int64)
    outside = ~np.isin(numbers, list(tiles)) | (squares[:, 0] < 0) | (squares[:, 0] > 9)
    if outside.any():
        raise BadInputError(
            f"'{source.name}': image '{image.name}' has no tile {numbers[outside][0]}, where faces lie; "
            "add the tile, or move them in the UV Editor"
        )
    colors = np.zeros((len(places), 4))
    for number, (pixels, is_encoded) in tiles.items():
        there = numbers == number
        # A tile does not repeat: its border has the color of its last pixel.
        half = 0.5 / np.array([pixels.shape[1], pixels.shape[0]])
        colors[there] = colors_at(pixels, np.clip(places[there] - squares[there], half, 1.0 - half), is_encoded)
    return colors


def to_vertices(mesh: bpy.types.Mesh, values: NDArray[np.generic], domain: str) -> NDArray[np.float64]:
    """Values of a mesh domain (POINT, EDGE, FACE or CORNER) -> means at its vertices."""
    count = len(mesh.vertices)
    if domain == "POINT":
        return values.astype(np.float64)
    if domain == "EDGE":
        edges = compat.read_edge_vertices(mesh)
        return density_maths.average_to_vertices(np.repeat(values, 2), edges.ravel(), count)
    corners = compat.read_corner_vertices(mesh)
    if domain == "FACE":
        values = np.repeat(values, compat.read_numbers(mesh.polygons, "loop_total"))
    return density_maths.average_to_vertices(values, corners, count)

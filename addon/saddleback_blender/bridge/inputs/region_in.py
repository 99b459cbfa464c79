# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of an object that a layer covers: which of its faces are in the region."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ... import compat
from ...core.errors import BadInputError
from ...core.fields.density import channel
from ...core.requests import Surface
from ...core.results import Reals
from ...core.settings import BarrierSettings, RegionSettings
from ...core.surfaces.parts import NO_EDGES
from .barriers_in import OTHERS, read_barriers
from .density import NUMBER_TYPES, no_attribute, read_attribute, read_vertex_group
from .materials_in import shown_materials
from .mesh_in import read_surface

ANOTHER_REGION = "choose another region for the layer"


def read_part(source: bpy.types.Object, mesh: bpy.types.Mesh, settings: RegionSettings) -> Surface:
    """The surface of the mesh, the object's own or evaluated one, in the region. Raises BadInputError."""
    edges, left_out = NO_EDGES, None
    if isinstance(settings, BarrierSettings):
        edges, left_out = read_barriers(source, mesh, settings)
    if settings.region == "WHOLE":
        is_inside = None
    else:
        is_inside, label = _faces(source, mesh, settings)
        if not is_inside.any():
            raise BadInputError(
                f"'{source.name}': no face is in the region, {label}; choose others, or {ANOTHER_REGION}"
            )
    if left_out is not None:
        is_inside = ~left_out if is_inside is None else is_inside & ~left_out
        if not is_inside.any():
            raise BadInputError(f"'{source.name}': the barriers leave no face; {OTHERS}")
    return read_surface(source, mesh, is_inside=is_inside, barriers=edges)


def _faces(source: bpy.types.Object, mesh: bpy.types.Mesh, settings: RegionSettings) -> tuple[NDArray[np.bool_], str]:
    """(polygons,) which are in the region, and what it is for messages."""
    name = settings.region_name
    if settings.region == "MATERIAL":
        slots = [material.name if material is not None else "" for material in shown_materials(source, mesh)]
        if name not in slots or not name:
            lacks = f"does not show a material '{name}'" if name else "needs the name of a material for the region"
            raise BadInputError(f"'{source.name}' {lacks}; {ANOTHER_REGION}")
        wanted = np.array([slot == name for slot in slots])
        numbers = compat.read_numbers(mesh.polygons, "material_index")
        return wanted[np.minimum(numbers, len(slots) - 1)], f"material '{name}'"
    if settings.region == "VERTEX_GROUP":
        weights, label = read_vertex_group(source, mesh, name, ANOTHER_REGION)
        return _means(mesh, weights[compat.read_corner_vertices(mesh)]) > 0.5, label
    attribute = mesh.attributes.get(name) if name else None
    if attribute is None:
        how = "select faces and press Take Selected Faces" if settings.region == "FACES" else "paint one"
        raise BadInputError(f"{no_attribute(source, name, 'the region')}; {how}, or {ANOTHER_REGION}")
    return _by_attribute(source, mesh, attribute), f"attribute '{name}'"


def _by_attribute(source: bpy.types.Object, mesh: bpy.types.Mesh, attribute: bpy.types.Attribute) -> NDArray[np.bool_]:
    if attribute.domain == "FACE" and attribute.data_type in NUMBER_TYPES:
        element, dtype = NUMBER_TYPES[attribute.data_type]
        values: NDArray[np.generic] = np.zeros(len(attribute.data), dtype)
        attribute.data.foreach_get(element, compat.as_copied(values))
        return values.astype(np.float64) > 0.5
    if attribute.data_type not in ("FLOAT_COLOR", "BYTE_COLOR"):
        numbers, _ = read_attribute(source, mesh, attribute.name)
        return _means(mesh, numbers[compat.read_corner_vertices(mesh)]) > 0.5
    light = channel(compat.read_floats(attribute.data, "color", 4), "LUMINANCE")
    return _means(mesh, light if attribute.domain == "CORNER" else light[compat.read_corner_vertices(mesh)]) > 0.5


def _means(mesh: bpy.types.Mesh, values: Reals) -> Reals:
    """(corners,) -> (polygons,)."""
    first = compat.read_numbers(mesh.polygons, "loop_start")
    order = np.argsort(first, kind="stable")  # ascending but for meshes of other programs
    means = np.empty(len(first))
    means[order] = np.add.reduceat(values, first[order]) / compat.read_numbers(mesh.polygons, "loop_total")[order]
    return means

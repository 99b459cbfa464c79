# SPDX-License-Identifier: GPL-3.0-or-later
"""The centers of the cells as points that carry what something put on them needs to know."""

from __future__ import annotations

import bpy
import numpy as np

from ... import nodes
from ...blocks import find
from ...core.errors import BadInputError
from ...core.results import CellsResult
from ...core.settings import TessellateSettings, Voronoi2dSettings
from ...core.surfaces.centers import euler_to_normal, instance_size
from ..inputs.mesh_in import level_place
from .following import Follower
from .out_attributes import set_attribute
from .out_collection import find_output, hair, replace_object

CENTERS_ROLE = "centers"
CELL_ATTRIBUTE, AREA_ATTRIBUTE = "saddleback_cell", "saddleback_area"


def write_centers(
    context: bpy.types.Context,
    source: bpy.types.Object,
    result: CellsResult,
    settings: TessellateSettings | Voronoi2dSettings,
    role: str = CENTERS_ROLE,
    follower: Follower | None = None,
) -> bpy.types.Object:
    """Makes or replaces the source's centers object, with the chosen object or a dot on every center.

    Point attributes: cell, area (world units squared), normal (unit), size (a radius) and
    rotation (Euler XYZ that takes Z to the normal).
    """
    instance = _instance(source, settings.instance_object, role)
    place = level_place(source)
    mesh = bpy.data.meshes.new("Saddleback Centers")
    count = len(result.sites_position)
    points = result.sites_position
    has_dots = settings.instance_dots and instance is None
    if has_dots:  # which are flat
        mesh.materials.append(nodes.dots_material())
        points = points + hair(source) * result.sites_normal
    mesh.vertices.add(count)
    mesh.vertices.foreach_set("co", points.astype(np.float32).ravel())
    rotations = euler_to_normal(result.sites_normal)
    columns: dict[str, np.ndarray] = {
        CELL_ATTRIBUTE: np.arange(count, dtype=np.int32),
        AREA_ATTRIBUTE: result.cell_area,
        nodes.NORMAL_ATTRIBUTE: result.sites_normal,
        nodes.SIZE_ATTRIBUTE: instance_size(result.cell_area, result.sites_tone, settings.instance_size),
        nodes.ROTATION_ATTRIBUTE: rotations,
    }
    for name, values in columns.items():
        set_attribute(mesh, name, "POINT", values)
    mesh.update()
    item = replace_object(context, source, role, mesh, place)
    nodes.set_instances(item, instance, settings.instance_scale)
    if has_dots:
        nodes.set_dots(item, settings.instance_scale, mesh.materials[0])
    else:
        nodes.remove_dots(item)
    if follower is not None:
        follower.take(item, place, points, result.sites_position, rotations=rotations)
    return item


def _instance(source: bpy.types.Object, name: str, role: str) -> bpy.types.Object | None:
    """The object to put on the centers. Raises BadInputError where none has that name, or it is the centers'."""
    if not name:
        return None
    instance = find(bpy.data.objects, name)
    if instance is None:
        raise BadInputError(f"There is no object '{name}' to put on the centers of '{source.name}'; choose another")
    if instance == find_output(source, role):
        raise BadInputError(f"'{name}' holds the centers themselves and cannot be put on them; choose another object")
    return instance

# SPDX-License-Identifier: GPL-3.0-or-later
"""Ribbons into Blender: one mesh that follows the surface."""

from __future__ import annotations

import bpy

from ... import compat, nodes
from ...blocks import find
from ...core.ribbon_runs import RibbonResult
from ...core.settings import RibbonSettings
from ...core.shapes.shape_templates import Picture
from ...image_materials import image_material
from ..inputs.mesh_in import level_place
from .following import Follower
from .out_collection import replace_object
from .out_shapes import UV_NAME, fill, materials_of

RIBBON_ROLE = "ribbon"


def write_ribbon(
    context: bpy.types.Context,
    source: bpy.types.Object,
    result: RibbonResult,
    settings: RibbonSettings,
    picture: Picture | None,
    follower: Follower,
) -> bpy.types.Object:
    """Makes or replaces the source's ribbon object, which follows the source."""
    place, solid = level_place(source), result.solid
    mesh = bpy.data.meshes.new("Saddleback Ribbon")
    fill(mesh, solid.vertices, solid.corners, solid.offsets, solid.uv, solid.smooth)
    for material in _materials(settings, picture, bool((result.repeats > 1).any())):
        mesh.materials.append(material)
    compat.write_numbers(mesh.polygons, "material_index", solid.material)
    mesh.update()
    item = replace_object(context, source, RIBBON_ROLE, mesh, place)
    follower.take_anchored(item, place, result.anchors)
    return item


def _materials(settings: RibbonSettings, picture: Picture | None, is_repeated: bool) -> list[bpy.types.Material | None]:
    image = find(bpy.data.images, picture.name) if picture is not None else None
    if picture is not None and image is not None:
        return [image_material(image, UV_NAME, picture.color, picture.is_transparent, is_repeated)]
    own = materials_of(find(bpy.data.objects, settings.ribbon_object)) if settings.show == "OBJECT" else []
    return own if any(own) else [nodes.edges_material()]

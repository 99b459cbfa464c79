# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh with the outlines of its shapes cut in, as an object that keeps what the artist put on the source."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from ... import compat, nodes
from ...core.results import DistributeResult
from ...core.settings import DistributeSettings
from ...core.shapes.shape_colors import random_of
from ...core.shapes.shape_templates import ShapeTemplate
from ...follow_nodes import stop_following
from ..inputs.carried_in import read_carried
from ..inputs.materials_in import shown_materials
from ..inputs.mesh_in import level_place, mesh_of
from .carried_out import write_groups
from .following import Follower
from .out_attributes import set_attribute
from .out_collection import replace_object
from .out_shapes import RANDOM_ATTRIBUTE, SHAPE_ATTRIBUTE, SHAPE_UV, add_materials

CUT_ROLE = "shape cut"


def write_cut(
    context: bpy.types.Context,
    source: bpy.types.Object,
    result: DistributeResult,
    templates: Sequence[ShapeTemplate],
    settings: DistributeSettings,
    follower: Follower,
) -> bpy.types.Object:
    """Makes or replaces the source's cut mesh, which may follow the source.

    Faces know their shape and its class (-1 outside), and have its material; a UV map says where in the shape their
    corners are. Vertex groups, UV maps, number attributes, shading and, outside of shapes, materials are the source's.
    """
    cut = result.cut
    assert cut is not None
    place = level_place(source)
    mesh = bpy.data.meshes.new("Saddleback Cut")
    mesh.vertices.add(len(cut.vertices))
    compat.write_positions(mesh, cut.vertices.astype(np.float32))
    compat.write_corners(mesh, cut.triangles)
    mesh.update(calc_edges=True)
    with mesh_of(context, source, settings.use_modifiers) as read:
        carried = read_carried(source, read, cut.faces, cut.barycentric)
        corners = read_carried(source, read, cut.corner_faces, cut.corner_barycentric, has_corners=True)
        compat.copy_auto_smooth(read, mesh)
        materials = shown_materials(source, read)
    for name, values in carried.attributes.items():
        set_attribute(mesh, name, "POINT", values)
    for name, places in corners.uv_maps.items():
        layer = mesh.uv_layers.new(name=name)
        if layer is not None:  # Blender holds eight maps at most
            layer.data.foreach_set("uv", np.ascontiguousarray(places).ravel())
    random = np.append(random_of(len(result.placed.shape), settings.seed), 0.0)
    set_attribute(mesh, SHAPE_ATTRIBUTE, "FACE", cut.copy)
    set_attribute(mesh, nodes.CLASS_ATTRIBUTE, "FACE", cut.shape)
    set_attribute(mesh, RANDOM_ATTRIBUTE, "FACE", random[cut.copy])
    own = mesh.uv_layers.new(name=SHAPE_UV, do_init=False)
    if own is not None:
        own.data.foreach_set("uv", cut.uv.astype(np.float32).ravel())
    mesh.polygons.foreach_set("use_smooth", np.ascontiguousarray(corners.smooth[::3]))
    for material in materials or [None]:
        mesh.materials.append(material)
    firsts = add_materials(mesh, templates, settings.look, is_cut=True)
    slots = np.where(cut.copy >= 0, firsts[cut.shape], corners.material[::3])
    compat.write_numbers(mesh.polygons, "material_index", slots)
    mesh.update()
    item = replace_object(context, source, CUT_ROLE, mesh, place)
    write_groups(item, carried)
    if result.cut_anchors is not None:
        follower.take_anchored(item, place, result.cut_anchors)
    else:
        stop_following(item)
    return item

# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.edit_sites`: the centers of the last cells as vertices to drag, add and remove."""

from __future__ import annotations

import bpy
import numpy as np

from .. import rollback
from ..bridge.inputs.mesh_in import unscaled
from ..core.errors import BadInputError
from ..props import existing_group
from ..props.kept_sites import kept_sites
from ..props.layers import active_layer, check_layer
from .paint import HelperOperator

SETTINGS = ("sites_source", "sites_object", "relax_sites")


class SADDLEBACK_OT_edit_sites(HelperOperator, bpy.types.Operator):
    """Begins to edit sites."""

    bl_idname = "saddleback.edit_sites"
    bl_label = "Edit Sites"
    bl_description = (
        "Make vertices of the cells' centers and edit them: drag, duplicate or delete some, leave Edit Mode, and the "
        "cells follow"
    )
    bl_options = {"REGISTER", "UNDO"}

    def help(self, context: bpy.types.Context, source: bpy.types.Object) -> str:
        """Makes the vertices, lets the cells be theirs, and changes the mode."""
        check_layer(source)
        group, layer = existing_group(source, "tessellate"), active_layer(source)
        item = None if group is None or group.sites_source != "OBJECT" else group.sites_object
        if item is None:
            places = None if group is None else kept_sites(source)
            if group is None or places is None or layer is None:
                raise BadInputError(f"'{source.name}' has no cells yet whose sites could be edited: press Tessellate")
            item = _new_points(source, unscaled(source, places))
            for name in SETTINGS:
                rollback.remember_setting(group, name)
            group.sites_source, group.sites_object, group.relax_sites = "OBJECT", item, False
        if layer is not None:
            rollback.remember_setting(layer, "auto_update")
            layer.auto_update = True
        for other in context.selected_objects:
            other.select_set(False)
        context.view_layer.objects.active = item
        item.select_set(True)
        bpy.ops.object.mode_set(mode="EDIT")
        tools = context.tool_settings
        tools.mesh_select_mode = (True, False, False)
        tools.use_snap, tools.snap_elements = True, {"FACE"}  # so that they stay on the surface while they are dragged
        return f"'{source.name}': drag, add or delete vertices, leave Edit Mode, and the cells follow"


def _new_points(source: bpy.types.Object, own: np.ndarray) -> bpy.types.Object:
    """An object of vertices (n, 3) in the source's space."""
    mesh = bpy.data.meshes.new(f"{source.name} Sites")
    mesh.vertices.add(len(own))
    mesh.vertices.foreach_set("co", own.astype(np.float32).ravel())
    item = bpy.data.objects.new(mesh.name, mesh)
    item.show_in_front = True
    for collection in source.users_collection:
        collection.objects.link(item)
    item.parent = source
    return item


CLASSES = (SADDLEBACK_OT_edit_sites,)

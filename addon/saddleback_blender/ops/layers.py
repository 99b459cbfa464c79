# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators on the list of layers: add, duplicate, freeze, delete."""

from __future__ import annotations

import bpy
import numpy as np

from .. import rollback
from ..bridge.inputs.source import check_own_mesh
from ..bridge.outputs.out_attributes import set_attribute
from ..bridge.outputs.out_collection import clear_layer, free_layer
from ..bridge.outputs.out_looks import set_stage
from ..bridge.outputs.preview import hide_preview
from ..core.errors import BadInputError
from ..props.layers import (
    active_layer,
    add_layer,
    check_layer,
    duplicate_layer,
    forget_layer,
    layers_of,
    look_of,
    suffix_of,
)
from .paint import HelperOperator

REGION_ATTRIBUTE = "saddleback_region"
BARRIERS_ATTRIBUTE = "saddleback_barriers"


class SADDLEBACK_OT_layer_add(HelperOperator, bpy.types.Operator):
    """Adds a layer."""

    bl_idname = "saddleback.layer_add"
    bl_label = "Add Layer"
    bl_description = "Begin another pattern on the active object; those that are there stay"
    bl_options = {"REGISTER", "UNDO"}

    def help(self, context: bpy.types.Context, source: bpy.types.Object) -> str:
        """Adds it."""
        return f"'{source.name}': layer '{add_layer(source).name}'"


class SADDLEBACK_OT_layer_duplicate(HelperOperator, bpy.types.Operator):
    """Duplicates a layer."""

    bl_idname = "saddleback.layer_duplicate"
    bl_label = "Duplicate Layer"
    bl_description = "Add a layer with the settings of the active one; nothing is made in it yet"
    bl_options = {"REGISTER", "UNDO"}

    def help(self, context: bpy.types.Context, source: bpy.types.Object) -> str:
        """Adds it."""
        return f"'{source.name}': layer '{duplicate_layer(source).name}'"


class SADDLEBACK_OT_layer_delete(HelperOperator, bpy.types.Operator):
    """Deletes a layer."""

    bl_idname = "saddleback.layer_delete"
    bl_label = "Delete Layer"
    bl_description = "Delete the active layer with the objects and attributes that were made in it"
    bl_options = {"REGISTER", "UNDO"}

    def help(self, context: bpy.types.Context, source: bpy.types.Object) -> str:
        """Deletes it."""
        layer = _layer(source)
        name, is_last = layer.name, len(layers_of(source)) == 1
        if is_last:
            hide_preview(source)
        clear_layer(context, source, layer.word, is_last)
        forget_layer(source)
        set_stage(source, look_of(source))
        return f"'{source.name}': layer '{name}' deleted"


class SADDLEBACK_OT_layer_freeze(HelperOperator, bpy.types.Operator):
    """Freezes a layer."""

    bl_idname = "saddleback.layer_freeze"
    bl_label = "Freeze"
    bl_description = "Make ordinary objects of what was made in the active layer: no run and no Clear changes them"
    bl_options = {"REGISTER", "UNDO"}

    def help(self, context: bpy.types.Context, source: bpy.types.Object) -> str:
        """Frees the objects."""
        layer = _layer(source)
        if layer.is_frozen:
            raise BadInputError(f"'{source.name}': the layer '{layer.name}' is frozen already")
        count = free_layer(source, layer.word)
        if not count:
            raise BadInputError(f"'{source.name}': nothing was made in the layer '{layer.name}' that could be frozen")
        rollback.remember_setting(layer, "is_frozen")
        layer.is_frozen = True
        return f"'{source.name}': layer '{layer.name}' frozen, {count} {'output' if count == 1 else 'outputs'}"


class SADDLEBACK_OT_region_from_selection(HelperOperator, bpy.types.Operator):
    """Takes the selected faces as the region."""

    bl_idname = "saddleback.region_from_selection"
    bl_label = "Take Selected Faces"
    bl_description = (
        "Let the active layer cover the faces that were selected in Edit Mode; they are kept as an attribute"
    )
    bl_options = {"REGISTER", "UNDO"}

    def help(self, context: bpy.types.Context, source: bpy.types.Object) -> str:
        """Writes the attribute."""
        check_own_mesh(source)
        check_layer(source)
        faces = source.data.polygons
        is_selected = np.empty(len(faces), np.bool_)
        faces.foreach_get("select", is_selected)
        if not is_selected.any():
            raise BadInputError(f"'{source.name}': no face is selected; select some in Edit Mode, and leave it")
        name = f"{REGION_ATTRIBUTE}{suffix_of(source)}"
        set_attribute(source.data, name, "FACE", is_selected)
        for setting in ("region", "region_name"):
            rollback.remember_setting(source.saddleback, setting)
        source.saddleback.region, source.saddleback.region_name = "FACES", name
        return f"'{source.name}': {int(is_selected.sum())} faces are the layer's region"


class SADDLEBACK_OT_barriers_from_selection(HelperOperator, bpy.types.Operator):
    """Takes the selected edges or faces as barriers."""

    bl_idname = "saddleback.barriers_from_selection"
    bl_label = "Take Selection"
    bl_description = (
        "Let nothing cross the edges that were selected in Edit Mode, or the faces where it selects faces; they are "
        "kept as an attribute"
    )
    bl_options = {"REGISTER", "UNDO"}

    def help(self, context: bpy.types.Context, source: bpy.types.Object) -> str:
        """Writes the attribute."""
        check_own_mesh(source)
        check_layer(source)
        has_faces = context.tool_settings.mesh_select_mode[2]
        elements, domain, what = (
            (source.data.polygons, "FACE", "faces") if has_faces else (source.data.edges, "EDGE", "edges")
        )
        is_selected = np.empty(len(elements), np.bool_)
        elements.foreach_get("select", is_selected)
        if not is_selected.any():
            raise BadInputError(f"'{source.name}': no {what[:-1]} is selected; select some in Edit Mode, and leave it")
        name = f"{BARRIERS_ATTRIBUTE}{suffix_of(source)}"
        set_attribute(source.data, name, domain, is_selected)
        for setting in ("barriers", "barriers_name"):
            rollback.remember_setting(source.saddleback, setting)
        source.saddleback.barriers, source.saddleback.barriers_name = "ATTRIBUTE", name
        return f"'{source.name}': {int(is_selected.sum())} {what} are barriers"


def _layer(source: bpy.types.Object) -> bpy.types.PropertyGroup:
    layer = active_layer(source)
    if layer is None:
        raise BadInputError(f"'{source.name}' has no layers yet; press a button that makes something")
    return layer


CLASSES = (
    SADDLEBACK_OT_layer_add,
    SADDLEBACK_OT_layer_duplicate,
    SADDLEBACK_OT_layer_freeze,
    SADDLEBACK_OT_layer_delete,
    SADDLEBACK_OT_region_from_selection,
    SADDLEBACK_OT_barriers_from_selection,
)

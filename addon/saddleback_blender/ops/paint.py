# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that put a brush into the artist's hand: a density to paint, strokes to draw, a singularity to place."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from bpy.props import EnumProperty, FloatProperty, StringProperty

from .. import rollback
from ..bridge.inputs.nearest import nearest_vertex
from ..bridge.inputs.source import check_own_mesh, usable_source
from ..bridge.outputs import hand_edits
from ..bridge.outputs.paint_layers import PAINT_NAME, prepare_colors, prepare_weights
from ..core.errors import BadInputError
from ..props.layers import suffix_of
from .base import PolledOperator

PAINTS = (
    ("WEIGHT", "Weights", "A vertex group, painted in Weight Paint mode"),
    ("COLOR", "Colors", "A color attribute, painted in Vertex Paint mode: white is dense, black is not"),
)
PENS = (
    ("ANNOTATE", "Annotations", "Draw with the Annotate tool on the surface"),
    ("CURVE", "Curve", "Draw curves on the surface, which can be edited later"),
)


class HelperOperator(PolledOperator):
    """Mixin: an operator that changes something on the active object at once."""

    report: Any

    def help(self, context: bpy.types.Context, source: bpy.types.Object) -> str:
        """Does it; returns one line that tells it."""
        raise NotImplementedError

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Does it, or says why not."""
        try:
            hand_edits.notes()  # of what was taken back
            with rollback.all_or_nothing():
                line = self.help(context, usable_source(context))
        except BadInputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for note in hand_edits.notes():
            self.report({"WARNING"}, note)
        self.report({"INFO"}, line)
        return {"FINISHED"}


class SADDLEBACK_OT_paint_density(HelperOperator, bpy.types.Operator):
    """Starts painting."""

    bl_idname = "saddleback.paint_density"
    bl_label = "Paint Density"
    bl_description = "Make a layer to paint the density on, choose it in the panel, and start painting"
    bl_options = {"REGISTER", "UNDO"}
    __annotations__ = {
        "paint": EnumProperty(name="Paint", description="What is painted", items=PAINTS, default="WEIGHT"),
        "paint_name": StringProperty(name="Name", description="Name of the painted layer", default=PAINT_NAME),
        "settings": StringProperty(name="Settings", description="Whose density it is to be", default="tessellate"),
    }

    def help(self, context: bpy.types.Context, source: bpy.types.Object) -> str:
        """Makes the layer and changes the mode."""
        check_own_mesh(source)
        name = self.paint_name or PAINT_NAME
        if name == PAINT_NAME:
            name += suffix_of(source)  # each layer is painted for itself
        if self.paint == "COLOR":
            prepare_colors(source, name)
        else:
            prepare_weights(source, name)
        group = getattr(source.saddleback, self.settings, None)
        if group is None or not hasattr(group, "density_source"):
            raise BadInputError(f"'{source.name}': no settings '{self.settings}' have a density")
        for setting in ("density_source", "density_name"):
            rollback.remember_setting(group, setting)
        group.density_source = "COLOR" if self.paint == "COLOR" else "VERTEX_GROUP"
        group.density_name = name
        bpy.ops.object.mode_set(mode="VERTEX_PAINT" if self.paint == "COLOR" else "WEIGHT_PAINT")
        return f"'{source.name}': paint '{name}', then press the button in the Saddleback tab"


class SADDLEBACK_OT_draw_strokes(HelperOperator, bpy.types.Operator):
    """Starts drawing."""

    bl_idname = "saddleback.draw_strokes"
    bl_label = "Draw Strokes"
    bl_description = "Take a pen that draws on the surface of the active object, for the direction field to follow"
    bl_options = {"REGISTER", "UNDO"}
    __annotations__ = {
        "pen": EnumProperty(name="Pen", description="What strokes are drawn with", items=PENS, default="ANNOTATE"),
    }

    def help(self, context: bpy.types.Context, source: bpy.types.Object) -> str:
        """Chooses the tool, and the strokes in the panel."""
        settings = source.saddleback.direction_field
        for setting in ("strokes", "strokes_collection"):
            rollback.remember_setting(settings, setting)
        if self.pen == "ANNOTATE":
            context.tool_settings.annotation_stroke_placement_view3d = "SURFACE"
            settings.strokes = "ANNOTATIONS"
            _take_tool(context, "builtin.annotate")
            return f"'{source.name}': draw on the surface, then press Direction Field"
        settings.strokes, settings.strokes_collection = "COLLECTION", None
        context.tool_settings.curve_paint_settings.depth_mode = "SURFACE"
        curve = bpy.data.curves.new(f"{source.name} Strokes", "CURVE")
        curve.dimensions = "3D"
        item = bpy.data.objects.new(curve.name, curve)
        for collection in source.users_collection:
            collection.objects.link(item)
        item.parent = source
        item.matrix_parent_inverse = source.matrix_world.inverted_safe()
        for other in context.selected_objects:
            other.select_set(False)
        item.select_set(True)
        context.view_layer.objects.active = item
        bpy.ops.object.mode_set(mode="EDIT")
        _take_tool(context, "builtin.draw")
        return f"'{source.name}': draw curves on the surface, leave Edit Mode, choose '{source.name}' again"


class SADDLEBACK_OT_add_singularity(HelperOperator, bpy.types.Operator):
    """Adds an empty."""

    bl_idname = "saddleback.add_singularity"
    bl_label = "Add Singularity"
    bl_description = "Add an empty at the vertex nearest to the 3D cursor, for the field to turn about"
    bl_options = {"REGISTER", "UNDO"}
    __annotations__ = {
        "index": FloatProperty(
            name="Index", description="How often the field turns about it: multiples of 1, 1/2 (lines), 1/4 (crosses)",
            default=1.0, soft_min=-2.0, soft_max=2.0, step=25,
        ),
    }  # fmt: skip

    def help(self, context: bpy.types.Context, source: bpy.types.Object) -> str:
        """Makes the empty, parented to the object."""
        place = nearest_vertex(source, np.array(context.scene.cursor.location[:], np.float64))
        item = bpy.data.objects.new(f"{source.name} Singularity", None)
        item.empty_display_type = "SPHERE"
        item.empty_display_size = 0.03 * max(source.dimensions)
        item["index"] = self.index
        for collection in source.users_collection:
            collection.objects.link(item)
        item.parent = source
        item.matrix_parent_inverse = source.matrix_world.inverted_safe()
        item.location = place
        rollback.remember_setting(source.saddleback.direction_field, "singularities")
        source.saddleback.direction_field.singularities = "EMPTIES"
        context.view_layer.update()
        return f"'{source.name}': singularity of index {self.index:.4g}"


def _take_tool(context: bpy.types.Context, name: str) -> None:
    """Chooses a tool of the 3D view, where there is one."""
    if context.area is not None and context.area.type == "VIEW_3D":
        bpy.ops.wm.tool_set_by_id(name=name)


CLASSES = (SADDLEBACK_OT_paint_density, SADDLEBACK_OT_draw_strokes, SADDLEBACK_OT_add_singularity)

# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels of direction fields and shapes."""

from __future__ import annotations

import bpy

from ..bridge.inputs.source import active_object
from . import rows
from .panel_parts import SaddlebackAdvancedPanel, SaddlebackSubPanel, draw_button, draw_figures, draw_state


class SADDLEBACK_PT_direction_field(SaddlebackSubPanel, bpy.types.Panel):
    """Shows which way things point."""

    bl_label = "Direction Field"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        item = active_object(context)
        layout = self.split_layout(context)
        draw_button(layout, context, "saddleback.direction_field", "FORCE_WIND")
        draw_state(layout, context, "direction_field")
        rows.draw_pens(layout)
        rows.draw_field(layout.column(), item.saddleback.direction_field, item)


class SADDLEBACK_PT_field_advanced(SaddlebackAdvancedPanel, bpy.types.Panel):
    """How the field follows strokes, and where it is written."""

    bl_parent_id = "SADDLEBACK_PT_direction_field"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        settings = active_object(context).saddleback.direction_field
        layout = self.split_layout(context)
        layout.prop(settings, "lengths")
        rows.draw_field_advanced(layout, settings)
        layout.prop(settings, "use_modifiers")


class SaddlebackFieldOutputPanel(SaddlebackSubPanel):
    """Mixin: a panel whose header switches a view of the field on."""

    bl_parent_id = "SADDLEBACK_PT_direction_field"
    switch: str

    def draw_header(self, context: bpy.types.Context) -> None:
        """Draws the switch."""
        self.layout.enabled = not context.window_manager.saddleback_running
        self.layout.prop(active_object(context).saddleback.direction_field, self.switch, text="")


class SADDLEBACK_PT_arrows(SaddlebackFieldOutputPanel, bpy.types.Panel):
    """Arrows along the field."""

    bl_label = "Arrows"
    bl_options = {"DEFAULT_CLOSED"}
    switch = "make_arrows"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        rows.draw_arrows(self.split_layout(context), active_object(context).saddleback.direction_field)


class SADDLEBACK_PT_streamlines(SaddlebackFieldOutputPanel, bpy.types.Panel):
    """Lines along the field."""

    bl_label = "Streamlines"
    bl_options = {"DEFAULT_CLOSED"}
    switch = "make_streamlines"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        rows.draw_streamlines(self.split_layout(context), active_object(context).saddleback.direction_field)


class SADDLEBACK_PT_distribute(SaddlebackSubPanel, bpy.types.Panel):
    """Shapes on the surface."""

    bl_label = "Distribute Shapes"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        item = active_object(context)
        settings = item.saddleback.distribute
        layout = self.split_layout(context)
        draw_button(layout, context, "saddleback.distribute", "STICKY_UVS_DISABLE")
        draw_state(layout, context, "distribute")
        draw_figures(layout, context, "distribute")
        rows.draw_shapes(layout.column(), settings, item)
        layout.operator("saddleback.check_distribution", icon="CHECKMARK")


class SADDLEBACK_PT_shapes_advanced(SaddlebackAdvancedPanel, bpy.types.Panel):
    """How shapes lie."""

    bl_parent_id = "SADDLEBACK_PT_distribute"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        item = active_object(context)
        settings = item.saddleback.distribute
        layout = self.split_layout(context)
        layout.prop(settings, "lengths")
        rows.draw_density_advanced(layout.column(), settings)
        rows.draw_shapes_advanced(layout, settings, item)
        layout.prop(settings, "use_modifiers")


class SADDLEBACK_PT_shape_density(SaddlebackSubPanel, bpy.types.Panel):
    """Shows where shapes are many."""

    bl_label = "Density"
    bl_parent_id = "SADDLEBACK_PT_distribute"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        item = active_object(context)
        rows.draw_shape_density(self.split_layout(context), item.saddleback.distribute, item)


class SADDLEBACK_PT_shape_outputs(SaddlebackSubPanel, bpy.types.Panel):
    """Shows what is made of the shapes."""

    bl_label = "Output"
    bl_parent_id = "SADDLEBACK_PT_distribute"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        settings = active_object(context).saddleback.distribute
        layout = self.split_layout(context)
        layout.prop(settings, "make_bent")
        row = layout.row()
        row.active = settings.make_bent and settings.shapes != "IMAGE"
        row.prop(settings, "fit")
        row = layout.row()
        row.active = settings.make_bent and settings.shapes in ("COLLECTION", "IMAGE")
        rows.draw_automatic(row, settings, "thickness")
        layout.prop(settings, "make_instances")
        row = layout.row()
        row.active = settings.make_instances
        row.prop(settings, "keep")
        layout.operator("saddleback.make_real", icon="OUTLINER_OB_MESH")
        layout.prop(settings, "make_outlines")
        row = layout.row()
        row.active = settings.make_outlines
        rows.draw_length(row, settings, "outline_radius")
        layout.prop(settings, "make_cut")
        row = layout.row()
        row.active = any((settings.make_bent, settings.make_instances, settings.make_outlines, settings.make_cut))
        row.prop(settings, "follow_surface")
        layout.prop(settings, "write_attributes")


CLASSES = (
    SADDLEBACK_PT_direction_field,
    SADDLEBACK_PT_arrows,
    SADDLEBACK_PT_streamlines,
    SADDLEBACK_PT_field_advanced,
    SADDLEBACK_PT_distribute,
    SADDLEBACK_PT_shape_density,
    SADDLEBACK_PT_shape_outputs,
    SADDLEBACK_PT_shapes_advanced,
)

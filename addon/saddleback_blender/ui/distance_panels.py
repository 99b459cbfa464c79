# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels of distances, paths and ribbons."""

from __future__ import annotations

import bpy

from ..bridge.inputs.source import active_object
from . import rows
from .panel_parts import SaddlebackAdvancedPanel, SaddlebackSubPanel, draw_button, draw_state


class SADDLEBACK_PT_distance(SaddlebackSubPanel, bpy.types.Panel):
    """Distances along the surface."""

    bl_label = "Distance"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        item = active_object(context)
        settings = item.saddleback.distance
        layout = self.split_layout(context)
        draw_button(layout, context, "saddleback.distance", "DRIVER_DISTANCE")
        draw_state(layout, context, "distance")
        rows.draw_distance_sources(layout.column(), settings, item)


class SADDLEBACK_PT_distance_advanced(SaddlebackAdvancedPanel, bpy.types.Panel):
    """How distances are found."""

    bl_parent_id = "SADDLEBACK_PT_distance"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        settings = active_object(context).saddleback.distance
        layout = self.split_layout(context)
        layout.prop(settings, "lengths")
        rows.draw_automatic(layout, settings, "limit", zero="None")
        rows.draw_quality(layout, settings)
        layout.prop(settings, "use_modifiers")
        rows.draw_name(layout, settings, "distance_attribute", "Attribute")


class SADDLEBACK_PT_isolines(SaddlebackSubPanel, bpy.types.Panel):
    """Lines of equal distance."""

    bl_label = "Isolines"
    bl_parent_id = "SADDLEBACK_PT_distance"

    def draw_header(self, context: bpy.types.Context) -> None:
        """Draws the switch."""
        self.layout.enabled = not context.window_manager.saddleback_running
        self.layout.prop(active_object(context).saddleback.distance, "make_isolines", text="")

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        rows.draw_isolines(self.split_layout(context), active_object(context).saddleback.distance)


class SADDLEBACK_PT_preview(SaddlebackSubPanel, bpy.types.Panel):
    """The distances in colors."""

    bl_label = "Preview Material"
    bl_parent_id = "SADDLEBACK_PT_distance"

    def draw_header(self, context: bpy.types.Context) -> None:
        """Draws the switch."""
        self.layout.enabled = not context.window_manager.saddleback_running
        self.layout.prop(active_object(context).saddleback.distance, "make_preview", text="")

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        settings = active_object(context).saddleback.distance
        layout = self.split_layout(context)
        layout.active = settings.make_preview
        layout.prop(settings, "preview_lines")


class SADDLEBACK_PT_path(SaddlebackSubPanel, bpy.types.Panel):
    """Shortest ways along the surface."""

    bl_label = "Path"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        item = active_object(context)
        settings = item.saddleback.path
        layout = self.split_layout(context)
        draw_button(layout, context, "saddleback.path", "CURVE_PATH")
        draw_state(layout, context, "path")
        rows.draw_path_points(layout.column(), settings, item)
        rows.draw_length(layout, settings, "path_radius")
        rows.draw_length(layout, settings, "lift")


class SADDLEBACK_PT_path_advanced(SaddlebackAdvancedPanel, bpy.types.Panel):
    """How paths are found."""

    bl_parent_id = "SADDLEBACK_PT_path"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        settings = active_object(context).saddleback.path
        layout = self.split_layout(context)
        layout.prop(settings, "lengths")
        row = layout.row()
        row.active = settings.connect != "PAIRS"
        row.prop(settings, "smooth")
        row = layout.row()
        row.active = settings.connect == "LOOP"
        row.prop(settings, "tighten")
        row = layout.row()
        row.active = settings.k > 0 or settings.quality != "EXACT"  # exact paths are straight
        row.prop(settings, "shorten")
        rows.draw_quality(layout, settings)
        layout.prop(settings, "use_modifiers")


class SADDLEBACK_PT_ribbon(SaddlebackSubPanel, bpy.types.Panel):
    """Bands along curves."""

    bl_label = "Ribbon"
    bl_parent_id = "SADDLEBACK_PT_path"  # one more heading would make the tab higher than a screen
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        settings = active_object(context).saddleback.ribbon
        layout = self.split_layout(context)
        draw_button(layout, context, "saddleback.ribbon", "MOD_CURVE")
        draw_state(layout, context, "ribbon")
        rows.draw_ribbon(layout.column(), settings)


class SADDLEBACK_PT_ribbon_advanced(SaddlebackAdvancedPanel, bpy.types.Panel):
    """How ribbons are measured."""

    bl_parent_id = "SADDLEBACK_PT_ribbon"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        settings = active_object(context).saddleback.ribbon
        layout = self.split_layout(context)
        layout.prop(settings, "lengths")
        layout.prop(settings, "use_modifiers")


CLASSES = (
    SADDLEBACK_PT_distance,
    SADDLEBACK_PT_isolines,
    SADDLEBACK_PT_preview,
    SADDLEBACK_PT_distance_advanced,
    SADDLEBACK_PT_path,
    SADDLEBACK_PT_path_advanced,
    SADDLEBACK_PT_ribbon,
    SADDLEBACK_PT_ribbon_advanced,
)

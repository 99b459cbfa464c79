# SPDX-License-Identifier: GPL-3.0-or-later
"""The tab "Saddleback" in the 3D View's sidebar: its top, its panels in their order, Bake and Repair."""

from __future__ import annotations

import bpy

from .. import compat
from ..bridge.inputs.source import active_object, why_not
from ..bridge.outputs.out_looks import is_hidden
from ..bridge.outputs.solid_colors import is_colored
from . import distance_panels, layer_rows, live_rows, look_rows, plane_panels, rows, shape_panels, tessellate_panels
from .panel_parts import (
    SaddlebackAdvancedPanel,
    SaddlebackPanel,
    SaddlebackSubPanel,
    draw_button,
    draw_figures,
    draw_state,
    native_problem,
)
from .texts import draw_text


class SADDLEBACK_PT_main(SaddlebackPanel, bpy.types.Panel):
    """Shows what Saddleback works on, what it is doing, what it did."""

    bl_label = "Saddleback"

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        """Draws the menu of looks that were kept."""
        if SaddlebackSubPanel.poll(context):
            look_rows.SADDLEBACK_PT_look_presets.draw_panel_header(self.layout)

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout = self.layout
        problem = native_problem()
        if problem:
            box = layout.box()
            box.alert = True
            draw_text(box, context, problem, "ERROR")
            return
        problem = why_not(context)
        if problem:
            draw_text(layout, context, problem, "INFO")
            layout.operator("saddleback.stipple_image", icon="IMAGE_DATA")
            return
        item = active_object(context)
        column = layout.column()
        column.enabled = not context.window_manager.saddleback_running
        layer_rows.draw_layers(column, item)
        layer_rows.draw_region(column, item)
        live_rows.draw_live(layout, context, item)
        look_rows.draw_looks(layout, context, item)
        if sum(other.type == "MESH" for other in context.view_layer.objects.selected) > 1:
            layout.prop(context.window_manager, "saddleback_all_selected")
        row = layout.row()
        row.label(text=item.name, icon="OUTLINER_OB_MESH")
        if context.window_manager.saddleback_running:
            compat.draw_progress(row, context.window_manager)
        else:
            if context.space_data.shading.type == "SOLID":  # which shows colors of cells and shapes in one of its ways
                row.operator("saddleback.show_colors", text="", icon="COLOR", depress=is_colored(context.space_data))
            row.operator("saddleback.clear", text="", icon="TRASH")
            icon = "HIDE_ON" if is_hidden(item) else "HIDE_OFF"
            row.operator("saddleback.hide_source", text="", icon=icon, depress=is_hidden(item))


class SADDLEBACK_PT_barriers(SaddlebackPanel, bpy.types.Panel):
    """Lines that the pattern of the layer does not cross."""

    bl_region_type, bl_category = "HEADER", ""  # a popover of the tab has its place nowhere else
    bl_label = "Barriers"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layer_rows.draw_barriers(self.layout, active_object(context))


class SADDLEBACK_PT_bake(SaddlebackSubPanel, bpy.types.Panel):
    """Images of the cells."""

    bl_label = "Bake"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        item = active_object(context)
        layout = self.split_layout(context)
        draw_button(layout, context, "saddleback.bake", "TEXTURE")
        draw_state(layout, context, "bake")
        rows.draw_maps(layout.column(), item.saddleback.bake, item)


class SADDLEBACK_PT_bake_advanced(SaddlebackAdvancedPanel, bpy.types.Panel):
    """How images are written."""

    bl_parent_id = "SADDLEBACK_PT_bake"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        item = active_object(context)
        rows.draw_images(self.split_layout(context), item.saddleback.bake, item)


class SADDLEBACK_PT_repair(SaddlebackSubPanel, bpy.types.Panel):
    """Faults of the mesh."""

    bl_label = "Repair"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout = self.split_layout(context)
        draw_button(layout, context, "saddleback.repair", "TOOL_SETTINGS")
        draw_state(layout, context, "repair")
        draw_figures(layout, context, "repair")
        settings = active_object(context).saddleback.repair
        rows.draw_automatic(layout, settings, "weld_distance", "Weld", zero="Same Place")
        layout.prop(settings, "close_cracks")
        rows.draw_automatic(layout, settings, "fill_holes", zero="None")


CLASSES = (
    look_rows.SADDLEBACK_PT_look_presets,
    layer_rows.SADDLEBACK_UL_layers,
    SADDLEBACK_PT_main,
    SADDLEBACK_PT_barriers,
    *tessellate_panels.CLASSES,
    *distance_panels.CLASSES,
    *plane_panels.CLASSES,
    *shape_panels.CLASSES,
    SADDLEBACK_PT_bake,
    SADDLEBACK_PT_bake_advanced,
    SADDLEBACK_PT_repair,
)

# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels of cells on surfaces."""

from __future__ import annotations

import bpy

from ..bridge.inputs.source import active_object
from ..bridge.outputs.out_collection import find_output
from ..bridge.outputs.out_shell import SHELL_ROLE
from . import rows
from .panel_parts import SaddlebackAdvancedPanel, SaddlebackSubPanel, draw_button, draw_figures, draw_state
from .texts import draw_text

HEADER_WIDTH = 7.5  # of a title with a value beside it, at the default width of the sidebar


class SADDLEBACK_PT_tessellate(SaddlebackSubPanel, bpy.types.Panel):
    """Cells: how many, where, and the button."""

    bl_label = "Tessellate"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        item = active_object(context)
        settings = item.saddleback.tessellate
        layout = self.split_layout(context)
        draw_button(layout, context, "saddleback.tessellate", "MOD_EXPLODE", "saddleback.relax_live")
        draw_state(layout, context, "tessellate", has_info=True)
        if find_output(item, SHELL_ROLE) is not None:
            rows.draw_exports(layout)
        rows.draw_sites(layout.column(), settings)


class SADDLEBACK_PT_density(SaddlebackSubPanel, bpy.types.Panel):
    """Shows where cells are small."""

    bl_label = ""
    bl_parent_id = "SADDLEBACK_PT_tessellate"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context: bpy.types.Context) -> None:
        """Draws the title and what density comes from, which so is seen while the panel is closed."""
        row = self.layout.row()
        row.ui_units_x = HEADER_WIDTH
        row.enabled = not context.window_manager.saddleback_running
        row.label(text="Density")
        row.prop(active_object(context).saddleback.tessellate, "density_source", text="")

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        item = active_object(context)
        layout = self.split_layout(context)
        rows.draw_density_of_source(layout, item.saddleback.tessellate, item)
        rows.draw_paint_buttons(layout, "tessellate")


class SaddlebackOutputPanel(SaddlebackSubPanel):
    """Mixin: a panel whose header switches an output on."""

    bl_parent_id = "SADDLEBACK_PT_tessellate"
    switch: str

    def draw_header(self, context: bpy.types.Context) -> None:
        """Draws the switch."""
        self.layout.enabled = not context.window_manager.saddleback_running
        self.layout.prop(active_object(context).saddleback.tessellate, self.switch, text="")


class SADDLEBACK_PT_edges(SaddlebackOutputPanel, bpy.types.Panel):
    """The lines between cells."""

    bl_label = "Edges"
    bl_options = {"DEFAULT_CLOSED"}
    switch = "make_edges"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        rows.draw_edges(self.split_layout(context), active_object(context).saddleback.tessellate)


class SADDLEBACK_PT_cells(SaddlebackOutputPanel, bpy.types.Panel):
    """The mesh of the cells."""

    bl_label = "Cells"
    bl_options = {"DEFAULT_CLOSED"}
    switch = "make_cells"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        rows.draw_cells(self.split_layout(context), active_object(context).saddleback.tessellate)


class SADDLEBACK_PT_centers(SaddlebackOutputPanel, bpy.types.Panel):
    """The centers of the cells."""

    bl_label = "Centers"
    bl_options = {"DEFAULT_CLOSED"}
    switch = "make_centers"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        layout = self.split_layout(context)
        layout.operator("saddleback.edit_sites", icon="EDITMODE_HLT")
        rows.draw_centers(layout, active_object(context).saddleback.tessellate)


class SADDLEBACK_PT_dual(SaddlebackOutputPanel, bpy.types.Panel):
    """The triangle mesh of the sites."""

    bl_label = "Dual Mesh"
    bl_options = {"DEFAULT_CLOSED"}
    switch = "make_dual"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        rows.draw_dual(self.split_layout(context), active_object(context).saddleback.tessellate)


class SADDLEBACK_PT_shell(SaddlebackOutputPanel, bpy.types.Panel):
    """Ribs between the cells, to be printed."""

    bl_label = "Lamp Shell"
    bl_options = {"DEFAULT_CLOSED"}
    switch = "make_shell"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        rows.draw_shell(self.split_layout(context), active_object(context).saddleback.tessellate)


class SADDLEBACK_PT_tessellate_advanced(SaddlebackAdvancedPanel, bpy.types.Panel):
    """How cells are found."""

    bl_parent_id = "SADDLEBACK_PT_tessellate"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        settings = active_object(context).saddleback.tessellate
        layout = self.split_layout(context)
        layout.prop(settings, "lengths")
        layout.prop(settings, "edge_kind", text="Edges")
        rows.draw_density_advanced(layout.column(), settings)
        rows.draw_sites_advanced(layout.column(), settings)
        rows.draw_quality(layout, settings)
        layout.prop(settings, "use_modifiers")
        rows.draw_attributes(layout.column(), settings)


class SADDLEBACK_PT_info(SaddlebackSubPanel, bpy.types.Panel):
    """Shows the lengths that were used, and how even the cells are."""

    bl_label = "Info"
    bl_parent_id = "SADDLEBACK_PT_tessellate_advanced"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        for line in active_object(context).saddleback.tessellate.told.splitlines()[1:]:
            draw_text(self.layout, context, line, "BLANK1")
        draw_figures(self.layout, context, "tessellate")


CLASSES = (
    SADDLEBACK_PT_tessellate,
    SADDLEBACK_PT_density,
    SADDLEBACK_PT_edges,
    SADDLEBACK_PT_cells,
    SADDLEBACK_PT_centers,
    SADDLEBACK_PT_dual,
    SADDLEBACK_PT_shell,
    SADDLEBACK_PT_tessellate_advanced,
    SADDLEBACK_PT_info,
)

# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels of diagrams of the plane."""

from __future__ import annotations

import bpy

from ..bridge.inputs.source import active_object
from . import rows
from .panel_parts import SaddlebackAdvancedPanel, SaddlebackSubPanel, draw_button, draw_state


class SADDLEBACK_PT_voronoi_2d(SaddlebackSubPanel, bpy.types.Panel):
    """Diagrams of the plane."""

    bl_label = "Voronoi 2D"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        item = active_object(context)
        settings = item.saddleback.voronoi_2d
        layout = self.split_layout(context)
        draw_button(layout, context, "saddleback.voronoi_2d", "MESH_GRID")
        draw_state(layout, context, "voronoi_2d")
        rows.draw_plane_sites(layout.column(), settings, item)


class SADDLEBACK_PT_plane_advanced(SaddlebackAdvancedPanel, bpy.types.Panel):
    """How the diagram is found."""

    bl_parent_id = "SADDLEBACK_PT_voronoi_2d"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        settings = active_object(context).saddleback.voronoi_2d
        layout = self.split_layout(context)
        layout.prop(settings, "lengths")
        layout.prop(settings, "edge_kind", text="Edges")
        row = layout.row()
        row.active = settings.sites_source in ("COUNT", "IMAGE")
        row.prop(settings, "seed")
        layout.prop(settings, "use_modifiers")


class SaddlebackPlaneOutputPanel(SaddlebackSubPanel):
    """Mixin: a panel whose header switches an output of the diagram on."""

    bl_parent_id = "SADDLEBACK_PT_voronoi_2d"
    switch: str

    def draw_header(self, context: bpy.types.Context) -> None:
        """Draws the switch."""
        self.layout.enabled = not context.window_manager.saddleback_running
        self.layout.prop(active_object(context).saddleback.voronoi_2d, self.switch, text="")


class SADDLEBACK_PT_plane_edges(SaddlebackPlaneOutputPanel, bpy.types.Panel):
    """The lines between cells."""

    bl_label = "Edges"
    bl_options = {"DEFAULT_CLOSED"}
    switch = "make_edges"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        rows.draw_edges(self.split_layout(context), active_object(context).saddleback.voronoi_2d)


class SADDLEBACK_PT_plane_cells(SaddlebackPlaneOutputPanel, bpy.types.Panel):
    """The mesh of the cells."""

    bl_label = "Cells"
    bl_options = {"DEFAULT_CLOSED"}
    switch = "make_cells"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        rows.draw_cells(self.split_layout(context), active_object(context).saddleback.voronoi_2d)


class SADDLEBACK_PT_plane_centers(SaddlebackPlaneOutputPanel, bpy.types.Panel):
    """The sites."""

    bl_label = "Centers"
    bl_options = {"DEFAULT_CLOSED"}
    switch = "make_centers"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        rows.draw_centers(self.split_layout(context), active_object(context).saddleback.voronoi_2d)


class SADDLEBACK_PT_sweep(SaddlebackPlaneOutputPanel, bpy.types.Panel):
    """The sweep circle, frame by frame."""

    bl_label = "Animate"
    bl_options = {"DEFAULT_CLOSED"}
    switch = "animate"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        rows.draw_sweep(self.split_layout(context), active_object(context).saddleback.voronoi_2d)


CLASSES = (
    SADDLEBACK_PT_voronoi_2d,
    SADDLEBACK_PT_plane_edges,
    SADDLEBACK_PT_plane_cells,
    SADDLEBACK_PT_plane_centers,
    SADDLEBACK_PT_sweep,
    SADDLEBACK_PT_plane_advanced,
)

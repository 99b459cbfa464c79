# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels of the tab "Saddleback" in the 3D View's sidebar."""

from __future__ import annotations

import functools

import bpy

from .. import compat
from ..bridge.inputs.source import active_object, why_not
from ..bridge.outputs.out_looks import is_hidden
from ..core import native
from . import layer_rows, live_rows, look_rows, rows
from .texts import draw_text


class SaddlebackPanel:
    """Mixin: where all panels of the tab are."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Saddleback"


class SaddlebackSubPanel(SaddlebackPanel):
    """Mixin: a panel within the tab that is there when the operators can run."""

    bl_parent_id = "SADDLEBACK_PT_main"
    layout: bpy.types.UILayout

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Allows it only where something can be done."""
        return not _native_problem() and not why_not(context)

    def split_layout(self, context: bpy.types.Context) -> bpy.types.UILayout:
        """Names to the left and values to the right; gray while a run goes on."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.enabled = not context.window_manager.saddleback_running
        return layout


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
        problem = _native_problem()
        if problem:
            box = layout.box()
            box.alert = True
            draw_text(box, context, problem, "ERROR")
            return
        problem = why_not(context)
        if problem:
            draw_text(layout, context, problem, "INFO")
            return
        item = active_object(context)
        column = layout.column()
        column.enabled = not context.window_manager.saddleback_running
        layer_rows.draw_layers(column, item)
        layer_rows.draw_region(column, item)
        live_rows.draw_live(layout, context, item)
        look_rows.draw_looks(layout, item)
        layout.label(text=item.name, icon="OUTLINER_OB_MESH")
        if sum(other.type == "MESH" for other in context.view_layer.objects.selected) > 1:
            layout.prop(context.window_manager, "saddleback_all_selected")
        row = layout.row()
        if context.window_manager.saddleback_running:
            compat.draw_progress(row, context.window_manager)
        else:
            row.operator("saddleback.clear", text="Clear Results", icon="TRASH")
            icon = "HIDE_ON" if is_hidden(item) else "HIDE_OFF"
            row.operator("saddleback.hide_source", text="", icon=icon, depress=is_hidden(item))
        shading = context.space_data.shading
        if shading.type == "SOLID":  # which shows the colors of cells and shapes in one of its ways only
            layout.prop(shading, "color_type", text="Color")


def _draw_button(
    layout: bpy.types.UILayout, context: bpy.types.Context, operator: str, icon: str, live: str = ""
) -> None:
    """The button that starts a run, always in the same place: while one goes on its progress stands there.

    A button that is gray under the mouse stays dead in Blender after it could be pressed again; a new one does not.
    """
    row = layout.row()
    row.scale_y = 1.4
    if context.window_manager.saddleback_running:
        compat.draw_progress(row, context.window_manager)
    else:
        row.operator(operator, icon=icon)
        if live:
            row.operator(live, text="", icon="PLAY")


def _draw_state(layout: bpy.types.UILayout, context: bpy.types.Context, kind: str) -> None:
    """The run that goes on; else the way out of an error, or what the last run of this kind made of the object."""
    manager, item = context.window_manager, active_object(context)
    is_last = manager.saddleback_kind == kind
    if manager.saddleback_running:
        if is_last:
            draw_text(layout, context, manager.saddleback_text, "TIME")
            layout.label(text="Press ESC to stop", icon="EVENT_ESC")
    elif is_last and manager.saddleback_needs_repair == item.name:
        box = layout.box()
        box.alert = True
        draw_text(box, context, "This mesh has faults that keep it from being a surface", "ERROR")
        row = box.row()
        row.alert = False
        row.scale_y = 1.3
        row.operator("saddleback.repair", text="Repair Mesh", icon="TOOL_SETTINGS")
    else:
        for number, line in enumerate(getattr(item.saddleback, kind).told.splitlines()):
            draw_text(layout, context, line, "BLANK1" if number else "CHECKMARK")


def _draw_figures(layout: bpy.types.UILayout, context: bpy.types.Context, kind: str) -> None:
    """Numbers of the last run of this kind on the object."""
    for line in getattr(active_object(context).saddleback, kind).figures.splitlines():
        draw_text(layout, context, line, "BLANK1")


class SADDLEBACK_PT_tessellate(SaddlebackSubPanel, bpy.types.Panel):
    """Cells: how many, where, and the button."""

    bl_label = "Tessellate"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        settings = active_object(context).saddleback.tessellate
        layout = self.split_layout(context)
        _draw_button(layout, context, "saddleback.tessellate", "MOD_EXPLODE", "saddleback.relax_live")
        _draw_state(layout, context, "tessellate")
        rows.draw_sites(layout.column(), settings)


class SADDLEBACK_PT_density(SaddlebackSubPanel, bpy.types.Panel):
    """Shows where cells are small."""

    bl_label = "Density"
    bl_parent_id = "SADDLEBACK_PT_tessellate"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        item = active_object(context)
        layout = self.split_layout(context)
        rows.draw_density(layout, item.saddleback.tessellate, item)
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
        rows.draw_centers(self.split_layout(context), active_object(context).saddleback.tessellate)


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


class SaddlebackAdvancedPanel(SaddlebackSubPanel):
    """Mixin: what is seldom changed."""

    bl_label = "Advanced"
    bl_options = {"DEFAULT_CLOSED"}


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


class SADDLEBACK_PT_attributes(SaddlebackSubPanel, bpy.types.Panel):
    """Names of what is written on the mesh."""

    bl_label = "Attributes"
    bl_parent_id = "SADDLEBACK_PT_tessellate"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        rows.draw_attributes(self.split_layout(context), active_object(context).saddleback.tessellate)


class SADDLEBACK_PT_info(SaddlebackSubPanel, bpy.types.Panel):
    """Shows how even the cells are."""

    bl_label = "Info"
    bl_parent_id = "SADDLEBACK_PT_tessellate"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        _draw_figures(self.layout, context, "tessellate")


class SADDLEBACK_PT_distance(SaddlebackSubPanel, bpy.types.Panel):
    """Distances along the surface."""

    bl_label = "Distance"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        item = active_object(context)
        settings = item.saddleback.distance
        layout = self.split_layout(context)
        _draw_button(layout, context, "saddleback.distance", "DRIVER_DISTANCE")
        _draw_state(layout, context, "distance")
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
        _draw_button(layout, context, "saddleback.path", "CURVE_PATH")
        _draw_state(layout, context, "path")
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
        row.active = settings.k > 0 or settings.quality != "EXACT"  # exact paths are straight
        row.prop(settings, "shorten")
        rows.draw_quality(layout, settings)
        layout.prop(settings, "use_modifiers")


class SADDLEBACK_PT_voronoi_2d(SaddlebackSubPanel, bpy.types.Panel):
    """Diagrams of the plane."""

    bl_label = "Voronoi 2D"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        item = active_object(context)
        settings = item.saddleback.voronoi_2d
        layout = self.split_layout(context)
        _draw_button(layout, context, "saddleback.voronoi_2d", "MESH_GRID")
        _draw_state(layout, context, "voronoi_2d")
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


class SADDLEBACK_PT_direction_field(SaddlebackSubPanel, bpy.types.Panel):
    """Shows which way things point."""

    bl_label = "Direction Field"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        item = active_object(context)
        layout = self.split_layout(context)
        _draw_button(layout, context, "saddleback.direction_field", "FORCE_WIND")
        _draw_state(layout, context, "direction_field")
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
        _draw_button(layout, context, "saddleback.distribute", "STICKY_UVS_DISABLE")
        _draw_state(layout, context, "distribute")
        _draw_figures(layout, context, "distribute")
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


class SADDLEBACK_PT_bake(SaddlebackSubPanel, bpy.types.Panel):
    """Images of the cells."""

    bl_label = "Bake"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        item = active_object(context)
        layout = self.split_layout(context)
        _draw_button(layout, context, "saddleback.bake", "TEXTURE")
        _draw_state(layout, context, "bake")
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
        _draw_button(layout, context, "saddleback.repair", "TOOL_SETTINGS")
        _draw_state(layout, context, "repair")
        _draw_figures(layout, context, "repair")
        settings = active_object(context).saddleback.repair
        rows.draw_automatic(layout, settings, "weld_distance", "Weld", zero="Same Place")
        layout.prop(settings, "close_cracks")
        rows.draw_automatic(layout, settings, "fill_holes", zero="None")


@functools.cache
def _native_problem() -> str:
    """Asked once: an answer that changes needs a restart of Blender anyway."""
    return native.problem()


CLASSES = (
    look_rows.SADDLEBACK_PT_look_presets,
    layer_rows.SADDLEBACK_UL_layers,
    SADDLEBACK_PT_main,
    SADDLEBACK_PT_tessellate,
    SADDLEBACK_PT_density,
    SADDLEBACK_PT_edges,
    SADDLEBACK_PT_cells,
    SADDLEBACK_PT_centers,
    SADDLEBACK_PT_dual,
    SADDLEBACK_PT_shell,
    SADDLEBACK_PT_tessellate_advanced,
    SADDLEBACK_PT_attributes,
    SADDLEBACK_PT_info,
    SADDLEBACK_PT_distance,
    SADDLEBACK_PT_isolines,
    SADDLEBACK_PT_preview,
    SADDLEBACK_PT_distance_advanced,
    SADDLEBACK_PT_path,
    SADDLEBACK_PT_path_advanced,
    SADDLEBACK_PT_voronoi_2d,
    SADDLEBACK_PT_plane_edges,
    SADDLEBACK_PT_plane_cells,
    SADDLEBACK_PT_plane_centers,
    SADDLEBACK_PT_sweep,
    SADDLEBACK_PT_plane_advanced,
    SADDLEBACK_PT_direction_field,
    SADDLEBACK_PT_arrows,
    SADDLEBACK_PT_streamlines,
    SADDLEBACK_PT_field_advanced,
    SADDLEBACK_PT_distribute,
    SADDLEBACK_PT_shape_density,
    SADDLEBACK_PT_shape_outputs,
    SADDLEBACK_PT_shapes_advanced,
    SADDLEBACK_PT_bake,
    SADDLEBACK_PT_bake_advanced,
    SADDLEBACK_PT_repair,
)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of settings, the same in a panel (settings kept on the object) and for an operator (its own properties)."""

from __future__ import annotations

from typing import Any

import bpy

# Density source -> the list of the mesh or object that its name is chosen from, and the icon.
DENSITY_LISTS = {
    "VERTEX_GROUP": ("vertex_groups", "GROUP_VERTEX"),
    "ATTRIBUTE": ("attributes", "SPREADSHEET"),
    "COLOR": ("color_attributes", "GROUP_VCOL"),
    "IMAGE": ("uv_layers", "GROUP_UVS"),
    "SPREAD": ("vertex_groups", "GROUP_VERTEX"),
}


def draw_sites(layout: bpy.types.UILayout, settings: Any) -> None:
    """Draws where the cells' centers come from, and how even they become."""
    if is_placed(settings):
        row = layout.row(align=True)
        row.use_property_split = False
        row.prop(settings, "sites_source", text="")
        row.prop(settings, "count" if settings.sites_source == "COUNT" else "cell_size", text="")
    else:
        layout.prop(settings, "sites_source")
        if settings.sites_source == "OBJECT":
            draw_object(layout, settings, "sites_object")
        layout.prop(settings, "relax_sites")
    row = layout.row()
    row.active = is_placed(settings) or settings.relax_sites
    row.prop(settings, "evenness")


def is_placed(settings: Any) -> bool:
    """Tells whether sites are placed by the run and not chosen."""
    return settings.sites_source in ("COUNT", "SIZE")


def draw_sites_advanced(layout: bpy.types.UILayout, settings: Any) -> None:
    """Draws how sites are found and evened out in detail."""
    layout.prop(settings, "stretch")
    layout.prop(settings, "follow_curvature")
    column = layout.column()
    column.active = is_placed(settings) or settings.relax_sites
    if is_placed(settings):
        column.prop(settings, "seed")
    column.prop(settings, "iterations")
    if is_placed(settings):
        column.prop(settings, "starts")
    column.prop(settings, "annealing")
    column.prop(settings, "method")
    if is_placed(settings):
        _draw_held(layout.column(heading="Keep", align=True), settings)


def _draw_held(layout: bpy.types.UILayout, settings: Any) -> None:
    """The lines on which sites stay."""
    layout.prop(settings, "hold_sharp")
    row = layout.row()
    row.active = settings.hold_sharp
    row.prop(settings, "sharp_angle", text="Angle")
    layout.prop(settings, "hold_marked")
    layout.prop(settings, "hold_boundary")


def draw_density(layout: bpy.types.UILayout, settings: Any, item: bpy.types.Object) -> None:
    """Draws what says where cells are small."""
    layout.prop(settings, "density_source", text="Source")
    draw_density_of_source(layout, settings, item)


def draw_density_of_source(layout: bpy.types.UILayout, settings: Any, item: bpy.types.Object) -> None:
    """Draws what the chosen source of density asks for."""
    source = settings.density_source
    if source in DENSITY_LISTS:
        name, icon = DENSITY_LISTS[source]
        owner = item if name == "vertex_groups" else item.data
        text = "UV Map" if source == "IMAGE" else "Name"
        layout.prop_search(settings, "density_name", owner, name, text=text, icon=icon)
    if source == "IMAGE":
        draw_pointer(layout, settings, "density_image", "images")
    elif source == "DISTANCE":
        draw_object(layout, settings, "density_object")
        if not settings.density_object:
            draw_collection(layout, settings, "density_collection")
    if source in ("COLOR", "IMAGE"):
        layout.prop(settings, "density_channel")
    if source not in ("UNIFORM", "CURVATURE", "DISTANCE"):
        draw_automatic(layout, settings, "density_smaller_by", zero="By Paint")


def draw_density_advanced(layout: bpy.types.UILayout, settings: Any) -> None:
    """Draws how the paint, or the way from curves, becomes density."""
    if settings.density_source == "DISTANCE":
        draw_automatic(layout, settings, "density_reach")
        layout.prop(settings, "density_beyond")
    if settings.density_source != "UNIFORM":
        layout.prop(settings, "density_invert")
        layout.prop(settings, "density_contrast")


def draw_paint_buttons(layout: bpy.types.UILayout, settings_name: str) -> None:
    """Buttons that begin to paint the density of one operator's settings."""
    row = layout.row(align=True)
    for paint, text, icon in (("WEIGHT", "Weights", "WPAINT_HLT"), ("COLOR", "Colors", "VPAINT_HLT")):
        button = row.operator("saddleback.paint_density", text=text, icon=icon)
        button.paint, button.settings = paint, settings_name


def draw_pens(layout: bpy.types.UILayout) -> None:
    """Buttons that begin to draw strokes for a field."""
    row = layout.row(align=True)
    row.operator("saddleback.draw_strokes", text="Draw", icon="GREASEPENCIL").pen = "ANNOTATE"
    row.operator("saddleback.draw_strokes", text="Curves", icon="CURVE_BEZCURVE").pen = "CURVE"


def is_relative(settings: Any) -> bool:
    """Tells whether lengths are given as shares."""
    return bool(settings.lengths == "RELATIVE")


def draw_length(layout: bpy.types.UILayout, settings: Any, name: str, text: str | None = None) -> None:
    """A length in the unit that is chosen."""
    layout.prop(settings, f"{name}_share" if is_relative(settings) else name, text=text)


def draw_edges(layout: bpy.types.UILayout, settings: Any) -> None:
    """The object of the lines between cells."""
    layout.active = settings.make_edges
    draw_length(layout, settings, "edge_radius")


def draw_cells(layout: bpy.types.UILayout, settings: Any) -> None:
    """The mesh of the cells."""
    layout.active = settings.make_cells
    if hasattr(settings, "cell_faces"):  # cells of the plane have one anyway
        layout.prop(settings, "cell_faces", text="Faces")
        if settings.cell_faces == "PATCHES":
            layout.prop(settings, "patch_error")
        layout = layout.column()
        layout.active = settings.cell_faces == "SURFACE"
    _draw_painted_length(layout.column(), settings, "gap")
    _draw_painted_length(layout.column(), settings, "thickness")
    column = layout.column()
    column.active = (settings.thickness_share if is_relative(settings) else settings.thickness) > 0.0
    _draw_painted_length(column.column(), settings, "inset")
    if hasattr(settings, "dome"):  # cells of the plane have a plateau
        column.prop(settings, "dome")
    column.prop(settings, "underside")
    if hasattr(settings, "local_uv"):  # cells of the plane have none
        layout.prop(settings, "local_uv")


def _draw_painted_length(layout: bpy.types.UILayout, settings: Any, name: str) -> None:
    """A length of cells, and what it is multiplied by."""
    draw_length(layout, settings, name)
    if hasattr(settings, f"{name}_by"):  # cells of the plane are all alike
        row = layout.row()
        row.active = (getattr(settings, f"{name}_share") if is_relative(settings) else getattr(settings, name)) > 0.0
        row.prop(settings, f"{name}_by", text="By")


def draw_centers(layout: bpy.types.UILayout, settings: Any) -> None:
    """The points at the centers, and what stands on them."""
    layout.active = settings.make_centers
    draw_object(layout, settings, "instance_object")
    if not settings.instance_object:
        layout.prop(settings, "instance_dots")
    column = layout.column()
    column.active = bool(settings.instance_object) or settings.instance_dots
    column.prop(settings, "instance_size")
    column.prop(settings, "instance_scale", text="Scale")


def draw_dual(layout: bpy.types.UILayout, settings: Any) -> None:
    """The remesh."""
    layout.active = settings.make_dual
    layout.prop(settings, "dual_faces", text="Faces")
    layout.prop(settings, "dual_policy", text="Policy")
    layout.prop(settings, "keep_count")


def draw_shell(layout: bpy.types.UILayout, settings: Any) -> None:
    """The printable ribs."""
    layout.active = settings.make_shell
    layout.prop(settings, "in_millimeters")
    for name, text in (("rib_width", "Width"), ("rib_thickness", "Thickness")):
        if settings.in_millimeters:
            layout.prop(settings, f"{name}_mm", text=text)
        elif is_relative(settings):
            draw_length(layout, settings, name, text)
        else:
            draw_automatic(layout, settings, name, text)
    if settings.in_millimeters:
        layout.prop(settings, "base_height_mm")
    else:
        draw_length(layout, settings, "base_height")
    layout.prop(settings, "rib_profile")
    draw_automatic(layout, settings, "shell_faces", zero="All")
    draw_exports(layout)


def draw_exports(layout: bpy.types.UILayout) -> None:
    """Buttons that save the printable ribs."""
    row = layout.row(align=True)
    row.operator("saddleback.export_stl", icon="EXPORT")
    row.operator("saddleback.export_3mf", icon="EXPORT")


def draw_attributes(layout: bpy.types.UILayout, settings: Any) -> None:
    """Names of what is written on the mesh itself."""
    draw_name(layout, settings, "cell_attribute", "Cell")
    draw_name(layout, settings, "distance_attribute", "Distance")
    column = layout.column()
    column.active = settings.density_source != "UNIFORM"
    draw_name(column, settings, "density_attribute", "Density")
    layout.prop(settings, "write_edge_distance")
    column = layout.column()
    column.active = settings.write_edge_distance
    draw_name(column, settings, "edge_distance_attribute", "To Edge")


def draw_name(layout: bpy.types.UILayout, settings: Any, name: str, label: str) -> None:
    """A name that is too long to stand beside its label."""
    column = layout.column(align=True)
    column.use_property_split = False
    column.label(text=label)
    column.prop(settings, name, text="")


def draw_automatic(
    layout: bpy.types.UILayout, settings: Any, name: str, text: str | None = None, zero: str = "Auto"
) -> None:
    """A number of which 0 means something else, mostly that it is found; then a word beside it says so."""
    row = layout.row(align=True)
    row.prop(settings, name, text=text)
    if not getattr(settings, name):
        row.label(text=zero)


def draw_quality(layout: bpy.types.UILayout, settings: Any) -> None:
    """Draws how exact distances are; a neighborhood, where one is set, stands for the quality."""
    column = layout.column()
    row = column.row()
    row.active = settings.k == 0
    row.prop(settings, "quality")
    draw_automatic(column, settings, "k")
    row = column.row()
    row.active = settings.k > 0 or settings.quality != "EXACT"
    row.prop(settings, "cache_on_disk")


def draw_plane_sites(layout: bpy.types.UILayout, settings: Any, item: bpy.types.Object) -> None:
    """The plane of a diagram, and where its sites come from."""
    layout.prop(settings, "space")
    if settings.space == "UV":
        layout.prop_search(settings, "uv_name", item.data, "uv_layers", text="UV Map", icon="GROUP_UVS")
    layout.prop(settings, "sites_source")
    source = settings.sites_source
    if source == "IMAGE":
        draw_pointer(layout, settings, "image_name", "images")
        layout.prop(settings, "image_invert")
    if source == "OBJECT":
        draw_object(layout, settings, "sites_object")
    if source in ("COUNT", "IMAGE"):
        layout.prop(settings, "count")
    else:
        layout.prop(settings, "weights_name")
        layout.prop(settings, "relax_sites")
    row = layout.row()
    row.active = source in ("COUNT", "IMAGE") or settings.relax_sites
    row.prop(settings, "iterations")
    layout.prop(settings, "equal_cells")
    if settings.space in ("AUTO", "OUTLINE"):
        layout.prop(settings, "seamless")


def draw_sweep(layout: bpy.types.UILayout, settings: Any) -> None:
    """Where a sweep's circles grow from, and its frames."""
    layout.active = settings.animate
    layout.prop(settings, "circles")
    if settings.circles == "EMPTIES":
        draw_collection(layout, settings, "circles_collection")
    elif settings.circles == "COUNT":
        layout.prop(settings, "circle_count")
    column = layout.column(align=True)
    column.prop(settings, "frame_start")
    column.prop(settings, "frame_end")


def draw_field(layout: bpy.types.UILayout, settings: Any, item: bpy.types.Object) -> None:
    """Draws what a field is made of and what it follows."""
    layout.prop(settings, "symmetry")
    layout.prop(settings, "align")
    if settings.align == "CURVATURE":
        layout.prop(settings, "align_weight")
    layout.prop(settings, "strokes")
    if settings.strokes == "OBJECT":
        draw_object(layout, settings, "strokes_object")
    elif settings.strokes == "COLLECTION":
        draw_collection(layout, settings, "strokes_collection")
    layout.prop(settings, "painted")
    if settings.painted == "ATTRIBUTE":
        layout.prop_search(settings, "painted_attribute", item.data, "attributes", text="Name", icon="SPREADSHEET")
    elif settings.painted == "COLOR":
        layout.prop_search(settings, "painted_color", item.data, "color_attributes", text="Name", icon="GROUP_VCOL")
    elif settings.painted == "IMAGE":
        draw_pointer(layout, settings, "painted_image", "images")
    layout.prop(settings, "singularities", text="Singular")
    if settings.singularities == "EMPTIES":
        draw_collection(layout, settings, "singularities_collection")
        layout.operator("saddleback.add_singularity", icon="EMPTY_AXIS")
    layout.prop(settings, "turn")


def draw_field_advanced(layout: bpy.types.UILayout, settings: Any) -> None:
    """Draws how strokes are followed, and where the field is written."""
    column = layout.column()
    column.active = settings.strokes != "NONE"
    column.prop(settings, "hard_strokes")
    row = column.row()
    row.active = not settings.hard_strokes
    row.prop(settings, "stroke_weight")
    draw_automatic(column, settings, "stroke_reach")
    row = layout.row()
    row.active = settings.painted != "NONE"
    row.prop(settings, "painted_weight", text="Paint")
    layout.prop(settings, "seed")
    layout.prop(settings, "domain")
    draw_name(layout, settings, "direction_attribute", "Attribute")


def draw_arrows(layout: bpy.types.UILayout, settings: Any) -> None:
    """The view of a field."""
    layout.active = settings.make_arrows
    layout.prop(settings, "arrow_count")
    draw_automatic(layout, settings, "arrow_length")


def draw_streamlines(layout: bpy.types.UILayout, settings: Any) -> None:
    """Lines along a field."""
    layout.active = settings.make_streamlines
    draw_automatic(layout, settings, "streamline_spacing")
    draw_automatic(layout, settings, "streamline_length")
    draw_length(layout, settings, "streamline_radius")


def draw_shapes(layout: bpy.types.UILayout, settings: Any, item: bpy.types.Object) -> None:
    """Draws what is laid on a surface, how many, how large, which way."""
    layout.prop(settings, "shapes")
    if settings.shapes == "COLLECTION":
        draw_collection(layout, settings, "shapes_collection")
    elif settings.shapes == "IMAGE":
        draw_pointer(layout, settings, "shapes_image", "images")
    row = layout.row()
    row.active = not settings.maximal or not settings.size
    row.prop(settings, "count")
    column = layout.column(align=True)
    draw_automatic(column, settings, "size")
    column.prop(settings, "size_variation")
    draw_length(layout, settings, "gap")
    column = layout.column(align=True)
    column.prop(settings, "overlap")
    row = column.row()
    row.active = settings.overlap > 0.0
    row.prop(settings, "tilt")
    layout.prop(settings, "packing")


def draw_shapes_advanced(layout: bpy.types.UILayout, settings: Any, item: bpy.types.Object) -> None:
    """Draws how shapes lie and turn in detail."""
    row = layout.row()
    row.active = settings.overlap > 0.0
    row.prop(settings, "no_crossings")
    row = layout.row()
    row.active = settings.overlap > 0.0 and settings.no_crossings and settings.make_bent
    row.prop(settings, "fill_gaps")
    layout.prop(settings, "maximal")
    layout.prop(settings, "mirror")
    layout.prop(settings, "bend")
    layout.prop(settings, "seed")
    layout.prop(settings, "field_source")
    if settings.field_source == "ATTRIBUTE":
        layout.prop_search(settings, "direction_attribute", item.data, "attributes", icon="SPREADSHEET")
    elif settings.field_source == "COLOR":
        layout.prop_search(settings, "direction_color", item.data, "color_attributes", icon="GROUP_VCOL")
    elif settings.field_source == "IMAGE":
        draw_pointer(layout, settings, "direction_image", "images")
    layout.prop_search(settings, "forbidden_group", item, "vertex_groups", icon="GROUP_VERTEX")


def draw_shape_density(layout: bpy.types.UILayout, settings: Any, item: bpy.types.Object) -> None:
    """Draws where shapes are many, or small."""
    draw_density(layout, settings, item)
    row = layout.row()
    row.active = settings.density_source != "UNIFORM"
    row.prop(settings, "size_by_density", text="By Density")
    draw_paint_buttons(layout, "distribute")


def draw_distance_sources(layout: bpy.types.UILayout, settings: Any, item: bpy.types.Object) -> None:
    """Draws where distances are measured from, and how far."""
    layout.prop(settings, "sources")
    if settings.sources == "VERTEX_GROUP":
        layout.prop_search(settings, "sources_group", item, "vertex_groups", text="Group", icon="GROUP_VERTEX")
    elif settings.sources == "EMPTIES":
        draw_collection(layout, settings, "sources_collection")
    elif settings.sources == "CURVES":
        draw_object(layout, settings, "sources_object")
        if not settings.sources_object:
            draw_collection(layout, settings, "sources_collection")


def draw_isolines(layout: bpy.types.UILayout, settings: Any) -> None:
    """The curves of equal distance, and the preview's, which has the same."""
    layout.active = settings.make_isolines or settings.make_preview
    layout.prop(settings, "isolines_by")
    layout.prop(settings, "isoline_count" if settings.isolines_by == "COUNT" else "isoline_spacing")
    column = layout.column()
    column.active = settings.make_isolines
    draw_length(column, settings, "isoline_radius")


def draw_path_points(layout: bpy.types.UILayout, settings: Any, item: bpy.types.Object) -> None:
    """Draws what paths connect, and how."""
    layout.prop(settings, "points")
    if settings.points == "VERTEX_GROUP":
        layout.prop_search(settings, "points_group", item, "vertex_groups", text="Group", icon="GROUP_VERTEX")
    elif settings.points == "EMPTIES":
        draw_collection(layout, settings, "points_collection")
    if settings.points != "CURSOR":
        layout.prop(settings, "from_cursor")
        layout.prop(settings, "connect")


def draw_ribbon(layout: bpy.types.UILayout, settings: Any) -> None:
    """Draws along which curves ribbons are laid, and what they show."""
    row = layout.row(align=True)
    draw_object(row, settings, "curves_object")
    row.operator("saddleback.draw_strokes", text="", icon="CURVE_BEZCURVE").pen = "CURVE"
    if not settings.curves_object:
        draw_collection(layout, settings, "curves_collection")
    layout.prop(settings, "show")
    if settings.show == "IMAGE":
        draw_pointer(layout, settings, "image_name", "images")
    elif settings.show == "OBJECT":
        draw_object(layout, settings, "ribbon_object")
    draw_length(layout, settings, "width")
    draw_length(layout, settings, "lift")
    layout.prop(settings, "repeat")


def draw_collection(layout: bpy.types.UILayout, settings: Any, name: str) -> None:
    """A choice among collections."""
    draw_pointer(layout, settings, name, "collections")


def draw_object(layout: bpy.types.UILayout, settings: Any, name: str) -> None:
    """A choice among objects."""
    draw_pointer(layout, settings, name, "objects")


def draw_pointer(layout: bpy.types.UILayout, settings: Any, name: str, blocks: str) -> None:
    """A choice among data-blocks: a pointer on the object's settings, a name on an operator."""
    if _is_name(settings, name):
        layout.prop_search(settings, name, bpy.data, blocks)
    elif blocks == "images":
        column = layout.column(align=True)  # with all its buttons it leaves no room for a label, or a name
        column.use_property_split = False
        column.label(text=settings.bl_rna.properties[name].name)
        column.template_ID(settings, name, open="image.open")
    else:
        layout.prop(settings, name)


def _is_name(settings: Any, name: str) -> bool:
    return bool(settings.bl_rna.properties[name].type == "STRING")


def draw_maps(layout: bpy.types.UILayout, settings: Any, item: bpy.types.Object) -> None:
    """Draws which images are baked, and how large."""
    layout.prop(settings, "resolution")
    column = layout.column(heading="Maps")
    column.prop(settings, "bake_cell")
    column.prop(settings, "bake_edge_distance")
    column.prop(settings, "bake_height")
    column.prop(settings, "bake_local_uv")
    column.prop(settings, "bake_direction")
    if settings.bake_height:
        layout.prop(settings, "profile")
    if settings.bake_direction:
        layout.prop_search(settings, "direction_attribute", item.data, "attributes", icon="FORCE_WIND")
    layout.prop(settings, "folder")


def draw_images(layout: bpy.types.UILayout, settings: Any, item: bpy.types.Object) -> None:
    """Draws what images are like."""
    layout.prop_search(settings, "uv_name", item.data, "uv_layers", icon="GROUP_UVS")
    layout.prop(settings, "use_tiles")
    layout.prop(settings, "margin")
    layout.prop(settings, "bits")
    layout.prop(settings, "cell_as")
    layout.prop(settings, "direction_space")
    layout.prop(settings, "image_prefix")

# SPDX-License-Identifier: GPL-3.0-or-later
"""The cells as a mesh object: a cell number and a color on every face."""

from __future__ import annotations

import math

import bpy
import numpy as np
from mathutils import Matrix

from ... import compat, nodes
from ...core.results import CellMesh, CellPolygons, CellsResult, Indices
from ...core.settings import TessellateSettings, Voronoi2dSettings
from ...core.shapes.local_places import local_uv
from ...core.solids.mesh_edges import triangle_edges
from ...core.surfaces.cell_colors import cell_colors, linear_to_srgb, palette_colors
from ...core.surfaces.polygons import neighbors_of
from ...finishes import material_of, palette_of
from ...looks import NO_LOOK, finish_of
from ..inputs.carried_in import read_carried
from ..inputs.materials_in import shown_materials
from ..inputs.mesh_in import level_place, mesh_of
from .carried_out import write_groups, write_layers
from .following import Follower
from .out_attributes import set_attribute
from .out_collection import replace_object

CELLS_ROLE = "cells"
CELL_ATTRIBUTE = "saddleback_cell"
LOCAL_UV = "saddleback_local"
# A plateau's edge is steeper than this, and a mesh fine enough for cells bends less from face to face.
CREASE_ANGLE = math.radians(30.0)
# A dome has no edge but where it meets its underside; its small triangles bend more than it does.
DOME_ANGLE = math.radians(75.0)


def write_cells(
    context: bpy.types.Context,
    source: bpy.types.Object,
    result: CellsResult,
    settings: TessellateSettings | Voronoi2dSettings,
    role: str = CELLS_ROLE,
    follower: Follower | None = None,
) -> bpy.types.Object:
    """Makes or replaces the source's cells object."""
    if result.polygons is not None and isinstance(settings, TessellateSettings):
        return _write_surface_polygons(context, source, result, settings, follower)
    assert result.mesh is not None
    cells = result.mesh
    look = settings.look if isinstance(settings, TessellateSettings) else NO_LOOK
    colors = _colors(result, settings, result.edge_cells)
    place = level_place(source)
    dome = settings.dome if isinstance(settings, TessellateSettings) else 0.0
    is_smooth = dome > 0.0 or compat.is_shaded_smooth(source.data)
    crease = (DOME_ANGLE if dome == 1.0 else CREASE_ANGLE) if is_smooth else None
    mesh = _mesh(cells.vertices, cells, colors, crease)
    if isinstance(settings, TessellateSettings) and settings.local_uv:
        places = local_uv(
            cells.vertices, cells.triangles, cells.triangle_cell, result.sites_position, result.sites_normal
        )
        mesh.uv_layers.new(name=LOCAL_UV).data.foreach_set("uv", places.astype(np.float32).ravel())
    item = _shown(context, source, role, mesh, place, look)
    if follower is not None:
        follower.take(item, place, cells.vertices, cells.feet)
    return item


def write_polygons(
    context: bpy.types.Context,
    source: bpy.types.Object,
    cells: CellPolygons,
    count: int,
    neighbors: Indices,
    role: str,
    follower: Follower | None = None,
) -> bpy.types.Object:
    """Makes or replaces the source's cells object from polygons; `neighbors` (e, 2) get colors unlike each other."""
    place = level_place(source)
    mesh = _new_mesh(cells.vertices)
    compat.write_polygons(mesh, cells.corners, cells.offsets)
    colors = cell_colors(count, neighbors)
    compat.shade_flat(mesh)
    mesh.update(calc_edges=True)
    set_attribute(mesh, CELL_ATTRIBUTE, "FACE", cells.polygon_cell)
    _write_colors(mesh, colors, np.repeat(cells.polygon_cell, np.diff(cells.offsets)))
    item = _shown(context, source, role, mesh, place)
    if follower is not None:
        follower.take(item, place, cells.vertices)
    return item


def _write_surface_polygons(
    context: bpy.types.Context,
    source: bpy.types.Object,
    result: CellsResult,
    settings: TessellateSettings,
    follower: Follower | None,
) -> bpy.types.Object:
    """Polygons with what the artist put on the surface: groups, maps, attributes, shading and, without a look, the
    materials, where there are some.
    """
    cells = result.polygons
    assert cells is not None
    place, counts = level_place(source), np.diff(cells.offsets)
    mesh = _new_mesh(cells.vertices)
    compat.write_polygons(mesh, cells.corners, cells.offsets)
    mesh.update(calc_edges=True)
    with mesh_of(context, source, settings.use_modifiers) as read:
        carried = read_carried(source, read, cells.faces, cells.barycentric)
        corners = read_carried(source, read, cells.corner_faces, cells.corner_barycentric, has_corners=True)
        compat.copy_auto_smooth(read, mesh)
        materials = shown_materials(source, read) if finish_of(settings.look) is None else []
    write_layers(mesh, carried, corners, counts)
    if cells.is_patches:
        compat.shade_flat(mesh)
    if not any(materials):
        compat.write_numbers(mesh.polygons, "material_index", np.zeros(len(counts), np.int32))
        materials = [material_of(settings.look, nodes.cells_material)]
    for material in materials:
        mesh.materials.append(material)
    set_attribute(mesh, CELL_ATTRIBUTE, "FACE", cells.polygon_cell)
    neighbors = neighbors_of(cells.corners, cells.offsets, cells.polygon_cell)
    _write_colors(mesh, _colors(result, settings, neighbors), np.repeat(cells.polygon_cell, counts))
    item = replace_object(context, source, CELLS_ROLE, mesh, place)
    write_groups(item, carried)
    if follower is not None:
        follower.take(item, place, cells.vertices)
    return item


def _colors(result: CellsResult, settings: TessellateSettings | Voronoi2dSettings, neighbors: Indices) -> np.ndarray:
    """A color for each cell, also for those that were added; the same on both sides of a mirror."""
    added = 0 if result.polygons is None else result.polygons.added
    twin = None if result.twin is None else np.append(result.twin, np.arange(result.count, result.count + added))
    count = result.count + added
    if twin is not None:
        neighbors = np.sort(twin[neighbors], axis=1)
    finish = finish_of(settings.look) if isinstance(settings, TessellateSettings) else None
    if finish is None:
        colors = cell_colors(count, neighbors)
    else:
        colors = palette_colors(count, neighbors, palette_of(finish), finish.contrast)
    return colors if twin is None else colors[twin]


def _mesh(positions: np.ndarray, cells: CellMesh, colors: np.ndarray, crease: float | None) -> bpy.types.Mesh:
    mesh = _new_mesh(positions)
    compat.write_corners(mesh, cells.triangles)
    compat.write_edges(mesh, *triangle_edges(cells.triangles, len(positions)))  # sooner than Blender finds them
    mesh.update()
    set_attribute(mesh, CELL_ATTRIBUTE, "FACE", cells.triangle_cell)
    _write_colors(mesh, colors, np.repeat(cells.triangle_cell, 3))
    if crease is not None:
        compat.shade_smooth_by_angle(mesh, crease)
    else:
        compat.shade_flat(mesh)
    return mesh


def _new_mesh(positions: np.ndarray) -> bpy.types.Mesh:
    mesh = bpy.data.meshes.new("Saddleback Cells")
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", positions.astype(np.float32).ravel())
    return mesh


def _shown(
    context: bpy.types.Context,
    source: bpy.types.Object,
    role: str,
    mesh: bpy.types.Mesh,
    place: Matrix,
    look: str = NO_LOOK,
) -> bpy.types.Object:
    mesh.materials.append(material_of(look, nodes.cells_material))
    return replace_object(context, source, role, mesh, place)


def _write_colors(mesh: bpy.types.Mesh, colors: np.ndarray, corner_cell: np.ndarray) -> None:
    """Writes the colors of corners, as scripts find them whether cells share vertices or not; Blender does not show
    colors of faces.

    Blender keeps them as sRGB: given so, a color is converted once a cell, not once a corner.
    """
    color = mesh.color_attributes.new(nodes.COLOR_ATTRIBUTE, "BYTE_COLOR", "CORNER")
    rgba = np.column_stack([linear_to_srgb(colors), np.ones(len(colors))]).astype(np.float32)
    color.data.foreach_set("color_srgb", rgba.take(corner_cell, axis=0).ravel())
    compat.show_color(mesh, nodes.COLOR_ATTRIBUTE)

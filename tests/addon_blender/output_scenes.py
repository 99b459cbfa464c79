# SPDX-License-Identifier: GPL-3.0-or-later
"""Sources and results for the tests of the output objects, made without the native library."""

import bpy
import numpy as np
from mathutils import Matrix
from scenes import add_object

from saddleback_blender.bridge.inputs.mesh_in import read_surface
from saddleback_blender.core.results import CellsResult
from saddleback_blender.core.solids.cell_mesh import CellShape
from saddleback_blender.core.surfaces.normals import normals_at
from tests import synthetic_cells
from tests.made_cells import build_cell_mesh

# A turn, a mirrored and uneven scale and a place of its own: whatever is wrong with a transform shows here.
HARD_PLACE = (
    Matrix.Translation((3.0, -2.0, 1.0)) @ Matrix.Rotation(0.7, 4, (1, 2, 3)) @ Matrix.Diagonal((2.0, -0.5, 1.0, 1.0))
)


def sphere_source(name="Ball", levels=3, place=None):
    item = add_object(name, *synthetic_cells.sphere(levels))
    if place is not None:
        item.matrix_world = place
        bpy.context.view_layer.update()
    return item


def result_of(item, count=25, sites=None, **lengths):
    """Cells of the object's surface, their mesh with the given gap, inset and thickness."""
    surface = read_surface(item, item.data)
    if sites is None:
        sites = np.linspace(0, len(surface.vertices) - 1, count)
    sites = np.asarray(sites, dtype=np.int32)
    cells = synthetic_cells.split_cells(surface.vertices, surface.triangles, sites)
    corner_of = np.zeros(len(surface.vertices), dtype=np.int32)
    for corner in range(3):
        corner_of[surface.triangles[:, corner]] = 3 * np.arange(len(surface.triangles)) + corner
    faces, corners = np.divmod(corner_of[sites], 3)
    return CellsResult(
        vertex_cell=cells.vertex_cell,
        vertex_distance=cells.vertex_distance,
        vertex_density=None,
        sites_position=cells.sites_position,
        sites_normal=normals_at(surface.vertices, surface.triangles, faces, np.eye(3)[corners]),
        cell_area=cells.cell_area,
        edge_points=cells.edge_points,
        edge_offsets=cells.edge_offsets,
        edge_cells=cells.edge_cells,
        edge_closed=cells.edge_closed,
        energy=np.array([2.0, 1.0]),
        iterations=2,
        stop_reason="max_iterations",
        mesh=build_cell_mesh(cells.split_vertices, cells.split_triangles, cells.split_cell, CellShape(**lengths)),
    )


def in_world(source, places, origin=1.0):
    """Places of the object's surface, with an origin of 0 directions, in the world: (n, 3)."""
    location, rotation, _ = source.matrix_world.decompose()
    return places @ np.array(rotation.to_matrix(), np.float64).T + origin * np.array(location, np.float64)


def world_positions(item, mesh=None):
    mesh = item.data if mesh is None else mesh
    values = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", values)
    matrix = np.array(item.matrix_world, np.float64)
    return values.reshape(-1, 3).astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]


def read_attribute(mesh, name):
    attribute = mesh.attributes[name]
    element, dtype, width = {
        "FLOAT": ("value", np.float32, 1),
        "INT": ("value", np.int32, 1),
        "BOOLEAN": ("value", bool, 1),
        "FLOAT_VECTOR": ("vector", np.float32, 3),
        "BYTE_COLOR": ("color", np.float32, 4),
        "FLOAT_COLOR": ("color", np.float32, 4),
    }[attribute.data_type]
    values = np.empty(len(attribute.data) * width, dtype)
    attribute.data.foreach_get(element, values)
    return values.reshape(-1, width) if width > 1 else values


def triangles_of(mesh):
    values = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", values)
    return values.reshape(-1, 3)


def edges_of(mesh):
    values = np.empty(2 * len(mesh.edges), np.int32)
    mesh.edges.foreach_get("vertices", values)
    return values.reshape(-1, 2)

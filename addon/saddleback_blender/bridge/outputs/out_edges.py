# SPDX-License-Identifier: GPL-3.0-or-later
"""The lines between cells as an object: an edge mesh or a curve, both with tubes."""

from __future__ import annotations

import bpy
import numpy as np

from ... import compat, nodes
from ...core.results import CellsResult
from ...core.settings import TessellateSettings, Voronoi2dSettings
from ...core.solids.edge_network import EdgeNetwork, edge_network, long_lines
from ..inputs.mesh_in import level_place
from .following import Follower
from .out_attributes import set_attribute
from .out_collection import replace_object
from .out_curves import Lines, write_lines

EDGES_ROLE = "edges"
# Attributes of the edges: the cells on both sides.
FIRST_CELL, SECOND_CELL = "saddleback_cell_a", "saddleback_cell_b"


def write_edges(
    context: bpy.types.Context,
    source: bpy.types.Object,
    result: CellsResult,
    settings: TessellateSettings | Voronoi2dSettings,
    role: str = EDGES_ROLE,
    follower: Follower | None = None,
) -> bpy.types.Object:
    """Makes or replaces the source's edges object; the radius is in world units whatever the source's scale."""
    network = result.network or edge_network(
        result.edge_points, result.edge_offsets, result.edge_cells, result.edge_closed
    )
    return write_network(context, source, network, settings, role, follower)


def write_network(
    context: bpy.types.Context,
    source: bpy.types.Object,
    network: EdgeNetwork,
    settings: TessellateSettings | Voronoi2dSettings,
    role: str,
    follower: Follower | None = None,
) -> bpy.types.Object:
    """Writes the same from lines that are joined already."""
    material = nodes.edges_material()
    if settings.edge_kind == "CURVE":
        # Few and long splines, because Blender's cost is by the spline.
        lines = Lines.of((network.vertices[vertices], is_closed) for vertices, is_closed in long_lines(network))
        return write_lines(context, source, role, lines, settings.edge_radius, material, follower)
    place = level_place(source)
    data = _edge_mesh(network)
    data.materials.append(material)
    item = replace_object(context, source, role, data, place)
    nodes.set_tubes(item, settings.edge_radius, material)
    if follower is not None:
        follower.take(item, place, network.vertices)
    return item


def _edge_mesh(network: EdgeNetwork) -> bpy.types.Mesh:
    mesh = bpy.data.meshes.new("Saddleback Edges")
    segments, line = network.segments()
    mesh.vertices.add(len(network.vertices))
    mesh.vertices.foreach_set("co", network.vertices.astype(np.float32).ravel())
    mesh.edges.add(len(segments))
    compat.write_numbers(mesh.edges, "vertices", segments)
    for column, name in enumerate((FIRST_CELL, SECOND_CELL)):
        set_attribute(mesh, name, "EDGE", network.cells[line, column])
    mesh.update()
    return mesh

# SPDX-License-Identifier: GPL-3.0-or-later
"""The dual mesh as an object: a remesh of the source that keeps what the artist put on it."""

from __future__ import annotations

import bpy
import numpy as np

from ... import compat
from ...core.results import CellsResult, Dual
from ...core.settings import TessellateSettings
from ...looks import NO_LOOK
from ..inputs.carried_in import read_carried
from ..inputs.materials_in import shown_materials
from ..inputs.mesh_in import mesh_of, unscaled, write_marks
from .carried_out import in_written_order, write_groups, write_layers
from .following import Follower
from .out_collection import replace_object

DUAL_ROLE = "dual"


def write_dual(
    context: bpy.types.Context,
    source: bpy.types.Object,
    result: CellsResult,
    settings: TessellateSettings,
    follower: Follower | None = None,
) -> bpy.types.Object:
    """Makes or replaces the source's dual object, in the source's own space.

    Vertex groups, UV maps and number attributes come along, each vertex with the values of the place where it lies;
    faces are smooth, and have the material, as at their first vertex. Corners have the UV places on the side of their
    face: only a face that lies across a seam is stretched over the map.
    """
    assert result.dual is not None
    dual = result.dual
    assert dual.corner_faces is not None and dual.corner_barycentric is not None
    with mesh_of(context, source, settings.use_modifiers) as read:
        carried = read_carried(source, read, dual.faces, dual.barycentric)
        corners = read_carried(source, read, dual.corner_faces, dual.corner_barycentric, has_corners=True)
        mesh = _mesh(source, dual)
        compat.copy_auto_smooth(read, mesh)
        materials = shown_materials(source, read)
    counts = np.full(len(dual.polygons), dual.polygons.shape[1])
    write_layers(mesh, carried, in_written_order(corners, counts, source.matrix_world.determinant() < 0), counts)
    for material in materials:
        mesh.materials.append(material)
    item = replace_object(context, source, DUAL_ROLE, mesh)
    write_groups(item, carried)
    if settings.look != NO_LOOK:
        item.show_wire = True  # which is what one looks at
    if follower is not None:
        follower.take(item, source.matrix_world, dual.vertices)
    return item


def _mesh(source: bpy.types.Object, dual: Dual) -> bpy.types.Mesh:
    mesh = bpy.data.meshes.new("Saddleback Dual")
    mesh.vertices.add(len(dual.vertices))
    compat.write_positions(mesh, unscaled(source, dual.vertices).astype(np.float32))
    is_mirrored = source.matrix_world.determinant() < 0
    polygons = dual.polygons[:, ::-1] if is_mirrored else dual.polygons
    count, sides = polygons.shape
    compat.write_polygons(mesh, polygons.ravel(), np.arange(0, sides * count + 1, sides, dtype=np.int32))
    mesh.update(calc_edges=True)
    if dual.marks is not None:
        write_marks(mesh, dual.marks)
    return mesh

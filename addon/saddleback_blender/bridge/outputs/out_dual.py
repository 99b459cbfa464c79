# SPDX-License-Identifier: GPL-3.0-or-later
"""The dual mesh as an object: a remesh of the source that keeps what the artist put on it."""

from __future__ import annotations

import bpy
import numpy as np

from ... import compat
from ...core.results import CellsResult, Dual
from ...core.settings import TessellateSettings
from ...looks import NO_LOOK
from ..inputs.carried_in import Carried, read_carried
from ..inputs.materials_in import shown_materials
from ..inputs.mesh_in import from_world, mesh_of
from .carried_out import write_groups
from .following import Follower
from .out_attributes import set_attribute
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
    faces are smooth, and have the material, as at their first vertex. A face across a seam of a UV map is stretched
    over the map, since its vertices lie on both sides.
    """
    assert result.dual is not None
    dual = result.dual
    with mesh_of(context, source, settings.use_modifiers) as read:
        carried = read_carried(source, read, dual.faces, dual.barycentric)
        mesh = _mesh(source, dual)
        compat.copy_auto_smooth(read, mesh)
        materials = shown_materials(source, read)
    _write_layers(mesh, carried)
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
    compat.write_positions(mesh, from_world(source, dual.vertices).astype(np.float32))
    is_mirrored = source.matrix_world.determinant() < 0
    compat.write_corners(mesh, dual.triangles[:, ::-1] if is_mirrored else dual.triangles)
    mesh.update(calc_edges=True)
    return mesh


def _write_layers(mesh: bpy.types.Mesh, carried: Carried) -> None:
    for name, values in carried.attributes.items():
        set_attribute(mesh, name, "POINT", values)
    corners = compat.read_corner_vertices(mesh)
    for name, places in carried.uv_maps.items():
        layer = mesh.uv_layers.new(name=name)
        if layer is not None:  # Blender holds eight maps at most
            layer.data.foreach_set("uv", np.ascontiguousarray(places[corners]).ravel())
    first = corners[::3]
    mesh.polygons.foreach_set("use_smooth", carried.smooth[first])
    compat.write_numbers(mesh.polygons, "material_index", carried.material[first])

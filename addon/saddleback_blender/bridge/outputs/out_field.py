# SPDX-License-Identifier: GPL-3.0-or-later
"""A field of directions into Blender: the vector attribute, arrows to look at, streamlines."""

from __future__ import annotations

import bpy
import numpy as np

from ... import compat, nodes
from ...core.fields.arrow_mesh import arrow_mesh
from ...core.results import FieldResult, Reals
from ..inputs.mesh_in import level_place, scale_of
from .following import Follower
from .out_attributes import note_symmetry, write_attributes
from .out_collection import replace_object
from .out_curves import Lines, write_lines

ARROWS_ROLE, STREAMLINES_ROLE = "arrows", "streamlines"


def write_directions(source: bpy.types.Object, surface: bpy.types.Object, name: str, result: FieldResult) -> None:
    """Writes the field as unit vectors in the source's own space on the mesh of `surface`."""
    own = _own_directions(source, result.directions)
    write_attributes(surface, result.domain, {name: own.astype(np.float32)})
    note_symmetry(surface.data, name, result.symmetry)


def write_arrows(
    context: bpy.types.Context, source: bpy.types.Object, result: FieldResult, follower: Follower | None = None
) -> bpy.types.Object:
    """Makes or replaces the source's arrows object, singularities with it."""
    place = level_place(source)
    arrows = arrow_mesh(result)
    mesh = bpy.data.meshes.new("Saddleback Arrows")
    mesh.vertices.add(len(arrows.vertices))
    mesh.vertices.foreach_set("co", arrows.vertices.astype(np.float32).ravel())
    compat.write_polygons(mesh, arrows.corners, arrows.offsets)
    compat.write_numbers(mesh.polygons, "material_index", arrows.materials)
    mesh.polygons.foreach_set("use_smooth", arrows.smooth.astype(bool))
    mesh.update(calc_edges=True)
    for material in nodes.field_materials():
        mesh.materials.append(material)
    item = replace_object(context, source, ARROWS_ROLE, mesh, place)
    if follower is not None:
        follower.take(item, place, arrows.vertices, arrows.feet)
    return item


def write_streamlines(
    context: bpy.types.Context,
    source: bpy.types.Object,
    result: FieldResult,
    radius: float,
    follower: Follower | None = None,
) -> bpy.types.Object:
    """Makes or replaces the source's streamlines object; the radius is in world units."""
    assert result.streamlines is not None
    lines = Lines.between(result.streamlines.points, result.streamlines)
    return write_lines(context, source, STREAMLINES_ROLE, lines, radius, nodes.edges_material(), follower)


def _own_directions(source: bpy.types.Object, directions: Reals) -> Reals:
    """Directions as the source's own space has them, of unit length; zero stays zero."""
    own = directions @ np.linalg.inv(scale_of(source)).T
    lengths = np.linalg.norm(own, axis=1, keepdims=True)
    units: Reals = np.divide(own, lengths, out=np.zeros_like(own), where=lengths > 0)
    return units

# SPDX-License-Identifier: GPL-3.0-or-later
"""Brings a repaired surface back into the Blender mesh it came from, with as much of the artist's data as can be kept.

BMesh carries every layer there is (groups, UVs, colors, creases, shape keys) through the few changes that a repair
makes; it costs some seconds a million vertices, which only meshes that need it pay.
"""

from __future__ import annotations

from collections.abc import Sequence

import bmesh
import bpy
import numpy as np

from ... import compat
from ...core.errors import BadInputError
from ...core.results import Indices, Reals
from ...core.surfaces.repair_plan import RepairPlan


def polygon_corners(mesh: bpy.types.Mesh) -> list[Indices]:
    """Vertices around each polygon."""
    totals = compat.read_numbers(mesh.polygons, "loop_total")
    return np.split(compat.read_corner_vertices(mesh), np.cumsum(totals)[:-1]) if len(totals) else []


def apply_repair(source: bpy.types.Object, plan: RepairPlan, places: Reals, moved: Indices, triangles: Indices) -> None:
    """Changes the object's mesh by the plan.

    `places` (n, 3): object-space place of each new vertex, used for copies and those listed in `moved`; `triangles`
    (F, 3) of new vertices, counter-clockwise in the object's own space. Vertices that lose their last face go; vertices
    that never had one stay.
    """
    mesh = source.data
    changed = bmesh.new()
    try:
        changed.from_mesh(mesh)
        if len(changed.faces) != len(mesh.polygons) or len(changed.verts) != len(mesh.vertices):
            raise BadInputError(f"'{source.name}' has damaged data: run Mesh.validate() on its mesh, then repair again")
        _rebuild(changed, plan, places, moved, triangles)
        changed.to_mesh(mesh)
    finally:
        changed.free()
    mesh.update()


def _rebuild(changed: bmesh.types.BMesh, plan: RepairPlan, places: Reals, moved: Indices, triangles: Indices) -> None:
    changed.verts.ensure_lookup_table()
    changed.faces.ensure_lookup_table()
    old = list(changed.verts)
    faces = list(changed.faces)
    # What hangs free from the start is the artist's; what the repair sets free goes.
    loose = {vertex for vertex in old if not vertex.link_faces}
    wires = {edge for edge in changed.edges if edge.is_wire}
    vertices = _new_vertices(changed, plan, places, moved, old)
    made: set[bmesh.types.BMFace] = set()
    condemned = {faces[polygon] for polygon in plan.dropped}
    for polygon, (around, turned) in plan.kept.items():
        face = faces[polygon]
        wanted = dict(zip(face.verts, (vertices[vertex] for vertex in around), strict=True))
        if turned:
            face.normal_flip()
        if any(before != after for before, after in wanted.items()):
            condemned.add(face)
            made.add(_remake(changed, face, [wanted[vertex] for vertex in face.verts], list(face.loops)))
    for polygon, parts in plan.replaced.items():
        face = faces[polygon]
        condemned.add(face)
        loops: dict[bmesh.types.BMVert, bmesh.types.BMLoop | None] = {loop.vert: loop for loop in face.loops}
        # A corner that the face has not is on its side, or was welded to one of its own: its data lies between theirs.
        other = None if face.calc_area() > 0 else face.loops[0]
        for part in parts:
            origins = [old[plan.vertex_origin[vertex]] for vertex in triangles[part]]
            lenders = [loops.get(vertex, other) for vertex in origins]
            made.add(_remake(changed, face, [vertices[vertex] for vertex in triangles[part]], lenders))
    for part, polygon in plan.filled.items():
        origins = [old[plan.vertex_origin[vertex]] for vertex in triangles[part]]
        lenders = [_lender(faces[polygon], origin) for origin in origins]
        made.add(_remake(changed, faces[polygon], [vertices[vertex] for vertex in triangles[part]], lenders))
    bmesh.ops.delete(changed, geom=list(condemned - made), context="FACES_ONLY")
    freed = [edge for edge in changed.edges if edge.is_wire and edge not in wires]
    bmesh.ops.delete(changed, geom=freed, context="EDGES")
    orphans = [vertex for vertex in changed.verts if not vertex.link_edges and vertex not in loose]
    bmesh.ops.delete(changed, geom=orphans, context="VERTS")
    changed.normal_update()


def _new_vertices(
    changed: bmesh.types.BMesh, plan: RepairPlan, places: Reals, moved: Indices, old: list[bmesh.types.BMVert]
) -> list[bmesh.types.BMVert]:
    """The BMesh vertex of each new vertex: the old one, or a copy of its origin."""
    vertices = [old[origin] for origin in plan.vertex_origin]
    for vertex in np.nonzero(plan.vertex_is_copy)[0]:
        vertices[vertex] = changed.verts.new(places[vertex], vertices[vertex])
    for vertex in moved:
        vertices[vertex].co = places[vertex]
    return vertices


def _lender(face: bmesh.types.BMFace, vertex: bmesh.types.BMVert) -> bmesh.types.BMLoop:
    """The face's corner at the vertex, or another face's, or else any corner of the face."""
    corners = [loop for loop in vertex.link_loops if loop.face == face] or list(vertex.link_loops)
    return corners[0] if corners else face.loops[0]


def _remake(
    changed: bmesh.types.BMesh,
    face: bmesh.types.BMFace,
    vertices: list[bmesh.types.BMVert],
    lenders: Sequence[bmesh.types.BMLoop | None],
) -> bmesh.types.BMFace:
    """A face of these vertices with the data of `face`, of the lending corners and of the edges between them.

    A corner without a lender gets what `face` has at its place.
    """
    new = changed.faces.get(vertices)
    if new is None:
        new = changed.faces.new(vertices, face)
    elif not _same_way_round(new, vertices):  # an old face that was to go, and is now this one
        new.normal_flip()
    between = {frozenset(edge.verts): edge for edge in face.edges}
    lender_of = dict(zip(vertices, lenders, strict=True))
    for loop in new.loops:
        ends = lender_of[loop.vert], lender_of[loop.link_loop_next.vert]
        edge = between.get(frozenset(end.vert for end in ends if end is not None))
        if edge is not None and edge != loop.edge and len(loop.edge.link_faces) == 1:
            loop.edge.seam, loop.edge.smooth = edge.seam, edge.smooth  # flags, which copy_from leaves out
            loop.edge.copy_from(edge)
    for loop in list(new.loops):
        lender = lender_of[loop.vert]  # last: from Blender 4 on copying makes `loop` unusable
        if lender is None:
            compat.interpolate_corner(loop, face)
        else:
            loop.copy_from(lender)
    return new


def _same_way_round(face: bmesh.types.BMFace, vertices: list[bmesh.types.BMVert]) -> bool:
    return any(loop.vert == vertices[0] and loop.link_loop_next.vert == vertices[1] for loop in face.loops)

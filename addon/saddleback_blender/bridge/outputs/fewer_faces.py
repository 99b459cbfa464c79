# SPDX-License-Identifier: GPL-3.0-or-later
"""A solid with fewer triangles, which is still closed and does not pass through itself."""

from __future__ import annotations

from dataclasses import replace

import bpy
import numpy as np
from mathutils.kdtree import KDTree

from ... import compat
from ...core.results import Indices, LampShell, Reals
from ...core.solids.crossings import find_crossings
from ...core.solids.mesh_edges import border_edges
from ...core.solids.room import beside
from ..inputs.evaluated import evaluated
from ..inputs.mesh_in import read_triangles

ROUNDS = 8
PROTECTED = 1000.0  # what Blender multiplies the cost of a vertex by that is to stay


def with_fewer_faces(context: bpy.types.Context, shell: LampShell, count: int) -> LampShell:
    """The shell with about `count` triangles, by Blender's *Decimate*: where what it leaves passes through itself, the
    vertices there are kept and it is tried again. The shell itself where that does not help.
    """
    if not 0 < count < len(shell.triangles):
        return shell
    mesh = bpy.data.meshes.new("Saddleback Fewer")
    item = bpy.data.objects.new(mesh.name, mesh)
    try:
        mesh.vertices.add(len(shell.vertices))
        compat.write_positions(mesh, shell.vertices.astype(np.float32))
        compat.write_corners(mesh, shell.triangles)
        mesh.update(calc_edges=True)
        return _decimated(context, item, shell, count)
    finally:
        bpy.data.objects.remove(item)
        bpy.data.meshes.remove(mesh)


def _decimated(context: bpy.types.Context, item: bpy.types.Object, shell: LampShell, count: int) -> LampShell:
    group = item.vertex_groups.new(name="Kept")
    modifier = item.modifiers.new("Fewer", "DECIMATE")
    modifier.ratio, modifier.use_collapse_triangulate = count / len(shell.triangles), True
    modifier.vertex_group, modifier.invert_vertex_group = group.name, True
    modifier.vertex_group_factor = PROTECTED
    tree = KDTree(len(shell.vertices))
    for number, place in enumerate(shell.vertices.tolist()):
        tree.insert(place, number)
    tree.balance()
    for _ in range(ROUNDS):
        vertices, triangles = _made(context, item)
        near = np.array([tree.find(place)[1] for place in vertices.tolist()], np.int32)
        crossing = np.unique(find_crossings(vertices, triangles))
        is_closed = not len(border_edges(triangles, len(vertices))[0])
        if is_closed and len(crossing) <= shell.crossing:
            return replace(
                shell, vertices=vertices, triangles=triangles, crossing=len(crossing), feet=shell.feet[near],
                wall=shell.wall[near], is_thinner=shell.is_thinner[near],
            )  # fmt: skip
        kept = beside(shell.triangles, _within(tree, vertices[triangles[crossing]]), len(shell.vertices))
        group.add(np.flatnonzero(kept).tolist(), 1.0, "REPLACE")
    return shell


def _within(tree: KDTree, corners: Reals) -> Indices:
    """The vertices about triangles with corners (t, 3, 3): those within the ball around each."""
    middles = corners.mean(axis=1)
    radii = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1)
    balls = zip(middles.tolist(), radii.tolist(), strict=True)
    found = {number for middle, radius in balls for _, number, _ in tree.find_range(middle, radius)}
    return np.array(sorted(found), np.int32)


def _made(context: bpy.types.Context, item: bpy.types.Object) -> tuple[Reals, Indices]:
    with evaluated(context, [item]) as (shown,):
        mesh = shown.to_mesh()
        try:
            return compat.read_positions(mesh).astype(np.float64), read_triangles(mesh).copy()
        finally:
            shown.to_mesh_clear()

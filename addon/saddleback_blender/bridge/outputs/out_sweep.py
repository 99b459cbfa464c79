# SPDX-License-Identifier: GPL-3.0-or-later
"""A sweep circle as objects that play back: the circle, whose keyframed scale is its radius, and what it uncovers."""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Matrix

from ... import compat, nodes
from ...core.results import Indices, Reals, Sweep
from ...core.settings import Voronoi2dSettings
from ..inputs.mesh_in import level_place
from .out_attributes import set_attribute
from .out_collection import remove_output, replace_object

CIRCLE_ROLE, BEACH_ROLE, GROWING_ROLE = "sweep circle", "beach curve", "growing edges"
CIRCLE_CORNERS = 128
NEVER = 3e38  # an end of time that single precision holds


def write_sweep(
    context: bpy.types.Context, source: bpy.types.Object, sweep: Sweep, settings: Voronoi2dSettings
) -> bpy.types.Object:
    """Makes the source's sweep anew; returns the circle."""
    remove_sweep(source)
    own = Matrix.Translation(sweep.center) @ Matrix(sweep.axes.tolist()).transposed().to_4x4()
    place = level_place(source) @ own
    circle = replace_object(context, source, CIRCLE_ROLE, _circle(), place)
    circle.hide_render = True
    _animate(circle, sweep, settings)
    ring_count, loop_count, size = sweep.rings.shape[:3]
    radii = np.repeat(sweep.last_radius * np.arange(1, ring_count + 1) / ring_count, loop_count * size)
    half = 0.5 * sweep.last_radius / ring_count
    number = np.arange(ring_count * loop_count * size, dtype=np.int32).reshape(-1, size)
    around = np.stack([number, np.roll(number, -1, axis=1)], axis=-1).reshape(-1, 2)
    beach = _mesh("Saddleback Beach Curve", sweep.seen_from_center(sweep.rings.reshape(-1, 3)), around)
    _show_between(beach, radii - half, radii + half)
    _write(
        context, source, BEACH_ROLE, beach, place, circle, 0.5 * settings.edge_radius, nodes.paths_material(),
        draws_circle=loop_count == 1,
    )  # fmt: skip
    edges = _mesh("Saddleback Growing Edges", sweep.seen_from_center(sweep.edge_vertices), sweep.edges)
    # As the beach curve is shown from half a step before its radius on, edges do not run ahead of it.
    _show_between(edges, sweep.edge_radius, np.full(len(sweep.edge_radius), NEVER))
    _write(context, source, GROWING_ROLE, edges, place, circle, settings.edge_radius, nodes.edges_material())
    return circle


def remove_sweep(source: bpy.types.Object) -> None:
    """Removes the sweep where there is one."""
    for role in (GROWING_ROLE, BEACH_ROLE, CIRCLE_ROLE):
        remove_output(source, role)


def _circle() -> bpy.types.Mesh:
    angle = 2 * np.pi * np.arange(CIRCLE_CORNERS) / CIRCLE_CORNERS
    number = np.arange(CIRCLE_CORNERS, dtype=np.int32)
    points = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(CIRCLE_CORNERS)])
    return _mesh("Saddleback Sweep Circle", points, np.column_stack([number, np.roll(number, -1)]))


def _mesh(name: str, points: Reals, edges: Indices) -> bpy.types.Mesh:
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(points))
    mesh.vertices.foreach_set("co", points.astype(np.float32).ravel())
    mesh.edges.add(len(edges))
    compat.write_numbers(mesh.edges, "vertices", edges)
    mesh.update()
    return mesh


def _show_between(mesh: bpy.types.Mesh, begin: Reals, end: Reals) -> None:
    set_attribute(mesh, nodes.FROM_ATTRIBUTE, "POINT", begin)
    set_attribute(mesh, nodes.UNTIL_ATTRIBUTE, "POINT", end)


def _animate(circle: bpy.types.Object, sweep: Sweep, settings: Voronoi2dSettings) -> None:
    """Half a step past the last radius, so that the last edges and the last beach curve are whole."""
    first, last = sweep.last_radius / len(sweep.rings), sweep.last_radius * (1 + 0.25 / len(sweep.rings))
    for frame, radius in ((settings.frame_start, first), (settings.frame_end, last)):
        circle.scale = (radius, radius, radius)
        circle.keyframe_insert("scale", frame=frame)
    compat.make_keys_linear(circle)


def _write(
    context: bpy.types.Context,
    source: bpy.types.Object,
    role: str,
    mesh: bpy.types.Mesh,
    place: Matrix,
    circle: bpy.types.Object,
    radius: float,
    material: bpy.types.Material,
    draws_circle: bool = False,
) -> None:
    mesh.materials.append(material)
    item = replace_object(context, source, role, mesh, place)
    nodes.set_tubes(item, radius, material)
    nodes.set_sweep(item, circle, draws_circle)

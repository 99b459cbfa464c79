"""Curve objects -> polylines in the world."""

from __future__ import annotations

import bpy
import numpy as np

from .. import compat
from ..core.errors import BadInputError
from ..core.requests import Polyline
from .mesh_in import to_world
from .out_collection import SOURCE


def read_curves(source: bpy.types.Object, name: str, collection: str) -> tuple[Polyline, ...]:
    """The splines of one curve object, of all in a collection or, without either, of those parented to the source."""
    items, where = _curve_objects(source, name, collection)
    lines = tuple(line for item in items for line in polylines_of(item))
    if not lines:
        raise BadInputError(f"'{source.name}': {where} has no spline of two points to measure from; draw one")
    for line in lines:
        if not np.isfinite(line.points).all():
            raise BadInputError(f"'{source.name}': {where} has a point that is not at a finite place; move it")
    return lines


def _curve_objects(source: bpy.types.Object, name: str, collection: str) -> tuple[list[bpy.types.Object], str]:
    if name:
        item = bpy.data.objects.get(name)
        if item is None:
            raise BadInputError(f"'{source.name}': there is no object '{name}' to measure from; choose a curve")
        if item.type != "CURVE":
            raise BadInputError(f"'{source.name}': '{name}' is no curve object; choose a curve to measure from")
        return [item], f"'{name}'"
    if collection:
        group = bpy.data.collections.get(collection)
        if group is None:
            raise BadInputError(
                f"'{source.name}': there is no collection '{collection}' to take curves from; choose one"
            )
        candidates, where = list(group.all_objects), f"collection '{collection}'"
    else:
        candidates, where = list(source.children), "the curve parented to it"
    # What we made ourselves, isolines and the like, is no source.
    curves = [item for item in candidates if item.type == "CURVE" and SOURCE not in item]
    if not curves:
        place = f"in collection '{collection}'" if collection else f"parented to '{source.name}'"
        raise BadInputError(f"'{source.name}': no curve is {place}; choose one to measure from")
    return sorted(curves, key=lambda item: item.name), where


def polylines_of(item: bpy.types.Object) -> list[Polyline]:
    """The splines of a curve object as Blender draws them without bevel; its modifiers do not count.

    The curve is copied for a moment, since its own bevel would make it a tube.
    """
    plain = item.data.copy()
    plain.bevel_mode, plain.bevel_object = "ROUND", None
    plain.bevel_depth = plain.extrude = plain.offset = 0.0
    plain.dimensions, plain.twist_mode = "3D", item.data.twist_mode
    holder = bpy.data.objects.new("Saddleback", plain)
    try:
        mesh = holder.to_mesh()
        places = to_world(item, compat.read_positions(mesh))
        edges = compat.read_edge_vertices(mesh)
        holder.to_mesh_clear()
    finally:
        bpy.data.objects.remove(holder)
        bpy.data.curves.remove(plain)
    return _chained(places, edges)


def _chained(places: np.ndarray, edges: np.ndarray) -> list[Polyline]:
    """Blender numbers the points of a spline in order; a closed one has an edge back to its first."""
    is_onward = edges[:, 1] == edges[:, 0] + 1
    joined = np.zeros(len(places), bool)
    joined[edges[is_onward, 1]] = True
    firsts = np.flatnonzero(~joined)
    back = {tuple(sorted(edge)) for edge in edges[~is_onward].tolist()}
    lines = []
    for first, end in zip(firsts, [*firsts[1:], len(places)], strict=True):
        if end - first >= 2:
            lines.append(Polyline(places[first:end], (int(first), int(end) - 1) in back))
    return lines

# SPDX-License-Identifier: GPL-3.0-or-later
"""Curve objects -> polylines."""

from __future__ import annotations

from dataclasses import replace

import bpy
import numpy as np
from numpy.typing import NDArray

from ... import compat
from ...blocks import find
from ...core.errors import BadInputError
from ...core.fields.hair_lines import through_points
from ...core.requests import Polyline
from ...core.solids.edge_chains import chains
from ...nodes import CURVE_TUBES, modifier_of
from ..tokens import SOURCE
from .evaluated import evaluated
from .mesh_in import seen_by, to_world


def read_curves(
    source: bpy.types.Object, name: str, collection: str, purpose: str = "to measure from"
) -> tuple[Polyline, ...]:
    """The splines of one curve object, of all in a collection or, without either, of those parented to the source, as
    its surface has them.
    """
    items, where = _curve_objects(source, name, collection, purpose)
    lines = tuple(line for item in items for line in polylines_of(item))
    if not lines:
        raise BadInputError(f"'{source.name}': {where} has no spline of two points {purpose}; draw one")
    for line in lines:
        if not np.isfinite(line.points).all():
            raise BadInputError(f"'{source.name}': {where} has a point that is not at a finite place; move it")
    return tuple(replace(line, points=seen_by(source, line.points)) for line in lines)


def _curve_objects(
    source: bpy.types.Object, name: str, collection: str, purpose: str
) -> tuple[list[bpy.types.Object], str]:
    if name:
        item = find(bpy.data.objects, name)
        if item is None:
            raise BadInputError(f"'{source.name}': there is no object '{name}' {purpose}; choose a curve")
        if not is_curve(item):
            raise BadInputError(f"'{source.name}': '{name}' is no curve object; choose a curve {purpose}")
        return [item], f"'{name}'"
    if collection:
        group = find(bpy.data.collections, collection)
        if group is None:
            raise BadInputError(
                f"'{source.name}': there is no collection '{collection}' to take curves from; choose one"
            )
        candidates, where = list(group.all_objects), f"collection '{collection}'"
    else:
        candidates, where = list(source.children), "the curve parented to it"
    # What we made ourselves, isolines and the like, is no source.
    curves = [item for item in candidates if is_curve(item) and SOURCE not in item]
    if not curves:
        place = f"in collection '{collection}'" if collection else f"parented to '{source.name}'"
        raise BadInputError(f"'{source.name}': no curve is {place}; choose one {purpose}")
    return sorted(curves, key=lambda item: item.name_full), where


def is_curve(item: bpy.types.Object) -> bool:
    """Tells whether an object holds curves, of the older or the newer kind, which hair is of."""
    return item.type in ("CURVE", "CURVES")


def polylines_of(item: bpy.types.Object) -> list[Polyline]:
    """In the world: the splines of a curve object as Blender draws them without bevel, its modifiers included."""
    return _hair_lines(item) if item.type == "CURVES" else _splines(item)


def _hair_lines(item: bpy.types.Object) -> list[Polyline]:
    """Hair is smooth between its points; of curves with handles or weights these are the points."""
    with evaluated(bpy.context, [item]) as (shown,):
        curves = shown.data
        places = to_world(shown, compat.read_floats(curves.attributes["position"].data, "vector", 3))
        kinds, closed = (_of_curves(curves, name) for name in ("curve_type", "cyclic"))
        lines = []
        for number, curve in enumerate(curves.curves):
            points = places[curve.first_point_index : curve.first_point_index + curve.points_length]
            is_closed = bool(closed[number]) and len(points) > 2
            if len(points) > 1:
                lines.append(Polyline(points if kinds[number] else through_points(points, is_closed), is_closed))
    return lines


def _of_curves(curves: bpy.types.Curves, name: str) -> NDArray[np.generic]:
    """(curves,) an attribute that is there only where it is not 0 for all."""
    attribute = curves.attributes.get(name)
    if attribute is None:
        return np.zeros(len(curves.curves), np.int8)
    values: NDArray[np.generic] = np.zeros(len(curves.curves), np.bool_ if name == "cyclic" else np.int8)
    attribute.data.foreach_get("value", values)
    return values


def _splines(item: bpy.types.Object) -> list[Polyline]:
    """Those of the older kind.

    The curve is copied for a moment, since its own bevel would make it a tube. Modifiers that make a surface of it do
    not count.
    """
    plain = item.data.copy()
    plain.bevel_mode, plain.bevel_object = "ROUND", None
    plain.bevel_depth = plain.extrude = plain.offset = 0.0
    plain.dimensions, plain.twist_mode = "3D", item.data.twist_mode
    try:
        lines = _modified(item, plain) if any(modifier.show_viewport for modifier in item.modifiers) else None
        return _plain(item, plain) if lines is None else lines
    finally:
        bpy.data.curves.remove(plain)


def _plain(item: bpy.types.Object, plain: bpy.types.Curve) -> list[Polyline]:
    holder = bpy.data.objects.new("Saddleback", plain)
    try:
        with evaluated(bpy.context, [item]) as (shown,):
            lines = _lines(shown, holder.to_mesh())
        holder.to_mesh_clear()
    finally:
        bpy.data.objects.remove(holder)
    return lines


def _modified(item: bpy.types.Object, plain: bpy.types.Curve) -> list[Polyline] | None:
    """Returns what modifiers make of the curve, None where that has faces. Only what is in a scene is modified."""
    scene = bpy.context.scene.collection
    holder = item.copy()
    holder.data, holder.hide_viewport = plain, False
    tubes = modifier_of(holder, CURVE_TUBES)
    if tubes is not None:  # our own lines count as lines
        compat.remove_modifier(holder, tubes)
    scene.objects.link(holder)
    try:
        shown = holder.evaluated_get(bpy.context.evaluated_depsgraph_get())
        mesh = shown.to_mesh()
        lines = None if len(mesh.polygons) else _lines(shown, mesh)
        shown.to_mesh_clear()
    finally:
        bpy.data.objects.remove(holder)
    return lines


def _lines(item: bpy.types.Object, mesh: bpy.types.Mesh | None) -> list[Polyline]:
    if mesh is None:  # of a curve without splines Blender makes none
        return []
    places = to_world(item, compat.read_positions(mesh))
    return [
        Polyline(places[numbers], closed) for numbers, closed in chains(len(places), compat.read_edge_vertices(mesh))
    ]

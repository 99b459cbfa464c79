# SPDX-License-Identifier: GPL-3.0-or-later
"""Strokes that a field shall follow: annotations, grease pencil, curves -> lines."""

from __future__ import annotations

import re
from dataclasses import replace

import bpy
import numpy as np

from ... import compat
from ...blocks import find
from ...core.errors import BadInputError
from ...core.requests import StrokeLine
from ...core.settings import DirectionFieldSettings
from ..tokens import SOURCE
from .curves_in import is_curve, polylines_of
from .evaluated import evaluated
from .mesh_in import seen_by, to_world

HARD = "hard"  # a word of the name of a layer or object: its strokes are met exactly


def read_strokes(
    context: bpy.types.Context, source: bpy.types.Object, settings: DirectionFieldSettings
) -> tuple[StrokeLine, ...]:
    """The chosen strokes of two places or more, as the surface has them. Raises BadInputError where there are none."""
    if settings.strokes == "NONE":
        return ()
    if settings.strokes == "ANNOTATIONS":
        lines, remedy = _of_annotations(context.scene), "no annotation is drawn in this scene; draw strokes on the mesh"
    elif settings.strokes == "OBJECT":
        lines, remedy = _of_object(context, source, settings.strokes_object)
    else:
        lines, remedy = _of_collection(context, source, settings.strokes_collection)
    lines = [line for line in lines if len(line.points) > 1 and np.ptp(line.points, axis=0).max() > 0]
    if not lines:
        raise BadInputError(f"'{source.name}': {remedy}")
    for line in lines:
        if not np.isfinite(line.points).all():
            raise BadInputError(f"'{source.name}': {line.label} has a point that is not at a finite place; move it")
    return tuple(replace(line, points=seen_by(source, line.points)) for line in lines)


def _of_annotations(scene: bpy.types.Scene) -> list[StrokeLine]:
    return [
        StrokeLine(places.astype(np.float64), False, _is_hard(layer), f"a stroke of annotation layer '{layer}'")
        for layer, places in compat.annotation_strokes(scene)
    ]


def _of_object(context: bpy.types.Context, source: bpy.types.Object, name: str) -> tuple[list[StrokeLine], str]:
    item = find(bpy.data.objects, name)
    if item is None:
        missing = f"there is no object '{name}'" if name else "no object is chosen"
        raise BadInputError(f"'{source.name}': {missing} to take strokes from; choose a curve or grease pencil")
    if not _has_strokes(item):
        raise BadInputError(f"'{source.name}': '{name}' has no strokes; choose a curve or grease pencil object")
    return _lines_of(context, item), f"'{name}' has no stroke of two points; draw one"


def _of_collection(context: bpy.types.Context, source: bpy.types.Object, name: str) -> tuple[list[StrokeLine], str]:
    if name:
        group = find(bpy.data.collections, name)
        if group is None:
            raise BadInputError(f"'{source.name}': there is no collection '{name}' to take strokes from; choose one")
        candidates, where = list(group.all_objects), f"in collection '{name}'"
    else:
        candidates, where = list(source.children), f"parented to '{source.name}'"
    # What we made ourselves, streamlines and the like, is no stroke.
    items = sorted(
        (item for item in candidates if _has_strokes(item) and SOURCE not in item), key=lambda i: i.name_full
    )
    return [
        line for item in items for line in _lines_of(context, item)
    ], f"no stroke of any length is {where}; draw a curve on the mesh"


def _has_strokes(item: bpy.types.Object) -> bool:
    return is_curve(item) or compat.is_grease_pencil(item)


def _lines_of(context: bpy.types.Context, item: bpy.types.Object) -> list[StrokeLine]:
    label = f"a stroke of '{item.name}'"
    if is_curve(item):
        hard = _is_hard(item.name)
        return [StrokeLine(line.points, line.closed, hard, label) for line in polylines_of(item)]
    with evaluated(context, [item]) as (shown,):
        return [
            StrokeLine(to_world(shown, places), closed, _is_hard(item.name) or _is_hard(layer), label)
            for layer, places, closed in compat.grease_pencil_strokes(shown)
        ]


def _is_hard(name: str) -> bool:
    """Tells whether one of the name's words is it: 'Hard', 'eyes_hard.001', 'HardEdges', but not 'Orchard'."""
    words = re.findall(r"[^\W\d_]+", re.sub(r"(?<=[^\W\d_A-Z])(?=[A-Z])", " ", name))
    return HARD in map(str.lower, words)

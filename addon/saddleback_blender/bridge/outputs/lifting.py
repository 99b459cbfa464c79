# SPDX-License-Identifier: GPL-3.0-or-later
"""Outputs that would lie on the surface they are made of, and fight with it for every pixel, lifted by a hair."""

from __future__ import annotations

from functools import partial

import bpy

from ... import rollback
from .out_collection import find_output, hair

LIFT = "Lift"  # the modifier, which an artist may change, or remove


def lift(source: bpy.types.Object, item: bpy.types.Object) -> None:
    """Adds the modifier, behind those that are there, unless there is one."""
    if LIFT in item.modifiers:
        return
    modifier = item.modifiers.new(LIFT, "DISPLACE")
    rollback.undo_with(partial(item.modifiers.remove, modifier))
    # Before Blender has evaluated it; the copy of the surface has the source's scale, and a hair is one of the world.
    place = source.matrix_world @ item.matrix_parent_inverse @ item.matrix_basis
    modifier.mid_level, modifier.strength = 0.0, hair(source) / abs(place.determinant()) ** (1.0 / 3.0)


def lift_lying(source: bpy.types.Object, lies: dict[str, bool]) -> None:
    """Lifts the source's outputs by their roles, those that lie on it, and takes the modifier from the others."""
    for role, is_lying in lies.items():
        item = find_output(source, role)
        if item is not None and is_lying:
            lift(source, item)
        elif item is not None and LIFT in item.modifiers:
            rollback.when_written(partial(item.modifiers.remove, item.modifiers[LIFT]))

# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers that an artist can paint on: made, selected, kept apart from what we write ourselves."""

from __future__ import annotations

from functools import partial

import bpy
import numpy as np

from ... import compat, rollback
from ...core.errors import BadInputError
from .out_attributes import forget, recorded

PAINT_NAME = "saddleback_density"


def prepare_weights(source: bpy.types.Object, name: str) -> bpy.types.VertexGroup:
    """The vertex group of this name, made without weights where there is none, and active."""
    group = source.vertex_groups.get(name)
    if group is None:
        _make_room(source, name)
        group = source.vertex_groups.new(name=name)
        rollback.undo_with(partial(source.vertex_groups.remove, group))
    source.vertex_groups.active = group
    return group


def prepare_colors(source: bpy.types.Object, name: str) -> bpy.types.Attribute:
    """The color attribute of this name, made black where there is none, and active."""
    mesh = source.data
    attribute = mesh.color_attributes.get(name)
    if attribute is None:
        _make_room(source, name)
        rollback.remember_attribute(mesh, name)
        attribute = mesh.color_attributes.new(name, "FLOAT_COLOR", "POINT")
        black = np.tile(np.array([0.0, 0.0, 0.0, 1.0], np.float32), len(mesh.vertices))
        attribute.data.foreach_set("color", black)
    compat.show_color(mesh, name)
    return mesh.color_attributes[name]


def _make_room(source: bpy.types.Object, name: str) -> None:
    """Removes a number attribute of the name that an earlier run wrote; refuses a name that is the artist's."""
    attribute = source.data.attributes.get(name)
    if attribute is not None and name in recorded(source.data) and attribute.data_type == "FLOAT":
        rollback.remember_attribute(source.data, name)
        source.data.attributes.remove(attribute)
        forget(source.data, name)
    if source.data.attributes.get(name) is not None or name in source.vertex_groups:
        raise BadInputError(f"'{source.name}' has another layer '{name}'; choose another name for the paint")

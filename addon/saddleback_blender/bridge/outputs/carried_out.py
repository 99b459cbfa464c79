# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes what was read at points of a mesh, onto the objects that have them as vertices."""

from __future__ import annotations

import bpy

from ..inputs.carried_in import Carried


def write_groups(item: bpy.types.Object, carried: Carried) -> None:
    """Makes or fills the vertex groups of an object whose vertices are the points."""
    for name, (vertices, weights) in carried.groups.items():
        group = item.vertex_groups.get(name) or item.vertex_groups.new(name=name)
        for vertex, weight in zip(vertices.tolist(), weights.tolist(), strict=True):
            group.add([vertex], weight, "REPLACE")

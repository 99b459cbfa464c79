# SPDX-License-Identifier: GPL-3.0-or-later
"""The numbers by which a mesh's vertices know their groups."""

from __future__ import annotations

import bpy


def group_numbers(source: bpy.types.Object, mesh: bpy.types.Mesh) -> dict[str, int]:
    """Number by name of the groups of `mesh`, the object's own or evaluated one.

    Modifiers that join other meshes, or make groups, number them anew.
    """
    owner = source if mesh == source.data else source.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return {group.name: group.index for group in owner.vertex_groups}

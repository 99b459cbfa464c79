# SPDX-License-Identifier: GPL-3.0-or-later
"""The materials that faces show, which are not always those of the mesh."""

from __future__ import annotations

import bpy


def shown_materials(item: bpy.types.Object, mesh: bpy.types.Mesh) -> list[bpy.types.Material | None]:
    """Returns them by the faces' material index: of the mesh, the object's own or evaluated one, unless the object has
    its own.
    """
    found = []
    for number, material in enumerate(mesh.materials):
        if number < len(item.material_slots) and item.material_slots[number].link == "OBJECT":
            material = item.material_slots[number].material
        found.append(material.original if material is not None else None)
    return found

# SPDX-License-Identifier: GPL-3.0-or-later
"""The materials that faces show, which are not always those of the mesh."""

from __future__ import annotations

import bpy

from ...finishes import GROUND
from ...nodes import MARK

PREVIEW = "distance"  # what begins the marks of materials that show distances
ADDED_SLOT = "saddleback_preview_slot"  # on an object: the slot that a mesh without materials was given
BEFORE = "saddleback_before_preview_"  # on an object, with a slot's number: the material that was linked to the object


def is_of(material: bpy.types.Material | None, kind: str) -> bool:
    """Tells whether a material is one of ours whose mark begins so."""
    return material is not None and str(material.get(MARK, "")).startswith(kind)


def shown_materials(item: bpy.types.Object, mesh: bpy.types.Mesh) -> list[bpy.types.Material | None]:
    """Returns them by the faces' material index: of the mesh, the object's own or evaluated one, unless the object has
    its own. What we show in place of the artist's is none of them.
    """
    found = []
    for number, material in enumerate(mesh.materials):
        if number < len(item.material_slots) and item.material_slots[number].link == "OBJECT":
            own = item.material_slots[number].material
            is_ours = is_of(own, PREVIEW) or is_of(own, GROUND)
            material = item.get(f"{BEFORE}{number}", material) if is_ours else own
        found.append(material.original if material is not None else None)
    return [] if ADDED_SLOT in item and not any(found) else found

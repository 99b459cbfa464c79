# SPDX-License-Identifier: GPL-3.0-or-later
"""Data-blocks of this file and of others: names that lead back to them, since a linked one may have a local one's name,
and whether they can be changed.
"""

from __future__ import annotations

from typing import Any

import bpy


def name_of(blocks: Any, block: bpy.types.ID | None) -> str:
    """The name by which `find` finds the data-block among those of its kind (`bpy.data.objects`, say); "" for None.

    Where a local one has it too, it is the name with the library's, as Blender writes it: 'Leaf [plants.blend]'.
    """
    if block is None:
        return ""
    return str(block.name if blocks.get(block.name) == block else block.name_full)


def find(blocks: Any, name: str) -> Any:
    """The data-block of this name, None where there is none."""
    if not name:
        return None
    found = blocks.get(name)
    return found if found is not None else next((block for block in blocks if block.name_full == name), None)


def is_editable(block: bpy.types.ID) -> bool:
    """Tells whether something may be added to a data-block: to none of another file, nor to an override of one."""
    return block.library is None and block.override_library is None

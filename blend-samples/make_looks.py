# SPDX-License-Identifier: GPL-3.0-or-later
"""Shows every look on a ring of its own, as one click makes it, and renders one picture of all: run by Python with bpy.

.cache/bpy-4.5/bin/python blend-samples/make_looks.py docs/images/looks.jpg
"""

from __future__ import annotations

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "blend-samples/scene"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "addon"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "build/python"))

import rings

COLUMNS = 5


def main() -> None:
    """Makes all looks, lights, renders."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    from saddleback_blender.looks import LOOKS

    ink = rings.ink()
    items = []
    for number, (key, look) in enumerate(LOOKS.items()):
        items.append(rings.ring(number, COLUMNS))
        bpy.ops.saddleback.apply_look(look=key)
        if key == "REMESH":
            made = next(child for child in items[-1].children if child.get("saddleback_role") == "dual")
            lines = made.modifiers.new("Lines", "WIREFRAME")
            lines.thickness, lines.use_replace, lines.material_offset = 0.014, False, 1
            made.data.materials.append(None)
            made.data.materials.append(ink)
        rings.label(look.label, items[-1], ink)
    rings.render(items, sys.argv[-1])


main()

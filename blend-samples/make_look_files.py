# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a .blend for each look, a ring as one click makes it, into blend-samples/out: run by Python with bpy.

.cache/bpy-4.5/bin/python blend-samples/make_look_files.py [LOOK ...]
"""

from __future__ import annotations

import sys
from pathlib import Path

import bpy

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / room) for room in ("blend-samples/scene", "addon", "build/python")]

import numpy as np
import rings
import studio
import subject

WIDTH, HEIGHT, SAMPLES = 960, 720, 32


def write(look: str, path: Path) -> None:
    """One look on a ring, lit, with a camera, in a file of its own."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    item = rings.ring(0, 1)
    bpy.ops.saddleback.apply_look(look=look)
    made = [subject.positions(child) for child in item.children if child.type == "MESH"]
    studio.add_to(bpy.context.scene, np.concatenate([subject.positions(item), *made]), WIDTH / HEIGHT)
    studio.use_cycles(bpy.context.scene, WIDTH, HEIGHT, SAMPLES)
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True)
    print(f"-- {path.relative_to(ROOT)}: {path.stat().st_size / 1e6:.1f} MB", flush=True)


def main() -> None:
    """Writes those that are named, or all."""
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    from saddleback_blender.looks import LOOKS

    folder = ROOT / "blend-samples" / "out"
    folder.mkdir(exist_ok=True)
    for look in [name.upper() for name in sys.argv[1:]] or LOOKS:
        write(look, folder / f"look-{look.lower()}.blend")


main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the pictures of docs/voronoi_2d.md from the scenes of blend-samples/make_voronoi_2d.py:

.cache/bpy-4.5/bin/python docs/images/make_voronoi_pictures.py [NAME ...]
"""

from __future__ import annotations

import sys
from pathlib import Path

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
for folder in ("blend-samples/scene", "addon", "build/python"):
    sys.path.insert(0, str(ROOT / folder))

import plane_scenes
import studio
import subject as models
from mathutils import Vector

HEIGHT, SAMPLES = 440, 12
# Picture: the scene, its arguments, width in pixels, the frame, whether the camera stands straight before a wall.
PICTURES: dict[str, tuple[str, dict[str, int], int, int, bool]] = {
    "tiles-random": ("tiles", {"iterations": 0}, 460, 1, True),
    "tiles": ("tiles", {}, 460, 1, True),
    "stipples": ("stipples", {}, 660, 1, True),
    "vase": ("vase", {}, 460, 1, False),
    "shell": ("shell", {}, 560, 1, False),
    "bubbles": ("bubbles", {}, 560, 1, False),
    "sweep-1": ("sweep", {}, 440, 30, True),
    "sweep-2": ("sweep", {}, 440, 58, True),
    "sweep-3": ("sweep", {}, 440, 84, True),
}


def shoot(name: str) -> None:
    """Builds, lights, renders, saves docs/images/voronoi-NAME.jpg."""
    builder, arguments, width, frame, is_straight = PICTURES[name]
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    items = getattr(plane_scenes, builder)(**arguments)
    scene = bpy.context.scene
    studio.VIEW = Vector((0.12, -1.0, 0.06) if is_straight else (0.45, -1.0, 0.42)).normalized()
    studio.add_to(scene, np.concatenate([models.positions(item) for item in items]), width / HEIGHT)
    studio.use_cycles(scene, width, HEIGHT, SAMPLES)
    scene.frame_set(frame)
    scene.render.image_settings.file_format = "JPEG"
    scene.render.image_settings.quality = 88
    scene.render.filepath = str(ROOT / "docs" / "images" / f"voronoi-{name}.jpg")
    bpy.ops.render.render(write_still=True)
    print(f"-- {scene.render.filepath}", flush=True)


def main() -> None:
    """Makes the pictures that are named, or all."""
    for name in sys.argv[1:] or PICTURES:
        shoot(name)


main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Diagrams of the plane through the add-on's operator, lit and saved: run by Blender.

    blender -b --factory-startup --python blend-samples/make_voronoi_2d.py -- SCENE OUT.blend
    blender -b --factory-startup --python blend-samples/render.py -- OUT.blend OUT.png

SCENE is one of: tiles (a plate with a hole), stipples (dots by an image's darkness), vase (through a UV map), shell
(through a disk), bubbles (sites with weights), sweep (an animation of 120 frames: open OUT.blend and press play).
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "blend-samples/scene"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "addon"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "build/python"))

import plane_scenes
import studio
import subject as models

WIDTH, HEIGHT, SAMPLES = 1280, 960, 8
SCENES = ("tiles", "stipples", "vase", "shell", "bubbles", "sweep")


def main() -> None:
    """Makes, lights, saves."""
    parser = argparse.ArgumentParser(prog="make_voronoi_2d.py")
    parser.add_argument("scene", choices=SCENES)
    parser.add_argument("out", type=Path)
    options = parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])

    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    items = getattr(plane_scenes, options.scene)()
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 120
    studio.add_to(scene, np.concatenate([models.positions(item) for item in items]), WIDTH / HEIGHT)
    studio.use_cycles(scene, WIDTH, HEIGHT, SAMPLES)
    scene.frame_set(60)
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=str(options.out.resolve()), compress=True)


main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders a scene that make_cells.py saved: run by Blender, or by Python with the bpy package.

blender -b --factory-startup --python blend-samples/render.py -- SCENE.blend OUT.png [SAMPLES [PERCENT]]
python blend-samples/render.py -- SCENE.blend OUT.png [SAMPLES [PERCENT]]
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent / "scene"))

import studio


def main() -> None:
    """Opens, renders, writes the picture."""
    source, target, *rest = sys.argv[sys.argv.index("--") + 1 :]
    started = time.time()
    bpy.ops.wm.open_mainfile(filepath=str(Path(source).resolve()), load_ui=False)
    scene = bpy.context.scene
    samples = int(rest[0]) if rest else scene.cycles.samples
    denoises = studio.use_cycles(scene, scene.render.resolution_x, scene.render.resolution_y, samples)
    if len(rest) > 1:
        scene.render.resolution_percentage = int(rest[1])
    if not denoises:
        scene.cycles.samples = 3 * samples
    scene.render.filepath = str(Path(target).resolve())
    scene.render.image_settings.file_format = "PNG"
    bpy.ops.render.render(write_still=True)
    how = "denoised" if denoises else "not denoised"
    print(f"   Rendered by Blender {bpy.app.version_string}, {how}: {time.time() - started:.1f} s", flush=True)


main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the pictures of the faces that Tessellate can make of cells, docs/images/tessellation-faces.jpg and
tessellation-curvature.jpg: with Debian's Blender, call

SADDLEBACK_PYTHONPATH=build/python blender -b --factory-startup -P docs/images/make_faces_picture.py
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import bpy

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "addon"), *os.environ.get("SADDLEBACK_PYTHONPATH", "").split(os.pathsep)]
PICTURES: dict[str, tuple[dict[str, object], ...]] = {
    "faces": (
        {"make_cells": True, "cell_faces": "ONE"},
        {"make_dual": True},
        {"make_dual": True, "dual_faces": "QUADS"},
    ),
    "curvature": tuple({"make_dual": True, "follow_curvature": follow} for follow in (0.0, 0.5, 1.0)),
}


def material(name: str, color: tuple[float, float, float]) -> bpy.types.Material:
    """What Workbench shows."""
    made = bpy.data.materials.new(name)
    made.diffuse_color = (*color, 1)
    return made


def head(place: float, settings: dict[str, object]) -> None:
    """Suzanne's cells with their edges."""
    bpy.ops.mesh.primitive_monkey_add(location=(place, 0, 0))
    source = bpy.context.object
    source.modifiers.new("Finer", "SUBSURF").levels = 2
    source.data.materials.append(material("Clay", (0.72, 0.6, 0.46)))
    bpy.ops.saddleback.tessellate(count=400, iterations=30, make_edges=False, use_modifiers=True, **settings)
    source.hide_render = True
    for child in source.children:
        child.hide_render = child["saddleback_role"] not in ("cells", "dual")
        child.data.materials.append(material("Lines", (0.05, 0.05, 0.08)))
        lines = child.modifiers.new("Lines", "WIREFRAME")
        lines.thickness, lines.use_replace, lines.use_even_offset, lines.material_offset = 0.012, False, False, 1


def shoot(name: str) -> None:
    """Three heads side by side."""
    bpy.ops.wm.read_homefile(use_empty=True)
    for place, settings in zip((-2.5, 0.0, 2.5), PICTURES[name], strict=True):
        head(place, settings)
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    camera.location, camera.rotation_euler, camera.data.lens, scene.camera = (0, -11, 1.2), (1.46, 0, 0), 53, camera
    scene.world = bpy.data.worlds.new("White")
    scene.world.color = (1, 1, 1)
    scene.render.engine = "BLENDER_WORKBENCH"
    scene.display.shading.color_type = "MATERIAL"
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y = 1200, 400
    scene.render.image_settings.file_format = "JPEG"
    scene.render.filepath = str(ROOT / f"docs/images/tessellation-{name}.jpg")
    bpy.ops.render.render(write_still=True)


def main() -> None:
    """Makes the pictures that are named, or all."""
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    named = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    for name in named or PICTURES:
        shoot(name)


main()

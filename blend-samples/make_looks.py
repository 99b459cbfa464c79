"""Shows every look on a ring of its own, as one click makes it, and renders one picture of all: run by Python with bpy.

.cache/bpy-4.5/bin/python blend-samples/make_looks.py docs/images/looks.jpg
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "blend-samples/scene"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "addon"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "build/python"))

import studio
import subject as models

WIDTH, HEIGHT, SAMPLES = 1200, 560, 8
COLUMNS, STEP = 5, 3.0
TURN = (math.radians(55.0), math.radians(12.0), 0.0)


def ring(number: int) -> bpy.types.Object:
    """A torus in its place of the picture: from left to right, then the row below."""
    bpy.ops.mesh.primitive_torus_add(major_radius=0.95, minor_radius=0.45, rotation=TURN)
    item = bpy.context.active_object
    item.location = STEP * (number % COLUMNS), 0.0, -1.08 * STEP * (number // COLUMNS)
    bpy.ops.object.shade_smooth()
    item.modifiers.new("Smooth", "SUBSURF").levels = 1
    bpy.context.view_layer.update()
    return item


def label(text: str, item: bpy.types.Object, color: bpy.types.Material) -> None:
    """The name of a look below its ring."""
    curve = bpy.data.curves.new(text, "FONT")
    curve.body, curve.size, curve.align_x = text, 0.32, "CENTER"
    curve.materials.append(color)
    name = bpy.data.objects.new(text, curve)
    name.location = item.location.x, -1.2, item.location.z - 1.62
    name.rotation_euler = math.radians(90.0), 0.0, 0.0
    bpy.context.scene.collection.objects.link(name)


def main() -> None:
    """Makes all looks, lights, renders."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    from saddleback_blender.looks import LOOKS

    ink = studio.principled("Ink", (0.03, 0.03, 0.03), Roughness=0.8)
    items = []
    for number, (key, look) in enumerate(LOOKS.items()):
        items.append(ring(number))
        bpy.ops.saddleback.apply_look(look=key)
        if key == "REMESH":
            made = next(child for child in items[-1].children if child.get("saddleback_role") == "dual")
            lines = made.modifiers.new("Lines", "WIREFRAME")
            lines.thickness, lines.use_replace, lines.material_offset = 0.014, False, 1
            made.data.materials.append(None)
            made.data.materials.append(ink)
        label(look.label, items[-1], ink)
    scene = bpy.context.scene
    studio.VIEW = studio.Vector((0.0, -1.0, 0.0))
    studio.add_to(scene, np.concatenate([models.positions(item) for item in items]) * (1.0, 1.0, 1.14), WIDTH / HEIGHT)
    studio.use_cycles(scene, WIDTH, HEIGHT, SAMPLES)
    scene.render.image_settings.file_format, scene.render.image_settings.quality = "JPEG", 85
    scene.render.filepath = str(Path(sys.argv[-1]).resolve())
    bpy.ops.render.render(write_still=True)


main()

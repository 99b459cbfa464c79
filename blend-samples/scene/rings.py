# SPDX-License-Identifier: GPL-3.0-or-later
"""Rings side by side, a name below each: for pictures that show several things at once."""

from __future__ import annotations

import math
from pathlib import Path

import bpy
import numpy as np
import studio
import subject as models

WIDTH, HEIGHT, SAMPLES = 1200, 560, 8
STEP = 3.0
TURN = (math.radians(55.0), math.radians(12.0), 0.0)


def ring(number: int, columns: int) -> bpy.types.Object:
    """A torus in its place of the picture: from left to right, then the row below."""
    bpy.ops.mesh.primitive_torus_add(major_radius=0.95, minor_radius=0.45, rotation=TURN)
    item = bpy.context.active_object
    item.location = STEP * (number % columns), 0.0, -1.08 * STEP * (number // columns)
    bpy.ops.object.shade_smooth()
    item.modifiers.new("Smooth", "SUBSURF").levels = 1
    bpy.context.view_layer.update()
    return item


def label(text: str, item: bpy.types.Object, color: bpy.types.Material) -> None:
    """The name of what a ring shows, below it."""
    curve = bpy.data.curves.new(text, "FONT")
    curve.body, curve.size, curve.align_x = text, 0.32, "CENTER"
    curve.materials.append(color)
    name = bpy.data.objects.new(text, curve)
    name.location = item.location.x, -1.2, item.location.z - 1.62
    name.rotation_euler = math.radians(90.0), 0.0, 0.0
    bpy.context.scene.collection.objects.link(name)


def ink() -> bpy.types.Material:
    """The material of names and lines."""
    return studio.principled("Ink", (0.03, 0.03, 0.03), Roughness=0.8)


def render(items: list[bpy.types.Object], path: str) -> None:
    """Lights the rings and renders them as a JPEG."""
    scene = bpy.context.scene
    studio.VIEW = studio.Vector((0.0, -1.0, 0.0))
    studio.add_to(scene, np.concatenate([models.positions(item) for item in items]) * (1.0, 1.0, 1.14), WIDTH / HEIGHT)
    studio.use_cycles(scene, WIDTH, HEIGHT, SAMPLES)
    scene.render.image_settings.file_format, scene.render.image_settings.quality = "JPEG", 85
    scene.render.filepath = str(Path(path).resolve())
    bpy.ops.render.render(write_still=True)

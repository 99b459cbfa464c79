# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes docs/images/shapes-pictures.jpg, shapes that show their images: with Python that has bpy, call

.cache/bpy-4.5/bin/python docs/images/make_stickers_picture.py
"""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("blend-samples/scene", "blend-samples/creature", "docs/manual/recipes", "addon", "build/python")
sys.path[:0] = [str(ROOT / room) for room in ROOMS]

import bpy
import models
import numpy as np
import studio
import subject

SIZE = 256
PINK, BLUE = ((0.85, 0.16, 0.3), (0.98, 0.55, 0.35)), ((0.1, 0.25, 0.7), (0.35, 0.75, 0.95))


def image(name: str, colors: np.ndarray, mask: np.ndarray) -> bpy.types.Image:
    """Packed into the file."""
    made = bpy.data.images.new(name, SIZE, SIZE, alpha=True)
    made.pixels.foreach_set(np.dstack([colors, mask]).astype(np.float32).ravel())
    made.pack()
    return made


def flower(name: str, petals: int, colors: tuple[tuple[float, ...], tuple[float, ...]]) -> bpy.types.Image:
    """Petals that change color towards their tips, around a yellow middle; nothing behind them."""
    y, x = np.mgrid[-1 : 1 : SIZE * 1j, -1 : 1 : SIZE * 1j]
    radius, angle = np.hypot(x, y), np.arctan2(y, x)
    edge = 0.62 + 0.3 * np.abs(np.cos(petals * angle / 2))
    share = np.clip(radius / edge, 0, 1)[..., None]
    shown = np.array(colors[0]) * (1 - share) + np.array(colors[1]) * share
    shown *= (0.75 + 0.25 * np.abs(np.cos(petals * angle / 2)))[..., None]
    middle = np.clip((0.24 - radius) * 60, 0, 1)[..., None]
    shown = shown * (1 - middle) + np.array((0.95, 0.75, 0.15)) * middle
    return image(name, shown, np.clip((edge - radius) * 40, 0, 1))


def main() -> None:
    """A vase with two kinds of flowers."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    item = models.vase()
    item.data.materials.append(studio.principled("Glaze", (0.78, 0.8, 0.74), Roughness=0.25))
    flowers = bpy.data.collections.new("Flowers")
    bpy.context.scene.collection.children.link(flowers)
    for name, petals, colors, share in (("Rose", 5, PINK, 1.0), ("Aster", 9, BLUE, 1.0)):
        empty = bpy.data.objects.new(name, None)
        empty.empty_display_type, empty.data = "IMAGE", flower(name, petals, colors)
        empty["share"] = share
        flowers.objects.link(empty)
    bpy.ops.object.select_all(action="DESELECT")
    item.select_set(True)
    bpy.context.view_layer.objects.active = item
    bpy.ops.saddleback.distribute(
        shapes="COLLECTION", shapes_collection="Flowers", count=150, size_variation=0.5, thickness=0.012
    )
    studio.add_to(bpy.context.scene, subject.positions(item), 1.5)
    studio.use_cycles(bpy.context.scene, 660, 440, 12)
    bpy.context.scene.render.image_settings.file_format = "JPEG"
    bpy.context.scene.render.image_settings.quality = 88
    bpy.context.scene.render.filepath = str(ROOT / "docs/images/shapes-pictures.jpg")
    bpy.ops.render.render(write_still=True)


main()

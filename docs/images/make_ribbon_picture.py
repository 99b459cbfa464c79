# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes docs/images/ribbon.jpg, a text along a stroke and a ring of links: with Python that has bpy, call

.cache/bpy-4.5/bin/python docs/images/make_ribbon_picture.py
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

GOLD = (0.83, 0.55, 0.16)


def curve(name: str, item: bpy.types.Object, places: np.ndarray, is_closed: bool) -> bpy.types.Object:
    """A line through places in the world."""
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = "3D"
    spline = data.splines.new("POLY")
    spline.points.add(len(places) - 1)
    spline.points.foreach_set("co", np.column_stack([places, np.ones(len(places))]).astype(np.float32).ravel())
    spline.use_cyclic_u = is_closed
    made = bpy.data.objects.new(name, data)
    made.parent, made.hide_render = item, True
    bpy.context.scene.collection.objects.link(made)
    return made


def text() -> bpy.types.Object:
    """A word with some thickness."""
    data = bpy.data.curves.new("Word", "FONT")
    data.body, data.extrude = "Saddleback", 0.04
    data.materials.append(studio.principled("Ink", (0.05, 0.08, 0.2), Roughness=0.35))
    return hidden(bpy.data.objects.new("Word", data))


def link() -> bpy.types.Object:
    """A bead between two rods, as of a necklace."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=16, radius=0.5)
    bead = bpy.context.active_object
    bpy.ops.mesh.primitive_cylinder_add(vertices=16, radius=0.12, depth=1.4, rotation=(0, np.pi / 2, 0))
    rod = bpy.context.active_object
    rod.location.z = bead.location.z = 0.3
    for part in (rod, bead):
        part.select_set(True)
        part.data.polygons.foreach_set("use_smooth", [True] * len(part.data.polygons))
    bpy.context.view_layer.objects.active = bead
    bpy.ops.object.join()
    bpy.ops.object.transform_apply()
    bead.name = "Link"
    bead.data.materials.append(studio.principled("Gold", GOLD, Roughness=0.25, Metallic=1.0))
    bpy.context.scene.collection.objects.unlink(bead)
    return hidden(bead)


def hidden(item: bpy.types.Object) -> bpy.types.Object:
    """In the scene, but not in the picture."""
    bpy.context.scene.collection.objects.link(item)
    item.hide_render = True
    return item


def main() -> None:
    """A vase with a word that winds around it, and a ring around its neck."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    item = models.vase()
    item.data.materials.append(studio.principled("Glaze", (0.78, 0.8, 0.74), Roughness=0.25))
    places = subject.positions(item)
    low, high = places.min(axis=0), places.max(axis=0)
    middle, size = (low + high) / 2, high - low
    turn = np.linspace(-2.7, 0.35, 60)
    word = np.column_stack([
        middle[0] + size[0] * np.cos(turn), middle[1] + size[1] * np.sin(turn),
        low[2] + size[2] * (0.42 + 0.12 * np.sin(2.2 * turn + 2.0)),
    ])  # fmt: skip
    turn = np.linspace(0.0, 2 * np.pi, 60, endpoint=False)
    ring = np.column_stack([
        middle[0] + size[0] / 4 * np.cos(turn), middle[1] + size[1] / 4 * np.sin(turn),
        np.full(60, low[2] + 0.82 * size[2]),
    ])  # fmt: skip
    curve("Word Line", item, word, is_closed=False)
    curve("Ring", item, ring, is_closed=True)
    text()
    link()
    bpy.context.view_layer.objects.active = item
    item.select_set(True)
    extent = float(np.linalg.norm(size))
    bpy.ops.saddleback.ribbon(
        curves_object="Word Line",
        show="OBJECT",
        ribbon_object="Word",
        repeat="STRETCH",
        width=0.11 * extent,
        lift=0.002 * extent,
    )
    bpy.ops.saddleback.layer_add()
    bpy.ops.saddleback.ribbon(
        curves_object="Ring", show="OBJECT", ribbon_object="Link", width=0.045 * extent, lift=0.001 * extent
    )
    studio.add_to(bpy.context.scene, places, 1.5)
    studio.use_cycles(bpy.context.scene, 660, 440, 12)
    bpy.context.scene.render.image_settings.file_format = "JPEG"
    bpy.context.scene.render.image_settings.quality = 88
    bpy.context.scene.render.filepath = str(ROOT / "docs/images/ribbon.jpg")
    bpy.ops.render.render(write_still=True)


main()

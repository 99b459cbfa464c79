# SPDX-License-Identifier: GPL-3.0-or-later
"""Clothes a model in scales that follow its strokes, through the add-on's operators, lights it, saves: run by Blender.

    blender -b --factory-startup --python blend-samples/make_scales.py -- MODEL OUT.blend [OPTION ...]
    blender -b --factory-startup --python blend-samples/render.py -- OUT.blend OUT.png

MODEL is a .blend (its active mesh object; curves that are its children are the strokes, a layer with "density" in its
name says where scales are small) or a mesh: .obj .ply .off .stl.
Options: --shapes PRESET, --count N (how many of them the size is made for), --up y|z, --turn DEGREES.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "blend-samples/scene"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "addon"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "build/python"))

import looks
import palette
import studio
import subject as models

WIDTH, HEIGHT, SAMPLES = 1280, 960, 8
ROLE = "saddleback_role"
PRESETS = ("SCALES", "STUDS", "FEATHERS", "LEAVES", "MOSAIC")


def cover(subject: bpy.types.Object, shapes: str, count: int) -> bpy.types.Object:
    """Calls the add-on; returns the object of all scales."""
    has_strokes = any(child.type == "CURVE" and ROLE not in child for child in subject.children)
    paint = models.find_paint(subject)
    if paint.source == "UNIFORM":
        paint = models.paint_curvature(subject)
    started = time.time()
    bpy.ops.saddleback.direction_field(strokes="COLLECTION" if has_strokes else "NONE", make_arrows=False)
    # Side by side until nothing more fits.
    bpy.ops.saddleback.distribute(
        shapes=shapes, maximal=True, size=math.sqrt(0.5 * models.area(subject) / (2.0 * count)), packing=1.0, seed=7,
        size_by_density=True, size_variation=0.12, density_source=paint.source, density_name=paint.name,
        density_contrast=0.7,
    )  # fmt: skip
    print(f"   Field and scales: {time.time() - started:.1f} s", flush=True)
    return next(child for child in subject.children if child.get(ROLE) == "shapes")


def color(scales: bpy.types.Object, subject: bpy.types.Object) -> None:
    """Gives every scale one color by its place."""
    mesh = scales.data
    number = looks.read(mesh, "saddleback_shape", "FACE", 1)
    random = looks.read(mesh, "saddleback_random", "FACE", 1)
    corners, places = np.empty(len(mesh.loops), np.int32), models.positions(scales)
    totals = np.empty(len(mesh.polygons), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    mesh.polygons.foreach_get("loop_total", totals)
    owner = np.repeat(number, totals)
    count = np.maximum(np.bincount(owner), 1)
    centers = np.stack([np.bincount(owner, places[corners, i]) / count for i in range(3)], axis=1)
    own = np.zeros(len(count))
    own[number] = random
    body = models.positions(subject)
    colors = palette.scale_colors(centers, own, body.min(axis=0), body.max(axis=0))
    rgba = np.concatenate([colors, np.ones((len(colors), 1))], axis=1).astype(np.float32)
    mesh.color_attributes[looks.COLOR].data.foreach_set("color", rgba[owner].ravel())


def main() -> None:
    """Reads, covers, dresses, lights, saves."""
    parser = argparse.ArgumentParser(prog="make_scales.py")
    parser.add_argument("model", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--shapes", choices=PRESETS, default="SCALES")
    parser.add_argument("--count", type=int, default=4000)
    parser.add_argument("--up", choices=("y", "z"), default="")
    parser.add_argument("--turn", type=float, default=0.0)
    options = parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])

    subject = models.open_subject(options.model, options.up or ("z" if options.model.suffix == ".stl" else "y"))
    subject.matrix_world = Matrix.Rotation(math.radians(options.turn), 4, "Z") @ subject.matrix_world
    bpy.context.view_layer.update()
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    models.refine(subject)
    scales = cover(subject, options.shapes, options.count)
    color(scales, subject)
    scales.data.materials[0].user_remap(looks.horn())
    subject.data.materials.clear()
    subject.data.materials.append(looks.skin())
    for child in subject.children:
        if ROLE not in child:
            looks.dress_child(child)
    family = [subject, *(child for child in subject.children if child.type == "MESH" and ROLE not in child)]
    studio.add_to(bpy.context.scene, np.concatenate([models.positions(item) for item in family]), WIDTH / HEIGHT)
    studio.use_cycles(bpy.context.scene, WIDTH, HEIGHT, SAMPLES)
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=str(options.out.resolve()), compress=True)


main()

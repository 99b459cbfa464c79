# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances and shortest paths on a model through the add-on's operators, lit and saved: run by Blender.

    blender -b --factory-startup --python blend-samples/make_distance.py -- MODEL OUT.blend [OPTION ...]
    blender -b --factory-startup --python blend-samples/render.py -- OUT.blend OUT.png

Colors and isolines tell the distance along the surface from one tip of the model; tubes are the shortest paths between
all its tips. MODEL is a .blend (its active mesh object) or a mesh: .obj .ply .off .stl.
Options: --tips N, --lines N, --up y|z, --turn DEGREES.
"""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "blend-samples/scene"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "addon"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "build/python"))

import looks
import studio
import subject as models

WIDTH, HEIGHT, SAMPLES = 1280, 960, 8
GROUP = "Saddleback tips"


def measure(vertex: int, **settings: object) -> np.ndarray:
    """The operator, from one vertex; distances (V,)."""
    subject = bpy.context.view_layer.objects.active
    chosen = np.zeros(len(subject.data.vertices), bool)
    chosen[vertex] = True
    subject.data.polygons.foreach_set("select", np.zeros(len(subject.data.polygons), bool))
    subject.data.vertices.foreach_set("select", chosen)
    bpy.ops.saddleback.distance(sources="SELECTED", **settings)
    return looks.read(subject.data, "saddleback_distance", "POINT", 1)


def find_tips(subject: bpy.types.Object, count: int) -> list[int]:
    """Vertices far from each other: the farthest from the middle, then always the farthest from all before."""
    places = models.positions(subject)
    middle = int(np.linalg.norm(places - places.mean(axis=0), axis=1).argmin())
    tips: list[int] = []
    nearest = measure(middle)
    while len(tips) < count:
        tips.append(int(np.where(np.isfinite(nearest), nearest, -1).argmax()))
        from_tip = measure(tips[-1])
        nearest = from_tip if len(tips) == 1 else np.minimum(nearest, from_tip)
    return tips


def main() -> None:
    """Reads, measures, dresses, lights, saves."""
    parser = argparse.ArgumentParser(prog="make_distance.py")
    parser.add_argument("model", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--tips", type=int, default=5)
    parser.add_argument("--lines", type=int, default=24)
    parser.add_argument("--up", choices=("y", "z"), default="")
    parser.add_argument("--turn", type=float, default=0.0)
    options = parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])

    subject = models.open_subject(options.model, options.up or ("z" if options.model.suffix == ".stl" else "y"))
    subject.matrix_world = Matrix.Rotation(math.radians(options.turn), 4, "Z") @ subject.matrix_world
    bpy.context.view_layer.update()
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    size = math.sqrt(models.area(subject))
    tips = find_tips(subject, options.tips)
    measure(
        tips[0],
        make_isolines=True,
        isoline_count=options.lines,
        isoline_radius=0.0011 * size,
        make_preview=True,
        preview_lines=False,
    )
    subject.vertex_groups.new(name=GROUP).add(tips, 1.0, "REPLACE")
    bpy.ops.saddleback.path(
        points="VERTEX_GROUP", points_group=GROUP, connect="PAIRS", path_radius=0.005 * size, lift=0.002 * size
    )
    for child in subject.children:
        looks.dress_child(child)
    family = [subject, *(child for child in subject.children if child.type == "MESH")]
    studio.add_to(bpy.context.scene, np.concatenate([models.positions(item) for item in family]), WIDTH / HEIGHT)
    studio.use_cycles(bpy.context.scene, WIDTH, HEIGHT, SAMPLES)
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=str(options.out.resolve()), compress=True)


main()

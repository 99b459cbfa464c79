# SPDX-License-Identifier: GPL-3.0-or-later
"""Combs a model through the add-on's operator, shows how it runs, lights it and saves the scene: run by Blender.

    blender -b --factory-startup --python blend-samples/make_fields.py -- MODEL OUT.blend [OPTION ...]
    blender -b --factory-startup --python blend-samples/render.py -- OUT.blend OUT.png

Dark lines follow the field, which follows the strokes (red): curves that are children of the model. A model without any
is combed as smoothly as can be; lines and crosses then follow how it bends. MODEL is a .blend (its active mesh object)
or a mesh: .obj .ply .off .stl.
Options: --symmetry 1|2|4, --lines N (across the model), --up y|z, --turn DEGREES.
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
ROLE = "saddleback_role"


def strokes_of(subject: bpy.types.Object) -> list[bpy.types.Object]:
    """The curves that somebody drew on the model."""
    return [child for child in subject.children if child.type == "CURVE" and ROLE not in child]


def main() -> None:
    """Reads, combs, dresses, lights, saves."""
    parser = argparse.ArgumentParser(prog="make_fields.py")
    parser.add_argument("model", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--symmetry", choices=("1", "2", "4"), default="")
    parser.add_argument("--lines", type=int, default=90)
    parser.add_argument("--up", choices=("y", "z"), default="")
    parser.add_argument("--turn", type=float, default=0.0)
    options = parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])

    subject = models.open_subject(options.model, options.up or ("z" if options.model.suffix == ".stl" else "y"))
    subject.matrix_world = Matrix.Rotation(math.radians(options.turn), 4, "Z") @ subject.matrix_world
    bpy.context.view_layer.update()
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    strokes = strokes_of(subject)
    size = float(np.linalg.norm(np.ptp(models.positions(subject), axis=0)))
    bpy.ops.saddleback.direction_field(
        symmetry=options.symmetry or ("1" if strokes else "4"),
        strokes="COLLECTION" if strokes else "NONE",
        align="NONE" if strokes or options.symmetry == "1" else "CURVATURE",
        make_arrows=False,
        make_streamlines=True,
        streamline_spacing=size / options.lines,
        streamline_radius=0.11 * size / options.lines,
    )
    subject.data.materials.clear()
    subject.data.materials.append(looks.clay())
    for item in strokes:
        item.data.bevel_depth = 0.24 * size / options.lines
        item.data.materials.append(looks.red_ink())
    for child in subject.children:
        looks.dress_child(child)
    family = [subject, *(child for child in subject.children if child.type == "MESH")]
    studio.add_to(bpy.context.scene, np.concatenate([models.positions(item) for item in family]), WIDTH / HEIGHT)
    studio.use_cycles(bpy.context.scene, WIDTH, HEIGHT, SAMPLES)
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=str(options.out.resolve()), compress=True)


main()

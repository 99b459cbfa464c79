# SPDX-License-Identifier: GPL-3.0-or-later
"""Covers a model with geodesic cells through the add-on's operators, lights it and saves the scene: run by Blender.

    blender -b --factory-startup --python blend-samples/make_cells.py -- MODEL OUT.blend [OPTION ...]

MODEL is a .blend (its active mesh object, with a painted density if it has one) or a mesh: .obj .ply .off .stl.
Options: --count N, --up y|z, --turn DEGREES.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
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
ROLE = "saddleback_role"  # on the add-on's output objects: "edges", "cells", "centers"


def say(text: str) -> None:
    """One plain line, at once."""
    print(f"   {text}", flush=True)


@contextmanager
def timed(what: str) -> Iterator[None]:
    """Says how long a step took."""
    started = time.time()
    yield
    say(f"{what}: {time.time() - started:.1f} s")


def cells_for(subject: bpy.types.Object, wanted: int) -> int:
    """Returns how many cells: as asked, or as many as the mesh shows well."""
    vertices = len(subject.data.vertices)
    return min(wanted, vertices) if wanted else int(np.clip(vertices / 25, min(12, vertices), 1500))


def tessellate(subject: bpy.types.Object, paint: models.Paint, count: int) -> None:
    """Calls the add-on, and the repair that it asks for where the mesh is damaged."""
    radius = math.sqrt(models.area(subject) / (count * math.pi))  # of a cell of mean area
    settings = {
        "count": count,
        "seed": 7,
        "iterations": 12,
        "k": min(40, len(subject.data.vertices)),
        "density_source": paint.source,
        "density_name": paint.name,
        "density_attribute": "saddleback_density_used",
        "make_edges": True,
        "edge_radius": 0.085 * radius,
        "make_cells": True,
        "gap": 0.10 * radius,
        "inset": 0.16 * radius,
        "thickness": 0.11 * radius,
        "make_centers": True,
        "instance_object": looks.make_stud(looks.gold()).name,
        "instance_scale": 0.2,
    }
    bpy.ops.saddleback.tessellate(**settings)


def repaired(subject: bpy.types.Object) -> None:
    """Repairs the mesh if the library would refuse it, and says what was wrong."""
    import saddleback

    try:
        saddleback.Mesh(models.positions(subject), models.triangles(subject))
        return
    except saddleback.MeshError as error:
        say(f"The mesh needs repair: {error}")
    bpy.ops.saddleback.repair()


def output(subject: bpy.types.Object, role: str) -> bpy.types.Object:
    """Returns what the add-on made for the subject."""
    return next(item for item in subject.children if item.get(ROLE) == role)


def dress(subject: bpy.types.Object) -> None:
    """Materials, and a color for each cell."""
    cells, edges, centers = (output(subject, role) for role in ("cells", "edges", "centers"))
    for child in subject.children:
        if ROLE not in child:
            looks.dress_child(child)
    subject.data.materials.clear()
    subject.data.materials.append(looks.grout())
    cells.data.materials[0].user_remap(looks.enamel())
    edges.data.materials[0].user_remap(bpy.data.materials["Gold"])
    points = models.positions(centers)
    turn = np.array(centers.matrix_world.to_3x3().normalized())
    normals = looks.read(centers.data, "saddleback_normal", "POINT", 3) @ turn.T
    areas = looks.read(centers.data, "saddleback_area", "POINT", 1)
    face_cell = looks.read(cells.data, "saddleback_cell", "FACE", 1)
    looks.color_cells(cells, face_cell, points, normals, areas, models.positions(subject))


def extent(subject: bpy.types.Object) -> np.ndarray:
    """World positions of everything that is to be in the picture."""
    family = [subject, *(child for child in subject.children if child.type == "MESH" and ROLE not in child)]
    return np.concatenate([models.positions(item) for item in family])


def main() -> None:
    """Reads, paints, tessellates, dresses, lights, saves."""
    parser = argparse.ArgumentParser(prog="make_cells.py")
    parser.add_argument("model", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--count", type=int, default=0)
    parser.add_argument("--up", choices=("y", "z"), default="")
    parser.add_argument("--turn", type=float, default=0.0)
    options = parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])
    up = options.up or ("z" if options.model.suffix.lower() == ".stl" else "y")

    with timed("Model read"):
        subject = models.open_subject(options.model, up)
        subject.matrix_world = Matrix.Rotation(math.radians(options.turn), 4, "Z") @ subject.matrix_world
        bpy.context.view_layer.update()
    if options.model.suffix.lower() != ".blend":
        say(f"Up is {up}, seen from the front: --up and --turn change that")
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    repaired(subject)
    coarse = len(models.triangles(subject))
    fine = models.refine(subject)
    if fine > coarse:
        say(f"{coarse:,} triangles are few: split into {fine:,} of the same shape, for smooth lines between the cells")
    paint = models.find_paint(subject)
    if paint.source == "UNIFORM":
        paint = models.paint_curvature(subject)
        say("Density: by curvature" if paint.name else "Density: even")
    else:
        say(f"Density: painted, {paint.source.lower().replace('_', ' ')} '{paint.name}'")
    count = cells_for(subject, options.count)
    with timed(f"{count:,} cells on {len(models.triangles(subject)):,} triangles"):
        tessellate(subject, paint, count)
    dress(subject)
    studio.add_to(bpy.context.scene, extent(subject), WIDTH / HEIGHT)
    studio.use_cycles(bpy.context.scene, WIDTH, HEIGHT, SAMPLES)
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=str(options.out.resolve()), compress=True)


main()

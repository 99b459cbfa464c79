# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes that never collide: `python -m tests.bench distribution [--blender PATH] [--size R]`.

On a torus of 400,000 faces, four classes, certificate included: CPU and wall seconds, copies, memory. In the same run
Blender's own node (Distribute Points on Faces, Poisson disk, 1,000 candidates for every copy; points only, no shapes)
and rejection: even random places in the plane tried one after the other against exact polygons. Then ratios of counts,
all certified: packed against random, stars against disks on a torus, pentagrams against disks in fields that turn.
"""

from __future__ import annotations

import argparse
import resource
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

import saddleback as sb
from tests import meshes

NODE = """
import bpy, sys, time
import numpy as np
path, distance, density = sys.argv[sys.argv.index("--") + 1:]
data = np.load(path)
mesh = bpy.data.meshes.new("m")
mesh.from_pydata(data["vertices"].tolist(), [], data["triangles"].tolist())
body = bpy.data.objects.new("m", mesh)
bpy.context.scene.collection.objects.link(body)
group = bpy.data.node_groups.new("g", "GeometryNodeTree")
group.inputs.new("NodeSocketGeometry", "Geometry")
group.outputs.new("NodeSocketGeometry", "Geometry")
begin, end = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
node = group.nodes.new("GeometryNodeDistributePointsOnFaces")
node.distribute_method = "POISSON"
node.inputs["Distance Min"].default_value = float(distance)
node.inputs["Density Max"].default_value = float(density)
group.links.new(begin.outputs[0], node.inputs["Mesh"])
group.links.new(node.outputs["Points"], end.inputs[0])
body.modifiers.new("n", "NODES").node_group = group
start, cpu = time.perf_counter(), time.process_time()
bpy.context.evaluated_depsgraph_get().update()
print("NODE", time.perf_counter() - start, time.process_time() - cpu)
"""


def blender_seconds(blender: str, mesh: sb.Mesh, distance: float, copies: int) -> str:
    with tempfile.TemporaryDirectory() as folder:
        path, script = Path(folder) / "mesh.npz", Path(folder) / "node.py"
        np.savez(path, vertices=mesh.vertices, triangles=mesh.triangles)
        script.write_text(NODE)
        density = 1000 * copies / mesh.area
        out = subprocess.run(
            [blender, "-b", "--factory-startup", "-P", str(script), "--", str(path), str(distance), str(density)],
            capture_output=True,
            text=True,
            check=False,
        ).stdout
    lines = [line for line in out.splitlines() if line.startswith("NODE")]
    return lines[0][5:] if lines else "did not run"


def rejection(shape: sb.Shape, radius: float, tries: int) -> tuple[int, float]:
    """Random places in the unit square against exact polygons: how many found room, and CPU seconds."""
    rng, start = np.random.default_rng(0), time.process_time()
    places: list[np.ndarray] = []
    laid: list[sb.Shape] = []
    for place in rng.uniform(radius, 1 - radius, (tries, 2)):
        near = np.flatnonzero(np.linalg.norm(np.array(places or [[9, 9]]) - place, axis=1) < 2 * radius)
        copy = shape.moved(radius, 0.0, place)
        if not any(copy.overlaps(laid[i]) for i in near if laid):
            places.append(place)
            laid.append(copy)
    return len(laid), time.process_time() - start


def ratios() -> None:
    mesh = sb.Mesh(*meshes.torus(200, 100))
    field = sb.direction_field(mesh, 1, {})
    disks = len(sb.distribute(mesh, sb.Shape.disk(32), field=field, size=0.08, maximal=True))
    for name, shape in (("star", sb.Shape.star()), ("leaf", sb.Shape.leaf()), ("needle", sb.Shape.needle(6))):
        start = time.process_time()
        loose = sb.distribute(mesh, shape, field=field, size=0.08, maximal=True)
        packed = sb.distribute(mesh, shape, field=field, size=0.08, mode="packed", maximal=True)
        seconds = time.process_time() - start
        print(
            f"{name:<8} random {len(loose)}, packed {len(packed)}: {len(packed) / len(loose):.2f}; "
            f"random against disks {len(loose) / disks:.2f}; {seconds:.1f} s CPU for both"
        )


def stars_against_disks() -> None:
    """Pentagrams and disks of one circumradius on a flat square, each the mean of six certified random layings."""
    mesh, size, seeds = sb.Mesh(*meshes.grid(100, 100)), 0.03, range(6)
    x, y = mesh.vertices[mesh.triangles].mean(axis=1)[:, :2].T
    disks = np.mean([len(sb.distribute(mesh, sb.Shape.disk(48), size=size, maximal=True, seed=i)) for i in seeds])
    star = sb.Shape.star(5, 0.381966)
    for turn in (0.0, 1.0, 4.0, 8.0):
        angle = turn * np.sin(2 * np.pi * x) * np.cos(2 * np.pi * y)
        field = sb.DirectionField.from_vectors(mesh, np.stack([np.cos(angle), np.sin(angle), 0 * x], axis=1))
        stars = np.mean([len(sb.distribute(mesh, star, field=field, size=size, maximal=True, seed=i)) for i in seeds])
        most = turn * 2 * np.pi * size
        print(f"pentagrams against disks, field turning by up to {most:.2f} rad a radius: {stars / disks:.3f}")


def main(arguments: list[str]) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--blender", default=shutil.which("blender"))
    parser.add_argument("--size", type=float, default=0.07)
    options = parser.parse_args(arguments)
    mesh = sb.Mesh(*meshes.torus(632, 316))
    field = sb.direction_field(mesh, 1, {})
    classes = [sb.Shape.star(), sb.Shape.leaf(), sb.Shape.drop(), sb.Shape.crescent()]
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    cpu, wall = time.process_time(), time.perf_counter()
    result = sb.distribute(mesh, classes, field=field, size=options.size, maximal=True, threads=2)
    cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    memory = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) * 1024 / len(mesh.triangles)
    print(
        f"{len(mesh.triangles)} faces: {len(result)} copies, {cpu:.2f} s CPU, {wall:.2f} s; {memory:.0f} bytes a face"
    )
    print(result.certificate, result.rejections)
    if options.blender:
        found = blender_seconds(options.blender, mesh, 2 * options.size, len(result))
        print(f"Blender's Poisson node, points only (seconds, CPU): {found}")
    count, seconds = rejection(sb.Shape.star(), 0.03, 5_000)
    print(f"rejection in the plane, 5,000 tries: {count} stars, {seconds:.1f} s CPU")
    ratios()
    stars_against_disks()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the demo's model, a chameleon on its branch, with its painted density: run by Blender.

blender -b --factory-startup --python blend-samples/make_creature.py -- OUT.blend
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent / "creature"))

import implicit
import sculpt
import shape
import strokes

GRID = 0.0165  # about 125,000 triangles
PAINT = "Cell density"


def largest_part(vertices: np.ndarray, quads: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The part with the most vertices: without the bubbles that are shut in where a thigh meets the belly."""
    ends = np.concatenate([quads[:, [i, (i + 1) % 4]] for i in range(4)])  # each edge in both directions
    label = np.arange(len(vertices))
    previous = np.empty(0, int)
    while not np.array_equal(label, previous):
        previous = label.copy()
        np.minimum.at(label, ends[:, 0], label[ends[:, 1]])
        label = label[label]
    keep = label == np.argmax(np.bincount(label))
    number = np.cumsum(keep) - 1
    return vertices[keep], number[quads[keep[quads[:, 0]]]].astype(np.int32)


def is_closed(quads: np.ndarray, vertex_count: int) -> bool:
    """Tells whether every edge has two quads."""
    ends = np.concatenate([quads[:, [i, (i + 1) % 4]] for i in range(4)])
    key = np.sort(ends, axis=1) @ np.array([vertex_count, 1], np.int64)
    return bool(np.all(np.unique(key, return_counts=True)[1] == 2))


def new_object(
    name: str, vertices: np.ndarray, faces: np.ndarray, collection: bpy.types.Collection
) -> bpy.types.Object:
    """A smooth-shaded mesh object from arrays of vertices and quads."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices.tolist(), [], faces.tolist())
    mesh.polygons.foreach_set("use_smooth", np.ones(len(faces), bool))
    mesh.update()
    made = bpy.data.objects.new(name, mesh)
    collection.objects.link(made)
    return made


def make_body(collection: bpy.types.Collection) -> bpy.types.Object:
    """The chameleon itself, with the vertex group that an artist would paint."""
    origin, grid = implicit.sample_grid(shape.parts(), GRID)
    vertices, quads = implicit.surface_nets(origin, implicit.without_pinches(grid), GRID)
    vertices, quads = largest_part(vertices, quads)
    vertices = sculpt.smooth(vertices, quads, 4)
    normals = sculpt.vertex_normals(vertices, quads)
    vertices = vertices + sculpt.detail(vertices, normals)[:, None] * normals
    if not is_closed(quads, len(vertices)):
        raise SystemExit(
            "The chameleon came out with edges that do not join two faces: change GRID in make_creature.py."
        )
    body = new_object("Chameleon", vertices, quads, collection)
    group = body.vertex_groups.new(name=PAINT)
    levels = np.round(sculpt.paint(vertices) * 100).astype(int)
    for level in np.unique(levels):
        group.add(np.flatnonzero(levels == level).tolist(), float(level) / 100, "REPLACE")
    print(f"   {2 * len(quads):,} triangles, closed, in one piece")
    return body


def lathe(profile: np.ndarray, segments: int) -> tuple[np.ndarray, np.ndarray]:
    """A surface of revolution about z: `profile` has rows radius, height."""
    angle = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    rings = np.stack(
        [profile[:, :1] * np.cos(angle), profile[:, :1] * np.sin(angle), np.repeat(profile[:, 1:], segments, 1)],
        axis=-1,
    )
    i, j = np.meshgrid(np.arange(len(profile) - 1), np.arange(segments), indexing="ij")
    k = (j + 1) % segments
    quads = np.stack([i * segments + j, i * segments + k, (i + 1) * segments + k, (i + 1) * segments + j], axis=-1)
    return rings.reshape(-1, 3), quads.reshape(-1, 4)


def make_eyes(body: bpy.types.Object, collection: bpy.types.Collection) -> None:
    """Two eyeballs, parented to the body so that they follow it."""
    angle = np.linspace(0, np.pi, 25)
    ball = np.stack([0.050 * np.sin(angle) + 1e-5, 0.050 * np.cos(angle)], axis=1)
    for side, name in ((1, "Eye left"), (-1, "Eye right")):
        mirror = np.array([1, side, 1])
        vertices, quads = lathe(ball, 32)
        eye = new_object(name, vertices + (shape.EYE_CENTER + 0.108 * shape.EYE_AXIS) * mirror, quads, collection)
        eye.parent = body


def make_strokes(body: bpy.types.Object, collection: bpy.types.Collection) -> None:
    """Draws what an artist would draw to say which way scales lie: one curve object, parented to the body."""
    curve = bpy.data.curves.new("Strokes", "CURVE")
    curve.dimensions = "3D"
    for points in strokes.strokes():
        spline = curve.splines.new("POLY")
        spline.points.add(len(points) - 1)
        spline.points.foreach_set("co", np.column_stack([points, np.ones(len(points))]).astype(np.float32).ravel())
    item = bpy.data.objects.new("Strokes", curve)
    collection.objects.link(item)
    item.parent = body


def limb(knots: list[tuple[float, ...]], seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A bent piece of wood with bark through knots (x, y, z, radius), its first end cut flat."""
    line = implicit.catmull_rom(np.array(knots), 40 * len(knots))
    segments = 48
    tangent = np.gradient(line[:, :3], axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    side = np.cross(tangent, [0.0, 1.0, 0.05])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    up = np.cross(side, tangent)
    angle = np.linspace(0, 2 * np.pi, segments, endpoint=False)[None, :, None]
    rim = side[:, None] * np.cos(angle) + up[:, None] * np.sin(angle)
    along = np.linspace(0, 1.3 * len(knots), len(line))[:, None, None]
    circle = [np.cos(angle) + 0 * along, np.sin(angle) + 0 * along, 0.5 * along + 0 * angle]
    sample = np.concatenate(circle, axis=2).reshape(-1, 3)
    bark = 0.10 * sculpt.octaves(sample, 1.3, 2, seed) - 0.10 * np.abs(
        sculpt.octaves(sample * [4, 4, 1], 1.6, 2, seed + 7)
    )
    radius = line[:, None, 3:] * (1 + bark.reshape(len(line), segments, 1))
    radius[:2] *= np.array([0.0, 0.93])[:, None, None]
    line[0] = line[1]
    vertices = (line[:, None, :3] + radius * rim).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(len(line) - 1), np.arange(segments), indexing="ij")
    k = (j + 1) % segments
    quads = np.stack([i * segments + j, (i + 1) * segments + j, (i + 1) * segments + k, i * segments + k], axis=-1)
    return vertices, quads.reshape(-1, 4)


def make_branch(body: bpy.types.Object, collection: bpy.types.Collection) -> None:
    """The branch under the feet: it rises from the ground and forks."""
    top = shape.BRANCH_HEIGHT
    main_limb = [
        (-1.13, 0.0, top + 0.02, 0.098),
        (-0.86, 0.0, top, 0.112),
        (0.0, 0.0, top - 0.02, 0.120),
        (0.86, 0.0, top, 0.122),
        (1.22, 0.02, top - 0.09, 0.128),
        (1.46, 0.06, top - 0.33, 0.140),
        (1.56, 0.10, top - 0.62, 0.155),
        (1.60, 0.12, top - 0.92, 0.190),
    ]
    fork = [
        (0.06, 0.80, top - 0.92, 0.075),
        (0.10, 0.66, top - 0.60, 0.070),
        (0.22, 0.42, top - 0.30, 0.075),
        (0.42, 0.12, top - 0.06, 0.085),
        (0.50, 0.03, top - 0.02, 0.085),
    ]
    for name, knots, seed in (("Branch", main_limb, 31), ("Fork", fork, 53)):
        new_object(name, *limb(knots, seed), collection).parent = body


def main() -> None:
    """Makes the scene and saves it."""
    started = time.time()
    path = sys.argv[sys.argv.index("--") + 1]
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    collection = bpy.context.scene.collection
    body = make_body(collection)
    make_eyes(body, collection)
    make_branch(body, collection)
    make_strokes(body, collection)
    bpy.context.view_layer.objects.active = body
    body.select_set(True)
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=str(Path(path).resolve()), compress=True)
    print(f"   saved to {path} in {time.time() - started:.1f} s")


main()

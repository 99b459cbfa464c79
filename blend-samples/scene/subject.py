# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh that gets the cells: read from a file or found in a .blend, stood upright, fine enough, its paint found."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FINE = 30_000  # triangles below which cell borders show the mesh's own edges
NEWER = 34  # exit status that tells blend-samples/run to try a newer Blender
CURVATURE = "Cell density"


@dataclass
class Paint:
    """Holds where the density comes from: the operator's `density_source` and `density_name`."""

    source: str = "UNIFORM"
    name: str = ""


def open_subject(path: Path, up: str) -> bpy.types.Object:
    """The object to work on, alone in its scene but for its children. Raises SystemExit with a sentence."""
    if path.suffix.lower() == ".blend":
        return _from_blend(path)
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    vertices, triangles = _read_arrays(path)
    mesh = bpy.data.meshes.new(path.stem)
    mesh.from_pydata(vertices.tolist(), [], triangles.tolist())
    mesh.polygons.foreach_set("use_smooth", np.ones(len(triangles), bool))
    mesh.update()
    subject = bpy.data.objects.new(path.stem, mesh)
    bpy.context.scene.collection.objects.link(subject)
    if up == "y":
        subject.rotation_euler = (math.pi / 2, 0, 0)
    _activate(subject)
    return subject


def _read_arrays(path: Path) -> tuple[Array, NDArray[np.int32]]:
    """Vertices and triangles of a mesh file, repaired where the library would refuse them."""
    import saddleback as sb

    try:
        vertices, triangles = sb.read_arrays(path)
    except sb.Error as error:
        raise SystemExit(f"{error}.") from error
    try:
        sb.Mesh(vertices, triangles)
        return vertices, triangles
    except sb.MeshError as error:
        print(f"   The mesh needs repair: {error}", flush=True)
    mesh, report = sb.repair(vertices, triangles)
    changes = ", ".join(f"{kind.replace('_', ' ')} {number:,}" for kind, number in report.changes.items() if number)
    print(f"   Repaired: {changes}; {len(mesh.triangles):,} triangles are left", flush=True)
    return mesh.vertices, mesh.triangles


def _from_blend(path: Path) -> bpy.types.Object:
    # An older Blender may crash on a newer file, so the version is read first: "BLENDER", two letters, 405 for 4.5.
    version = path.open("rb").read(12)[9:]
    if version.isdigit() and divmod(int(version), 100) > bpy.app.version[:2]:
        print(f"   {path}: saved by Blender {int(version) // 100}.{int(version) % 100}.", flush=True)
        raise SystemExit(NEWER)
    try:
        bpy.ops.wm.open_mainfile(filepath=str(path.resolve()), load_ui=False)
    except RuntimeError as error:  # not a .blend, or of a Blender so new that this one cannot tell
        print(f"   {path}: Blender {bpy.app.version_string} cannot open it ({str(error).strip()}).", flush=True)
        raise SystemExit(NEWER) from error
    scene = bpy.context.scene
    active = bpy.context.view_layer.objects.active
    meshes = [item for item in scene.objects if item.type == "MESH" and len(item.data.polygons)]
    if not meshes:
        raise SystemExit(f"{path}: it holds no mesh object with faces.")
    subject = active if active in meshes else meshes[0]
    if active is not None and active.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    keep = {subject, *subject.children_recursive}
    for other in list(scene.objects):
        if other not in keep:
            bpy.data.objects.remove(other)
    if subject.data.users > 1:
        subject.data = subject.data.copy()
    subject.hide_viewport = subject.hide_render = False
    _activate(subject)
    return subject


def _activate(subject: bpy.types.Object) -> None:
    view_layer = bpy.context.view_layer
    view_layer.update()
    subject.hide_set(False)
    for item in bpy.context.scene.objects:
        item.select_set(item == subject)
    view_layer.objects.active = subject


def positions(subject: bpy.types.Object) -> Array:
    """Vertices (V, 3) in world space."""
    mesh = subject.data
    flat = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", flat)
    place = np.array(subject.matrix_world)
    return flat.reshape(-1, 3) @ place[:3, :3].T + place[:3, 3]


def triangles(subject: bpy.types.Object) -> NDArray[np.int32]:
    """Corners (F, 3) of the triangulated faces."""
    mesh = subject.data
    mesh.calc_loop_triangles()
    flat = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", flat)
    return flat.reshape(-1, 3)


def area(subject: bpy.types.Object) -> float:
    """The surface area in world units."""
    vertices, corners = positions(subject), triangles(subject)
    a, b, c = (vertices[corners[:, i]] for i in range(3))
    return float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


def refine(subject: bpy.types.Object) -> int:
    """Splits faces, without changing the shape, until there are enough; returns the number of triangles.

    The first round makes a quad of each corner of a face, every other round four quads of a quad.
    """
    rounds, count, quads = 0, len(triangles(subject)), len(subject.data.loops)
    while count < FINE and rounds < 7:
        rounds, count, quads = rounds + 1, 2 * quads, 4 * quads
    if rounds:
        modifier = subject.modifiers.new("Refine", "SUBSURF")
        modifier.subdivision_type = "SIMPLE"
        modifier.levels = modifier.render_levels = rounds
        while subject.modifiers[0] != modifier:
            bpy.ops.object.modifier_move_up(modifier=modifier.name)
        bpy.ops.object.modifier_apply(modifier=modifier.name)
    return count


def find_paint(subject: bpy.types.Object) -> Paint:
    """The density that somebody painted: a layer with "density" in its name, "saddleback_density" before others."""
    mesh = subject.data
    layers = [(attribute.name, "COLOR") for attribute in mesh.color_attributes]
    layers += [
        (attribute.name, "ATTRIBUTE") for attribute in mesh.attributes if attribute.data_type in ("FLOAT", "INT")
    ]
    layers += [(group.name, "VERTEX_GROUP") for group in subject.vertex_groups]
    painted = [layer for layer in layers if "density" in layer[0].lower()]
    if not painted:
        return Paint()
    name, source = min(painted, key=lambda layer: (layer[0] != "saddleback_density", layer[0]))
    return Paint(source, name)


def paint_curvature(subject: bpy.types.Object) -> Paint:
    """Paints how much the surface bends, smoothed, as a density from 0.12 to 1."""
    mesh, vertices, corners = subject.data, positions(subject), triangles(subject)
    count = len(vertices)
    face = np.cross(
        vertices[corners[:, 1]] - vertices[corners[:, 0]], vertices[corners[:, 2]] - vertices[corners[:, 0]]
    )
    normal = np.stack([np.bincount(corners.ravel(), np.repeat(face[:, i], 3), count) for i in range(3)], axis=1)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
    ends = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    ends = np.concatenate([ends, ends[:, ::-1]])
    degree = np.maximum(np.bincount(ends[:, 0], minlength=count), 1)
    reach = 0.04 * float(np.linalg.norm(np.ptp(vertices, axis=0)))
    length = np.maximum(np.linalg.norm(vertices[ends[:, 0]] - vertices[ends[:, 1]], axis=1), 1e-30)
    turn = np.linalg.norm(normal[ends[:, 0]] - normal[ends[:, 1]], axis=1) / length
    bend = np.bincount(ends[:, 0], turn, count) / degree
    rounds = int(np.clip((reach / np.median(length)) ** 2, 5, 200))
    for _ in range(rounds):
        bend = 0.5 * bend + 0.5 * np.bincount(ends[:, 0], bend[ends[:, 1]], count) / degree
    low, high = np.percentile(bend, [10, 95])
    if not high > 1.05 * low:  # as good as even: a sphere, a cube's faces
        return Paint()
    density = 0.12 + 0.88 * np.clip((bend - low) / (high - low), 0, 1)
    attribute = mesh.attributes.new(CURVATURE, "FLOAT", "POINT")
    attribute.data.foreach_set("value", density.astype(np.float32))
    return Paint("ATTRIBUTE", attribute.name)

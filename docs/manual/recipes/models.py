# SPDX-License-Identifier: GPL-3.0-or-later
"""The models of the recipes, all made by code."""

from __future__ import annotations

import bpy
import numpy as np
from implicit import Tube, catmull_rom, sample_grid, surface_nets, tube, without_pinches
from plane_scenes import add_mesh, lathe

Array = np.ndarray


def smooth(item: bpy.types.Object) -> bpy.types.Object:
    """Shades it smooth."""
    item.data.polygons.foreach_set("use_smooth", np.ones(len(item.data.polygons), bool))
    return item


def solid(name: str, parts: list[Tube], cell: float, turn: Array | None = None) -> bpy.types.Object:
    """The blended parts as a closed mesh, its axes turned by a matrix."""
    origin, grid = sample_grid(parts, cell)
    vertices, quads = surface_nets(origin, without_pinches(grid), cell)
    item = smooth(add_mesh(name, vertices if turn is None else vertices @ turn.T, quads.tolist()))
    item.modifiers.new("Smooth", "SMOOTH").iterations = 4  # surface nets are a little stepped
    bpy.ops.object.modifier_apply(modifier="Smooth")
    return item


def hull() -> bpy.types.Object:
    """The hull of a ship with wings and engines. In `parts` y is up, since tubes are flat along y."""
    body = [(-1.25, 0, 0, 0.16, 0.13), (-0.8, 0.02, 0, 0.28, 0.2), (0, 0.03, 0, 0.34, 0.22), (0.7, 0, 0, 0.27, 0.17),
            (1.3, -0.05, 0, 0.12, 0.09), (1.5, -0.07, 0, 0.05, 0.05)]  # fmt: skip
    cabin = [(-0.45, 0.2, 0, 0.16, 0.1), (0.05, 0.22, 0, 0.17, 0.13), (0.45, 0.15, 0, 0.1, 0.08)]
    parts = [tube(body, 0.05, 40), tube(cabin, 0.06, 20)]
    for side in (-1, 1):
        wing = [(-0.35, 0, 0.2 * side, 0.42, 0.085), (-0.6, -0.03, 0.7 * side, 0.28, 0.06),
                (-0.85, -0.06, 1.15 * side, 0.15, 0.045)]  # fmt: skip
        z = 0.5 * side
        engine = [(-1.15, 0, z, 0.12, 0.13), (-0.6, 0, z, 0.14, 0.14), (-0.2, 0, z, 0.08, 0.08)]
        parts += [tube(wing, 0.06, 20), tube(engine, 0.05, 20)]
    return solid("Hull", parts, 0.034, np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]))


def fish() -> bpy.types.Object:
    """A fish with a tail fin."""
    body = [(1.1, 0, 0.0, 0.06, 0.05), (0.95, 0, 0.0, 0.17, 0.12), (0.5, 0, 0.02, 0.36, 0.21),
            (0.0, 0, 0.03, 0.42, 0.22), (-0.5, 0, 0.02, 0.29, 0.15), (-0.95, 0, 0, 0.12, 0.07)]  # fmt: skip
    fin = [(0.2, 0, 0.4, 0.08, 0.05), (-0.1, 0, 0.5, 0.08, 0.04), (-0.35, 0, 0.45, 0.04, 0.03)]
    parts = [tube(body, 0.05, 40), tube(fin, 0.06, 12)]
    for side in (-1, 1):
        half = [(-0.9, 0, 0, 0.09, 0.05), (-1.15, 0, 0.2 * side, 0.12, 0.04), (-1.35, 0, 0.42 * side, 0.05, 0.03)]
        parts += [tube(half, 0.05, 12)]
    return solid("Fish", parts, 0.03)


def fish_strokes() -> list[Array]:
    """Where an artist would draw on the fish, from the mouth to the tail."""
    lines = [[(0.95, 0.12, z), (0.5, 0.24, 1.9 * z), (0.0, 0.24, 2.2 * z), (-0.5, 0.17, 1.4 * z), (-1.0, 0.08, 0.3 * z)]
             for z in (-0.11, 0.0, 0.11)]  # fmt: skip
    tails = [[(-0.95, 0.08, 0.04 * s), (-1.15, 0.05, 0.2 * s), (-1.33, 0.04, 0.4 * s)] for s in (-1, 1)]
    return [np.array(line) * (1, side, 1) for line in lines + tails for side in (-1, 1)]


def hand(cell: float = 0.03) -> bpy.types.Object:
    """A hand whose fingers lie close together."""
    palm = [(0, 0, -1.0, 0.23, 0.17), (0, 0, -0.6, 0.25, 0.16), (0, 0, -0.2, 0.4, 0.15), (0, 0, 0.15, 0.4, 0.15)]
    thumb = [(-0.28, -0.04, -0.35, 0.15), (-0.5, -0.1, 0.0, 0.13), (-0.56, -0.14, 0.35, 0.1)]
    parts = [tube(palm, 0.08, 24)]
    for i, tall in enumerate((0.62, 0.8, 0.76, 0.52)):
        x = -0.36 + 0.24 * i
        finger = [(x, 0, 0.25, 0.115), (1.06 * x, -0.02, 0.45 + 0.5 * tall, 0.11), (1.1 * x, -0.02, 0.35 + tall, 0.095)]
        parts += [tube(finger, 0.04, 16)]
    parts += [tube(thumb, 0.06, 16)]
    return solid("Hand", parts, cell)


def paint_fingers(item: bpy.types.Object) -> None:
    """What a brush would do: full weight at the tips, less and less towards the palm."""
    group = item.vertex_groups["saddleback_density"]
    for vertex in item.data.vertices:
        group.add([vertex.index], float(np.clip((vertex.co.z - 0.35) / 0.35, 0, 1)), "REPLACE")


def turned(name: str, knots: list[tuple[float, float]], samples: int, around: int) -> bpy.types.Object:
    """A smooth surface of revolution through radii and heights."""
    vertices, faces, _ = lathe(catmull_rom(np.array(knots, float), samples), around)
    return smooth(add_mesh(name, vertices, faces))


def vase() -> bpy.types.Object:
    """A vase with a lip."""
    knots = [
        (0.02, 0),
        (0.3, 0),
        (0.42, 0.12),
        (0.56, 0.5),
        (0.52, 0.95),
        (0.3, 1.3),
        (0.22, 1.5),
        (0.3, 1.72),
        (0.36, 1.78),
    ]
    return turned("Vase", knots, 70, 110)


def lamp() -> bpy.types.Object:
    """A lamp shade of 14 cm, open below and above."""
    knots = [(0.036, 0), (0.06, 0.03), (0.072, 0.065), (0.06, 0.1), (0.036, 0.125), (0.03, 0.14)]
    return turned("Lamp", knots, 70, 120)


def shield() -> bpy.types.Object:
    """A round shield that faces the viewer; its rim and its boss have a material of their own."""
    knots = [(1.0, 0.0), (1.0, 0.08), (0.95, 0.15), (0.84, 0.16), (0.8, 0.12), (0.5, 0.22), (0.24, 0.25), (0.2, 0.3),
             (0.12, 0.4), (0.01, 0.42)]  # fmt: skip
    item = turned("Shield", knots, 120, 160)
    item.rotation_euler.x = np.pi / 2
    for name, color in (("Plate", (0.05, 0.07, 0.1, 1)), ("Rim", (0.16, 0.05, 0.02, 1))):
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        material.diffuse_color = color
        material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = color
        item.data.materials.append(material)
    for face in item.data.polygons:
        face.material_index = int(np.hypot(*face.center[:2]) > 0.81 or np.hypot(*face.center[:2]) < 0.235)
    return item


def strap(around: int = 48, along: int = 150) -> bpy.types.Object:
    """A padded strap along x, lying flat; its own y is up, since the Bend of Simple Deform turns about z."""
    angle = -2 * np.pi * np.arange(around) / around
    power = np.sign(np.cos(angle)) * np.abs(np.cos(angle)) ** 0.4, np.sign(np.sin(angle)) * np.abs(np.sin(angle)) ** 0.6
    section = np.column_stack([0.1 * power[1], 0.34 * power[0]])
    x = np.linspace(-2.2, 2.2, along)
    width = 1 - np.clip((np.abs(x) - 2.0) / 0.2, 0, 1) ** 2 * 0.5
    rows = [
        np.column_stack([np.full(around, at), section * (0.5 + wide / 2, wide)])
        for at, wide in zip(x, width, strict=True)
    ]
    faces = [(j * around + i, j * around + (i + 1) % around, (j + 1) * around + (i + 1) % around, (j + 1) * around + i)
             for j in range(along - 1) for i in range(around)]  # fmt: skip
    caps = [tuple(range(around))[::-1], tuple(range((along - 1) * around, along * around))]
    item = smooth(add_mesh("Strap", np.concatenate(rows), [*faces, *caps]))
    item.rotation_euler.x = np.pi / 2
    return item


def canvas() -> bpy.types.Object:
    """An upright plane with the proportions of the portrait."""
    bpy.ops.mesh.primitive_plane_add(size=1.0, rotation=(np.pi / 2, 0, 0))
    item = bpy.context.active_object
    item.scale = 1.6, 2.0, 1.0
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
    return item


def portrait(columns: int = 400, rows: int = 500) -> bpy.types.Image:
    """A face in the light of a window, as an image of tones."""
    x, y = np.meshgrid(np.linspace(-0.8, 0.8, columns), np.linspace(-1, 1, rows))

    def blob(cx: float, cy: float, rx: float, ry: float, soft: float = 0.25) -> Array:
        inside = 1 - np.hypot((x - cx) / rx, (y - cy) / ry)
        return np.clip(inside / soft, 0, 1)

    def lay(tone: Array, shade: Array | float, mask: Array) -> Array:
        return tone * (1 - mask) + shade * mask

    tone = 0.97 - 0.22 * (x + 0.8) / 1.6
    tone = lay(tone, 0.12 + 0.1 * np.sin(30 * x) ** 2, blob(0, 0.28, 0.56, 0.62, 0.06))  # hair
    tone = lay(tone, 0.14, blob(0, -0.35, 0.56, 0.5, 0.3) * (np.abs(x) > 0.25))
    tone = lay(tone, 0.42 - 0.3 * x, blob(0, -1.15, 0.85, 0.52, 0.05))  # shoulders
    tone = lay(tone, 0.5 - 0.5 * x - 0.2 * (y > -0.55), blob(0, -0.55, 0.19, 0.35, 0.1))  # neck
    u, v = x / 0.42, (y - 0.05) / 0.58
    bulge = np.sqrt(np.clip(1 - u**2 - v**2, 0, 1))
    lit = np.clip(-0.62 * u + 0.25 * v + 0.74 * bulge, 0, 1)
    tone = lay(tone, 0.2 + 0.8 * lit, np.clip((1 - np.hypot(u, v)) / 0.05, 0, 1))
    tone = lay(tone, 0.12 + 0.1 * np.sin(24 * x + 5 * y) ** 2, blob(0.1, 0.56, 0.46, 0.2, 0.2))  # fringe
    for side in (-1, 1):
        tone = lay(tone, 0.1, 0.8 * blob(0.17 * side, 0.235, 0.125, 0.035, 0.5))  # brow
        tone = lay(tone, 0.3, 0.6 * blob(0.17 * side, 0.13, 0.12, 0.09, 0.8))
        tone = lay(tone, 0.95, blob(0.17 * side, 0.12, 0.085, 0.042, 0.2))
        tone = lay(tone, 0.04, blob(0.18 * side - 0.015, 0.122, 0.042, 0.044, 0.2))
        tone = lay(tone, 0.05, blob(0.17 * side, 0.16, 0.1, 0.018, 0.4))  # lashes
    tone = lay(tone, 0.25, 0.7 * blob(0.065, -0.03, 0.05, 0.15, 0.9))  # the nose's shadow
    tone = lay(tone, 0.2, 0.8 * blob(0.02, -0.14, 0.075, 0.03, 0.7))
    tone = lay(tone, 0.22, blob(0, -0.285, 0.13, 0.03, 0.4))  # mouth
    tone = lay(tone, 0.35, 0.9 * blob(0, -0.325, 0.1, 0.035, 0.5))
    tone = lay(tone, 0.25, 0.5 * blob(0.02, -0.41, 0.1, 0.03, 0.9))
    image = bpy.data.images.new("Portrait", columns, rows)
    pixels = np.ones((rows, columns, 4), np.float32)
    pixels[:, :, :3] = np.clip(tone, 0, 1)[:, :, None]
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    return image

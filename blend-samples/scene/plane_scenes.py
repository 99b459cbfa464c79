# SPDX-License-Identifier: GPL-3.0-or-later
"""Shows what diagrams of the plane are good for: a tiled plate, stippling, a vase, a shell, and the sweep that finds
them.
"""

from __future__ import annotations

import math

import bpy
import looks
import numpy as np
import palette
import studio

ROLE = "saddleback_role"  # on the add-on's output objects
Items = list[bpy.types.Object]


def add_mesh(name: str, vertices: np.ndarray, faces: list[tuple[int, ...]]) -> bpy.types.Object:
    """A mesh object, active and alone selected."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices.tolist(), [], faces)
    item = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(item)
    for other in bpy.context.scene.objects:
        other.select_set(False)
    item.select_set(True)
    bpy.context.view_layer.objects.active = item
    bpy.context.view_layer.update()
    return item


def output(source: bpy.types.Object, role: str) -> bpy.types.Object:
    """Returns what the add-on made for an object."""
    return next(child for child in source.children if child.get(ROLE) == role)


def color(code: str) -> tuple[float, float, float]:
    """A color by its code, linear."""
    red, green, blue = palette.linear([code])[0]
    return float(red), float(green), float(blue)


def ring(radius: float, corners: int, wobble: float = 0.0) -> np.ndarray:
    """(n, 2) a circle or, with `wobble`, a flower."""
    angle = 2 * np.pi * np.arange(corners) / corners
    wide = radius * (1 + wobble * np.cos(5 * angle))
    return np.column_stack([wide * np.cos(angle), wide * np.sin(angle)])


def upright(flat: np.ndarray) -> np.ndarray:
    """(n, 2) places -> (n, 3) on a wall that faces the camera."""
    return np.column_stack([flat[:, 0], np.zeros(len(flat)), flat[:, 1]])


def plate() -> bpy.types.Object:
    """A flower with a round hole, as a strip of quads."""
    corners = 240
    outer, inner = ring(1.0, corners, 0.12), ring(0.32, corners)
    faces = [(i, (i + 1) % corners, corners + (i + 1) % corners, corners + i) for i in range(corners)]
    return add_mesh("Plate", upright(np.concatenate([outer, inner])), faces)


def tiles(iterations: int = 12) -> Items:
    """Cells of a plate around its hole, raised and parted."""
    item = plate()
    bpy.ops.saddleback.voronoi_2d(
        count=170, seed=4, iterations=iterations, make_edges=False, gap=0.022, inset=0.016, thickness=0.05
    )
    output(item, "voronoi cells").data.materials[0].user_remap(looks.enamel())
    item.data.materials.append(looks.grout())
    return [item, output(item, "voronoi cells")]


def panel(width: float = 2.2, height: float = 1.5) -> bpy.types.Object:
    """An upright rectangle."""
    flat = np.array([(0, 0), (width, 0), (width, height), (0, height)]) - (width / 2, height / 2)
    return add_mesh("Panel", upright(flat), [(0, 1, 2, 3)])


def still_life(columns: int = 660, rows: int = 450) -> bpy.types.Image:
    """Two balls on a table in the light of a lamp, as an image of tones."""
    x, y = np.meshgrid(np.linspace(-1.1, 1.1, columns), np.linspace(-0.75, 0.75, rows))
    light = np.array([-0.55, 0.62, 0.56])
    light /= np.linalg.norm(light)
    tone = np.where(y < -0.3, 0.62 + 0.3 * (-0.3 - y) / 0.45, 0.93 - 0.25 * (y + 0.3))
    for cx, cy, r in ((0.42, -0.28, 0.2), (-0.18, 0.0, 0.44)):
        shadow = ((x - cx - 0.75 * r) / (1.5 * r)) ** 2 + ((y - cy + 0.98 * r) / (0.25 * r)) ** 2
        tone *= 1 - 0.72 * np.clip(1.25 - shadow, 0, 1)
    for cx, cy, r in ((0.42, -0.28, 0.2), (-0.18, 0.0, 0.44)):
        u, v = (x - cx) / r, (y - cy) / r
        inside = u * u + v * v < 1
        w = np.sqrt(np.clip(1 - u * u - v * v, 0, 1))
        lit = np.clip(u * light[0] + v * light[1] + w * light[2], 0, 1)
        ball = 0.03 + 0.85 * lit**1.2 + 0.12 * np.clip(-v, 0, 1) * (1 - w)
        tone = np.where(inside, ball, tone)
    image = bpy.data.images.new("Still Life", columns, rows, float_buffer=True)
    pixels = np.ones((rows, columns, 4), np.float32)
    pixels[:, :, :3] = np.clip(tone, 0, 1)[:, :, None]
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    return image


def inked(item: bpy.types.Object) -> bpy.types.Object:
    """Gives the panel paper, and its dots ink; returns those."""
    centers = output(item, "voronoi centers")
    ink = studio.principled("Ink", color("#15171d"), Roughness=0.8, Specular=0.1)
    centers.data.materials[0].user_remap(ink)
    item.data.materials.append(studio.principled("Paper", color("#f4efe4"), Roughness=0.9, Specular=0.1))
    return centers


def stipples(count: int = 6000) -> Items:
    """Dots of one size whose density is an image's darkness."""
    image, item = still_life(), panel()
    bpy.ops.saddleback.voronoi_2d(
        sites_source="IMAGE", image_name=image.name, count=count, seed=1, iterations=30, make_edges=False,
        make_cells=False, make_centers=True, instance_dots=True, instance_size="EQUAL",
    )  # fmt: skip
    return [item, inked(item)]


def lathe(profile: np.ndarray, around: int) -> tuple[np.ndarray, list[tuple[int, ...]], np.ndarray]:
    """A surface of revolution from (n, 2) radii and heights, and the UV places of its corners, cut open at the back."""
    angle = 2 * np.pi * (np.arange(around) + 0.25 * around) / around
    turned = [np.column_stack([r * np.cos(angle), r * np.sin(angle), np.full(around, z)]) for r, z in profile]
    steps = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(profile, axis=0), axis=1))])
    v = steps / steps[-1]
    faces, places = [], []
    for j in range(len(profile) - 1):
        for i in range(around):
            k = (i + 1) % around
            faces.append((j * around + i, j * around + k, (j + 1) * around + k, (j + 1) * around + i))
            a, b = i / around, (i + 1) / around
            places += [(a, v[j]), (b, v[j]), (b, v[j + 1]), (a, v[j + 1])]
    return np.concatenate(turned), faces, np.array(places)


def vase() -> Items:
    """Cells on a vase, through its UV map."""
    t = np.linspace(0, 1, 90)
    radius = 0.34 + 0.22 * np.sin(2.6 * t + 0.35) ** 2 - 0.17 * np.exp(-(((t - 0.84) / 0.12) ** 2)) + 0.10 * t**6
    vertices, faces, places = lathe(np.column_stack([radius, 1.7 * t]), 180)
    item = add_mesh("Vase", vertices, faces)
    # As wide as the vase is around in the mean: cells are not stretched.
    places *= (2 * math.pi * float(radius.mean()) / 1.8, 1.0)
    item.data.uv_layers.new(name="UVMap").data.foreach_set("uv", places.astype(np.float32).ravel())
    bpy.ops.saddleback.voronoi_2d(
        space="UV", count=260, seed=3, iterations=15, make_edges=False, gap=0.016, inset=0.014, thickness=0.022
    )
    output(item, "voronoi cells").data.materials[0].user_remap(looks.enamel())
    item.data.materials.append(looks.grout())
    for polygon in item.data.polygons:
        polygon.use_smooth = True
    return [item, output(item, "voronoi cells")]


def wavy_shell() -> bpy.types.Object:
    """A disk without a UV map."""
    corners, rings = 160, 60
    flat = [np.zeros((1, 2))] + [ring(r, corners) for r in np.linspace(0.02, 1, rings)]
    places = np.concatenate(flat)
    x, y = places.T
    radius, angle = np.hypot(x, y), np.arctan2(y, x)
    height = 0.75 * np.sqrt(np.clip(1.02 - radius**2, 0, None)) + 0.10 * radius**2 * np.cos(6 * angle)
    vertices = np.column_stack([x, y, height])
    faces: list[tuple[int, ...]] = [(0, 1 + i, 1 + (i + 1) % corners) for i in range(corners)]
    for j in range(rings - 1):
        a, b = 1 + j * corners, 1 + (j + 1) * corners
        faces += [(a + i, b + i, b + (i + 1) % corners, a + (i + 1) % corners) for i in range(corners)]
    return add_mesh("Shell", vertices, faces)


def shell() -> Items:
    """Lines on a wavy shell."""
    item = wavy_shell()
    bpy.ops.saddleback.voronoi_2d(space="DISK", count=220, seed=2, iterations=40, make_cells=False, edge_radius=0.009)
    output(item, "voronoi edges").data.materials[0].user_remap(looks.gold())
    item.data.materials.append(studio.principled("Glaze", color("#1f5a63"), Roughness=0.25, Clearcoat=0.4))
    for polygon in item.data.polygons:
        polygon.use_smooth = True
    return [item, output(item, "voronoi edges")]


def bubbles() -> Items:
    """Sites of three weights on a wavy shell: the heaviest have the largest cells, all are raised."""
    item = wavy_shell()
    chosen = np.random.default_rng(6).permutation(len(item.data.vertices))[:130]
    weights = np.zeros(len(item.data.vertices), np.float32)
    weights[chosen] = np.repeat([0.24, 0.12, 0.0], [9, 25, 96])
    item.data.attributes.new("size", "FLOAT", "POINT").data.foreach_set("value", weights)
    is_site = np.zeros(len(weights), bool)
    is_site[chosen] = True
    item.data.vertices.foreach_set("select", is_site)
    bpy.ops.saddleback.voronoi_2d(
        space="DISK", sites_source="SELECTED", weights_name="size", iterations=6, make_edges=False, make_cells=True,
        gap=0.012, thickness=0.035, inset=0.015,
    )  # fmt: skip
    return [item, output(item, "voronoi cells")]


def sweep(sites: int = 60) -> Items:
    """A circle that grows over a panel, with the beach curve and the edges that it leaves behind."""
    item = panel(2.0, 2.0)
    bpy.ops.saddleback.voronoi_2d(
        count=sites, seed=9, iterations=2, make_edges=False, make_cells=False, make_centers=True, edge_radius=0.009,
        animate=True, frame_start=1, frame_end=120, instance_dots=True, instance_size="EQUAL", instance_scale=0.11,
    )  # fmt: skip
    inked(item)
    line = studio.principled("Beach", color("#d8452f"), Roughness=0.5)
    output(item, "beach curve").data.materials[0].user_remap(line)
    return [item]

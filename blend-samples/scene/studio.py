# SPDX-License-Identifier: GPL-3.0-or-later
"""A photographer's corner: a seamless backdrop, three soft lights, a camera that finds its own distance."""

from __future__ import annotations

import math

import bpy
import numpy as np
from mathutils import Vector

VIEW = Vector((0.50, -1.0, 0.27)).normalized()  # from the subject to the camera


def principled(name: str, color: tuple[float, float, float], **inputs: float) -> bpy.types.Material:
    """A material of one principled shader; `inputs` are its sockets, an underscore for a space."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.diffuse_color = (*color, 1.0)
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    renamed = {"Clearcoat": "Coat Weight", "Clearcoat Roughness": "Coat Roughness", "Specular": "Specular IOR Level"}
    for key, value in inputs.items():
        socket = key.replace("_", " ")
        if socket not in shader.inputs:
            socket = renamed[socket]
        shader.inputs[socket].default_value = value
    return material


def backdrop(low: Vector, high: Vector, size: float) -> bpy.types.Object:
    """A floor that bends up into a wall behind the subject."""
    floor, back, bend = low.z, (low.y + high.y) / 2 + 1.6 * size, 0.9 * size
    near = low.y - 12 * size
    profile = [(near, floor), (back - bend, floor)]
    for i in range(1, 25):
        a = i / 24 * math.pi / 2
        profile.append((back - bend + bend * math.sin(a), floor + bend * (1 - math.cos(a))))
    profile.append((back, floor + 9 * size))
    center = (low.x + high.x) / 2
    vertices = [(center + s * 14 * size, y, z) for y, z in profile for s in (-1, 1)]
    faces = [(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(len(profile) - 1)]
    mesh = bpy.data.meshes.new("Backdrop")
    mesh.from_pydata(vertices, [], faces)
    mesh.polygons.foreach_set("use_smooth", [True] * len(faces))
    mesh.materials.append(principled("Backdrop", (0.50, 0.475, 0.44), Roughness=0.55, Specular=0.25))
    return bpy.data.objects.new("Backdrop", mesh)


def area_light(
    name: str, where: Vector, target: Vector, size: float, power: float, color: tuple[float, ...]
) -> bpy.types.Object:
    """A square area light at `where` that looks at `target`."""
    data = bpy.data.lights.new(name, "AREA")
    data.size, data.energy, data.color = size, power, color
    light = bpy.data.objects.new(name, data)
    light.location = where
    light.rotation_euler = (where - target).to_track_quat("Z", "Y").to_euler()
    return light


def frame(camera: bpy.types.Object, points: np.ndarray, aspect: float, margin: float) -> None:
    """Puts the camera in the direction VIEW, as near as all points (n, 3) stay inside the margins of the picture."""
    rotation = VIEW.to_track_quat("Z", "Y")
    camera.rotation_euler = rotation.to_euler()
    local = points @ np.array(rotation.to_matrix())  # columns: right, up, towards the camera
    half = np.array([camera.data.sensor_width / 2 / camera.data.lens] * 2) / [1, aspect] * margin
    # A point (u, v, w) is inside for a camera at (x, y, z) if |u - x| <= half_x (z - w), likewise v: linear bounds.
    place = np.zeros(3)
    for axis in (0, 1):
        upper = np.max(local[:, axis] + half[axis] * local[:, 2])
        lower = np.min(local[:, axis] - half[axis] * local[:, 2])
        place[axis] = (upper + lower) / 2
        place[2] = max(place[2] if axis else -np.inf, (upper - lower) / 2 / half[axis])
    camera.location = rotation.to_matrix() @ Vector(place)
    camera.data.clip_end = 1000 * max(1.0, float(np.ptp(points)))
    camera.data.clip_start = camera.data.clip_end * 1e-6


def add_to(scene: bpy.types.Scene, points: np.ndarray, aspect: float) -> None:
    """Backdrop, lights and camera for a subject with these points (n, 3) in world space."""
    stage = bpy.data.collections.new("Studio")
    scene.collection.children.link(stage)
    low, high = Vector(points.min(axis=0)), Vector(points.max(axis=0))
    center, size = (low + high) / 2, (high - low).length / 2
    stage.objects.link(backdrop(low, high, size))
    lights = (
        ("Key", (-0.9, -1.7, 2.3), 1.3, 150, (1.0, 0.94, 0.86)),
        ("Fill", (2.4, -1.6, 0.9), 2.4, 34, (0.88, 0.94, 1.0)),
        ("Rim", (0.7, 1.15, 2.0), 1.1, 150, (1.0, 0.97, 0.92)),
    )
    for name, where, width, power, color in lights:
        stage.objects.link(
            area_light(name, center + size * Vector(where), center, width * size, power * size**2, color)
        )
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.lens = 75
    frame(camera, points, aspect, 0.90)
    stage.objects.link(camera)
    scene.camera = camera
    world = bpy.data.worlds.new("Studio")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.80, 0.87, 1.0, 1)
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.22
    scene.world = world


def use_cycles(scene: bpy.types.Scene, width: int, height: int, samples: int) -> bool:
    """Render settings for a CPU; returns whether this build of Blender can denoise."""
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100
    for name in dir(scene.render):  # no names of folders, files and hosts in the picture
        if name.startswith("use_stamp"):
            setattr(scene.render, name, False)
    scene.view_settings.view_transform = "Filmic"
    scene.view_settings.look = "High Contrast"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = samples
    cycles.use_adaptive_sampling = True
    cycles.adaptive_threshold = 0.04
    cycles.max_bounces, cycles.diffuse_bounces, cycles.glossy_bounces = 3, 2, 2
    cycles.transmission_bounces = cycles.transparent_max_bounces = 0
    cycles.caustics_reflective = cycles.caustics_refractive = False
    cycles.sample_clamp_indirect = 2.0
    cycles.blur_glossy = 0.5
    import _cycles

    cycles.use_denoising = bool(_cycles.with_openimagedenoise)
    return cycles.use_denoising

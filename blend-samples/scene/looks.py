# SPDX-License-Identifier: GPL-3.0-or-later
"""Enamel for the cells, gold for the lines and studs, and a color for every cell."""

from __future__ import annotations

import bpy
import numpy as np
import palette
from studio import principled

COLOR = "saddleback_color"  # the add-on's own color layer of its cells, written over


def enamel() -> bpy.types.Material:
    """Glazed color, read from the cells."""
    material = principled(
        "Enamel", (0.1, 0.5, 0.4), Roughness=0.32, Clearcoat=0.5, Clearcoat_Roughness=0.12, Specular=0.4
    )
    tree = material.node_tree
    color = tree.nodes.new("ShaderNodeAttribute")
    color.attribute_name = COLOR
    tree.links.new(color.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    return material


def gold() -> bpy.types.Material:
    """The metal of lines and studs."""
    return principled("Gold", (1.0, 0.62, 0.24), Metallic=1.0, Roughness=0.28)


def grout() -> bpy.types.Material:
    """Returns what shows between the cells."""
    return principled("Grout", (0.10, 0.055, 0.02), Roughness=0.6)


def horn() -> bpy.types.Material:
    """Polished scales, each of its own color."""
    material = principled("Horn", (0.4, 0.2, 0.1), Roughness=0.28, Clearcoat=0.6, Clearcoat_Roughness=0.1, Specular=0.5)
    tree = material.node_tree
    color = tree.nodes.new("ShaderNodeAttribute")
    color.attribute_name = COLOR
    tree.links.new(color.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    return material


def skin() -> bpy.types.Material:
    """Returns what shows between scales."""
    return principled("Skin", (0.016, 0.011, 0.012), Roughness=0.7, Specular=0.2)


def clay() -> bpy.types.Material:
    """A plain body that lines stand out on."""
    return principled("Clay", (0.62, 0.50, 0.40), Roughness=0.6)


def red_ink() -> bpy.types.Material:
    """Strokes that somebody drew."""
    return principled("Ink", (0.80, 0.08, 0.03), Roughness=0.4)


def dress_child(child: bpy.types.Object) -> None:
    """Materials for the parts of our own model that came without."""
    if child.type != "MESH" or len(child.data.materials):
        return
    if child.name.startswith("Eye"):
        child.data.materials.append(principled("Eye", (0.004, 0.004, 0.006), Roughness=0.05, Clearcoat=1.0))
    else:
        child.data.materials.append(wood())


def wood() -> bpy.types.Material:
    """Dark wood, a little uneven."""
    material = principled("Wood", (0.13, 0.065, 0.033), Roughness=0.6, Specular=0.3)
    tree = material.node_tree
    place = tree.nodes.new("ShaderNodeTexCoord")
    noise = tree.nodes.new("ShaderNodeTexNoise")
    noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = 14.0, 6.0
    ramp = tree.nodes.new("ShaderNodeValToRGB")
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[0].position = (0.095, 0.046, 0.023, 1), 0.30
    ramp.color_ramp.elements[1].color, ramp.color_ramp.elements[1].position = (0.175, 0.092, 0.048, 1), 0.72
    tree.links.new(place.outputs["Object"], noise.inputs["Vector"])
    tree.links.new(noise.outputs["Fac"], ramp.inputs["Fac"])
    tree.links.new(ramp.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    return material


def make_stud(material: bpy.types.Material) -> bpy.types.Object:
    """A small dome of radius 1 that stands on z = 0; hidden, since only its instances are to be seen."""
    angle = np.linspace(0, np.pi / 2, 7)
    turn = np.linspace(0, 2 * np.pi, 17)[:-1]
    radius, height = np.cos(angle[:-1])[:, None], np.sin(angle[:-1])[:, None]
    rings = np.stack([radius * np.cos(turn), radius * np.sin(turn), height + 0 * turn], axis=-1).reshape(-1, 3)
    vertices = np.vstack([rings, [[0, 0, 1.0]]])
    i, j = np.meshgrid(np.arange(5), np.arange(16), indexing="ij")
    k = (j + 1) % 16
    quads = np.stack([16 * i + j, 16 * i + k, 16 * i + 16 + k, 16 * i + 16 + j], axis=-1).reshape(-1, 4).tolist()
    cap = [[80 + j, 80 + (j + 1) % 16, 96] for j in range(16)]
    mesh = bpy.data.meshes.new("Stud")
    mesh.from_pydata(vertices.tolist(), [], quads + cap)
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    mesh.materials.append(material)
    stud = bpy.data.objects.new("Stud", mesh)
    bpy.context.scene.collection.objects.link(stud)
    stud.hide_render = stud.hide_viewport = True
    return stud


def read(mesh: bpy.types.Mesh, name: str, domain: str, width: int) -> np.ndarray:
    """A named attribute as an array: integers, numbers (width 1) or vectors (width 3)."""
    attribute = mesh.attributes[name]
    if attribute.domain != domain:
        raise SystemExit(f"{mesh.name}: attribute {name} is on {attribute.domain}, not {domain}.")
    integer = attribute.data_type == "INT"
    values = np.empty(width * len(attribute.data), np.int32 if integer else np.float32)
    attribute.data.foreach_get("vector" if width == 3 else "value", values)
    return values.reshape(-1, width) if width > 1 else values


def color_cells(
    cells: bpy.types.Object,
    face_cell: np.ndarray,
    centers: np.ndarray,
    normals: np.ndarray,
    areas: np.ndarray,
    points: np.ndarray,
) -> None:
    """Gives every face its cell's color; centers and normals (n, 3), points (m, 3) of the subject, in world space."""
    colors = palette.cell_colors(centers, normals, areas, points.min(axis=0), points.max(axis=0))
    rgba = np.concatenate([colors, np.ones((len(colors), 1))], axis=1).astype(np.float32)
    corners = np.empty(len(cells.data.polygons), np.int32)
    cells.data.polygons.foreach_get("loop_total", corners)
    cells.data.color_attributes[COLOR].data.foreach_set("color", rgba[np.repeat(face_cell, corners)].ravel())

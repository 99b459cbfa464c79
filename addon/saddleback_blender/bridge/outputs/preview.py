# SPDX-License-Identifier: GPL-3.0-or-later
"""A look at distances: a material of colors and lines on the object, without touching the artist's own materials.

Each material slot of the object is linked to the object instead of the mesh and shows the preview; the mesh keeps its
materials. Taking the preview away links the slots back. Solid view shows no nodes: it gets the same colors as an
attribute, where the mesh has no colors of the artist's.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import bpy
import numpy as np

from ... import compat, nodes, rollback
from ...core.results import Reals
from ...finishes import GROUND
from ..inputs.materials_in import ADDED_SLOT, BEFORE, PREVIEW, is_of
from .out_attributes import recorded, twins_of, write_vertex_attributes

COLORS = "saddleback_distance_color"  # of a mesh's vertices

# Node names, by which a later run finds what it sets; all else of the material is the artist's to change.
ATTRIBUTE, FARTHEST, SPACING, DARKNESS = "Distance", "Farthest", "Line Spacing", "Line Darkness"
NO_COLOR = (1.0, 1.0, 1.0, 1.0)  # of objects, as Blender makes them
LINE_WIDTH = 0.05  # half of it, in spacings
LINE_DARKNESS = 0.8

# Near to far, linear: sand, orange, magenta, violet, night.
RAMP = (
    (0.00, (1.000, 0.835, 0.440)),
    (0.25, (0.956, 0.339, 0.070)),
    (0.50, (0.651, 0.060, 0.126)),
    (0.75, (0.208, 0.022, 0.201)),
    (1.00, (0.020, 0.012, 0.078)),
)


def show_preview(
    item: bpy.types.Object, attribute: str, distances: Reals, farthest: float, spacing: float
) -> bpy.types.Material:
    """Shows the attribute from 0 to `farthest` in colors, with a line every `spacing` (0: none) mesh units.

    `distances` (V,) are its values.
    """
    hide_preview(item, GROUND)
    material = _own_material(item)
    if material is None:
        material = _new_material()
    _set(material, attribute, farthest, spacing)
    if not len(item.material_slots):
        item.data.materials.append(None)
        item[ADDED_SLOT] = True
    for number, slot in enumerate(item.material_slots):
        if slot.link == "OBJECT" and slot.material is not None and not is_of(slot.material, PREVIEW):
            item[f"{BEFORE}{number}"] = slot.material
        slot.link = "OBJECT"
        slot.material = material
    if all(color.name == COLORS for color in item.data.color_attributes):
        write_vertex_attributes(item, {COLORS: _ramp_colors(distances, farthest)})
        compat.show_color(item.data, COLORS)
    return material


def _ramp_colors(distances: Reals, farthest: float) -> Reals:
    """(V, 4) linear colors of the ramp; what is out of reach has the last one."""
    share = distances / max(farthest, 1e-30)
    stops, colors = np.array([stop for stop, _ in RAMP]), np.array([(*color, 1.0) for _, color in RAMP])
    return np.column_stack([np.interp(share, stops, channel) for channel in colors.T]).astype(np.float32)


def show_ground(item: bpy.types.Object, material: bpy.types.Material) -> None:
    """Shows a material on an object that has none, in place of what was shown so before."""
    hide_preview(item, GROUND)
    if not any(slot.material for slot in item.material_slots):
        _remember(item)
        if not len(item.material_slots):
            item.data.materials.append(None)
            item[ADDED_SLOT] = True
        for slot in item.material_slots:
            slot.link, slot.material = "OBJECT", material
        if tuple(item.color) == NO_COLOR:  # which Solid view shows where it shows attributes
            rollback.remember(item, "color")
            item.color = material.diffuse_color


def hide_preview(item: bpy.types.Object, kind: str = PREVIEW) -> bool:
    """Gives the object its own materials back; says whether it showed a preview, or what else begins with `kind`."""
    _remember(item)
    if kind == PREVIEW and COLORS in item.data.attributes and COLORS in recorded(item.data, item):
        rollback.remember_attribute(item.data, COLORS)
        item.data.attributes.remove(item.data.attributes[COLORS])
    shown = [(number, slot) for number, slot in enumerate(item.material_slots) if is_of(slot.material, kind)]
    if not shown:
        return False
    materials = {slot.material for _, slot in shown}
    if kind == GROUND and any(tuple(item.color) == tuple(material.diffuse_color) for material in materials):
        rollback.remember(item, "color")
        item.color = NO_COLOR
    for number, slot in shown:
        key = f"{BEFORE}{number}"
        slot.link = "OBJECT"
        slot.material = item.get(key)
        if item.get(key) is None:
            slot.link = "DATA"
    for key in [key for key in item.keys() if key.startswith(BEFORE)]:  # noqa: SIM118  (an ID is no dict)
        del item[key]
    if ADDED_SLOT in item:
        del item[ADDED_SLOT]
        other = next((twin for twin in twins_of(item) if any(slot.material for slot in twin.material_slots)), None)
        if other is not None:  # shows its own in that slot
            rollback.remember_keys(other, ADDED_SLOT)
            other[ADDED_SLOT] = True
        elif len(item.data.materials) == 1 and item.data.materials[0] is None:
            compat.remove_material_slots(item.data)
    for material in materials:
        rollback.when_written(partial(_remove_if_unused, material.name))
    return bool(shown)


def _remember(item: bpy.types.Object) -> None:
    """The slots, which are about to change."""
    keys = [ADDED_SLOT, *(f"{BEFORE}{number}" for number in range(len(item.material_slots)))]
    rollback.remember_keys(item, *keys)
    slots = [(slot.link, slot.material) for slot in item.material_slots]
    rollback.undo_with(partial(_put_back, item, slots))


def _put_back(item: bpy.types.Object, slots: list[tuple[str, bpy.types.Material | None]]) -> None:
    while len(item.data.materials) < len(slots):
        item.data.materials.append(None)
    for slot, (link, material) in zip(item.material_slots, slots, strict=False):
        slot.link = link
        slot.material = material
    if not slots and len(item.data.materials):
        compat.remove_material_slots(item.data)


def _remove_if_unused(name: str) -> None:
    material = bpy.data.materials.get(name)  # gone where all unused ones were removed
    if material is not None and material.users == 0 and nodes.is_ours(material):
        bpy.data.materials.remove(material)


def _own_material(item: bpy.types.Object) -> bpy.types.Material | None:
    """The preview of an earlier run, unless another object (a duplicate of this one) shows it as well."""
    for slot in item.material_slots:
        if is_of(slot.material, PREVIEW):
            uses = sum(other.material == slot.material for other in item.material_slots)
            return slot.material if slot.material.users <= uses and slot.material.library is None else None
    return None


def _set(material: bpy.types.Material, attribute: str, farthest: float, spacing: float) -> None:
    tree = material.node_tree.nodes
    if ATTRIBUTE in tree:
        rollback.remember(tree[ATTRIBUTE], "attribute_name")
        tree[ATTRIBUTE].attribute_name = attribute
    values = {FARTHEST: max(farthest, 1e-30), SPACING: spacing if spacing > 0.0 else 1.0}
    values[DARKNESS] = LINE_DARKNESS if spacing > 0.0 else 0.0
    for name, value in values.items():
        if name in tree:
            rollback.remember(tree[name].inputs[1], "default_value")
            tree[name].inputs[1].default_value = value


def _new_material() -> bpy.types.Material:
    material, shader = nodes.new_material("Saddleback Distance", PREVIEW)
    material.diffuse_color = (*RAMP[1][1], 1.0)
    material.node_tree.links.new(add_ramp(material.node_tree), shader.inputs["Base Color"])
    shader.inputs["Roughness"].default_value = 0.6
    return material


def add_ramp(group: bpy.types.NodeTree) -> Any:
    """Distance / farthest -> ramp -> color, darkened where distance / spacing is near a whole number.

    Returns the socket of the color; the second inputs of the nodes FARTHEST, SPACING and DARKNESS are the numbers.
    """
    tree, link = group.nodes, group.links.new

    def math(operation: str, name: str, second: float, x: float, y: float) -> Any:
        node = tree.new("ShaderNodeMath")
        node.operation, node.name, node.label = operation, name, name
        node.inputs[1].default_value = second
        node.location = (x, y)
        return node

    distance = tree.new("ShaderNodeAttribute")
    distance.name = distance.label = ATTRIBUTE
    distance.location = (-1300, 200)
    share = math("DIVIDE", FARTHEST, 1.0, -1080, 300)
    ramp = tree.new("ShaderNodeValToRGB")
    ramp.location = (-860, 300)
    colors = ramp.color_ramp.elements
    colors[0].position, colors[1].position = RAMP[0][0], RAMP[-1][0]
    for position, _ in RAMP[1:-1]:
        colors.new(position)
    for stop, (_, color) in zip(colors, RAMP, strict=True):
        stop.color = (*color, 1.0)
    turns = math("DIVIDE", SPACING, 1.0, -1080, 20)
    to_line = math("PINGPONG", "To Nearest Line", 0.5, -860, 20)
    on_line = math("LESS_THAN", "On Line", LINE_WIDTH, -680, 20)
    dark = math("MULTIPLY", DARKNESS, LINE_DARKNESS, -500, 20)
    bright = math("SUBTRACT", "Brightness", 0.0, -500, 200)
    bright.inputs[0].default_value = 1.0
    shaded = tree.new("ShaderNodeVectorMath")
    shaded.operation = "SCALE"
    shaded.location = (-280, 300)

    link(distance.outputs["Fac"], share.inputs[0])
    link(share.outputs[0], ramp.inputs[0])
    link(distance.outputs["Fac"], turns.inputs[0])
    link(turns.outputs[0], to_line.inputs[0])
    link(to_line.outputs[0], on_line.inputs[0])
    link(on_line.outputs[0], dark.inputs[0])
    link(dark.outputs[0], bright.inputs[1])
    link(ramp.outputs["Color"], shaded.inputs[0])
    link(bright.outputs[0], shaded.inputs["Scale"])
    return shaded.outputs[0]

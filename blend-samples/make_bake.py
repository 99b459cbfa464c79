# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes the cells of coarse rings and shows every map on one of its own: run by Python with bpy.

.cache/bpy-4.5/bin/python blend-samples/make_bake.py docs/images/bake.jpg
"""

from __future__ import annotations

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "blend-samples/scene"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "addon"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "build/python"))

import rings

COLUMNS = 3
MAPS = ("Cell", "Edge Distance", "Local UV", "Direction", "Height", "Height as Bump")


def main() -> None:
    """Bakes, lights, renders."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    items = []
    for number, shown in enumerate(MAPS):
        body = rings.ring(number, COLUMNS)
        bpy.ops.object.modifier_apply(modifier=body.modifiers[0].name)
        items.append(body)
        bpy.ops.saddleback.tessellate(count=120, iterations=30, make_edges=False)
        bpy.ops.saddleback.direction_field(make_arrows=False)
        bpy.ops.saddleback.bake(
            resolution=2048,
            profile="PEBBLES",
            bake_local_uv=True,
            bake_direction=True,
            image_prefix=shown,
        )
        body.data.materials.append(material(shown))
    ink = rings.ink()
    for shown, body in zip(MAPS, items, strict=True):
        rings.label(shown, body, ink)
    rings.render(items, sys.argv[-1])


def material(shown: str) -> bpy.types.Material:
    """The map as the color; or, of the last, as bumps in clay."""
    made = rings.studio.principled(shown, (0.55, 0.2, 0.1), Roughness=0.5)
    nodes, links = made.node_tree.nodes, made.node_tree.links
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    picture = nodes.new("ShaderNodeTexImage")
    is_bump = shown == "Height as Bump"
    picture.image = bpy.data.images[f"{shown} {'Height' if is_bump else shown}"]
    if not is_bump:
        links.new(picture.outputs["Color"], shader.inputs["Base Color"])
        return made
    bump = nodes.new("ShaderNodeBump")
    bump.inputs["Distance"].default_value = picture.image["saddleback_reach"]
    links.new(picture.outputs["Color"], bump.inputs["Height"])
    links.new(bump.outputs["Normal"], shader.inputs["Normal"])
    return made


main()

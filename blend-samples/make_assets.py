# SPDX-License-Identifier: GPL-3.0-or-later
"""Shows every node asset on a ring of its own and renders one picture of all: run by Python with bpy.

.cache/bpy-4.5/bin/python blend-samples/make_assets.py docs/images/assets.jpg
"""

from __future__ import annotations

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "blend-samples/scene"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "addon"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "build/python"))

import rings

COLUMNS = 4


def main() -> None:
    """Makes all assets, lights, renders."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    from saddleback_blender import compat
    from saddleback_blender.assets.groups import ASSETS

    ink, colors = rings.ink(), rings.studio.principled("Clay", (0.55, 0.2, 0.1), Roughness=0.5)
    items = []
    for number, asset in enumerate(ASSETS):
        body = rings.ring(number, COLUMNS)
        items.append(body)
        body.modifiers["Smooth"].levels = 3  # attributes of vertices show cells where these are finer
        bpy.ops.object.modifier_apply(modifier="Smooth")
        bpy.ops.saddleback.tessellate(
            count=120, iterations=30, make_edges=False, make_centers=True, write_edge_distance=True
        )
        group = asset.make(asset.name)
        if group.type == "SHADER":
            shown = bpy.data.materials.new(asset.name)
            shown.use_nodes = True
            node = shown.node_tree.nodes.new("ShaderNodeGroup")
            node.node_tree = group
            shader = next(other for other in shown.node_tree.nodes if other.type == "BSDF_PRINCIPLED")
            shown.node_tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
            if asset.name == "Distance Ramp":
                bpy.ops.saddleback.distance(sources="CURSOR")
                node.inputs["Farthest"].default_value, node.inputs["Line Spacing"].default_value = 5.0, 0.3
            else:
                node.inputs["Joint Width"].default_value, node.inputs["Variation"].default_value = 0.04, 0.6
            body.data.materials.append(shown)
            continue
        body.data.materials.append(colors)
        item = body
        if asset.name == "Tubes by Cell Size":
            bpy.ops.saddleback.tessellate(count=120, iterations=30, make_edges=True)
            item = next(child for child in body.children if child.get("saddleback_role") == "edges")
            item.modifiers.remove(item.modifiers["Saddleback Tubes"])
        elif asset.name in ("Stipple Dots", "Overlapping Scales"):
            item = next(child for child in body.children if child.get("saddleback_role") == "centers")
        modifier = item.modifiers.new(asset.name, "NODES")
        modifier.node_group = group
        if item is not body:
            compat.set_modifier_input(modifier, "Material", colors if "Scales" in asset.name else ink)
    for asset, body in zip(ASSETS, items, strict=True):
        rings.label(asset.name, body, ink)
    rings.render(items, sys.argv[-1])


main()

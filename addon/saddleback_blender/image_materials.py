# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that show an image, one for each, shared; one that is there is the artist's and stays as it is."""

from __future__ import annotations

import bpy

from . import compat, nodes

PICTURE = "picture"  # begins the kind of such a material


def image_material(
    image: bpy.types.Image, uv_map: str, color: tuple[float, ...], is_transparent: bool, is_repeated: bool = False
) -> bpy.types.Material:
    """A material that shows an image on a UV map. Where that is transparent, it lets through what lies behind, or has
    the color, as it has where Blender shows no textures. A repeated one goes on beyond the image's border.
    """
    kind = f"{PICTURE} {uv_map}{'' if is_transparent else ' opaque'}{' repeated' if is_repeated else ''}"
    for material in bpy.data.materials:
        if material.get(nodes.MARK) == kind and material.library is None and _shows(material, image):
            return material
    material, shader = nodes.new_material(f"{image.name}{'' if is_transparent else ' Opaque'}", kind)
    tree = material.node_tree
    places, texture = tree.nodes.new("ShaderNodeUVMap"), tree.nodes.new("ShaderNodeTexImage")
    places.uv_map, texture.image = uv_map, image
    # The border of a single image is the shape's, and shall not have the opposite one's colors.
    texture.extension = "REPEAT" if is_repeated else "EXTEND"
    places.location, texture.location = (-660, 300), (-460, 300)
    tree.links.new(places.outputs["UV"], texture.inputs["Vector"])
    if is_transparent:
        shown = texture.outputs["Color"]
        tree.links.new(texture.outputs["Alpha"], shader.inputs["Alpha"])
        compat.let_through(material)
    else:  # Where nothing of the picture is, it has no color, or a wrong one.
        mixed = tree.nodes.new("ShaderNodeMixRGB")
        mixed.inputs["Color1"].default_value, mixed.location = (*color, 1.0), (-180, 300)
        tree.links.new(texture.outputs["Alpha"], mixed.inputs["Fac"])
        tree.links.new(texture.outputs["Color"], mixed.inputs["Color2"])
        shown = mixed.outputs["Color"]
    tree.links.new(shown, shader.inputs["Base Color"])
    tree.nodes.active = texture  # for the viewport's color by texture
    material.diffuse_color = (*color, 1.0)
    return material


def _shows(material: bpy.types.Material, image: bpy.types.Image) -> bool:
    return bool(material.node_tree) and any(
        node.type == "TEX_IMAGE" and node.image == image for node in material.node_tree.nodes
    )

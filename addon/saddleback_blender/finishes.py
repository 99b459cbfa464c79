# SPDX-License-Identifier: GPL-3.0-or-later
"""The materials of looks, made once a file and shared; one that is there is the artist's and stays as it is."""

from __future__ import annotations

from collections.abc import Callable

import bpy
import numpy as np

from . import compat, nodes
from .core.fields.image_colors import to_linear
from .core.results import Reals
from .looks import LOOKS, Finish, finish_of

GROUND = "ground"  # begins the kind of a material that a body has below a look


def palette_of(finish: Finish) -> Reals:
    """(m, 3) linear colors."""
    return np.array([linear_of(color) for color in finish.colors])


def linear_of(color: str) -> Reals:
    """(3,) of "#rrggbb"."""
    return to_linear(np.array([int(color[i : i + 2], 16) / 255.0 for i in (1, 3, 5)]))


def ground_of(look: str) -> bpy.types.Material | None:
    """The material of the body below a look, None where that stays as it is."""
    if look not in LOOKS or not LOOKS[look].ground:
        return None
    kind, name = f"{GROUND} {look}", f"Saddleback {LOOKS[look].label} Ground"
    return nodes.find_material(kind) or nodes.new_colored(name, kind, (*linear_of(LOOKS[look].ground), 1.0), 0.8)


def has_colors(look: str) -> bool:
    """Tells whether what a look makes has many colors, or the body has."""
    finish = finish_of(look)
    has_preview = look in LOOKS and LOOKS[look].settings.get("make_preview", False)
    return has_preview or (finish is not None and len(finish.colors) > 1)


def material_of(look: str, otherwise: Callable[[], bpy.types.Material]) -> bpy.types.Material:
    """The material of a look, made where the file has none; another where the look has no finish."""
    finish = finish_of(look)
    if finish is None:
        return otherwise()
    return nodes.find_material(f"look {look}") or _new_material(f"look {look}", finish)


def _new_material(kind: str, finish: Finish) -> bpy.types.Material:
    """A shader that shows the color attribute, or the one color that there is; of nodes that all versions have."""
    material, shader = nodes.new_material(f"Saddleback {finish.name}", kind)
    palette = palette_of(finish)
    if len(palette) > 1:
        nodes.show_attribute(material, shader)
    shader.inputs["Base Color"].default_value = (*palette[0], 1.0)
    shader.inputs["Roughness"].default_value = finish.roughness
    shader.inputs["Metallic"].default_value = finish.metallic
    compat.coat_input(shader).default_value = finish.coat
    material.diffuse_color = (*palette.mean(axis=0), 1.0)
    material.roughness, material.metallic = finish.roughness, finish.metallic
    return material

# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether Solid view shows the color of each cell and shape: the view's choice, which a look makes and Clear undoes."""

from __future__ import annotations

from typing import Any

import bpy

from ... import jobs

BY_ATTRIBUTE, BY_MATERIAL = "VERTEX", "MATERIAL"  # what Blender calls them


def is_colored(space: Any) -> bool:
    """Tells whether a space is a 3D view that shows them."""
    return isinstance(space, bpy.types.SpaceView3D) and space.shading.color_type == BY_ATTRIBUTE


def show_colors(space: Any) -> None:
    """Shows them in a 3D view that is as Blender begins with it; a person's other choice stays."""
    if isinstance(space, bpy.types.SpaceView3D) and space.shading.color_type == BY_MATERIAL:
        space.shading.color_type = BY_ATTRIBUTE
        jobs.state.colored.add(space.as_pointer())


def hide_colors(space: Any) -> None:
    """Shows the materials' colors again where a look has changed that."""
    if is_colored(space) and space.as_pointer() in jobs.state.colored:
        space.shading.color_type = BY_MATERIAL
        jobs.state.colored.discard(space.as_pointer())

# SPDX-License-Identifier: GPL-3.0-or-later
"""What each operator makes that has looks, and how it goes away when the object gets a look of another."""

from __future__ import annotations

import bpy

from ... import rollback
from ...blocks import is_editable
from ...finishes import GROUND, ground_of
from ...looks import LOOKS
from .out_cells import CELLS_ROLE
from .out_centers import CENTERS_ROLE
from .out_collection import SURFACE_ROLE, find_output, remove_output
from .out_curves import ISOLINES_ROLE
from .out_dual import DUAL_ROLE
from .out_edges import EDGES_ROLE
from .out_shape_cut import CUT_ROLE
from .out_shapes import BENT_ROLE, INSTANCES_ROLE, OUTLINES_ROLE, remove_templates
from .out_shell import SHELL_ROLE
from .preview import hide_preview, show_ground

# On a hidden source, by who hid it: how it was displayed, and whether renders left it out.
BY_LOOK, BY_HAND = "saddleback_hidden", "saddleback_hidden_by_hand"

ROLES = {
    "tessellate": (EDGES_ROLE, CELLS_ROLE, CENTERS_ROLE, DUAL_ROLE, SHELL_ROLE),
    "distribute": (BENT_ROLE, INSTANCES_ROLE, OUTLINES_ROLE, CUT_ROLE),
    "distance": (ISOLINES_ROLE,),
}


def remove_look(source: bpy.types.Object, operator: str) -> None:
    """Removes the objects that one operator made of the source; attributes stay."""
    for role in ROLES[operator]:
        remove_output(source, role)
    if operator == "distribute":
        remove_templates(source)
    elif operator == "distance":
        for shown in (source, find_output(source, SURFACE_ROLE)):
            if shown is not None:
                hide_preview(shown)


def set_stage(source: bpy.types.Object, look: str) -> None:
    """Gives the body the color that belongs below a look, and hides it where the look is all that is to be seen.

    What has a material keeps it. Without a look, or with another one, the body is as it was before.
    """
    ground = ground_of(look)
    if ground is not None and is_editable(source.data):
        show_ground(source, ground)
    else:
        hide_preview(source, GROUND)
    copy = find_output(source, SURFACE_ROLE)
    is_on_copy = look in LOOKS and LOOKS[look].operator == "distance" and copy is not None and not copy.hide_viewport
    hides = is_on_copy or (look in LOOKS and LOOKS[look].hides_source)
    if hides and not is_hidden(source):
        hide(source, BY_LOOK)
    elif not hides and BY_LOOK in source:
        show(source)


def is_hidden(source: bpy.types.Object) -> bool:
    """Tells whether a look or a person has hidden the source."""
    return BY_LOOK in source or BY_HAND in source


def hide(source: bpy.types.Object, who: str) -> None:
    """Shows the source as a box, which can be worked on, and not in renders."""
    _remember(source)
    source[who] = f"{source.display_type} {int(source.hide_render)}"
    source.display_type, source.hide_render = "BOUNDS", True


def show(source: bpy.types.Object) -> None:
    """Shows a hidden source as it was before."""
    _remember(source)
    display, left_out = source[BY_LOOK if BY_LOOK in source else BY_HAND].split()
    source.display_type, source.hide_render = display, left_out == "1"
    for who in (BY_LOOK, BY_HAND):
        if who in source:
            del source[who]


def _remember(source: bpy.types.Object) -> None:
    rollback.remember_keys(source, BY_LOOK)
    rollback.remember_keys(source, BY_HAND)
    rollback.remember(source, "display_type", "hide_render")

"""What each operator makes that has looks, and how it goes away when the object gets a look of another."""

from __future__ import annotations

import bpy

from ... import rollback
from ...blocks import is_editable
from ...finishes import GROUND, ground_of
from ...looks import LOOKS
from .out_cells import CELLS_ROLE
from .out_centers import CENTERS_ROLE
from .out_collection import find_output, remove_output
from .out_curves import ISOLINES_ROLE
from .out_dual import DUAL_ROLE
from .out_edges import EDGES_ROLE
from .out_shape_cut import CUT_ROLE
from .out_shapes import BENT_ROLE, INSTANCES_ROLE, OUTLINES_ROLE, remove_templates
from .out_shell import SHELL_ROLE
from .output_surface import SURFACE_ROLE
from .preview import hide_preview, show_ground

HIDDEN = "saddleback_hidden"  # on a source that a look hides: how it was displayed

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
    if hides != (HIDDEN in source):
        rollback.remember_keys(source, HIDDEN)
        rollback.remember(source, "display_type", "hide_render")
        source.hide_render = hides
        if hides:
            source[HIDDEN], source.display_type = source.display_type, "BOUNDS"
        else:
            source.display_type = source[HIDDEN]
            del source[HIDDEN]

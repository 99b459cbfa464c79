"""What each operator makes that has looks, and how it goes away when the object gets a look of another."""

from __future__ import annotations

import bpy

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
from .preview import hide_preview

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

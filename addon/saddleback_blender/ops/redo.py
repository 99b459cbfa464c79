# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of Adjust Last Operation: what one turns after a run, six at most, in place of every property there is."""

from __future__ import annotations

from typing import Any

import bpy

from ..core.lengths import OUTPUTS, SHARE

MOST_ROWS = 6
ROWS = {
    "tessellate": ("count", "seed", "iterations", "edge_radius", "gap", "thickness", "inset", "instance_scale"),
    "distance": ("isoline_count", "isoline_radius", "preview_lines", "limit"),
    "path": ("path_radius", "lift", "connect", "shorten"),
    "ribbon": ("width", "lift", "show", "repeat"),
    "voronoi_2d": ("count", "seed", "iterations", "edge_radius", "gap", "thickness", "instance_size", "instance_scale"),
    "direction_field": ("symmetry", "align", "turn", "arrow_count", "streamline_spacing", "streamline_radius"),
    "distribute": ("count", "seed", "size", "packing", "gap", "outline_radius"),
    "bake": ("resolution", "margin", "bits", "profile"),
    "repair": ("weld_distance", "close_cracks", "fill_holes"),
}
# The switches of what is neither a length nor always there.
SWITCHES = OUTPUTS | {
    "isoline_count": "make_isolines",
    "preview_lines": "make_preview",
    "instance_size": "make_centers",
    "instance_scale": "make_centers",
    "arrow_count": "make_arrows",
    "streamline_spacing": "make_streamlines",
}


# What stands for a number of cells, by where they come from.
COUNTS = {"SIZE": "cell_size", "SELECTED": "", "OBJECT": ""}


def rows_of(operator: Any, settings_name: str) -> list[str]:
    """Names of the properties that an operator shows: of outputs that are made only, in the unit that is chosen."""
    names = []
    for name in ROWS[settings_name]:
        switch = SWITCHES.get(name, "")
        if settings_name == "distribute" and name == "gap":
            switch = ""  # between shapes, whatever is made of them
        if not getattr(operator, switch, True):
            continue
        if name == "count" and getattr(operator, "sites_source", name) in COUNTS:
            name = COUNTS[operator.sites_source]
            if not name:
                continue
        is_share = hasattr(operator, name + SHARE) and operator.lengths == "RELATIVE"
        names.append(name + SHARE if is_share else name)
    return names[:MOST_ROWS]


def draw_redo(layout: bpy.types.UILayout, operator: Any, settings_name: str) -> None:
    """Draws them."""
    layout.use_property_split = True
    layout.use_property_decorate = False
    for name in rows_of(operator, settings_name):
        layout.prop(operator, name)

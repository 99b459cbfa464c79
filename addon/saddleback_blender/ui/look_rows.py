# SPDX-License-Identifier: GPL-3.0-or-later
"""The looks in the tab: a button each, and Blender's menu of presets for the artist's own."""

from __future__ import annotations

import bpy
from bl_ui.utils import PresetPanel

from ..looks import LOOKS
from ..ops.look_presets import PRESET_FOLDER
from .panel_parts import draw_state


class SADDLEBACK_PT_look_presets(PresetPanel, bpy.types.Panel):
    """Looks that were kept."""

    bl_label = "Look Presets"
    preset_subdir = PRESET_FOLDER
    preset_operator = "saddleback.run_preset"
    preset_operator_defaults = {"wait": False}
    preset_add_operator = "saddleback.look_preset_add"


def draw_looks(layout: bpy.types.UILayout, context: bpy.types.Context, item: bpy.types.Object) -> None:
    """A button for each look, some with another beside it; the one that the object has is pressed. What it made stands
    below, unless the panel that tells it is open at first.
    """
    grid = layout.grid_flow(row_major=True, columns=2, even_columns=True, align=True)
    for key, look in LOOKS.items():
        if look.beside:
            continue
        row = grid.row(align=True)
        others = [name for name in LOOKS if LOOKS[name].beside == key]
        has_more = bool(others) or key == "STIPPLE"
        _draw_look(row, item, key, look.label, "NONE" if has_more else look.icon)  # no room for both
        for other in others:
            _draw_look(row, item, other, "", LOOKS[other].icon)
        if key == "STIPPLE":
            row.operator("saddleback.stipple_image", text="", icon="IMAGE_DATA")
    groups = item.saddleback
    kinds = [look.operator for key, look in LOOKS.items() if getattr(groups, look.operator).look == key]
    if groups.voronoi_2d.sites_source == "IMAGE":  # Stipple Image
        kinds.append("voronoi_2d")
    if kinds and kinds[0] != "tessellate":
        draw_state(layout, context, kinds[0], has_info=True)


def _draw_look(layout: bpy.types.UILayout, item: bpy.types.Object, key: str, text: str, icon: str) -> None:
    is_on = getattr(item.saddleback, LOOKS[key].operator).look == key
    layout.operator("saddleback.apply_look", text=text, icon=icon, depress=is_on).look = key

# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of layers in the tab, and the buttons below it."""

from __future__ import annotations

from typing import Any

import bpy

from ..looks import LOOKS, NO_LOOK
from ..props import LAYER_KINDS
from ..props.layers import active_layer, layers_of

FEWEST_ROWS, MOST_ROWS = 2, 5  # of the list; buttons below it stay where they are while layers are few


class SADDLEBACK_UL_layers(bpy.types.UIList):
    """Patterns on one object."""

    def draw_item(  # Blender counts the arguments
        self,
        _context: bpy.types.Context,
        layout: bpy.types.UILayout,
        data: Any,
        item: Any,
        _icon_value: int,
        _active_data: Any,
        _active_property: str,
    ) -> None:
        """Draws one: its name, and whether it is seen."""
        owner = data if item.word == data.layer_word else item
        row = layout.row(align=True)
        row.prop(item, "name", text="", emboss=False, icon="FREEZE" if item.is_frozen else _icon(owner))
        switches = row.row(align=True)
        switches.enabled = not item.is_frozen
        for switch, icon in (("show_viewport", "HIDE"), ("show_render", "RESTRICT_RENDER")):
            is_on = getattr(item, switch)
            switches.prop(item, switch, text="", emboss=False, icon=f"{icon}_{'OFF' if is_on else 'ON'}")


def _icon(owner: Any) -> str:
    """That of the layer's look."""
    groups = [getattr(owner, kind) for kind in LAYER_KINDS if owner.is_property_set(kind)]
    looks = [group.look for group in groups if getattr(group, "look", NO_LOOK) != NO_LOOK]
    return LOOKS[looks[0]].icon if looks else "MESH_DATA"


def draw_region(layout: bpy.types.UILayout, item: bpy.types.Object) -> None:
    """What the active layer covers."""
    props = item.saddleback
    column = layout.column()
    column.use_property_split = True
    column.use_property_decorate = False
    row = column.row(align=True)
    row.prop(props, "region", text="")
    row.prop(props, "mirror_x", text="", icon="MOD_MIRROR")
    row.popover("SADDLEBACK_PT_barriers", text="", icon="MOD_EDGESPLIT")
    if props.region == "VERTEX_GROUP":
        column.prop_search(props, "region_name", item, "vertex_groups", text="Group", icon="GROUP_VERTEX")
    elif props.region == "ATTRIBUTE":
        column.prop_search(props, "region_name", item.data, "attributes", text="Name", icon="SPREADSHEET")
    elif props.region == "MATERIAL":
        column.prop_search(props, "region_name", item.data, "materials", text="Material", icon="MATERIAL")
    elif props.region == "FACES":
        column.operator("saddleback.region_from_selection", icon="FACESEL")


def draw_barriers(layout: bpy.types.UILayout, item: bpy.types.Object) -> None:
    """What the pattern of the active layer does not cross."""
    props = item.saddleback
    column = layout.column()
    column.use_property_split = True
    column.use_property_decorate = False
    column.prop(props, "barriers")
    if props.barriers == "ATTRIBUTE":
        row = column.row(align=True)
        row.prop_search(props, "barriers_name", item.data, "attributes", text="Name", icon="SPREADSHEET")
        row.operator("saddleback.barriers_from_selection", text="", icon="EDGESEL")


def draw_layers(layout: bpy.types.UILayout, item: bpy.types.Object) -> None:
    """The list, and what can be done with the active one."""
    column = layout.column(align=True)
    rows = min(max(len(layers_of(item)), FEWEST_ROWS), MOST_ROWS)
    props = item.saddleback
    column.template_list("SADDLEBACK_UL_layers", "", props, "layers", props, "layer_index", rows=rows, maxrows=rows)
    row = column.row(align=True)
    row.operator("saddleback.layer_add", text="Add Layer", icon="ADD")
    if active_layer(item) is not None:
        row.operator("saddleback.layer_duplicate", text="", icon="DUPLICATE")
        row.operator("saddleback.layer_freeze", text="", icon="FREEZE")
        row.operator("saddleback.layer_delete", text="", icon="TRASH")

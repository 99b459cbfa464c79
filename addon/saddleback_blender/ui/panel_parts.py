# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panels of the tab have in common: where they are, the button, what a run says."""

from __future__ import annotations

import functools

import bpy

from .. import compat
from ..bridge.inputs.source import active_object, why_not
from ..core import native
from .texts import draw_text


class SaddlebackPanel:
    """Mixin: where all panels of the tab are."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Saddleback"


class SaddlebackSubPanel(SaddlebackPanel):
    """Mixin: a panel within the tab that is there when the operators can run."""

    bl_parent_id = "SADDLEBACK_PT_main"
    layout: bpy.types.UILayout

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Allows it only where something can be done."""
        return not native_problem() and not why_not(context)

    def split_layout(self, context: bpy.types.Context) -> bpy.types.UILayout:
        """Names to the left and values to the right; gray while a run goes on."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.enabled = not context.window_manager.saddleback_running
        return layout


def draw_button(
    layout: bpy.types.UILayout, context: bpy.types.Context, operator: str, icon: str, live: str = ""
) -> None:
    """The button that starts a run, always in the same place: while one goes on its progress stands there.

    A button that is gray under the mouse stays dead in Blender after it could be pressed again; a new one does not.
    """
    row = layout.row()
    row.scale_y = 1.15
    if context.window_manager.saddleback_running:
        compat.draw_progress(row, context.window_manager)
    else:
        row.operator(operator, icon=icon)
        if live:
            row.operator(live, text="", icon="PLAY")


def draw_state(layout: bpy.types.UILayout, context: bpy.types.Context, kind: str, has_info: bool = False) -> None:
    """The run that goes on; else the way out of an error, or what the last run of this kind made of the object.

    Lengths are told here, too, unless there is a panel Info.
    """
    manager, item = context.window_manager, active_object(context)
    is_last = manager.saddleback_kind == kind
    if manager.saddleback_running:
        if is_last:
            draw_text(layout, context, manager.saddleback_text, "TIME")
            layout.label(text="Press ESC to stop", icon="EVENT_ESC")
    elif is_last and manager.saddleback_needs_repair == item.name:
        box = layout.box()
        box.alert = True
        draw_text(box, context, "This mesh has faults that keep it from being a surface", "ERROR")
        row = box.row()
        row.alert = False
        row.scale_y = 1.3
        row.operator("saddleback.repair", text="Repair Mesh", icon="TOOL_SETTINGS")
    else:
        lines = getattr(item.saddleback, kind).told.splitlines()
        for number, line in enumerate(lines[:1] if has_info else lines):
            text = line if number else line.removeprefix(f"'{item.name}': ")  # which stands above
            draw_text(layout, context, text, "BLANK1" if number else "CHECKMARK")


def draw_figures(layout: bpy.types.UILayout, context: bpy.types.Context, kind: str) -> None:
    """Numbers of the last run of this kind on the object."""
    for line in getattr(active_object(context).saddleback, kind).figures.splitlines():
        draw_text(layout, context, line, "BLANK1")


class SaddlebackAdvancedPanel(SaddlebackSubPanel):
    """Mixin: what is seldom changed."""

    bl_label = "Advanced"
    bl_options = {"DEFAULT_CLOSED"}


@functools.cache
def native_problem() -> str:
    """Asked once: an answer that changes needs a restart of Blender anyway."""
    return native.problem()

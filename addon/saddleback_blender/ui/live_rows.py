# SPDX-License-Identifier: GPL-3.0-or-later
"""The switch of Auto Update, and what it has to say."""

from __future__ import annotations

import bpy

from .. import jobs
from ..props.layers import active_layer
from .texts import draw_text


def draw_live(layout: bpy.types.UILayout, context: bpy.types.Context, item: bpy.types.Object) -> None:
    """Of the active layer. Sentences that were told stay until there is something else."""
    layer = active_layer(item)
    label, running = bpy.app.translations.pgettext_iface("Auto Update"), jobs.state.live_running
    if layer is None or layer.is_frozen:  # as high as the switch, so that the first run moves no button below
        row = layout.row()
        row.enabled = False
        row.label(text=label, translate=False, icon="FILE_REFRESH")
        return
    if running is not None and running[0] == item.name:  # here, since a line of its own would push all below to and fro
        label = f"{label} {running[1]} %"
    layout.prop(layer, "auto_update", text=label, translate=False, toggle=True, icon="FILE_REFRESH")
    text = jobs.state.live.get(item.name, "") if layer.auto_update else ""
    if text:
        draw_text(layout, context, text, "INFO")
    elif jobs.state.live_ended:
        draw_text(layout, context, jobs.state.live_ended, "INFO")

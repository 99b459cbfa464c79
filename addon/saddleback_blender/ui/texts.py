# SPDX-License-Identifier: GPL-3.0-or-later
"""Text in panels: Blender cuts a label off at the panel's edge, so sentences are broken into lines."""

from __future__ import annotations

import textwrap

import bpy

# Width of a letter of the interface font at scale 1, in pixels, on the wide side; and what icon and margins take.
LETTER_WIDTH = 7.0
MARGIN = 58.0
FEWEST_LETTERS = 16


def draw_text(layout: bpy.types.UILayout, context: bpy.types.Context, text: str, icon: str = "NONE") -> None:
    """Draws a sentence in as many lines as the sidebar needs; the icon stands before the first."""
    region = context.region
    scale = context.preferences.system.ui_scale
    width = region.width if region is not None else 240
    letters = max(FEWEST_LETTERS, int((width / scale - MARGIN) / LETTER_WIDTH))
    column = layout.column(align=True)
    column.scale_y = 0.8
    for number, line in enumerate(textwrap.wrap(text, letters) or [""]):
        column.label(text=line, icon=icon if number == 0 else "BLANK1" if icon != "NONE" else "NONE")

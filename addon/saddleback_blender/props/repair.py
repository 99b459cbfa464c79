# SPDX-License-Identifier: GPL-3.0-or-later
"""The properties of `saddleback.repair`."""

from __future__ import annotations

from typing import Any

from bpy.props import IntProperty

from .kinds import length, switch

REPAIR: dict[str, Any] = {
    "weld_distance": length("Weld Distance", "Join vertices closer than this; 0 joins those at the same place", 0.0),
    "close_cracks": switch(
        "Close Cracks",
        "Join borders that nearly meet, also where vertices of one lie amid edges of the other. With a Weld Distance "
        "of 0 they are joined by the least distance that does",
        False,
    ),
    "fill_holes": IntProperty(
        name="Fill Holes",
        description="Fill holes with at most so many edges; 0 fills none. Outlines of open surfaces are holes, too",
        default=0,
        min=0,
        max=2000,
        options={"SKIP_SAVE"},
    ),
}

# SPDX-License-Identifier: GPL-3.0-or-later
"""Shows and hides all that was made in a layer; what the artist hid by hand stays hidden."""

from __future__ import annotations

from typing import Any

import bpy

from ... import rollback
from .out_collection import outputs_of

# Of a layer, of an object, and on outputs: hidden there with the layer.
SWITCHES = (
    ("show_viewport", "hide_viewport", "saddleback_hidden_in_viewport"),
    ("show_render", "hide_render", "saddleback_hidden_in_renders"),
)


def show_layer(source: bpy.types.Object, layer: Any) -> None:
    """Shows what was made in a layer, or hides it, as the layer says."""
    for item in outputs_of(source, layer.word):
        if not item.users_collection:  # seen as instances only
            continue
        for switch, hides, mark in SWITCHES:
            is_shown = getattr(layer, switch)
            if is_shown == (mark in item) and (is_shown or not getattr(item, hides)):
                rollback.remember(item, hides)
                rollback.remember_keys(item, mark)
                setattr(item, hides, not is_shown)
                if is_shown:
                    del item[mark]
                else:
                    item[mark] = True

# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that version 0.1 wrote: what nobody chose there stays what it was before the panel began with other values."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.app.handlers import persistent

from ..bridge.outputs.out_collection import outputs_of
from ..bridge.tokens import ROLE
from .layers import first_layer, has_settings

LAYOUT = 1  # of the kept settings; in version 0.1 there was no number, which reads as 0
OLD_SETTING, NEW_SETTING = "make_centres", "make_centers"  # the one that has another name since
OLD_ROLES = {"centres": "centers", "voronoi centres": "voronoi centers"}


def _own_objects() -> list[bpy.types.Object]:
    """Those of this file that keep settings. An override's come from its text."""
    candidates = (item for item in bpy.data.objects if item.library is None and item.override_library is None)
    return [item for item in candidates if item.is_property_set("saddleback")]


@persistent  # type: ignore[untyped-decorator]
def mark(*_: Any) -> None:
    """Says before a file is saved which layout its settings have."""
    for item in _own_objects():
        if item.saddleback.layout_number != LAYOUT:
            item.saddleback.layout_number = LAYOUT


@persistent  # type: ignore[untyped-decorator]
def settle(*_: Any) -> None:
    """Writes down after a file was opened what version 0.1 would have taken."""
    from . import BEGIN, PROPERTIES, existing_group

    for item in _own_objects():
        if has_settings(item):  # it may be from before there were layers
            first_layer(item)
        if item.saddleback.layout_number != 0:
            continue
        for output in outputs_of(item):
            output[ROLE] = OLD_ROLES.get(output[ROLE], output[ROLE])
        for settings_name, begin in BEGIN.items():
            group = existing_group(item, settings_name)
            if group is not None and OLD_SETTING in group:
                setattr(group, NEW_SETTING, bool(group.pop(OLD_SETTING)))
            for name in begin:
                if group is not None and not group.is_property_set(name):
                    setattr(group, name, PROPERTIES[settings_name][name].keywords["default"])


def register() -> None:
    """Makes everything of this module known to Blender."""
    bpy.app.handlers.save_pre.append(mark)
    bpy.app.handlers.load_post.append(settle)


def unregister() -> None:
    """Takes it back, in the opposite order."""
    bpy.app.handlers.load_post.remove(settle)
    bpy.app.handlers.save_pre.remove(mark)

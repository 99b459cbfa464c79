# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps what a library override keeps. Of an object that overrides another file's, Blender saves only registered
properties that may be overridden, and from 5.0 on no groups of them: token, settings and what we noted on the object
are kept as texts besides.
"""

from __future__ import annotations

import json
from typing import Any

import bpy
from bpy.app.handlers import persistent
from bpy.props import StringProperty

from ..bridge.outputs.out_looks import BY_HAND, BY_LOOK
from ..bridge.outputs.rest_places import KEPT
from ..bridge.tokens import OVERRIDE_TOKEN

SETTINGS = "saddleback_override_settings"
NOTES = "notes"  # beside the settings: custom properties of the object
NOTED = (BY_HAND, BY_LOOK, KEPT)


@persistent  # type: ignore[untyped-decorator]
def write_texts(*_: Any) -> None:
    """Writes texts before a file is saved."""
    from . import told_settings

    for item in _overrides():
        told = told_settings(item)
        if told:
            told[NOTES] = {key: item[key] for key in NOTED if key in item}
        text = json.dumps(told, sort_keys=True) if told else ""
        if getattr(item, SETTINGS) != text:
            setattr(item, SETTINGS, text)


@persistent  # type: ignore[untyped-decorator]
def read_texts(*_: Any) -> None:
    """Reads texts after a file was opened."""
    from . import take_settings

    for item in _overrides():
        if getattr(item, SETTINGS):
            told = json.loads(getattr(item, SETTINGS))
            take_settings(item, told)
            for key in NOTED if NOTES in told else ():
                if key in told[NOTES]:
                    item[key] = told[NOTES][key]
                elif key in item:  # what the original has
                    del item[key]


def _overrides() -> list[bpy.types.Object]:
    return [item for item in bpy.data.objects if item.override_library is not None and item.library is None]


def register() -> None:
    """Makes everything of this module known to Blender."""
    for name, label in ((OVERRIDE_TOKEN, "Token"), (SETTINGS, "Settings")):
        text = StringProperty(
            name=f"Saddleback {label}", description="Of a library override", options={"HIDDEN"},
            override={"LIBRARY_OVERRIDABLE"},
        )  # fmt: skip
        setattr(bpy.types.Object, name, text)
    bpy.app.handlers.save_pre.append(write_texts)
    bpy.app.handlers.load_post.append(read_texts)


def unregister() -> None:
    """Takes it back, in the opposite order."""
    bpy.app.handlers.load_post.remove(read_texts)
    bpy.app.handlers.save_pre.remove(write_texts)
    for name in (OVERRIDE_TOKEN, SETTINGS):
        delattr(bpy.types.Object, name)

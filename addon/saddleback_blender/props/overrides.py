# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps what a library override keeps. Of an object that overrides another file's, Blender saves only registered
properties that may be overridden, and from 5.0 on no groups of them: token and settings are kept as texts besides.
"""

from __future__ import annotations

import json
from typing import Any

import bpy
from bpy.app.handlers import persistent
from bpy.props import StringProperty

from ..bridge.tokens import OVERRIDE_TOKEN

SETTINGS = "saddleback_override_settings"


@persistent  # type: ignore[untyped-decorator]
def write_texts(*_: Any) -> None:
    """Writes texts before a file is saved."""
    from . import told_settings

    for item in _overrides():
        told = told_settings(item)
        text = json.dumps(told, sort_keys=True) if told else ""
        if getattr(item, SETTINGS) != text:
            setattr(item, SETTINGS, text)


@persistent  # type: ignore[untyped-decorator]
def read_texts(*_: Any) -> None:
    """Reads texts after a file was opened."""
    from . import take_settings

    for item in _overrides():
        if getattr(item, SETTINGS):
            take_settings(item, json.loads(getattr(item, SETTINGS)))


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

# SPDX-License-Identifier: GPL-3.0-or-later
"""The sidebar tab "Saddleback" and the menu: they draw, and nothing else."""

from __future__ import annotations

import bpy

from . import menus, panels


def register() -> None:
    """Makes the panels known to Blender."""
    for cls in panels.CLASSES:
        bpy.utils.register_class(cls)
    menus.register()


def unregister() -> None:
    """Takes them back, in the opposite order."""
    menus.unregister()
    for cls in reversed(panels.CLASSES):
        bpy.utils.unregister_class(cls)

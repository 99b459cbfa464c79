# SPDX-License-Identifier: GPL-3.0-or-later
"""Saddleback: geodesic cells, even tessellations and distances on painted meshes."""

from __future__ import annotations

import atexit

bl_info = {
    "name": "Saddleback",
    "author": "The Saddleback maintainers",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Saddleback",
    "description": "Geodesic Voronoi cells and even tessellations of painted meshes",
    "doc_url": "https://github.com/OWNER/saddleback/tree/main/docs/manual",
    "category": "Mesh",
}


def register() -> None:
    """Makes everything of this module known to Blender."""
    import bpy

    from . import jobs, ops, prefs, props, translations, ui

    for module in (translations, props, prefs, jobs, ops, ui):
        module.register()
    # Blender as a Python module frees the classes of add-ons after Python has ended: 4.5 hangs there, and 4.2 crashes.
    if getattr(bpy.app, "module", False):
        atexit.register(unregister)


def unregister() -> None:
    """Takes it back, in the opposite order."""
    from . import jobs, ops, prefs, props, translations, ui

    atexit.unregister(unregister)
    globals()["__addon_enabled__"] = False  # or Blender would do all of this again, in vain, when it ends after Python
    for module in (ui, ops, jobs, prefs, props, translations):
        module.unregister()

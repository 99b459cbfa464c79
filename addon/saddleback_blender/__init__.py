# SPDX-License-Identifier: GPL-3.0-or-later
"""Saddleback: geodesic cells, even tessellations and distances on painted meshes."""

from __future__ import annotations

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
    from . import jobs, ops, prefs, props, translations, ui

    for module in (translations, props, prefs, jobs, ops, ui):
        module.register()


def unregister() -> None:
    """Takes it back, in the opposite order."""
    from . import jobs, ops, prefs, props, translations, ui

    for module in (ui, ops, jobs, prefs, props, translations):
        module.unregister()

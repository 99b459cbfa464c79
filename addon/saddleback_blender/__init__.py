"""Saddleback: geodesic cells, even tessellations and distances on painted meshes."""

from __future__ import annotations


def register() -> None:
    """Makes everything of this module known to Blender."""
    from . import jobs, ops, prefs, props, ui

    for module in (props, prefs, jobs, ops, ui):
        module.register()


def unregister() -> None:
    """Takes it back, in the opposite order."""
    from . import jobs, ops, prefs, props, ui

    for module in (ui, ops, jobs, prefs, props):
        module.unregister()

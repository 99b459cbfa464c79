"""The sidebar tab "Saddleback": panels that draw, and nothing else."""

from __future__ import annotations

import bpy

from . import panels


def register() -> None:
    """Makes the panels known to Blender."""
    for cls in panels.CLASSES:
        bpy.utils.register_class(cls)


def unregister() -> None:
    """Takes them back, in the opposite order."""
    for cls in reversed(panels.CLASSES):
        bpy.utils.unregister_class(cls)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators: gather from Blender, let the core compute, write the result."""

from __future__ import annotations

import bpy

from . import (
    applied,
    apply_look,
    asset_library,
    bake,
    clear,
    direction_field,
    distance,
    distribute,
    export_solid,
    layers,
    live,
    look_presets,
    paint,
    path,
    repair,
    ribbon,
    sites,
    stipple_image,
    tessellate,
    voronoi_2d,
)

CLASSES = (
    *apply_look.CLASSES,
    *look_presets.CLASSES,
    *layers.CLASSES,
    *distance.CLASSES,
    *path.CLASSES,
    *ribbon.CLASSES,
    *tessellate.CLASSES,
    *sites.CLASSES,
    *voronoi_2d.CLASSES,
    *stipple_image.CLASSES,
    *direction_field.CLASSES,
    *distribute.CLASSES,
    *bake.CLASSES,
    *paint.CLASSES,
    *repair.CLASSES,
    *export_solid.CLASSES,
    *clear.CLASSES,
    *asset_library.CLASSES,
)


def register() -> None:
    """Makes everything of this module known to Blender."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    live.register()
    applied.register()


def unregister() -> None:
    """Takes it back, in the opposite order."""
    applied.unregister()
    live.unregister()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)

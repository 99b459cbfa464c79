"""Preferences: threads, the cache's size, and what the native library is and sees."""

from __future__ import annotations

import bpy
from bpy.props import IntProperty

from .core import cache, native


def _resize_cache(preferences: bpy.types.AddonPreferences, _context: bpy.types.Context) -> None:
    cache.shared.resize(preferences.cache_megabytes * 2**20)


class SaddlebackPreferences(bpy.types.AddonPreferences):
    """What holds for the whole computer rather than for one file."""

    bl_idname = __package__

    __annotations__ = {
        "threads": IntProperty(
            name="Threads", description="Processor threads to compute with; 0 means all", default=0, min=0, max=1024
        ),
        "cache_megabytes": IntProperty(
            name="Cache",
            description="Memory (MB) for meshes, distance graphs and results kept for the next run",
            default=2048,
            min=0,
            soft_max=65536,
            update=_resize_cache,
        ),
    }

    def draw(self, _context: bpy.types.Context) -> None:
        """Draws the preferences."""
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "threads")
        layout.prop(self, "cache_megabytes")
        problem = native.problem()
        row = layout.row()
        row.alert = bool(problem)
        row.label(text=problem or native.description(), icon="ERROR" if problem else "INFO")


def threads(context: bpy.types.Context) -> int:
    """The number of threads to compute with, 0 = all."""
    addon = context.preferences.addons.get(__package__)
    return int(addon.preferences.threads) if addon is not None and addon.preferences is not None else 0


def register() -> None:
    """Makes everything of this module known to Blender."""
    bpy.utils.register_class(SaddlebackPreferences)
    addon = bpy.context.preferences.addons.get(__package__)
    if addon is not None and addon.preferences is not None:
        cache.shared.resize(addon.preferences.cache_megabytes * 2**20)


def unregister() -> None:
    """Takes it back, in the opposite order."""
    bpy.utils.unregister_class(SaddlebackPreferences)

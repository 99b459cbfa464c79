# SPDX-License-Identifier: GPL-3.0-or-later
"""Preferences: threads, device, what is kept in memory and on disk, and what the native library is and sees."""

from __future__ import annotations

from pathlib import Path

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty

from . import compat
from .core import cache, devices, native
from .core.disk_cache import DiskCache

DEFAULT_DISK_MEGABYTES = 4096


def _resize_cache(preferences: bpy.types.AddonPreferences, _context: bpy.types.Context) -> None:
    cache.shared.resize(preferences.cache_megabytes * 2**20)


def _choose_device(preferences: bpy.types.AddonPreferences, _context: bpy.types.Context) -> None:
    devices.choose(preferences.device, preferences.cuda_index)


class SaddlebackPreferences(bpy.types.AddonPreferences):
    """Holds the settings of the whole computer rather than for one file."""

    bl_idname = __package__

    __annotations__ = {
        "threads": IntProperty(
            name="Threads", description="Processor threads to compute with; 0 means all", default=0, min=0, max=1024
        ),
        "device": EnumProperty(
            name="Device",
            description="What builds the distance graphs; the result does not depend on it",
            items=[
                (devices.AUTO, "Automatic", "A CUDA device where there is one and the mesh is large enough"),
                (devices.CPU, "Processor", "The processor only"),
                (devices.CUDA, "CUDA", "A CUDA device; where it fails, the processor"),
            ],
            default=devices.AUTO,
            update=_choose_device,
        ),
        "cuda_index": IntProperty(
            name="CUDA Device", description="Which of several", default=0, min=0, max=63, update=_choose_device
        ),
        "cache_megabytes": IntProperty(
            name="Cache",
            description="Memory (MB) for meshes, distance graphs and results kept for the next run",
            default=2048,
            min=0,
            soft_max=65536,
            update=_resize_cache,
        ),
        "cache_on_disk": BoolProperty(
            name="Keep Graphs on Disk",
            description="Keep every mesh's distance graph for the next session, not only where an object asks for it",
            default=False,
        ),
        "cache_folder": StringProperty(
            name="Folder",
            description="Where distance graphs are kept; empty means a folder of Blender's own for this user",
            subtype="DIR_PATH",
        ),
        "disk_megabytes": IntProperty(
            name="Disk Space",
            description="Space (MB) for distance graphs on disk; those not used for longest go first",
            default=DEFAULT_DISK_MEGABYTES,
            min=0,
            soft_max=65536,
        ),
    }

    def draw(self, _context: bpy.types.Context) -> None:
        """Draws the preferences."""
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "threads")
        layout.prop(self, "device")
        if self.device == devices.CUDA:
            layout.prop(self, "cuda_index")
        if self.device != devices.CPU:
            layout.label(text=devices.status(), icon="BLANK1")
        layout.prop(self, "cache_megabytes")
        layout.prop(self, "cache_on_disk")
        layout.prop(self, "cache_folder")
        layout.prop(self, "disk_megabytes")
        layout.operator("saddleback.add_asset_library", icon="ASSET_MANAGER")
        problem = native.problem()
        row = layout.row()
        row.alert = bool(problem)
        row.label(text=problem or native.description(), icon="ERROR" if problem else "INFO")


def threads(context: bpy.types.Context) -> int:
    """The number of threads to compute with, 0 = all."""
    addon = context.preferences.addons.get(__package__)
    return int(addon.preferences.threads) if addon is not None and addon.preferences is not None else 0


def disk_cache(context: bpy.types.Context, wanted: bool) -> DiskCache | None:
    """The folder of distance graphs, where an object or the preferences want it."""
    addon = context.preferences.addons.get(__package__)
    own = addon.preferences if addon is not None else None
    if not wanted and (own is None or not own.cache_on_disk):
        return None
    folder = bpy.path.abspath(own.cache_folder) if own is not None and own.cache_folder else compat.user_folder()
    megabytes = own.disk_megabytes if own is not None else DEFAULT_DISK_MEGABYTES
    return DiskCache(Path(folder), megabytes * 2**20)


def register() -> None:
    """Makes everything of this module known to Blender."""
    bpy.utils.register_class(SaddlebackPreferences)
    addon = bpy.context.preferences.addons.get(__package__)
    if addon is not None and addon.preferences is not None:
        cache.shared.resize(addon.preferences.cache_megabytes * 2**20)
        devices.choose(addon.preferences.device, addon.preferences.cuda_index)


def unregister() -> None:
    """Takes it back, in the opposite order."""
    bpy.utils.unregister_class(SaddlebackPreferences)

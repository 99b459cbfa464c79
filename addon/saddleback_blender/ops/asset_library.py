# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.add_asset_library`: writes the node groups to a file of assets and tells Blender of it."""

from __future__ import annotations

from pathlib import Path

import bpy

from .. import compat
from ..assets import groups, library


class SADDLEBACK_OT_add_asset_library(bpy.types.Operator):
    """Adds node groups for cells to the asset browser and to the menus of modifiers and nodes."""

    bl_idname = "saddleback.add_asset_library"
    bl_label = "Add Node Assets"
    bl_description = (
        "Add node groups for panels, pebbles, tubes, dots, scales and colors to the asset browser. "
        "They work on what Tessellate writes, also where this add-on is not installed"
    )
    bl_options = {"REGISTER"}

    def execute(self, _context: bpy.types.Context) -> set[str]:
        """Writes the file anew and adds its folder to the preferences once."""
        folder = Path(compat.user_folder("assets"))
        try:
            library.write(folder)
        except OSError as error:
            self.report({"ERROR"}, f"The assets cannot be written to '{folder}': {error.strerror or error}")
            return {"CANCELLED"}
        library.register(folder)
        self.report({"INFO"}, f"{len(groups.ASSETS)} node groups in the asset library '{library.LIBRARY}'")
        return {"FINISHED"}


CLASSES = (SADDLEBACK_OT_add_asset_library,)

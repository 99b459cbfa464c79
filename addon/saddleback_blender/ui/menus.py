# SPDX-License-Identifier: GPL-3.0-or-later
"""Object > Saddleback, which Blender's search finds, too, and pages of the manual for the buttons' context menus."""

from __future__ import annotations

import bpy

# Its owner is that of pyproject.toml: docs/releasing.md, step 1.
MANUAL = "https://github.com/OWNER/saddleback/blob/main/docs/manual/"
PAGES = {
    "tessellate": "tessellation.md",
    "relax_live": "tessellation.md",
    "edit_sites": "tessellation.md",
    "distance": "distance.md",
    "path": "distance.md",
    "ribbon": "ribbon.md",
    "voronoi_2d": "voronoi_2d.md",
    "stipple_image": "voronoi_2d.md",
    "direction_field": "direction_field.md",
    "draw_strokes": "direction_field.md",
    "add_singularity": "direction_field.md",
    "distribute": "shapes.md",
    "check_distribution": "shapes.md",
    "make_real": "shapes.md",
    "paint_density": "tessellation.md",
    "bake": "bake.md",
    "repair": "repair.md",
    "layer_": "layers.md",
    "region_": "layers.md",
    "barriers_": "layers.md",
}
# Of settings on objects, by the group that they are in.
GROUPS = {
    "SaddlebackTessellateProps": "tessellation.md",
    "SaddlebackDistanceProps": "distance.md",
    "SaddlebackPathProps": "distance.md",
    "SaddlebackRibbonProps": "ribbon.md",
    "SaddlebackVoronoi2dProps": "voronoi_2d.md",
    "SaddlebackDirectionFieldProps": "direction_field.md",
    "SaddlebackDistributeProps": "shapes.md",
    "SaddlebackBakeProps": "bake.md",
    "SaddlebackRepairProps": "repair.md",
    "SaddlebackLayer": "layers.md",
}
# None is a line between groups.
ENTRIES = (
    ("tessellate", "MOD_EXPLODE"),
    ("relax_live", "PLAY"),
    ("edit_sites", "EDITMODE_HLT"),
    ("voronoi_2d", "MESH_GRID"),
    None,
    ("distance", "DRIVER_DISTANCE"),
    ("path", "CURVE_PATH"),
    ("ribbon", "MOD_CURVE"),
    None,
    ("direction_field", "FORCE_WIND"),
    ("distribute", "STICKY_UVS_DISABLE"),
    ("bake", "TEXTURE"),
    None,
    ("layer_add", "ADD"),
    ("layer_duplicate", "DUPLICATE"),
    ("layer_freeze", "FREEZE"),
    ("layer_delete", "TRASH"),
    ("region_from_selection", "FACESEL"),
    ("barriers_from_selection", "EDGESEL"),
    None,
    ("repair", "TOOL_SETTINGS"),
    ("hide_source", "HIDE_OFF"),
    ("clear", "TRASH"),
)


class SADDLEBACK_MT_object(bpy.types.Menu):
    """All that runs on the active object, with the settings that it keeps."""

    bl_label = "Saddleback"
    bl_idname = "SADDLEBACK_MT_object"

    def draw(self, _context: bpy.types.Context) -> None:
        """Draws the menu."""
        for entry in ENTRIES:
            if entry is None:
                self.layout.separator()
            else:
                self.layout.operator(f"saddleback.{entry[0]}", icon=entry[1])


def draw_menu(menu: bpy.types.Menu, _context: bpy.types.Context) -> None:
    """Draws the entry in the menu Object."""
    menu.layout.separator()
    menu.layout.menu(SADDLEBACK_MT_object.bl_idname)


def draw_image_entry(menu: bpy.types.Menu, _context: bpy.types.Context) -> None:
    """Draws the entry in the menu Add > Image."""
    menu.layout.operator("saddleback.stipple_image", icon="STICKY_UVS_DISABLE")


def manual_map() -> tuple[str, tuple[tuple[str, str], ...]]:
    """Returns where the pages are, and the page of each operator and setting."""
    operators = tuple((f"bpy.ops.saddleback.{name}*", page) for name, page in PAGES.items())
    settings = tuple((f"bpy.types.{name.lower()}.*", page) for name, page in GROUPS.items())
    return MANUAL, (*operators, *settings, ("bpy.ops.saddleback.*", "README.md"))


def register() -> None:
    """Makes everything of this module known to Blender."""
    bpy.utils.register_class(SADDLEBACK_MT_object)
    bpy.types.VIEW3D_MT_object.append(draw_menu)
    bpy.types.VIEW3D_MT_image_add.append(draw_image_entry)
    bpy.utils.register_manual_map(manual_map)


def unregister() -> None:
    """Takes it back, in the opposite order."""
    bpy.utils.unregister_manual_map(manual_map)
    bpy.types.VIEW3D_MT_image_add.remove(draw_image_entry)
    bpy.types.VIEW3D_MT_object.remove(draw_menu)
    bpy.utils.unregister_class(SADDLEBACK_MT_object)

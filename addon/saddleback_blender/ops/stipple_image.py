# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.stipple_image`: an image file as ink dots on a sheet of paper, in one go."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import numpy as np
from bpy.props import BoolProperty, IntProperty, StringProperty
from mathutils import Matrix

from .. import jobs
from ..finishes import ground_of

LONG_SIDE = 2.0  # of the paper, in world units: as large as what else Blender adds
UPRIGHT = Matrix.Rotation(np.pi / 2, 4, "X")  # where no view says how to face it


class SADDLEBACK_OT_stipple_image(bpy.types.Operator):
    """Adds a stippled image."""

    bl_idname = "saddleback.stipple_image"
    bl_label = "Stipple Image"
    bl_description = "Add a sheet that faces the view, with dots close together where an image is dark"
    bl_options = {"REGISTER", "UNDO"}
    __annotations__ = {
        "filepath": StringProperty(name="File", subtype="FILE_PATH", options={"SKIP_SAVE"}),
        "filter_image": BoolProperty(default=True, options={"HIDDEN", "SKIP_SAVE"}),
        "filter_folder": BoolProperty(default=True, options={"HIDDEN", "SKIP_SAVE"}),
        "count": IntProperty(name="Dots", description="How many dots there are", default=6000, min=1, soft_max=50_000),
    }

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether an object can be added now."""
        if context.mode != "OBJECT" or jobs.state.task is not None:
            cls.poll_message_set("An object can be added in Object Mode, while nothing is computed")
            return False
        return True

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Asks for the file, beside the one that is open."""
        if not self.properties.filepath:
            self.filepath = bpy.path.abspath("//")
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Adds all of it or nothing."""
        path = Path(bpy.path.abspath(self.filepath))
        if not self.filepath or not path.is_file():
            self.report({"ERROR"}, f"'{path.name}' is no file: choose an image" if self.filepath else "Choose an image")
            return {"CANCELLED"}
        before = set(bpy.data.images)
        try:
            image = bpy.data.images.load(str(path), check_existing=True)
        except RuntimeError as error:
            self.report({"ERROR"}, f"'{path.name}' cannot be read as an image: {error}")
            return {"CANCELLED"}
        sheet, last = None, context.view_layer.objects.active
        try:
            width, height = image.size
            if not width or not height:
                raise RuntimeError(f"'{path.name}' cannot be read as an image: it has no pixels")
            sheet = _new_sheet(context, path.stem, np.array([width, height]) / max(width, height) * LONG_SIDE)
            bpy.ops.saddleback.voronoi_2d(
                space="OUTLINE", sites_source="IMAGE", image_name=image.name, count=self.count, iterations=30,
                make_edges=False, make_cells=False, make_centers=True, instance_dots=True, instance_size="TONE",
                lengths="RELATIVE",
            )  # fmt: skip
        except RuntimeError as error:
            self.report({"ERROR"}, str(error).removeprefix("Error: ").strip())
            if sheet is not None:
                bpy.data.meshes.remove(sheet.data)
                context.view_layer.objects.active = last
            if image not in before:
                bpy.data.images.remove(image)
            return {"CANCELLED"}
        _look_at(context)
        return {"FINISHED"}


def _look_at(context: bpy.types.Context) -> None:
    """Shows what was added as large as the view is: from afar dots are a gray."""
    if context.area is not None and context.area.type == "VIEW_3D":
        region = next(region for region in context.area.regions if region.type == "WINDOW")
        with context.temp_override(region=region):
            bpy.ops.view3d.view_selected()


def _new_sheet(context: bpy.types.Context, name: str, size: np.ndarray[Any, Any]) -> bpy.types.Object:
    """A rectangle of paper at the 3D cursor, which faces the view; it is selected and active."""
    mesh = bpy.data.meshes.new(name)
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * size / 2
    mesh.from_pydata(np.column_stack([corners, np.zeros(4)]).tolist(), [], [(0, 1, 2, 3)])
    mesh.uv_layers.new().data.foreach_set("uv", np.array([0, 0, 1, 0, 1, 1, 0, 1], np.float32))
    mesh.materials.append(ground_of("STIPPLE"))
    sheet = bpy.data.objects.new(name, mesh)
    context.collection.objects.link(sheet)
    view = context.region_data
    turn = view.view_rotation.to_matrix().to_4x4() if isinstance(view, bpy.types.RegionView3D) else UPRIGHT
    sheet.matrix_world = Matrix.Translation(context.scene.cursor.location) @ turn
    for other in context.selected_objects:
        other.select_set(False)
    sheet.select_set(True)
    context.view_layer.objects.active = sheet
    context.view_layer.update()
    return sheet


CLASSES = (SADDLEBACK_OT_stipple_image,)

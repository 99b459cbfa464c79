# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.clear`: removes what the other operators made for the active object, and nothing else."""

from __future__ import annotations

import bpy

from .. import jobs, rollback
from ..bridge.inputs.source import active_object, usable_source, why_not
from ..bridge.outputs import hand_edits
from ..bridge.outputs.out_collection import clear_outputs
from ..bridge.outputs.out_looks import BY_HAND, hide, is_hidden, set_stage, show
from ..bridge.outputs.preview import hide_preview
from ..bridge.outputs.solid_colors import BY_ATTRIBUTE, BY_MATERIAL, hide_colors, is_colored
from ..bridge.tokens import ROLE
from ..core.errors import BadInputError
from ..looks import NO_LOOK
from ..props import forget_texts


class SADDLEBACK_OT_clear(bpy.types.Operator):
    """Removes outputs."""

    bl_idname = "saddleback.clear"
    bl_label = "Clear"
    bl_description = "Remove the objects and attributes that Saddleback made for the active object"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether the button can be pressed; says why not."""
        problem = why_not(context)
        if problem:
            cls.poll_message_set(problem)
        return not problem

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Computes and writes before it returns: scripts and the redo panel."""
        try:
            source = usable_source(context)
        except BadInputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        hand_edits.notes()  # of what was taken back
        with rollback.all_or_nothing():
            set_stage(source, NO_LOOK)
            removed = hide_preview(source) + clear_outputs(context, source)
            forget_texts(source)
        if not any(ROLE in item for item in bpy.data.objects):
            hide_colors(context.space_data)
        if jobs.state.needs_repair == source.name:
            jobs.state.needs_repair = ""
        jobs.state.line = ""
        jobs.state.figures = []
        for note in hand_edits.notes():
            self.report({"WARNING"}, note)
        self.report({"INFO"}, f"'{source.name}': {removed} outputs removed" if removed else "Nothing to clear")
        return {"FINISHED"} if removed else {"CANCELLED"}


class SADDLEBACK_OT_hide_source(bpy.types.Operator):
    """Shows outputs alone."""

    bl_idname = "saddleback.hide_source"
    bl_label = "Hide Source"
    bl_description = "Show the active object as a box, and not in renders, to see what was made of it; or show it again"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether the button can be pressed."""
        return active_object(context) is not None

    def execute(self, context: bpy.types.Context) -> set[str]:
        """It stays where it can be worked on, as a box."""
        source = active_object(context)
        with rollback.all_or_nothing():
            if is_hidden(source):
                show(source)
            else:
                hide(source, BY_HAND)
        return {"FINISHED"}


class SADDLEBACK_OT_show_colors(bpy.types.Operator):
    """Shows colors in Solid view."""

    bl_idname = "saddleback.show_colors"
    bl_label = "Show Colors"
    bl_description = "Show the color of each cell and shape in Solid view, or the one of each material"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether there is a view."""
        return isinstance(context.space_data, bpy.types.SpaceView3D)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """It is the view's own setting, as Viewport Shading has it."""
        space = context.space_data
        space.shading.color_type = BY_MATERIAL if is_colored(space) else BY_ATTRIBUTE
        return {"FINISHED"}


CLASSES = (SADDLEBACK_OT_clear, SADDLEBACK_OT_hide_source, SADDLEBACK_OT_show_colors)

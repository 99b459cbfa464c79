# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.export_stl` and `saddleback.export_3mf`: the lamp shell as a file for 3D printers."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
from bpy.props import StringProperty

from .. import compat
from ..bridge.inputs.mesh_in import modified, read_triangles
from ..bridge.inputs.source import active_object
from ..bridge.outputs.out_collection import find_output
from ..bridge.outputs.out_shell import SHELL_ROLE
from ..core.lengths import millimeter
from ..core.results import Indices, Reals
from ..core.solids.stl import stl_bytes
from ..core.solids.three_mf import three_mf_bytes


def _properties(ending: str) -> dict[str, object]:
    return {
        "filepath": StringProperty(name="File", subtype="FILE_PATH", options={"SKIP_SAVE"}),
        "filter_glob": StringProperty(default=f"*{ending}", options={"HIDDEN", "SKIP_SAVE"}),
    }


class ExportOperator:
    """Mixin: writes what can be printed."""

    ending: str
    written: Callable[[Reals, Indices], bytes]
    filepath: str
    report: Callable[..., None]
    poll_message_set: Callable[..., None]

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether there is anything to print."""
        item = active_object(context)
        if item is None or find_output(item, SHELL_ROLE) is None:
            cls.poll_message_set("The active object has no lamp shell; press Tessellate with Lamp Shell on")
            return False
        return True

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Asks for the file."""
        self.filepath = self.filepath or f"{bpy.path.clean_name(active_object(context).name)} Lamp{self.ending}"
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Writes the file whole or not at all."""
        shell = find_output(active_object(context), SHELL_ROLE)
        if not self.filepath:
            self.report({"ERROR"}, "Name a file to save the lamp shell in")
            return {"CANCELLED"}
        # A link stays one: what it leads to is replaced.
        path = Path(os.path.realpath(bpy.path.ensure_ext(bpy.path.abspath(self.filepath), self.ending)))
        points, triangles = _solid(context, shell)
        part = path.with_name(path.name + ".part")
        try:
            part.write_bytes(type(self).written(points, triangles))
            os.replace(part, path)
        except OSError as error:
            part.unlink(missing_ok=True)
            self.report({"ERROR"}, f"'{path.name}' cannot be saved: {error.strerror}")
            return {"CANCELLED"}
        size = " x ".join(f"{side:.4g}" for side in np.ptp(points, axis=0))
        self.report({"INFO"}, f"Saved '{path.name}': {size} mm, {len(triangles):,} faces")
        return {"FINISHED"}


class SADDLEBACK_OT_export_stl(ExportOperator, bpy.types.Operator):
    """Writes an STL file."""

    bl_idname = "saddleback.export_stl"
    bl_label = "Export STL"
    bl_description = "Save the lamp shell of the active object for a 3D printer, in millimeters by the scene's units"
    bl_options = {"REGISTER"}
    ending, written = ".stl", staticmethod(stl_bytes)
    __annotations__ = _properties(".stl")


class SADDLEBACK_OT_export_3mf(ExportOperator, bpy.types.Operator):
    """Writes a 3MF file."""

    bl_idname = "saddleback.export_3mf"
    bl_label = "Export 3MF"
    bl_description = "Save the lamp shell of the active object as 3MF, which says itself that it is in millimeters"
    bl_options = {"REGISTER"}
    ending, written = ".3mf", staticmethod(three_mf_bytes)
    __annotations__ = _properties(".3mf")


def _solid(context: bpy.types.Context, item: bpy.types.Object) -> tuple[Reals, Indices]:
    """Points (n, 3) in millimeters and triangles of an object with its modifiers, also where it is hidden."""
    with modified(context, item) as (shown, mesh):
        places, triangles, world = (
            compat.read_positions(mesh),
            read_triangles(mesh).copy(),
            np.array(shown.matrix_world),
        )
    if np.linalg.det(world[:3, :3]) < 0:  # mirrored: the outside stays outside
        triangles = triangles[:, ::-1]
    return (places @ world[:3, :3].T + world[:3, 3]) / millimeter(compat.unit_scale(context.scene)), triangles


CLASSES = (SADDLEBACK_OT_export_stl, SADDLEBACK_OT_export_3mf)

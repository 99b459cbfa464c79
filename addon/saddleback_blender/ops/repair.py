# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.repair`: makes the active object's mesh one that the others accept, keeping what is painted on it."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import bpy
import numpy as np

from .. import jobs
from ..bridge.inputs.mesh_in import read_surface, read_triangle_polygons, unscaled
from ..bridge.inputs.source import check_own_mesh, shared_mesh_warning
from ..bridge.outputs.repair_mesh import apply_repair, polygon_corners
from ..core.progress import Progress
from ..core.repair_runs import repair
from ..core.results import RepairResult
from ..core.settings import RepairSettings
from ..core.surfaces.repair_plan import plan_repair
from ..props import keep_settings, settings_of
from ..props.repair import REPAIR
from .base import ALL_SELECTED, SurfaceOperator


class SADDLEBACK_OT_repair(SurfaceOperator, bpy.types.Operator):
    """Repairs the mesh."""

    bl_idname = "saddleback.repair"
    bl_label = "Repair"
    bl_description = (
        "Weld, split, orient and drop what keeps the active object's mesh from being a surface, close its cracks and "
        "fill its holes; groups, UVs, colors and materials stay"
    )
    bl_options = {"REGISTER", "UNDO"}
    __annotations__ = REPAIR | ALL_SELECTED

    settings_name = "repair"
    makes_layers = False

    def gather(self, context: bpy.types.Context, source: bpy.types.Object) -> Callable[[Progress], RepairResult]:
        """Reads the mesh as it is, bad numbers included."""
        check_own_mesh(source)
        surface = read_surface(source, source.data, check=False)
        return partial(repair, surface, settings_of(self, RepairSettings))

    def write(self, context: bpy.types.Context, source: bpy.types.Object, result: RepairResult) -> str:
        """Changes the mesh in place, or nothing where nothing is wrong."""
        keep_settings(settings_of(self, RepairSettings), "repair", source)
        jobs.state.needs_repair = ""
        warning = shared_mesh_warning(source)
        if not result.changes or not _apply(source, result):
            made = (
                " in its own mesh; to repair what its modifiers make, apply them first"
                if _has_modifiers(source)
                else ""
            )
            return f"'{source.name}': nothing to repair{made}"
        if warning:
            self.report({"WARNING"}, warning)
        return f"'{source.name}': {result.text}"

    def notes(self, result: RepairResult) -> list[str]:
        """Returns what is left, and which setting would mend it."""
        return list(result.advice)

    figures = notes


def _has_modifiers(source: bpy.types.Object) -> bool:
    """Tells whether what is seen is not, or not only, the object's own mesh."""
    return any(modifier.show_viewport for modifier in source.modifiers)


def _apply(source: bpy.types.Object, result: RepairResult) -> bool:
    """Changes the mesh; False where there was nothing to change."""
    surface = read_surface(source, source.data, check=False)
    used = np.arange(surface.vertex_count, dtype=np.int32) if surface.used is None else surface.used
    plan = plan_repair(
        used[surface.triangles],
        read_triangle_polygons(source.data),
        polygon_corners(source.data),
        result.vertices,
        result.triangles,
        surface.spread(result.vertex_map, -1),
        result.face_map,
        result.filled,
    )
    if plan.changes_nothing:
        return False
    # A vertex left in its place keeps its coordinates to the bit: only the others go through the inverse.
    before = surface.vertices[surface.compact(plan.vertex_origin)]
    moved = np.nonzero(~plan.vertex_is_copy & (before != result.vertices).any(axis=1))[0]
    places = unscaled(source, result.vertices)
    mirrored = source.matrix_world.determinant() < 0
    triangles = result.triangles[:, ::-1] if mirrored else result.triangles
    apply_repair(source, plan, places, moved.astype(np.int32), triangles)
    return True


CLASSES = (SADDLEBACK_OT_repair,)

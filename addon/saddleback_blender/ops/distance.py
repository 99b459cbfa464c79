# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.distance`: how far every vertex is from the nearest source, along the surface."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import bpy
import numpy as np

from .. import prefs
from ..bridge.inputs.mesh_in import mesh_of
from ..bridge.inputs.region_in import read_part
from ..bridge.inputs.sites import read_sources
from ..bridge.inputs.source import shared_mesh_warning
from ..bridge.outputs.out_attributes import write_vertex_attributes
from ..bridge.outputs.out_curves import ISOLINES_ROLE, write_isolines
from ..bridge.outputs.output_surface import check_attribute_names, output_surface
from ..bridge.outputs.preview import hide_preview, show_preview
from ..core import runs
from ..core.progress import Progress
from ..core.requests import DistanceRequest
from ..core.results import DistanceResult
from ..core.settings import DistanceSettings
from ..core.solids.level_lines import isoline_spacing
from ..props import keep_settings, settings_of
from ..props.distance import DISTANCE
from .base import ALL_SELECTED, SurfaceOperator


class DistanceOperator(SurfaceOperator):
    """Mixin: measures distances."""

    settings_name = "distance"

    def gather(self, context: bpy.types.Context, source: bpy.types.Object) -> Callable[[Progress], DistanceResult]:
        """Reads everything from Blender."""
        settings = settings_of(self, DistanceSettings)
        check_attribute_names(
            source, {"distance_attribute": settings.distance_attribute}, {"distance_attribute": "FLOAT"}
        )
        with mesh_of(context, source, settings.use_modifiers) as mesh:
            surface = read_part(source, mesh, settings)
            request = DistanceRequest(
                surface=surface,
                settings=self.measured(settings, surface),
                sources=read_sources(context, source, mesh, settings),
                threads=prefs.threads(context),
                disk=prefs.disk_cache(context, settings.cache_on_disk),
            )
        return partial(runs.distance, request)

    def write(self, context: bpy.types.Context, source: bpy.types.Object, result: DistanceResult) -> str:
        """Writes the result into Blender."""
        chosen = settings_of(self, DistanceSettings)
        settings = replace(chosen, **self._lengths)
        warning = shared_mesh_warning(source)
        follower = self.follower(context, source)
        aside = ("LIFT" if settings.make_preview else "HIDE") if self._is_by_hand else ""
        surface = output_surface(context, source, settings.use_modifiers, aside, follower)
        distances = result.vertex_distance
        write_vertex_attributes(surface, {settings.distance_attribute: distances.astype(np.float32)})
        reached = np.isfinite(distances)
        farthest = float(distances[reached].max(initial=0.0))
        if result.isolines is not None:
            write_isolines(context, source, result.isolines, settings.isoline_radius, follower)
        else:
            self.drop(source, ISOLINES_ROLE)
        if settings.make_preview:
            spacing = isoline_spacing(settings, farthest) if settings.preview_lines else 0.0
            show_preview(surface, settings.distance_attribute, distances, farthest, spacing)
        else:
            hide_preview(surface)
        keep_settings(chosen, "distance", source)
        if warning:
            self.report({"WARNING"}, warning)
        lines = "" if result.isolines is None else f", {_count(len(set(result.isolines.level)), 'isoline')}"
        beyond = "" if reached.all() or settings.limit > 0 else f"; no way to the other {int((~reached).sum())}"
        return f"'{source.name}': {int(reached.sum())} vertices reached, the farthest at {farthest:.4g}{lines}{beyond}"


class SADDLEBACK_OT_distance(DistanceOperator, bpy.types.Operator):
    """Measures distances."""

    bl_idname = "saddleback.distance"
    bl_label = "Distance"
    bl_description = "Measure along the surface how far each vertex of the active object is from the nearest source"
    bl_options = {"REGISTER", "UNDO"}
    __annotations__ = DISTANCE | ALL_SELECTED


def _count(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


CLASSES = (SADDLEBACK_OT_distance,)

# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.ribbon`: an image, a text or a mesh along curves on the surface, as one mesh object."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import bpy

from .. import prefs
from ..bridge.inputs.curves_in import read_curves
from ..bridge.inputs.mesh_in import mesh_of
from ..bridge.inputs.region_in import read_part
from ..bridge.inputs.ribbon_in import read_laid, read_picture
from ..bridge.outputs.out_ribbon import write_ribbon
from ..core import ribbon_runs
from ..core.progress import Progress
from ..core.requests import RibbonRequest
from ..core.ribbon_runs import RibbonResult
from ..core.settings import RibbonSettings
from ..core.shapes.shape_templates import Picture
from ..props import keep_settings, settings_of
from ..props.ribbon import RIBBON
from .base import SurfaceOperator

WELL_COVERED = 0.97  # of a band, and of half its width; what is less is told


class RibbonOperator(SurfaceOperator):
    """Mixin: lays ribbons."""

    settings_name = "ribbon"
    _picture: Picture | None = None

    def gather(self, context: bpy.types.Context, source: bpy.types.Object) -> Callable[[Progress], RibbonResult]:
        """Reads everything from Blender."""
        settings = settings_of(self, RibbonSettings)
        with mesh_of(context, source, settings.use_modifiers) as mesh:
            surface = read_part(source, mesh, settings)
        self._picture = picture = read_picture(source, settings)
        request = RibbonRequest(
            surface=surface,
            settings=self.measured(settings, surface),
            curves=read_curves(source, settings.curves_object, settings.curves_collection, "to lay a ribbon along"),
            aspect=picture.columns / picture.rows if picture is not None else 1.0,
            solid=read_laid(context, source, settings),
            threads=prefs.threads(context),
        )
        return partial(ribbon_runs.ribbons, request)

    def write(self, context: bpy.types.Context, source: bpy.types.Object, result: RibbonResult) -> str:
        """Writes the result into Blender."""
        chosen = settings_of(self, RibbonSettings)
        settings = replace(chosen, **self._lengths)
        write_ribbon(context, source, result, settings, self._picture, self.follower(context, source))
        keep_settings(chosen, "ribbon", source)
        return f"'{source.name}': {_told(result)}"


class SADDLEBACK_OT_ribbon(RibbonOperator, bpy.types.Operator):
    """Lays ribbons."""

    bl_idname = "saddleback.ribbon"
    bl_label = "Ribbon"
    bl_description = "Lay a band, an image, a text or a mesh along curves on the surface of the active object"
    bl_options = {"REGISTER", "UNDO"}
    __annotations__ = dict(RIBBON)


def _told(result: RibbonResult) -> str:
    lengths = result.lengths
    if len(lengths) == 1:
        told = f"ribbon of length {lengths[0]:.4g}"
    else:
        told = f"{len(lengths)} ribbons of lengths {lengths.min():.4g} to {lengths.max():.4g}"
    if result.coverage < WELL_COVERED:
        told += f", {100 * result.coverage:.0f} % of the band is on it: where curves bend more, there is no room"
    if result.reach < WELL_COVERED:
        told += f", wider than the surface: of half the width, {100 * result.reach:.0f} % is on it on one side"
    return told


CLASSES = (SADDLEBACK_OT_ribbon,)

# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.path`: the shortest ways between points, along the surface, as a curve object."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import bpy

from .. import prefs
from ..bridge.inputs.mesh_in import mesh_of
from ..bridge.inputs.region_in import read_part
from ..bridge.inputs.sites import read_path_points
from ..bridge.outputs.out_curves import write_paths
from ..core import path_runs
from ..core.progress import Progress
from ..core.requests import PathRequest
from ..core.results import PathsResult
from ..core.settings import PathSettings
from ..props import keep_settings, settings_of
from ..props.path import PATH
from .base import SurfaceOperator


class PathOperator(SurfaceOperator):
    """Mixin: finds paths."""

    settings_name = "path"

    def gather(self, context: bpy.types.Context, source: bpy.types.Object) -> Callable[[Progress], PathsResult]:
        """Reads everything from Blender."""
        settings = settings_of(self, PathSettings)
        with mesh_of(context, source, settings.use_modifiers) as mesh:
            surface = read_part(source, mesh, settings)
            request = PathRequest(
                surface=surface,
                settings=self.measured(settings, surface),
                points=read_path_points(context, source, mesh, settings),
                threads=prefs.threads(context),
                disk=prefs.disk_cache(context, settings.cache_on_disk),
            )
        return partial(path_runs.paths, request)

    def write(self, context: bpy.types.Context, source: bpy.types.Object, result: PathsResult) -> str:
        """Writes the result into Blender."""
        chosen = settings_of(self, PathSettings)
        settings = replace(chosen, **self._lengths)
        write_paths(context, source, result, settings.path_radius, settings.lift, self.follower(context, source))
        keep_settings(chosen, "path", source)
        return f"'{source.name}': {_told(result)}"


class SADDLEBACK_OT_path(PathOperator, bpy.types.Operator):
    """Finds paths."""

    bl_idname = "saddleback.path"
    bl_label = "Path"
    bl_description = "Find the shortest way along the surface of the active object from point to point, as a curve"
    bl_options = {"REGISTER", "UNDO"}
    __annotations__ = dict(PATH)


def _told(result: PathsResult) -> str:
    lengths = result.lengths
    if len(lengths) == 1:
        return f"{'loop' if result.closed[0] else 'path'} of length {lengths[0]:.4g}"
    return f"{len(lengths)} paths of lengths {lengths.min():.4g} to {lengths.max():.4g}, {lengths.sum():.4g} in all"


CLASSES = (SADDLEBACK_OT_path,)

# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.direction_field`: which way things shall point, all over the surface."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import bpy
import numpy as np

from ..bridge.inputs.directions_in import read_painted
from ..bridge.inputs.mesh_in import mesh_of, read_triangle_polygons
from ..bridge.inputs.region_in import read_part
from ..bridge.inputs.singularities_in import read_singularities
from ..bridge.inputs.source import shared_mesh_warning
from ..bridge.inputs.strokes_in import read_strokes
from ..bridge.outputs.out_field import ARROWS_ROLE, STREAMLINES_ROLE, write_arrows, write_directions, write_streamlines
from ..bridge.outputs.output_surface import check_attribute_names, output_surface
from ..core import field_runs
from ..core.progress import Progress
from ..core.requests import DirectionFieldRequest, Surface
from ..core.results import FieldResult
from ..core.settings import DirectionFieldSettings
from ..props import keep_settings, kept_settings, settings_of
from ..props.direction_field import DIRECTION_FIELD
from .base import ALL_SELECTED, SurfaceOperator

KINDS = {1: "vectors", 2: "lines", 4: "crosses"}


def own_field(
    context: bpy.types.Context, source: bpy.types.Object, mesh: bpy.types.Mesh, surface: Surface
) -> DirectionFieldRequest:
    """Reads the object's own field, for what follows it."""
    own = kept_settings(source, "direction_field", DirectionFieldSettings)
    return DirectionFieldRequest(
        surface,
        own,
        read_strokes(context, source, own),
        read_singularities(context, source, own),
        painted=read_painted(source, mesh, own),
    )


class FieldOperator(SurfaceOperator):
    """Mixin: makes a field."""

    settings_name = "direction_field"

    def gather(self, context: bpy.types.Context, source: bpy.types.Object) -> Callable[[Progress], FieldResult]:
        """Reads everything from Blender."""
        settings = settings_of(self, DirectionFieldSettings)
        names = {"direction_attribute": settings.direction_attribute}
        check_attribute_names(source, names, {"direction_attribute": "FLOAT_VECTOR"}, settings.domain)
        with mesh_of(context, source, settings.use_modifiers) as mesh:
            surface = read_part(source, mesh, settings)
            request = DirectionFieldRequest(
                surface=surface,
                settings=self.measured(settings, surface),
                strokes=read_strokes(context, source, settings),
                singularities=read_singularities(context, source, settings),
                polygons=read_triangle_polygons(mesh) if settings.domain == "FACE" else None,
                painted=read_painted(source, mesh, settings),
            )
        return partial(field_runs.direction_field, request)

    def write(self, context: bpy.types.Context, source: bpy.types.Object, result: FieldResult) -> str:
        """Writes the result into Blender."""
        chosen = settings_of(self, DirectionFieldSettings)
        settings = replace(chosen, **self._lengths)
        warning = shared_mesh_warning(source)
        follower = self.follower(context, source)
        aside = "HIDE" if self._is_by_hand else ""
        surface = output_surface(context, source, settings.use_modifiers, aside, follower)
        write_directions(source, surface, settings.direction_attribute, result)
        if result.arrows is not None:
            write_arrows(context, source, result, follower)
        else:
            self.drop(source, ARROWS_ROLE)
        if result.streamlines is not None:
            write_streamlines(context, source, result, settings.streamline_radius, follower)
        else:
            self.drop(source, STREAMLINES_ROLE)
        keep_settings(chosen, "direction_field", source)
        if warning:
            self.report({"WARNING"}, warning)
        return f"'{source.name}': {KINDS[result.symmetry]}, {_told(result)}"

    def notes(self, result: FieldResult) -> list[str]:
        """Says which strokes were left out, and where faces are too large for the field."""
        notes = list(result.warnings)
        if result.largest_turn >= math.pi / result.symmetry:
            notes.append("The field turns faster than the faces can show; subdivide the mesh where it is singular")
        return notes


class SADDLEBACK_OT_direction_field(FieldOperator, bpy.types.Operator):
    """Makes a field."""

    bl_idname = "saddleback.direction_field"
    bl_label = "Direction Field"
    bl_description = "Comb the surface of the active object: directions that follow strokes and turn where you say"
    bl_options = {"REGISTER", "UNDO"}
    __annotations__ = DIRECTION_FIELD | ALL_SELECTED


def _told(result: FieldResult) -> str:
    indices = result.singular_indices
    if not len(indices):
        singular = "no singularities"
    else:
        many = "singularity" if len(indices) == 1 else "singularities"
        singular = f"{len(indices)} {many} of index sum {np.sum(indices):.4g}"
    if not result.stroke_count:
        return singular
    return f"{singular}, along {result.stroke_count} stroke{'s' if result.stroke_count > 1 else ''}"


CLASSES = (SADDLEBACK_OT_direction_field,)

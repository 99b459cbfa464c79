# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.distribute`: shapes all over a surface that follow a field and never touch each other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import bpy
import numpy as np

from .. import prefs
from ..bridge.inputs.classes_in import read_classes, read_kept
from ..bridge.inputs.density import read_density, read_vertex_group
from ..bridge.inputs.directions_in import read_directions, read_image_flow, read_painted_flow
from ..bridge.inputs.mesh_in import mesh_of
from ..bridge.inputs.mirror_in import read_mirror
from ..bridge.inputs.region_in import read_part
from ..bridge.inputs.shapes_in import read_templates
from ..bridge.inputs.source import shared_mesh_warning
from ..bridge.outputs.hand_edits import accept
from ..bridge.outputs.out_collection import find_output
from ..bridge.outputs.out_shape_cut import CUT_ROLE, write_cut
from ..bridge.outputs.out_shapes import (
    BENT_ROLE,
    INSTANCES_ROLE,
    OUTLINE_DISTANCE,
    OUTLINES_ROLE,
    SHAPE_ATTRIBUTE,
    SHAPE_UV,
    make_real,
    remove_templates,
    write_bent,
    write_instances,
    write_outlines,
    write_shape_values,
)
from ..bridge.outputs.output_surface import check_attribute_names, output_surface
from ..core import distribute_runs, mirrored_runs
from ..core.errors import BadInputError
from ..core.mirrored_runs import shapes_halved
from ..core.progress import Progress
from ..core.requests import DirectionFieldRequest, DistributeRequest, GivenDirections, Surface
from ..core.results import CheckResult, DistributeResult
from ..core.settings import DistributeSettings
from ..core.shapes.shape_templates import sized
from ..core.surfaces.inside_out import inside_out_of
from ..props import keep_settings, settings_of
from ..props.distribute import DISTRIBUTE
from ..props.layers import suffix_of
from .base import ALL_SELECTED, SurfaceOperator
from .direction_field import own_field
from .paint import HelperOperator


class ShapesOperator(SurfaceOperator):
    """Mixin: lays shapes."""

    settings_name = "distribute"

    def gather(self, context: bpy.types.Context, source: bpy.types.Object) -> Callable[[Progress], DistributeResult]:
        """Reads everything from Blender."""
        settings = settings_of(self, DistributeSettings)
        if settings.write_attributes:
            own = {"shape_attribute": SHAPE_ATTRIBUTE, "distance_attribute": OUTLINE_DISTANCE, "uv": SHAPE_UV}
            names = {label: name + suffix_of(source) for label, name in own.items()}
            types = {"shape_attribute": "INT", "distance_attribute": "FLOAT", "uv": "FLOAT2"}
            check_attribute_names(source, names, types)
        request = _request(self, context, source, settings)
        self._templates = tuple(sized(template) for template in request.templates)
        if settings.mirror_x:
            with mesh_of(context, source, settings.use_modifiers) as mesh:
                mirror = read_mirror(source, mesh, request.surface)
            self._surface = mirror.whole  # on which all of it lies
            return partial(mirrored_runs.distribute, shapes_halved(request, mirror), mirror)
        return partial(distribute_runs.distribute, request)

    def write(self, context: bpy.types.Context, source: bpy.types.Object, result: DistributeResult) -> str:
        """Writes the result into Blender."""
        chosen = settings_of(self, DistributeSettings)
        settings = replace(chosen, **self._lengths)
        warning = shared_mesh_warning(source) if settings.write_attributes else ""
        follower = self.follower(context, source)
        if result.values is not None:
            aside = "HIDE" if self._is_by_hand else ""
            surface = output_surface(context, source, settings.use_modifiers, aside, follower)
            write_shape_values(surface, result, suffix_of(source))
        if result.bent is not None:
            write_bent(context, source, result, self._templates, settings, follower)
        else:
            self.drop(source, BENT_ROLE)
        if settings.make_instances:
            lying = find_output(source, INSTANCES_ROLE) if settings.keep else None
            if lying is not None:
                accept(lying)
            write_instances(context, source, result, self._templates, settings, follower)
        else:
            self.drop(source, INSTANCES_ROLE)
            if find_output(source, INSTANCES_ROLE) is None:
                remove_templates(source)
        if result.outlines is not None:
            write_outlines(context, source, result, settings, follower)
        else:
            self.drop(source, OUTLINES_ROLE)
        if result.cut is not None:
            write_cut(context, source, result, self._templates, settings, follower)
        else:
            self.drop(source, CUT_ROLE)
        keep_settings(chosen, "distribute", source)
        if warning:
            self.report({"WARNING"}, warning)
        return f"'{source.name}': {result.text}"

    def lying(self) -> dict[str, bool]:
        """The cut mesh does."""
        return {CUT_ROLE: True}

    def notes(self, result: DistributeResult) -> list[str]:
        """Returns what went wrong."""
        return [*result.warnings, *inside_out_of(self._surface)]

    def figures(self, result: DistributeResult) -> list[str]:
        """Returns how dense it is, and why no more found room."""
        return list(result.lines)


class SADDLEBACK_OT_distribute(ShapesOperator, bpy.types.Operator):
    """Lays shapes."""

    bl_idname = "saddleback.distribute"
    bl_label = "Distribute Shapes"
    bl_description = "Lay shapes on the surface of the active object: along its direction field, none touching another"
    bl_options = {"REGISTER", "UNDO"}
    __annotations__ = DISTRIBUTE | ALL_SELECTED


class SADDLEBACK_OT_check_distribution(SurfaceOperator, bpy.types.Operator):
    """Checks shapes."""

    bl_idname = "saddleback.check_distribution"
    bl_label = "Check Shapes"
    bl_description = "Lay the same shapes again and check by other mathematics that none touches another"
    bl_options = {"REGISTER"}
    __annotations__ = dict(DISTRIBUTE)

    settings_name = "distribute"
    makes_layers = False

    def gather(self, context: bpy.types.Context, source: bpy.types.Object) -> Callable[[Progress], CheckResult]:
        """Reads everything from Blender."""
        return partial(distribute_runs.check, _request(self, context, source, settings_of(self, DistributeSettings)))

    def write(self, _context: bpy.types.Context, source: bpy.types.Object, result: CheckResult) -> str:
        """Changes nothing; tells."""
        return f"'{source.name}': {result.text}"

    def notes(self, result: CheckResult) -> list[str]:
        """The faults."""
        return list(result.faults)

    def figures(self, result: CheckResult) -> list[str]:
        """Returns what was looked at."""
        return list(result.lines)


class SADDLEBACK_OT_make_real(HelperOperator, bpy.types.Operator):
    """Frees instances."""

    bl_idname = "saddleback.make_real"
    bl_label = "Make Instances Real"
    bl_description = "Turn the instances on the active object into objects of their own"
    bl_options = {"REGISTER", "UNDO"}

    def help(self, context: bpy.types.Context, source: bpy.types.Object) -> str:
        """Makes the objects and removes the instances."""
        item = find_output(source, INSTANCES_ROLE)
        if item is None:
            raise BadInputError(f"'{source.name}' carries no instances; press Distribute Shapes with Instances on")
        count = make_real(context, source, item)
        source.saddleback.distribute.make_instances = False
        return f"'{source.name}': {count} objects"


def _request(
    operator: SurfaceOperator, context: bpy.types.Context, source: bpy.types.Object, settings: DistributeSettings
) -> DistributeRequest:
    """Reads everything from Blender."""
    with mesh_of(context, source, settings.use_modifiers) as mesh:
        surface = read_part(source, mesh, settings)
        templates = read_templates(context, source, settings)
        return DistributeRequest(
            surface=surface,
            settings=operator.measured(settings, surface, settings.count),
            templates=templates,
            classes=read_classes(source, mesh, settings),
            kept=read_kept(source, templates, settings),
            density=read_density(source, mesh, settings),
            field=_read_field(context, source, mesh, settings, surface),
            forbidden=_read_forbidden(source, mesh, settings),
            threads=prefs.threads(context),
            disk=prefs.disk_cache(context, False),
        )


def _read_field(
    context: bpy.types.Context,
    source: bpy.types.Object,
    mesh: bpy.types.Mesh,
    settings: DistributeSettings,
    surface: Surface,
) -> DirectionFieldRequest | GivenDirections | None:
    if settings.field_source == "NONE":
        return None
    if settings.field_source == "ATTRIBUTE":
        return read_directions(source, mesh, settings.direction_attribute)
    if settings.field_source == "COLOR":
        return read_painted_flow(source, mesh, settings.direction_color)
    if settings.field_source == "IMAGE":
        return read_image_flow(source, mesh, settings.direction_image)
    return own_field(context, source, mesh, surface)


def _read_forbidden(source: bpy.types.Object, mesh: bpy.types.Mesh, settings: DistributeSettings) -> np.ndarray | None:
    if not settings.forbidden_group:
        return None
    weights, _ = read_vertex_group(source, mesh, settings.forbidden_group, "choose another group")
    return weights > 0.5


CLASSES = (SADDLEBACK_OT_distribute, SADDLEBACK_OT_check_distribution, SADDLEBACK_OT_make_real)

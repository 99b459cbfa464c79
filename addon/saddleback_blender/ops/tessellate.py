# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.tessellate`: geodesic cells, even ones, and everything that can be made of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import bpy
import numpy as np

from .. import compat, prefs
from ..blocks import find
from ..bridge.inputs.density import read_cell_paint, read_density
from ..bridge.inputs.mesh_in import level_place, mesh_of, read_marks, up_of
from ..bridge.inputs.mirror_in import read_mirror
from ..bridge.inputs.region_in import read_part
from ..bridge.inputs.sites import read_sites
from ..bridge.inputs.source import shared_mesh_warning
from ..bridge.outputs.fewer_faces import with_fewer_faces
from ..bridge.outputs.live_preview import LivePreview
from ..bridge.outputs.out_attributes import write_vertex_attributes
from ..bridge.outputs.out_cells import CELLS_ROLE, write_cells
from ..bridge.outputs.out_centers import CENTERS_ROLE, write_centers
from ..bridge.outputs.out_collection import hair
from ..bridge.outputs.out_dual import DUAL_ROLE, write_dual
from ..bridge.outputs.out_edges import EDGES_ROLE, write_edges
from ..bridge.outputs.out_shell import SHELL_ROLE, write_shell
from ..bridge.outputs.output_surface import check_attribute_names, output_surface
from ..core import mirrored_runs, runs
from ..core.errors import BadInputError
from ..core.figures import (
    cell_faults_of,
    faults_of,
    lines_of,
    lost_of,
    polygon_faults_of,
    shell_faults_of,
    shell_of,
)
from ..core.flowing_cells import FlowingCells
from ..core.lengths import count_for_parts, count_of_size
from ..core.live_cells import LiveCells
from ..core.mirrored_runs import halved
from ..core.progress import Progress
from ..core.requests import CellPaint, Surface, TessellateRequest, content_of
from ..core.results import CellsResult
from ..core.settings import TessellateSettings
from ..core.solids.rib_surface import UPRIGHT
from ..core.standing import with_anchors
from ..core.surfaces.inside_out import inside_out_of
from ..props import existing_group, keep_settings, settings_of
from ..props.kept_sites import keep_sites, kept_cells
from ..props.tessellate import TESSELLATE
from .base import ALL_SELECTED, SurfaceOperator
from .direction_field import own_field

# Sources of density that a brush changes.
PAINTED = ("VERTEX_GROUP", "ATTRIBUTE", "COLOR", "MASK", "SPREAD")
# What the library's reasons to stop mean to a person; that all steps were done needs no word.
ENDS = {
    "tolerance": " until nothing changed",
    "no step lowers the energy": " until nothing got better",
    "least_move": " until nothing moved",
    "cancelled": " until it was stopped",
    "closed_ball": " as far as the dual mesh stayed whole",
}


def read_request(
    context: bpy.types.Context,
    source: bpy.types.Object,
    mesh: bpy.types.Mesh,
    settings: TessellateSettings,
    measured: Callable[[TessellateSettings, Surface, int], TessellateSettings],
) -> TessellateRequest:
    """Reads what cells are made from; `measured` gives the settings' lengths for so many cells."""
    surface = read_part(source, mesh, settings)
    if settings.sites_source == "SIZE":
        settings = replace(settings, sites_source="COUNT", count=count_of_size(surface, settings.cell_size))
    sites = read_sites(context, source, mesh, settings)
    if sites is None:
        settings = replace(settings, count=count_for_parts(surface, settings.count))
    has_mesh = settings.make_cells and not settings.makes_polygons
    marks = read_marks(mesh) if settings.hold_marked or settings.make_dual else None
    settings = measured(settings, surface, settings.count if sites is None else len(sites))
    return TessellateRequest(
        surface=surface,
        settings=settings,
        density=read_density(source, mesh, settings),
        sites=sites,
        marked_edges=marks.edges if marks is not None and settings.hold_marked else None,
        marks=marks,
        paint=read_cell_paint(source, mesh, settings) if has_mesh else CellPaint(),
        field=None if settings.stretch == 1.0 else own_field(context, source, mesh, surface),
        threads=prefs.threads(context),
        disk=prefs.disk_cache(context, settings.cache_on_disk),
        up=up_of(source) if settings.make_shell and settings.base_height > 0.0 else UPRIGHT,
    )


class CellsOperator(SurfaceOperator):
    """Mixin: makes cells."""

    settings_name = "tessellate"
    thickness: float
    cell_faces: str
    density_source: str
    dual_policy: str
    flowing: FlowingCells | None = None  # cells to go on from
    _parts = ""  # why there are more cells than asked for

    def gather(self, context: bpy.types.Context, source: bpy.types.Object) -> Callable[[Progress], CellsResult]:
        """Reads everything from Blender."""
        return self._gather(context, source, None)

    def _gather(
        self, context: bpy.types.Context, source: bpy.types.Object, live: LiveCells | None
    ) -> Callable[[Progress], CellsResult]:
        settings = settings_of(self, TessellateSettings)
        _check(source, settings)
        if settings.mirror_x and settings.makes_patches:
            raise BadInputError(
                f"'{source.name}': patches are not mirrored; switch X Mirror off, or choose One as the cells' Faces"
            )
        if settings.mirror_x and settings.barriers != "NONE":
            raise BadInputError(
                f"'{source.name}': barriers are not mirrored; switch X Mirror off, or choose no barriers"
            )
        with mesh_of(context, source, settings.use_modifiers) as mesh:
            request = read_request(context, source, mesh, settings, self.measured)
            mirror = read_mirror(source, mesh, request.surface) if settings.mirror_x else None
        is_more = request.sites is None and settings.sites_source == "COUNT" and request.settings.count > settings.count
        self._parts = ", so that each part has one" if is_more else ""
        request = replace(request, live=live, flowing=self.flowing)
        kept = kept_cells(source) if self.flowing is not None and existing_group(source, "tessellate") else None
        if self.flowing is not None and kept is not None:
            self.flowing.begin_at(*kept)
        if mirror is not None:
            self._surface = mirror.whole  # on which all of it lies
            run = partial(mirrored_runs.tessellate, halved(request, mirror), mirror)
        else:
            run = partial(runs.tessellate, request)
        return partial(with_anchors, run, self._surface, request.settings)

    def write(self, context: bpy.types.Context, source: bpy.types.Object, result: CellsResult) -> str:
        """Writes the result into Blender."""
        chosen = settings_of(self, TessellateSettings)
        settings = replace(chosen, **self._lengths)
        warning = shared_mesh_warning(source)
        follower = self.follower(context, source)
        if settings.make_centers or settings.make_shell or (settings.make_cells and settings.thickness):
            follower.read()
        aside = "HIDE" if self._is_by_hand else ""
        surface = output_surface(context, source, settings.use_modifiers, aside, follower)
        values: dict[str, np.ndarray[Any, Any]] = {
            settings.cell_attribute: result.vertex_cell.astype(np.int32, copy=False),
            settings.distance_attribute: result.vertex_distance.astype(np.float32),
        }
        if result.vertex_density is not None and _writes_density(settings):
            values[settings.density_attribute] = result.vertex_density.astype(np.float32)
        if result.edge_distance is not None:
            values[settings.edge_distance_attribute] = result.edge_distance.astype(np.float32)
        write_vertex_attributes(surface, values)
        if result.shell is not None:
            result = replace(result, shell=with_fewer_faces(context, result.shell, settings.shell_faces))
        outputs: tuple[tuple[bool, Callable[..., object], str], ...] = (
            (settings.make_edges, write_edges, EDGES_ROLE),
            (settings.make_cells, write_cells, CELLS_ROLE),
            (settings.make_centers, write_centers, CENTERS_ROLE),
            (settings.make_dual, write_dual, DUAL_ROLE),
            (settings.make_shell, write_shell, SHELL_ROLE),
        )
        for wanted, write, role in outputs:
            if wanted:
                write(context, source, result, settings, follower=follower)
            else:
                self.drop(source, role)
        keep_settings(chosen, "tessellate", source)
        keep_sites(source, result.sites_position, result.frame)
        if warning:
            self.report({"WARNING"}, warning)
        shell = "" if result.shell is None else shell_of(result.shell, *_units(context.scene))
        done = f"{_steps(result)}{_lost(result)}{_added(result)}{shell}"
        cells = "1 cell" if result.count == 1 else f"{result.count} cells"
        return f"'{source.name}': {cells}{self._parts}{done}"

    def lying(self) -> dict[str, bool]:
        """Cells without a height do."""
        return {CELLS_ROLE: self.cell_faces != "SURFACE" or not self._lengths.get("thickness", self.thickness)}

    def notes(self, result: CellsResult) -> list[str]:
        """Returns what is wrong with the meshes that were made."""
        cells = [] if result.mesh is None else cell_faults_of(result.mesh)
        dual = [] if result.dual is None else faults_of(result.dual, self.dual_policy)
        polygons = [] if result.polygons is None else polygon_faults_of(result.polygons, self.dual_policy)
        shell = [] if result.shell is None else shell_faults_of(result.shell)
        return [*cells, *polygons, *dual, *shell, *inside_out_of(self._surface)]

    def figures(self, result: CellsResult) -> list[str]:
        """Returns how even the cells are."""
        if result.figures is None and len(result.energy):
            return [f"Energy: {result.energy[-1]:.4g}"]
        return lines_of(result.figures)


class SADDLEBACK_OT_tessellate(CellsOperator, bpy.types.Operator):
    """Makes cells."""

    bl_idname = "saddleback.tessellate"
    bl_label = "Tessellate"
    bl_description = "Cover the surface of the active object with cells of even size, small where the density is high"
    bl_options = {"REGISTER", "UNDO"}
    __annotations__ = TESSELLATE | ALL_SELECTED


class SADDLEBACK_OT_relax_live(CellsOperator, bpy.types.Operator):
    """Makes cells and shows how they become even."""

    bl_idname = "saddleback.relax_live"
    bl_label = "Relax Live"
    bl_description = "Tessellate, and watch the cells become even: ENTER or a click keeps them as they are, ESC stops"
    bl_options = {"REGISTER", "UNDO"}
    __annotations__ = dict(TESSELLATE)

    keys = "ENTER or click: keep    ESC: stop"

    def gather(self, context: bpy.types.Context, source: bpy.types.Object) -> Callable[[Progress], CellsResult]:
        """Reads everything from Blender."""
        is_painting = source.mode in ("WEIGHT_PAINT", "VERTEX_PAINT", "SCULPT") and self.density_source in PAINTED
        self._live = LiveCells(stays=is_painting and self._is_watched)
        self._density, self._source_name = "", source.name
        return self._gather(context, source, self._live)

    def begin_watching(self, context: bpy.types.Context, source: bpy.types.Object) -> None:
        """Begins to show the cells."""
        self._preview = LivePreview(level_place(source), hair(source))
        self._has_news = False
        if self._live.stays:
            bpy.app.handlers.depsgraph_update_post.append(self._note)

    def _note(self, _scene: Any, depsgraph: bpy.types.Depsgraph) -> None:
        self._has_news = True

    def _read_density(self) -> None:
        """Lets cells flow to what was painted since."""
        self._has_news = False
        source, settings = bpy.data.objects.get(self._source_name), settings_of(self, TessellateSettings)
        if source is None:
            return
        try:
            with mesh_of(bpy.context, source, settings.use_modifiers) as mesh:
                painted = read_density(source, mesh, settings)
        except BadInputError:
            return  # what cannot be read is told by the next run
        content = content_of(painted)
        if self._density not in ("", content) and self._task is not None:
            self._live.change_density(painted)
            self._task.progress.settle()
        self._density = content

    def show_newest(self) -> None:
        """Shows the latest cells."""
        if self._live.stays and (self._has_news or not self._density):
            self._read_density()
        step = self._live.newest()
        if step is not None:
            self._preview.show(step.lines)

    def end_watching(self) -> None:
        """Takes the cells away."""
        self._preview.remove()
        if self._note in bpy.app.handlers.depsgraph_update_post:
            bpy.app.handlers.depsgraph_update_post.remove(self._note)

    def keeps(self, context: bpy.types.Context, event: bpy.types.Event) -> bool:
        """ENTER, or a click into a 3D view, where that does not paint."""
        is_kept = _keeps(context, event) and not (self._live.stays and event.type == "LEFTMOUSE")
        if is_kept:
            self._live.keep()
        return is_kept


def _keeps(context: bpy.types.Context, event: bpy.types.Event) -> bool:
    """Tells whether the event asks for the cells as they are: ENTER, or a click into a 3D view, not on its panels."""
    if event.value != "PRESS":
        return False
    if event.type != "LEFTMOUSE":
        return event.type in ("RET", "NUMPAD_ENTER")
    views = [area for area in context.screen.areas if area.type == "VIEW_3D"] if context.screen is not None else []
    return any(
        _is_over(region, event) for area in views for region in area.regions if region.type == "WINDOW"
    ) and not any(_is_over(region, event) for area in views for region in area.regions if region.type != "WINDOW")


def _is_over(region: bpy.types.Region, event: bpy.types.Event) -> bool:
    x, y = event.mouse_x - region.x, event.mouse_y - region.y
    return bool(0 <= x < region.width and 0 <= y < region.height)


def _writes_density(settings: TessellateSettings) -> bool:
    """Tells whether the density used becomes an attribute; not where it was painted under that name."""
    is_named = settings.density_source in ("VERTEX_GROUP", "ATTRIBUTE", "COLOR", "SPREAD")
    is_source = is_named and settings.density_name == settings.density_attribute
    return settings.density_source != "UNIFORM" and not is_source


def _steps(result: CellsResult) -> str:
    if not result.iterations:
        return ", stopped before the first iteration" if result.stop_reason == "cancelled" else ""
    steps = "iteration" if result.iterations == 1 else "iterations"
    return f", {result.iterations} {steps}{ENDS.get(result.stop_reason, '')}"


def _added(result: CellsResult) -> str:
    """Returns what the dual mesh and polygons needed: cells elsewhere, or more of them."""
    if result.dual is None and result.polygons is None:
        return ""
    moved = "1 cell" if result.exchanged == 1 else f"{result.exchanged} cells"
    what = "polygons need" if result.dual is None else "the dual mesh needs"
    text = f", {moved} moved to where {what} them" if result.exchanged else ""
    if result.polygons is not None and result.polygons.is_patches:
        text += f", {len(result.polygons.polygon_cell)} patches"
    elif result.polygons is not None and result.polygons.added:
        text += f", {result.polygons.added} cells added so that all can be polygons"
    if result.dual is not None and result.dual.added:
        text += f", {result.dual.added} vertices added to the dual mesh"
    return text


def _lost(result: CellsResult) -> str:
    return "" if result.mesh is None else lost_of(len(result.mesh.vanished), len(result.mesh.thinner))


def _units(scene: bpy.types.Scene) -> tuple[Callable[[float], str], Callable[[float], str]]:
    """What writes lengths and volumes of the world as the scene's units are."""

    def written(kind: str, power: int, value: float) -> str:
        scaled = value * compat.unit_scale(scene) ** power
        text: str = bpy.utils.units.to_string(scene.unit_settings.system, kind, scaled, precision=3)
        return text.strip()

    return partial(written, "LENGTH", 1), partial(written, "VOLUME", 3)


def _check(source: bpy.types.Object, settings: TessellateSettings) -> None:
    """Refuses names that lead nowhere or would overwrite what they are made from, before anything is computed."""
    names = {"cell_attribute": settings.cell_attribute, "distance_attribute": settings.distance_attribute}
    if _writes_density(settings):
        names["density_attribute"] = settings.density_attribute
    if settings.density_source in ("ATTRIBUTE", "COLOR") and settings.density_name in names.values():
        raise BadInputError(
            f"'{source.name}': the result would overwrite its density '{settings.density_name}'; "
            "choose another name for the attributes that are written"
        )
    if settings.write_edge_distance:
        names["edge_distance_attribute"] = settings.edge_distance_attribute
    types = {name: "INT" if name == "cell_attribute" else "FLOAT" for name in names}
    check_attribute_names(source, names, types)
    if settings.make_centers and settings.instance_object:
        instance = find(bpy.data.objects, settings.instance_object)
        if instance is None:
            raise BadInputError(
                f"'{source.name}': there is no object '{settings.instance_object}' to put on the centers"
            )
        if instance == source:
            raise BadInputError(f"'{source.name}' cannot be put on its own centers; choose another object for them")


CLASSES = (SADDLEBACK_OT_tessellate, SADDLEBACK_OT_relax_live)

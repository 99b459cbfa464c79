# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.voronoi_2d`: Voronoi diagrams of the plane, on flat meshes and on surfaces through their maps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import bpy
import numpy as np

from .. import prefs
from ..blocks import find
from ..bridge.inputs.mesh_in import mesh_of, read_triangle_polygons
from ..bridge.inputs.region_in import read_part
from ..bridge.inputs.voronoi_in import read_circles, read_darkness, read_uv, read_voronoi_sites
from ..bridge.outputs.following import Follower
from ..bridge.outputs.out_cells import write_cells, write_polygons
from ..bridge.outputs.out_centers import write_centers
from ..bridge.outputs.out_edges import write_edges, write_network
from ..bridge.outputs.out_sweep import remove_sweep, write_sweep
from ..core import voronoi_runs
from ..core.errors import BadInputError
from ..core.figures import cell_faults_of, lost_of
from ..core.progress import Progress
from ..core.requests import Surface, Voronoi2dRequest
from ..core.results import FlatCells, Reals, Voronoi2dResult
from ..core.settings import Voronoi2dSettings
from ..core.solids.edge_network import EdgeNetwork
from ..core.surfaces.plane_frame import is_flat
from ..props import keep_settings, settings_of
from ..props.voronoi_2d import VORONOI_2D
from .base import ALL_SELECTED, SurfaceOperator

# Other names than tessellate's, so that an object can show both.
EDGES_ROLE, CELLS_ROLE, CENTERS_ROLE = "voronoi edges", "voronoi cells", "voronoi centers"


class PlaneOperator(SurfaceOperator):
    """Mixin: makes plane diagrams."""

    settings_name = "voronoi_2d"
    thickness: float

    def gather(self, context: bpy.types.Context, source: bpy.types.Object) -> Callable[[Progress], Voronoi2dResult]:
        """Reads everything from Blender."""
        settings = settings_of(self, Voronoi2dSettings)
        _check(source, settings)
        with mesh_of(context, source, settings.use_modifiers) as mesh:
            sites, weights = read_voronoi_sites(context, source, mesh, settings)
            surface = read_part(source, mesh, settings)
            is_found = settings.space == "AUTO"
            steps = settings.iterations if _moves(settings) else 0
            settings = replace(settings, space=_space(surface, mesh, settings), iterations=steps)
            sized = self.measured(settings, surface, settings.count if sites is None else len(sites))
            request = Voronoi2dRequest(
                surface=surface,
                settings=sized,
                polygons=surface.of_part(read_triangle_polygons(mesh)),
                uv=_uv(source, mesh, surface, settings),
                is_mirrored=source.matrix_world.determinant() < 0,
                sites=sites,
                weights=weights,
                darkness=read_darkness(source, settings),
                circles=read_circles(context, source, settings),
                threads=prefs.threads(context),
            )
        return partial(_run, request, is_found)

    def write(self, context: bpy.types.Context, source: bpy.types.Object, result: Voronoi2dResult) -> str:
        """Writes the result into Blender."""
        chosen = settings_of(self, Voronoi2dSettings)
        settings = replace(chosen, **self._lengths)
        follower = self.follower(context, source)
        for wanted, write, role in (
            (settings.make_edges, _write_edges, EDGES_ROLE),
            (settings.make_cells, _write_cells, CELLS_ROLE),
        ):
            if wanted:
                write(context, source, result, settings, follower)
            else:
                self.drop(source, role)
        if settings.make_centers:
            write_centers(context, source, result.cells, settings, CENTERS_ROLE, follower)
        else:
            self.drop(source, CENTERS_ROLE)
        if result.sweep is not None:
            write_sweep(context, source, result.sweep, settings)
        else:
            remove_sweep(source)
        keep_settings(chosen, "voronoi_2d", source)
        return f"'{source.name}': {_told(result)}{_lost(result)}"

    def lying(self) -> dict[str, bool]:
        """Cells without a height do."""
        return {CELLS_ROLE: not self._lengths.get("thickness", self.thickness)}

    def notes(self, result: Voronoi2dResult) -> list[str]:
        """Returns what is wrong with the meshes that were made."""
        return [] if result.cells.mesh is None else cell_faults_of(result.cells.mesh)


class SADDLEBACK_OT_voronoi_2d(PlaneOperator, bpy.types.Operator):
    """Makes plane diagrams."""

    bl_idname = "saddleback.voronoi_2d"
    bl_label = "Voronoi 2D"
    bl_description = "Divide a flat mesh, or a surface through its UV map, into the cells of a plane Voronoi diagram"
    bl_options = {"REGISTER", "UNDO"}
    __annotations__ = VORONOI_2D | ALL_SELECTED


def _uv(source: bpy.types.Object, mesh: bpy.types.Mesh, surface: Surface, settings: Voronoi2dSettings) -> Reals | None:
    if settings.space != "UV":
        return None
    return surface.of_part(read_uv(source, mesh, settings.uv_name).reshape(-1, 3, 2)).reshape(-1, 2)


def _space(surface: Surface, mesh: bpy.types.Mesh, settings: Voronoi2dSettings) -> str:
    """The plane that is meant where it is to be found."""
    if settings.space != "AUTO":
        return settings.space
    if is_flat(surface):
        return "OUTLINE"
    return "UV" if len(mesh.uv_layers) else "DISK"


def _moves(settings: Voronoi2dSettings) -> bool:
    """Tells whether sites leave the places where they are at first."""
    return settings.sites_source in ("COUNT", "IMAGE") or settings.relax_sites


def _run(request: Voronoi2dRequest, is_found: bool, progress: Progress) -> Voronoi2dResult:
    """Says where the space was found by itself what needs none."""
    try:
        return voronoi_runs.voronoi_2d(request, progress)
    except BadInputError as error:
        if not is_found or request.settings.space == "OUTLINE":
            raise
        raise BadInputError(f"{error}. Tessellate makes cells of any surface, without a map") from error


def _write_edges(
    context: bpy.types.Context,
    source: bpy.types.Object,
    result: Voronoi2dResult,
    settings: Voronoi2dSettings,
    follower: Follower,
) -> None:
    if result.flat is not None:
        write_network(context, source, _network(result.flat), settings, EDGES_ROLE, follower)
    else:
        write_edges(context, source, result.cells, settings, EDGES_ROLE, follower)


def _write_cells(
    context: bpy.types.Context,
    source: bpy.types.Object,
    result: Voronoi2dResult,
    settings: Voronoi2dSettings,
    follower: Follower,
) -> None:
    if result.flat is not None and result.polygons is not None:
        neighbors = result.flat.edge_cells
        count = result.cells.count
        write_polygons(context, source, result.polygons, count, neighbors, CELLS_ROLE, follower)
    else:
        write_cells(context, source, result.cells, settings, CELLS_ROLE, follower)


def _network(flat: FlatCells) -> EdgeNetwork:
    count = len(flat.edges)
    offsets = np.arange(0, 2 * count + 1, 2, dtype=np.int32)
    return EdgeNetwork(flat.vertices, flat.edges.ravel(), offsets, flat.edge_cells, np.zeros(count, bool))


def _told(result: Voronoi2dResult) -> str:
    alive = int(np.count_nonzero(result.cells.cell_area > 0))
    without = result.cells.count - alive
    cells = f"{alive} cell" if alive == 1 else f"{alive} cells"
    return f"{cells}, {without} sites without one" if without else cells


def _lost(result: Voronoi2dResult) -> str:
    mesh = result.cells.mesh
    return lost_of(result.vanished) if mesh is None else lost_of(len(mesh.vanished), len(mesh.thinner))


def _check(source: bpy.types.Object, settings: Voronoi2dSettings) -> None:
    """Refuses what leads nowhere, before anything is computed."""
    if settings.animate and settings.frame_end <= settings.frame_start:
        raise BadInputError(
            f"'{source.name}': the sweep ends in frame {settings.frame_end}, not after frame {settings.frame_start} "
            "in which it starts; choose a later end"
        )
    if settings.make_centers and settings.instance_object:
        instance = find(bpy.data.objects, settings.instance_object)
        if instance is None:
            raise BadInputError(
                f"'{source.name}': there is no object '{settings.instance_object}' to put on the centers"
            )
        if instance == source:
            raise BadInputError(f"'{source.name}' cannot be put on its own centers; choose another object for them")


CLASSES = (SADDLEBACK_OT_voronoi_2d,)

# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.bake`: the cells of the active object as images over its UV map."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import bpy
import numpy as np

from .. import compat, prefs
from ..bridge.inputs.directions_in import read_directions
from ..bridge.inputs.mesh_in import mesh_of, read_triangle_polygons, up_of, world_axes
from ..bridge.inputs.voronoi_in import read_uv
from ..bridge.outputs.out_images import check_images, name_of_image, write_images
from ..bridge.outputs.output_surface import holder
from ..core import bake_runs
from ..core.bake_runs import MOST_TEXELS, BakeResult
from ..core.cell_runs import shape_of
from ..core.errors import BadInputError
from ..core.fields.given_fields import corner_directions, in_tangents
from ..core.lengths import world_lengths
from ..core.progress import Progress
from ..core.requests import BakeRequest, Surface, TessellateRequest
from ..core.results import Indices, Reals
from ..core.settings import BakeSettings, TessellateSettings
from ..core.solids.cell_mesh import CellShape
from ..looks import LOOKS
from ..props import existing_group, keep_settings, kept_settings, settings_of
from ..props.bake import BAKE
from ..props.kept_sites import kept_sites
from .base import SurfaceOperator
from .tessellate import read_request

MAPS = {
    "bake_cell": "Cell",
    "bake_edge_distance": "Edge Distance",
    "bake_height": "Height",
    "bake_local_uv": "Local UV",
    "bake_direction": "Direction",
}


class SADDLEBACK_OT_bake(SurfaceOperator, bpy.types.Operator):
    """Bakes images."""

    bl_idname = "saddleback.bake"
    bl_label = "Bake"
    bl_description = "Write the cells of the active object into images over its UV map, each pixel by itself"
    bl_options = {"REGISTER", "UNDO"}
    __annotations__ = dict(BAKE)

    settings_name = "bake"
    makes_layers = False

    def gather(self, context: bpy.types.Context, source: bpy.types.Object) -> Callable[[Progress], BakeResult]:
        """Reads everything from Blender."""
        settings = settings_of(self, BakeSettings)
        _check(source, settings)
        cells = existing_group(source, "tessellate")
        if cells is None or not cells.told:
            raise BadInputError(f"'{source.name}' has no cells yet to bake: press Tessellate first")
        chosen, sites = kept_settings(source, "tessellate", TessellateSettings), kept_sites(source)
        if sites is None and chosen.mirror_x:
            raise BadInputError(
                f"'{source.name}': it is not known where its mirrored cells are: press Tessellate first"
            )
        if sites is not None:  # nothing needs to be found again
            chosen = replace(chosen, relax_sites=False, density_source="UNIFORM")
            if chosen.sites_source not in ("COUNT", "SIZE"):
                chosen = replace(chosen, sites_source="COUNT", count=len(sites))
        with mesh_of(context, source, chosen.use_modifiers) as mesh:
            request = read_request(context, source, mesh, chosen, _measured)
            if sites is not None:
                request = replace(request, sites=sites)
            baked = _request(source, mesh, settings, request, prefs.threads(context))
        shown = holder(context, source, chosen.use_modifiers)
        seen = None if shown is None else _seen_cells(shown.data, chosen.cell_attribute)
        return partial(bake_runs.bake, replace(baked, vertex_cell=seen))

    def write(self, context: bpy.types.Context, source: bpy.types.Object, result: BakeResult) -> str:
        """Makes the images."""
        settings = settings_of(self, BakeSettings)
        names = write_images(source, result, settings.image_prefix or source.name, settings.folder)
        keep_settings(settings, "bake", source)
        count = "1 image" if len(names) == 1 else f"{len(names)} images"
        return f"'{source.name}': {result.count} cells in {count}, {_sizes(settings, result)}"

    def figures(self, result: BakeResult) -> list[str]:
        """Returns what the numbers in the images stand for."""
        return [f"{image.label}: 1 is {image.reach:.4g}" for image in result.images if image.reach]


def _check(source: bpy.types.Object, settings: BakeSettings) -> None:
    if not 1 <= settings.resolution <= MOST_TEXELS:
        raise BadInputError(
            f"'{source.name}': images of {settings.resolution:,} pixels cannot be baked; choose 1 to {MOST_TEXELS:,}"
        )
    wanted = [label for name, label in MAPS.items() if getattr(settings, name)]
    if not wanted:
        raise BadInputError(f"'{source.name}': no map is chosen; choose one to bake")
    prefix = settings.image_prefix or source.name
    check_images(source, [name_of_image(prefix, label) for label in wanted], settings.folder)


def _sizes(settings: BakeSettings, result: BakeResult) -> str:
    tiles = len(result.images[0].files)
    many = f" in {tiles} tiles" if tiles > 1 else ""
    return f"{settings.resolution} x {settings.resolution}{many}, {settings.bits} bits"


def _measured(settings: TessellateSettings, surface: Surface, count: int) -> TessellateSettings:
    return replace(settings, **world_lengths(settings, surface, count))


def _request(
    source: bpy.types.Object,
    mesh: bpy.types.Mesh,
    settings: BakeSettings,
    cells: TessellateRequest,
    threads: int,
) -> BakeRequest:
    surface, polygons = cells.surface, read_triangle_polygons(mesh)
    uv = read_uv(source, mesh, settings.uv_name, " before it is baked")
    if surface.kept is not None:
        uv, polygons = uv.reshape(-1, 3, 2)[surface.kept].reshape(-1, 2), polygons[surface.kept]
    if not np.isfinite(uv).all():
        face = polygons[np.flatnonzero(~np.isfinite(uv).all(axis=1))[0] // 3]
        raise BadInputError(f"'{source.name}': face {face} is not at a finite place in its UV map; unwrap it again")
    tiles = bake_runs.tiles_of(uv)[0].tolist() if settings.use_tiles else [bake_runs.FIRST_TILE]
    if not tiles:
        raise BadInputError(f"'{source.name}': no face lies in a UDIM tile; move them there in the UV Editor")
    return BakeRequest(
        cells=cells,
        settings=settings,
        shape=_shape(settings, cells),
        uv=uv,
        tiles=tuple(tiles),
        polygons=polygons,
        directions=_directions(source, mesh, settings, surface, uv),
        up=up_of(source),
        threads=threads,
    )


def _shape(settings: BakeSettings, cells: TessellateRequest) -> CellShape:
    """How cells rise: as they are set, or as a look has them."""
    if settings.profile == "CELLS":
        return shape_of(cells.settings)
    given = replace(cells.settings, dome=0.0, lengths="RELATIVE")
    own = {name: value for name, value in LOOKS[settings.profile].settings.items() if name != "count"}
    count = cells.settings.count if cells.sites is None else len(cells.sites)
    return shape_of(_measured(replace(given, **own), cells.surface, count))


def _directions(
    source: bpy.types.Object, mesh: bpy.types.Mesh, settings: BakeSettings, surface: Surface, uv: Reals
) -> Reals | None:
    if not settings.bake_direction:
        return None
    vectors = corner_directions(surface, read_directions(source, mesh, settings.direction_attribute))
    in_world: Reals = vectors @ world_axes(source).T
    return in_tangents(surface, uv, vectors) if settings.direction_space == "TANGENT" else in_world


def _seen_cells(mesh: bpy.types.Mesh, name: str) -> Indices | None:
    """(V,) the cells that the mesh shows, None where it has none."""
    attribute = mesh.attributes.get(name)
    if attribute is None or attribute.domain != "POINT" or attribute.data_type != "INT":
        return None
    numbers = np.empty(len(attribute.data), np.int32)  # signed: -1 is no cell
    attribute.data.foreach_get("value", compat.as_copied(numbers))
    return numbers


CLASSES = (SADDLEBACK_OT_bake,)

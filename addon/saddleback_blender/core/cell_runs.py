# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh of the cells: from the library's split mesh to gaps, rims and heights."""

from __future__ import annotations

import math
from dataclasses import astuple, replace
from typing import Any

import numpy as np

from . import native
from .cache import Cache
from .progress import Progress
from .requests import Surface, TessellateRequest, digest
from .results import CellMesh, Reals
from .settings import TessellateSettings, Voronoi2dSettings
from .solids.cell_mesh import CellPieces, CellShape, cell_pieces, raise_cells
from .solids.directions import smooth_directions

# Of a cell's size: directions are smoothed over so much at least, so that they are found once for all usual heights.
SMOOTHED = 0.2
MOST_SMOOTHING = 40  # rounds; more change next to nothing where a mesh is that fine


def shape_of(settings: TessellateSettings | Voronoi2dSettings) -> CellShape:
    """Takes the lengths from settings that have them in world units."""
    dome = settings.dome if isinstance(settings, TessellateSettings) else 0.0
    return CellShape(settings.gap, settings.inset, settings.thickness, settings.underside, dome)


def shape_of_each(shape: CellShape, request: TessellateRequest, sites: Any) -> CellShape:
    """The same with what each cell's lengths are multiplied by: what was painted where its site (n,) is."""
    gap, inset, thickness = (at_sites(request.surface, sites, values) for values in vars(request.paint).values())
    return replace(shape, gap_by=gap, inset_by=inset, thickness_by=thickness)


def at_sites(surface: Surface, sites: Any, values: Reals | None) -> Reals | None:
    """(V,) values of the Blender mesh's vertices -> (n,) those where sites are."""
    if values is None:
        return None
    corners = surface.gather(values)[surface.triangles[sites.faces]]
    found: Reals = np.einsum("ni,ni->n", sites.barycentric, corners)
    return found


def cells_of(
    mesh: Any, split: Any, shape: CellShape, key: tuple[str, ...], progress: Progress, cache: Cache
) -> CellMesh:
    """The cells of the library's split mesh of its `mesh`, which `key` names. Only what changed is computed."""
    count = int(np.max(split.triangle_cell, initial=0)) + 1
    highest = float(np.max(shape.height, initial=0.0))
    reach = max(highest, SMOOTHED * math.sqrt(mesh.area / count)) if highest > 0.0 else 0.0

    def pieces() -> CellPieces:
        way = directions(mesh, split, reach, progress)
        return cell_pieces(split.vertices, split.triangles, split.triangle_cell, way, shape)

    def raised() -> CellMesh:
        part = ("cell pieces", *key, digest(shape.rim_start, shape.rim_width, shape.differs, shape.is_round, reach))
        return raise_cells(cache.get(part, pieces, lambda found: found.nbytes), shape, progress)

    whole = ("cell mesh", *key, digest(*astuple(shape)))
    return cache.get(whole, raised, lambda made: made.nbytes)


def directions(mesh: Any, split: Any, reach: float, progress: Progress) -> Reals:
    """Which way (V, 3) the split mesh's vertices go when it is raised by about `reach`: zero where that is zero.

    Those that the split added go as their places on the mesh do. Normals of the split mesh would not: small triangles
    beside lines turn them, and plates would wrinkle along their rims.
    """
    vertices, origin = np.asarray(split.vertices), np.asarray(split.vertex_origin)
    ways = np.zeros((len(vertices), 3))
    if reach > 0.0:
        triangles = np.asarray(mesh.triangles)
        smooth = smooth_directions(np.asarray(mesh.vertices), triangles, reach, progress, MOST_SMOOTHING)
        is_old = origin >= 0
        ways[is_old] = smooth[origin[is_old]]
        places = native.load().project(mesh, vertices[~is_old])
        ways[~is_old] = np.einsum("ni,nij->nj", places.barycentric, smooth[triangles[places.faces]])
    return ways

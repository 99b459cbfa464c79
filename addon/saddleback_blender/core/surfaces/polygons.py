# SPDX-License-Identifier: GPL-3.0-or-later
"""Cells as polygons, one for each."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from .. import native
from ..progress import Progress
from ..results import Indices, SurfacePolygons
from ..settings import TessellateSettings
from .corner_places import corner_places


def polygons_of(mesh: Any, cells: Any, policy: str, threads: int, progress: Progress) -> SurfacePolygons:
    """The library's polygons of its cells on its mesh, by REPAIR or STRICT.

    Raises the library's InputError where the cells cannot be repaired, and its Cancelled.
    """
    with progress.stage(0.985, "making polygons of the cells") as job:
        made = cells.polygons(policy.lower(), threads=threads, job=job)
    return _placed(mesh, made)


def patches_of(
    mesh: Any, settings: TessellateSettings, extent: float, threads: int, progress: Progress
) -> SurfacePolygons:
    """The library's patches of its mesh, by an error.

    Raises the library's InputError where the error is too small for the mesh, and its Cancelled.
    """
    sharp = {"sharp": settings.sharp_angle} if settings.hold_sharp else {}
    with progress.stage(0.985, "dividing the surface into patches") as job:
        made = native.load().super_patches(
            mesh, error=settings.patch_error / 100 * extent, threads=threads, job=job, **sharp
        )
    return replace(_placed(mesh, made.polygons), is_patches=True)


def _placed(mesh: Any, made: Any) -> SurfacePolygons:
    faces, barycentric = corner_places(mesh, made.vertices, made.corners, made.offsets)
    return SurfacePolygons(
        vertices=made.vertices,
        corners=made.corners,
        offsets=made.offsets,
        polygon_cell=made.polygon_cell,
        faces=made.points.faces,
        barycentric=made.points.barycentric,
        corner_faces=faces,
        corner_barycentric=barycentric,
        missing=made.missing,
        added=int(made.added),
    )


def neighbors_of(corners: Indices, offsets: Indices, polygon_cell: Indices) -> Indices:
    """(e, 2) different cells of polygons that share a side."""
    counts = np.diff(offsets)
    onward = np.arange(1, len(corners) + 1)
    onward[offsets[1:] - 1] = offsets[:-1]
    ends = np.sort(np.column_stack([corners, corners[onward]]), axis=1)
    cell = np.repeat(polygon_cell, counts)
    order = np.lexsort([ends[:, 1], ends[:, 0]])
    is_same = (ends[order][1:] == ends[order][:-1]).all(axis=1)
    pairs = np.column_stack([cell[order][1:][is_same], cell[order][:-1][is_same]])
    found: Indices = pairs[pairs[:, 0] != pairs[:, 1]].astype(np.int32)
    return found

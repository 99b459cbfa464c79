# SPDX-License-Identifier: GPL-3.0-or-later
"""Cells as polygons, one for each."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..progress import Progress
from ..results import Indices, SurfacePolygons
from .corner_places import corner_places


def polygons_of(mesh: Any, cells: Any, policy: str, threads: int, progress: Progress) -> SurfacePolygons:
    """The library's polygons of its cells on its mesh, by REPAIR or STRICT.

    Raises the library's InputError where the cells cannot be repaired, and its Cancelled.
    """
    with progress.stage(0.985, "making polygons of the cells") as job:
        made = cells.polygons(policy.lower(), threads=threads, job=job)
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

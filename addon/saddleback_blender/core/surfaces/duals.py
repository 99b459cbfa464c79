# SPDX-License-Identifier: GPL-3.0-or-later
"""The dual of cells: a triangle mesh of their sites, and how good its triangles are."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .. import native
from ..progress import Progress
from ..requests import Surface
from ..results import Dual, EdgeMarks, Figures, Indices
from .corner_places import corner_places
from .marks import halves, inherited


@dataclass(frozen=True)
class MadeDual:
    """The library's dual mesh, and what is made of it."""

    library: Any
    dual: Dual


def dual_of(cells: Any, policy: str, threads: int, progress: Progress, has_faults: bool = False) -> MadeDual:
    """The library's dual mesh of its cells, by REPAIR or STRICT, without triangles that no mesh can hold.

    Where cells cannot be repaired, one that `has_faults`, if that is allowed; else raises the library's InputError. Its
    Cancelled, too.
    """
    try:
        with progress.stage(0.99, "joining the sites") as job:
            mesh = cells.dual(policy=policy.lower(), threads=threads, job=job)
    except native.load().InputError:
        if not has_faults:
            raise
        with progress.stage(0.99, "joining the sites") as job:
            mesh = cells.dual(policy="strict", threads=threads, job=job)
    dual = Dual(
        vertices=mesh.vertices,
        triangles=_simple(mesh.triangles),
        faces=mesh.sites.faces,
        barycentric=mesh.sites.barycentric,
        sites=len(mesh.vertices),
        added=int(mesh.added),
        issues=tuple(str(issue) for issue in mesh.issues),
    )
    return MadeDual(mesh, dual)


def finished(made: MadeDual, mesh: Any, surface: Surface, marks: EdgeMarks | None, lines: list[Any] | None) -> Dual:
    """The same with its edges' marks, where `marks` has some of the Blender mesh, and what its corners are seen from.

    With quads where there are `lines`, curves along which some of its edges run, perhaps none.
    """
    dual, library = made.dual, made.library
    own = None if marks is None or not len(marks.edges) else inherited(surface, marks, library)
    if lines is not None:
        points, quads = library.quads(lines)
        places, middles = points.positions(mesh), dual.sites + np.arange(len(library.edges), dtype=np.int32)
        own = None if own is None else halves(own, library.edges, middles)
        dual = replace(
            dual, vertices=places, faces=points.faces, barycentric=points.barycentric, quads=quads, marks=own
        )
        dual = _without_loose_middles(dual)
    else:
        dual = replace(dual, marks=own)
    return with_corners(dual, mesh)


def with_corners(dual: Dual, mesh: Any) -> Dual:
    """The same with the places of its faces' corners on the library's mesh."""
    count, sides = dual.polygons.shape
    offsets = np.arange(0, sides * count + 1, sides)
    faces, barycentric = corner_places(mesh, dual.vertices, dual.polygons.ravel(), offsets)
    return replace(dual, corner_faces=faces, corner_barycentric=barycentric)


def _without_loose_middles(dual: Dual) -> Dual:
    """Leaves out the vertices of no quad, but for sites."""
    assert dual.quads is not None
    is_used = np.arange(len(dual.vertices)) < dual.sites
    is_used[dual.quads] = True
    number = (np.cumsum(is_used) - 1).astype(np.int32)
    marks = dual.marks
    if marks is not None:
        kept = is_used[marks.edges].all(axis=1)
        marks = EdgeMarks(number[marks.edges[kept]], marks.sharp[kept], marks.seam[kept], marks.crease[kept])
    return replace(
        dual,
        vertices=dual.vertices[is_used],
        faces=dual.faces[is_used],
        barycentric=dual.barycentric[is_used],
        quads=number[dual.quads],
        marks=marks,
    )


def figures_of(dual: Dual, energy: float | None) -> Figures | None:
    """Returns what is told of a run; None where there is no triangle."""
    if not len(dual.triangles):
        return None
    quality = native.load().triangle_quality(dual.vertices, dual.triangles)
    return Figures(float(quality.mean_quality), float(quality.mean_angle), float(quality.irregular), energy)


def _simple(triangles: Indices) -> Indices:
    """Each triangle once, and only those with three different corners: others are no faces of a mesh."""
    a, b, c = triangles.T
    whole = np.flatnonzero((a != b) & (b != c) & (c != a))
    _, first = np.unique(np.sort(triangles[whole], axis=1), axis=0, return_index=True)
    kept: Indices = triangles[whole[np.sort(first)]]
    return kept

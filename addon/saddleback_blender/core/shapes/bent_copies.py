# SPDX-License-Identifier: GPL-3.0-or-later
"""Copies of shapes bent onto the surface, as one mesh that knows whose each face is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..progress import Progress, blocks
from ..results import BentCopies, Indices, Reals
from ..settings import DistributeSettings
from ..surfaces.normals import normals_at
from .shape_templates import SIDES, ShapeTemplate, Solid

THICKNESS = 0.12  # of a shape's radius: of raised pieces of surface, where none is given


@dataclass(frozen=True)
class Bent:
    """Solids bent onto the surface, as the library's BentCopies, but vertices of a copy may lie anywhere among all."""

    vertices: Reals
    faces: Indices
    barycentric: Reals
    begins: NDArray[np.int64]
    ends: NDArray[np.int64]
    triangles: Indices
    triangle_copy: Indices
    triangle_source: Indices
    weights: tuple[Reals, ...]  # of all that were bent, one time after the other
    row: Indices  # of a triangle among those

    @staticmethod
    def of(copies: Any) -> Bent:
        """What the library bent."""
        return Bent(
            copies.vertices, copies.surface.faces, copies.surface.barycentric, copies.begins[:-1], copies.begins[1:],
            copies.triangles, copies.triangle_copy, copies.triangle_source, (copies.weights,),
            np.arange(len(copies.triangles), dtype=np.int32),
        )  # fmt: skip

    def weights_of(self, chosen: NDArray[np.int64]) -> Reals:
        """Where the corners of some triangles lie in their sources. All of them are too many to be moved about."""
        found, row, first = np.empty((len(chosen), 3, 3)), self.row[chosen], 0
        for part in self.weights:
            mine = (row >= first) & (row < first + len(part))
            found[mine] = part[row[mine] - first]
            first += len(part)
        return found

    def joined(self, other: Bent) -> Bent:
        """With the copies of another behind."""

        def both(name: str, shift: int = 0) -> Any:
            own, others = getattr(self, name), getattr(other, name)
            return np.concatenate([own, others + own.dtype.type(shift)])

        count = len(self.vertices)
        return Bent(
            both("vertices"), both("faces"), both("barycentric"), both("begins", count), both("ends", count),
            both("triangles", count), both("triangle_copy", len(self.begins)), both("triangle_source"),
            (*self.weights, *other.weights), both("row", sum(map(len, self.weights))),
        )  # fmt: skip

    def with_again(self, again: Sequence[tuple[Bent, NDArray[np.int64]]]) -> Bent:
        """With copies that were bent `again`, and whose those are, in the place of what they were before."""
        tries = [(self, np.arange(len(self.begins))), *again]
        last, begins, ends = (np.zeros(len(self.begins), np.int64) for _ in range(3))
        for number, (_, chosen) in enumerate(tries):
            last[chosen] = number
        kept, triangles, copies, vertex, row = [], [], [], 0, 0
        for number, (bent, chosen) in enumerate(tries):
            begins[chosen], ends[chosen] = bent.begins + vertex, bent.ends + vertex
            is_last = last[chosen][bent.triangle_copy] == number
            triangles.append(bent.triangles[is_last] + np.int32(vertex))
            copies.append(chosen[bent.triangle_copy[is_last]])
            kept.append(np.flatnonzero(is_last) + row)
            vertex, row = vertex + len(bent.vertices), row + len(bent.triangles)
        order = np.argsort(np.concatenate(copies), kind="stable")
        rows = np.concatenate(kept)[order]

        def joined(name: str) -> Any:
            return np.concatenate([getattr(bent, name) for bent, _ in tries])

        return Bent(
            joined("vertices"), joined("faces"), joined("barycentric"), begins, ends, np.concatenate(triangles)[order],
            np.concatenate(copies).astype(np.int32)[order], joined("triangle_source")[rows],
            tuple(part for bent, _ in tries for part in bent.weights), rows.astype(np.int32),
        )  # fmt: skip


def bent_copies(
    mesh: Any, mapped: Any, templates: Sequence[ShapeTemplate], settings: DistributeSettings, threads: int,
    progress: Progress, without: Sequence[int] = (), bent: Bent | None = None,
) -> BentCopies:  # fmt: skip
    """One copy for each placement that could be laid, those with a solid first; none of those `without`.

    `bent`: the copies of all solids, where they are there already.
    """
    shapes, scales, mirrored = (
        mapped.placements.shape.tolist(), mapped.placements.scale, mapped.placements.mirrored
    )  # fmt: skip
    pieces = []
    if bent is None:
        with progress.stage(0.95, "bending shapes onto the surface") as job:
            solids = [triangulated(template.solid) for template in templates]
            bent = Bent.of(mapped.bend(solids, settings.fit, threads=threads, job=job))
    for shape, template in enumerate(templates):
        if template.solid is not None:
            copies = np.flatnonzero((mapped.placements.shape == shape) & (bent.ends > bent.begins))
            pieces.append(_of_solid(bent, mapped, template.solid, shape, np.setdiff1d(copies, without)))
    for number, shape in enumerate(shapes):
        if number % 32 == 0:
            progress.check()
        if number not in mapped.failures and templates[shape].solid is None:
            height = settings.thickness or THICKNESS * float(scales[number])
            pieces.append(_raised(mesh, mapped.patch(number), height, bool(mirrored[number]), number, shape, template))
    del bent  # larger than what is made of it
    return _joined(pieces)


def triangulated(solid: Solid | None) -> tuple[Reals, Indices] | None:
    """Vertices and triangles of a solid, as the library bends them."""
    return None if solid is None else (solid.vertices, solid.corners[solid.parted()])


@dataclass(frozen=True)
class _Piece:
    vertices: Reals
    faces: Indices
    barycentric: Reals
    corners: Indices
    offsets: Indices
    uv: Reals
    smooth: NDArray[np.bool_]
    material: Indices
    copy: Indices  # (polygons,)
    shape: int


def _joined(pieces: list[_Piece]) -> BentCopies:
    counts = [len(piece.offsets) - 1 for piece in pieces]
    firsts = np.cumsum([0, *(len(piece.vertices) for piece in pieces)])
    sizes = [np.diff(piece.offsets) for piece in pieces]
    corners = [piece.corners + first.astype(np.int32) for piece, first in zip(pieces, firsts, strict=False)]
    return BentCopies(
        vertices=_rows([piece.vertices for piece in pieces], 3),
        faces=_row([piece.faces for piece in pieces], np.int32),
        barycentric=_rows([piece.barycentric for piece in pieces], 3),
        corners=_row(corners, np.int32),
        offsets=np.concatenate([[0], np.cumsum(_row(sizes, np.int32))]).astype(np.int32),
        uv=_rows([piece.uv for piece in pieces], 2),
        smooth=_row([piece.smooth for piece in pieces], np.bool_),
        material=_row([piece.material for piece in pieces], np.int32),
        polygon_copy=_row([piece.copy for piece in pieces], np.int32),
        polygon_shape=np.repeat([piece.shape for piece in pieces], counts).astype(np.int32),
    )


def _rows(parts: list[Reals], width: int) -> Reals:
    rows: Reals = parts[0] if len(parts) == 1 else np.concatenate(parts) if parts else np.empty((0, width))
    return rows


def _row(parts: list[Any], dtype: type[np.generic]) -> Any:
    return (np.concatenate(parts) if parts else np.empty(0)).astype(dtype, copy=False)


def _of_solid(bent: Bent, mapped: Any, solid: Solid, shape: int, copies: NDArray[np.int64]) -> _Piece:
    """Copies of a class: polygons as they were where nothing of them was divided or folded, else triangles."""
    parted = solid.parted()
    polygon = (np.searchsorted(solid.offsets, parted[:, 0], "right") - 1).astype(np.int32)
    begins, ends = bent.begins[copies], bent.ends[copies]
    used = np.concatenate([np.arange(b, e) for b, e in zip(begins, ends, strict=True)] or [np.empty(0, np.int64)])
    order = np.zeros(len(bent.vertices), np.int64)  # of a vertex among those used
    order[used] = np.arange(len(used))
    rank = np.zeros(len(mapped.placements), np.int64)
    rank[copies] = np.arange(len(copies))

    mine = np.flatnonzero(np.isin(bent.triangle_copy, copies))
    source, owner = bent.triangle_source[mine], rank[bent.triangle_copy[mine]]
    # A polygon is whole where each of its triangles is there once.
    parts = np.bincount(owner * len(parted) + source, minlength=len(copies) * len(parted)).reshape(-1, len(parted))
    is_whole = np.ones((len(copies), len(solid.offsets) - 1), bool)
    row, triangle = np.nonzero(parts != 1)
    is_whole[row, polygon[triangle]] = False
    # Blender parts one that folds along another diagonal, where it may pass through what it was clear of.
    folded = _is_folded(bent.vertices, bent.triangles[mine], owner, source, polygon)
    is_whole[owner[folded], polygon[source[folded]]] = False
    whole_row, whole = np.nonzero(is_whole)
    is_mirrored = np.asarray(mapped.placements.mirrored)[copies][whole_row]

    sizes = np.diff(solid.offsets)[whole]
    kept = _runs(solid.offsets[:-1][whole], sizes, is_mirrored)
    kept_corners = order[np.repeat(begins[whole_row], sizes) + solid.corners[kept]]
    cut = mine[~is_whole[owner, polygon[source]]]
    cut_source = bent.triangle_source[cut]
    cut_uv = np.einsum("tck,tkj->tcj", bent.weights_of(cut), solid.uv[parted[cut_source]]).reshape(-1, 2)
    of_cut = polygon[cut_source]
    all_sizes = np.concatenate([sizes, np.full(len(cut), 3)])
    return _Piece(
        vertices=bent.vertices[used],
        faces=bent.faces[used],
        barycentric=bent.barycentric[used],
        corners=np.concatenate([kept_corners, order[bent.triangles[cut].ravel()]]).astype(np.int32),
        offsets=np.concatenate([[0], np.cumsum(all_sizes)]).astype(np.int32),
        uv=np.concatenate([solid.uv[kept], cut_uv]),
        smooth=np.concatenate([solid.smooth[whole], solid.smooth[of_cut]]),
        material=np.concatenate([solid.material[whole], solid.material[of_cut]]),
        copy=np.concatenate([copies[whole_row], bent.triangle_copy[cut]]).astype(np.int32),
        shape=shape,
    )


def _is_folded(
    vertices: Reals, triangles: Indices, owner: NDArray[np.int64], source: Indices, polygon: Indices
) -> NDArray[np.bool_]:
    """(t,) triangles that do not face as the first one of their polygon does, given whose each is."""
    normals, found = np.empty((len(triangles), 3)), np.empty(len(triangles), np.bool_)
    for rows in blocks(len(triangles)):
        corners = vertices[triangles[rows]]
        normals[rows] = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    row = np.zeros((owner.max(initial=-1) + 1) * len(polygon), np.int64)
    row[owner * len(polygon) + source] = np.arange(len(source))
    first = row[owner * len(polygon) + np.searchsorted(polygon, polygon)[source]]
    for rows in blocks(len(triangles)):
        found[rows] = np.einsum("ij,ij->i", normals[rows], normals[first[rows]]) <= 0
    return found


def _runs(firsts: Indices, sizes: Indices, is_backwards: NDArray[np.bool_]) -> NDArray[np.int64]:
    """The corners of polygons one after the other, each from its first on, or from its last back."""
    within = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    back = np.repeat(firsts + sizes - 1, sizes) - within
    forth = np.repeat(firsts, sizes) + within
    runs: NDArray[np.int64] = np.where(np.repeat(is_backwards, sizes), back, forth)
    return runs


def _raised(
    mesh: Any, patch: Any, height: float, is_mirrored: bool, copy: int, shape: int, template: ShapeTemplate
) -> _Piece:
    """A piece of the surface, raised by a height, with walls down to the surface all around.

    Those of a picture have its second material: it is not transparent, as a picture is all along its border.
    """
    places, triangles = np.asarray(patch.vertices), np.asarray(patch.triangles)
    points = patch.surface
    up = normals_at(mesh.vertices, mesh.triangles, points.faces, points.barycentric)
    begin, end = border(triangles)
    below = np.full(len(places), -1)
    rim = np.unique(np.concatenate([begin, end]))
    below[rim] = len(places) + np.arange(len(rim))
    walls = np.stack([below[begin], below[end], end, begin], axis=1)
    uv = template.uv_of(np.asarray(patch.uv) * (1.0, -1.0 if is_mirrored else 1.0))
    uv = np.concatenate([uv, uv[rim]])
    corners = np.concatenate([triangles.ravel(), walls.ravel()]).astype(np.int32)
    sizes = np.concatenate([np.full(len(triangles), 3), np.full(len(walls), 4)])
    is_top = np.arange(len(sizes)) < len(triangles)
    return _Piece(
        vertices=np.concatenate([places + height * up, places[rim]]),
        faces=np.concatenate([points.faces, points.faces[rim]]),
        barycentric=np.concatenate([points.barycentric, points.barycentric[rim]]),
        corners=corners,
        offsets=np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32),
        uv=uv[corners],
        smooth=is_top,
        material=np.where(is_top, 0, SIDES if template.picture else 0).astype(np.int32),
        copy=np.full(len(sizes), copy, np.int32),
        shape=shape,
    )


def border(triangles: Indices) -> tuple[Indices, Indices]:
    """Begin and end of the edges that only one triangle has, as it runs through them."""
    begin, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    size = int(triangles.max(initial=0)) + 1
    there, back = begin.astype(np.int64) * size + end, end.astype(np.int64) * size + begin
    lone = ~np.isin(there, back)
    return begin[lone], end[lone]

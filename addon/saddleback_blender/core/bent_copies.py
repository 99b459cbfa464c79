"""Copies of shapes bent onto the surface, as one mesh that knows whose each face is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .normals import normals_at
from .progress import Progress
from .results import BentCopies, Indices, Reals
from .shape_templates import ShapeTemplate, Solid

THICKNESS = 0.12  # of a shape's radius: of raised pieces of surface, where none is given


def bent_copies(
    mesh: Any, mapped: Any, templates: Sequence[ShapeTemplate], thickness: float, progress: Progress
) -> BentCopies:
    """One copy for each placement that could be laid."""
    placements, failures = mapped.placements, mapped.failures
    shapes, scales, mirrored = placements.shape.tolist(), placements.scale, placements.mirrored
    pieces: list[_Piece] = []
    for number, shape in enumerate(shapes):
        if number in failures:
            continue
        if number % 32 == 0:
            progress.check()
        solid = templates[shape].solid
        if solid is None:
            height = thickness or THICKNESS * float(scales[number])
            pieces.append(_raised(mesh, mapped.patch(number), height, bool(mirrored[number]), number, shape))
        else:
            places = mapped.conform(solid.vertices, number).points
            pieces.append(_Piece(places, _turned(solid) if mirrored[number] else solid, number, shape))
    return _joined(pieces)


@dataclass(frozen=True)
class _Piece:
    vertices: Reals
    solid: Solid  # all but the vertices counts
    copy: int
    shape: int


def _joined(pieces: list[_Piece]) -> BentCopies:
    counts = [len(piece.solid.offsets) - 1 for piece in pieces]
    firsts = np.cumsum([0, *(len(piece.vertices) for piece in pieces)])
    sizes = [np.diff(piece.solid.offsets) for piece in pieces]
    corners = [piece.solid.corners + first for piece, first in zip(pieces, firsts, strict=False)]
    return BentCopies(
        vertices=_rows([piece.vertices for piece in pieces], 3),
        corners=_row(corners, np.int32),
        offsets=np.concatenate([[0], np.cumsum(_row(sizes, np.int32))]).astype(np.int32),
        uv=_rows([piece.solid.uv for piece in pieces], 2),
        smooth=_row([piece.solid.smooth for piece in pieces], np.bool_),
        material=_row([piece.solid.material for piece in pieces], np.int32),
        polygon_copy=np.repeat([piece.copy for piece in pieces], counts).astype(np.int32),
        polygon_shape=np.repeat([piece.shape for piece in pieces], counts).astype(np.int32),
    )


def _rows(parts: list[Reals], width: int) -> Reals:
    rows: Reals = np.concatenate(parts) if parts else np.empty((0, width))
    return rows


def _row(parts: list[Any], dtype: type[np.generic]) -> Any:
    return (np.concatenate(parts) if parts else np.empty(0)).astype(dtype)


def _turned(solid: Solid) -> Solid:
    """The same polygons run through the other way, as a mirrored copy needs them."""
    order = _backwards(solid.offsets)
    return Solid(solid.vertices, solid.corners[order], solid.offsets, solid.uv[order], solid.smooth, solid.material)


def _backwards(offsets: Indices) -> NDArray[np.int64]:
    """(corners,) the order of the corners when each polygon is reversed."""
    sizes = np.diff(offsets)
    within = np.arange(offsets[-1]) - np.repeat(offsets[:-1], sizes)
    order: NDArray[np.int64] = np.repeat(offsets[1:] - 1, sizes) - within
    return order


def _raised(mesh: Any, patch: Any, height: float, is_mirrored: bool, copy: int, shape: int) -> _Piece:
    """A piece of the surface, raised by a height, with walls down to the surface all around."""
    places, triangles = np.asarray(patch.vertices), np.asarray(patch.triangles)
    points = patch.surface
    up = normals_at(mesh.vertices, mesh.triangles, points.faces, points.barycentric)
    begin, end = _border(triangles)
    below = np.full(len(places), -1)
    rim = np.unique(np.concatenate([begin, end]))
    below[rim] = len(places) + np.arange(len(rim))
    walls = np.stack([below[begin], below[end], end, begin], axis=1)
    uv = np.asarray(patch.uv)
    uv = 0.5 + 0.5 * uv * (1.0, -1.0 if is_mirrored else 1.0)
    uv = np.concatenate([uv, uv[rim]])
    corners = np.concatenate([triangles.ravel(), walls.ravel()]).astype(np.int32)
    sizes = np.concatenate([np.full(len(triangles), 3), np.full(len(walls), 4)])
    is_top = np.arange(len(sizes)) < len(triangles)
    solid = Solid(
        np.empty((0, 3)), corners, np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32), uv[corners], is_top,
        np.zeros(len(sizes), np.int32),
    )  # fmt: skip
    return _Piece(np.concatenate([places + height * up, places[rim]]), solid, copy, shape)


def _border(triangles: Indices) -> tuple[Indices, Indices]:
    """Begin and end of the edges that only one triangle has, as it runs through them."""
    begin, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    size = int(triangles.max(initial=0)) + 1
    there, back = begin.astype(np.int64) * size + end, end.astype(np.int64) * size + begin
    lone = ~np.isin(there, back)
    return begin[lone], end[lone]

# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines along a field that keep their distance from each other, so that all of the surface shows how it runs.

After [jobard1997]: a line ends where it would come too near to one that is there. Lines begin at even points, in their
order.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import native
from ..progress import Progress
from ..results import PathsResult, Reals
from ..settings import DirectionFieldSettings
from ..surfaces.normals import normals_at
from ..surfaces.point_grid import PointGrid, even_points

SPACING = 0.02  # of the surface's extent, where none is asked for
LENGTH = 30.0  # in spacings, where none is asked for
NEAREST = 0.6  # of the spacing: where a line ends for another
SHORTEST = 2.0  # spacings; less than that is not kept
STEP = 0.25  # of the spacing, from point to point of a drawn line


def even_streamlines(mesh: Any, field: Any, settings: DirectionFieldSettings, progress: Progress) -> PathsResult:
    """Streamlines at the settings' spacing; of a cross field both ways, each keeping its distance to its like only."""
    sb = native.load()
    extent = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    spacing = progress.choose("streamline_spacing", settings.streamline_spacing, SPACING * extent)
    length = progress.choose("streamline_length", settings.streamline_length, LENGTH * spacing)
    count = int(np.clip(mesh.area / spacing**2, 1, 50_000))
    starts = even_points(mesh, count, settings.seed)
    places, headings = starts.positions(mesh), field.directions(starts)[:, None]
    crosses = field.symmetry == 4
    if crosses:
        normals = normals_at(mesh.vertices, mesh.triangles, starts.faces, starts.barycentric)
        headings = np.concatenate([headings, np.cross(normals, headings[:, 0])[:, None]], axis=1)
    taken = PointGrid(NEAREST * spacing)
    points, faces, barycentric, begin = [], [], [], progress.fraction
    for number, own in enumerate(headings):
        if number % 64 == 0:
            with progress.stage(begin + (0.95 - begin) * number / len(headings), "following streamlines"):
                pass
        for heading in own:
            axis = heading[None] if crosses else None
            if not taken.is_free(places[number : number + 1], axis)[0]:
                continue
            line = sb.streamline(mesh, field, starts[number], length, True, heading=heading)
            kept = _kept(line, taken, spacing, crosses)
            if len(kept):
                points.append(line.points[kept])
                faces.append(line.surface.faces[kept])
                barycentric.append(line.surface.barycentric[kept])
                few = _thinned(points[-1], STEP * spacing)
                taken.add(points[-1][few], _axes(points[-1])[few] if crosses else None)
    return _result(mesh, points, faces, barycentric)


def _axes(points: Reals) -> Reals:
    """(n, 3) which way a line runs at each of its points."""
    along = np.gradient(points, axis=0)
    lengths = np.linalg.norm(along, axis=1, keepdims=True)
    units: Reals = np.divide(along, lengths, out=np.zeros_like(along), where=lengths > 0)
    return units


def _kept(line: Any, taken: PointGrid, spacing: float, crosses: bool) -> Any:
    """The numbers of the points about the start as far as they keep their distance; none where that is too short."""
    points = line.points
    asked = np.union1d(_thinned(points, STEP * spacing), [line.start])
    axes = _axes(points)[asked] if crosses and len(points) > 1 else None
    blocked = asked[~taken.is_free(points[asked], axes)]
    before, after = blocked[blocked < line.start], blocked[blocked >= line.start]
    kept = np.arange(before[-1] + 1 if len(before) else 0, after[0] if len(after) else len(points))
    length = np.linalg.norm(np.diff(points[kept], axis=0), axis=1).sum() if len(kept) > 1 else 0.0
    return kept if length >= SHORTEST * spacing else kept[:0]


def _thinned(points: Reals, step: float) -> NDArray[np.int64]:
    """The numbers of points of a line about a step apart."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    kept = np.unique(np.searchsorted(along, np.arange(0.0, along[-1] + step, step)).clip(max=len(points) - 1))
    numbers: NDArray[np.int64] = kept
    return numbers


def _result(mesh: Any, points: list[Reals], faces: list[Any], barycentric: list[Reals]) -> PathsResult:
    if not points:
        empty = np.empty((0, 3))
        return PathsResult(empty, empty, np.zeros(1, np.int32), np.zeros(0, bool), np.zeros(0))
    return PathsResult(
        points=np.concatenate(points),
        normals=normals_at(mesh.vertices, mesh.triangles, np.concatenate(faces), np.concatenate(barycentric)),
        offsets=np.cumsum([0, *map(len, points)]).astype(np.int32),
        closed=np.zeros(len(points), bool),
        lengths=np.array([np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in points]),
    )

"""Lines along a field that keep their distance from each other, so that all of the surface shows how it runs.

After Jobard and Lefer, Creating evenly-spaced streamlines of arbitrary density (1997): a line ends where it would come
too near to one that is there. Lines begin at even points, in their order.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import native
from .normals import normals_at
from .point_grid import PointGrid, even_points
from .progress import Progress
from .results import PathsResult, Reals
from .settings import DirectionFieldSettings

SPACING = 0.02  # of the surface's extent, where none is asked for
LENGTH = 30.0  # in spacings, where none is asked for
NEAREST = 0.6  # of the spacing: where a line ends for another
SHORTEST = 2.0  # spacings; less than that is not kept
STEP = 0.25  # of the spacing, from point to point of a drawn line


def even_streamlines(mesh: Any, field: Any, settings: DirectionFieldSettings, progress: Progress) -> PathsResult:
    """Streamlines at the settings' spacing; of a cross field in both directions, each keeping its own distance."""
    sb = native.load()
    extent = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    spacing = settings.streamline_spacing or SPACING * extent
    length = settings.streamline_length or LENGTH * spacing
    count = int(np.clip(mesh.area / spacing**2, 1, 50_000))
    starts = even_points(mesh, count, settings.seed)
    places = starts.positions(mesh)
    directions = [field.directions(starts)]
    if field.symmetry == 4:
        normals = normals_at(mesh.vertices, mesh.triangles, starts.faces, starts.barycentric)
        directions.append(np.cross(normals, directions[0]))
    points, faces, barycentric, begin = [], [], [], progress.fraction
    for turn, headings in enumerate(directions):
        taken = PointGrid(NEAREST * spacing)
        for number, heading in enumerate(headings):
            if number % 64 == 0:
                share = (turn + number / len(headings)) / len(directions)
                with progress.stage(begin + (0.95 - begin) * share, "following streamlines"):
                    pass
            if not taken.is_free(places[number : number + 1])[0]:
                continue
            line = sb.streamline(mesh, field, starts[number], length, True, heading=heading)
            kept = _kept(line, taken, spacing)
            if len(kept):
                points.append(line.points[kept])
                faces.append(line.surface.faces[kept])
                barycentric.append(line.surface.barycentric[kept])
                taken.add(points[-1][_thinned(points[-1], STEP * spacing)])
    return _result(mesh, points, faces, barycentric)


def _kept(line: Any, taken: PointGrid, spacing: float) -> Any:
    """The numbers of the points about the start as far as they keep their distance; none where that is too short."""
    points = line.points
    asked = np.union1d(_thinned(points, STEP * spacing), [line.start])
    blocked = asked[~taken.is_free(points[asked])]
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

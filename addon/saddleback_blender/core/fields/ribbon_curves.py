# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves in space -> smooth curves on a surface that bands can be laid along.

A hand's tremor, or the steps in which a curve far above the surface moves over its folds, would crease a band. So the
curve is taken at places half a width apart, which are brought to the surface and joined there by a smooth curve.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import native
from ..errors import BadInputError
from ..progress import Progress
from ..requests import Polyline
from ..results import Reals

HALVINGS = 3  # of a piece between two places
FEWEST_PLACES, MOST_PLACES = 8, 1000  # of one curve
ROUND = 1e-3  # of half the width: a curve whose ends are no farther from each other is drawn all round
FAR = 0.5  # of the surface's extent: a curve that is nowhere nearer does not belong to it


def ribbon_curves(
    name: str, extent: float, mesh: Any, graph: Any, curves: tuple[Polyline, ...], radius: float, progress: Progress
) -> list[Any]:
    """The library's curves, one for each piece of a curve on a part of the surface of its own, none of them a point.

    Raises BadInputError for a curve that is off the surface.
    """
    sb = native.load()
    found = []
    for number, drawn in enumerate(curves):
        curve = _round(drawn, radius)
        places = _places(curve, radius)
        points = sb.project(mesh, places)
        nearest = float(np.linalg.norm(points.positions(mesh) - places, axis=1).min())
        if nearest > FAR * extent:
            raise BadInputError(
                f"'{name}': curve {number + 1} is nowhere nearer to the surface than {nearest:.3g}; move it there"
            )
        runs = _runs(mesh, points)
        is_closed = curve.closed and len(runs) == 1 and len(runs[0]) > 2
        pieces = []
        for run in runs:
            if len(run) < 2:
                continue
            with progress.stage(0.5 + 0.2 * (number + 1) / len(curves), "joining the curves on the surface") as job:
                pieces.append(
                    sb.curve_through(
                        graph, sb.SurfacePoints(points.faces[run], points.barycentric[run]), closed=is_closed,
                        smooth=True, halvings=HALVINGS, job=job,
                    )
                )  # fmt: skip
        # Between parts of the surface a curve touches some in passing.
        long = [piece for piece in pieces if piece.length >= 2 * radius] or pieces
        if len(long) < len(pieces):
            progress.note(f"'{name}': pieces of curve {number + 1} that are shorter than wide are left out")
        found += long
    if not found:
        raise BadInputError(f"'{name}': the curves are single points on the surface; draw longer ones")
    return found


def _round(curve: Polyline, radius: float) -> Polyline:
    """The same, closed where its last point lies on its first, as in drawings of other programs."""
    ends = curve.points[[0, -1]]
    is_round = len(curve.points) > 2 and float(np.linalg.norm(ends[1] - ends[0])) <= ROUND * radius
    return replace(curve, points=curve.points[:-1], closed=True) if is_round and not curve.closed else curve


def _places(curve: Polyline, radius: float) -> Reals:
    """(n, 3) places evenly along a curve; of a closed one without the first one again."""
    points = np.concatenate([curve.points, curve.points[:1]]) if curve.closed else curve.points
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    count = int(np.clip(np.ceil(along[-1] / radius), FEWEST_PLACES, MOST_PLACES))
    wanted = np.linspace(0.0, along[-1], count + 1)[: count if curve.closed else None]
    return np.stack([np.interp(wanted, along, points[:, axis]) for axis in range(3)], axis=1)


def _runs(mesh: Any, points: Any) -> list[NDArray[np.int64]]:
    """The numbers of points that follow each other on one part of the surface, those left out that do not move on."""
    places = points.positions(mesh)
    moves = np.concatenate([[True], (places[1:] != places[:-1]).any(axis=1)])
    moves[-1] &= len(places) < 2 or bool((places[-1] != places[0]).any())
    kept = np.flatnonzero(moves)
    parts = mesh.components[mesh.triangles[points.faces[kept], 0]]
    return np.split(kept, np.flatnonzero(np.diff(parts)) + 1)

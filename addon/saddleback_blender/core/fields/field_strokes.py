# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawn lines -> strokes that a field of directions can follow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import native
from ..errors import BadInputError
from ..requests import DirectionFieldRequest
from ..results import Reals
from ..surfaces.surface_walk import joined
from .curve_points import LEAP, places_along

STEPS_PER_EDGE = 2.0  # places along a line, to the mean edge of the mesh
REACH = 0.05  # of the surface's extent: the farthest that a line may be from it
# A hand trembles by a pixel or two: each place becomes the mean of its neighbors so often.
SMOOTHING_ROUNDS = 4


@dataclass(frozen=True)
class SurfaceStrokes:
    """Drawn lines brought to the surface."""

    strokes: list[Any]  # the library's; several for a line that leaves the surface and comes back
    labels: list[str]  # whose each of them is
    followed: int  # lines of which something is on the surface
    left_out: tuple[str, ...] = ()  # whose lines are too far from it


def reach_of(mesh: Any) -> float:
    """How far strokes may be from the surface where nothing else is asked for."""
    return REACH * float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))


def strokes_of(request: DirectionFieldRequest, mesh: Any) -> SurfaceStrokes:
    """The library's strokes. Raises BadInputError where no line comes near the surface."""
    if not request.strokes:
        return SurfaceStrokes([], [], 0)
    sb, settings = native.load(), request.settings
    reach = settings.stroke_reach or reach_of(mesh)
    step = float(mesh.mean_edge_length) / STEPS_PER_EDGE
    lines = [_smoothed(places_along(line, step), line.closed) for line in request.strokes]
    places, owner = np.concatenate(lines), np.repeat(np.arange(len(lines)), [len(line) for line in lines])
    points = sb.project(mesh, places)
    near = np.linalg.norm(points.positions(mesh) - places, axis=1) <= reach
    # A line begins where a stroke does, and where one comes near the surface again.
    starts = near & (np.diff(owner, prepend=-1).astype(bool) | ~np.append(False, near[:-1]))
    walked = joined(mesh, points.faces[near], points.barycentric[near], starts[near], LEAP * step)
    strokes, labels = [], []
    for pieces, stroke in zip(walked, owner[starts].tolist(), strict=True):
        line = request.strokes[stroke]
        for piece in pieces:
            hard = line.hard or settings.hard_strokes
            strokes.append(sb.Stroke(sb.SurfaceCurve(mesh, piece), hard=hard, weight=settings.stroke_weight))
            labels.append(line.label)
    if not strokes:
        raise BadInputError(
            f"'{request.surface.name}': no stroke comes within {reach:.3g} of the surface; draw on it "
            "(placement Surface), or allow a larger reach"
        )
    left_out = np.setdiff1d(np.arange(len(lines)), owner[starts])
    return SurfaceStrokes(
        strokes, labels, len(lines) - len(left_out), tuple(request.strokes[number].label for number in left_out)
    )


def _smoothed(places: Reals, closed: bool) -> Reals:
    """Returns the same places without the tremble; the ends of an open line stay."""
    if len(places) < 3:
        return places
    for _ in range(SMOOTHING_ROUNDS):
        before, after = np.roll(places, 1, axis=0), np.roll(places, -1, axis=0)
        means = 0.5 * places + 0.25 * (before + after)
        if not closed:
            means[0], means[-1] = places[0], places[-1]
        places = means
    return np.concatenate([places, places[:1]]) if closed else places

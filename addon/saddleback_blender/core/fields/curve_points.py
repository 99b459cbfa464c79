# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves in space -> what of a surface they pass over, as curves on it that distances can be measured from.

A curve is followed in steps shorter than the mesh's edges, each brought to the nearest point of the surface, and joined
there by shortest paths. Where it leaps (from one fold to another) it is cut: a path between would be an invention.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import native
from ..requests import Polyline
from ..results import Reals

# Places along a curve, to the mean edge of the mesh; points that stand for a curve, in exact distances, lie closer.
STEPS_PER_EDGE = 2.0
POINTS_PER_EDGE = 8.0
MOST_PLACES = 100_000  # of one curve
# A path on the surface this many times as long as the step in space is a leap.
LEAP = 4.0


def curves_on_surface(mesh: Any, graph: Any, curves: tuple[Polyline, ...]) -> tuple[list[Any], Any | None]:
    """Curves on the surface, and the points (None: no such) that hang together with no other."""
    sb = native.load()
    step = float(mesh.mean_edge_length) / STEPS_PER_EDGE
    found: list[Any] = []
    faces: list[NDArray[np.int32]] = []
    barycentric: list[Reals] = []
    for curve in curves:
        for piece in _pieces(sb.project(mesh, places_along(curve, step)), mesh, graph, curve.closed, LEAP * step):
            if len(piece[0]) > 1:
                found.append(sb.SurfaceCurve(mesh, sb.SurfacePoints(*piece)))
            else:
                faces.append(piece[0])
                barycentric.append(piece[1])
    lone = sb.SurfacePoints(np.concatenate(faces), np.concatenate(barycentric)) if faces else None
    return found, lone


def points_along(mesh: Any, curves: list[Any], lone: Any | None) -> Any:
    """Points of the surface close together all along curves on it, and the lone ones: what exact distances take."""
    step = float(mesh.mean_edge_length) / POINTS_PER_EDGE
    lines = [Polyline(curve.points.positions(mesh), curve.closed) for curve in curves]
    places = [places_along(line, step) for line in lines]
    if lone is not None:
        places.append(lone.positions(mesh))
    return native.load().project(mesh, np.concatenate(places))


def places_along(curve: Polyline, step: float) -> Reals:
    """Places (n, 3) along a curve at most `step` apart, its own points among them."""
    points = np.concatenate([curve.points, curve.points[:1]]) if curve.closed else curve.points
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    step = max(step, float(lengths.sum()) / MOST_PLACES)
    counts = np.maximum(np.ceil(lengths / step).astype(np.int64), 1)
    piece = np.repeat(np.arange(len(counts)), counts)
    share = (np.arange(len(piece)) - np.repeat(np.cumsum(counts) - counts, counts)) / counts[piece]
    along: Reals = points[piece] + share[:, None] * (points[piece + 1] - points[piece])
    return along if curve.closed else np.concatenate([along, points[-1:]])


def _pieces(points: Any, mesh: Any, graph: Any, closed: bool, longest: float) -> list[tuple[NDArray[np.int32], Reals]]:
    """Faces and barycentric coordinates of the points joined on the surface, a pair for each piece without a leap."""
    points = _different(points, mesh)
    count = len(points)
    parts = mesh.components[mesh.triangles[points.faces, 0]]
    faces, barycentric = [points.faces[:1]], [points.barycentric[:1]]
    pieces = []
    for i in range(count if closed and count > 2 else count - 1):
        j = (i + 1) % count
        if points.faces[i] == points.faces[j]:
            faces.append(points.faces[j : j + 1])
            barycentric.append(points.barycentric[j : j + 1])
            continue
        path = graph.path(points[i], points[j]) if parts[i] == parts[j] else None
        if path is not None and path.length <= longest:
            faces.append(path.surface.faces)
            barycentric.append(path.surface.barycentric)
            continue
        pieces.append((np.concatenate(faces), np.concatenate(barycentric)))
        faces, barycentric = [points.faces[j : j + 1]], [points.barycentric[j : j + 1]]
    pieces.append((np.concatenate(faces), np.concatenate(barycentric)))
    return pieces


def _different(points: Any, mesh: Any) -> Any:
    """The points that are not at the place of the one before them."""
    places = points.positions(mesh)
    kept = np.ones(len(places), bool)
    kept[1:] = (places[1:] != places[:-1]).any(axis=1)
    return native.load().SurfacePoints(points.faces[kept], points.barycentric[kept])

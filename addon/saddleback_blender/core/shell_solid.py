"""A strip of a surface made thick to both sides: one closed solid that does not pass through itself.

Each vertex moves along a direction that is the surface's normal, smoothed over the thickness: where directions change
slowly, neighbouring columns do not cross. Where the solid would still meet itself (in creases, in walls thinner than
it) it is made thinner until it does not; where that is not enough, the surface itself is folded, and is smoothed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .cell_mesh import drop_unused
from .cell_solid import vertex_normals
from .mesh_edges import border_edges, directed_edges
from .progress import Progress
from .requests import FindCrossings
from .results import Indices, LampShell, Reals
from .rib_surface import RibSurface

# Each time that a place meets itself it becomes thinner by this factor, so often at most.
THINNER, MOST_TIMES = 0.6, 24
# A place that meets itself after so many times is folded, and is smoothed each time from then on.
FOLDED_AFTER = 5
MOST_SMOOTHING = 200
# The direction and the normal of a triangle may differ by so much: the cosine.
LEAST_COSINE = 0.05


def thicken(ribs: RibSurface, thickness: float, find_crossings: FindCrossings, progress: Progress) -> LampShell:
    """The solid, half the thickness to either side of the surface. O(t) for each of at most MOST_TIMES rounds."""
    direction = _directions(ribs.vertices, ribs.triangles, thickness)
    vertices, triangles = drop_unused(np.column_stack([ribs.vertices, direction]), ribs.triangles[ribs.is_rib])
    places, direction = vertices[:, :3].copy(), vertices[:, 3:].copy()
    count = len(places)
    share = np.ones(count)
    faces = _closed(triangles, count)
    for number in range(MOST_TIMES + 1):
        progress.check()
        offset = (0.5 * thickness * share)[:, None] * direction
        solid = np.concatenate([places + offset, places - offset])
        crossing = np.unique(find_crossings(solid, faces))
        if not len(crossing) or number == MOST_TIMES:
            break
        there = _beside(triangles, np.unique(faces[crossing] % count), count)
        share[there] *= THINNER
        if number >= FOLDED_AFTER:
            places[there] = _mean_of_neighbours(places, triangles)[there]
            direction[there] = _directions(places, triangles, 0.0)[there]
    return LampShell(solid, faces, _pieces(triangles, count), float((share < 1.0).mean()), len(crossing))


def _closed(triangles: Indices, count: int) -> Indices:
    """Triangles of the solid: outside vertex v, inside vertex v + count, a wall along every border."""
    start, end, _ = border_edges(triangles, count)
    walls = [np.stack([end, start, start + count], axis=1), np.stack([end, start + count, end + count], axis=1)]
    return np.concatenate([triangles, triangles[:, ::-1] + count, *walls]).astype(np.int32)


def _directions(vertices: Reals, triangles: Indices, thickness: float) -> Reals:
    """Unit normals (n, 3), smoothed over about the thickness, but not turned away from a triangle beside them."""
    normals = vertex_normals(vertices, triangles)
    start, end = directed_edges(triangles)
    mean_edge = float(np.linalg.norm(vertices[end] - vertices[start], axis=1).mean())
    smooth = normals
    for _ in range(int(np.clip(4 * (thickness / mean_edge) ** 2, 1, MOST_SMOOTHING))):
        smooth = _unit(0.2 * smooth + _mean_of_neighbours(smooth, triangles), normals)
    corners = vertices[triangles]
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    face = _unit(face, face)
    turned = (np.einsum("tij,tj->ti", smooth[triangles], face) < LEAST_COSINE).any(axis=1)
    own = np.zeros(len(vertices), bool)
    own[triangles[turned]] = True
    return np.where(own[:, None], normals, smooth)


def _mean_of_neighbours(values: Reals, triangles: Indices) -> Reals:
    """Mean (n, 3) over the corners of the triangles around each vertex but itself."""
    start, end = directed_edges(triangles)
    both, other = np.concatenate([start, end]), np.concatenate([end, start])
    times = np.maximum(np.bincount(both, minlength=len(values)), 1)
    sums = [np.bincount(both, values[other, axis], minlength=len(values)) for axis in range(3)]
    return np.column_stack(sums) / times[:, None]


def _unit(vectors: Reals, otherwise: Reals) -> Reals:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    unit: Reals = np.where(length > 0, vectors / np.where(length > 0, length, 1.0), otherwise)
    return unit


def _beside(triangles: Indices, vertices: NDArray[np.integer], count: int) -> NDArray[np.bool_]:
    """The vertices (count,) given and all that share a triangle with one."""
    chosen = np.zeros(count, bool)
    chosen[vertices] = True
    chosen[triangles[chosen[triangles].any(axis=1)]] = True
    return chosen


def _pieces(triangles: Indices, count: int) -> int:
    """Number of connected parts: the least vertex of each spreads, in ever longer jumps."""
    label = np.arange(count)
    while True:
        least = label[triangles].min(axis=1)
        spread = label.copy()
        for corner in range(3):
            np.minimum.at(spread, triangles[:, corner], least)
        spread = spread[spread]
        if np.array_equal(spread, label):
            return len(np.unique(label))
        label = spread

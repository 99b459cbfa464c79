"""A strip of a surface made thick to both sides: one closed solid that does not pass through itself.

Each vertex moves along a direction that is the surface's normal, smoothed over the thickness: where directions change
slowly, neighboring columns do not cross. Where the solid would still meet itself (in creases, in walls thinner than
it) it is made thinner until it does not; where that is not enough, the surface itself is folded, and is smoothed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import native
from ..progress import Progress
from ..requests import FindCrossings
from ..results import Indices, LampShell, Reals
from .cell_mesh import drop_unused
from .cell_solid import vertex_normals
from .mesh_edges import border_edges, directed_edges
from .near_faces import largest_extent, near_faces
from .rib_surface import RibSurface
from .sewn import sewn

# Each time that a place meets itself it becomes thinner by this factor, to this least share.
THINNER, LEAST_SHARE = 0.6, 1e-5
# Rounds at most, those without fewer crossings, and triangles that are looked at in all of them, in those of the solid.
MOST_TIMES, STALLED, MOST_LOOKS = 100, 20, 24
END = 0.99  # of the run's progress
# A place that meets itself after so many times is folded, and is smoothed each time from then on.
FOLDED_AFTER = 5
MOST_SMOOTHING = 200
# The direction and the normal of a triangle may differ by so much: the cosine.
LEAST_COSINE = 0.05


def thicken(ribs: RibSurface, thickness: float, find_crossings: FindCrossings, progress: Progress) -> LampShell:
    """The solid, half the thickness to either side of the surface, of which parts that lie border on border are joined.

    The first round is O(t), each after it in what lies about the places that the one before has moved; all together
    they look at no more than MOST_LOOKS times as many triangles as there are.
    """
    surface = sewn(ribs.vertices, ribs.triangles)
    progress.check()
    direction = _directions(ribs.vertices, surface, thickness, progress)
    vertices, triangles = drop_unused(np.column_stack([ribs.vertices, direction]), surface[ribs.is_rib])
    progress.check()
    places, direction = vertices[:, :3].copy(), vertices[:, 3:].copy()
    count = len(places)
    share = np.ones(count)
    faces = _closed(triangles, count)
    progress.check()
    there, extent = np.ones(count, bool), 0.0
    least, least_at, looks, begin = len(faces) + 1, 0, 0, progress.fraction
    for number in range(MOST_TIMES + 1):
        offset = (0.5 * thickness * share)[:, None] * direction
        solid = np.concatenate([places + offset, places - offset])
        moved = np.asarray(there[faces % count].any(axis=1))
        progress.check()
        extent = max(extent, largest_extent(solid, faces[moved]))
        looked_at = near_faces(solid, faces, moved, extent, progress)
        end = begin + (END - begin) * (number + 1) / (MOST_TIMES + 1)
        with progress.stage(end, "making the lamp shell") as job:
            crossing = looked_at[np.unique(find_crossings(solid, faces[looked_at], job))]
        if len(crossing) < least:
            least, least_at = len(crossing), number
        looks += len(looked_at)
        is_enough = number == MOST_TIMES or number - least_at == STALLED or looks > MOST_LOOKS * len(faces)
        if not len(crossing) or is_enough:
            break
        progress.check()
        there = _beside(triangles, np.unique(faces[crossing] % count), count)
        share[there] = np.maximum(THINNER * share[there], LEAST_SHARE)
        if number >= FOLDED_AFTER:
            _smooth(places, direction, triangles, there, progress)
    return LampShell(
        solid,
        faces,
        int(native.load().connected_parts(triangles, count).max()) + 1,
        float((share < 1.0).mean()),
        len(crossing),
    )


def _smooth(places: Reals, direction: Reals, triangles: Indices, there: NDArray[np.bool_], progress: Progress) -> None:
    """Moves the vertices `there` (n,) to the middle of their neighbors, and turns their directions to what is new."""
    around = there
    for _ in range(3):  # a normal, its mean over neighbors, and whether that is turned away: a ring each
        around = _beside(triangles, np.flatnonzero(around), len(places))
    used, number = np.unique(triangles[around[triangles].all(axis=1)], return_inverse=True)
    near: Indices = number.reshape(-1, 3).astype(np.int32)
    own, moved = there[used], places[used]
    moved[own] = _Neighbors(near, len(used), progress).mean(moved)[own]
    places[used] = moved
    direction[used[own]] = _directions(moved, near, 0.0, progress)[own]


def _closed(triangles: Indices, count: int) -> Indices:
    """Triangles of the solid: outside vertex v, inside vertex v + count, a wall along every border."""
    start, end, _ = border_edges(triangles, count)
    walls = [np.stack([end, start, start + count], axis=1), np.stack([end, start + count, end + count], axis=1)]
    return np.concatenate([triangles, triangles[:, ::-1] + count, *walls]).astype(np.int32)


def _directions(vertices: Reals, triangles: Indices, thickness: float, progress: Progress) -> Reals:
    """Unit normals (n, 3), smoothed over about the thickness, but not turned away from a triangle beside them."""
    normals = vertex_normals(vertices, triangles)
    progress.check()
    start, end = directed_edges(triangles)
    progress.check()
    mean_edge = float(np.linalg.norm(vertices[end] - vertices[start], axis=1).mean())
    progress.check()
    neighbors = _Neighbors(triangles, len(vertices), progress)
    smooth = normals
    for _ in range(int(np.clip(4 * (thickness / mean_edge) ** 2, 1, MOST_SMOOTHING))):
        progress.check()
        smooth = _unit(0.2 * smooth + neighbors.mean(smooth), normals)
    progress.check()
    corners = vertices[triangles]
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    face = _unit(face, face)
    progress.check()
    turned = (np.einsum("tij,tj->ti", smooth[triangles], face) < LEAST_COSINE).any(axis=1)
    own = np.zeros(len(vertices), bool)
    own[triangles[turned]] = True
    return np.where(own[:, None], normals, smooth)


class _Neighbors:
    """Corners of the triangles around each vertex but itself, sorted by vertex: one on two triangles counts twice."""

    def __init__(self, triangles: Indices, count: int, progress: Progress) -> None:
        start, end = directed_edges(triangles)
        progress.check()
        both, other = np.concatenate([start, end]), np.concatenate([end, start])
        order = np.argsort(both, kind="stable")
        progress.check()
        self.other = other[order]
        times = np.bincount(both, minlength=count)
        self.used = np.flatnonzero(times)
        self.times = times[self.used]
        self.first = (np.cumsum(times) - times)[self.used]
        self.count = count

    def mean(self, values: Reals) -> Reals:
        """Mean (n, 3) of the neighbors' values; zero where there are none."""
        means = np.zeros((self.count, 3))
        for axis in range(3):
            means[self.used, axis] = np.add.reduceat(values[:, axis][self.other], self.first) / self.times
        return means


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

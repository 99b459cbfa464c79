# SPDX-License-Identifier: GPL-3.0-or-later
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
from ..results import Indices, LampShell, Reals
from .cell_mesh import drop_unused
from .directions import smooth_directions
from .level_cut import cut_at_level
from .mesh_edges import border_edges
from .rib_surface import RibSurface, level_off
from .room import FindCrossings, Solid, beside, fit

THINNER, LEAST_SHARE, PATIENCE = 0.6, 1e-5, 20
ACROSS = 6  # after place and direction: how far from the middle of the rib, in halves of its width
END = 0.99  # of the run's progress
# Of half the width: where round ribs have lines of vertices.
ROUND_LINES = (0.75, 0.35)
RIM = 0.25  # of the thickness of a round rib in its middle: how thick it is at its sides
# A place that meets itself after so many times is folded, and is smoothed each time from then on.
FOLDED_AFTER = 5


def thicken(
    ribs: RibSurface, thickness: float, find_crossings: FindCrossings, progress: Progress, is_round: bool = False
) -> LampShell:
    """The solid, half the thickness to either side of the surface. Round ribs are half ellipses to either side, but for
    a low wall at their sides.
    """
    fields, triangles = np.column_stack([ribs.vertices, ribs.direction, ribs.across]), ribs.triangles[ribs.is_rib]
    for share in ROUND_LINES if is_round else ():
        progress.check()
        level_off(fields, ACROSS, share)
        cut = cut_at_level(fields, triangles, ACROSS, share)
        fields, triangles = cut.fields, cut.triangles
    fields, triangles = drop_unused(fields, triangles)
    progress.check()
    places, direction = fields[:, :3].copy(), fields[:, 3:6].copy()
    profile = (
        RIM + (1.0 - RIM) * np.sqrt(1.0 - np.clip(fields[:, ACROSS], 0.0, 1.0) ** 2)
        if is_round
        else np.ones(len(fields))
    )
    count = len(places)
    faces = _closed(triangles, count)
    progress.check()

    def at(share: Reals) -> Reals:
        offset = (0.5 * thickness * profile * share)[:, None] * direction
        return np.concatenate([places + offset, places - offset])

    def mend(times: int, there: NDArray[np.bool_]) -> None:
        if times >= FOLDED_AFTER:
            _smooth(places, direction, triangles, there, progress)

    solid = Solid(faces, np.tile(np.arange(count, dtype=np.int32), 2), count, at, THINNER, LEAST_SHARE, PATIENCE, mend)
    fitted = fit(solid, find_crossings, END, "making the lamp shell", progress)
    outside, inside = np.split(fitted.vertices, 2)
    return LampShell(
        vertices=fitted.vertices,
        triangles=faces,
        pieces=int(native.load().connected_parts(triangles, count).max()) + 1,
        thickness=thickness,
        is_thinner=np.tile(fitted.share < 1.0, 2),
        crossing=len(fitted.crossing),
        feet=np.tile(0.5 * (outside + inside), (2, 1)),
        wall=np.tile(np.linalg.norm(outside - inside, axis=1) / profile, 2),
    )


def _smooth(places: Reals, direction: Reals, triangles: Indices, there: NDArray[np.bool_], progress: Progress) -> None:
    """Moves the vertices `there` (n,) to the middle of their neighbors, and turns their directions to what is new."""
    around = there
    for _ in range(3):  # a normal, its mean over neighbors, and whether that is turned away: a ring each
        around = beside(triangles, np.flatnonzero(around), len(places))
    used, number = np.unique(triangles[around[triangles].all(axis=1)], return_inverse=True)
    near: Indices = number.reshape(-1, 3).astype(np.int32)
    own, moved = there[used], places[used]
    moved[own] = native.load().neighbor_means(near, moved)[own]
    places[used] = moved
    direction[used[own]] = smooth_directions(moved, near, 0.0, progress)[own]


def _closed(triangles: Indices, count: int) -> Indices:
    """Triangles of the solid: outside vertex v, inside vertex v + count, a wall along every border."""
    start, end, _ = border_edges(triangles, count)
    walls = [np.stack([end, start, start + count], axis=1), np.stack([end, start + count, end + count], axis=1)]
    return np.concatenate([triangles, triangles[:, ::-1] + count, *walls]).astype(np.int32)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Gives a solid on a surface the thickness that it has room for: where it meets itself it becomes thinner."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..progress import Progress
from ..results import Indices, Reals

# Of vertices, triangles, those of which one of each pair is, and the job that may stop it: pairs (k, 2) of triangles
# that pass through each other.
FindCrossings = Callable[[Reals, Indices, Indices, object], Indices]

# Rounds at most, and triangles that have moved in all of them, in those of the solid.
MOST_TIMES, MOST_MOVES = 100, 12


@dataclass(frozen=True)
class Fitted:
    """Vertices of the solid, the share (n,) of the thickness that each place of the surface got, and the triangles that
    still pass through others.
    """

    vertices: Reals
    share: Reals
    crossing: Indices


@dataclass(frozen=True)
class Solid:
    """Triangles of a solid, and the place (v,) on the surface of each of its vertices, of which the surface has n.

    `at` gives the vertices (v, 3) for the shares (n,) of the thickness. Places that meet others become thinner by the
    factor `thinner`, none below `least`. After `patience` rounds without fewer crossings it is given up. `mend`, if
    any, is told how often that was too much, and where (n,).
    """

    triangles: Indices
    place: Indices
    count: int
    at: Callable[[Reals], Reals]
    thinner: float
    least: float
    patience: int
    mend: Callable[[int, NDArray[np.bool_]], None] | None = None


def fit(solid: Solid, find_crossings: FindCrossings, end: float, text: str, progress: Progress) -> Fitted:
    """Makes the solid thinner where it passes through itself until it does not, as long as that helps.

    Each round looks for what passes through triangles that the one before has moved; all together they move no more
    than MOST_MOVES times as many triangles as there are. The run is at `end` after the last.
    """
    triangles, surface = solid.triangles, surface_of(solid)
    share, there = np.ones(solid.count), np.ones(solid.count, bool)
    least, least_at, moves, begin = len(triangles) + 1, 0, 0, progress.fraction
    for number in range(MOST_TIMES + 1):
        vertices = solid.at(share)
        moved = np.flatnonzero(has_any(there, surface)).astype(np.int32)
        progress.check()
        with progress.stage(begin + (end - begin) * (number + 1) / (MOST_TIMES + 1), text) as job:
            crossing = np.unique(find_crossings(vertices, triangles, moved, job))
        if len(crossing) < least:
            least, least_at = len(crossing), number
        moves += len(moved)
        is_enough = number == MOST_TIMES or number - least_at == solid.patience or moves > MOST_MOVES * len(triangles)
        if not len(crossing) or is_enough:
            break
        progress.check()
        if solid.mend is None and not has_any(share > solid.least, surface[crossing]).any():
            break
        there = beside(surface, np.unique(surface[crossing]), solid.count)
        share[there] = np.maximum(solid.thinner * share[there], solid.least)
        if solid.mend is not None:
            solid.mend(number, there)
    return Fitted(vertices, share, crossing)


def surface_of(solid: Solid) -> Indices:
    """The places (m, 3) of the triangles' corners, column by column, as they are looked at."""
    return np.asfortranarray(solid.place[solid.triangles])


def beside(triangles: Indices, vertices: NDArray[np.integer], count: int) -> NDArray[np.bool_]:
    """The vertices (count,) given and all that share a triangle with one."""
    chosen = np.zeros(count, bool)
    chosen[vertices] = True
    chosen[triangles[has_any(chosen, triangles)]] = True
    return chosen


def has_any(chosen: NDArray[np.bool_], triangles: Indices) -> NDArray[np.bool_]:
    """Tells which triangles (t, 3) have a chosen corner; numpy's `any` along short rows takes ten times as long."""
    a, b, c = (chosen.take(triangles[:, side]) for side in range(3))
    return a | b | c

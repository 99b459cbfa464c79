# SPDX-License-Identifier: GPL-3.0-or-later
"""The lines between cells as one network: polylines that meet at a branch point share that vertex."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..results import Indices, Reals

# Points of a line nearer than this part of the network's extent are one: Blender's single precision cannot tell them
# apart, and a tube of no length has no direction.
SAME_POINT = 1e-6


@dataclass(frozen=True)
class EdgeNetwork:
    """Vertices (n,3), and the lines between cells as chains of them.

    Line i runs through chain[offsets[i]:offsets[i+1]] and, where closed, back to its first vertex.
    """

    vertices: Reals
    chain: Indices
    offsets: Indices  # (e + 1,)
    cells: Indices  # (e, 2)
    closed: NDArray[np.bool_]  # (e,)

    def segments(self) -> tuple[Indices, Indices]:
        """All pieces (s,2) between two vertices, and the line (s,) that each belongs to."""
        count = np.diff(self.offsets)
        line = np.repeat(np.arange(len(count), dtype=np.int32), count)
        onward = np.arange(1, len(self.chain) + 1, dtype=np.int32)
        last = self.offsets[1:] - 1
        onward[last] = self.offsets[:-1]
        is_piece = np.ones(len(self.chain), dtype=np.bool_)
        is_piece[last] = self.closed & (count > 2)
        pairs = np.column_stack([self.chain, self.chain[onward]])[is_piece]
        return pairs.astype(np.int32), line[is_piece]


def edge_network(points: Reals, offsets: Indices, cells: Indices, closed: NDArray[np.bool_]) -> EdgeNetwork:
    """Weld the equal end points of polylines, and drop repeated points. O(m log m).

    points (m,3), offsets (e+1,), cells (e,2), closed (e,) as in CellsResult. A closed line may repeat its first point
    at the end or not. A line that shrinks to one point is dropped.
    """
    points = points + 0.0  # minus zero becomes zero, so that equal points have equal bits
    line = np.repeat(np.arange(len(closed)), np.diff(offsets))
    extent = float(np.ptp(points, axis=0).max(initial=0.0)) if len(points) else 0.0
    kept = _distinct(points, offsets, line, closed, SAME_POINT * extent)
    count = np.bincount(line[kept], minlength=len(closed))
    points, line = points[kept], line[kept]
    first = np.cumsum(count) - count

    number = np.arange(len(points), dtype=np.int32)
    is_open = ~closed & (count > 0)
    ends = np.concatenate([first[is_open], (first + count - 1)[is_open]])
    if len(ends):
        _, representative, group = np.unique(points[ends], axis=0, return_index=True, return_inverse=True)
        number[ends] = ends[representative][group.ravel()]
    used, chain = np.unique(number, return_inverse=True)

    alive = count >= 2
    new_offsets = np.concatenate([[0], np.cumsum(count[alive])]).astype(np.int32)
    vertices, compact_chain = _compact(points[used], chain.ravel()[alive[line]])
    return EdgeNetwork(vertices, compact_chain, new_offsets, cells[alive], closed[alive])


def _distinct(
    points: Reals, offsets: Indices, line: NDArray[np.int64], closed: NDArray[np.bool_], tolerance: float
) -> NDArray[np.bool_]:
    """Tells which points stay: not those that repeat their predecessor; the ends of open lines always stay."""
    kept = np.ones(len(points), dtype=np.bool_)
    if len(points) == 0:
        return kept
    same_line = line[1:] == line[:-1]
    kept[1:] = ~same_line | (np.linalg.norm(np.diff(points, axis=0), axis=1) > tolerance)
    filled = np.flatnonzero(np.diff(offsets) > 0)
    first, last = offsets[filled], offsets[filled + 1] - 1
    to_end = np.linalg.norm(points - points[last[np.searchsorted(filled, line)]], axis=1)
    before_last = np.zeros(len(points), dtype=np.bool_)
    before_last[last[last > first] - 1] = True
    kept[before_last & (to_end <= tolerance)] = False
    is_open = ~closed[filled]
    kept[first] = True
    kept[last[is_open]] = True
    whole_turn = np.linalg.norm(points[first] - points[last], axis=1) <= tolerance
    kept[last[~is_open & whole_turn & (last > first)]] = False
    identical = is_open & (points[first] == points[last]).all(axis=1) & (last > first) & (last - first < 2)
    kept[last[identical]] = False
    return kept


def _compact(vertices: Reals, chain: NDArray[np.integer]) -> tuple[Reals, Indices]:
    used = np.zeros(len(vertices), dtype=np.bool_)
    used[chain] = True
    return vertices[used], (np.cumsum(used) - 1)[chain].astype(np.int32)


def long_lines(network: EdgeNetwork) -> list[tuple[Indices, bool]]:
    """Join lines across branch points to few long ones: vertices of each, and whether it is closed.

    At every branch point the two lines that go on straightest become one; a third ends there, inside the tube of the
    other two. Every piece of the network is in exactly one long line.
    """
    partner = _partners(network)
    offsets, chain = network.offsets, network.chain
    done = np.zeros(len(network.closed), dtype=np.bool_)
    lines: list[tuple[Indices, bool]] = []
    for loop in np.flatnonzero(network.closed):
        done[loop] = True
        lines.append((chain[offsets[loop] : offsets[loop + 1]], True))
    starts = [(i, side) for i in range(len(done)) for side in (0, 1) if (i, side) not in partner]
    for start in starts + [(i, 0) for i in range(len(done))]:
        if done[start[0]]:
            continue
        pieces, (i, side) = [], start
        while True:
            done[i] = True
            piece = chain[offsets[i] : offsets[i + 1]]
            pieces.append((piece if side == 0 else piece[::-1])[:-1])
            leaving = (i, 1 - side)
            onward = partner.get(leaving)
            if onward is None or done[onward[0]]:
                break
            i, side = onward
        is_closed = onward is not None
        if not is_closed:
            pieces.append(piece[-1:] if side == 0 else piece[:1])
        lines.append((np.concatenate(pieces), is_closed))
    return lines


def _partners(network: EdgeNetwork) -> dict[tuple[int, int], tuple[int, int]]:
    """Finds for ends (line, 0 at its first vertex or 1 at its last) the end of the line that goes on straightest."""
    at: dict[int, list[tuple[int, int]]] = defaultdict(list)
    direction: dict[tuple[int, int], Reals] = {}
    offsets, chain, vertices = network.offsets, network.chain, network.vertices
    for i in np.flatnonzero(~network.closed):
        ids = chain[offsets[i] : offsets[i + 1]]
        for side, (end, inner) in enumerate(((ids[0], ids[1]), (ids[-1], ids[-2]))):
            away = vertices[inner] - vertices[end]
            direction[int(i), side] = away / max(float(np.linalg.norm(away)), np.finfo(np.float64).tiny)
            at[int(end)].append((int(i), side))
    partner: dict[tuple[int, int], tuple[int, int]] = {}
    for ends in at.values():
        pairs = [(float(direction[a] @ direction[b]), a, b) for n, a in enumerate(ends) for b in ends[:n]]
        for _, a, b in sorted(pairs):
            if a not in partner and b not in partner and a[0] != b[0]:
                partner[a], partner[b] = b, a
    return partner

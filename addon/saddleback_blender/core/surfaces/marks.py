# SPDX-License-Identifier: GPL-3.0-or-later
"""What is marked along edges, and which edges of a dual mesh inherit it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..requests import Surface
from ..results import EdgeMarks, Indices, Reals
from ..solids.mesh_edges import directed_edges, edge_keys

ON_EDGE = 1e-9  # barycentric coordinates below count as 0: the library writes exact ones along edges


class MarkedLines:
    """Tells what points of a surface lie on: rows of sharp, seam and crease, 0 for what they are not on."""

    def __init__(self, surface: Surface, marks: EdgeMarks) -> None:
        self._surface, count = surface, len(surface.vertices)
        edges = surface.compact(marks.edges.ravel()).reshape(-1, 2)
        values = np.column_stack([marks.sharp, marks.seam, marks.crease]).astype(np.float64)
        keys = edge_keys(edges[:, 0], edges[:, 1], count)
        is_known = (edges >= 0).all(axis=1) & np.isin(keys, edge_keys(*directed_edges(surface.triangles), count))
        order = np.argsort(keys[is_known], kind="stable")
        self._keys, self._values = keys[is_known][order], values[is_known][order]
        self._of_vertex = np.zeros((count, 3))
        for end in range(2):
            np.maximum.at(self._of_vertex, edges[is_known, end], values[is_known])

    def at(self, points: Any) -> Reals:
        """(n, 3) of the library's points."""
        corners = self._surface.triangles[points.faces]
        is_zero = points.barycentric <= ON_EDGE
        found = np.zeros((len(corners), 3))
        at_vertex = is_zero.sum(axis=1) == 2
        found[at_vertex] = self._of_vertex[corners[at_vertex][~is_zero[at_vertex]]]
        on_edge = is_zero.sum(axis=1) == 1
        ends = corners[on_edge][~is_zero[on_edge]].reshape(-1, 2)
        keys = edge_keys(ends[:, 0], ends[:, 1], len(self._surface.vertices))
        place = np.minimum(np.searchsorted(self._keys, keys), max(len(self._keys) - 1, 0))
        if len(self._keys):
            found[on_edge] = np.where((self._keys[place] == keys)[:, None], self._values[place], 0.0)
        return found


def inherited(surface: Surface, marks: EdgeMarks, dual: Any) -> EdgeMarks:
    """Those of the library's dual mesh: an edge has what both its sites lie on and the boundary that it crosses
    crosses, too. Its `edges` (m, 2) are numbers of sites. O(points of the boundaries).
    """
    lines, cells = MarkedLines(surface, marks), dual.cells
    crossed = lines.at(cells.edge_surface)
    most = np.maximum.reduceat(crossed, cells.edge_offsets[:-1]) if len(cells.edge_closed) else crossed
    most = most[~cells.edge_closed]
    at_sites = lines.at(dual.sites)[dual.edges] > 0.0
    values = most * at_sites.all(axis=1)
    return _some(dual.edges, values, (values > 0.0).any(axis=1))


def halves(marks: EdgeMarks, edges: Indices, middles: Indices) -> EdgeMarks:
    """The same for edges (e, 2) that have a vertex (e,) in their middle."""
    ends = {(int(a), int(b)): int(middle) for (a, b), middle in zip(edges, middles, strict=True)}
    middle = np.array([ends[int(a), int(b)] for a, b in marks.edges], np.int32)
    first, second = marks.edges.T
    return marks.along(np.column_stack([first, middle]), np.column_stack([middle, second]))


def _some(edges: Indices, values: Reals, kept: NDArray[np.bool_]) -> EdgeMarks:
    sharp, seam, crease = values[kept].T
    return EdgeMarks(np.asarray(edges)[kept], sharp > 0.0, seam > 0.0, crease)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Distance of every vertex to the boundary of the cell that it lies in.

The mesh is split along the cell boundaries: every triangle belongs to one cell, and a boundary segment is an edge whose
two triangles belong to different cells. The border of an open mesh is no boundary of a cell.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import native

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]


def find_boundary(vertex_count: int, triangles: Ints, triangle_cell: Ints) -> tuple[Ints, Ints]:
    """The segments (B,2) of the cell boundaries, and the two cells beside each (B,2)."""
    segments, cells = native.load().cell_boundary(triangles, triangle_cell, vertex_count)
    return segments, cells


def boundary_distance(vertices: Floats, triangles: Ints, triangle_cell: Ints, limit: float = np.inf) -> Floats:
    """Distance (V,) to the boundary of the vertex's own cell; inf beyond the ring of vertices that follows `limit`.

    vertices (V,3), triangles (T,3), triangle_cell (T,). A vertex on a boundary has distance zero. Never too short;
    exact for most vertices, and at most a few percent too long near the middle line of a cell with a ragged boundary,
    where the nearest segment may be nearest to no vertex on the way.
    """
    distance: Floats = native.load().cell_boundary_distance(vertices, triangles, triangle_cell, limit)
    return distance

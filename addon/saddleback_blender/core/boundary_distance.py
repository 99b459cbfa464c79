"""Distance of every vertex to the boundary of the cell that it lies in.

The mesh is split along the cell boundaries: every triangle belongs to one cell, and a boundary segment is an edge whose
two triangles belong to different cells. The border of an open mesh is no boundary of a cell.

Method: every vertex remembers its nearest boundary segment, and segments spread over the mesh edges from the boundary
inwards, ring by ring, as in vector distance transforms; each vertex also tries the segments that follow its own along
the boundary. So the distance is the straight one to a segment that was reached on the surface, and never
jumps from one fold of the mesh to another. Only vertices within the wanted limit, and one ring beyond, are computed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .mesh_edges import border_vertices, directed_edges, edge_keys

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Bools = NDArray[np.bool_]

# The rings of vertices between a boundary and the limit; far more than any mesh needs, so that a loop always ends.
MAX_RINGS = 100_000


@dataclass(frozen=True)
class CellBoundary:
    """Segments (B,2) of the cell boundaries, the two cells beside each (B,2), and which vertices (V,) they touch."""

    segments: Ints
    cells: Ints
    touches: Bools


def find_boundary(vertex_count: int, triangles: Ints, triangle_cell: Ints) -> CellBoundary:
    """Find the edges between different cells. O(T) plus a sort of the edges whose both ends touch several cells."""
    cell_of_corner = np.repeat(triangle_cell, 3)
    some_cell = np.zeros(vertex_count, dtype=np.int32)
    some_cell[triangles.ravel()] = cell_of_corner
    several = np.zeros(vertex_count, dtype=np.bool_)
    several[triangles.ravel()[some_cell[triangles.ravel()] != cell_of_corner]] = True

    start, end = directed_edges(triangles)
    candidate = np.flatnonzero(several[start] & several[end])
    key = edge_keys(start[candidate], end[candidate], vertex_count)
    order = np.argsort(key, kind="stable")
    key, candidate = key[order], candidate[order]
    cell = cell_of_corner[candidate]
    pair = np.flatnonzero((key[1:] == key[:-1]) & (cell[1:] != cell[:-1]))
    segments = np.stack([start[candidate[pair]], end[candidate[pair]]], axis=1)
    cells = np.stack([cell[pair], cell[pair + 1]], axis=1)
    touches = np.zeros(vertex_count, dtype=np.bool_)
    touches[segments.ravel()] = True
    return CellBoundary(segments.astype(np.int32), cells.astype(np.int32), touches)


def segment_distance(points: Floats, a: Floats, b: Floats) -> Floats:
    """Distance (n,) of points (n,3) to the segments from a to b (n,3)."""
    along = b - a
    to_point = points - a
    squared_length = np.einsum("ij,ij->i", along, along)
    position = np.einsum("ij,ij->i", to_point, along)
    with np.errstate(invalid="ignore", divide="ignore"):
        position = np.where(squared_length > 0.0, position / squared_length, 0.0)
    offset = to_point - along * np.clip(position, 0.0, 1.0)[:, None]
    distance: Floats = np.sqrt(np.einsum("ij,ij->i", offset, offset))
    return distance


def boundary_distance(
    vertices: Floats, triangles: Ints, triangle_cell: Ints, boundary: CellBoundary, limit: float
) -> Floats:
    """Distance (V,) to the boundary of the vertex's own cell; inf beyond the ring of vertices that follows `limit`.

    vertices (V,3), triangles (T,3), triangle_cell (T,). A vertex on a boundary has distance zero. Never too short;
    exact for most vertices, and at most a few percent too long near the middle line of a cell with a ragged boundary,
    where the nearest segment may be nearest to no vertex on the way.
    """
    search = _Search(vertices, triangles, triangle_cell, boundary)
    changed = search.follow_boundary(search.seed())
    for _ in range(MAX_RINGS):
        changed = changed[search.distance[changed] < limit]
        if changed.size == 0:
            break
        changed = search.follow_boundary(search.spread(changed))
    return search.distance


class _Search:
    """The nearest segment found so far for each vertex."""

    def __init__(self, vertices: Floats, triangles: Ints, triangle_cell: Ints, boundary: CellBoundary) -> None:
        self.vertices = vertices
        self.boundary = boundary
        self.distance = np.full(len(vertices), np.inf)
        self.distance[boundary.touches] = 0.0
        self.nearest = np.full(len(vertices), -1, dtype=np.int32)
        self.is_changed = np.zeros(len(vertices), dtype=np.bool_)
        self.cell = np.zeros(len(vertices), dtype=np.int32)
        self.cell[triangles.ravel()] = np.repeat(triangle_cell, 3)
        # An inner edge is met once in either direction; one on the border of the mesh needs its way back as well.
        start, end = directed_edges(triangles)
        is_border = border_vertices(triangles, len(vertices))
        back = np.flatnonzero(is_border[start] & is_border[end])
        start, end = np.concatenate([start, end[back]]), np.concatenate([end, start[back]])
        inside = ~boundary.touches[end]
        self.start, self.end = start[inside], end[inside]
        self._list_segments_of_vertices()

    def _list_segments_of_vertices(self) -> None:
        ends = self.boundary.segments.ravel()
        order = np.argsort(ends, kind="stable")
        self.incident = (order // 2).astype(np.int32)
        self.incident_count = np.bincount(ends, minlength=len(self.vertices))
        self.incident_first = np.cumsum(self.incident_count) - self.incident_count

    def offer(self, targets: Ints, segments: Ints) -> Ints:
        """Let each target vertex try a segment; return the vertices (sorted, once each) that got nearer."""
        a = self.vertices[self.boundary.segments[segments, 0]]
        b = self.vertices[self.boundary.segments[segments, 1]]
        found = segment_distance(self.vertices[targets], a, b)
        better = np.flatnonzero(found < self.distance[targets])
        targets, segments, found = targets[better], segments[better], found[better]
        order = np.argsort(-found, kind="stable")  # of the offers to one vertex the last, the nearest, remains
        self.distance[targets[order]] = found[order]
        self.nearest[targets[order]] = segments[order]
        self.is_changed[targets] = True
        changed = np.flatnonzero(self.is_changed).astype(np.int32)
        self.is_changed[changed] = False
        return changed

    def offer_segments_at(self, targets: Ints, boundary_vertices: Ints) -> Ints:
        """Let each target try every segment at the boundary vertex beside it that bounds the target's own cell."""
        count = self.incident_count[boundary_vertices]
        position = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        segments = self.incident[np.repeat(self.incident_first[boundary_vertices], count) + position]
        targets = np.repeat(targets, count)
        cell, (left, right) = self.cell[targets], self.boundary.cells[segments].T
        own = (left == cell) | (right == cell)
        return self.offer(targets[own], segments[own])

    def seed(self) -> Ints:
        """Start from the vertices beside a boundary."""
        beside = np.flatnonzero(self.boundary.touches[self.start])
        return self.offer_segments_at(self.end[beside], self.start[beside])

    def spread(self, changed: Ints) -> Ints:
        """Hand the segments of the changed vertices to their neighbours."""
        active = np.zeros(len(self.vertices), dtype=np.bool_)
        active[changed] = True
        chosen = np.flatnonzero(active[self.start])
        return self.offer(self.end[chosen], self.nearest[self.start[chosen]])

    def follow_boundary(self, changed: Ints) -> Ints:
        """Walk along the boundary from the segments found, as long as that brings a vertex nearer; return `changed`."""
        nearer = changed
        for _ in range(MAX_RINGS):
            if nearer.size == 0:
                break
            ends = self.boundary.segments[self.nearest[nearer]]
            nearer = self.offer_segments_at(np.repeat(nearer, 2), ends.ravel())
        return changed

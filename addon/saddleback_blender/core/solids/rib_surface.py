# SPDX-License-Identifier: GPL-3.0-or-later
"""The ribs between cells as a strip of the surface: all that lies within half the rib's width of a line between cells.

The mesh is refined where ribs run, until no edge there is longer than half their width; then it is cut along the level
of the distance to the lines. It is not cut along the lines themselves, so no triangle is thinner than the mesh's own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import native
from ..errors import BadInputError
from ..progress import Progress
from ..results import Indices, Reals
from .cell_mesh import drop_unused
from .directions import smooth_directions
from .level_cut import cut_at_level, split_edges
from .mesh_edges import border_edges
from .sewn import sewn

# Vertices nearer to the level than this share of half the width are moved off it: then the cut passes through no
# vertex, the strip is a surface everywhere (nowhere two pieces meet in a point), and no triangle is a needle.
OFF_LEVEL = 0.05
# Ribs are this many times as long as wide at most, all together; a solid has about forty triangles for each.
MOST_STEPS = 100_000
POSITION, DISTANCE, DIRECTION = slice(0, 3), 3, slice(4, 7)


UPRIGHT = (0.0, 0.0, 1.0)  # up, as an object sees it that is not turned


@dataclass(frozen=True)
class RibShape:
    """How wide ribs are, up to which height above the lowest point all is solid, how thick that is to be, and where up
    is.
    """

    width: float
    base: float = 0.0
    thickness: float = 0.0
    up: tuple[float, float, float] = UPRIGHT


@dataclass(frozen=True)
class RibSurface:
    """Refined mesh, of which parts that lie border on border are joined: vertices (n, 3), triangles (t, 3), which of
    them (t,) are ribs, the way (n, 3) in which the surface is thickened, and how far (n,) vertices are from the middle
    of the rib, in halves of its width.
    """

    vertices: Reals
    triangles: Indices
    is_rib: NDArray[np.bool_]
    direction: Reals
    across: Reals

    @property
    def pieces(self) -> int:
        """The number of pieces that hang together."""
        found = native.load().connected_parts(self.triangles[self.is_rib], len(self.vertices))
        return int(found.max(initial=-1)) + 1


def rib_surface(name: str, mesh: Any, cells: Any, shape: RibShape, progress: Progress) -> RibSurface:
    """The ribs of the library's cells on its mesh; a border of the mesh has a rib, too.

    `name` of the object, for messages. Raises BadInputError where there are no lines, or the ribs are too narrow for
    the mesh. O(t) and the number of points times the number of segments around their cell.
    """
    width = shape.width
    length = _length(mesh, cells)
    if not length:
        raise BadInputError(f"'{name}': there are no lines between cells to make ribs of; ask for more cells")
    if length > MOST_STEPS * width:
        raise BadInputError(f"'{name}': ribs of width {width:g} are too narrow for its size; make them wider")
    lines = _Lines(mesh, cells, width)
    progress.check()
    vertices, triangles = np.asarray(mesh.vertices, np.float64), np.asarray(mesh.triangles, np.int32)
    face = np.arange(len(triangles), dtype=np.int32)
    points = _surface_points(mesh, vertices, triangles, face, 0)
    level, ground = 0.5 * width, _Ground(vertices, shape)
    distance = ground.distance(vertices, lines.distance(vertices, points, progress))
    fields = np.column_stack([vertices, distance])
    while True:
        progress.check()
        marked = _too_long(fields, triangles, width)
        if not marked.any():
            break
        old = len(fields)
        progress.check()
        cut = split_edges(fields, triangles, marked)
        progress.check()
        fields, triangles, face = cut.fields, cut.triangles, face[cut.parent]
        added = _surface_points(mesh, fields[:, POSITION], triangles, face, old)
        there = fields[old:, POSITION]
        fields[old:, DISTANCE] = ground.distance(there, lines.distance(there, added, progress))
    fields[~np.isfinite(fields[:, DISTANCE]), DISTANCE] = 2 * width
    level_off(fields, DISTANCE, level)
    progress.check()
    # Directions are mixed along edges: those of the small triangles that the cut makes would cross each other.
    triangles = sewn(fields[:, POSITION], triangles)
    progress.check()
    fields = np.column_stack([fields, smooth_directions(fields[:, POSITION], triangles, shape.thickness, progress)])
    progress.check()
    cut = cut_at_level(fields, triangles, DISTANCE, level)
    progress.check()
    fields, triangles = drop_unused(cut.fields, cut.triangles)
    is_rib = fields[triangles, DISTANCE].min(axis=1) < level
    way = fields[:, DIRECTION]
    way /= np.maximum(np.linalg.norm(way, axis=1, keepdims=True), np.finfo(np.float64).tiny)
    return RibSurface(fields[:, POSITION], triangles, is_rib, way, fields[:, DISTANCE] / level)


def level_off(fields: Reals, column: int, level: float) -> None:
    """Moves values so near to the level off it that a cut would pass through vertices."""
    above = fields[:, column] - level
    fields[:, column] = level + np.where(above < 0, -1, 1) * np.maximum(abs(above), OFF_LEVEL * level)


class _Ground:
    """What is solid from the lowest point up to the base's height: there distances are below half the width."""

    def __init__(self, vertices: Reals, shape: RibShape) -> None:
        self._up, self._level = np.array(shape.up), 0.5 * shape.width
        self._top = float((vertices @ self._up).min()) + shape.base
        self._is_wanted = shape.base > 0.0

    def distance(self, places: Reals, distance: Reals) -> Reals:
        """The less (n,) of the distance (n,) to lines and that to the base, of places (n, 3)."""
        return np.minimum(distance, self._level + places @ self._up - self._top) if self._is_wanted else distance


def _too_long(fields: Reals, triangles: Indices, width: float) -> NDArray[np.bool_]:
    """Sides (t, 3) that are longer than half the width and may come nearer to a line than that, but for those deep in
    the base.
    """
    places, distance = fields[triangles, POSITION], fields[triangles, DISTANCE]
    length = np.linalg.norm(np.roll(places, -1, axis=1) - places, axis=2)
    # A distance changes by no more than the way.
    both = distance + np.roll(distance, -1, axis=1)
    long: NDArray[np.bool_] = (length > 0.5 * width) & (both - length < width) & (both + length > -width)
    return long


def _surface_points(mesh: Any, places: Reals, triangles: Indices, face: Indices, first: int) -> Any:
    """The refined mesh's vertices from `first` on as points of the mesh; `face` (t,) is where its triangles lie."""
    owner = np.empty(len(places), np.int64)
    owner[triangles.ravel()] = np.repeat(np.arange(len(triangles)), 3)
    faces = face[owner[first:]]
    corners = mesh.vertices[mesh.triangles[faces]]
    away = corners - places[first:, None]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    opposite = np.cross(np.roll(away, -1, axis=1), np.roll(away, -2, axis=1))
    weights = np.maximum(np.einsum("nij,nj->ni", opposite, normal), 0.0)
    return native.load().SurfacePoints(faces, weights / weights.sum(axis=1, keepdims=True))


def _length(mesh: Any, cells: Any) -> float:
    """Returns the length of all lines between cells, and of the mesh's border."""
    steps = np.diff(np.asarray(cells.edge_points), axis=0)
    steps = np.delete(steps, np.asarray(cells.edge_offsets)[1:-1] - 1, axis=0)
    start, end, _ = border_edges(np.asarray(mesh.triangles), len(mesh.vertices))
    return float(sum(np.linalg.norm(ways, axis=1).sum() for ways in (steps, mesh.vertices[end] - mesh.vertices[start])))


class _Lines:
    """The lines between cells in straight pieces, each with the cell it bounds."""

    def __init__(self, mesh: Any, cells: Any, width: float) -> None:
        points, offsets = np.asarray(cells.edge_points), np.asarray(cells.edge_offsets)
        line = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
        inner = np.flatnonzero(line[1:] == line[:-1])
        sides = np.asarray(cells.edge_cells, np.int32).reshape(-1, 2)[line[inner]]
        rim_first, rim_second, rim_cell = _rim(mesh, cells, 0.5 * width)
        self.first = np.concatenate([points[inner], points[inner], rim_first])
        self.second = np.concatenate([points[inner + 1], points[inner + 1], rim_second])
        self.owner = np.concatenate([sides[:, 0], sides[:, 1], rim_cell])
        self.cells = cells

    def distance(self, places: Reals, points: Any, progress: Progress) -> Reals:
        """Distance (n,) to the lines around each point's own cell, straight through space; inf where there is none."""
        progress.check()
        own = self.cells.cells_at(points)
        with progress.stage(progress.fraction, "measuring ribs") as job:
            found: Reals = native.load().segment_distances(places, own, self.first, self.second, self.owner, job=job)
        return found


def _rim(mesh: Any, cells: Any, step: float) -> tuple[Reals, Reals, Indices]:
    """The mesh's border in pieces no longer than `step`: their ends (m, 3) and the cell (m,) of each piece's middle."""
    triangles, vertices = np.asarray(mesh.triangles), np.asarray(mesh.vertices)
    start, end, face = border_edges(triangles, len(vertices))
    if not len(start):
        return np.empty((0, 3)), np.empty((0, 3)), np.empty(0, np.int32)
    pieces = np.maximum(np.ceil(np.linalg.norm(vertices[end] - vertices[start], axis=1) / step), 1).astype(np.int64)
    edge = np.repeat(np.arange(len(start)), pieces)
    number = np.arange(len(edge)) - np.repeat(np.cumsum(pieces) - pieces, pieces)

    def along(share: Reals) -> Reals:
        places: Reals = vertices[start[edge]] + share[:, None] * (vertices[end] - vertices[start])[edge]
        return places

    middle = (number + 0.5) / pieces[edge]
    is_start, is_end = (triangles[face[edge]] == ends[edge][:, None] for ends in (start, end))
    barycentric = is_start * (1 - middle)[:, None] + is_end * middle[:, None]
    cell = cells.cells_at(native.load().SurfacePoints(face[edge], barycentric))
    return along(number / pieces[edge]), along((number + 1) / pieces[edge]), cell

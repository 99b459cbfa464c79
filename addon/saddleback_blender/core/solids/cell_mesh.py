# SPDX-License-Identifier: GPL-3.0-or-later
"""The cells of a tessellation as a mesh: a gap between cells, a bevelled rim, a raised plateau.

Input is the split mesh (every triangle inside one cell). The distance to the boundary of the own cell is linear over
the triangles; the mesh is cut where it equals half the gap, and again one inset further in, where the plateau begins.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .. import native
from ..progress import Progress
from ..results import CellMesh
from .boundary_distance import find_boundary
from .cell_solid import Raised, raise_surface
from .crossings import find_crossings, is_deep
from .level_cut import Cut, cut_at_level, open_chords, split_edges
from .room import Solid, beside, fit, has_any, surface_of

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Lengths = float | Floats  # one, or one for each cell

POSITION, DIRECTION, DISTANCE, WITHIN = slice(0, 3), slice(3, 6), 6, 7
# Of the way from a cell's rim to its middle: where a dome has lines of vertices, so that it turns by as much from each
# to the next, and is off by 2 % of its height at most.
DOME_LINES = tuple(1.0 - math.cos(math.radians(turn)) for turn in (22.5, 45.0, 67.5))
DOME_STEP = 0.6  # as long as edges are at most, of half a cell's size
DOME_SMOOTHING = 8  # rounds, which take the ridges from where two sides of a cell are equally near
# A level line is off by this share of its distance from the boundary at most.
LEVEL_TOLERANCE = 0.2
# Of cells with lengths of their own: more levels than that are too many, and none is below this share of the largest.
MANY_LEVELS, LEAST_LEVEL = 4, 0.02
LEAST_FACTOR = 0.01  # paint that is fainter is none: slopes and joints of such cells would be thinner than rounding
END = 0.99  # of the run's progress
# A place without room becomes lower by this factor, down to a share of the height that could as well be flat.
THINNER, LEAST_SHARE, PATIENCE = 0.5, 0.001, 8
LOWER = 0.99  # of its height: a place that is lower than that is told
CRUMB = 0.02  # of a cell's largest piece: what the gap leaves of a ragged tip that is smaller goes, too


@dataclass(frozen=True)
class CellShape:
    """Lengths in the unit of the vertices: the gap between cells, the width of the rim, the height of the plateau."""

    gap: float = 0.0
    inset: float = 0.0
    thickness: float = 0.0
    underside: bool = False  # close each cell from below
    dome: float = 0.0  # 0: a plateau; 1: round from the rim to the middle
    # Of each cell, by its number (n,), what its lengths are multiplied by; None: by nothing.
    gap_by: Floats | None = None
    inset_by: Floats | None = None
    thickness_by: Floats | None = None

    def __post_init__(self) -> None:
        for name in ("gap", "inset", "thickness"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise ValueError(f"{name} is {value}: it must be a length of zero or more")
        if not 0.0 <= self.dome <= 1.0:
            raise ValueError(f"dome is {self.dome}: it must be between 0 and 1")

    @property
    def is_round(self) -> bool:
        """Tells whether there is anything of a dome."""
        return self.dome > 0.0 and self.thickness > 0.0

    @property
    def has_plateau(self) -> bool:
        """Tells whether a rim ends where something flat begins."""
        return self.inset > 0.0 and not (self.is_round and self.dome == 1.0)

    @property
    def rim_start(self) -> Lengths:
        """Distance from the cell boundary at which the cell begins, of each cell where they differ."""
        return _times(0.5 * self.gap, self.gap_by)

    @property
    def rim_width(self) -> Lengths:
        """The inset, of each cell where they differ."""
        return _times(self.inset, self.inset_by)

    @property
    def height(self) -> Lengths:
        """The thickness, of each cell where they differ."""
        return _times(self.thickness, self.thickness_by)

    @property
    def rim_end(self) -> Lengths:
        """Distance from the cell boundary at which the plateau begins."""
        return self.rim_start + self.rim_width

    @property
    def differs(self) -> bool:
        """Tells whether cells have lengths of their own."""
        return any(by is not None for by in (self.gap_by, self.inset_by, self.thickness_by))

    @property
    def levels(self) -> list[float]:
        """The distances from the cell boundary at which the mesh is cut; of many, those that are far apart."""
        found = np.unique([*np.ravel(self.rim_start), *(np.ravel(self.rim_end) if self.has_plateau else ())])
        found = found[found > LEAST_LEVEL * found[-1]]
        if len(found) > MANY_LEVELS:
            step = np.log1p(LEVEL_TOLERANCE)
            found = np.exp(step * np.unique(np.rint(np.log(found) / step)))
        levels: list[float] = found.tolist()
        return levels

    @property
    def cuts(self) -> bool:
        """Tells whether the cells differ from the split mesh before raising."""
        return self.gap > 0.0 or self.inset > 0.0 or self.is_round


@dataclass(frozen=True)
class CellPieces:
    """Holds what of a split mesh the gap leaves, and what its cells are raised by: all that no thickness
    changes.

    fields (n,7): position, direction, distance to the boundary of the cell; triangles (m,3), the cell of each (m,); the
    cells (k,) that the split mesh has.
    """

    fields: Floats
    triangles: Ints
    cells: Ints
    present: Ints

    @property
    def nbytes(self) -> int:
        """Returns what is kept in memory."""
        return self.fields.nbytes + self.triangles.nbytes + self.cells.nbytes + self.present.nbytes


def cell_pieces(
    vertices: Floats, triangles: Ints, triangle_cell: Ints, direction: Floats, shape: CellShape
) -> CellPieces:
    """Drop what lies within half the gap of a boundary from a split mesh: vertices (V,3), triangles (T,3), cells (T,),
    and which way (V,3) the surface is raised. Of the shape `gap` and `inset` matter, and whether it is round. O(T).
    """
    triangles = np.ascontiguousarray(triangles, dtype=np.int32)
    cells = np.ascontiguousarray(triangle_cell, dtype=np.int32)
    fields = np.column_stack([vertices, direction, np.zeros(len(vertices))])
    present = np.unique(cells)
    if shape.cuts and len(triangles):
        segments, _ = find_boundary(len(fields), triangles, cells)
        opened = open_chords(fields, triangles, segments)
        levels = shape.levels
        if shape.is_round:
            middle = 0.5 * math.sqrt(_doubled_areas(fields[:, POSITION], triangles).sum() / (2 * len(present)))
            levels = sorted({*levels, *(np.max(shape.rim_start) + share * middle for share in DOME_LINES)})
            opened = _split_long(opened, DOME_STEP * middle)
        fields, triangles, cells = native.load().refine_to_cell_boundary(
            opened.fields, opened.triangles, cells[opened.parent], levels, LEVEL_TOLERANCE
        )
    if shape.differs:
        fields, triangles = _apart(fields, triangles, cells)
    if shape.gap > 0.0 and len(triangles):
        outer = _cut_at_distance(fields, triangles, cells, shape.rim_start, 1.0)
        fields, triangles, cells = outer.fields, outer.triangles[outer.above], cells[outer.parent[outer.above]]
        kept = ~_is_crumb(fields[:, POSITION], triangles, cells)
        triangles, cells = triangles[kept], cells[kept]
    return CellPieces(*drop_unused(fields, triangles), cells, present)


def _times(length: float, by: Floats | None) -> Lengths:
    return float(length) if by is None else length * np.where(by < LEAST_FACTOR, 0.0, by)


def _of_each(lengths: Lengths, triangles: Ints, cells: Ints, count: int) -> Floats:
    """Lengths of cells -> those (count,) of the cells that vertices are in, which share none where they differ."""
    if isinstance(lengths, float):
        return np.full(count, lengths)
    own = np.zeros(count)
    own[triangles] = lengths[cells][:, None]
    return own


def _apart(fields: Floats, triangles: Ints, cells: Ints) -> tuple[Floats, Ints]:
    """Gives each cell vertices of its own. O(m log m)."""
    key = cells.astype(np.int64)[:, None] * len(fields) + triangles
    kept, corners = np.unique(key, return_inverse=True)
    return fields[kept % len(fields)], corners.reshape(-1, 3).astype(np.int32)


def _cut_at_distance(fields: Floats, triangles: Ints, cells: Ints, lengths: Lengths, otherwise: float) -> Cut:
    """Cuts along a distance from the boundary, one for each cell. What has a distance of 0 is not cut, but taken for
    above where `otherwise` is above 0.
    """
    if isinstance(lengths, float):
        return cut_at_level(fields, triangles, DISTANCE, lengths)
    own = _of_each(lengths, triangles, cells, len(fields))
    beyond = np.where(own > 0.0, fields[:, DISTANCE] - own, otherwise)
    cut = cut_at_level(np.column_stack([fields, beyond]), triangles, fields.shape[1], 0.0)
    found = np.ascontiguousarray(cut.fields[:, :-1])
    ends = _of_each(lengths, cut.triangles, cells[cut.parent], len(found))
    found[len(fields) :, DISTANCE] = ends[len(fields) :]  # to the last bit: a rim as high as rounding is no rim
    return replace(cut, fields=found)


def _doubled_areas(positions: Floats, triangles: Ints) -> Floats:
    """Twice the area of each triangle (m,)."""
    corners = positions[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    doubled: Floats = np.sqrt(np.einsum("ij,ij->i", normals, normals))
    return doubled


def _split_long(cut: Cut, longest: float) -> Cut:
    """Halves edges until none is longer, so that what is flat in a coarse mesh can be round. O(m) for each round."""
    parent = cut.parent
    while True:
        places = cut.fields[cut.triangles, POSITION]
        sides = np.linalg.norm(np.roll(places, -1, axis=1) - places, axis=2)
        if not (sides > longest).any():
            return replace(cut, parent=parent)
        cut = split_edges(cut.fields, cut.triangles, sides > longest)
        parent = parent[cut.parent]


def _is_crumb(positions: Floats, triangles: Ints, cells: Ints) -> NDArray[np.bool_]:
    """Tells which triangles (m,) belong to a piece that is tiny beside the largest of its cell. O(m)."""
    if not len(triangles):
        return np.zeros(0, np.bool_)
    part = native.load().connected_parts(triangles, len(positions))
    area = np.bincount(part, _doubled_areas(positions, triangles))
    largest = np.zeros(int(cells.max()) + 1)
    np.maximum.at(largest, cells, area[part])
    crumb: NDArray[np.bool_] = area[part] < CRUMB * largest[cells]
    return crumb


def raise_cells(pieces: CellPieces, shape: CellShape, progress: Progress) -> CellMesh:
    """Put an edge line where the plateau begins, and raise it as far as there is room.

    Each cell is an island of its own when there is a gap; without gap, inset and thickness vertices stay shared. With a
    thickness but no inset the sides are upright walls.
    """
    fields, triangles, cells = pieces.fields, pieces.triangles, pieces.cells
    if shape.has_plateau and len(triangles):
        ends = shape.rim_end if isinstance(shape.rim_width, float) else np.where(shape.rim_width > 0, shape.rim_end, 0)
        inner = _cut_at_distance(fields, triangles, cells, ends, -1.0)
        fields, triangles, cells = inner.fields, inner.triangles, cells[inner.parent]
    if shape.is_round:
        fields = np.column_stack([fields, _way_to_middle(fields[:, DISTANCE], triangles, cells, shape)])
        for share in DOME_LINES if len(triangles) else ():
            inner = cut_at_level(fields, triangles, WITHIN, share)
            fields, triangles, cells = inner.fields, inner.triangles, cells[inner.parent]
    is_left = np.zeros(pieces.present.max(initial=-1) + 1, dtype=np.bool_)
    is_left[cells] = True
    vanished = pieces.present[~is_left[pieces.present]]
    if shape.thickness > 0.0:
        height = _plateau_share(fields[:, DISTANCE], triangles, cells, shape)
        if shape.is_round:
            height = (1.0 - shape.dome) * height + shape.dome * _dome_share(fields[:, WITHIN], triangles, progress)
        height = _of_each(shape.height, triangles, cells, len(fields)) * height
        raised = raise_surface(fields[:, :6], triangles, height, shape.underside)
        owner = cells[raised.parent]
        above, thinner, crossing = _with_room(raised, owner, progress)
        feet = raised.base[raised.place]
        placed, triangles = drop_unused(np.column_stack([above, feet]), raised.triangles)
        vertices, feet = np.ascontiguousarray(placed[:, :3]), np.ascontiguousarray(placed[:, 3:])
        return CellMesh(vertices, feet, triangles, owner, vanished, thinner, crossing)
    positions, triangles = drop_unused(fields[:, POSITION], triangles)
    none = np.empty(0, np.int32)
    return CellMesh(positions, positions, triangles, cells, vanished, none, none)


def _with_room(raised: Raised, owner: Ints, progress: Progress) -> tuple[Floats, Ints, Ints]:
    """The vertices where there is room for them, and which of the triangles' cells (m,) are lower for want of it, and
    which still cross. Of what crosses by rounding alone nothing is told, though it is lowered, too.
    """
    solid = Solid(raised.triangles, raised.place, len(raised.base), raised.at, THINNER, LEAST_SHARE, PATIENCE)
    surface, deep = surface_of(solid), np.empty((0, 2), np.int32)
    has_no_room = np.zeros(solid.count, np.bool_)

    def find(vertices: Floats, triangles: Ints, among: Ints, job: object) -> Ints:
        nonlocal deep
        pairs = find_crossings(vertices, triangles, among, job)
        deep = pairs[is_deep(vertices, triangles, pairs)]
        has_no_room[beside(surface, np.unique(surface[deep]), solid.count)] = True
        return pairs

    fitted = fit(solid, find, END, "making room for the cells", progress)
    thinner = np.unique(owner[has_any(has_no_room & (fitted.share < LOWER), surface)])
    return fitted.vertices, thinner, np.unique(owner[deep])


def _way_to_middle(distance: Floats, triangles: Ints, cells: Ints, shape: CellShape) -> Floats:
    """How far (V,) from its cell's rim to the place farthest from it each vertex is: 0 to 1. O(m).

    A cell that is all of its part of the mesh has no rim: it is as high as the farthest place all over.
    """
    farthest = np.zeros(int(cells.max(initial=0)) + 1)
    np.maximum.at(farthest, np.repeat(cells, 3), distance[triangles].ravel())
    start = _of_each(shape.rim_start, triangles, cells, len(distance))
    room = _of_each(farthest, triangles, cells, len(distance)) - start
    within: Floats = np.ones(len(distance))
    np.divide(distance - start, np.maximum(room, 1e-300), out=within, where=np.isfinite(room))
    return np.clip(within, 0.0, 1.0)


def _dome_share(within: Floats, triangles: Ints, progress: Progress) -> Floats:
    """The height (V,) of a half ellipsoid as a part of the thickness, its ridges smoothed; the rim stays. O(m)."""
    means = native.load().neighbor_means
    share = within * (2.0 - within)
    for _ in range(DOME_SMOOTHING):
        progress.check()
        share = np.where(within > 0.0, 0.5 * (share + means(triangles, share[:, None])[:, 0]), share)
    round_share: Floats = np.sqrt(np.clip(share, 0.0, 1.0))
    return round_share


def _plateau_share(distance: Floats, triangles: Ints, cells: Ints, shape: CellShape) -> Floats:
    """The height (V,) as a part of the thickness: from 0 where the cell begins to 1 on the plateau."""
    start, width = (_of_each(of, triangles, cells, len(distance)) for of in (shape.rim_start, shape.rim_width))
    beyond = distance - start
    rising = np.divide(beyond, width, out=np.ones_like(distance), where=width > 0.0)
    return np.clip(rising, 0.0, 1.0)


def drop_unused(vertices: Floats, triangles: Ints) -> tuple[Floats, Ints]:
    """Leave out the vertices that no triangle uses."""
    used = np.zeros(len(vertices), dtype=np.bool_)
    used[triangles.ravel()] = True
    if used.all():
        return vertices, triangles
    number = np.cumsum(used, dtype=np.int32) - 1
    return vertices[used], number[triangles].astype(np.int32)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Holds what the core is given: arrays of one surface and a way to find it again."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass, fields, is_dataclass
from fractions import Fraction
from functools import cached_property, partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from .disk_cache import DiskCache
from .flowing_cells import FlowingCells
from .live_cells import LiveCells
from .results import EdgeMarks, Indices, Reals
from .settings import (
    BakeSettings,
    DirectionFieldSettings,
    DistanceSettings,
    DistributeSettings,
    PathSettings,
    RibbonSettings,
    TessellateSettings,
    Voronoi2dSettings,
)
from .shapes.shape_templates import ShapeTemplate, Solid
from .solids.cell_mesh import CellShape
from .solids.rib_surface import UPRIGHT

Number = TypeVar("Number", bound=np.generic)


@dataclass(frozen=True)
class Surface:
    """The triangles of one Blender mesh with its object's scale, without its loose vertices.

    It is seen from where the object stands, as it is turned; so are all places and directions beside it.
    `vertices` (n, 3) and `triangles` (F, 3), counter-clockwise seen from outside. `used` (n,) gives each vertex its
    number in the Blender mesh of `vertex_count` vertices; None where all are used. `kept` (F,) gives each triangle its
    number among the Blender mesh's; None where all are in the surface.
    """

    name: str  # of the object, for messages
    vertices: Reals
    triangles: Indices
    vertex_count: int
    used: Indices | None = None
    kept: Indices | None = None
    metric: str = ""  # names the lengths by which it is measured, where they are not those of space

    @cached_property
    def key(self) -> str:
        """Content hash: equal for equal geometry, whatever the object. O(n + F)."""
        digest = hashlib.blake2b(digest_size=16)
        digest.update(np.int64(len(self.vertices)).tobytes())
        digest.update(np.ascontiguousarray(self.vertices).data)
        digest.update(np.ascontiguousarray(self.triangles).data)
        return digest.hexdigest() + self.metric

    @cached_property
    def area(self) -> float:
        """The area of all triangles. O(F)."""
        corners = self.vertices[self.triangles]
        doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        return 0.5 * float(np.sqrt(np.einsum("ij,ij->i", doubled, doubled)).sum())

    @property
    def extent(self) -> float:
        """The diagonal of the box around all vertices."""
        return float(np.linalg.norm(np.ptp(self.vertices, axis=0)))

    @cached_property
    def _compact(self) -> Indices:
        numbers = np.full(self.vertex_count, -1, np.int32)
        numbers[self.used] = np.arange(len(self.vertices), dtype=np.int32)
        return numbers

    def of_mesh(self, faces: Indices) -> Indices:
        """Numbers of triangles -> numbers among the Blender mesh's."""
        return faces if self.kept is None else self.kept[faces]

    def of_part(self, values: NDArray[Number]) -> NDArray[Number]:
        """Values of the Blender mesh's triangles, in their first axis -> those of the surface's."""
        return values if self.kept is None else values[self.kept]

    def compact(self, vertices: NDArray[np.integer]) -> Indices:
        """Numbers in `vertices` of the Blender mesh's vertices, -1 for loose ones."""
        if self.used is None:
            return np.asarray(vertices, np.int32)
        found: Indices = self._compact[vertices]
        return found

    def gather(self, values: NDArray[np.floating]) -> Reals:
        """(V,) values of the Blender mesh's vertices -> (n,) of `vertices`."""
        return np.ascontiguousarray(values if self.used is None else values[self.used], np.float64)

    @cached_property
    def has_copies(self) -> bool:
        """Tells whether vertices of the Blender mesh are there several times: at barriers, where parts meet."""
        return self.used is not None and len(np.unique(self.used)) < len(self.used)

    def copies(self, vertices: NDArray[np.integer]) -> Indices:
        """Numbers in `vertices` of all copies of the Blender mesh's."""
        if self.used is None:
            return np.asarray(vertices, np.int32)
        return np.flatnonzero(np.isin(self.used, vertices)).astype(np.int32)

    def spread(self, values: NDArray[Number], fill: float, by: Reals | None = None) -> NDArray[Number]:
        """(n,) values of `vertices` -> (V,) of the Blender mesh's, loose ones `fill`; of copies that of least `by`."""
        if self.used is None:
            return values
        order = np.argsort(by, kind="stable")[::-1] if by is not None and self.has_copies else slice(None)
        full = np.full(self.vertex_count, fill, values.dtype)
        full[self.used[order]] = values[order]  # the last one written stays
        return full


def digest(*parts: object) -> str:
    """One short name for any mixture of numbers, strings and arrays, equal only for equal content."""
    hashed = hashlib.blake2b(digest_size=16)
    for part in parts:
        if isinstance(part, np.ndarray):
            hashed.update(f"{part.dtype.str}{part.shape}".encode())
            hashed.update(np.ascontiguousarray(part).data)
        else:
            hashed.update(repr(part).encode())
        hashed.update(b"\0")
    return hashed.hexdigest()


def content_of(call: object) -> str:
    """One short name for what a run, a `partial` with its request, does: equal where it would do the same. O(size)."""
    return digest(*_content(call))


def _content(value: object) -> Iterator[object]:
    if isinstance(value, (DiskCache, LiveCells, FlowingCells)):
        return
    if isinstance(value, partial):
        yield value.func.__qualname__
        yield from _content(value.args)
    elif isinstance(value, Surface):
        yield from (value.key, value.vertex_count, value.used, value.kept)
    elif is_dataclass(value):
        for field in fields(value):
            yield field.name
            if field.name != "threads":
                yield from _content(getattr(value, field.name))
    elif isinstance(value, (tuple, list)):
        yield len(value)
        for part in value:
            yield from _content(part)
    else:
        yield value


Direction = tuple[float, float, float]
Points = NDArray[np.int32] | Reals  # vertices of the Blender mesh (n,), or places (n, 3)


@dataclass(frozen=True)
class Polyline:
    """A curve through places (n, 3), back to the first where closed."""

    points: Reals
    closed: bool


@dataclass(frozen=True)
class StrokeLine(Polyline):
    """A curve that a field shall follow; a hard one is met exactly."""

    hard: bool
    label: str  # whose it is, for messages


@dataclass(frozen=True)
class SingularPlace:
    """A place about which a field shall turn; an index of None is one unit of the field's symmetry."""

    place: Reals  # (3,)
    index: Fraction | None
    name: str  # of the empty, for messages


@dataclass(frozen=True)
class CurvatureDensity:
    """High where the surface bends much."""


@dataclass(frozen=True)
class DistanceDensity:
    """High at curves."""

    curves: tuple[Polyline, ...]


@dataclass(frozen=True)
class SpreadDensity:
    """Known at some vertices of the Blender mesh (k,), by values (k,), and smooth between."""

    vertices: Indices
    values: Reals
    label: str  # of what it was painted in, for messages


# (V,) values at the Blender mesh's vertices, or what the core makes them from.
Density = Reals | CurvatureDensity | DistanceDensity | SpreadDensity


@dataclass(frozen=True)
class CellPaint:
    """What lengths of cells are multiplied by at the Blender mesh's vertices (V,), None: by nothing."""

    gap: Reals | None = None
    inset: Reals | None = None
    thickness: Reals | None = None


@dataclass(frozen=True)
class TessellateRequest:
    """One tessellation. `density` and `sites` speak of the Blender mesh's vertices."""

    surface: Surface
    settings: TessellateSettings
    density: Density | None = None
    sites: Points | None = None  # None: place `settings.count`
    marked_edges: Indices | None = None  # (n, 2) of the Blender mesh: some of the count stay on them
    marks: EdgeMarks | None = None  # of the Blender mesh, for the dual mesh to inherit
    paint: CellPaint = CellPaint()
    field: DirectionFieldRequest | None = None  # along which cells are stretched; None: along none
    threads: int = 0
    disk: DiskCache | None = None  # None: graphs are kept in memory only
    live: LiveCells | None = None  # shown the cells while they are relaxed
    flowing: FlowingCells | None = None  # cells to go on from
    up: Direction = UPRIGHT  # the world's, where something stands on a base


@dataclass(frozen=True)
class BakeRequest:
    """Images of the cells of one tessellation."""

    cells: TessellateRequest
    settings: BakeSettings
    shape: CellShape  # of the height
    uv: Reals  # (3 F, 2) UV places of the triangles' corners
    tiles: tuple[int, ...]  # numbers of the UDIM tiles, 1001 without tiles
    polygons: Indices  # (F,) polygon of the Blender mesh that each triangle is part of, for messages
    directions: Reals | None = None  # (3 F, 3) at the triangles' corners, in the axes that are wanted
    vertex_cell: Indices | None = None  # (V,) of the Blender mesh: the cells that are seen there, where they are known
    up: Direction = UPRIGHT  # the world's
    threads: int = 0


@dataclass(frozen=True)
class DistanceRequest:
    """One distance field, from the nearest of `sources`: points, or curves that are brought to the surface."""

    surface: Surface
    settings: DistanceSettings
    sources: Points | tuple[Polyline, ...]
    threads: int = 0
    disk: DiskCache | None = None


@dataclass(frozen=True)
class PathRequest:
    """Shortest paths between points in their order, or between all pairs of them."""

    surface: Surface
    settings: PathSettings
    points: Points
    threads: int = 0
    disk: DiskCache | None = None


@dataclass(frozen=True)
class RibbonRequest:
    """Bands along curves that are brought to the surface."""

    surface: Surface
    settings: RibbonSettings
    curves: tuple[Polyline, ...]
    aspect: float = 1.0  # how many times as long as wide is what a band shows
    solid: Solid | None = None  # laid on the bands; None: the bands themselves are seen
    threads: int = 0


@dataclass(frozen=True)
class GivenDirections:
    """A vector attribute: directions on the Blender mesh's vertices, or on its polygons."""

    vectors: Reals  # (V, 3) or (polygons, 3)
    symmetry: int
    label: str  # for messages
    polygons: Indices | None = None  # (F,) polygon of each triangle, where the vectors are on polygons


@dataclass(frozen=True)
class DirectionFieldRequest:
    """One field of directions."""

    surface: Surface
    settings: DirectionFieldSettings
    strokes: tuple[StrokeLine, ...] = ()
    singularities: tuple[SingularPlace, ...] | None = None  # None: the field chooses them
    polygons: Indices | None = None  # (F,) polygon that each triangle is part of; of the domain FACE
    painted: GivenDirections | None = None  # followed where there are any


@dataclass(frozen=True)
class ClassOrder:
    """What one class of shapes has of its own; None: as all have it. Values (V,) are the Blender mesh's vertices'."""

    density: Reals | None = None
    direction: GivenDirections | float | None = None  # a number: degrees from the common field, counter-clockwise
    size: Reals | None = None  # factors


@dataclass(frozen=True)
class KeptShapes:
    """Shapes that lie there already, (n,) of each."""

    shape: Indices
    points: Reals  # (n, 3) centers
    ahead: Reals  # (n, 3) their x axes, at right angles to
    up: Reals  # (n, 3) the surface's smooth normals
    scales: Reals
    mirrored: NDArray[np.bool_]


@dataclass(frozen=True)
class DistributeRequest:
    """Shapes to be laid on a surface without touching each other."""

    surface: Surface
    settings: DistributeSettings
    templates: tuple[ShapeTemplate, ...]
    density: Density | None = None
    field: DirectionFieldRequest | GivenDirections | None = None  # None: the smoothest lines
    forbidden: NDArray[np.bool_] | None = None  # (V,) of the Blender mesh: where no shape may lie
    classes: tuple[ClassOrder, ...] = ()  # one a template, or none
    kept: KeptShapes | None = None
    threads: int = 0
    disk: DiskCache | None = None


@dataclass(frozen=True)
class Voronoi2dRequest:
    """One diagram of the plane. `sites` speaks of the Blender mesh's vertices, or of places."""

    surface: Surface
    settings: Voronoi2dSettings
    polygons: Indices  # (F,) polygon of the Blender mesh that each triangle is part of, for messages
    uv: Reals | None = None  # (3 F, 2) UV places of the triangles' corners, of the space UV
    is_mirrored: bool = False  # by the object's scale: the UV map is seen from behind
    sites: Points | None = None  # None: place `settings.count`
    weights: Reals | None = None  # one for each of `sites`
    darkness: Reals | None = None  # (rows, columns) 0 to 1, the first row below; of the sites source IMAGE
    circles: Reals | None = None  # (m, 3) places that sweep circles grow from, where they are chosen
    threads: int = 0

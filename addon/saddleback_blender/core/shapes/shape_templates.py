# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes what is laid on a surface: an outline, and what stands on it as a small mesh in the outline's own units."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..results import Indices, Reals

Parts = tuple[tuple[Reals, ...], ...]  # each an outline (n, 2) and its holes

SIDES = 1  # among the materials of a shape with a picture: that of its sides
FLAT_LIFT = 0.02  # of a shape's radius; twice what faces of bent copies may leave the surface by


@dataclass(frozen=True)
class Solid:
    """A mesh in the plane of a shape, z away from the surface. Polygon i: corners[offsets[i]:offsets[i + 1]]."""

    vertices: Reals  # (n, 3)
    corners: Indices
    offsets: Indices
    uv: Reals  # (corners, 2)
    smooth: NDArray[np.bool_]  # (polygons,)
    material: Indices  # (polygons,) of the shape's own list
    triangles: Indices | None = None  # (t, 3) corners of the triangles that polygons are made of; None = fans

    def parted(self) -> Indices:
        """(t, 3) corners of the triangles that the polygons are made of, one polygon's after the other's."""
        return fans(self.offsets) if self.triangles is None else self.triangles

    def moved(self, shift: Reals, scale: float) -> Solid:
        """Shifted by (3,), then scaled."""
        return replace(self, vertices=(self.vertices + shift) * scale)


@dataclass(frozen=True)
class Picture:
    """An image whose pixels were the coordinates of a shape's outline."""

    name: str
    columns: int
    rows: int
    is_transparent: bool  # somewhere
    color: tuple[float, ...]  # linear, the mean within the shape


@dataclass(frozen=True)
class ShapeTemplate:
    """One class of shapes, of circumradius 1 about the origin; x points along the field.

    Without a solid the surface itself is raised within the outline. `half_turn`: looks the same turned by half a turn.
    """

    name: str
    parts: Parts
    solid: Solid | None = None
    share: float = 1.0  # how many there shall be, to those of other classes
    size: float = 1.0  # to other classes
    source: str = ""  # name of the object that it was read from
    own_scale: tuple[float, float, float] = (1.0, 1.0, 1.0)  # of that object in the world
    # From the object's own space to the template's: shift (3,), then scale.
    shift: tuple[float, float, float] = (0.0, 0.0, 0.0)
    scale: float = 1.0
    materials: tuple[str, ...] = ()  # names of the solid's, where it has no one object that it was read from
    picture: Picture | None = None  # what it shows, where it was made from an image

    def uv_of(self, places: Reals) -> Reals:
        """(n, 2) where in its picture, or else in the square about its circle, places (n, 2) of the shape are."""
        if self.picture is None:
            return 0.5 + 0.5 * places
        pixels: Reals = places / self.scale - np.array(self.shift[:2])
        return pixels / (self.picture.columns, self.picture.rows)


def uv_of_classes(templates: Sequence[ShapeTemplate], classes: Indices, places: Reals) -> Reals:
    """(n, 2) what `uv_of` says of places (n, 2) in shapes of the classes (n,); those of class -1 are in none."""
    uv: Reals = 0.5 + 0.5 * places
    for number, template in enumerate(templates):
        rows = classes == number
        uv[rows] = template.uv_of(places[rows])
    return uv


def joined(solids: Sequence[Solid], slots: Sequence[int]) -> Solid:
    """Solids as one; each has its own `slots` of materials, one list after the other."""
    vertices = np.cumsum([0, *(len(solid.vertices) for solid in solids)])
    corners = np.cumsum([0, *(len(solid.corners) for solid in solids)])
    first = np.cumsum([0, *slots])
    return Solid(
        vertices=np.concatenate([solid.vertices for solid in solids]),
        corners=np.concatenate([solid.corners + vertices[i] for i, solid in enumerate(solids)]).astype(np.int32),
        offsets=np.concatenate([[0], *(solid.offsets[1:] + corners[i] for i, solid in enumerate(solids))]).astype(
            np.int32
        ),
        uv=np.concatenate([solid.uv for solid in solids]),
        smooth=np.concatenate([solid.smooth for solid in solids]),
        material=np.concatenate([solid.material + first[i] for i, solid in enumerate(solids)]).astype(np.int32),
        triangles=np.concatenate([solid.parted() + corners[i] for i, solid in enumerate(solids)]).astype(np.int32),
    )


def sized(template: ShapeTemplate) -> ShapeTemplate:
    """The template in units in which the largest class of its kind has circumradius 1."""
    size = template.size
    return replace(
        template,
        parts=tuple(tuple(loop * size for loop in part) for part in template.parts),
        solid=None if template.solid is None else template.solid.moved(np.zeros(3), size),
        scale=template.scale * size,
        size=1.0,
    )


def fitted(name: str, parts: Sequence[Sequence[Reals]], center: Reals, solid: Solid | None = None) -> ShapeTemplate:
    """A template of circumradius 1 about `center` (2,) of the given coordinates.

    A solid that is flat is lifted a little, since it could not be told from the surface on which it lies.
    """
    radius = max(float(np.linalg.norm(loop - center, axis=1).max()) for part in parts for loop in part)
    scale = 1.0 / radius if radius > 0 else 1.0
    moved = tuple(tuple((loop - center) * scale for loop in part) for part in parts)
    is_flat = solid is not None and bool((np.abs(solid.vertices[:, 2]) * scale < FLAT_LIFT).all())
    shift = (-float(center[0]), -float(center[1]), FLAT_LIFT / scale if is_flat else 0.0)
    own = None if solid is None else solid.moved(np.array(shift), scale)
    return ShapeTemplate(name, moved, own, shift=shift, scale=scale)


def dome(outline: Reals, levels: Reals, heights: Reals) -> Solid:
    """A solid over an outline (m, 2) that sees all of itself from the origin: rings drawn in towards it.

    Ring k is the outline times levels[k], at heights[k]; the last ring is closed by a fan about the origin at the last
    height.
    """
    count, rings = len(outline), len(levels)
    ring = levels[:, None, None] * outline[None]
    z = np.repeat(heights[:, None], count, axis=1)
    vertices = np.concatenate([np.dstack([ring, z]).reshape(-1, 3), [[0.0, 0.0, heights[-1]]]])
    here = np.arange(rings * count).reshape(rings, count)
    onward = np.roll(here, -1, axis=1)
    quads = np.stack([here[:-1], onward[:-1], onward[1:], here[1:]], axis=-1).reshape(-1, 4)
    fan = np.stack([here[-1], onward[-1], np.full(count, rings * count)], axis=-1)
    corners = np.concatenate([quads.ravel(), fan.ravel()]).astype(np.int32)
    sizes = np.concatenate([np.full(len(quads), 4), np.full(len(fan), 3)])
    return Solid(
        vertices, corners, np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32), box_uv(vertices)[corners],
        np.ones(len(sizes), bool), np.zeros(len(sizes), np.int32),
    )  # fmt: skip


def fans(offsets: Indices) -> Indices:
    """(t, 3) corners of triangles that polygons are made of, each of them convex, about its first corner."""
    sizes = np.diff(offsets)
    first = np.repeat(offsets[:-1], sizes - 2)
    ends = np.cumsum(sizes - 2)
    step = np.arange(len(first)) - np.repeat(ends - (sizes - 2), sizes - 2)
    return np.stack([first, first + step + 1, first + step + 2], axis=1).astype(np.int32)


def box_uv(vertices: Reals) -> Reals:
    """(n, 2) places in the unit square, along and across the shape, its longer side as long as the square's."""
    low, high = vertices[:, :2].min(axis=0), vertices[:, :2].max(axis=0)
    extent = float((high - low).max()) or 1.0
    places: Reals = 0.5 + (vertices[:, :2] - (low + high) / 2) / extent
    return places


def rounded(corners: Reals, radius: float, steps: int = 6) -> Reals:
    """A convex outline (m, 2), counter-clockwise, its corners replaced by arcs that begin `radius` before them."""
    before, after = np.roll(corners, 1, axis=0) - corners, np.roll(corners, -1, axis=0) - corners
    share = np.linspace(0.0, 1.0, steps + 1)[:, None]
    pieces = []
    for corner, back, ahead in zip(corners, before, after, strict=True):
        a = corner + back * min(0.5, radius / np.linalg.norm(back))
        b = corner + ahead * min(0.5, radius / np.linalg.norm(ahead))
        pieces.append((1 - share) ** 2 * a + 2 * share * (1 - share) * corner + share**2 * b)
    points = np.concatenate(pieces)
    moved = np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1) > 1e-9
    outline: Reals = points[moved]
    return outline

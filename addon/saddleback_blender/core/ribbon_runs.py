# SPDX-License-Identifier: GPL-3.0-or-later
"""Bands along curves of a surface, and what is laid on them: an image, or the faces of a mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from . import cache as cache_module
from . import native
from .cache import Cache
from .errors import BadInputError
from .fields.ribbon_curves import ribbon_curves
from .graphs import GraphChoice, graph_of_surface, mesh_of_surface
from .progress import Progress
from .requests import RibbonRequest, digest
from .results import Anchors, Indices, Reals
from .shapes.bent_copies import border
from .shapes.divided_solids import divided
from .shapes.shape_templates import Solid, joined
from .surfaces.ground import Ground
from .surfaces.normals import normals_at

GUIDE = GraphChoice("FAST", 0)  # curves are joined by short ways
EDGES_PER_WIDTH = 8.0  # of what is laid on a band: enough to follow it
LEAST_AREA = 1e-12  # of a square as wide as the ribbon: smaller triangles hold nothing
MOST_VERTICES = 5_000_000  # of all that is laid on bands
MOST_WIDTHS = 300  # in the length of a band: its map takes some ten seconds


@dataclass(frozen=True)
class RibbonResult:
    """Ribbons as one mesh, and what a person is told of them."""

    solid: Solid
    anchors: Anchors  # of its vertices
    lengths: Reals  # (m,) of the ribbons
    repeats: Indices  # (m,) how often what they show is there
    coverage: float  # share of the bands that is there
    reach: float  # of half the width: how far the surface reaches, on the side of a curve where that is least


@dataclass(frozen=True)
class _Strip:
    """The surface beside a curve, laid flat."""

    vertices: Reals  # (n, 3) on the surface
    up: Reals  # (n, 3) its unit normals
    uv: Reals  # (n, 2) along the curve, and distance from it, positive to the left
    triangles: Indices  # (t, 3)
    length: float
    area: float
    coverage: float

    @property
    def reach(self) -> float:
        """How far from the curve the surface reaches, on the side where that is less."""
        return float(min(self.uv[:, 1].max(), -self.uv[:, 1].min()))

    @property
    def nbytes(self) -> int:
        """Memory of the arrays."""
        return self.vertices.nbytes + self.up.nbytes + self.uv.nbytes + self.triangles.nbytes


def ribbons(request: RibbonRequest, progress: Progress, cache: Cache | None = None) -> RibbonResult:
    """Ribbons along all curves.

    Raises BadInputError, the library's MeshError and InputError with sentences, and its Cancelled.
    """
    cache = cache or cache_module.shared
    settings, surface = request.settings, request.surface
    radius = settings.width / 2
    if not 0.0 < settings.width <= surface.extent:
        problem = "no ribbons" if settings.width <= 0.0 else f"wider than the whole surface, {surface.extent:.3g}"
        raise BadInputError(
            f"'{surface.name}': ribbons of width {settings.width:.3g} are {problem}; choose another width"
        )
    mesh = mesh_of_surface(surface, progress, cache)
    curves = digest(*(part for curve in request.curves for part in (curve.points, curve.closed)))
    strips = cache.get(
        ("strips", GUIDE.name(surface), digest(curves, radius)),
        lambda: _strips(request, mesh, radius, progress, cache),
        lambda found: sum(strip.nbytes for strip in found),
    )
    pieces = []
    with progress.stage(0.95, "laying ribbons"):
        repeats = [_repeats(request, strip) for strip in strips]
        _check_size(request, repeats)
        for strip, count in zip(strips, repeats, strict=True):
            progress.check()
            piece = _band(request, strip, count) if request.solid is None else _laid(request, strip, count, progress)
            pieces.append(piece)
        solid = joined([piece for piece, _ in pieces], [0] * len(pieces))
        anchors = Ground(surface, mesh).anchors(solid.vertices, np.concatenate([feet for _, feet in pieces]), progress)
    progress.check()
    wanted = sum(strip.area / strip.coverage for strip in strips)
    return RibbonResult(
        solid=solid,
        anchors=anchors,
        lengths=np.array([strip.length for strip in strips]),
        repeats=np.array(repeats, np.int32),
        coverage=sum(strip.area for strip in strips) / wanted,
        reach=min(strip.reach for strip in strips) / radius,
    )


def _strips(request: RibbonRequest, mesh: Any, radius: float, progress: Progress, cache: Cache) -> list[_Strip]:
    sb, surface = native.load(), request.surface
    graph = graph_of_surface(surface, mesh, GUIDE, request.threads, None, progress, cache)
    curves = ribbon_curves(surface.name, surface.extent, mesh, graph, request.curves, radius, progress)
    strips = []
    for number, curve in enumerate(curves):
        widths = float(curve.length) / (2 * radius)
        if widths > MOST_WIDTHS:
            raise BadInputError(
                f"'{surface.name}': ribbon {number + 1} would be {widths:,.0f} times as long as wide, more than the "
                f"{MOST_WIDTHS:,} that are allowed; make it wider, or draw a path instead"
            )
        with progress.stage(0.7 + 0.2 * (number + 1) / len(curves), "laying the surface flat") as job:
            try:
                found = sb.stroke_map(mesh, curve, radius, job=job)
            except sb.InputError as error:
                raise BadInputError(f"'{surface.name}': ribbon {number + 1}: {error}") from error
        if not len(found.triangles):
            raise BadInputError(f"'{surface.name}': ribbon {number + 1} has no room on the surface; make it narrower")
        places = found.points
        strips.append(
            _Strip(
                vertices=np.asarray(found.vertices),
                up=normals_at(mesh.vertices, mesh.triangles, places.faces, places.barycentric),
                uv=np.asarray(found.uv),
                triangles=np.asarray(found.triangles),
                length=float(found.length),
                area=float(found.area),
                coverage=float(found.coverage),
            )
        )
    return strips


def _aspect(request: RibbonRequest) -> float:
    """How many times as long as wide is what a ribbon shows."""
    if request.solid is None:
        return request.aspect
    size = np.ptp(request.solid.vertices[:, :2], axis=0)
    return float(size[0] / size[1])


def _repeats(request: RibbonRequest, strip: _Strip) -> int:
    if request.settings.repeat == "STRETCH":
        return 1
    return max(1, round(strip.length / (request.settings.width * _aspect(request))))


def _check_size(request: RibbonRequest, repeats: list[int]) -> None:
    count = 0 if request.solid is None else sum(repeats) * len(request.solid.vertices)
    if count > MOST_VERTICES:
        raise BadInputError(
            f"'{request.surface.name}': the object would be laid {sum(repeats):,} times, with {count:,} vertices, more "
            f"than the {MOST_VERTICES:,} that are allowed; make the ribbon wider, or choose a simpler object"
        )


def _band(request: RibbonRequest, strip: _Strip, repeats: int) -> tuple[Solid, Reals]:
    """The strip above the surface, a plain one with walls down to it; and where its vertices stand.

    Where it was cut, along the cut locus and at a closed curve's ends, it is sewn: corners have the places in the map.
    """
    _, first, number = np.unique(strip.vertices, axis=0, return_index=True, return_inverse=True)
    feet, up = strip.vertices[first], strip.up[first]
    triangles = number.reshape(-1)[strip.triangles].astype(np.int32)
    lift, radius = request.settings.lift, request.settings.width / 2
    top = feet + lift * up
    uv = strip.uv[strip.triangles].reshape(-1, 2) * [repeats / strip.length, 0.5 / radius] + [0.0, 0.5]
    sizes = np.full(len(triangles), 3)
    smooth = np.ones(len(triangles), bool)
    corners = triangles.ravel()
    if request.settings.show == "BAND" and lift > 0.0:
        begin, end = border(triangles)
        rim, ends = np.unique(np.concatenate([begin, end]), return_inverse=True)
        begin_of, end_of = ends.reshape(2, -1) + len(top)
        # Walls have vertices of their own, or the band would be shaded as if it were round there.
        walls = np.stack([begin_of + len(rim), end_of + len(rim), end_of, begin_of], axis=1)
        across = _uv_of(triangles, uv, len(top))
        corners = np.concatenate([corners, walls.ravel()]).astype(np.int32)
        uv = np.concatenate([uv, across[np.stack([begin, end, end, begin], axis=1).ravel()]])
        sizes = np.concatenate([sizes, np.full(len(walls), 4)])
        smooth = np.concatenate([smooth, np.zeros(len(walls), bool)])
        top, feet = np.concatenate([top, top[rim], feet[rim]]), np.concatenate([feet, feet[rim], feet[rim]])
    solid = Solid(
        vertices=top,
        corners=corners,
        offsets=np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32),
        uv=uv,
        smooth=smooth,
        material=np.zeros(len(sizes), np.int32),
    )
    return solid, feet


def _uv_of(triangles: Indices, uv: Reals, count: int) -> Reals:
    """(count, 2) UV places of vertices, where corners have several one of them."""
    places = np.zeros((count, 2))
    places[triangles.ravel()] = uv
    return places


def _laid(request: RibbonRequest, strip: _Strip, repeats: int, progress: Progress) -> tuple[Solid, Reals]:
    """The solid along the strip, so often, and where its vertices stand."""
    assert request.solid is not None
    sb, settings = native.load(), request.settings
    low, size = request.solid.vertices[:, :2].min(axis=0), np.ptp(request.solid.vertices[:, :2], axis=0)
    scale = settings.width / size[1]
    stretch = strip.length / repeats / size[0]
    step = size[1] / EDGES_PER_WIDTH
    one = divided(request.solid, (step * scale / stretch, step), progress)
    solid = joined([one] * repeats, [0] * repeats)
    along = (one.vertices[:, 0] - low[0]) * stretch
    flat = np.zeros((repeats, len(one.vertices), 3))
    flat[:, :, 0] = along + np.arange(repeats)[:, None] * (strip.length / repeats)
    flat[:, :, 1] = (one.vertices[:, 1] - low[1] - size[1] / 2) * scale
    # Triangles for themselves, without needles that rounding leaves no area, are a mesh whatever the strip's border is.
    first, second, third = (strip.uv[strip.triangles[:, i]] for i in range(3))
    ahead, aside = second - first, third - first
    doubled = ahead[:, 0] * aside[:, 1] - ahead[:, 1] * aside[:, 0]
    triangles = strip.triangles[doubled > LEAST_AREA * settings.width**2]
    loose = np.dstack([strip.uv[triangles], np.zeros((len(triangles), 3))]).reshape(-1, 3)
    plane = sb.Mesh(loose, np.arange(len(loose), dtype=np.int32).reshape(-1, 3))
    feet, tops = np.empty_like(solid.vertices), np.empty_like(solid.vertices)
    places = flat.reshape(-1, 3)
    height = settings.lift + scale * solid.vertices[:, 2]
    for rows in progress.blocks(len(places)):
        found = sb.project(plane, places[rows])
        corners = triangles[found.faces]
        feet[rows] = np.einsum("ni,nij->nj", found.barycentric, strip.vertices[corners])
        up = np.einsum("ni,nij->nj", found.barycentric, strip.up[corners])
        tops[rows] = feet[rows] + height[rows, None] * up / np.linalg.norm(up, axis=1, keepdims=True)
    return Solid(tops, solid.corners, solid.offsets, solid.uv, solid.smooth, solid.material), feet

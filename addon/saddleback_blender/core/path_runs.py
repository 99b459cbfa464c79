# SPDX-License-Identifier: GPL-3.0-or-later
"""Shortest paths between chosen points: a chain, a loop, or all pairs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from . import cache as cache_module
from . import native
from .cache import Cache
from .errors import BadInputError
from .graphs import GraphChoice, graph_of_surface, mesh_of_surface
from .progress import Progress
from .requests import PathRequest, Surface, digest
from .results import Indices, PathsResult, Reals
from .surfaces.normals import normals_at
from .surfaces.surface_places import compact_points, surface_points

MOST_PAIRS = 20_000  # more lines than that hide what they should show
MOST_LINE_POINTS = 1_000_000  # of all lines: they are about half a gigabyte, here and in Blender
MOST_POINTS = 500  # of a chain: more are no stations on a way but a selection by mistake, and take minutes


def paths(request: PathRequest, progress: Progress, cache: Cache | None = None) -> PathsResult:
    """Paths along a surface.

    Raises BadInputError, the library's MeshError and InputError with sentences, and its Cancelled.
    """
    cache = cache or cache_module.shared
    settings, surface = request.settings, request.surface
    chosen = compact_points(surface, request.points, "point")
    mesh = mesh_of_surface(surface, progress, cache)
    points = surface_points(mesh, chosen)
    is_to_farthest = settings.points == "CURSOR"
    connect = "CHAIN" if is_to_farthest else settings.connect
    order = _different(mesh, points, connect == "LOOP")
    if not is_to_farthest:
        _check(surface, mesh, points, order, connect)
    choice = GraphChoice(settings.quality, settings.k)
    ways: _Ways
    if choice.is_exact:
        ways = _ExactWays(mesh)
    else:
        graph = graph_of_surface(surface, mesh, choice, request.threads, request.disk, progress, cache)
        ways = _GraphWays(graph, settings.shorten)

    def solve() -> PathsResult:
        if is_to_farthest:
            return _result(mesh, [_to_farthest(ways, mesh, points, progress)], False)
        closed = connect == "LOOP" and len(order) > 2
        if settings.smooth and connect != "PAIRS":
            guide = GraphChoice("FAST", 0) if choice.is_exact else choice
            line = _smooth(
                mesh, graph_of_surface(surface, mesh, guide, request.threads, request.disk, progress, cache),
                _take(points, order), closed, progress,
            )  # fmt: skip
        else:
            legs = list(_bounded(surface, _legs(ways, points, order, connect, progress)))
            if connect == "PAIRS":
                return _result(mesh, legs, False)
            line = _joined(legs, closed)
        if settings.tighten and closed:
            line = _tight(surface, mesh, line, progress)
        return _result(mesh, [line], closed)

    how = connect, is_to_farthest, settings.shorten and not choice.is_exact, settings.smooth, settings.tighten
    key = ("paths", choice.name(surface), digest(chosen, *how))
    result = cache.get(key, solve, lambda result: result.nbytes)
    progress.check()
    return result


class _Line:
    """A polyline on the surface as plain arrays."""

    def __init__(self, points: Reals, faces: Indices, barycentric: Reals, length: float) -> None:
        self.points, self.faces, self.barycentric, self.length = points, faces, barycentric, length

    @classmethod
    def of(cls, path: Any) -> _Line:
        """The library's path."""
        return cls(path.points, path.surface.faces, path.surface.barycentric, float(path.length))


class _Ways(Protocol):
    """Holds where shortest paths come from."""

    def paths(self, source: Any, targets: Any, job: Any) -> list[Any]:
        """One path of the library's from the source to each of the targets."""

    def distances(self, source: Any, job: Any) -> Reals:
        """Distance (V,) of the mesh's vertices, inf where no path leads."""


class _GraphWays:
    """Finds ways over the arcs of a distance graph, pulled straight where that is asked for."""

    def __init__(self, graph: Any, shorten: bool) -> None:
        self._graph, self._shorten = graph, shorten

    def paths(self, source: Any, targets: Any, job: Any) -> list[Any]:
        if len(targets) == 1:  # looks at a part of the graph only
            return [self._graph.path(source[0], targets[0], shorten=self._shorten, job=job)]
        return list(self._graph.paths(source, targets, shorten=self._shorten, job=job))

    def distances(self, source: Any, job: Any) -> Reals:
        values: Reals = self._graph.distances(source, job=job)
        return values


class _ExactWays:
    """Back through the windows of an exact field, a new one for each source."""

    def __init__(self, mesh: Any) -> None:
        self._mesh = mesh

    def paths(self, source: Any, targets: Any, job: Any) -> list[Any]:
        return list(native.load().ExactField(self._mesh, source, job=job).paths(targets))

    def distances(self, source: Any, job: Any) -> Reals:
        values: Reals = native.load().exact_distances(self._mesh, source, job=job)
        return values


def _to_farthest(ways: _Ways, mesh: Any, source: Any, progress: Progress) -> _Line:
    """The path from a point to the vertex that is farthest from it."""
    with progress.stage(0.8, "looking for the farthest point") as job:
        distances = ways.distances(source, job)
    farthest = np.argmax(np.where(np.isfinite(distances), distances, -1.0))
    face, corner = np.unravel_index(np.argmax(mesh.triangles == farthest), mesh.triangles.shape)
    target = native.load().SurfacePoints(np.array([face], np.int32), np.eye(3)[[corner]])
    with progress.stage(0.98, "following the shortest paths") as job:
        return _Line.of(ways.paths(source, target, job)[0])


def _legs(ways: _Ways, points: Any, order: NDArray[np.int64], connect: str, progress: Progress) -> Iterator[_Line]:
    """The paths one by one; those from one point are a step of the progress."""
    if connect == "PAIRS":
        steps = [(order[i : i + 1], order[i + 1 :]) for i in range(len(order) - 1)]
    else:
        ends = order if connect == "LOOP" and len(order) > 2 else order[:-1]
        steps = [(order[i : i + 1], np.roll(order, -1)[i : i + 1]) for i in range(len(ends))]
    begin = progress.fraction
    for number, (source, targets) in enumerate(steps):
        with progress.stage(_share(begin, number + 1, len(steps)), "following the shortest paths") as job:
            found = ways.paths(_take(points, source), _take(points, targets), job)
        yield from (_Line.of(path) for path in found)


def _bounded(surface: Surface, legs: Iterator[_Line]) -> Iterator[_Line]:
    """The paths as long as there is room for them."""
    count = 0
    for leg in legs:
        count += len(leg.points)
        if count > MOST_LINE_POINTS:
            raise BadInputError(
                f"'{surface.name}': the paths would have more than {MOST_LINE_POINTS:,} points; choose fewer places to "
                "connect, or connect them as a chain"
            )
        yield leg


def _take(points: Any, chosen: NDArray[np.int64]) -> Any:
    """Some of the points: vertices or anything on the surface."""
    if isinstance(points, np.ndarray):
        return points[chosen]
    return native.load().SurfacePoints(points.faces[chosen], points.barycentric[chosen])


def _share(begin: float, done: int, count: int) -> float:
    return begin + (0.98 - begin) * done / count


def _joined(legs: list[_Line], closed: bool) -> _Line:
    """One line; where legs meet their common point stands once."""
    last = None if not closed else -1
    ends = [-1] * (len(legs) - 1) + [last]
    return _Line(
        np.concatenate([leg.points[:end] for leg, end in zip(legs, ends, strict=True)]),
        np.concatenate([leg.faces[:end] for leg, end in zip(legs, ends, strict=True)]),
        np.concatenate([leg.barycentric[:end] for leg, end in zip(legs, ends, strict=True)]),
        sum(leg.length for leg in legs),
    )


def _smooth(mesh: Any, graph: Any, points: Any, closed: bool, progress: Progress) -> _Line:
    """The smooth curve through points."""
    with progress.stage(0.9, "joining the points by a smooth curve") as job:
        curve = native.load().curve_through(graph, points, closed=closed, smooth=True, job=job)
    places = curve.points.positions(mesh)
    end = -1 if closed and (places[0] == places[-1]).all() else None
    return _Line(places[:end], curve.points.faces[:end], curve.points.barycentric[:end], float(curve.length))


def _tight(surface: Surface, mesh: Any, line: _Line, progress: Progress) -> _Line:
    """A closed line pulled tight without leaving its homotopy class. Raises BadInputError where nothing holds it."""
    sb = native.load()
    curve = sb.SurfaceCurve(mesh, sb.SurfacePoints(line.faces, line.barycentric), closed=True)
    with progress.stage(0.98, "pulling the chain tight") as job:
        path = sb.shorten_curve(curve, job=job)
    if path.length == 0.0:
        raise BadInputError(
            f"'{surface.name}': nothing holds the closed chain, so that it contracts to a point when pulled tight; "
            "lead it around a neck, a handle or a hole"
        )
    return _Line.of(path)


def _result(mesh: Any, lines: list[_Line], closed: bool) -> PathsResult:
    faces = np.concatenate([line.faces for line in lines])
    barycentric = np.concatenate([line.barycentric for line in lines])
    return PathsResult(
        points=np.concatenate([line.points for line in lines]),
        normals=normals_at(mesh.vertices, mesh.triangles, faces, barycentric),
        offsets=np.cumsum([0, *(len(line.points) for line in lines)]).astype(np.int32),
        closed=np.full(len(lines), closed),
        lengths=np.array([line.length for line in lines]),
    )


def _different(mesh: Any, points: Any, is_loop: bool) -> NDArray[np.int64]:
    """The points that are not at the place of the one before them."""
    places = mesh.vertices[points] if isinstance(points, np.ndarray) else points.positions(mesh)
    kept = np.ones(len(places), bool)
    kept[1:] = (places[1:] != places[:-1]).any(axis=1)
    order = np.flatnonzero(kept)
    if is_loop and len(order) > 1 and (places[order[0]] == places[order[-1]]).all():
        order = order[:-1]
    return order


def _check(surface: Surface, mesh: Any, points: Any, order: NDArray[np.int64], connect: str) -> None:
    count = len(order)
    if count < 2:
        raise BadInputError(
            f"'{surface.name}': a path needs two points at different places, and there is "
            f"{'only one' if len(points) == 1 else 'one place only'}; choose another one, too"
        )
    if connect != "PAIRS" and count > MOST_POINTS:
        raise BadInputError(
            f"'{surface.name}': a path through {count:,} points is more than the {MOST_POINTS} that are allowed; "
            "choose fewer: the ends, and where it shall turn"
        )
    pairs = count * (count - 1) // 2
    if connect == "PAIRS" and pairs > MOST_PAIRS:
        raise BadInputError(
            f"'{surface.name}': all pairs of {count} points are {pairs:,} paths, more than the {MOST_PAIRS:,} that are "
            "allowed; choose fewer points, or connect them as a chain"
        )
    vertices = points if isinstance(points, np.ndarray) else mesh.triangles[points.faces, 0]
    parts = mesh.components[vertices[order]]
    strange = np.flatnonzero(parts != parts[0])
    if len(strange):
        raise BadInputError(
            f"'{surface.name}': points {order[0] + 1} and {order[strange[0]] + 1} lie on parts of the surface that do "
            "not hang together, so no path joins them; choose points of one part"
        )

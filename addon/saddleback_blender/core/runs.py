# SPDX-License-Identifier: GPL-3.0-or-later
"""The runs themselves: from a request to a result through the native library and the cache."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import astuple, dataclass, replace
from typing import Any

import numpy as np

from ..looks import NO_LOOK
from . import cache as cache_module
from . import native
from .cache import Cache
from .cell_runs import cells_of, shape_of, shape_of_each
from .density_runs import density_of
from .fields.curve_points import curves_on_surface, points_along
from .flowing_cells import UNSEEN
from .graphs import GraphChoice, graph_of_surface, mesh_of_surface
from .isolines import isolines_of
from .lengths import RIB_SHARE
from .metrics import measured
from .progress import Progress
from .requests import Density, DistanceRequest, Points, Polyline, Surface, TessellateRequest, digest
from .results import CellsResult, DistanceResult, Dual, LampShell, Reals, SurfacePolygons
from .solids.boundary_distance import boundary_distance
from .solids.crossings import find_crossings
from .solids.rib_surface import RibShape, RibSurface, rib_surface
from .solids.shell_solid import thicken
from .surfaces.duals import dual_of, figures_of, finished
from .surfaces.features import feature_lines
from .surfaces.normals import upright_normals
from .surfaces.polygons import patches_of, polygons_of
from .surfaces.surface_places import compact_points, on_whole_surface, surface_points


def new_progress() -> Progress:
    """A progress to give to one run. Raises native.NativeMissingError."""
    sb = native.load()
    return Progress(sb.Job, sb.Cancelled)


def tessellate(request: TessellateRequest, progress: Progress, cache: Cache | None = None) -> CellsResult:
    """Cells of a surface. Only what changed since an earlier run is computed: mesh, graph, cells, cut, in this order.

    Raises BadInputError, the library's MeshError and InputError with sentences, and its Cancelled.
    """
    cache = cache or cache_module.shared
    settings, surface = request.settings, request.surface
    mesh, density, solved, key = solved_cells(request, progress, cache)
    result = _result(request, solved, density)
    has_mesh = settings.make_cells and not settings.makes_polygons
    if has_mesh or settings.write_edge_distance:
        with progress.stage(0.98, "cutting the cells out"):
            split = cache.get(("split", *key), solved.cells.split, _split_bytes)
    if settings.write_edge_distance:
        with progress.stage(0.985, "measuring the way to the edges"):
            found = cache.get(("edge distance", *key), lambda: _edge_distance(surface, split), lambda a: a.nbytes)
        result = replace(result, edge_distance=surface.spread(found, np.inf, found))
    if has_mesh:
        shape = shape_of_each(shape_of(settings), request, solved.cells.sites)
        made = cells_of(mesh, split, shape, key, progress, cache)
        result = replace(result, mesh=made)
    if settings.makes_polygons:
        result = replace(result, polygons=_polygons(request, mesh, solved, key, progress, cache))
    dual = _dual(request, mesh, solved, key, progress, cache)
    result = replace(result, figures=figures_of(dual, solved.normalized_energy))
    if settings.make_dual:
        result = replace(result, dual=on_whole_surface(dual, surface))
    if settings.make_shell:
        result = replace(result, shell=_shell(request, mesh, solved, key, progress, cache))
    progress.check()
    return result


def solved_cells(
    request: TessellateRequest, progress: Progress, cache: Cache
) -> tuple[Any, Reals | None, Solved, tuple[str, ...]]:
    """The library's mesh, the density (n,) of its vertices, the cells, and what names them in the cache."""
    settings, surface = request.settings, request.surface
    sites = None if request.sites is None else compact_points(surface, request.sites, "site")
    mesh = mesh_of_surface(surface, progress, cache)
    choice = GraphChoice(settings.quality, settings.k)
    space, metric = measured(request, mesh, progress, cache)
    graph = graph_of_surface(space, metric, choice, request.threads, request.disk, progress, cache)

    def graph_in_space() -> Any:
        if metric is mesh:
            return graph
        return graph_of_surface(surface, mesh, choice, request.threads, request.disk, progress, cache)

    density = density_of(request.density, surface, settings, mesh, graph_in_space, progress)
    moves = sites is None or settings.relax_sites
    iterations = settings.iterations if moves else 0
    frame = _frame(request, sites, iterations)
    what = digest(frame, density if sites is None or iterations else None)
    key = (choice.name(space), what)

    def of_paint(painted: Density | None) -> Reals | None:
        return density_of(painted, surface, settings, mesh, graph_in_space, progress)

    def solve() -> Solved:
        return _solve(request, mesh, graph, sites, density, iterations, of_paint, progress)

    if request.flowing is not None and sites is None and iterations:
        key, solved = _flow(request, (key[0], frame), what, mesh, graph, density, solve, progress, cache)
    elif request.live is None:
        solved = cache.get(("cells", *key), solve, _solved_bytes)
    else:  # to be looked at, however often it ran before, and perhaps stopped on the way
        solved = solve()
        density = request.live.density_used(density)
        key = (key[0], digest(what, density, solved.energy, "live"))
    if request.flowing is not None and sites is not None:
        request.flowing.show(solved.cells, 0)
    return mesh, density, replace(solved, frame=(choice.name(space), frame)), key


def _frame(request: TessellateRequest, sites: Points | None, iterations: int) -> str:
    """Names all that decides on the cells of a surface but the density, watched or not."""
    settings, unseen = request.settings, replace(request, live=None)
    return digest(
        settings.count if sites is None else sites,
        settings.seed if sites is None else 0,
        iterations,
        settings.method if iterations else "",
        _starts(unseen),
        _annealing(unseen, iterations),
        _closed_ball(request, iterations),
        *_held(request),
    )


def distance(request: DistanceRequest, progress: Progress, cache: Cache | None = None) -> DistanceResult:
    """Distance of every vertex to the nearest source, and its isolines. Raises as `tessellate` does."""
    cache = cache or cache_module.shared
    settings, surface = request.settings, request.surface
    sources = request.sources
    if not isinstance(sources, tuple):
        sources = compact_points(surface, sources, "source")
        if settings.sources == "CURSOR_PARTS":
            sources = _nearest_of_parts(surface, sources)
    mesh = mesh_of_surface(surface, progress, cache)
    choice = GraphChoice(settings.quality, settings.k)
    # Exact distances need no graph; curves are joined on the surface by one, and a quick one will do for that.
    graph: Any = None
    if not choice.is_exact or isinstance(sources, tuple):
        guide = GraphChoice("FAST", 0) if choice.is_exact else choice
        graph = graph_of_surface(surface, mesh, guide, request.threads, request.disk, progress, cache)
    limit = settings.limit if settings.limit > 0 else np.inf

    def found() -> tuple[list[Any], Any | None]:
        if isinstance(sources, tuple):
            with progress.stage(0.6, "following the curves"):
                return curves_on_surface(mesh, graph, sources)
        return [], surface_points(mesh, sources)

    def solve() -> Reals:
        curves, points = found()
        if choice.is_exact:
            with progress.stage(0.9, "measuring distances") as job:
                places = points_along(mesh, curves, points) if curves else points
                exact: Reals = native.load().exact_distances(mesh, places, limit=limit, job=job)
            return exact
        values = np.full(len(surface.vertices), np.inf)
        for number, part in enumerate((curves, points)):
            if part is not None and len(part):
                with progress.stage(0.8 + 0.1 * number, "measuring distances") as job:
                    values = np.minimum(values, graph.distances(part, limit=limit, job=job))
        return values

    def between(targets: Any) -> Reals:
        """At other points than vertices."""
        (curves, points), sb = found(), native.load()
        values = np.full(len(targets.faces), np.inf)
        if choice.is_exact:
            with progress.stage(0.95, "measuring distances between vertices") as job:
                field = sb.ExactField(mesh, points_along(mesh, curves, points) if curves else points, job=job)
            values = field.distance_to(targets)
        for part in () if choice.is_exact else (curves, points):
            if part is not None and len(part):
                with progress.stage(0.95, "measuring distances between vertices") as job:
                    values = np.minimum(values, graph.distances_to(part, targets, job=job))
        return np.where(values > limit, np.inf, values)

    key = ("distance", choice.name(surface), _digest_of(sources, limit))
    values = cache.get(key, solve, lambda array: array.nbytes)
    progress.check()
    isolines = isolines_of(surface, mesh, values, between, settings, progress) if settings.make_isolines else None
    return DistanceResult(surface.spread(values, np.inf, values), isolines)


def _nearest_of_parts(surface: Surface, place: Points) -> Points:
    """Of each part of a surface its vertex nearest to a place (1, 3); of one part the place itself."""
    parts = native.load().connected_parts(surface.triangles, len(surface.vertices))
    if not parts.any():
        return place
    part_of = np.full(len(surface.vertices), -1, np.int32)
    part_of[surface.triangles] = parts[:, None]
    order = np.argsort(((surface.vertices - place[0]) ** 2).sum(axis=1), kind="stable")
    order = order[part_of[order] >= 0]
    first: Points = order[np.unique(part_of[order], return_index=True)[1]].astype(np.int32)
    return first


def _digest_of(sources: Points | tuple[Polyline, ...], limit: float) -> str:
    if not isinstance(sources, tuple):
        return digest(sources, limit)
    return digest(limit, *(part for curve in sources for part in (curve.points, curve.closed)))


@dataclass(frozen=True)
class Solved:
    """Cells as the library gives them, and how they came about."""

    cells: Any
    site_positions: Reals
    site_normals: Reals
    energy: Reals
    iterations: int
    stop_reason: str
    normalized_energy: float | None  # None where nothing was relaxed
    exchanged: int  # sites that were moved for the sake of the dual mesh
    frame: tuple[str, str] = ("", "")  # of the result


def _held(request: TessellateRequest) -> tuple[object, ...]:
    """Returns what says on which lines sites stay."""
    settings = request.settings
    if request.sites is not None:
        return ()
    may_leave = settings.look != NO_LOOK and (settings.hold_sharp or settings.hold_boundary)
    return (settings.hold_sharp and settings.sharp_angle, settings.hold_boundary, request.marked_edges, may_leave)


def _lines(request: TessellateRequest, mesh: Any, metric: Any) -> list[Any]:
    """Curves to stay on: found by the shape in space, on the mesh by which cells are measured."""
    lines = feature_lines(request.surface, mesh, request.settings, request.marked_edges)
    return [native.load().SurfaceCurve(metric, line.points, line.closed) for line in lines]


def _starts(request: TessellateRequest) -> int:
    """Returns how many relaxations to choose from: one of sites that are given, or that is watched, is the only one."""
    settings = request.settings
    return settings.starts if settings.iterations and request.sites is None and request.live is None else 1


def _annealing(request: TessellateRequest, iterations: int) -> int:
    """Steps before the first one that is counted: none where sites stay, or are watched."""
    return request.settings.annealing if iterations and request.live is None else 0


def _closed_ball(request: TessellateRequest, iterations: int) -> bool:
    """Tells whether sites may be exchanged for the sake of the dual mesh: not those that are to stay where they are."""
    settings = request.settings
    wants_polygons = settings.makes_polygons and not settings.makes_patches
    return bool(iterations) and (settings.make_dual or wants_polygons) and settings.keep_count


def _solve(
    request: TessellateRequest,
    mesh: Any,
    graph: Any,
    sites: Points | None,
    density: Reals | None,
    iterations: int,
    density_of_paint: Callable[[Density | None], Reals | None],
    progress: Progress,
) -> Solved:
    sb, settings = native.load(), request.settings
    points = None if sites is None else surface_points(mesh, sites)
    energy, done, reason, normalized, exchanged = np.empty(0), 0, "sites kept", None, 0
    if points is None or iterations:
        choice: dict[str, Any] = {"sites": points}
        if points is None:
            choice = {"count": settings.count, "curves": _lines(request, mesh, graph.mesh) or None}
        live, is_newer = request.live, True
        with nullcontext() if live is None else live.follow(graph) as watch:
            while is_newer:
                with progress.stage(0.9, "evening out the cells", can_settle=live is not None) as job:
                    # To be watched from a start that is far from even; else from cells that are even on a coarse mesh.
                    cvt = sb.centroidal_voronoi(
                        graph, density=density, method=settings.method.lower(), max_iterations=iterations,
                        seed=settings.seed, starts=_starts(request), annealing=_annealing(request, iterations),
                        closed_ball=_closed_ball(request, iterations),
                        start="coarse_mesh" if live is None else "sample", least_move=0.0 if live is None else UNSEEN,
                        return_when_cancelled=live is not None, watch=watch, threads=request.threads, job=job, **choice,
                    )  # fmt: skip
                is_newer = live is not None and live.waits_for_density(progress)
                if live is not None and is_newer:
                    density, choice["sites"] = live.take_density(density_of_paint), cvt.sites
                    choice.pop("count", None)
                    choice.pop("curves", None)
        cells = cvt.cells
        energy, done, reason = np.asarray(cvt.energy, np.float64), int(cvt.iterations), str(cvt.stop_reason)
        normalized, exchanged = float(cvt.normalized_energy), int(cvt.exchanged)
    else:
        with progress.stage(0.9, "finding the cells") as job:
            cells = sb.geodesic_voronoi(graph, points, threads=request.threads, job=job)
    progress.check()
    return Solved(cells, *_places(mesh, cells), energy, done, reason, normalized, exchanged)


def _places(mesh: Any, cells: Any) -> tuple[Reals, Reals]:
    """Where the sites (n, 3) are, and the normals (n, 3) there."""
    faces, barycentric = cells.sites.faces, cells.sites.barycentric
    vertices, triangles = mesh.vertices, mesh.triangles
    positions = (barycentric[:, :, None] * vertices[triangles[faces]]).sum(axis=1)
    return positions, upright_normals(vertices, triangles, faces, barycentric)


def _flow(
    request: TessellateRequest,
    frame: tuple[str, str],
    what: str,
    mesh: Any,
    graph: Any,
    density: Reals | None,
    solve: Callable[[], Solved],
    progress: Progress,
    cache: Cache,
) -> tuple[tuple[str, str], Solved]:
    """Cells that go on from the last ones where only the density is another, and the key of what is made of them.

    Else they are those of any other run, after a sketch of them.
    """
    flowing, key = request.flowing, (frame[0], what)
    assert flowing is not None
    flow_key = (frame[0], digest(what, flowing.word))
    known = [found for found in (key, flow_key) if ("cells", *found) in cache]
    flowing.take_kept(frame, mesh)
    flows = not known and flowing.sites(frame) is not None and not _has_lines(request)

    def flow() -> Solved:
        made = flowing.flow(frame, graph, density, request.settings, request.threads, progress)
        places = _places(mesh, made.cells)
        return Solved(
            made.cells, *places, made.energy, made.iterations, made.stop_reason, made.normalized_energy, exchanged=0
        )

    if not known and not flows:
        flowing.sketch(graph, density, request.settings, request.threads, progress)
    key = known[0] if known else flow_key if flows else key
    solved = cache.get(("cells", *key), flow if flows else solve, _solved_bytes)
    flowing.keep(frame, solved.cells)
    return key, solved


def _has_lines(request: TessellateRequest) -> bool:
    """Tells whether sites are held on lines, or moved for the sake of the dual mesh."""
    settings = request.settings
    is_held = settings.hold_sharp or settings.hold_boundary or request.marked_edges is not None
    return is_held or _closed_ball(request, settings.iterations)


def _result(request: TessellateRequest, solved: Solved, density: Reals | None) -> CellsResult:
    cells, surface = solved.cells, request.surface
    return CellsResult(
        vertex_cell=surface.spread(cells.vertex_cell, -1, cells.vertex_distance),
        vertex_distance=surface.spread(cells.vertex_distance, np.inf, cells.vertex_distance),
        vertex_density=None if density is None else surface.spread(density, 0.0),
        frame=solved.frame,
        sites_position=solved.site_positions,
        sites_normal=solved.site_normals,
        cell_area=np.asarray(cells.areas, np.float64),
        edge_points=cells.edge_points,
        edge_offsets=cells.edge_offsets,
        edge_cells=cells.edge_cells,
        edge_closed=np.asarray(cells.edge_closed, bool),
        energy=solved.energy,
        iterations=solved.iterations,
        stop_reason=solved.stop_reason,
        exchanged=solved.exchanged,
        sites_tone=None if density is None else _tone(surface, solved.cells.sites, density),
    )


def _tone(surface: Surface, sites: Any, density: Reals) -> Reals:
    """The density (n,) where the sites are, 1 where it is highest."""
    corners = density[surface.triangles[sites.faces]]
    tone: Reals = np.einsum("ni,ni->n", sites.barycentric, corners) / max(float(density.max(initial=0.0)), 1e-300)
    return tone


def _polygons(
    request: TessellateRequest, mesh: Any, solved: Solved, key: tuple[str, ...], progress: Progress, cache: Cache
) -> SurfacePolygons:
    settings, surface = request.settings, request.surface

    def build() -> SurfacePolygons:
        if settings.makes_patches:
            return patches_of(mesh, settings, surface.extent, request.threads, progress)
        return polygons_of(mesh, solved.cells, settings.dual_policy, request.threads, progress)

    if settings.makes_patches:
        sharp = settings.hold_sharp and settings.sharp_angle
        found = cache.get(
            ("patches", surface.key, digest(settings.patch_error, sharp)), build, lambda made: made.nbytes
        )
        found = replace(found, added=len(found.polygon_cell) - len(solved.cells.sites))
    else:
        found = cache.get(("polygons", *key, settings.dual_policy), build, lambda made: made.nbytes)
    return on_whole_surface(found, request.surface)


def _dual(
    request: TessellateRequest, mesh: Any, solved: Solved, key: tuple[str, ...], progress: Progress, cache: Cache
) -> Dual:
    """The dual mesh that is wanted, or what figures are told of."""
    settings, surface, marks = request.settings, request.surface, request.marks
    policy = settings.dual_policy if settings.make_dual else "STRICT"
    has_quads = settings.dual_faces == "QUADS"

    def build() -> Dual:
        has_look = settings.look != NO_LOOK  # who asks for a picture gets one
        made = dual_of(solved.cells, policy, request.threads, progress, has_look)
        if not settings.make_dual:
            return made.dual
        lines = _lines(request, mesh, measured(request, mesh, progress, cache)[1]) if has_quads else None
        return finished(made, mesh, surface, marks, lines)

    extra: tuple[object, ...] = (has_quads, *_held(request)) if settings.make_dual else ()
    if settings.make_dual and marks is not None:
        extra = (*extra, marks.edges, marks.sharp, marks.seam, marks.crease)
    extra = (*extra, settings.look != NO_LOOK)
    return cache.get(("dual", *key, policy, digest(*extra)), build, lambda made: 2 * made.nbytes)


def _shell(
    request: TessellateRequest, mesh: Any, solved: Solved, key: tuple[str, ...], progress: Progress, cache: Cache
) -> LampShell:
    settings = request.settings
    width = progress.choose("rib_width", settings.rib_width, RIB_SHARE * math.sqrt(mesh.area / len(solved.cells.areas)))
    thickness = progress.choose("rib_thickness", settings.rib_thickness, width)

    shape, is_round = RibShape(width, settings.base_height, thickness, request.up), settings.rib_profile == "ROUND"

    def build() -> LampShell:
        with progress.stage(0.95, "making the ribs of the lamp shell"):
            ribs = rib_surface(request.surface.name, mesh, solved.cells, shape, progress)
            joined = _hanging_together(request, mesh, solved.cells, ribs, shape, progress)
        shell = thicken(joined.ribs, thickness, find_crossings, progress, is_round)
        return replace(shell, parts=int(mesh.component_count), added=joined.added)

    return cache.get(("shell", *key, digest(*astuple(shape), is_round)), build, lambda shell: shell.nbytes)


@dataclass(frozen=True)
class _JoinedRibs:
    """Ribs, and how many cells were added for them."""

    ribs: RibSurface
    added: int = 0


def _hanging_together(
    request: TessellateRequest, mesh: Any, cells: Any, ribs: RibSurface, shape: RibShape, progress: Progress
) -> _JoinedRibs:
    """The ribs, or those of more cells where that makes fewer pieces: a cell around a leg, say, leaves loose rings."""
    pieces = ribs.pieces
    if request.sites is not None or pieces <= mesh.component_count:
        return _JoinedRibs(ribs)
    try:
        dual = cells.dual("repair", threads=request.threads)
    except native.load().InputError:
        return _JoinedRibs(ribs)
    progress.check()
    more = rib_surface(request.surface.name, mesh, dual.cells, shape, progress)
    return _JoinedRibs(more, int(dual.added)) if more.pieces < pieces else _JoinedRibs(ribs)


def _edge_distance(surface: Surface, split: Any) -> Reals:
    """Distance (n,) of the surface's vertices to the nearest line between their cell and another."""
    triangles, cell = np.asarray(split.triangles), np.asarray(split.triangle_cell)
    all_of_them = boundary_distance(np.asarray(split.vertices), triangles, cell)
    origin = np.asarray(split.vertex_origin)
    found = np.full(len(surface.vertices), np.inf)
    found[origin[origin >= 0]] = all_of_them[origin >= 0]
    return found


def _solved_bytes(solved: Solved) -> int:
    cells = solved.cells
    arrays = (cells.vertex_cell, cells.vertex_distance, cells.edge_points, cells.edge_offsets, cells.edge_cells)
    # Twice: the library holds its own copy beside the arrays that it hands out.
    return 2 * sum(int(array.nbytes) for array in arrays) + solved.site_positions.nbytes + solved.site_normals.nbytes


def _split_bytes(split: Any) -> int:
    arrays = (split.vertices, split.triangles, split.triangle_cell, split.vertex_origin)
    return sum(int(array.nbytes) for array in arrays)

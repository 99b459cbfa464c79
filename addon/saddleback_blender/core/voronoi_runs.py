# SPDX-License-Identifier: GPL-3.0-or-later
"""Voronoi diagrams of the plane, on flat meshes and brought to surfaces."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from . import cache as cache_module
from . import devices, native
from .cache import Cache
from .cell_runs import cells_of, shape_of
from .errors import BadInputError
from .fields.darkness import darkness_at, places_by_density
from .progress import Progress
from .requests import Voronoi2dRequest, digest
from .results import CellPolygons, CellsResult, FlatCells, Indices, Reals, Voronoi2dResult
from .solids.cell_mesh import CellShape
from .solids.flat_cells import flat_cells
from .solids.flat_solid import raised_cells
from .solids.tile_solid import cut_to_tile
from .surfaces.normals import normals_at
from .surfaces.plane_frame import FLAT_FRAME, PlaneFrame
from .surfaces.spaces import Space, space_of
from .surfaces.surface_places import compact_points
from .surfaces.sweep import sweep_over
from .surfaces.tiles import Tile, tile_of


def voronoi_2d(request: Voronoi2dRequest, progress: Progress, cache: Cache | None = None) -> Voronoi2dResult:
    """A diagram on a surface. Sites and maps of earlier runs are used again.

    Raises BadInputError, the library's MeshError and InputError with sentences, and its Cancelled.
    """
    cache = cache or cache_module.shared
    settings = request.settings
    _check(request)
    space = space_of(request, progress, cache)
    what = digest(
        settings.space, settings.sites_source, settings.count, settings.seed, settings.iterations,
        settings.equal_cells, settings.seamless,
        request.uv, request.is_mirrored, request.sites, request.weights, request.darkness,
    )  # fmt: skip
    key = ("sites 2d", request.surface.key, what)
    sites = cache.get(key, lambda: _placed(request, space, progress), lambda s: s.nbytes)
    with progress.stage(0.8, "finding the cells") as job:
        if sites.powers is None:
            places = sites.places
            if settings.seamless:
                places = tile_of(space.loops, request.surface.name).copies(places)
            diagram = devices.plane_diagram(places, _weights(request, space), request.threads, progress, job)
        else:
            diagram = native.load().power_diagram_2d(sites.places, sites.powers, threads=request.threads, job=job)
    if space.frame is None:
        result = Voronoi2dResult(_lifted(request, space, sites, diagram, key[1:], progress, cache))
    else:
        result = _flat(request, space, sites, diagram, key[1:], progress, cache)
    progress.check()
    return result


@dataclass(frozen=True)
class _Sites:
    """Places in the plane (n, 2) and, but for flat meshes, the points of the surface there."""

    places: Reals
    faces: Indices | None = None  # (n,)
    barycentric: Reals | None = None  # (n, 3)
    tone: Reals | None = None  # (n,) how dark the image is there
    powers: Reals | None = None  # (n,) of cells of one size

    @classmethod
    def at(cls, space: Space, points: Any) -> _Sites:
        """Surface points, or vertices."""
        if not isinstance(points, np.ndarray):
            return cls(space.chart.places(points), points.faces.copy(), points.barycentric.copy())
        corners = space.mesh.triangles.ravel()
        first = np.full(len(space.mesh.vertices), -1, np.int64)
        first[corners[::-1]] = np.arange(len(corners))[::-1]
        corner = first[points]
        return cls(space.chart.corners[corner], (corner // 3).astype(np.int32), np.eye(3)[corner % 3])

    def moved(self, space: Space, places: Reals) -> _Sites:
        """Moves the sites that stay on the surface to their new places; the others stay."""
        found, inside = space.chart.locate(places)
        kept = np.where(inside[:, None], places, self.places)
        if self.faces is None or self.barycentric is None:
            return _Sites(kept)
        faces, barycentric = self.faces.copy(), self.barycentric.copy()
        faces[inside], barycentric[inside] = found.faces, found.barycentric
        return _Sites(kept, faces, barycentric)

    @property
    def nbytes(self) -> int:
        """Memory of the arrays."""
        return 4 * self.places.nbytes


def _check(request: Voronoi2dRequest) -> None:
    settings, name = request.settings, request.surface.name
    if settings.animate and settings.space != "OUTLINE":
        raise BadInputError(f"'{name}': the sweep is shown on flat meshes only; switch Animate off, or choose Outline")
    if settings.animate and settings.equal_cells:
        raise BadInputError(f"'{name}': the sweep shows cells of any size; switch Animate off, or Equal Cells")
    if settings.seamless:
        _check_seamless(request)
    if request.weights is not None and settings.equal_cells:
        raise BadInputError(
            f"'{name}': cells are as large as the weights say, or all alike; leave their name empty, or switch Equal "
            "Cells off"
        )


def _check_seamless(request: Voronoi2dRequest) -> None:
    settings, name = request.settings, request.surface.name
    for is_wrong, reason in (
        (settings.space != "OUTLINE", "only flat rectangles are; choose Outline"),
        (request.weights is not None, "sites with weights are not; leave their name empty"),
        (request.darkness is not None, "an image is not; choose other Sites"),
        (settings.equal_cells, "equal cells are not; switch one of both off"),
        (settings.animate, "the sweep is not; switch Animate off"),
    ):
        if is_wrong:
            raise BadInputError(f"'{name}': Seamless: {reason}")


def _weights(request: Voronoi2dRequest, space: Space) -> Reals | None:
    """The sites' weights as lengths of the plane, by the map's mean scale."""
    if request.weights is None or space.frame is not None:
        return request.weights
    scaled: Reals = request.weights * np.sqrt(space.chart.area / space.mesh.area)
    return scaled


def _placed(request: Voronoi2dRequest, space: Space, progress: Progress) -> _Sites:
    density = _darkness(request, space) if request.darkness is not None else None
    sites = _relaxed(request, space, _sites(request, space, density), density, progress)
    if request.settings.equal_cells:
        sites = _equal(request, space, sites, density, progress)
    return sites if density is None else replace(sites, tone=darkness_at(density, *space.box, sites.places))


def _sites(request: Voronoi2dRequest, space: Space, density: Reals | None) -> _Sites:
    """Returns where the sites are at first."""
    sb, settings, surface = native.load(), request.settings, request.surface
    if settings.sites_source == "COUNT":
        return _Sites.at(space, sb.sample(space.mesh, settings.count, seed=settings.seed))
    if request.sites is None:
        assert density is not None
        places = places_by_density(
            density, *space.box, settings.count, settings.seed,
            lambda tried: space.chart.locate(tried)[1],
        )  # fmt: skip
        return _Sites(places, np.zeros(len(places), np.int32), np.zeros((len(places), 3))).moved(space, places)
    points = compact_points(surface, request.sites, "site")
    if space.frame is not None:
        where: Reals = space.mesh.vertices[points] if points.ndim == 1 else np.asarray(points, np.float64)
        return _Sites(space.frame.to_plane(where))
    return _Sites.at(space, points if points.ndim == 1 else sb.project(space.mesh, points))


def _darkness(request: Voronoi2dRequest, space: Space) -> Reals:
    """The image as it lies over the domain's box, empty where no surface is."""
    assert request.darkness is not None
    density = request.darkness[:, ::-1] if request.is_mirrored and space.frame is None else request.darkness
    rows, columns = density.shape
    low, high = space.box
    x = low[0] + (np.arange(columns) + 0.5) / columns * (high[0] - low[0])
    y = low[1] + (np.arange(rows) + 0.5) / rows * (high[1] - low[1])
    _, inside = space.chart.locate(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2))
    covered: Reals = density * inside.reshape(rows, columns)
    if not covered.any():
        raise BadInputError(
            f"'{request.surface.name}': the image is white where the surface is; choose another, or Invert"
        )
    return covered


def _relaxed(
    request: Voronoi2dRequest, space: Space, sites: _Sites, density: Reals | None, progress: Progress
) -> _Sites:
    """The sites after the wanted steps. A step that would take a site off the surface is not taken."""
    settings = request.settings
    if settings.seamless:
        tile = tile_of(space.loops, request.surface.name)
        return replace(sites, places=tile.relaxed(sites.places, settings.iterations, request.threads, 0.7, progress))
    if not settings.iterations:
        return sites
    if space.frame is None and density is None:
        return _relaxed_on_surface(request, space, sites, progress)
    with progress.stage(0.7, "relaxing the sites") as job:
        relaxed = native.load().relax_2d(
            sites.places, space.loops, density, max_iterations=settings.iterations, tolerance=0.0,
            weights=request.weights, threads=request.threads, job=job,
        )  # fmt: skip
    return sites.moved(space, relaxed.sites)


def _equal(request: Voronoi2dRequest, space: Space, sites: _Sites, density: Reals | None, progress: Progress) -> _Sites:
    """Cells of one area, on the surface too, or of one share of the image's tone."""
    mass = _stretch(space) if space.frame is None and density is None else density
    balance = native.load().balance_2d
    most = 5  # steps: sites that were relaxed are nearly there
    with progress.stage(0.75, "making the cells equal") as job:
        done = balance(
            sites.places, space.loops, mass, max_iterations=min(most, request.settings.iterations), tolerance=0.0,
            threads=request.threads, job=job,
        )  # fmt: skip
    moved = sites.moved(space, done.sites)
    if (moved.places != done.sites).any():  # some would be off the surface: their cells stay where they are
        with progress.stage(0.78, "making the cells equal") as job:
            done = balance(moved.places, space.loops, mass, max_iterations=0, threads=request.threads, job=job)
    return replace(moved, powers=done.weights)


def _stretch(space: Space) -> Reals:
    """How much of the surface lies in each of many equal rectangles over the map's box, in proportion."""
    size = 512
    low, high = space.box
    middles = (np.arange(size) + 0.5) / size
    x, y = np.meshgrid(*(low[k] + middles * (high[k] - low[k]) for k in range(2)))
    points, inside = space.chart.locate(np.stack([x, y], axis=-1).reshape(-1, 2))
    corners = space.mesh.vertices[space.mesh.triangles]
    on_surface = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    u, v = (space.chart.corners.reshape(-1, 3, 2)[:, k] - space.chart.corners.reshape(-1, 3, 2)[:, 0] for k in (1, 2))
    shares = on_surface / np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    result = np.zeros(size * size)
    result[inside] = shares[points.faces]
    return result.reshape(size, size)


def _relaxed_on_surface(request: Voronoi2dRequest, space: Space, sites: _Sites, progress: Progress) -> _Sites:
    """Cells of equal area on the surface, not in its map: centers of mass by area on the surface."""
    begin, steps = progress.fraction, request.settings.iterations
    for number in range(steps):
        with progress.stage(begin + (0.7 - begin) * (number + 1) / steps, "relaxing the sites") as job:
            diagram = devices.plane_diagram(sites.places, _weights(request, space), request.threads, progress, job)
            centroids = space.chart.lift(diagram, threads=request.threads, job=job).centroids
            sites = sites.moved(space, np.where(np.isfinite(centroids), centroids, sites.places))
    return sites


def _lifted(
    request: Voronoi2dRequest,
    space: Space,
    sites: _Sites,
    diagram: Any,
    key: tuple[str, ...],
    progress: Progress,
    cache: Cache,
) -> CellsResult:
    with progress.stage(0.95, "bringing the cells to the surface") as job:
        lifted = space.chart.lift(diagram, threads=request.threads, job=job)
    result = replace(
        _bare_cells(space, sites, np.asarray(lifted.areas)),
        edge_points=lifted.edge_points,
        edge_offsets=lifted.edge_offsets,
        edge_cells=lifted.edge_cells,
        edge_closed=np.zeros(len(lifted.edge_of), bool),
    )
    if not request.settings.make_cells:
        return result
    mesh = cells_of(space.mesh, lifted.split(), shape_of(request.settings), key, progress, cache)
    return replace(result, mesh=mesh)


def _flat(
    request: Voronoi2dRequest,
    space: Space,
    sites: _Sites,
    diagram: Any,
    key: tuple[str, ...],
    progress: Progress,
    cache: Cache,
) -> Voronoi2dResult:
    assert space.frame is not None
    settings = request.settings
    with progress.stage(0.9, "cutting the cells out") as job:
        clipped = diagram.clip(space.loops, threads=request.threads, job=job)
    count = len(sites.places)  # of seamless cells there are nine copies
    flat = flat_cells(clipped, space.frame)
    flat = replace(
        flat,
        polygon_cell=flat.polygon_cell % count,
        edge_cells=np.where(flat.edge_cells < 0, -1, flat.edge_cells % count),
    )
    cells = _bare_cells(space, sites, np.asarray(clipped.areas).reshape(-1, count).sum(axis=0))
    polygons: CellPolygons | None = None
    vanished = 0
    if settings.make_cells and flat.has_holes:
        cells = _lifted(request, space, sites, diagram, key, progress, cache)
    elif settings.make_cells:
        with progress.stage(0.95, "shaping the cells") as job:
            polygons, vanished = _shaped(request, space, diagram, flat, count, job)
            polygons = replace(polygons, polygon_cell=polygons.polygon_cell % count)
    sweep = None
    if settings.animate:
        frames = settings.frame_end - settings.frame_start + 1
        with progress.stage(0.98, "following the sweep"):
            centers = _centers(request, space)
            sweep = sweep_over(sites.places, request.weights, flat, space, centers, frames, progress)
    return Voronoi2dResult(cells, flat, polygons, vanished, sweep)


def _centers(request: Voronoi2dRequest, space: Space) -> Reals | None:
    """Returns where circles grow from, in the plane; None for one from the middle."""
    assert space.frame is not None
    if request.circles is not None:
        return space.frame.to_plane(request.circles)
    settings = request.settings
    if settings.circles != "COUNT":
        return None
    sb = native.load()
    places = _Sites.at(space, sb.sample(space.mesh, settings.circle_count, seed=settings.seed)).places
    relaxed: Reals = sb.relax_2d(places, space.loops, max_iterations=20, threads=request.threads).sites
    return relaxed


def _shaped(
    request: Voronoi2dRequest, space: Space, diagram: Any, flat: FlatCells, count: int, job: Any
) -> tuple[CellPolygons, int]:
    """The cells with their gap, thickness and rim; and how many of the `count` the gap leaves nothing of."""
    settings, threads = request.settings, request.threads
    shape = shape_of(settings)
    if not shape.cuts and shape.thickness == 0:
        return flat, 0
    assert space.frame is not None
    has_rim = shape.inset > 0 and shape.thickness > 0
    tile = tile_of(space.loops, request.surface.name) if settings.seamless and has_rim else None
    loops = space.loops if tile is None else [tile.with_neighbors]
    base = diagram.clip(loops, gap=shape.gap, threads=threads, job=job)
    vanished = len(np.unique(flat.polygon_cell)) - len(np.unique(base.loop_sites % count))
    if shape.thickness == 0:  # a rim needs a height
        return flat_cells(base, space.frame), vanished
    plateau = diagram.clip(loops, gap=2 * shape.rim_end, threads=threads, job=job) if has_rim else None
    if tile is None:
        return raised_cells(base, plateau, space.frame, shape), vanished
    return _repeating(tile, base, plateau, count, space.frame, shape), vanished


def _repeating(tile: Tile, base: Any, plateau: Any, count: int, frame: PlaneFrame, shape: CellShape) -> CellPolygons:
    """Cells whose rims go on at the opposite side: whole ones, cut at the sides of the tile."""
    whole = raised_cells(base, plateau, FLAT_FRAME, replace(shape, underside=True), count)
    local = np.column_stack([tile.seen(whole.vertices[:, :2]), whole.vertices[:, 2]])
    cut = cut_to_tile(replace(whole, vertices=local), tile.size, shape.underside)
    heights = cut.vertices[:, 2:] * frame.axes[2]
    return replace(cut, vertices=frame.to_space(tile.shown(cut.vertices[:, :2])) + heights)


def _bare_cells(space: Space, sites: _Sites, areas: Reals) -> CellsResult:
    """Sites and areas, without edges and pieces."""
    vertices, triangles = space.mesh.vertices, space.mesh.triangles
    if space.frame is not None:
        positions = space.frame.to_space(sites.places)
        normals: Reals = np.tile(space.frame.axes[2], (len(positions), 1))
    else:
        assert sites.faces is not None and sites.barycentric is not None
        positions = (sites.barycentric[:, :, None] * vertices[triangles[sites.faces]]).sum(axis=1)
        normals = normals_at(vertices, triangles, sites.faces, sites.barycentric)
    indices, reals = np.empty(0, np.int32), np.empty(0)
    return CellsResult(
        vertex_cell=indices,
        vertex_distance=reals,
        vertex_density=None,
        sites_position=positions,
        sites_normal=normals,
        cell_area=areas,
        edge_points=np.empty((0, 3)),
        edge_offsets=np.zeros(1, np.int32),
        edge_cells=np.empty((0, 2), np.int32),
        edge_closed=np.empty(0, bool),
        energy=reals,
        iterations=0,
        stop_reason="",
        sites_tone=sites.tone,
    )

# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs on the half of an object, and their results on both sides."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from . import cache as cache_module
from . import distribute_runs, native, runs
from .errors import BadInputError
from .graphs import mesh_of_surface
from .progress import Progress
from .requests import DirectionFieldRequest, DistributeRequest, TessellateRequest
from .results import (
    BentCopies,
    CellMesh,
    CellsResult,
    DistributeResult,
    Dual,
    Indices,
    LampShell,
    PathsResult,
    PlacedShapes,
    Reals,
    ShapeValues,
    SurfacePolygons,
)
from .surfaces.corner_places import corner_places
from .surfaces.duals import with_corners
from .surfaces.mirrors import Mirror
from .surfaces.quaternions import quaternions_of, turned

Value = TypeVar("Value", bound=np.generic)
NEEDED = re.compile(r"count: the curves .*need (\d+) sites")  # what the library says where too few sites are asked for
MOST_TRIES = 8  # with more sites shorter lines count


def halved(request: TessellateRequest, mirror: Mirror) -> TessellateRequest:
    """The same for the half: some sites stay on the plane, so that their cells lie across it. Raises BadInputError."""
    settings, sites, edges = request.settings, request.sites, mirror.plane_edges()
    if sites is not None:
        sites = mirror.on_half(sites)
        if not len(sites):
            raise BadInputError(f"'{mirror.whole.name}': no site is on the side where X is above 0, which is mirrored")
    elif len(edges):
        count = settings.count
        vertices = np.unique(edges)
        ends = mirror.half.vertices[mirror.half.compact(edges)]
        across = float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum()) / np.sqrt(mirror.whole.area / count)
        settings = replace(settings, count=max(1, round((count + min(across, count, len(vertices))) / 2)))
    else:
        settings = replace(settings, count=max(1, round(settings.count / 2)))
    marked = edges if request.marked_edges is None else np.concatenate([request.marked_edges, edges])
    return replace(
        request,
        surface=mirror.half,
        field=None if request.field is None else replace(request.field, surface=mirror.half),
        sites=sites,
        settings=replace(settings, hold_marked=True),
        marked_edges=marked,
    )


def shapes_halved(request: DistributeRequest, mirror: Mirror) -> DistributeRequest:
    """The same for the half. Raises BadInputError."""
    if request.settings.make_cut:
        raise BadInputError(f"'{mirror.whole.name}': a Cut Mesh cannot be mirrored; switch it, or X Mirror, off")
    field = request.field
    if isinstance(field, DirectionFieldRequest):
        field = replace(field, surface=mirror.half)
    settings = replace(request.settings, count=max(1, round(request.settings.count / 2)))
    return replace(request, surface=mirror.half, settings=settings, field=field)


def tessellate(request: TessellateRequest, mirror: Mirror, progress: Progress) -> CellsResult:
    """Cells of both sides. Those whose sites are on the plane lie across it. Raises as `runs.tessellate`."""
    result = _on_half(request, progress)
    count = result.count
    on = mirror.is_on(result.sites_position)
    twins = np.arange(count, dtype=np.int32)
    twins[~on] = count + np.arange(int((~on).sum()), dtype=np.int32)
    sites, other_sites = mirror.both(result.sites_position, on)
    points, other_points = mirror.both(result.edge_points)
    return replace(
        result,
        vertex_cell=mirror.spread_numbers(result.vertex_cell, twins),
        vertex_distance=mirror.spread(result.vertex_distance),
        vertex_density=None if result.vertex_density is None else mirror.spread(result.vertex_density),
        edge_distance=None if result.edge_distance is None else mirror.spread(result.edge_distance),
        sites_position=np.concatenate([sites, other_sites[~on]]),
        sites_normal=np.concatenate([result.sites_normal, mirror.turned(result.sites_normal)[~on]]),
        cell_area=np.concatenate([np.where(on, 2.0, 1.0) * result.cell_area, result.cell_area[~on]]),
        sites_tone=None if result.sites_tone is None else _twice(result.sites_tone, ~on),
        edge_points=np.concatenate([points, other_points]),
        edge_offsets=np.concatenate([result.edge_offsets, result.edge_offsets[1:] + result.edge_offsets[-1]]),
        edge_cells=np.concatenate([result.edge_cells, twins[result.edge_cells]]),
        edge_closed=np.tile(result.edge_closed, 2),
        frame=("", ""),
        twin=np.concatenate([np.arange(count), np.flatnonzero(~on)]).astype(np.int32),
        mesh=None if result.mesh is None else _cells(result.mesh, mirror, twins),
        polygons=None if result.polygons is None else _polygons(result.polygons, mirror, twins, progress),
        dual=None if result.dual is None else _dual(result.dual, mirror, progress),
        shell=None if result.shell is None else _shell(result.shell, mirror),
    )


def _on_half(request: TessellateRequest, progress: Progress) -> CellsResult:
    """Cells of the half: where fewer are asked for than the line at the plane needs, of which the artist knows nothing,
    as many as it needs, and a note.
    """
    settings = request.settings
    for _ in range(MOST_TRIES):
        try:
            result = runs.tessellate(replace(request, settings=settings), progress)
        except native.load().InputError as error:
            needed = NEEDED.match(str(error))
            if needed is None:
                raise
            settings = replace(settings, count=int(needed[1]))
            continue
        if settings is not request.settings:
            progress.note(f"'{request.surface.name}': as few cells as X Mirror allows, since some lie across the plane")
        return result
    return runs.tessellate(replace(request, settings=settings), progress)


def distribute(request: DistributeRequest, mirror: Mirror, progress: Progress) -> DistributeResult:
    """Shapes on both sides, none across the plane. Raises as `distribute_runs.distribute`."""
    result = distribute_runs.distribute(request, progress)
    count = len(result.placed.shape)
    paths, anchors = result.outlines, mirror.anchors
    return replace(
        result,
        placed=_placed(result.placed, mirror, progress),
        twin=np.tile(np.arange(count, dtype=np.int32), 2),
        class_counts=2 * result.class_counts,
        text=f"on each side {result.text}",
        bent=None if result.bent is None else _bent(result.bent, mirror, count),
        bent_anchors=None if result.bent_anchors is None else anchors(result.bent_anchors),
        outlines=None if paths is None else _paths(paths, mirror),
        outline_anchors=None if result.outline_anchors is None else anchors(result.outline_anchors),
        values=None if result.values is None else _values(result.values, mirror, count),
    )


def _twice(values: NDArray[Value], again: NDArray[np.bool_]) -> NDArray[Value]:
    return np.concatenate([values, values[again]])


def _joined(
    vertices: Reals, feet: Reals, triangles: Indices, mirror: Mirror
) -> tuple[Reals, Reals, Indices, NDArray[np.bool_], NDArray[np.bool_]]:
    """A mesh and its mirror, one at the plane: vertices, feet, triangles; which vertices, which triangles of the half
    there are twice. Faces within the plane, which would be inside, are left out.
    """
    on = mirror.is_on(feet)
    twins = np.arange(len(vertices), dtype=np.int32)
    twins[~on] = len(vertices) + np.arange(int((~on).sum()), dtype=np.int32)
    both, standing = mirror.both(vertices, on), mirror.both(feet, on)
    seen = np.logical_not(np.all(on[triangles], axis=1)).reshape(-1)
    kept = triangles[seen]
    return (
        np.concatenate([both[0], both[1][~on]]),
        np.concatenate([standing[0], standing[1][~on]]),
        np.concatenate([kept, twins[kept][:, ::-1]]),
        ~on,
        seen,
    )


def _cells(mesh: CellMesh, mirror: Mirror, twins: Indices) -> CellMesh:
    vertices, feet, triangles, _, seen = _joined(mesh.vertices, mesh.feet, mesh.triangles, mirror)
    cells = mesh.triangle_cell[seen]
    return replace(
        mesh,
        vertices=vertices,
        feet=feet,
        triangles=triangles,
        triangle_cell=np.concatenate([cells, twins[cells]]),
        **{name: np.union1d(found, twins[found]) for name, found in _named(mesh)},
    )


def _named(mesh: CellMesh) -> list[tuple[str, Indices]]:
    return [(name, np.asarray(getattr(mesh, name), np.int32)) for name in ("vanished", "thinner", "crossing")]


def _dual(dual: Dual, mirror: Mirror, progress: Progress) -> Dual:
    vertices, _, polygons, twice, _ = _joined(dual.vertices, dual.vertices, dual.polygons, mirror)
    triangles = _joined(dual.vertices, dual.vertices, dual.triangles, mirror)[2]
    faces, barycentric = _on_whole(vertices[len(dual.vertices) :], mirror, progress)
    marks = dual.marks
    if marks is not None:
        twins = np.arange(len(dual.vertices), dtype=np.int32)
        twins[twice] = len(dual.vertices) + np.arange(int(twice.sum()), dtype=np.int32)
        marks = marks.along(marks.edges, twins[marks.edges])
    whole = replace(
        dual,
        vertices=vertices,
        triangles=triangles,
        faces=np.concatenate([dual.faces, faces]),
        barycentric=np.concatenate([dual.barycentric, barycentric]),
        added=dual.added + int(twice[dual.sites - dual.added : dual.sites].sum()),
        quads=None if dual.quads is None else polygons,
        marks=marks,
    )
    whole = with_corners(whole, _whole_mesh(mirror, progress))
    assert whole.corner_faces is not None
    return replace(whole, corner_faces=mirror.whole.of_mesh(whole.corner_faces))


def _polygons(polygons: SurfacePolygons, mirror: Mirror, twins: Indices, progress: Progress) -> SurfacePolygons:
    """Both sides; a cell across the plane is two polygons, with an edge along the plane between them."""
    count, on = len(polygons.vertices), mirror.is_on(polygons.vertices)
    both, other = mirror.both(polygons.vertices, on)
    number = np.arange(count, dtype=np.int32)
    number[~on] = count + np.arange(int((~on).sum()), dtype=np.int32)
    lengths = np.diff(polygons.offsets)
    ends = np.repeat(polygons.offsets[:-1] + polygons.offsets[1:] - 1, lengths)
    back = ends - np.arange(len(polygons.corners))
    vertices = np.concatenate([both, other[~on]])
    corners = np.concatenate([polygons.corners, number[polygons.corners[back]]])
    offsets = np.concatenate([polygons.offsets, polygons.offsets[1:] + polygons.offsets[-1]])
    own, others = _numbers_with_added(twins, polygons.added)
    cell = polygons.polygon_cell
    faces, barycentric = _on_whole(other[~on], mirror, progress)
    corner_faces, corner_barycentric = corner_places(_whole_mesh(mirror, progress), vertices, corners, offsets)
    return SurfacePolygons(
        vertices=vertices,
        corners=corners,
        offsets=offsets,
        polygon_cell=np.concatenate([own[cell], others[cell]]),
        faces=np.concatenate([polygons.faces, faces]),
        barycentric=np.concatenate([polygons.barycentric, barycentric]),
        corner_faces=mirror.whole.of_mesh(corner_faces),
        corner_barycentric=corner_barycentric,
        missing=np.union1d(polygons.missing, twins[polygons.missing]),
        added=2 * polygons.added,
    )


def _numbers_with_added(twins: Indices, added: int) -> tuple[Indices, Indices]:
    """Numbers of the half's cells, those that were added last, and of their mirrors: added ones come after all."""
    count, more = int(twins.max(initial=-1)) + 1, np.arange(added, dtype=np.int32)
    own = np.concatenate([np.arange(len(twins), dtype=np.int32), count + more])
    return own, np.concatenate([twins, count + added + more])


def _on_whole(points: Reals, mirror: Mirror, progress: Progress) -> tuple[Indices, Reals]:
    """Where places are on the whole surface: triangles of the Blender mesh (n,), weights (n, 3)."""
    found = native.load().project(_whole_mesh(mirror, progress), points)
    return mirror.whole.of_mesh(np.asarray(found.faces, np.int32)), np.asarray(found.barycentric)


def _whole_mesh(mirror: Mirror, progress: Progress) -> Any:
    return mesh_of_surface(mirror.whole, progress, cache_module.shared)


def _shell(shell: LampShell, mirror: Mirror) -> LampShell:
    vertices, feet, triangles, twice, _ = _joined(shell.vertices, shell.feet, shell.triangles, mirror)
    return replace(
        shell,
        vertices=vertices,
        feet=feet,
        triangles=triangles,
        is_thinner=_twice(shell.is_thinner, twice),
        wall=_twice(shell.wall, twice),
        crossing=2 * shell.crossing,
        added=2 * shell.added,
    )


def _placed(placed: PlacedShapes, mirror: Mirror, progress: Progress) -> PlacedShapes:
    points, others = mirror.both(placed.points)
    feet = np.einsum("ni,nij->nj", placed.barycentric, placed.corner_points)
    faces, _ = _on_whole(mirror.both(feet)[1], mirror, progress)
    corners = mirror.partner[placed.corners]
    corner_points = np.stack([mirror.both(placed.corner_points[:, i])[1] for i in range(3)], axis=1)
    x, z = (mirror.turned(turned(placed.rotations, np.tile(axis, (len(points), 1)))) for axis in np.eye(3)[[0, 2]])
    return PlacedShapes(
        shape=np.tile(placed.shape, 2),
        points=np.concatenate([points, others]),
        rotations=np.concatenate([placed.rotations, quaternions_of(x, np.cross(z, x), z)]),
        scales=np.concatenate([placed.scales, placed.scales * np.array([1.0, -1.0, 1.0])]),
        faces=np.concatenate([placed.faces, faces]),
        barycentric=np.tile(placed.barycentric, (2, 1)),
        corners=np.concatenate([placed.corners, corners]),
        corner_points=np.concatenate([placed.corner_points, corner_points]),
    )


def _bent(bent: BentCopies, mirror: Mirror, count: int) -> BentCopies:
    vertices, others = mirror.both(bent.vertices)
    # Polygons run the other way round.
    lengths = np.diff(bent.offsets)
    first = np.repeat(bent.offsets[:-1], lengths)
    last = np.repeat(bent.offsets[1:], lengths) - 1
    back = first + last - np.arange(len(bent.corners))
    # Those that fill gaps come behind all that were laid on both sides.
    copy, fillers = bent.polygon_copy, max(0, int(bent.polygon_copy.max(initial=-1)) + 1 - count)
    is_filler = copy >= count
    own, other = copy + np.where(is_filler, count, 0), copy + np.where(is_filler, count + fillers, count)
    return BentCopies(
        vertices=np.concatenate([vertices, others]),
        faces=np.tile(bent.faces, 2),
        barycentric=np.tile(bent.barycentric, (2, 1)),
        corners=np.concatenate([bent.corners, bent.corners[back] + np.int32(len(vertices))]),
        offsets=np.concatenate([bent.offsets, bent.offsets[1:] + bent.offsets[-1]]),
        uv=np.concatenate([bent.uv, bent.uv[back]]),
        smooth=np.tile(bent.smooth, 2),
        material=np.tile(bent.material, 2),
        polygon_copy=np.concatenate([own, other]).astype(np.int32),
        polygon_shape=np.tile(bent.polygon_shape, 2),
    )


def _paths(paths: PathsResult, mirror: Mirror) -> PathsResult:
    return PathsResult(
        points=np.concatenate(mirror.both(paths.points)),
        normals=np.concatenate([paths.normals, mirror.turned(paths.normals)]),
        offsets=np.concatenate([paths.offsets, paths.offsets[1:] + paths.offsets[-1]]),
        closed=np.tile(paths.closed, 2),
        lengths=np.tile(paths.lengths, 2),
    )


def _values(values: ShapeValues, mirror: Mirror, count: int) -> ShapeValues:
    twins = count + np.arange(count, dtype=np.int32)
    return ShapeValues(
        shape=mirror.spread_numbers(values.shape, twins),
        distance=mirror.spread(values.distance),
        uv=np.stack([mirror.spread(np.ascontiguousarray(column)) for column in values.uv.T], axis=1),
    )

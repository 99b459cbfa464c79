# SPDX-License-Identifier: MIT
"""Super-patches: a surface as few polygons, one for each cell, with its sharp edges among their sides."""

import hashlib
import math
import sys
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from saddleback._arrays import integer, real
from saddleback._saddleback import (
    CellPolygons,
    GeodesicVoronoi,
    HausdorffDistance,
    InputError,
    Job,
    Mesh,
    SaddleVertexGraph,
    SplitMesh,
    SurfacePoints,
    add_barriers,
    centroidal_voronoi,
    feature_curves,
    hausdorff_distance,
    principal_curvatures,
    project,
)
from saddleback.metrics import anisotropic_metric

_Floats = NDArray[np.float64]
_Indices = NDArray[np.integer]
_How = dict[str, Any]  # threads and job of a projection

# Cells are at most so many times as long as wide: longer ones are no fewer, and bend around ends.
_LONGEST = 8.0
_ITERATIONS = 3  # of a relaxation between two looks at the patches
_EVEN = 100  # of that of a given count
_ROUND = 0.08  # of what is left of the job, for each round: how many there will be is not known
_SLACK = 0.02  # of the error: what a distance may be less than it to be shown to be within it
_FLAT = 1e-12  # of the square of its longest side: twice the area of what is no triangle
# Where polygons' triangles are compared with the surface: weights of the corners.
_LATTICE = np.array([(i, j, 4 - i - j) for i in range(5) for j in range(5 - i)]) / 4


@dataclass(frozen=True, eq=False)
class SuperPatches:
    """Polygons that stand for a surface, and how well; made by `super_patches`. All lengths are in mesh units."""

    polygons: CellPolygons  #: `vertices`, `points`, `corners`, `offsets`; `is_barrier`: sides along sharp edges
    regions: SplitMesh  #: the mesh cut along the patches' boundaries
    region_patch: _Indices  #: (T,) the patch of each of its triangles
    triangles: _Indices  #: (t, 3) the polygons cut into triangles between their corners
    triangle_patch: _Indices  #: (t,)
    sharp_edges: _Indices  #: (k, 2) the mesh's edges that are sharp, and its boundary: all run along sides
    centers: _Floats  #: (p, 3) of the regions
    normals: _Floats  #: (p, 3) of the planes nearest to the regions, by least squares
    corner_distance: _Floats  #: (p,) the largest distance of a corner to that plane
    region_distance: _Floats  #: (p,) that of a point of the region
    deviation: _Floats  #: (p,) the largest distance found between region and polygons, by samples of both

    def __len__(self) -> int:
        return len(self.polygons)

    @cached_property
    def faces(self) -> list[list[int]]:
        """The polygons as lists of vertices, counter-clockwise."""
        return [part.tolist() for part in np.split(self.polygons.corners, self.polygons.offsets[1:-1])]

    def hausdorff(self, mesh: Mesh, tolerance: float = 1e-4, job: Job | None = None) -> HausdorffDistance:
        """Measure the distance of the mesh (first) from the patches' triangles (second), as `hausdorff_distance`."""
        return hausdorff_distance(mesh, _soup(self.polygons.vertices, self.triangles)[0], tolerance, job=job)


def super_patches(
    mesh: Mesh,
    count: int | None = None,
    *,
    error: float | None = None,
    sharp: float = math.pi / 3,
    bend: float = 0.15,
    seed: int = 0,
    threads: int = 0,
    job: Job | None = None,
) -> SuperPatches:
    """Make a surface of few polygons, one for each cell: as many as asked for, or as an error needs.

    No cell crosses a sharp edge, and the polygons' sides run along all of them, with corners where they bend and where
    cells of either side meet. Polygons of a closed surface are a closed mesh of its topology.

    Args:
        mesh: the surface.
        count: number of even cells. Either this or `error`. Where a cell is no disk (a tube, a lid with a hole), one
            more is made; where a sharp edge ends within a cell, it may become two.
        error: length. Patches are divided, and moved, until no point of the surface is farther from the polygons, no
            point of those from the surface, and no corner of a polygon from its plane. Cells are long along where the
            surface is straight. What is flat stays one patch: a cube has six.
        sharp: radians: edges at which the normals of the faces differ by more are sharp. The mesh's boundary always is.
        bend: how far a side that is not sharp may leave the boundary of its cell, in parts of the cell's size, as for
            `GeodesicVoronoi.polygons`; with `error` no more than half of that either.
        seed: of the start.
        threads: 0: all cores. The result does not depend on it.
        job: told of progress and asked whether to stop; how many rounds there will be is not known.

    Raises
    ------
        InputError: neither or both of `count` and `error`; fewer cells than sharp edges leave parts; an error that is
        not positive, or so small that there would be more patches than the mesh has faces; a mesh with lengths of its
        own.
        Cancelled: the job was cancelled.

    Notes
    -----
        Each round O(V log V). Cells follow the curvature as in [dazevedo1989], by `anisotropic_metric`, and get another
        where the error is largest.
    """
    if (count is None) == (error is None):
        raise InputError("count, error: give either one of them")
    count = count if count is None else integer(count, "count")
    error, sharp = error if error is None else real(error, "error"), real(sharp, "sharp")
    if not 0 <= sharp <= math.pi:
        raise InputError(f"sharp: wanted radians from 0 to pi, got {sharp}")
    if error is not None and not 0 < error < math.inf:
        raise InputError(f"error: wanted a positive length, got {error}")
    job = job or Job()
    edges = _sharp_edges(mesh, sharp)
    barred = add_barriers(mesh, edges=edges, job=job.part(0, 0.02))
    parts = barred.mesh.component_count
    if count is not None and count < parts:
        raise InputError(f"count: {count} cells for {parts} parts between sharp edges; use more, or a larger `sharp`")
    metric = barred.mesh if error is None else _curvature_metric(barred.mesh, error)
    limit = sys.float_info.max if error is None else error
    graph = SaddleVertexGraph(metric, threads=threads, job=job.part(0.02, 0.1))
    # Of a count the cells are to be even; with an error they are only where others will be put.
    most = _EVEN if error is None else _ITERATIONS
    cells = centroidal_voronoi(
        graph, count=count or parts, max_iterations=most, seed=seed, threads=threads, job=job.part(0.1, 0.2)
    ).cells
    known: dict[bytes, float] = {}
    done = 0.2
    while True:
        polygons, split = barred.polygons(cells, bend=bend, tolerance=limit / 2)
        how = {"threads": threads, "job": job.part(done, done)}
        errors = _known_errors(mesh, polygons, split, limit, known, how)
        errors[polygons.missing] = math.inf
        bad: _Indices = np.flatnonzero(errors > limit)
        job.update(done)
        ahead = done + _ROUND * (1 - done)
        if not len(bad):  # each cell had its error when the polygons beside it were perhaps others
            patches, errors = _measured(mesh, polygons, split, edges, how)
            bad = np.flatnonzero(errors > limit)
        if error is not None and not len(bad):
            bad = _beyond(mesh, patches, error, threads, job.part(done, ahead))
        if not len(bad):
            job.update(1)
            return patches
        # Half of them at a time: what they get makes room for the others.
        worst = bad[np.argsort(-errors[bad], kind="stable")[: (len(bad) + 1) // 2]]
        if len(polygons.sites) + len(worst) > mesh.face_count:
            raise InputError(f"error: {error} needs more patches than the mesh has faces ({mesh.face_count}); use more")
        added = _places(barred.mesh, cells, split, worst)
        sites = SurfacePoints(
            np.concatenate([cells.sites.faces, added.faces]),
            np.concatenate([cells.sites.barycentric, added.barycentric]),
        )
        settled = np.setdiff1d(np.arange(len(cells.sites), dtype=np.int32), bad)
        cells = centroidal_voronoi(
            graph, sites, max_iterations=_ITERATIONS, fixed=settled, threads=threads, job=job.part(done, ahead)
        ).cells
        done = ahead


def _sharp_edges(mesh: Mesh, sharp: float) -> _Indices:
    """(k, 2) vertices of the edges where the surface is sharper, and of its boundary."""
    pairs = [np.zeros((0, 2), dtype=np.int32)]
    for curve in feature_curves(mesh, sharp):
        line = mesh.triangles[curve.points.faces, curve.points.barycentric.argmax(axis=1)]
        pairs.append(np.stack([line, np.roll(line, -1)], axis=1)[: len(line) if curve.closed else -1])
    return np.concatenate(pairs)


def _curvature_metric(mesh: Mesh, error: float) -> Mesh:
    """Make a mesh in which round cells of one size leave their planes by the same: small and short where it bends.

    Neither this nor `curvature_metric(mesh, 1)` serves all: with that one fandisk by 1 and 0.3 % of its extent becomes
    44 and 112 patches (66 and 202 by this one), but a turbine 380 (291) and an open cylinder 28 (13), for its
    cells are of one size along where the surface is straight.
    """
    smallest, largest, direction = principal_curvatures(mesh)
    # As of a cap as large as the surface that is as high as the error: what bends less is one patch anyway.
    least = 8 * error / mesh.area
    smallest, largest = np.abs(smallest) + least, np.abs(largest) + least
    stretch = np.clip(np.sqrt(smallest / largest), 1 / _LONGEST, _LONGEST)
    clearest = np.abs(np.log(stretch))[mesh.triangles].argmax(axis=1)
    field = direction[mesh.triangles[np.arange(mesh.face_count), clearest]]
    lengths = anisotropic_metric(mesh, field, stretch, np.sqrt(smallest * largest))
    return Mesh(mesh.vertices, mesh.triangles, lengths=lengths)


def _soup(vertices: _Floats, triangles: _Indices) -> tuple[Mesh, _Indices]:
    """Triangles with vertices of their own, for patches may meet along a diagonal, and which of the given ones.

    Those without an area are none of them: what they cover is a side of another.
    """
    corners = vertices[triangles]
    sides = np.roll(corners, -1, axis=1) - corners
    longest = (sides**2).sum(axis=2).max(axis=1)
    kept = np.flatnonzero(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) > _FLAT * longest)
    corners = corners[kept].reshape(-1, 3)
    return Mesh(corners, np.arange(len(corners), dtype=np.int32).reshape(-1, 3)), kept


@dataclass(frozen=True)
class _Distances:
    """Of each cell: its plane, and how far what is from it or from the surface."""

    centers: _Floats
    normals: _Floats
    corner: _Floats
    region: _Floats
    deviation: _Floats

    @property
    def errors(self) -> _Floats:
        return np.maximum(self.corner, self.deviation / (1 - _SLACK))


def _measured(
    mesh: Mesh, polygons: CellPolygons, split: SplitMesh, edges: _Indices, how: _How
) -> tuple[SuperPatches, _Floats]:
    """The patches, and the error of each cell."""
    count = int(split.triangle_cell.max()) + 1
    of = _distances(mesh, polygons, split, np.ones(count, dtype=bool), how)
    kept = polygons.polygon_cell
    patch = np.full(count, -1, dtype=np.int32)
    patch[kept] = np.arange(len(kept))
    patches = SuperPatches(
        polygons=polygons,
        regions=split,
        region_patch=patch[split.triangle_cell],
        triangles=polygons.triangles(),
        triangle_patch=patch[_owners(polygons, 2)],
        sharp_edges=edges,
        centers=of.centers[kept],
        normals=of.normals[kept],
        corner_distance=of.corner[kept],
        region_distance=of.region[kept],
        deviation=of.deviation[kept],
    )
    return patches, of.errors


def _known_errors(
    mesh: Mesh, polygons: CellPolygons, split: SplitMesh, limit: float, known: dict[bytes, float], how: _How
) -> _Floats:
    """The error of each cell; of one that was good in an earlier round, and is as it was, what it was then."""
    count = int(split.triangle_cell.max()) + 1
    regions = _by_owner(split.vertices[split.triangles], split.triangle_cell, count)
    loops = _by_owner(polygons.vertices[polygons.corners], _owners(polygons), count)
    keys = [
        hashlib.sha256(region.tobytes() + loop.tobytes()).digest() for region, loop in zip(regions, loops, strict=True)
    ]
    is_new = np.array([key not in known for key in keys])
    errors = _distances(mesh, polygons, split, is_new, how).errors
    known.update((keys[i], float(errors[i])) for i in np.flatnonzero(is_new & (errors <= limit)))
    return np.where(is_new, errors, [known.get(key, 0.0) for key in keys])


def _owners(polygons: CellPolygons, fewer: int = 0) -> _Indices:
    """The cells of all corners, or of what each polygon has so many fewer of."""
    return np.repeat(polygons.polygon_cell, np.diff(polygons.offsets) - fewer)


def _by_owner(values: _Floats, owner: _Indices, count: int) -> list[_Floats]:
    order = np.argsort(owner, kind="stable")
    return np.split(values[order], np.searchsorted(owner[order], np.arange(1, count)))


def _distances(
    mesh: Mesh, polygons: CellPolygons, split: SplitMesh, chosen: NDArray[np.bool_], how: _How
) -> _Distances:
    """Those of the chosen cells, 0 of the others."""
    count = len(chosen)
    within = chosen[split.triangle_cell]
    region, cell = split.triangles[within], split.triangle_cell[within]
    centers, normals = _planes(split.vertices[region], cell, count)

    def off_plane(points: _Floats, owner: _Indices) -> _Floats:
        distance: _Floats = np.abs(np.einsum("...j,...j->...", points - centers[owner], normals[owner]))
        return distance

    corner_distance, region_distance, deviation = np.zeros((3, count))
    corner_cell = _owners(polygons)
    within = chosen[corner_cell]
    corners, corner_cell = polygons.corners[within], corner_cell[within]
    np.maximum.at(corner_distance, corner_cell, off_plane(polygons.vertices[corners], corner_cell))
    for i in range(3):
        np.maximum.at(region_distance, cell, off_plane(split.vertices[region[:, i]], cell))
    triangles, triangle_cell = polygons.triangles(), _owners(polygons, 2)
    if len(triangles):
        soup, _ = _soup(polygons.vertices, triangles)
        points, where = np.unique(region, return_inverse=True)
        off = _off(soup, split.vertices[points], how)[where.reshape(-1, 3)]
        np.maximum.at(deviation, cell, off.max(axis=1))
        within = chosen[triangle_cell]
        samples = np.einsum("sk,tkj->stj", _LATTICE, polygons.vertices[triangles[within]])
        off = _off(mesh, samples.reshape(-1, 3), how).reshape(len(_LATTICE), -1)
        np.maximum.at(deviation, triangle_cell[within], off.max(axis=0))
    return _Distances(centers, normals, corner_distance, region_distance, deviation)


def _off(surface: Mesh, points: _Floats, how: _How) -> _Floats:
    """How far points are from a surface."""
    distance: _Floats = np.linalg.norm(project(surface, points, **how).positions(surface) - points, axis=1)
    return distance


def _planes(corners: _Floats, owner: _Indices, count: int) -> tuple[_Floats, _Floats]:
    """Centers and normals of the planes of least squares, over all points of the triangles of each owner."""
    twice = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(twice, axis=1)

    def sums(values: _Floats) -> _Floats:
        columns = values.reshape(len(values), -1).T
        return np.stack([np.bincount(owner, column, count) for column in columns], axis=1)

    weights = np.maximum(sums(areas), 1e-300)
    centers = sums(areas[:, None] * corners.mean(axis=1)) / weights
    from_center = corners - centers[owner][:, None]
    middle = from_center.sum(axis=1)
    squares = np.einsum("tki,tkj->tij", from_center, from_center) + np.einsum("ti,tj->tij", middle, middle)
    normals = np.linalg.eigh((sums(areas[:, None, None] * squares) / weights).reshape(-1, 3, 3))[1][:, :, 0]
    outward = np.einsum("ni,ni->n", normals, sums(twice)) >= 0
    return centers, np.where(outward[:, None], normals, -normals)


def _beyond(mesh: Mesh, patches: SuperPatches, error: float, threads: int, job: Job) -> _Indices:
    """Cells at the places where the surfaces are farthest apart, if samples did not show that it is too far."""
    soup, kept = _soup(patches.polygons.vertices, patches.triangles)
    extent = float(np.linalg.norm(np.ptp(np.concatenate([mesh.vertices, soup.vertices]), axis=0)))
    slack = _SLACK * error
    far = hausdorff_distance(mesh, soup, slack / extent, limit=error, threads=threads, job=job)
    places = [
        place
        for distance, place in (
            (far.from_first, project(soup, far.farthest_of_first.positions(mesh))),
            (far.from_second, far.farthest_of_second),
        )
        if distance + slack > error
    ]
    return np.unique([patches.polygons.polygon_cell[patches.triangle_patch[kept[p.faces[0]]]] for p in places])


def _places(mesh: Mesh, cells: GeodesicVoronoi, split: SplitMesh, chosen: _Indices) -> SurfacePoints:
    """A place in each of these cells: the vertex farthest from the site; where there is none, or where a sharp edge
    made a cell of its own, the middle of the triangle farthest from the cell's center.
    """
    order = np.lexsort((cells.vertex_distance, cells.vertex_cell))
    last = np.searchsorted(cells.vertex_cell[order], chosen, side="right") - 1
    vertex = order[np.maximum(last, 0)]
    is_there = (cells.vertex_cell[vertex] == chosen) & (cells.vertex_distance[vertex] > 0)
    _, corner = np.unique(mesh.triangles, return_index=True)
    faces, barycentric = corner[vertex] // 3, np.eye(3)[corner[vertex] % 3]
    if not is_there.all():
        centers = split.vertices[split.triangles].mean(axis=1)
        middles = [centers[split.triangle_cell == cell] for cell in chosen[~is_there]]
        farthest = [own[((own - own.mean(axis=0)) ** 2).sum(axis=1).argmax()] for own in middles]
        found = project(mesh, np.array(farthest))
        faces[~is_there], barycentric[~is_there] = found.faces, found.barycentric
    return SurfacePoints(faces.astype(np.int32), barycentric)

# SPDX-License-Identifier: MIT
"""Super-patches: a surface as few polygons, one for each cell, with its sharp edges among their sides."""

import math
import sys
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from saddleback._saddleback import (
    CellPolygons,
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

# Cells are at most so many times as long as wide: longer ones are no fewer, and bend around ends.
_LONGEST = 8.0
_ITERATIONS = 5  # of a relaxation between two looks at the patches
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
        job: its fraction is that of the step that is being done.

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
    if error is not None and not 0 < error < math.inf:
        raise InputError(f"error: wanted a positive length, got {error}")
    edges = _sharp_edges(mesh, sharp)
    barred = add_barriers(mesh, edges=edges, job=job)
    parts = barred.mesh.component_count
    if count is not None and count < parts:
        raise InputError(f"count: {count} cells for {parts} parts between sharp edges; use more, or a larger `sharp`")
    metric = barred.mesh if error is None else _curvature_metric(barred.mesh, error)
    limit = sys.float_info.max if error is None else error
    graph = SaddleVertexGraph(metric, threads=threads, job=job)
    cells = centroidal_voronoi(graph, count=count or parts, seed=seed, threads=threads, job=job).cells
    while True:
        polygons, split = barred.polygons(cells, bend=bend, tolerance=limit / 2)
        patches, errors = _measured(mesh, polygons, split, edges)
        errors[polygons.missing] = math.inf
        bad: _Indices = np.flatnonzero(errors > limit)
        if error is not None and not len(bad):
            bad = _beyond(mesh, patches, error, job)
        if not len(bad):
            return patches
        # Half of them at a time: what they get makes room for the others.
        worst = bad[np.argsort(-errors[bad], kind="stable")[: (len(bad) + 1) // 2]]
        if len(polygons.sites) + len(worst) > mesh.face_count:
            raise InputError(f"error: {error} needs more patches than the mesh has faces ({mesh.face_count}); use more")
        added = project(barred.mesh, _places(split, worst))
        sites = SurfacePoints(
            np.concatenate([cells.sites.faces, added.faces]),
            np.concatenate([cells.sites.barycentric, added.barycentric]),
        )
        settled = np.setdiff1d(np.arange(len(cells.sites), dtype=np.int32), bad)
        cells = centroidal_voronoi(
            graph, sites, max_iterations=_ITERATIONS, fixed=settled, threads=threads, job=job
        ).cells


def _sharp_edges(mesh: Mesh, sharp: float) -> _Indices:
    """(k, 2) vertices of the edges where the surface is sharper, and of its boundary."""
    pairs = [np.zeros((0, 2), dtype=np.int32)]
    for curve in feature_curves(mesh, sharp):
        line = mesh.triangles[curve.points.faces, curve.points.barycentric.argmax(axis=1)]
        pairs.append(np.stack([line, np.roll(line, -1)], axis=1)[: len(line) if curve.closed else -1])
    return np.concatenate(pairs)


def _curvature_metric(mesh: Mesh, error: float) -> Mesh:
    """Make a mesh in which round cells of one size leave their planes by the same: small and short where it bends."""
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


def _measured(mesh: Mesh, polygons: CellPolygons, split: SplitMesh, edges: _Indices) -> tuple[SuperPatches, _Floats]:
    """The patches, and the error of each cell."""
    cell, count = split.triangle_cell, int(split.triangle_cell.max()) + 1
    corner_cell = np.repeat(polygons.polygon_cell, np.diff(polygons.offsets))
    triangles = polygons.triangles()
    triangle_cell = np.repeat(polygons.polygon_cell, np.diff(polygons.offsets) - 2)

    centers, normals = _planes(split.vertices[split.triangles], cell, count)

    def off_plane(points: _Floats, owner: _Indices) -> _Floats:
        distance: _Floats = np.abs(np.einsum("...j,...j->...", points - centers[owner], normals[owner]))
        return distance

    corner_distance, region_distance, deviation = np.zeros((3, count))
    np.maximum.at(corner_distance, corner_cell, off_plane(polygons.vertices[polygons.corners], corner_cell))
    for i in range(3):
        np.maximum.at(region_distance, cell, off_plane(split.vertices[split.triangles[:, i]], cell))
    if len(triangles):
        soup, _ = _soup(polygons.vertices, triangles)
        off = np.linalg.norm(project(soup, split.vertices).positions(soup) - split.vertices, axis=1)
        np.maximum.at(deviation, cell, off[split.triangles].max(axis=1))
        samples = np.einsum("sk,tkj->stj", _LATTICE, polygons.vertices[triangles])
        for points in samples:
            off = np.linalg.norm(project(mesh, points).positions(mesh) - points, axis=1)
            np.maximum.at(deviation, triangle_cell, off)

    kept = polygons.polygon_cell
    patch = np.full(count, -1, dtype=np.int32)
    patch[kept] = np.arange(len(kept))
    patches = SuperPatches(
        polygons=polygons,
        regions=split,
        region_patch=patch[cell],
        triangles=triangles,
        triangle_patch=patch[triangle_cell],
        sharp_edges=edges,
        centers=centers[kept],
        normals=normals[kept],
        corner_distance=corner_distance[kept],
        region_distance=region_distance[kept],
        deviation=deviation[kept],
    )
    return patches, np.maximum(corner_distance, deviation)


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


def _beyond(mesh: Mesh, patches: SuperPatches, error: float, job: Job | None) -> _Indices:
    """Cells at the places where the surfaces are farthest apart, if samples did not show that it is too far."""
    soup, kept = _soup(patches.polygons.vertices, patches.triangles)
    extent = float(np.linalg.norm(np.ptp(np.concatenate([mesh.vertices, soup.vertices]), axis=0)))
    for share in (0.25, 0.02):  # where surfaces lie on each other, to look closely takes long
        tolerance = share * error / extent
        far = hausdorff_distance(mesh, soup, tolerance, job=job)
        if far.distance + share * error <= error:
            return np.zeros(0, dtype=np.intp)
    places = [
        place
        for distance, place in (
            (far.from_first, project(soup, far.farthest_of_first.positions(mesh))),
            (far.from_second, far.farthest_of_second),
        )
        if distance + share * error > error
    ]
    return np.unique([patches.polygons.polygon_cell[patches.triangle_patch[kept[p.faces[0]]]] for p in places])


def _places(split: SplitMesh, cells: _Indices) -> _Floats:
    """A place in each of these cells: the middle of the triangle farthest from the cell's center."""
    centers = split.vertices[split.triangles].mean(axis=1)
    places = []
    for cell in cells:
        own = centers[split.triangle_cell == cell]
        places.append(own[((own - own.mean(axis=0)) ** 2).sum(axis=1).argmax()])
    return np.array(places)

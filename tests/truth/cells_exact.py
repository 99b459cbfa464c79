# SPDX-License-Identifier: MIT
"""Truths about exact cells and their duals: areas by clipped polygons and by brute force, counts, lengths."""

from __future__ import annotations

from collections import Counter

import numpy as np
from numpy.typing import NDArray

import saddleback as sb
from tests.truth.registry import guards
from tests.truth.surfaces import are_fat, elsewhere

Floats = NDArray[np.float64]
Random = np.random.Generator


def exact_cells(mesh: sb.Mesh, sites: sb.SurfacePoints) -> sb.GeodesicVoronoi:
    return sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=3), sites, exact=True)


def random_sites(mesh: sb.Mesh, rng: Random) -> sb.SurfacePoints:
    """One in each part and some more; the last may be at the place of another or beside it."""
    parts = mesh.components[mesh.triangles[:, 0]]
    faces = [int(rng.choice(np.flatnonzero(parts == part))) for part in range(parts.max() + 1)]
    faces += rng.integers(0, len(parts), rng.integers(1, 6)).tolist()
    weights = rng.dirichlet([1.0, 1.0, 1.0], len(faces))
    if rng.random() < 0.5:
        gap = 10.0 ** rng.uniform(-14, -2) * rng.integers(0, 2)
        faces, weights = [*faces, faces[-1]], np.concatenate([weights, weights[-1:] + gap * (1 / 3 - weights[-1:])])
    return sb.SurfacePoints(np.array(faces, dtype=np.int32), weights)


def quarters(corners: Floats, faces: NDArray[np.int32]) -> tuple[Floats, NDArray[np.int32]]:
    """The four triangles into which middles divide each, barycentric in its face."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.concatenate([np.stack(part, axis=1) for part in parts]), np.tile(faces, 4)


@guards("geodesic_voronoi", "GeodesicVoronoi.locate")
def check_areas_by_brute_force(mesh: sb.Mesh, rng: Random) -> None:
    """Areas of exact cells lie between those of small triangles that are surely theirs and that may be theirs."""
    sites = random_sites(mesh, rng)
    cells = exact_cells(mesh, sites)
    corners, faces = np.tile(np.eye(3), (len(mesh.triangles), 1, 1)), np.arange(len(mesh.triangles), dtype=np.int32)
    for _ in range(2):
        corners, faces = quarters(corners, faces)
    places = np.einsum("tij,tjk->tik", corners, mesh.vertices[mesh.triangles[faces]])
    radii = np.linalg.norm(places - places.mean(axis=1, keepdims=True), axis=2).max(axis=1)
    areas = np.linalg.norm(np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0]), axis=1) / 2
    middles = sb.SurfacePoints(faces, corners.mean(axis=1))
    table = np.array([sb.ExactField(mesh, sites[i]).distance_to(middles) for i in range(len(sites))])
    slack, margin = 1e-5 * mesh.area, 2 * radii + 1e-9 * np.sqrt(mesh.area)
    for cell in range(len(sites)):
        others = np.delete(table, cell, axis=0).min(axis=0)
        sure, maybe = table[cell] + margin < others, table[cell] <= others + margin
        assert areas[sure].sum() - slack <= cells.areas[cell] <= areas[maybe].sum() + slack, f"cell {cell}"
    located, distance = cells.locate(middles)
    # Sites within 1e-10 of the extent of each other are one, which of a needle's area is more than rounding.
    rounding = 1e-9 * np.sqrt(mesh.area) + 1e-10 * np.linalg.norm(np.ptp(mesh.vertices, axis=0))
    np.testing.assert_allclose(distance, table.min(axis=0), rtol=1e-9, atol=rounding)
    np.testing.assert_allclose(table[located, np.arange(len(faces))], table.min(axis=0), rtol=1e-9, atol=rounding)


def lag_at_borders(mesh: sb.Mesh, cells: sb.GeodesicVoronoi) -> float:
    """By how much more than from the nearest site points of borders are from those whose cells meet there, at most."""
    fields = [sb.ExactField(mesh, cells.sites[i]) for i in range(len(cells.sites))]
    table = np.array([field.distance_to(cells.edge_surface) for field in fields])
    owners = np.repeat(cells.edge_cells, np.diff(cells.edge_offsets), axis=0).T
    lags = table[owners, np.arange(owners.shape[1])] - table.min(axis=0)
    return float(lags.max(initial=0))


def are_apart(mesh: sb.Mesh, sites: sb.SurfacePoints) -> bool:
    """Tell whether no two sites are beside each other: of such the tolerance says where one's cell ends."""
    places = sites.positions(mesh)
    gaps = np.linalg.norm(places[:, None] - places, axis=2) + np.eye(len(places)) * mesh.mean_edge_length
    return bool(gaps[gaps > 0].min() >= 1e-2 * np.sqrt(mesh.area / len(sites)))


@guards("geodesic_voronoi")
def check_cells_without_places(mesh: sb.Mesh, rng: Random) -> None:
    """Exact cells of a surface elsewhere against those of the surface itself, and their borders against its fields."""
    if not are_fat(mesh):
        return
    sites, moved = random_sites(mesh, rng), elsewhere(mesh, rng)
    here, there = exact_cells(mesh, sites), exact_cells(moved, sites)
    size = np.sqrt(mesh.area / len(sites))
    np.testing.assert_allclose(there.vertex_distance, here.vertex_distance, rtol=1e-9, atol=1e-9 * size)
    allowed = max(1.001 * lag_at_borders(mesh, here), 1e-5 * size)
    assert lag_at_borders(mesh, there) <= allowed, f"another site is nearer by {lag_at_borders(mesh, there)}"
    if are_apart(mesh, sites):
        np.testing.assert_allclose(there.areas, here.areas, rtol=0, atol=1e-5 * mesh.area)


@guards("geodesic_voronoi")
def check_borders_are_nearest(mesh: sb.Mesh, rng: Random) -> None:
    """To no point of a border is another site nearer by more than 1e-5 of the size of a cell, by exact distances."""
    sites = random_sites(mesh, rng)
    if not are_fat(mesh) or mesh.component_count > 1:
        return
    lag, size = lag_at_borders(mesh, exact_cells(mesh, sites)), np.sqrt(mesh.area / len(sites))
    assert lag <= 1e-5 * size, f"another site is nearer by {lag}"


def edges_of(triangles: NDArray[np.int32]) -> Counter[tuple[int, int]]:
    return Counter((min(e), max(e)) for t in triangles.tolist() for e in zip(t, t[1:] + t[:1], strict=True))


def characteristic(triangles: NDArray[np.int32]) -> int:
    return len(np.unique(triangles)) - len(edges_of(triangles)) + len(triangles)


@guards("geodesic_voronoi", "GeodesicVoronoi.split", "GeodesicVoronoi.dual")
def check_split_is_the_surface(mesh: sb.Mesh, rng: Random) -> None:
    """A split mesh has the surface's Euler characteristic, its triangles a cell's area; whole disks are not complained
    about.
    """
    cells = exact_cells(mesh, random_sites(mesh, rng))
    split, issues = cells.split(), cells.dual("strict").issues
    assert max(edges_of(split.triangles).values()) <= 2
    assert characteristic(split.triangles) == characteristic(mesh.triangles)
    a, b, c = (split.vertices[split.triangles[:, i]] for i in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    per_cell = np.bincount(split.triangle_cell, areas, minlength=len(cells.sites))
    np.testing.assert_allclose(per_cell, cells.areas, rtol=0, atol=1e-7 * mesh.area)
    if any(issue.kind == "cell_meets_itself" for issue in issues):
        return  # What touches itself is taken apart there, which its triangles alone do not tell.
    for issue in issues:
        if issue.kind == "not_a_disk":
            assert characteristic(split.triangles[split.triangle_cell == issue.cell]) != 1, f"cell {issue.cell}"


@guards("GeodesicVoronoi.dual", "GeodesicVoronoi.dual_paths")
def check_dual_edges_are_ways(mesh: sb.Mesh, rng: Random) -> None:
    """Dual paths are as long as their polylines; no dual edge is shorter than the exact distance of its sites."""
    cells = exact_cells(mesh, random_sites(mesh, rng))
    dual, paths = cells.dual("strict"), cells.dual_paths()
    fields = {int(a): sb.ExactField(mesh, cells.sites[int(a)]) for a in np.unique(dual.edges[:, 0])}
    for path, (a, b), length in zip(paths, dual.edges.tolist(), dual.edge_lengths, strict=True):
        along = np.linalg.norm(np.diff(path.points, axis=0), axis=1).sum()
        distance = fields[a].distance_to(cells.sites[b])[0]
        np.testing.assert_allclose(path.length, along, rtol=1e-12)
        assert min(path.length, length) >= distance * (1 - 1e-6) - 1e-4 * np.sqrt(mesh.area / len(cells.sites))


@guards("GeodesicVoronoi.dual", "GeodesicVoronoi.dual_paths", "DualMesh")
def check_dual_edges_from_either_side(mesh: sb.Mesh, rng: Random) -> None:
    """Where all faces are turned over, left and right change places, and dual edges keep their lengths."""
    sites = random_sites(mesh, rng)
    if not are_apart(mesh, sites):
        return
    over = sb.SurfacePoints(sites.faces, sites.barycentric[:, [0, 2, 1]])
    told = []
    for there, points in ((mesh, sites), (sb.Mesh(mesh.vertices, mesh.triangles[:, [0, 2, 1]]), over)):
        cells = exact_cells(there, points)
        dual = cells.dual("strict")
        pairs = np.sort(dual.edges, axis=1)
        order = np.lexsort((dual.edge_lengths, pairs[:, 1], pairs[:, 0]))
        told.append((pairs[order], dual.edge_lengths[order], sorted(path.length for path in cells.dual_paths())))
    (pairs, lengths, ways), (same_pairs, same_lengths, same_ways) = told
    if not np.array_equal(pairs, same_pairs):
        return  # a boundary of no length, or between cells that meet in one point
    room = 1e-4 * np.sqrt(mesh.area / len(sites))
    np.testing.assert_allclose(lengths, same_lengths, rtol=1e-3, atol=room)
    np.testing.assert_allclose(ways, same_ways, rtol=1e-3, atol=room)


def clipped(polygon: Floats, normal: Floats, offset: float) -> Floats:
    """The part of a convex polygon where normal . x <= offset."""
    result: list[Floats] = []
    for p, q in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        here, there = normal @ p - offset, normal @ q - offset
        if here <= 0:
            result.append(p)
        if here * there < 0:
            result.append(p + here / (here - there) * (q - p))
    return np.array(result).reshape(-1, 2)


def polygon_area(polygon: Floats) -> float:
    x, y = polygon.T
    return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2)


@guards("geodesic_voronoi", on="nothing")
def check_plane_cells(rng: Random) -> None:
    """Cells on a flat square of any triangles are those of the plane, each clipped from the square by lines.

    Whether the square lies in the plane or is told by lengths alone.
    """
    size = int(rng.integers(2, 7))
    x, y = (part.ravel() for part in np.meshgrid(np.linspace(0, 1, size), np.linspace(0, 1, size)))
    inner = (np.minimum(x, y) > 0) & (np.maximum(x, y) < 1)
    shift = rng.uniform(-0.2, 0.2, (2, size * size)) / (size - 1) * inner
    at = np.arange(size * size).reshape(size, size)
    a, b, c, d = (part.ravel() for part in (at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]))
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]).astype(np.int32)
    mesh = sb.Mesh(np.stack([x + shift[0], y + shift[1], 0 * x], axis=1), triangles)
    sites = random_sites(mesh, rng)
    places = sites.positions(mesh)[:, :2]
    gap = (np.linalg.norm(places[:, None] - places, axis=2) + np.eye(len(places))).min()
    if gap < 1e-9:
        return  # One cell or two, as rounding says: see check_areas_by_brute_force.
    cells = exact_cells(mesh if rng.random() < 0.5 else elsewhere(mesh, rng), sites)
    for i, place in enumerate(places):
        polygon = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], dtype=float)
        for other in np.delete(places, i, axis=0):
            polygon = clipped(polygon, other - place, float((other - place) @ (place + other) / 2))
        assert abs(polygon_area(polygon) - cells.areas[i]) < 1e-5 + 1e-14 / gap, f"cell {i}"

# SPDX-License-Identifier: MIT
"""Truths about even cells and centers: energies by closed forms over cells in fractions, centers of mass where the
surface is flat.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

import saddleback as sb
from tests.truth.distances import Floats, Random, area_between, is_convex_and_flat, longest_edge
from tests.truth.plane import Point, cells_within, exact, random_domain, rounded, some_of
from tests.truth.registry import guards
from tests.truth.surfaces import are_fat, elsewhere


def moments(loop: list[Point], site: Floats) -> tuple[float, Floats, float]:
    """Area, first moment and squared distance from a site, over a polygon: triangles from the site, signed."""
    p = rounded([(x - s[0], y - s[1]) for s in exact(site[None]) for x, y in loop])
    q = np.roll(p, -1, axis=0)
    twice = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    squared = (p * p).sum(axis=1) + (p * q).sum(axis=1) + (q * q).sum(axis=1)
    return float(twice.sum() / 2), (twice[:, None] * (p + q)).sum(axis=0) / 6, float((twice * squared).sum() / 12)


def plane_energy(sites: Floats, domain: list[Floats], density: Floats | None) -> float:
    """Squared distance from the nearest site by squared density, over a domain or over a raster of its box."""
    if density is None:
        return sum_of_cells(sites, domain)
    low, high = domain[0].min(axis=0), domain[0].max(axis=0)
    rows, columns = density.shape
    x, y = (np.linspace(low[k], high[k], n + 1) for k, n in ((0, columns), (1, rows)))
    total = 0.0
    for row, (bottom, top) in enumerate(pairwise(y)):
        for column, (left, right) in enumerate(pairwise(x)):
            tile = np.array([(left, bottom), (right, bottom), (right, top), (left, top)])
            total += density[row, column] ** 2 * sum_of_cells(sites, [tile])
    return total


def sum_of_cells(sites: Floats, loops: list[Floats]) -> float:
    cells = zip(cells_within(sites, loops), sites, strict=True)
    return sum(moments(loop, site)[2] for cell, site in cells for loop in cell if len(loop) > 2)


@guards("relax_2d", "Relaxation2d", on="plane")
def stippling(sites: Floats, rng: Random) -> None:
    """Energies at the start and the end against cells in fractions, and never rising between; sites that can move stay
    where the density is.
    """
    sites = some_of(sites, rng, 6)
    domain = random_domain(sites, rng)
    corners = domain[0]
    size = float(np.ptp(corners, axis=0).max())
    density = None
    if rng.random() < 0.5:
        low, high = corners.min(axis=0), corners.max(axis=0)
        domain = [np.array([low, (high[0], low[1]), high, (low[0], high[1])])]
        density = rng.choice([0.0, 1.0, 3.0], (int(rng.integers(1, 3)), int(rng.integers(1, 3))))
        density[0, 0] = 2.0
    steps = int(rng.integers(0, 15))
    relaxed = sb.relax_2d(sites, domain, density, steps, threads=1)
    assert len(relaxed.energy) == relaxed.iterations + 1 <= steps + 1
    assert relaxed.converged or relaxed.iterations == steps
    assert (np.diff(relaxed.energy) <= 0).all()
    scale = max(np.abs(corners).max(), np.abs(sites).max())
    rounding = 1e-14 * size**2 * scale**2 * float(9 if density is not None else 1)
    for energy, places in ((relaxed.energy[0], sites), (relaxed.energy[-1], relaxed.sites)):
        wanted = plane_energy(places, domain, density)
        assert abs(energy - wanted) <= 1e-9 * wanted + rounding, f"energy {energy} for {wanted}"
    moved = (relaxed.sites != sites).any(axis=1)
    low, high = corners.min(axis=0), corners.max(axis=0)
    assert ((relaxed.sites[moved] >= low - 1e-9 * size) & (relaxed.sites[moved] <= high + 1e-9 * size)).all()


HEXAGON = 5 / (18 * math.sqrt(3))
"""Squared distance from the middle of a regular hexagon, over one of area 1."""


@guards("centroidal_voronoi", "CentroidalVoronoi")
def even_cells(mesh: sb.Mesh, rng: Random) -> None:
    """The energy never rises, fixed sites stay, every part keeps its sites, the cells are those of the sites; on flat
    convex pieces of the plane the energy is that of polygons in fractions.
    """
    graph = sb.SaddleVertexGraph(mesh, exact=True, threads=1)
    count = mesh.component_count + int(rng.integers(0, 5))
    start = sb.sample(mesh, count, seed=int(rng.integers(1 << 30)), one_per_component=True)
    fixed = rng.permutation(count)[: int(rng.integers(0, 2))].astype(np.int32)
    steps, method = int(rng.integers(0, 6)), str(rng.choice(["lbfgs", "lloyd"]))
    relaxed = sb.centroidal_voronoi(graph, start, max_iterations=steps, method=method, fixed=fixed, threads=1)
    assert len(relaxed.energy) == relaxed.iterations + 1 <= steps + 1
    assert relaxed.converged == (relaxed.stop_reason != "max_iterations")
    assert (np.diff(relaxed.energy) <= 1e-12 * relaxed.energy[0]).all()
    assert (relaxed.held == -1).all()
    there = relaxed.sites.positions(mesh)
    stay = np.linalg.norm(there - start.positions(mesh), axis=1)[fixed]
    assert stay.max(initial=0) <= 1e-6 * longest_edge(mesh)
    parts = [set(mesh.components[mesh.triangles[points.faces, 0]].tolist()) for points in (start, relaxed.sites)]
    assert parts[0] == parts[1]
    cells = sb.geodesic_voronoi(graph, relaxed.sites, threads=1)
    assert (cells.vertex_cell == relaxed.cells.vertex_cell).all()
    np.testing.assert_allclose(cells.areas, relaxed.cells.areas, atol=1e-9 * mesh.area)
    hexagons = HEXAGON * mesh.area**2 / count
    np.testing.assert_allclose(relaxed.normalized_energy, relaxed.energy[-1] / hexagons, rtol=1e-6)
    if not is_convex_and_flat(mesh):
        return
    rim = mesh.vertices[mesh.boundary_loops[0], :2]
    for energy, sites in ((relaxed.energy[0], start.positions(mesh)), (relaxed.energy[-1], there)):
        wanted = sum_of_cells(sites[:, :2], [rim])
        assert abs(energy - wanted) <= 1e-3 * wanted, f"energy {energy} for {wanted}"


@guards("centroidal_voronoi", "CellCache", "RelaxationWatch")
def even_cells_by_any_options(mesh: sb.Mesh, rng: Random) -> None:
    """Whatever options go together: so many cells, an energy that never rises, fixed sites where they were, the cells
    of the sites found anew. Threads, a job, a cache and a watch change no bit.
    """
    if mesh.component_count > 40:
        return
    graph = sb.SaddleVertexGraph(mesh, threads=1)
    count = mesh.component_count + int(rng.integers(1, 8))
    sites = sb.sample(mesh, count, seed=int(rng.integers(99)), one_per_component=True)
    curve = sb.SurfaceCurve(mesh, mesh.triangles[rng.integers(mesh.face_count), :2])
    options: dict[str, object] = {"max_iterations": int(rng.integers(0, 5))}
    likely = {
        "method": "lloyd", "tolerance": 0.0, "annealing": 2, "least_move": 1e-2, "closed_ball": True,
        "density": 0.1 + rng.random(mesh.vertex_count), "curves": [curve],
    }  # fmt: skip
    options |= {name: value for name, value in likely.items() if rng.random() < 0.3}
    fixed = np.flatnonzero(rng.random(count) < 0.2)
    if rng.random() < 0.3:
        options |= {"count": count, "seed": int(rng.integers(9)), "starts": int(rng.integers(1, 3))}
    else:
        options |= {"sites": sites, "fixed": fixed}
        if "curves" in options:
            options["held"] = np.where(np.isin(np.arange(count), fixed) | (rng.random(count) < 0.6), -1, 0)
    job = sb.Job()
    beside: dict[str, object] = {"job": job, "watch": sb.RelaxationWatch(), "return_when_cancelled": True}
    if "closed_ball" not in options:  # whose exchanges look farther about cells, which a cache then knows
        beside["cache"] = sb.CellCache()
    made = sb.centroidal_voronoi(graph, threads=1, **options)  # type: ignore[arg-type]
    again = sb.centroidal_voronoi(graph, threads=2, **options, **beside)  # type: ignore[arg-type]
    assert made == again
    assert job.fraction == 1
    assert len(made.sites) == count
    assert len(made.energy) == made.iterations + 1
    assert (np.diff(made.energy) <= 0).all()
    if "sites" in options:
        assert np.array_equal(made.sites.positions(mesh)[fixed], sites.positions(mesh)[fixed])
    assert np.array_equal(made.cells.areas, sb.geodesic_voronoi(graph, made.sites).areas)


def points_of_a_part(mesh: sb.Mesh, rng: Random) -> tuple[sb.SurfacePoints, Floats]:
    """A few points of one part, and weights."""
    parts = mesh.components[mesh.triangles[:, 0]]
    faces = rng.choice(np.flatnonzero(parts == rng.choice(parts)), int(rng.integers(1, 5))).astype(np.int32)
    return sb.SurfacePoints(faces, rng.dirichlet([1, 1, 1], len(faces))), rng.uniform(0.1, 2, len(faces))


@guards("geodesic_center")
def middles(mesh: sb.Mesh, rng: Random) -> None:
    """On flat convex pieces of the plane the weighted mean; elsewhere no worse than three times the best of the points
    themselves.
    """
    graph = sb.SaddleVertexGraph(mesh, exact=True, threads=1)
    points, weights = points_of_a_part(mesh, rng)
    found = sb.geodesic_center(graph, points, weights)
    assert len(found) == 1
    size = longest_edge(mesh)
    if is_convex_and_flat(mesh):
        mean = weights @ points.positions(mesh) / weights.sum()
        missed = float(np.linalg.norm(found.positions(mesh)[0] - mean))
        assert missed <= 1e-5 * size, f"{missed} beside the mean"
    elif mesh.edge_lengths.min() > 1e-3 * size:
        fields = [sb.ExactField(mesh, points[i]) for i in range(len(points))]
        sums = [weights @ np.square([f.distance_to(p) for f in fields]) for p in (found, points)]
        assert sums[0][0] <= 3 * sums[1].min() + 1e-9 * size**2, f"{sums[0][0]}, but {sums[1].min()} at a point"


@guards("geodesic_center")
def least_sums_of_squares(mesh: sb.Mesh, rng: Random) -> None:
    """No point beside the center has a lesser sum of exact squared distances."""
    size = longest_edge(mesh)
    if mesh.edge_lengths.min() < 1e-3 * size:
        return  # exact fields take long
    graph = sb.SaddleVertexGraph(mesh, exact=True, threads=1)
    points, weights = points_of_a_part(mesh, rng)
    found = sb.geodesic_center(graph, points, weights)
    fields = [sb.ExactField(mesh, points[i]) for i in range(len(points))]
    step = 1e-3  # so that a mean twice as far away would be seen
    beside = (1 - step) * found.barycentric + step * rng.dirichlet([1, 1, 1], 20)
    others = sb.SurfacePoints(np.repeat(found.faces, 20), beside / beside.sum(axis=1, keepdims=True))
    sums = [weights @ np.square([f.distance_to(p) for f in fields]) for p in (found, others)]
    least = sums[0][0] - 4 * weights.sum() * (step * size) ** 2
    assert sums[1].min() >= least * (1 - 1e-9), f"{sums[0][0]}, but {sums[1].min()} beside it"


def exact_plane_cells(mesh: sb.Mesh, rng: Random) -> tuple[sb.GeodesicVoronoi, Floats, list[list[Point]]] | None:
    """Exact cells of a flat convex piece of the plane, of places or lengths, their sites' places, and their polygons in
    fractions.
    """
    if not is_convex_and_flat(mesh):
        return None
    count, size = int(rng.integers(1, 6)), longest_edge(mesh)
    sites = sb.sample(mesh, count, seed=int(rng.integers(1 << 30)))
    places = sites.positions(mesh)[:, :2]
    gaps = np.linalg.norm(places[:, None] - places, axis=2) + size * np.eye(count)
    if gaps.min() < 1e-3 * size:
        return None
    surface = elsewhere(mesh, rng) if are_fat(mesh) and rng.random() < 0.5 else mesh
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(surface, k=3, threads=1), sites, exact=True, threads=1)
    rim = mesh.vertices[mesh.boundary_loops[0], :2]
    return cells, places, [polygon for (polygon,) in cells_within(places, [rim])]


def clipped(loop: Floats, corners: Floats) -> Floats:
    """What of a convex polygon is in a triangle, by half-planes."""
    around = corners if area_between(corners[1] - corners[0], corners[2] - corners[0]) > 0 else corners[::-1]
    for a, b in pairwise([*around, around[0]]):
        above = area_between(b - a, loop - a)
        kept = []
        for p, q, at_p, at_q in zip(loop, np.roll(loop, -1, axis=0), above, np.roll(above, -1), strict=True):
            kept += [p] if at_p >= 0 else []
            kept += [p + at_p / (at_p - at_q) * (q - p)] if at_p * at_q < 0 else []
        loop = np.array(kept).reshape(-1, 2)
    return loop


def sees_all(center: Floats, triangles: Floats) -> bool:
    """Whether the straight lines from a point to all corners of triangles (n, 3, 2) stay in them, by their border."""
    sides = {side for t in triangles.tolist() for side in pairwise(map(tuple, [*t, t[0]]))}
    border = np.array([side for side in sides if side[::-1] not in sides])
    corners = np.unique(triangles.reshape(-1, 2), axis=0)
    way, (a, b) = corners[:, None] - center, border.transpose(1, 0, 2)
    at_a, at_b = area_between(way, a - center), area_between(way, b - center)
    slack = 1e-9 * np.abs(at_a).max()
    own = (corners[:, None] == a).all(axis=2) | (corners[:, None] == b).all(axis=2)
    passes = np.minimum(at_a, at_b) <= slack
    passes &= np.maximum(at_a, at_b) >= -slack
    crosses = area_between(b - a, corners[:, None] - a) * area_between(b - a, center - a) <= 0
    return not (passes & crosses & ~own).any()


@guards("GeodesicVoronoi.centers")
def centers_of_the_plane(mesh: sb.Mesh, rng: Random) -> None:
    """On flat convex pieces of the plane: centers of mass against polygons in fractions, if ways in faces are straight.

    That is to the last step of the search. Where a way within a cell's faces bends round one, nothing is claimed; nor
    beyond edges of 1e-10 of the cell, about which ways that lead in other directions are alike to 1e-12.
    """
    found = exact_plane_cells(mesh, rng)
    if found is None or mesh.edge_lengths.min() < 1e-10 * longest_edge(mesh):
        return
    cells, places, polygons = found
    flat = mesh.vertices[mesh.triangles][:, :, :2]
    for i, center in enumerate(cells.centers(threads=1).positions(mesh)[:, :2]):
        area, first, _ = moments(polygons[i], places[i])
        wanted = places[i] + first / area
        polygon = rounded(polygons[i])
        parts = [clipped(polygon, corners) for corners in flat]
        touched = [len(part) > 2 and area_between(part[1:-1] - part[0], part[2:] - part[0]).sum() > 0 for part in parts]
        missed = float(np.hypot(*(wanted - center)))
        if sees_all(wanted, flat[touched]):
            assert missed <= 2e-6 * area**0.5, f"center {i} is {missed} off"


def room_of_corner(corner: Floats, sites: Floats, rim: Floats) -> float:
    """How far a corner of cells moves if each difference of two of its sites' distances is off by 1: infinitely far
    where boundaries touch.
    """
    toward = corner - sites
    toward /= np.linalg.norm(toward, axis=1)[:, None]
    along = np.roll(rim, -1, axis=0) - rim
    along /= np.linalg.norm(along, axis=1)[:, None]
    normal = np.column_stack([along[:, 1], -along[:, 0]])
    on_side = np.abs(((corner - rim) * normal).sum(axis=1)).argmin()
    rows = [*(toward[1:] - toward[0]), *([normal[on_side]] if len(sites) == 2 else [])]
    return 1 / max(float(np.linalg.svd(np.array(rows), compute_uv=False).min()), 1e-300)


@guards("GeodesicVoronoi.corners", "GeodesicVoronoi.centers")
def corners_of_the_plane(mesh: sb.Mesh, rng: Random) -> None:
    """On flat convex pieces of the plane: corners of exact cells against polygons in fractions; centers lie in their
    cells.

    Faces are divided until distances are right to 5e-6 of a cell's size (to a tenth of it where all known ways are
    straight): corners are as far off as their boundaries make of that.
    """
    found = exact_plane_cells(mesh, rng)
    if found is None:
        return
    (cells, places, polygons), size = found, longest_edge(mesh)
    centers = cells.centers(threads=1).positions(mesh)[:, :2]
    rim = mesh.vertices[mesh.boundary_loops[0], :2]
    tolerance = 5e-6 * (mesh.area / len(places)) ** 0.5
    # Corners of the domain are none of a cell, unless a boundary between cells ends there.
    for i, polygon in enumerate(polygons):
        wanted = rounded(polygon)
        corners = cells.corners(i).positions(mesh)[:, :2]
        distances = np.linalg.norm(wanted[:, None] - places, axis=2)
        near = distances - distances[:, [i]] < 1e-9 * size
        between = near.sum(axis=1) > 1
        wanted, near = wanted[between], near[between]
        rooms = np.array([room_of_corner(p, places[of], rim) for p, of in zip(wanted, near, strict=True)])
        off = np.linalg.norm(corners[:, None] - wanted, axis=2) / (tolerance * rooms)
        for corner, best in zip(corners, off.min(axis=1, initial=np.inf), strict=True):
            assert best <= 1, f"cell {i} has no corner at {corner}"
        for corner, best in zip(wanted, off.min(axis=0, initial=np.inf), strict=True):
            assert best <= 1, f"cell {i} lacks {corner}"
        to_sites = np.linalg.norm(centers[i] - places, axis=1)
        assert to_sites[i] <= to_sites.min() + 1e-2 * size, f"center {i} is in another cell"


@guards("spread_values")
def values_between_places(mesh: sb.Mesh, rng: Random) -> None:
    """Values meet the given ones, but of places that are nearly the same, and stay within them.

    They follow a shift and a factor, in any unit; parts without a place have the mean.
    """
    method = str(rng.choice(["biharmonic", "harmonic"]))
    places = rng.permutation(mesh.vertex_count)[: int(rng.integers(1, 4))].astype(np.int32)
    values = rng.normal(size=len(places)).round(3)
    found = sb.spread_values(mesh, places, values, method)
    span = float(np.ptp(values))
    assert found.min() >= values.min() - 1e-9 * span
    assert found.max() <= values.max() + 1e-9 * span
    there = mesh.vertices[places]
    gaps = np.linalg.norm(there[:, None] - there, axis=2) + longest_edge(mesh) * np.eye(len(places))
    apart = (gaps > 1e-2 * np.ptp(mesh.vertices, axis=0).max()).all(axis=1)
    assert abs(found[places] - values)[apart].max(initial=0) <= 2e-5 * span
    without = ~np.isin(mesh.components, mesh.components[places])
    np.testing.assert_allclose(found[without], values.mean(), atol=1e-9 * max(span, 1))
    scaled = sb.Mesh(mesh.vertices * 2.0 ** rng.integers(-20, 20), mesh.triangles)
    shift = -(10.0 ** rng.integers(0, 10))
    again = sb.spread_values(scaled, places, 3 * values + shift, method)
    np.testing.assert_allclose(again, 3 * found + shift, atol=1e-4 * span + 1e-9 + 1e-14 * abs(shift))
    if method == "harmonic" and len(places) == 1:
        np.testing.assert_allclose(found, values[0], atol=1e-9)

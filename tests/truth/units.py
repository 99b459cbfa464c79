# SPDX-License-Identifier: MIT
"""Truths about units: powers of two round no coordinate, so that in another unit every answer is the same to the bit.

What is compared is a list of arrays, each with the power of the unit that it is measured in: 0 for numbers and angles,
1 for lengths, 2 for areas, -1 for curvatures.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import saddleback as sb
from tests.truth.distances import Floats, Random
from tests.truth.fields import is_usual
from tests.truth.lines_and_maps import is_disk
from tests.truth.plane import random_domain, some_of
from tests.truth.registry import guards
from tests.truth.shapes import random_layout

Answer = list[tuple[object, int]]


def points_of(mesh: sb.Mesh, points: sb.SurfacePoints) -> Answer:
    return [(points.positions(mesh), 1)]


def areas_of(vertices: Floats, triangles: NDArray[np.int32], kinds: NDArray[np.int32]) -> Answer:
    """Of each kind of triangle: which diagonals were chosen is a matter of rounding."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    sizes = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    return [(len(triangles), 0), (np.bincount(kinds + 1, sizes), 2)]


def told(ask: Callable[[], Answer]) -> Answer | str:
    """The answer, or that it was refused."""
    try:
        return ask()
    except sb.Error as refusal:
        return type(refusal).__name__


def assert_scales(name: str, ask: Callable[[float], Answer], unit: float, rounding: float = 0.0) -> None:
    """What is asked with all lengths times a unit is answered with all lengths times that unit, to the bit, or to so
    much of the largest number.
    """
    plain, scaled = told(lambda: ask(1.0)), told(lambda: ask(unit))
    if isinstance(plain, str) or isinstance(scaled, str):
        assert plain == scaled, f"{name}: {plain if isinstance(plain, str) else scaled} at one of the units 1, {unit}"
        return
    for k, ((mine, power), (theirs, _)) in enumerate(zip(plain, scaled, strict=True)):
        wanted = np.atleast_1d(np.asarray(mine, dtype=float)) * unit**power
        found = np.atleast_1d(np.asarray(theirs, dtype=float))
        assert found.shape == wanted.shape, f"{name}, {k}: {found.shape} at the unit {unit}, not {wanted.shape}"
        same = (found == wanted) | (np.isnan(found) & np.isnan(wanted))
        finite = np.isfinite(wanted)
        room = rounding * abs(wanted[finite]).max(initial=0)
        same[finite] |= abs(found[finite] - wanted[finite]) <= room
        assert same.all(), f"{name}, {k}: {found[~same][:3]} at the unit {unit}, not {wanted[~same][:3]}"


def random_unit(rng: Random) -> float:
    """2^-20 to 2^20, a millionth to a million."""
    return float(2.0 ** rng.integers(-20, 21))


def distances_of(mesh: sb.Mesh, unit: float, seed: int) -> Answer:
    rng = np.random.default_rng(seed)
    points = sb.SurfacePoints(rng.integers(0, mesh.face_count, 3).astype(np.int32), rng.dirichlet([1, 1, 1], 3))
    reach = float(rng.choice([np.inf, 1.5])) * mesh.mean_edge_length
    graph = sb.SaddleVertexGraph(mesh, accuracy=float(rng.choice([2e-2, 1e-3])), threads=1)
    field, log = sb.ExactField(mesh, points[0]), graph.log_map(points[1], reach)
    # As long as suits its part: on a tiny one a line of two of the mesh's mean edges winds round without end.
    edges = mesh.vertices[mesh.triangles[points.faces[2]]]
    own = float(np.linalg.norm(edges - np.roll(edges, 1, axis=0), axis=1).max())
    line = sb.trace(mesh, points[2], float(rng.uniform(0, 7)), 2 * min(mesh.mean_edge_length, 10 * own))
    polar = sb.polar_coordinates(graph, sb.SurfaceCurve(mesh, line.surface), reach)
    near = np.flatnonzero(np.isfinite(field.distances))[:3].astype(np.int32)
    return [
        (sb.exact_distances(mesh, points, reach), 1), (graph.distances(points, reach), 1), (field.distances, 1),
        (field.distance_to(points), 1), *[(path.length, 1) for path in field.paths(near)],
        *[(path.points, 1) for path in graph.paths(near[:1], near, threads=1)],
        (log.vertices, 0), (log.uv, 1), (line.points, 1), (line.end_angle, 0), (polar.distance, 1), (polar.along, 1),
        *points_of(mesh, sb.exp_map(mesh, points[1], log.uv, threads=1)),
    ]  # fmt: skip


@guards("exact_distances", "ExactField", "SaddleVertexGraph", "trace", "exp_map", "polar_coordinates", "LogMap")
def units_of_distances(mesh: sb.Mesh, rng: Random) -> None:
    """Distances, paths, traced lines, coordinates about points and curves."""
    unit, seed = random_unit(rng), int(rng.integers(1 << 30))
    assert_scales("distances", lambda u: distances_of(sb.Mesh(mesh.vertices * u, mesh.triangles), u, seed), unit)


def cells_of(mesh: sb.Mesh, unit: float, seed: int) -> Answer:
    rng = np.random.default_rng(seed)
    count = mesh.component_count + int(rng.integers(0, 5))
    sites = sb.sample(mesh, count, seed=seed, one_per_component=True)
    graph, is_exact = sb.SaddleVertexGraph(mesh, threads=1), bool(rng.random() < 0.5)
    cells = sb.geodesic_voronoi(graph, sites, exact=is_exact, threads=1)
    split, dual = cells.split(), cells.dual("strict")
    relaxed = sb.centroidal_voronoi(graph, sites, max_iterations=3, threads=1)
    return [
        *points_of(mesh, sites), (cells.vertex_cell, 0), (cells.vertex_distance, 1), (cells.areas, 2),
        (cells.edge_points, 1), (cells.edge_cells, 0),
        *areas_of(split.vertices, split.triangles, split.triangle_cell), (dual.edge_lengths, 1),
        *points_of(mesh, cells.centers(threads=1)), *points_of(mesh, relaxed.sites), (relaxed.energy, 4),
        *points_of(mesh, sb.geodesic_center(graph, sites[:1])),
    ]  # fmt: skip


@guards("geodesic_voronoi", "GeodesicVoronoi", "centroidal_voronoi", "geodesic_center", "sample", "SplitMesh")
def units_of_cells(mesh: sb.Mesh, rng: Random) -> None:
    """Cells, their boundaries, centers, duals, and even ones."""
    unit, seed = random_unit(rng), int(rng.integers(1 << 30))
    assert_scales("cells", lambda u: cells_of(sb.Mesh(mesh.vertices * u, mesh.triangles), u, seed), unit)


def surface_of(mesh: sb.Mesh, unit: float, seed: int) -> Answer:
    rng = np.random.default_rng(seed)
    places = rng.uniform(mesh.vertices.min(axis=0), mesh.vertices.max(axis=0), (4, 3))
    other = sb.Mesh(mesh.vertices[:, [1, 2, 0]], mesh.triangles)
    hausdorff = sb.hausdorff_distance(mesh, other, 1e-3, threads=1)
    height = np.column_stack([mesh.vertices, mesh.vertices @ (1.0, 0.5, 0.25)])
    cut = sb.cut_at_level(height, mesh.triangles, 3, float(np.median(height[:, 3])))
    quality = sb.triangle_quality(mesh.vertices, mesh.triangles)
    cells = rng.integers(0, 3, mesh.face_count).astype(np.int32)
    known = rng.permutation(mesh.vertex_count)[:3].astype(np.int32)
    answer: Answer = [
        *points_of(mesh, sb.project(mesh, places, threads=1)), (hausdorff.distance, 1), (cut[0], 1), (cut[1], 0),
        (quality.quality, 0), (quality.least_angle, 0), (sb.vertex_normals(mesh.vertices, mesh.triangles), 0),
        (sb.cell_boundary_distance(mesh.vertices, mesh.triangles, cells), 1), (mesh.area, 2), (mesh.edge_lengths, 1),
        (mesh.corner_angles, 0), (mesh.saddle_vertices, 0),
        (sb.self_crossings(mesh.vertices, mesh.triangles, threads=1), 0),
        *[(curve.length, 1) for curve in sb.feature_curves(mesh, 0.6)],
        *[(k, power) for k, power in zip(sb.principal_curvatures(mesh), (-1, -1, 0), strict=True)],
        (sb.density_by_curvature(mesh), 0),
        *[(sb.spread_values(mesh, known, [1.0, 2.0, 4.0][: len(known)], method), 0)
          for method in ("biharmonic", "harmonic")],
    ]  # fmt: skip
    if is_disk(mesh):
        uv = sb.harmonic_map(mesh)
        answer += [(uv, 0), (sb.Chart(mesh, uv).area, 0)]
    return answer


@guards(
    "project", "hausdorff_distance", "cut_at_level", "principal_curvatures", "spread_values", "harmonic_map", "Mesh"
)
def units_of_surfaces(mesh: sb.Mesh, rng: Random) -> None:
    """What meshes are, nearest points, curvature, feature lines, values spread over them, maps of disks."""
    unit, seed = random_unit(rng), int(rng.integers(1 << 30))
    assert_scales("surfaces", lambda u: surface_of(sb.Mesh(mesh.vertices * u, mesh.triangles), u, seed), unit)


def mended(mesh: sb.Mesh, seed: int) -> tuple[sb.Mesh, sb.RepairReport]:
    rng = np.random.default_rng(seed)
    corners = mesh.vertices[mesh.triangles].reshape(-1, 3)
    soup = np.arange(3 * mesh.face_count, dtype=np.int32).reshape(-1, 3)
    weld = float(rng.choice([0.0, 1e-3])) * mesh.mean_edge_length
    return sb.repair(corners, soup, weld, stitch=bool(rng.random() < 0.5), fill_holes=10)


def scaled(ask: Callable[[sb.Mesh, float, int], Answer], mesh: sb.Mesh, seed: int) -> Callable[[float], Answer]:
    return lambda unit: ask(sb.Mesh(mesh.vertices * unit, mesh.triangles), unit, seed)


def repaired(mesh: sb.Mesh, unit: float, seed: int) -> Answer:
    whole, report = mended(mesh, seed)
    changes = list(report.changes.values())
    return [(whole.vertices, 1), (whole.triangles, 0), (changes, 0), (report.t_junctions, 0)]


def joining(mesh: sb.Mesh, unit: float, seed: int) -> Answer:
    """Told in two decimal digits."""
    return [(mended(mesh, seed)[1].joining_distance, 1)]


@guards("repair", "RepairReport")
def units_of_repair(mesh: sb.Mesh, rng: Random) -> None:
    """Welds, stitches and fills the same."""
    unit, seed = random_unit(rng), int(rng.integers(1 << 30))
    for ask, rounding in ((repaired, 0.0), (joining, 0.1)):
        assert_scales(ask.__name__, scaled(ask, mesh, seed), unit, rounding)


def fields_of(mesh: sb.Mesh, unit: float, seed: int) -> Answer:
    rng = np.random.default_rng(seed)
    symmetry = int(rng.choice([2, 4]))
    start = sb.sample(mesh, 1, seed=seed)
    line = sb.SurfaceCurve(mesh, sb.trace(mesh, start, 1.0, mesh.mean_edge_length).surface)
    answer: Answer = []
    for options in ({}, {"align": "curvature"}, {"align": "boundary"}, {"strokes": [line]}):
        field = sb.direction_field(mesh, symmetry, **options)
        answer += [(field.angles, 0), (field.turns, 0)]
    field = sb.direction_field(mesh, symmetry)
    curve = sb.streamline(mesh, field, start, 3 * mesh.mean_edge_length, max_curvature=1 / mesh.mean_edge_length)
    return [*answer, (curve.points, 1), (curve.length, 1)]


@guards("direction_field", "streamline")
def units_of_fields(mesh: sb.Mesh, rng: Random) -> None:
    """Directions, smooth, aligned and along strokes, and lines that follow them."""
    if is_usual(mesh):
        unit, seed = random_unit(rng), int(rng.integers(1 << 30))
        assert_scales("fields", lambda u: fields_of(sb.Mesh(mesh.vertices * u, mesh.triangles), u, seed), unit)


def plane_of(sites: Floats, weights: Floats, domain: list[Floats], unit: float, seed: int) -> Answer:
    rng = np.random.default_rng(seed)
    size = float(np.ptp(domain[0], axis=0).max())
    diagram = sb.voronoi_2d(sites, weights, threads=1)
    clipped = diagram.clip(domain, threads=1)
    plain = sb.voronoi_2d(sites, threads=1).clip(domain, gap=0.05 * size, threads=1)
    relaxed = sb.relax_2d(sites, domain, max_iterations=4, threads=1)
    sweep = sb.SweepCircle(sites, sites[0], weights if rng.random() < 0.5 else None)
    sweep.grow(0.5 * size)
    return [
        (diagram.vertices, 1), (diagram.edges, 0), (diagram.areas, 2), (diagram.hidden, 0),
        *[(diagram.edge_polyline(edge, 0.01 * size), 1) for edge in range(min(3, len(diagram.edges)))],
        (clipped.points, 1), (clipped.areas, 2), (plain.points, 1), (relaxed.sites, 1), (relaxed.energy, 4),
        (sweep.beach_curve(8), 1), (diagram.locate(domain[0], threads=1), 0),
        *[(line, 1) for line in sweep.edge_polylines(0.01 * size)],
    ]  # fmt: skip


@guards("voronoi_2d", "Voronoi2d.clip", "relax_2d", "SweepCircle", on="plane")
def units_of_diagrams(sites: Floats, rng: Random) -> None:
    """Diagrams of points and disks, clipped ones, relaxed sites, sweeps."""
    sites = some_of(sites, rng, 8)
    domain, seed = random_domain(sites, rng), int(rng.integers(1 << 30))
    weights = 0.2 * float(np.ptp(sites)) * rng.random(len(sites))
    unit = random_unit(rng)
    # Curves are computed at a size of their own.
    assert_scales(
        "plane", lambda u: plane_of(u * sites, u * weights, [u * loop for loop in domain], u, seed), unit, 1e-13
    )


SOLID = (np.array([(0.0, 0, 0), (0.3, 0, 0.1), (0, 0.3, 0)]), np.array([[0, 1, 2]]))


def shapes_of(
    mesh: sb.Mesh, shapes: list[sb.Shape], placements: sb.Placements, u: float, seed: int, mode: str
) -> Answer:
    there = sb.Mesh(u * mesh.vertices, mesh.triangles)
    poses = sb.Placements(
        placements.shape, placements.center, placements.angle, u * placements.scale, placements.mirrored
    )
    laid = sb.map_shapes(there, shapes, poses, threads=1)
    cut, report = laid.cut(), sb.check_distribution(there, laid, samples=200, threads=1)
    about, bent = laid.attributes(0.1 * u, threads=1), laid.bend([SOLID] * len(shapes), threads=1)
    copies = sb.distribute(there, shapes[:2], [3, 2], size=0.1 * u, gap=0.01 * u, seed=seed, mode=mode)
    density = 1.0 + np.arange(len(mesh.vertices)) % 7
    painted = sb.distribute(there, shapes[:2], [3, 2], size=0.3 * u, density=density, seed=seed, mode=mode).placements
    proof = sb.distribute(there, shapes[0], size=0.3 * u, seed=seed, maximal=True, tolerance=0.1).certificate
    return [
        (len(laid.failures), 0), (laid.stretch, 0),
        (cut.vertices, 1), *areas_of(cut.vertices, cut.triangles, cut.triangle_shape), (report.ok, 0),
        (report.coverage, 0), (about.placement, 0), (about.distance, 1), (about.uv, 0), (bent.vertices, 1),
        (bent.deviations, 0), (laid.frames()[0], 1), (laid.frames()[1], 0), (copies.placements.shape, 0),
        (copies.placements.angle, 0), (copies.placements.scale, 1), *points_of(there, copies.placements.center),
        (painted.shape, 0), (painted.angle, 0), (painted.scale, 1), *points_of(there, painted.center),
        (proof.tolerance, 1), (proof.uncertified_area, 2), (proof.cells, 0),
    ]  # fmt: skip


def shapes_in_the_plane(shape: sb.Shape, other: sb.Shape, u: float) -> Answer:
    one = shape.moved(u)
    table = sb.SafeDistanceTable(one, other.moved(u), threads=1)
    return [
        (one.area, 2), (one.circumradius, 1), (one.inradius, 1), (table.distance(1.0, 2.0), 1),
        (table.distance(3.0, 1.0, 0.5, 2.0), 1), (one.overlaps(other.moved(u, 0.5, (0.9 * u, 0))), 0),
        (one.contains([[0.1 * u, 0.2 * u], [0.9 * u, 0]]), 0), (np.vstack(one.centered(u).loops), 1),
    ]  # fmt: skip


@guards("Shape", "SafeDistanceTable", "map_shapes", "MappedShapes", "check_distribution", "distribute", on="nothing")
def units_of_shapes(rng: Random) -> None:
    """Shapes laid on a surface, checked, cut, told to vertices; copies laid without collision; shapes of the plane."""
    layout, seed = random_layout(rng, 3, innocent=True), int(rng.integers(1000))
    if not layout.poses:
        return
    mesh, placements, mode = layout.surface.mesh, layout.mapped().placements, str(rng.choice(["random", "packed"]))
    if rng.random() < 0.3:
        assert_scales("shapes", lambda u: shapes_of(mesh, layout.shapes, placements, u, seed, mode), random_unit(rng))
    one, other = layout.shapes[int(rng.integers(5))], layout.shapes[1]
    assert_scales("shapes of the plane", lambda u: shapes_in_the_plane(one, other, u), random_unit(rng))

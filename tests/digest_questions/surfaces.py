# SPDX-License-Identifier: MIT
"""Questions about meshes: distances, cells, fields, charts, repair, files."""

from __future__ import annotations

import functools
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes
from tests.digest_questions.asking import Way, all_of, asked, rounded, surface
from tests.native import mesh_dialects
from tests.native.graph_files import GraphFile

FROM_ANGLES = ("icosphere", "torus", "two_components", "cylinder", "cone")


def _surfaces() -> dict[str, meshes.Case]:
    cases = {
        case.name: case if case.name not in FROM_ANGLES
        else meshes.Case(case.name, rounded(case.vertices), case.triangles, case.genus, case.loops, case.components)
        for case in meshes.good()
    }  # fmt: skip
    vertices, triangles = meshes.graded_disk(rings=24)
    cases["graded_disk"] = meshes.Case("graded_disk", rounded(vertices), triangles, loops=1)
    cases["spikes"] = meshes.Case("spikes", *meshes.spikes(14, 3.0), loops=1)
    cases["sheet"] = meshes.Case("sheet", *meshes.grid(60, 50, 0.3, 2), loops=1)
    vertices, triangles = meshes.torus(72, 30)
    bumps = 1 + 0.04 * np.random.default_rng(1).random((len(vertices), 1))
    cases["bumpy_torus"] = meshes.Case("bumpy_torus", rounded(vertices * bumps), triangles, genus=1)
    return cases


GOOD = _surfaces()
LARGE = {name: case for name, case in GOOD.items() if len(case.vertices) >= 100}
FEW = {name: LARGE[name] for name in ("torus", "grid_jittered", "double_torus", "spikes", "bumpy_torus")}
DISKS = {
    name: case for name, case in GOOD.items()
    if case.loops == 1 and case.genus == 0 and name not in ("graded_disk", "spikes", "needles")
}  # fmt: skip


def points_on(case: meshes.Case, count: int, seed: int = 1) -> sb.SurfacePoints:
    """Anywhere, within faces, on an edge and in a vertex."""
    random = np.random.default_rng(seed)
    weights = random.random((count, 3)) + 0.05
    weights[0], weights[1] = (0.0, 0.0, 1.0), (0.25, 0.75, 0.0)
    weights /= weights.sum(axis=1, keepdims=True)
    return sb.SurfacePoints(random.integers(0, len(case.triangles), count).astype(np.int32), weights)


@functools.lru_cache(maxsize=64)
def graph_of(case: meshes.Case, way: Way, **rule: Any) -> sb.SaddleVertexGraph:
    if "k" in rule:
        rule["k"] = min(rule["k"], len(case.vertices))
    return sb.SaddleVertexGraph(
        case.mesh,
        threads=way.threads,
        device=way.device,
        **(rule or {"k": len(case.vertices) if len(case.vertices) < 30 else 30}),
    )


def density_of(case: meshes.Case) -> NDArray[np.float64]:
    return np.random.default_rng(5).random(len(case.vertices)) + 0.25


@asked(GOOD, portable=True)
def mesh(case: meshes.Case) -> Iterable[object]:
    made = case.mesh
    names = "edges edge_lengths face_areas area boundary_vertices components genus fingerprint mean_edge_length"
    return [*all_of(made, names), *made.boundary_loops]


@asked(GOOD)
def angles(case: meshes.Case) -> Iterable[object]:
    return all_of(case.mesh, "corner_angles total_angles saddle_vertices")


@asked(
    GOOD, portable=True, **{"k=6": {"k": 6}, "k=40": {"k": 40}, "5e-2": {"accuracy": 0.05}, "5e-3": {"accuracy": 5e-3}}
)
def arcs(case: meshes.Case, way: Way, **rule: Any) -> Iterable[object]:
    return _arcs(graph_of(case, way, **rule))


@asked({name: case for name, case in FEW.items() if name != "bumpy_torus"})
def arcs_exact(case: meshes.Case, way: Way) -> Iterable[object]:
    return _arcs(graph_of(case, way, exact=True))


def _arcs(graph: sb.SaddleVertexGraph) -> Iterable[object]:
    with tempfile.TemporaryDirectory() as folder:
        graph.save(Path(folder) / "graph")
        file = GraphFile.read(Path(folder) / "graph")
    return [file.vertices, file.degrees, file.arcs, file.header["quantum"], file.header["least_exponent"]]


@asked(GOOD, portable=True, k={"k": 20}, accuracy={"accuracy": 5e-3})
def graph_distances(case: meshes.Case, way: Way, **rule: Any) -> Iterable[object]:
    graph, device = graph_of(case, way, **rule), way.device
    some = np.arange(0, len(case.vertices), 7, dtype=np.int32)
    near, source = graph.nearest(some, device=device)
    return [
        graph.distances(0, device=device), graph.distances(0, 0.4, "dijkstra", device=device), near, source,
        graph.fields(some[:5], threads=way.threads, device=device), graph.distance(0, len(case.vertices) - 1),
        graph.distances_to(some[:3], some[::-1].copy()),
    ]  # fmt: skip


@asked(GOOD)
def graph_points(case: meshes.Case, way: Way) -> Iterable[object]:
    graph, points = graph_of(case, way), points_on(case, 6)
    return [
        graph.distances(points, device=way.device), *graph.nearest(points, device=way.device),
        graph.distance(points[2], points[3]), graph.distances_to(points[:2], points_on(case, 20, 2)),
        graph.fields(points[:3], threads=way.threads, device=way.device),
    ]  # fmt: skip


@asked(GOOD, plain={}, shorten={"shorten": True})
def graph_paths(case: meshes.Case, way: Way, shorten: bool = False) -> Iterable[object]:
    graph = graph_of(case, way)
    paths = graph.paths(points_on(case, 4), points_on(case, 15, 2), shorten, threads=way.threads)
    return [*all_of(paths, "points offsets lengths sources"), *surface(paths.surface)]


@asked(GOOD)
def exact(case: meshes.Case) -> Iterable[object]:
    some = np.arange(0, len(case.vertices), 11, dtype=np.int32)
    return [
        sb.exact_distances(case.mesh, [0]),
        sb.exact_distances(case.mesh, some, 0.3),
        *sb.exact_nearest(case.mesh, some),
    ]


@asked(GOOD)
def exact_points(case: meshes.Case) -> Iterable[object]:
    field = sb.ExactField(case.mesh, points_on(case, 4))
    paths = field.paths(points_on(case, 10, 2))
    return [
        field.distances, field.nearest, field.window_count, field.distance_to(points_on(case, 40, 3)),
        *[part for path in paths for part in (path.length, path.points)],
    ]  # fmt: skip


@asked(LARGE)
def log_map(case: meshes.Case, way: Way) -> Iterable[object]:
    graph, center = graph_of(case, way), points_on(case, 3)
    radius = 6 * case.mesh.mean_edge_length
    answer: list[object] = []
    for point in (0, center[1], center[2]):
        log = graph.log_map(point, radius)
        answer += [*all_of(log, "vertices uv distance angle shadowed")]
        answer += surface(sb.exp_map(case.mesh, point, log.uv, threads=way.threads))
    return answer


@asked(LARGE)
def trace_and_polar_map(case: meshes.Case, way: Way) -> Iterable[object]:
    edge, answer = case.mesh.mean_edge_length, []
    for i, point in enumerate(points_on(case, 4)):
        line = sb.trace(case.mesh, point, 1.0 + i, 5 * edge)
        answer += [line.points, line.length, line.end_angle, line.end_direction, *surface(line.surface)]
    curve = sb.SurfaceCurve(case.mesh, line.surface)
    polar = sb.polar_coordinates(graph_of(case, way), curve, 4 * edge)
    return [*answer, curve.length, *all_of(polar, "vertices distance along shadowed")]


@asked(LARGE)
def curves_of_few_points(case: meshes.Case, way: Way) -> Iterable[object]:
    own = np.flatnonzero(case.mesh.components == 0).astype(np.int32)
    graph, stops, answer = graph_of(case, way), own[:: len(own) // 4][:4], []
    for closed in (False, True):
        straight, smooth = (sb.curve_through(graph, stops, closed=closed, smooth=smooth) for smooth in (False, True))
        tight = sb.shorten_curve(straight)
        answer += [straight.length, smooth.length, tight.points, tight.length, *surface(tight.surface)]
    return [*answer, sb.bezier_curve(graph, stops).length]


@asked(LARGE)
def map_along_a_curve(case: meshes.Case) -> Iterable[object]:
    edge = case.mesh.mean_edge_length
    curve = sb.SurfaceCurve(case.mesh, sb.trace(case.mesh, points_on(case, 4)[3], 1.0, 5 * edge).surface)
    found = sb.stroke_map(case.mesh, curve, 2 * edge)
    return [*all_of(found, "vertices triangles uv face_origin length area coverage"), *surface(found.points)]


@asked(GOOD, portable=True)
def project_and_sample(case: meshes.Case, way: Way) -> Iterable[object]:
    places = np.random.default_rng(3).uniform(-1.5, 1.5, (80, 3))
    return [
        *surface(sb.project(case.mesh, places, threads=way.threads)), *surface(sb.sample(case.mesh, 50, seed=4)),
        *surface(sb.sample(case.mesh, 50, density_of(case), 4, one_per_component=True)),
    ]  # fmt: skip


CELLS = "vertex_cell vertex_distance areas edge_points edge_offsets edge_cells edge_closed"


def cells_of(cells: sb.GeodesicVoronoi, way: Way) -> list[object]:
    split = cells.split()
    return [
        *all_of(cells, CELLS), *surface(cells.edge_surface), *surface(cells.branch_points),
        *all_of(split, "vertices triangles triangle_cell vertex_origin"),
    ]  # fmt: skip


@asked(GOOD, few={"count": 5}, many={"count": 40}, exact={"count": 12, "exact": True})
def cells(case: meshes.Case, way: Way, count: int, exact: bool = False) -> Iterable[object]:
    sites = sb.sample(case.mesh, count, seed=6, one_per_component=True)
    found = sb.geodesic_voronoi(graph_of(case, way), sites, exact=exact, threads=way.threads, device=way.device)
    points = points_on(case, 60, 7)
    answer = [*cells_of(found, way), *surface(found.centers(threads=way.threads)), found.cells_at(points)]
    return [*answer, *found.locate(points), *surface(found.centers(density_of(case), threads=way.threads))]


@asked(GOOD)
def baked_cells(case: meshes.Case, way: Way) -> Iterable[object]:
    sites = sb.sample(case.mesh, 8, seed=6, one_per_component=True)
    found = sb.geodesic_voronoi(graph_of(case, way), sites, threads=way.threads, device=way.device)
    uv = np.random.default_rng(1).random((3 * case.mesh.face_count, 2))
    image = sb.bake_cells(found, uv, values=uv, size=(60, 40), margin=2, allow_overlaps=True, threads=way.threads)
    return all_of(image, "triangle cell edge_distance local_uv values overlapping")


@asked(
    LARGE,
    strict={"policy": "strict", "count": 12},
    repair={"policy": "repair", "count": 6},
    many={"policy": "repair", "count": 40},
)
def dual(case: meshes.Case, way: Way, policy: Any, count: int) -> Iterable[object]:
    sites = sb.sample(case.mesh, count, seed=2, one_per_component=True)
    found = sb.geodesic_voronoi(graph_of(case, way), sites, threads=way.threads, device=way.device)
    made = found.dual(policy, threads=way.threads)
    paths = found.dual_paths(threads=way.threads)
    return [
        *all_of(made, "vertices triangles edges edge_lengths added"), *surface(made.sites), len(made.issues),
        *[path.points for path in paths],
    ]  # fmt: skip


@asked(LARGE, few={"count": 6}, many={"count": 40})
def faces_of_cells(case: meshes.Case, way: Way, count: int) -> Iterable[object]:
    sites = sb.sample(case.mesh, count, seed=2, one_per_component=True)
    found = sb.geodesic_voronoi(graph_of(case, way), sites, threads=way.threads, device=way.device)
    polygons = found.polygons("strict")
    points, quads = found.dual("strict").quads()
    return [*all_of(polygons, "vertices corners offsets polygon_cell missing"), *surface(points), quads]


def relaxed(case: meshes.Case, way: Way, **options: Any) -> sb.CentroidalVoronoi:
    return sb.centroidal_voronoi(graph_of(case, way), threads=way.threads, device=way.device, **options)


def even_cells_of(result: sb.CentroidalVoronoi) -> list[object]:
    names = "energy iterations converged held normalized_energy exchanged"
    return [*surface(result.sites), *all_of(result, names), *all_of(result.cells, CELLS)]


@asked(LARGE, lbfgs={"max_iterations": 12}, lloyd={"method": "lloyd", "max_iterations": 8})
def even_cells(case: meshes.Case, way: Way, **options: Any) -> Iterable[object]:
    return even_cells_of(relaxed(case, way, count=20, seed=3, **options))


@asked(LARGE)
def even_cells_density(case: meshes.Case, way: Way) -> Iterable[object]:
    return even_cells_of(relaxed(case, way, count=15, density=density_of(case), max_iterations=8))


@asked(
    FEW,
    coarse_to_fine={"start": "coarse_to_fine", "max_iterations": 4, "count": 60},
    starts={"starts": 3, "max_iterations": 5},
    annealing={"annealing": 4, "max_iterations": 6},
    closed_ball={"closed_ball": True, "count": 12, "max_iterations": 8},
    least_move={"least_move": 0.02, "max_iterations": 10},
)
def even_cells_options(case: meshes.Case, way: Way, **options: Any) -> Iterable[object]:
    return even_cells_of(relaxed(case, way, **{"count": 15, "seed": 4, **options}))


@asked(FEW)
def of_a_metric(case: meshes.Case, way: Way) -> Iterable[object]:
    lengths = sb.curvature_metric(case.mesh, 0.3)
    mesh = sb.Mesh(case.vertices, case.triangles, lengths=lengths)
    graph = sb.SaddleVertexGraph(mesh, k=30, threads=way.threads, device=way.device)
    result = sb.centroidal_voronoi(graph, count=20, max_iterations=8, threads=way.threads, device=way.device)
    field = sb.direction_field(mesh, 4)
    return [lengths, sb.exact_distances(mesh, 0), *graph.arcs(), *even_cells_of(result), field.angles]


@asked(FEW)
def even_cells_held(case: meshes.Case, way: Way) -> Iterable[object]:
    curves = sb.feature_curves(case.mesh, 0.6)[:3]
    sites = sb.sample(case.mesh, 12, seed=8)
    cache = sb.CellCache()
    first = relaxed(case, way, sites=sites, fixed=[0, 3], max_iterations=4, cache=cache)
    again = relaxed(case, way, sites=first.sites[:11], max_iterations=3, cache=cache)
    return [
        *even_cells_of(first),
        *even_cells_of(again),
        *even_cells_of(relaxed(case, way, count=20, curves=curves, max_iterations=4)),
    ]


@asked({name: case for name, case in LARGE.items() if case.components == 1})
def center(case: meshes.Case, way: Way) -> Iterable[object]:
    points = points_on(case, 5)
    graph = graph_of(case, way)
    return [
        *surface(sb.geodesic_center(graph, points)),
        *surface(sb.geodesic_center(graph, np.arange(4, dtype=np.int32), [1.0, 2.0, 3.0, 4.0])),
    ]  # fmt: skip


@asked(LARGE, one={"symmetry": 1}, two={"symmetry": 2, "align": "boundary"}, four={"symmetry": 4, "align": "curvature"})
def field(case: meshes.Case, **options: Any) -> Iterable[object]:
    made = sb.direction_field(case.mesh, **options)
    names = "vectors angles turns loop_indices largest_turn sharp_edges"
    answer = [*all_of(made, names), np.array(sorted(made.singularities.items())), made.directions(points_on(case, 20))]
    for point in points_on(case, 3):
        line = sb.streamline(case.mesh, made, point, 8 * case.mesh.mean_edge_length, True)
        answer += [line.points, line.length, line.start]
    return answer


@asked(FEW, free={}, stroke={"hard": True})
def field_strokes(case: meshes.Case, hard: bool = False) -> Iterable[object]:
    line = sb.trace(case.mesh, points_on(case, 3)[2], 1.0, 6 * case.mesh.mean_edge_length)
    stroke = sb.Stroke(sb.SurfaceCurve(case.mesh, line.surface), hard)
    made = sb.direction_field(case.mesh, 2, strokes=[stroke])
    return all_of(made, "vectors angles turns")


@asked({name: LARGE[name] for name in ("icosphere", "torus", "bumpy_torus")})
def field_singularities(case: meshes.Case) -> Iterable[object]:
    wanted = {5: 1.0, 90: 1.0 if case.genus == 0 else -1.0}
    return all_of(sb.direction_field(case.mesh, 2, wanted), "vectors angles turns")


@asked(GOOD)
def curvature_and_features(case: meshes.Case) -> Iterable[object]:
    curves = sb.feature_curves(case.mesh, 0.6)
    return [
        *sb.principal_curvatures(case.mesh), sb.density_by_curvature(case.mesh),
        *[part for curve in curves for part in (*surface(curve.points), curve.length)],
    ]  # fmt: skip


@asked(GOOD)
def barriers(case: meshes.Case) -> Iterable[object]:
    count = len(case.vertices)
    curve = sb.SurfaceCurve(case.mesh, sb.trace(case.mesh, count // 2, 0.3, 0.7).surface)
    barred = sb.add_barriers(case.mesh, edges=case.mesh.edges[::5], curves=[curve])
    values = rounded(barred.values_to_barred(np.arange(count, dtype=float)))
    return [
        barred.mesh.vertices, barred.mesh.triangles, *all_of(barred, "vertex_origin face_origin"),
        barred.least(values), barred.least_copies(values), *surface(barred.to_barred(np.arange(count))[0]),
    ]  # fmt: skip


@asked(GOOD, harmonic={"method": "harmonic"}, biharmonic={"method": "biharmonic"})
def spread(case: meshes.Case, method: Any) -> Iterable[object]:
    count = min(4, len(case.vertices))
    places = np.random.default_rng(9).permutation(len(case.vertices))[:count].astype(np.int32)
    return [sb.spread_values(case.mesh, places, np.arange(1.0, count + 1), method)]


@asked(DISKS)
def charts(case: meshes.Case, way: Way) -> Iterable[object]:
    uv = sb.harmonic_map(case.mesh)
    chart = sb.Chart(case.mesh, uv)
    places = np.random.default_rng(2).random((30, 2)) * np.ptp(uv, axis=0) + uv.min(axis=0)
    points, inside = chart.locate(places, threads=way.threads)
    lifted = chart.lift(sb.voronoi_2d(places, threads=way.threads), threads=way.threads)
    split = lifted.split()
    return [
        uv, chart.area, *surface(points), inside, chart.places(points_on(case, 20)),
        *all_of(lifted, "areas centroids face_cell edge_points edge_offsets edge_of edge_cells"),
        *all_of(split, "vertices triangles triangle_cell vertex_origin"),
    ]  # fmt: skip


@asked(GOOD)
def triangle_arrays(case: meshes.Case, way: Way) -> Iterable[object]:
    vertices, triangles = case.vertices, case.triangles
    kinds = (np.arange(len(triangles)) * 7 % 5 // 2).astype(np.int32)
    height = np.column_stack([vertices, vertices @ (1.0, 0.5, 0.25)])
    quality = sb.triangle_quality(vertices, triangles)
    turned = sb.Mesh(vertices[:, [1, 2, 0]], triangles)
    distance = sb.hausdorff_distance(case.mesh, turned, 1e-2, threads=way.threads)
    return [
        sb.vertex_normals(vertices, triangles), *sb.triangle_edges(triangles, len(vertices)),
        *sb.border_edges(triangles, len(vertices)), *sb.cut_at_level(height, triangles, 3, 0.3),
        sb.self_crossings(vertices, triangles, threads=way.threads), *sb.cell_boundary(triangles, kinds, len(vertices)),
        sb.cell_boundary_distance(vertices, triangles, kinds),
        *all_of(quality, "quality least_angle greatest_angle valence irregular mean_quality"),
        *all_of(distance, "distance from_first from_second"),
    ]  # fmt: skip


# --- broken meshes, files ---------------------------------------------------------------------------------------------


def _broken() -> dict[str, meshes.Arrays]:
    cases = {case.name: (rounded(case.vertices), case.triangles) for case in meshes.broken()}
    vertices, triangles = meshes.soup()
    return {**cases, "soup": (rounded(vertices), triangles), "holes": meshes.holes()}


@asked(_broken(), plain={}, weld={"weld_distance": 0.01, "stitch": True, "fill_holes": 12})
def repair(arrays: meshes.Arrays, **options: Any) -> Iterable[object]:
    mended, report = sb.repair(*arrays, **options)
    changes = np.array(list(report.changes.values()))
    return [
        mended.vertices, mended.triangles, changes,
        *all_of(report, "vertex_map face_map near_border_vertices joining_distance t_junctions"),
    ]  # fmt: skip


@asked({name.replace(", ", "-").replace(" ", "_"): name for name in mesh_dialects.DIALECTS}, portable=True)
def read(name: str) -> Iterable[object]:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"box.{mesh_dialects.DIALECTS[name][0]}"
        path.write_bytes(mesh_dialects.contents(name))
        return sb.read_arrays(path)

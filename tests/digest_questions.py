# SPDX-License-Identifier: MIT
"""What `tests.digests` asks the library: every public answer, on the meshes, sites and files of the test suite.

Coordinates that come from sines, powers or normal deviates are rounded to 24 bits, so that every platform asks the
same. A question is marked `portable` when its answer depends on nothing of libm but square roots: that is promised to
be equal to the bit on every platform. Not so exact distances: angles decide where they bend around vertices, and with
sines and arc tangents off by one bit 5 of 140,688 exact arcs were off by one bit, too; nothing else of them was.
"""

from __future__ import annotations

import functools
import inspect
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import saddleback as sb
from saddleback._saddleback import predicates
from tests import meshes
from tests.native import mesh_dialects, plane_sites, weighted_sites
from tests.native.graph_files import GraphFile


@dataclass(frozen=True)
class Way:
    """How a question is asked: by so many threads, on this device."""

    threads: int = 1
    device: str = "cpu"


@dataclass(frozen=True)
class Question:
    name: str
    subject: str
    portable: bool
    ask: Callable[[Way], Iterable[object]]
    has_threads: bool  # the answer may depend on their number, if there is a fault


QUESTIONS: list[Question] = []


def asked(subjects: dict[str, Any], *, portable: bool = False, **rules: dict[str, Any]) -> Callable[..., Any]:
    """Ask a function of a subject, perhaps of the way, and of each rule's options, about each of the subjects."""

    def add(function: Callable[..., Iterable[object]]) -> Callable[..., Iterable[object]]:
        has_way = "way" in inspect.signature(function).parameters
        for subject, thing in subjects.items():
            for rule, options in (rules or {"": {}}).items():

                def ask(way: Way, thing: Any = thing, options: dict[str, Any] = options) -> Iterable[object]:
                    return function(thing, way, **options) if has_way else function(thing, **options)

                name = function.__name__ + (f" {rule}" if rule else "")
                QUESTIONS.append(Question(name, subject, portable, ask, has_way))
        return function

    return add


def rounded(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """To 24 bits."""
    return points.astype(np.float32).astype(np.float64)


def all_of(thing: object, names: str) -> list[object]:
    return [getattr(thing, name) for name in names.split()]


def surface(points: sb.SurfacePoints) -> list[object]:
    return [points.faces, points.barycentric]


# --- surfaces ---------------------------------------------------------------------------------------------------------

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


# --- the plane --------------------------------------------------------------------------------------------------------

FROM_DEVIATES = ("clusters", "circle", "two_rings", "regular_polygon", "all_scales")
SQUARE = np.array([(0.1, 0.1), (0.9, 0.1), (0.9, 0.9), (0.1, 0.9)])
HOLED = [SQUARE, np.array([(0.4, 0.4), (0.4, 0.6), (0.6, 0.6), (0.6, 0.4)])]
DIAGRAM = "site_of hidden vertices edges edge_sites edge_directions delaunay"
CLIPPED = "points loop_offsets loop_sites areas centroids"


def _plane(n: int) -> dict[str, NDArray[np.float64]]:
    kinds = {
        name: make(n, np.random.default_rng(n)) for name, make in plane_sites.KINDS.items() if name != "near_twins"
    }
    return {f"{name}-{n}": rounded(sites) if name in FROM_DEVIATES else sites for name, sites in kinds.items()}


def _weighted(n: int) -> dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]:
    made = {name: make(n, np.random.default_rng(n)) for name, make in weighted_sites.KINDS.items()}
    angular = ("clustered_disks", "one_ring")
    return {f"{k}-{n}": (rounded(v[0]), rounded(v[1])) if k in angular else v for k, v in made.items()}


PLANE = {**_plane(60), **_plane(5000)}
WEIGHTED = {**_weighted(60), **_weighted(1500)}
USUAL = {name: sites for name, sites in _plane(60).items() if name != "huge-60"}


@asked(PLANE, portable=True)
def diagram(sites: NDArray[np.float64], way: Way) -> Iterable[object]:
    made = sb.voronoi_2d(sites, threads=way.threads, device=way.device)
    return [*all_of(made, DIAGRAM), *made.cells, made.locate(sites[::3] * 1.01, threads=way.threads)]


@asked(PLANE, portable=True)
def diagram_areas(sites: NDArray[np.float64], way: Way) -> Iterable[object]:
    return all_of(sb.voronoi_2d(sites, threads=way.threads, device=way.device), "areas centroids")


@asked(WEIGHTED, portable=True)
def weighted_diagram(disks: tuple[NDArray[np.float64], NDArray[np.float64]], way: Way) -> Iterable[object]:
    made = sb.voronoi_2d(*disks, threads=way.threads, device=way.device)
    return [*all_of(made, DIAGRAM), *made.cells, made.locate(disks[0][::3] * 1.01, threads=way.threads)]


@asked({name: disks for name, disks in WEIGHTED.items() if not name.startswith("huge")}, portable=True)
def power_diagram(disks: tuple[NDArray[np.float64], NDArray[np.float64]], way: Way) -> Iterable[object]:
    made = sb.power_diagram_2d(disks[0], disks[1] * np.abs(disks[1]), threads=way.threads)
    clipped = made.clip(disks[0].min(axis=0) + float(np.ptp(disks[0], axis=0).max()) * SQUARE, threads=way.threads)
    return [*all_of(made, DIAGRAM), *made.cells, made.locate(disks[0][::3] * 1.01), *all_of(clipped, CLIPPED)]


PERIODIC = "vertices edges edge_shifts edge_sites edge_site_shifts corner_vertices corner_shifts delaunay areas"


@asked({name: PLANE[name] for name in ("uniform-60", "grid-60", "duplicates-60", "uniform-5000")}, portable=True)
def periodic_diagram(sites: NDArray[np.float64], way: Way) -> Iterable[object]:
    weights = 1e-3 * np.random.default_rng(1).random(len(sites))
    answer: list[object] = []
    for given in (None, weights):
        made = sb.periodic_voronoi_2d(sites, [(0, 0), (1, 0.5)], given, threads=way.threads)
        answer += [*all_of(made, PERIODIC), *made.cells, made.locate(sites[::3] * 1.01)]
    return answer


@asked({name: disks for name, disks in WEIGHTED.items() if not name.startswith("huge")})
def weighted_curves(disks: tuple[NDArray[np.float64], NDArray[np.float64]], way: Way) -> Iterable[object]:
    made = sb.voronoi_2d(*disks, threads=way.threads, device=way.device)
    size = float(np.ptp(disks[0], axis=0).max())
    low = disks[0].min(axis=0)
    clipped = made.clip(low + size * SQUARE, tolerance=1e-3 * size, threads=way.threads)
    lines = [made.edge_polyline(edge, 1e-3 * size, size) for edge in range(min(10, len(made.edges)))]
    return [*all_of(made, "areas centroids"), *lines, *all_of(clipped, CLIPPED)]


@asked({**USUAL, "uniform-5000": PLANE["uniform-5000"]}, portable=True)
def clipped_diagram(sites: NDArray[np.float64], way: Way) -> Iterable[object]:
    size, low = float(np.ptp(sites, axis=0).max()), sites.min(axis=0)
    made = sb.voronoi_2d(sites, threads=way.threads, device=way.device)
    return [
        *all_of(made.clip([low + size * loop for loop in HOLED], threads=way.threads), CLIPPED),
        *all_of(made.clip(low + size * SQUARE, gap=0.02 * size, threads=way.threads), CLIPPED),
    ]  # fmt: skip


@asked({"uniform-60": PLANE["uniform-60"], "uniform-5000": PLANE["uniform-5000"]}, portable=True)
def relaxed_2d(sites: NDArray[np.float64], way: Way) -> Iterable[object]:
    density = np.random.default_rng(1).random((8, 8))
    answer: list[object] = []
    for given in (None, density):
        done = sb.relax_2d(sites, HOLED, given, max_iterations=6, threads=way.threads)
        answer += all_of(done, "sites energy iterations converged")
    return answer


@asked({"uniform-60": PLANE["uniform-60"], "uniform-5000": PLANE["uniform-5000"]}, portable=True)
def balanced_2d(sites: NDArray[np.float64], way: Way) -> Iterable[object]:
    density = np.random.default_rng(1).random((8, 8))
    answer: list[object] = []
    for given in (None, density):
        done = sb.balance_2d(sites, HOLED, given, max_iterations=3, threads=way.threads)
        answer += all_of(done, "sites weights shares energy iterations converged")
    return answer


@asked({"uniform-60": PLANE["uniform-60"]})
def weighted_gaps_and_areas(sites: NDArray[np.float64], way: Way) -> Iterable[object]:
    weights = 0.1 * np.random.default_rng(1).random(len(sites))
    clipped = sb.voronoi_2d(sites, weights, threads=way.threads).clip(HOLED, gap=0.02, threads=way.threads)
    relaxed = sb.relax_2d(sites, HOLED, max_iterations=4, weights=weights, threads=way.threads)
    found = sb.weights_for_areas(0.1 + 0.8 * sites, SQUARE, max_iterations=4, threads=way.threads)
    answer: list[object] = []
    answer += all_of(clipped, "points loop_offsets loop_sites areas")
    answer += all_of(relaxed, "sites energy iterations converged")
    return answer + all_of(found, "weights shares lacks iterations converged")


@asked(USUAL)
def sweep_circle(sites: NDArray[np.float64]) -> Iterable[object]:
    size = float(np.ptp(sites, axis=0).max())
    sweep = sb.SweepCircle(sites, sites.mean(axis=0))
    sweep.grow(0.3 * size)
    answer: list[object] = [sweep.radius, sweep.beach_curve(16), np.array(sweep.arcs)]
    while (event := sweep.step()) is not None:
        answer += [event.kind == "touch", event.radius, event.sites, event.point]
    return [*answer, *sweep.edges]


@asked({**_weighted(60), **{name: (sites, None) for name, sites in _plane(60).items()}})
def sweep_circles(disks: tuple[NDArray[np.float64], Any]) -> Iterable[object]:
    sites, weights = disks
    size = float(np.ptp(sites, axis=0).max())
    sweep = sb.SweepCircles(sites, sites[[0, len(sites) // 2]], weights)
    sweep.grow(0.4 * size)
    steps = 0
    while sweep.step() is not None and steps < 200:
        steps += 1
    return [steps, sweep.radii, sweep.done, *sweep.edges(0), *sweep.edges(1)]


@asked({"nearly": 2.0**-52, "coarse": 2.0**-10}, portable=True)
def signs(step: float) -> Iterable[object]:
    """Of points nearly in a row and nearly on a circle."""
    random = np.random.default_rng(1)
    grid = lambda *shape: random.integers(-3, 4, shape) * step  # noqa: E731
    a, b, c, d = (np.array(place) + grid(400, 2) for place in ((0.5, 0.5), (12.0, 12.0), (24.0, 24.0), (12.0, 0.5)))
    p, q, r = (np.array(place) + grid(400, 3) for place in ((1.0, 1.0, 1.0), (2.0, 2.0, 2.0), (4.0, 4.0, 4.0)))
    circle = [np.array(place) + grid(400, 2) for place in ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))]
    return [
        predicates.orient_2d(a, b, c), predicates.in_circle(a, b, d, c), predicates.in_circle(*circle),
        predicates.collinear_3d(p, q, r),
    ]  # fmt: skip


# --- shapes -----------------------------------------------------------------------------------------------------------

FRAME = sb.Shape([SQUARE * 2 - 1, (SQUARE - 0.5)[::-1]])
PRESETS = {
    "disk": sb.Shape.disk(24), "star": sb.Shape.star(5), "needle": sb.Shape.needle(6), "leaf": sb.Shape.leaf(),
    "drop": sb.Shape.drop(), "crescent": sb.Shape.crescent(0.8, 0.4, 20), "frame": FRAME,
}  # fmt: skip
SOLID = (
    np.array([(0.0, 0, 0), (0.5, 0, 0.1), (0.2, 0.5, 0), (0.2, 0.2, 0.4)]),
    np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]),
)


@asked(PRESETS)
def shape(given: sb.Shape, way: Way) -> Iterable[object]:
    names = "area circumradius inradius has_half_turn"
    table = sb.SafeDistanceTable(given, PRESETS["leaf"], threads=way.threads)
    turns = np.linspace(0, 6, 20)
    moved = given.moved(0.5, 0.3, (0.1, 0.2))
    return [
        *given.loops, *all_of(given, names), *moved.loops, *given.mirrored().loops,
        given.contains(np.random.default_rng(1).uniform(-1, 1, (50, 2))), given.overlaps(moved),
        table.distance(turns, turns[::-1].copy(), 1.0, 0.5), table.nbytes,
    ]  # fmt: skip


@asked({"blobs": 7, "noise": 1})
def shape_from_mask(coarse: int) -> Iterable[object]:
    image = np.kron(
        np.random.default_rng(coarse).random((40 // coarse, 40 // coarse)) > 0.45, np.ones((coarse, coarse))
    )
    made = sb.Shape.from_mask(np.pad(image, 2).astype(np.uint8) * 255)
    return [*made.loops, made.area, made.circumradius]


def placements_of(made: sb.Placements) -> list[object]:
    return [*all_of(made, "shape angle scale mirrored"), *surface(made.center)]


COVERED = {
    name: LARGE[name]
    for name in ("icosphere", "torus", "grid_jittered", "saddle", "cone", "double_torus", "bumpy_torus")
}


@asked(COVERED)
def mapped_shapes(case: meshes.Case, way: Way) -> Iterable[object]:
    random, shapes, count = np.random.default_rng(3), list(PRESETS.values()), 9
    size = 0.12 * case.mesh.area**0.5
    placements = sb.Placements(
        random.integers(0, len(shapes), count), sb.sample(case.mesh, count, seed=3), random.uniform(0, 6, count),
        np.full(count, size), random.random(count) < 0.5,
    )  # fmt: skip
    mapped = sb.map_shapes(case.mesh, shapes, placements, threads=way.threads)
    laid = [i for i in range(len(mapped)) if i not in mapped.failures]
    bent = mapped.bend([SOLID] * len(shapes), threads=way.threads)
    told = mapped.attributes(0.2 * size, threads=way.threads)
    report = sb.check_distribution(case.mesh, mapped, samples=2000, threads=way.threads)
    patches = mapped.patches()
    names = "coverage patch_coverage stretch fault_count"
    return [
        np.array(sorted(mapped.failures)), mapped.stretch, *mapped.frames(),
        *[loop for i in laid for loop in mapped.outline(i)],
        *[mapped.conform(SOLID[0], i).points for i in laid],
        *all_of(bent, "vertices heights begins triangles triangle_copy triangle_source deviations lost"),
        *all_of(patches, "vertices triangles triangle_face triangle_shape uv"),
        *all_of(told, "placement distance uv"), *all_of(report, names),
    ]  # fmt: skip


@asked(
    COVERED,
    random={"counts": [4, 5, 3]},
    packed={"counts": [4, 5, 3], "mode": "packed", "mirror": True},
    mixed={"counts": [3, 3, 3], "mode": 0.5, "size_range": (0.6, 1.0), "gap": 0.01},
)
def distribution(case: meshes.Case, way: Way, **options: Any) -> Iterable[object]:
    shapes = [PRESETS[name] for name in ("star", "disk", "crescent")]
    made = sb.distribute(case.mesh, shapes, seed=1, size=0.1 * case.mesh.area**0.5, threads=way.threads, **options)
    cut, told = made.mapped.cut(), made.mapped.attributes(0.05, threads=way.threads)
    return [
        *placements_of(made.placements), np.array(list(made.rejections.values())), *made.outline(0),
        *all_of(cut, "vertices triangles triangle_face triangle_shape uv"), *all_of(told, "placement distance uv"),
    ]  # fmt: skip


@asked(COVERED)
def distribution_field(case: meshes.Case, way: Way) -> Iterable[object]:
    along = sb.direction_field(case.mesh, 2)
    size, density = 0.15 * case.mesh.area**0.5, density_of(case)
    made = sb.distribute(
        case.mesh, PRESETS["leaf"], field=along, density=density, size=size, bend=True, counts=6, threads=way.threads
    )
    full = sb.distribute(
        case.mesh, PRESETS["star"], field=along, size=1.5 * size, maximal=True, tolerance=0.1, threads=way.threads
    )
    proof = all_of(full.certificate, "tolerance cells leaves uncertified_area")
    return [*placements_of(made.placements), *placements_of(full.placements), *proof]

# SPDX-License-Identifier: MIT
"""Progress and cancelling of the engine's long calls: `python -m tests.bench progress [--only TEXT] [MESH...]`.

A line a call: its seconds, how much longer it takes watched than unwatched, the longest time in which neither the share
nor the text changes, and the longest wait after `Job.cancel()` at random moments. `!` marks what breaks the promise: a
share that falls or does not end at 1, a standstill of more than 0.5 s, a wait of more than 0.1 s. All calls use one
thread; seconds are its processor time, standstills and waits are by the clock on the wall.
"""

from __future__ import annotations

import argparse
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import saddleback as sb
from tests import meshes

Call = Callable[[sb.Job | None, Any], object]
MOST_SILENCE, MOST_WAIT = 0.5, 0.1  # seconds
THREADS = 1  # tests.bench.versions asks for others
MOST_FOR_EXACT = 5000  # vertices: the exact graph holds all pairs in sight


@dataclass(frozen=True)
class Case:
    """A call with a job and with what was prepared for it, each time, unwatched."""

    name: str
    call: Call
    prepare: Callable[[], Any] = lambda: None


@dataclass(frozen=True)
class Watched:
    """What another thread saw of one call: its processor time, its shares, and its longest standstill on the wall."""

    seconds: float
    shares: np.ndarray
    last: float
    silence: float

    def is_rising(self) -> bool:
        return bool((np.diff(self.shares) >= 0).all()) and self.last == 1


class Runner(threading.Thread):
    """Calls in a thread of its own."""

    def __init__(self, case: Case, job: sb.Job | None):
        super().__init__()
        self.job = job
        self.done = threading.Event()
        self.ended_at = self.begin = self.end = 0.0
        self.error: BaseException | None = None
        self._call, self._given = case.call, case.prepare()
        self.start()

    def run(self) -> None:
        self.begin = time.thread_time()
        try:
            self._call(self.job, self._given)
        except BaseException as error:  # whoever waits for the call is told
            self.error = error
        self.end = time.thread_time()
        self.ended_at = time.perf_counter()
        self.done.set()


def watch(case: Case) -> Watched:
    runner = Runner(case, job := sb.Job())
    shares, told, silence = [0.0], (0.0, ""), 0.0
    since = time.perf_counter()
    while not runner.done.wait(0.02):
        seen = job.fraction, job.text
        shares.append(seen[0])
        silence = max(silence, time.perf_counter() - since)
        if seen != told:
            told, since = seen, time.perf_counter()
    runner.join()
    if runner.error:
        raise runner.error
    return Watched(runner.end - runner.begin, np.array(shares), job.fraction, silence)


def unwatched(case: Case) -> float:
    """In a thread as well, as the heaps of threads are other than that of the main one."""
    runner = Runner(case, None)
    runner.join()
    if runner.error:
        raise runner.error
    return runner.end - runner.begin


def wait_after_cancel(case: Case, after: float) -> float:
    """Seconds on the wall; 0 where the call was done before."""
    runner = Runner(case, job := sb.Job())
    if runner.done.wait(after):
        runner.join()
        return 0.0
    asked = time.perf_counter()
    job.cancel()
    runner.join()
    if runner.error and not isinstance(runner.error, sb.Cancelled):
        raise runner.error
    return max(0.0, runner.ended_at - asked)


def build_calls(mesh: sb.Mesh) -> Iterator[Case]:
    def build(**how: Any) -> Call:
        return lambda job, _: sb.SaddleVertexGraph(mesh, threads=THREADS, device="cpu", job=job, **how)

    for accuracy in (2e-2, 5e-3, 1e-3):
        yield Case(f"build, accuracy={accuracy:g}", build(accuracy=accuracy))
    for k in (20, 50, 200):
        yield Case(f"build, k={k}", build(k=min(k, mesh.vertex_count)))
    if mesh.vertex_count <= MOST_FOR_EXACT:
        yield Case("build, exact", build(exact=True))


def exact_calls(mesh: sb.Mesh) -> Iterator[Case]:
    middle = mesh.vertex_count // 2
    inside = sb.SurfacePoints([mesh.face_count // 3], [[0.2, 0.3, 0.5]])
    size = float(np.ptp(mesh.vertices, axis=0).max())
    yield Case("exact_distances, vertex 0", lambda job, _: sb.exact_distances(mesh, [0], job=job))
    yield Case("exact_distances, middle vertex", lambda job, _: sb.exact_distances(mesh, [middle], job=job))
    yield Case("exact_distances, inside a face", lambda job, _: sb.exact_distances(mesh, inside, job=job))
    yield Case("exact_distances, limit", lambda job, _: sb.exact_distances(mesh, [middle], 0.4 * size, job=job))
    for count in (5, 50, 500, 5000):
        some = sb.sample(mesh, count, seed=count)
        yield Case(f"exact_distances, {count}", lambda job, _, some=some: sb.exact_distances(mesh, some, job=job))
    some = sb.sample(mesh, 300, seed=1)
    limit = 0.7 * (mesh.area / 300) ** 0.5
    yield Case("exact_distances, 300, limit", lambda job, _: sb.exact_distances(mesh, some, limit, job=job))
    yield Case("exact_nearest, 300", lambda job, _: sb.exact_nearest(mesh, some, job=job))
    yield Case("ExactField", lambda job, _: sb.ExactField(mesh, [middle], job=job))
    field, many = sb.ExactField(mesh, [middle]), reached(mesh, sb.sample(mesh, 20_000, seed=2), middle)
    yield Case("ExactField.distance_to, 20,000", lambda job, _: field.distance_to(many, job=job))
    yield Case("ExactField.paths, 20,000", lambda job, _: field.paths(many, job=job))


def reached(mesh: sb.Mesh, points: sb.SurfacePoints, source: int) -> sb.SurfacePoints:
    distances = sb.exact_distances(mesh, [source])
    kept = np.isfinite(distances[mesh.triangles[points.faces, 0]])
    return sb.SurfacePoints(points.faces[kept], points.barycentric[kept])


def query_calls(mesh: sb.Mesh, graph: sb.SaddleVertexGraph) -> Iterator[Case]:
    few, some, many = (sb.sample(mesh, count, seed=count) for count in (20, 300, 5000))
    vertices = np.random.default_rng(0).integers(mesh.vertex_count, size=20_000).astype(np.int32)
    curve = sb.SurfaceCurve(mesh, sb.trace(mesh, 0, 0.3, 3 * mesh.area**0.5).surface)
    size = 0.4 * float(np.ptp(mesh.vertices, axis=0).max())
    yield Case("distances, vertex", lambda job, _: graph.distances([0], job=job))
    yield Case("distances, dijkstra", lambda job, _: graph.distances([0], method="dijkstra", job=job))
    yield Case("distances, limit", lambda job, _: graph.distances([0], size, job=job))
    yield Case("distances, 300 points", lambda job, _: graph.distances(some, job=job))
    yield Case("distances, curve", lambda job, _: graph.distances(curve, job=job))
    yield Case("distances, curve, limit", lambda job, _: graph.distances(curve, size, job=job))
    yield Case("nearest, 5,000 points", lambda job, _: graph.nearest(many, job=job))
    yield Case("nearest, vertices", lambda job, _: graph.nearest(vertices[:1500], job=job))
    yield Case("fields, 100 vertices", lambda job, _: graph.fields(vertices[:100], threads=THREADS, job=job))
    yield Case("fields, 20 points", lambda job, _: graph.fields(few, threads=THREADS, job=job))
    yield Case("distances_to, 20 to 5,000", lambda job, _: graph.distances_to(few, many, job=job))
    yield Case("distances_to, 300 to 5,000", lambda job, _: graph.distances_to(some, many, job=job))
    yield Case("distances_to, curve to 5,000", lambda job, _: graph.distances_to(curve, many, job=job))
    # The first distance of a graph lays its landmarks.
    last = mesh.vertex_count - 1
    yield Case("distance, the first", lambda job, fresh: fresh.distance(0, last, job=job), lambda: copy(graph))


def copy(graph: sb.SaddleVertexGraph) -> sb.SaddleVertexGraph:
    with tempfile.TemporaryDirectory() as folder:
        graph.save(Path(folder) / "graph")
        return sb.SaddleVertexGraph.load(Path(folder) / "graph", graph.mesh)


def path_calls(mesh: sb.Mesh, graph: sb.SaddleVertexGraph) -> Iterator[Case]:
    some, many = sb.sample(mesh, 300, seed=3), sb.sample(mesh, 2000, seed=4)
    vertices = np.random.default_rng(5).integers(mesh.vertex_count, size=20_000).astype(np.int32)

    def paths(sources: object, targets: object, shorten: bool = False) -> Call:
        return lambda job, _: graph.paths(sources, targets, shorten, threads=THREADS, job=job)  # type: ignore[arg-type]

    yield Case("paths, 1 to 20,000 vertices", paths([0], vertices))
    yield Case("paths, 1 to 2,000 points", paths([0], many))
    yield Case("paths, 300 to 300 points", paths(some, some))
    yield Case("paths, 300 to 2,000 points", paths(some, many))
    yield Case("paths, 2,000 to 20,000 vertices", paths(many, vertices))
    yield Case("paths, shortened, 1 to 1,000 vertices", paths([0], vertices[:1000], True))
    yield Case("paths, shortened, 300 to 5,000 vertices", paths(some, vertices[:5000], True))
    yield Case("paths, shortened, 300 to 2,000 points", paths(some, many, True))


def map_calls(mesh: sb.Mesh, graph: sb.SaddleVertexGraph, folder: Path) -> Iterator[Case]:
    size = 0.4 * float(np.ptp(mesh.vertices, axis=0).max())
    middle = mesh.vertex_count // 2
    curve = sb.SurfaceCurve(mesh, sb.trace(mesh, 0, 0.3, mesh.area**0.5).surface)
    uv = np.random.default_rng(6).normal(size=(20_000, 2)) * size / 2
    yield Case("log_map", lambda job, _: graph.log_map(middle, np.inf, job=job))
    yield Case("log_map, radius", lambda job, _: graph.log_map(middle, size, job=job))
    yield Case("polar_coordinates", lambda job, _: sb.polar_coordinates(graph, curve, np.inf, job=job))
    yield Case("polar_coordinates, radius", lambda job, _: sb.polar_coordinates(graph, curve, size, job=job))
    yield Case("trace", lambda job, _: sb.trace(mesh, middle, 0.3, 2e5 * mesh.mean_edge_length, job=job))
    yield Case("exp_map, 20,000", lambda job, _: sb.exp_map(mesh, middle, uv, threads=THREADS, job=job))
    path = folder / "graph"
    graph.save(path)
    yield Case("save", lambda job, _: graph.save(folder / "saved", job=job))
    yield Case("load", lambda job, _: sb.SaddleVertexGraph.load(path, mesh, job=job))


def pattern_calls(mesh: sb.Mesh, graph: sb.SaddleVertexGraph) -> Iterator[Case]:
    cells = sb.geodesic_voronoi(graph, sb.sample(mesh, 500))
    field = sb.direction_field(mesh, symmetry=1)
    size = 0.02 * mesh.area**0.5
    star = sb.Shape.star()
    placed = sb.distribute(graph, star, [300], size=size, threads=THREADS).placements
    sites = np.random.default_rng(7).uniform(size=(500_000, 2))
    weights = np.random.default_rng(8).uniform(0, 1e-3, size=50_000)
    yield Case(
        "centroidal_voronoi, 500",
        lambda job, _: sb.centroidal_voronoi(graph, count=500, max_iterations=15, threads=THREADS, job=job),
    )
    yield Case("exact cells, 500", lambda job, _: sb.geodesic_voronoi(graph, cells.sites, exact=True, job=job))
    yield Case("dual", lambda job, _: cells.dual(job=job))
    yield Case("direction_field", lambda job, _: sb.direction_field(mesh, symmetry=4, align="curvature", job=job))
    yield Case(
        "distribute, maximal",
        lambda job, _: sb.distribute(graph, star, None, field=field, size=size, maximal=True, threads=THREADS, job=job),
    )
    yield Case("map_shapes, 300", lambda job, _: sb.map_shapes(mesh, star, placed, threads=THREADS, job=job))
    yield Case("repair", lambda job, _: sb.repair(mesh.vertices, mesh.triangles, job=job))
    yield Case("voronoi_2d, 500,000", lambda job, _: sb.voronoi_2d(sites, threads=THREADS, job=job))
    yield Case(
        "voronoi_2d, 50,000 weighted", lambda job, _: sb.voronoi_2d(sites[:50_000], weights, threads=THREADS, job=job)
    )


def calls(mesh: sb.Mesh, folder: Path) -> Iterator[Case]:
    yield from build_calls(mesh)
    yield from exact_calls(mesh)
    graph = sb.SaddleVertexGraph(mesh, device="cpu")
    yield from query_calls(mesh, graph)
    yield from path_calls(mesh, graph)
    yield from map_calls(mesh, graph, folder)
    yield from pattern_calls(mesh, graph)


def mark(broken: bool) -> str:
    return "!" if broken else " "


def row(case: Case, runs: int, cancels: int) -> tuple[str, bool]:
    """A line of the table, and whether all promises hold."""
    watched, alone = [], []
    for _ in range(runs):
        alone.append(unwatched(case))
        watched.append(watch(case))
    seconds = min(seen.seconds for seen in watched)
    moments = np.random.default_rng(0).uniform(size=cancels) * seconds
    wait = max([wait_after_cancel(case, float(moment)) for moment in moments], default=0.0)
    silence = min(seen.silence for seen in watched)
    rises = all(seen.is_rising() for seen in watched)
    line = (
        f"  {case.name:<40} {seconds:>8.3f} {seconds / max(min(alone), 1e-9):>8.2f} "
        f"{silence:>8.3f}{mark(silence > MOST_SILENCE)} {wait:>8.3f}{mark(wait > MOST_WAIT)} "
        f"{'' if rises else f'! falls or ends at {watched[0].last:.3f}'}"
    )
    return line.rstrip(), rises and silence <= MOST_SILENCE and wait <= MOST_WAIT


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.bench progress")
    parser.add_argument("--only", default="", help="calls whose names begin so, several divided by /")
    parser.add_argument("--runs", type=int, default=1, help="of each call; the least of all is shown")
    parser.add_argument("--cancels", type=int, default=3, help="random moments")
    parser.add_argument("meshes", nargs="*", type=Path)
    options = parser.parse_args(arguments)
    named = {path.stem: sb.read_mesh(path) for path in options.meshes} or {
        "sphere": sb.Mesh(*meshes.icosphere(6)),
        "needles": sb.Mesh(*meshes.needles(8, 200)),
        "torus": sb.Mesh(*meshes.torus(72, 28)),
    }
    wanted, all_hold = tuple(options.only.split("/")), True
    with tempfile.TemporaryDirectory() as folder:
        for name, mesh in named.items():
            print(f"{name}, {mesh.vertex_count:,} vertices")
            print(f"  {'call':<40} {'seconds':>8} {'watched':>8} {'silence':>8}  {'cancel':>8}")
            for case in calls(mesh, Path(folder)):
                if not case.name.startswith(wanted):
                    continue
                line, holds = row(case, options.runs, options.cancels)
                all_hold &= holds
                print(line, flush=True)
    return 0 if all_hold else 1

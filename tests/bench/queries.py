# SPDX-License-Identifier: MIT
"""What questions to a built graph cost and how right the answers are: `python -m tests.bench queries [MESH...]`.

Fields, nearest sources with their labels, A*, distances between any points; a column a mesh. Without meshes it makes a
sphere and a graded landscape. Times are process CPU time on one thread; set OPENBLAS_NUM_THREADS=1, or idle threads of
numpy are counted. Exact distances come from pygeodesic (labels) and from ExactField, which the tests hold to it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeVar

import numpy as np
import pygeodesic.geodesic as mmp

import saddleback as sb
from tests import meshes

T = TypeVar("T")
ACCURACY = 5e-3  # labels may be wrong where the two nearest sources are nearer to each other's distance than that


def median_seconds(work: Callable[[], object], times: int = 5) -> float:
    """CPU seconds, after once for nothing."""
    work()
    seconds = []
    for _ in range(times):
        start = time.process_time()
        work()
        seconds.append(time.process_time() - start)
    return float(np.median(seconds))


def landscape(count: int = 20_000) -> meshes.Arrays:
    """Hills over a disk whose edges are a hundred times shorter in the middle than at the border."""
    from scipy.spatial import Delaunay

    rng = np.random.default_rng(0)
    angle = rng.uniform(0, 2 * np.pi, count)
    middle = 0.01 * np.sqrt(rng.random(count))  # a disk as dense as what begins at its border
    radius = np.where(rng.random(count) < 0.1, middle, 10 ** rng.uniform(-2, 0, count))
    xy = radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    height = 0.1 * np.sin(9 * xy[:, 0]) * np.cos(7 * xy[:, 1])
    return np.column_stack([xy, height]), Delaunay(xy).simplices.astype(np.int32)


def fields(mesh: sb.Mesh, graph: sb.SaddleVertexGraph) -> Iterator[tuple[str, str]]:
    """One source: time and error."""
    count = mesh.vertex_count
    sources = np.random.default_rng(1).integers(count, size=3)
    for method in ("label_correcting", "dijkstra"):
        each = [median_seconds(lambda s=s, m=method: graph.distances([s], method=m)) for s in sources]
        yield f"field, {method}: us/v", f"{1e6 * np.median(each) / count:.3f}"
    errors = []
    for source in sources:
        exact = sb.exact_distances(mesh, [source])
        away = np.isfinite(exact) & (exact > 0)
        errors.append(graph.distances([source])[away] / exact[away] - 1)
    error = 100 * np.concatenate(errors)
    yield "  error: mean, max %", f"{error.mean():.4f}, {error.max():.3f}"


def labels(mesh: sb.Mesh, graph: sb.SaddleVertexGraph) -> Iterator[tuple[str, str]]:
    """Many sources: time, and how many labels are wrong beyond the accuracy."""
    algorithm = mmp.PyGeodesicAlgorithmExact(mesh.vertices, mesh.triangles)
    for count in (50, 500, 1500, 5000):
        sources = np.random.default_rng(count).choice(mesh.vertex_count, min(count, mesh.vertex_count), replace=False)
        seconds = median_seconds(lambda s=sources: graph.nearest(s))
        start = time.process_time()
        exact, label = algorithm.geodesicDistances(sources)
        ratio = (time.process_time() - start) / seconds
        yield f"nearest of {count}: ms (x pygeodesic)", f"{1e3 * seconds:.2f} ({ratio:.0f})"
        other, wrong = mislabeled(mesh, sources, graph.nearest(sources)[1], np.array(exact), np.array(label))
        yield "  labels not pygeodesic's, wrong", f"{other}, {wrong}"


def mislabeled(
    mesh: sb.Mesh, sources: np.ndarray, found: np.ndarray, exact: np.ndarray, label: np.ndarray
) -> tuple[int, int]:
    """Vertices with another label than the exact one, and those of them whose source is farther by over ACCURACY."""
    wrong = 0
    reachable = exact < 1e9
    differs = reachable & (found != label)
    for source in np.unique(found[differs]):
        own = np.flatnonzero(differs & (found == source))
        limit = 1.1 * float(exact[own].max())
        away = sb.exact_distances(mesh, [sources[source]], limit)[own]
        wrong += int((away > exact[own] * (1 + ACCURACY)).sum())
    return int(differs.sum()), wrong


def pairs(mesh: sb.Mesh, graph: sb.SaddleVertexGraph) -> Iterator[tuple[str, str]]:
    """A*: nodes expanded, time, and whether the bits are the field's."""
    chosen = np.random.default_rng(2).integers(mesh.vertex_count, size=(1000, 2))
    start = time.process_time()
    graph.distance(*chosen[0])
    yield "A*: first call (landmarks), ms", f"{1e3 * (time.process_time() - start):.0f}"
    start = time.process_time()
    found = np.array([graph._distance_and_settled(a, b) for a, b in chosen])
    yield "  each, ms", f"{time.process_time() - start:.3f}"
    share = 100 * found[:, 1] / mesh.vertex_count
    yield "  settled: mean, median, max %", f"{share.mean():.2f}, {np.median(share):.2f}, {share.max():.1f}"
    other = sum(found[i, 0] != graph.distances([chosen[i, 0]])[chosen[i, 1]] for i in range(100))
    yield "  other bits than a field's", f"{other} of 100"


def any_points(mesh: sb.Mesh, graph: sb.SaddleVertexGraph) -> Iterator[tuple[str, str]]:
    """Error between points inside faces, spread over faces and not over area: small faces count as much as large."""
    rng = np.random.default_rng(3)

    def random_points(count: int) -> sb.SurfacePoints:
        return sb.SurfacePoints(rng.integers(mesh.face_count, size=count), rng.dirichlet([1.0, 1.0, 1.0], count))

    sources, targets = random_points(10), random_points(100)
    errors = []
    for i in range(len(sources)):
        exact = sb.ExactField(mesh, sources[i : i + 1]).distance_to(targets)
        found = graph.distances_to(sources[i : i + 1], targets)
        errors.append(found[np.isfinite(exact)] / exact[np.isfinite(exact)] - 1)
    error = 100 * np.concatenate(errors)
    seconds = median_seconds(lambda: graph.distances_to(sources[:1], targets), 3)
    yield f"any to any, {len(error)} pairs: mean, max error %", f"{error.mean():.4f}, {error.max():.3f}"
    yield "  one to 100, ms", f"{1e3 * seconds:.2f}"


def triangles(mesh: sb.Mesh, graph: sb.SaddleVertexGraph) -> Iterator[tuple[str, str]]:
    """Symmetry and the triangle inequality."""
    rng = np.random.default_rng(4)
    chosen = rng.integers(mesh.vertex_count, size=200)
    table = graph.fields(chosen, threads=1)[:, chosen]
    a, b, c = rng.integers(len(chosen), size=(3, 1_000_000))
    excess = table[a, c] - (table[a, b] + table[b, c])
    yield "symmetric; triangles broken of 1e6", f"{np.array_equal(table, table.T)}; {int((excess > 0).sum())}"


def main(arguments: list[str]) -> int:
    if arguments:
        columns = {Path(argument).stem: sb.read_mesh(argument) for argument in arguments}
    else:
        columns = {"sphere": sb.Mesh(*meshes.icosphere(5)), "graded landscape": sb.Mesh(*landscape())}
    for name, mesh in columns.items():
        graph = sb.SaddleVertexGraph(mesh, threads=1)
        print(f"{name}: {mesh.vertex_count:,} vertices, {graph.mean_degree:.1f} arcs each")
        for part in (fields, labels, pairs, any_points, triangles):
            for what, value in part(mesh, graph):
                print(f"  {what:<44}{value}", flush=True)
    return 0

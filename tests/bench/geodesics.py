"""The graph and its cells on meshes of a folder: `python -m tests.bench geodesics MESH...`.

Build per vertex, one distance field, the nearest of 1,500 sources and their cells, beside pygeodesic's exact
algorithm in the same run, whose distances also give the errors.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numpy as np
import pygeodesic.geodesic as mmp

import saddleback as sb

T = TypeVar("T")


def timed(work: Callable[[], T]) -> tuple[T, float]:
    """The result and the shortest of three times, seconds."""
    best = np.inf
    for _ in range(3):
        start = time.perf_counter()
        result = work()
        best = min(best, time.perf_counter() - start)
    return result, float(best)


def row(path: Path, k: int) -> str:
    """One line of the table."""
    mesh = sb.read_mesh(path)
    count = len(mesh.vertices)
    graph = sb.SaddleVertexGraph(mesh, k=k, threads=1)
    found, query = timed(lambda: graph.distances([0]))
    start = time.perf_counter()
    exact, _ = mmp.PyGeodesicAlgorithmExact(mesh.vertices, mesh.triangles).geodesicDistances(np.array([0]))
    exact_seconds = time.perf_counter() - start
    known = np.isfinite(found) & (exact > 0)
    error = found[known] / exact[known] - 1
    sites = sb.sample(mesh, min(1500, count), seed=1)
    _, nearest = timed(lambda: graph.nearest(sites))
    _, cells = timed(lambda: sb.geodesic_voronoi(graph, sites, threads=1))
    return (
        f"{path.stem[:26]:26s} {count:8,d} {1e6 * graph.build_seconds / count:9.1f} {graph.mean_degree:7.1f} "
        f"{1e3 * query:8.2f} {1e6 * query / count:7.3f} {100 * error.mean():8.3f} {100 * error.max():7.2f} "
        f"{1e3 * nearest:8.1f} {1e3 * cells:8.1f} {exact_seconds / query:8.0f}"
    )


def main(arguments: list[str]) -> int:
    k = 50
    print(f"k = {k}, one thread; errors and the last column (speed of one field) against pygeodesic's exact MMP")
    print(
        f"{'mesh':26s} {'V':>8s} {'build us/v':>9s} {'arcs/v':>6s} {'field ms':>8s} {'us/v':>7s} {'mean %':>8s} "
        f"{'max %':>7s} {'1500 ms':>8s} {'cells ms':>8s} {'x exact':>8s}"
    )
    for argument in arguments:
        print(row(Path(argument), k), flush=True)
    return 0

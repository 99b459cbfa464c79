# SPDX-License-Identifier: MIT
"""Nearest points, sampling and tracing, CPU seconds on one thread, beside peers when they are installed."""

from __future__ import annotations

import importlib.util
import time
from collections.abc import Callable
from functools import partial

import numpy as np

import saddleback as sb
from tests import meshes

Arrays = meshes.Arrays


def cpu_seconds(work: Callable[[], object]) -> float:
    start = time.process_time()
    work()
    return time.process_time() - start


def row(name: str, value: str) -> None:
    print(f"{name:<58} {value}")


def wavy_sheet(size: int) -> Arrays:
    vertices, triangles = meshes.grid(size, size, 0.3)
    vertices[:, 2] = 0.1 * np.sin(9 * vertices[:, 0]) * np.cos(7 * vertices[:, 1])
    return vertices, triangles


def bench_project(mesh: sb.Mesh, count: int) -> None:
    rng = np.random.default_rng(0)
    on = sb.sample(mesh, count, seed=3).positions(mesh)[rng.permutation(count)]
    row("project 1 query (the hierarchy)", f"{cpu_seconds(lambda: sb.project(mesh, on[:1])):.2f} s")
    off = on + rng.normal(0, mesh.mean_edge_length, on.shape)
    for name, queries in (("on the surface", on), ("one edge off it", off)):
        seconds = cpu_seconds(partial(sb.project, mesh, queries, threads=1))
        row(f"project {count} queries {name}", f"{seconds:.2f} s")
    if importlib.util.find_spec("scipy") is None:
        row("scipy cKDTree", "not installed")
    else:
        from scipy.spatial import cKDTree  # type: ignore[import-untyped]

        seconds = cpu_seconds(lambda: cKDTree(mesh.vertices).query(on))
        row("  scipy cKDTree (nearest vertex only), build and query", f"{seconds:.2f} s")
    bench_meshlib(mesh, on)


def bench_meshlib(mesh: sb.Mesh, queries: np.ndarray) -> None:
    if importlib.util.find_spec("meshlib") is None:
        row("  meshlib", "not installed")
        return
    from meshlib import mrmeshnumpy, mrmeshpy  # type: ignore[import-not-found]

    other = mrmeshnumpy.meshFromFacesVerts(mesh.triangles, mesh.vertices)
    some = [mrmeshpy.Vector3f(*map(float, query)) for query in queries[:10_000]]
    mrmeshpy.findProjection(some[0], other)
    seconds = cpu_seconds(lambda: [mrmeshpy.findProjection(query, other) for query in some])
    row("  meshlib, a query (called from Python)", f"{seconds / len(some) * 1e6:.1f} us")


def bench_sample(mesh: sb.Mesh, count: int) -> None:
    density = 1 + 7 * mesh.vertices[:, 0]
    row(f"sample {count} points", f"{cpu_seconds(lambda: sb.sample(mesh, count)):.2f} s")
    row(f"sample {count} points with density", f"{cpu_seconds(lambda: sb.sample(mesh, count, density)):.2f} s")


def bench_trace() -> None:
    mesh = sb.Mesh(*meshes.icosphere(6))
    crossed = 0

    def curves() -> None:
        nonlocal crossed
        for vertex in range(0, 4000, 20):
            crossed += len(sb.trace(mesh, vertex, 0.3, 20.0).points)

    seconds = cpu_seconds(curves)
    row("trace, a face crossed (with polyline)", f"{seconds / crossed * 1e9:.0f} ns")
    if importlib.util.find_spec("potpourri3d") is None:
        row("  potpourri3d", "not installed")
        return
    import potpourri3d  # type: ignore[import-not-found]

    tracer = potpourri3d.GeodesicTracer(np.array(mesh.vertices), np.array(mesh.triangles))
    points = 0

    def their_curves() -> None:
        nonlocal points
        for vertex in range(0, 4000, 20):
            points += len(tracer.trace_geodesic_from_vertex(vertex, np.array([0.3, 0.4, 1.0]), 20 / np.sqrt(1.25)))

    seconds = cpu_seconds(their_curves)
    row("  potpourri3d, a face crossed", f"{seconds / max(1, points) * 1e9:.0f} ns")


def main(arguments: list[str]) -> None:
    size = int(arguments[0]) if arguments else 1001
    mesh = sb.Mesh(*wavy_sheet(size))
    row("mesh", f"{len(mesh.triangles)} triangles")
    bench_project(mesh, size * size)
    bench_sample(mesh, size * size)
    bench_trace()

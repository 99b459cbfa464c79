# SPDX-License-Identifier: MIT
"""How much faster calls are on many cores: `python -m tests.bench scaling [--threads N] [--size F] [--plot FILE]`.

A line a call: seconds on the wall on one thread, and how many times as fast it is on 2, 4 ... N; the best of three. All
of it on a bumpy torus of F faces made here, and on random sites of the plane. FILE gets a picture, by matplotlib.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

import saddleback as sb
from tests import meshes

Call = Callable[[int], object]
RUNS = 3


def bumpy_torus(faces: int) -> sb.Mesh:
    around = int(np.sqrt(faces))
    vertices, triangles = meshes.torus(around, around // 2)
    bumps = 1 + 0.05 * np.sin(9 * vertices[:, :1]) * np.sin(11 * vertices[:, 1:2]) * np.sin(13 * vertices[:, 2:])
    return sb.Mesh(vertices * bumps, triangles)


def calls(faces: int) -> Iterator[tuple[str, Call]]:
    """Each call by its name, given the number of threads."""
    mesh, rng = bumpy_torus(faces), np.random.default_rng(0)
    count = mesh.vertex_count
    yield "graph", lambda threads: sb.SaddleVertexGraph(mesh, accuracy=5e-3, threads=threads, device="cpu")
    graph = sb.SaddleVertexGraph(mesh, accuracy=5e-3, device="cpu")
    sources = rng.choice(count, 64, replace=False).astype(np.int32)
    yield "64 fields", lambda threads: graph.fields(sources, threads=threads)
    plane = rng.random((5 * count, 2))
    yield f"plane, {len(plane):,} sites", lambda threads: sb.voronoi_2d(plane, threads=threads)
    few, weights = plane[:count], rng.random(count) / np.sqrt(count)
    yield f"weighted plane, {count:,} sites", lambda threads: sb.voronoi_2d(few, weights, threads=threads)
    sites = rng.choice(count, 2000, replace=False).astype(np.int32)
    yield "2,000 cells", lambda threads: sb.geodesic_voronoi(graph, sites, threads=threads, device="cpu")
    yield (
        "relaxed cells, 20 rounds",
        lambda threads: sb.centroidal_voronoi(
            graph, count=2000, max_iterations=20, tolerance=0, threads=threads, device="cpu"
        ),
    )
    field = sb.direction_field(mesh, 1, {})
    yield "a direction field", lambda threads: on_cores(threads, lambda: sb.direction_field(mesh, 4, align="curvature"))
    star, size = sb.Shape.star(), 0.02
    yield (
        "stars until nothing fits",
        lambda threads: sb.distribute(mesh, star, field=field, size=size, maximal=True, threads=threads),
    )


def on_cores(count: int, call: Callable[[], object]) -> None:
    """Calls what takes as many threads as it is allowed cores; on Linux only, elsewhere it has them all."""
    if not hasattr(os, "sched_setaffinity"):
        call()
        return
    cores = os.sched_getaffinity(0)
    try:
        os.sched_setaffinity(0, sorted(cores)[:count])
        call()
    finally:
        os.sched_setaffinity(0, cores)


def best(call: Call, threads: int) -> float:
    seconds = []
    for _ in range(RUNS):
        begin = time.perf_counter()
        call(threads)
        seconds.append(time.perf_counter() - begin)
    return min(seconds)


def draw(rows: dict[str, list[float]], threads: list[int], file: Path) -> None:
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(7, 5), layout="constrained")
    axes.plot(threads, threads, color="0.8")
    for name, seconds in rows.items():
        axes.plot(threads, [seconds[0] / s for s in seconds], "o-", label=name, markersize=3)
    axes.set(xlabel="threads", ylabel="times as fast as on one")
    axes.legend(fontsize=8)
    figure.savefig(file)


def main(arguments: list[str]) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--size", type=int, default=400_000)
    parser.add_argument("--plot", type=Path)
    options = parser.parse_args(arguments)
    threads = [2**k for k in range(options.threads.bit_length()) if 2**k < options.threads] + [options.threads]
    rows = {}
    print(f"| call | seconds on 1 | {' | '.join(f'x on {n}' for n in threads[1:])} |")
    print("|---" * (len(threads) + 1) + "|")
    for name, call in calls(options.size):
        seconds = rows[name] = [best(call, n) for n in threads]
        gains = " | ".join(f"{seconds[0] / s:.1f}" for s in seconds[1:])
        print(f"| {name} | {seconds[0]:.2f} | {gains} |", flush=True)
    if options.plot:
        draw(rows, threads, options.plot)

# SPDX-License-Identifier: MIT
"""Voronoi diagrams of the plane: `python -m tests.bench voronoi_2d [LARGEST [THREADS]]`; 1e6 sites and one thread.

Processor nanoseconds per site, medians over fresh sites in every repetition (the same ones again would train the
branch predictor), beside CGAL's, Boost.Polygon's and SciPy's in the same run; numbers of vertices and edges against
CGAL's (`plane_counts` does that for all sizes, kinds and centers); then nanoseconds by the kind of sites, and the
growth of memory; then the same for weighted sites beside CGAL's Apollonius graph, hidden sites and all. CGAL
and Boost need a compiler and their headers (Debian: g++, libcgal-dev); without them their columns stay empty.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.spatial import Delaunay

import saddleback as sb

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "native"))
import plane_sites

KINDS = ("uniform", "clusters", "circle", "grid", "nearly_collinear", "duplicates")


def build_peers(folder: Path, name: str = "voronoi_2d_peers") -> Path | None:
    """Compile the peers; None when that is not possible here."""
    compiler = shutil.which("g++")
    program = folder / name
    source = Path(__file__).with_name(f"{name}.cpp")
    if compiler is None or not Path("/usr/include/CGAL/Delaunay_triangulation_2.h").exists():
        return None
    options = ["-O3", "-march=native", "-frounding-math", "-DNDEBUG", "-std=c++17"]  # CGAL's intervals want the third
    command = [compiler, *options, source, "-o", program, "-lgmp", "-lmpfr"]
    done = subprocess.run(command, capture_output=True, check=False)
    return program if done.returncode == 0 else None


def run_peers(program: Path, sites: plane_sites.Points, *wanted: str) -> dict[str, list[float]]:
    """Seconds by peer; CGAL's are followed by its numbers of vertices and edges."""
    with tempfile.NamedTemporaryFile() as file:
        file.write(np.ascontiguousarray(sites).tobytes())
        file.flush()
        done = subprocess.run([program, file.name, *wanted], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"{program.name}: exit status {done.returncode}, {done.stderr.strip()}")
    return {name: [float(value) for value in values] for name, *values in map(str.split, done.stdout.splitlines())}


def measured(work: Callable[[], object]) -> float:
    """Processor seconds."""
    start = time.process_time()
    work()
    return time.process_time() - start


def repetitions(n: int) -> int:
    return max(3, min(31, 10**6 // n))


def compare(kind: str, n: int, threads: int, peers: Path | None, *, with_scipy: bool) -> dict[str, float]:
    """Median nanoseconds per site by library; "wall" is ours by the clock. Stops when the counts differ."""
    times: dict[str, list[float]] = {}
    for seed in range(repetitions(n)):
        sites = plane_sites.KINDS[kind](n, np.random.default_rng(1000 * n + seed))
        start, cpu_start = time.perf_counter(), time.process_time()
        diagram = sb.voronoi_2d(sites, threads=threads)
        times.setdefault("cpu", []).append(time.process_time() - cpu_start)
        times.setdefault("wall", []).append(time.perf_counter() - start)
        if peers is not None:
            found = run_peers(peers, sites)
            counts = [len(diagram.vertices), len(diagram.edges)]
            if counts != found["cgal"][1:]:
                raise SystemExit(f"{kind}, {n}, seed {seed}: {counts} vertices and edges, CGAL has {found['cgal'][1:]}")
            for name, values in found.items():
                times.setdefault(name, []).append(values[0])
        if with_scipy:
            times.setdefault("scipy", []).append(measured(lambda sites=sites: Delaunay(sites)))
    return {name: 1e9 * float(np.median(values)) / n for name, values in times.items()}


def compare_weighted(n: int, share: float, threads: int, peers: Path | None) -> dict[str, float]:
    """Median nanoseconds per site, radii up to a share of the mean distance. Stops when CGAL's counts differ."""
    times: dict[str, list[float]] = {}
    for seed in range(min(5, repetitions(n))):
        rng = np.random.default_rng(1000 * n + seed)
        sites, weights = rng.random((n, 2)), rng.random(n) * share / n**0.5
        cpu_start, start = time.process_time(), time.perf_counter()
        diagram = sb.voronoi_2d(sites, weights, threads=threads)
        times.setdefault("cpu", []).append(time.process_time() - cpu_start)
        times.setdefault("wall", []).append(time.perf_counter() - start)
        times.setdefault("points", []).append(measured(lambda sites=sites: sb.voronoi_2d(sites, threads=threads)))
        if peers is not None:
            found = run_peers(peers, np.column_stack([sites, weights]))["cgal"]
            hidden = len(diagram.hidden)
            counts = [n - hidden, hidden, len(diagram.vertices), len(diagram.edges)]
            if counts != found[1:]:
                raise SystemExit(f"weighted, {n}, {share}, seed {seed}: {counts}, CGAL has {found[1:]}")
            times.setdefault("cgal", []).append(found[0])
    return {name: 1e9 * float(np.median(values)) / n for name, values in times.items()}


def wrong_places(n: int, queries: int) -> int:
    """How many points `locate` gives to a site that another is nearer than, by brute force."""
    rng = np.random.default_rng(n)
    sites, weights = rng.random((n, 2)), rng.random(n) / n**0.5
    points = 1.4 * rng.random((queries, 2)) - 0.2
    found = sb.voronoi_2d(sites, weights).locate(points)
    wrong = 0
    for begin in range(0, queries, 1000):
        rows = slice(begin, begin + 1000)
        distances = np.hypot(*(points[rows, None] - sites).transpose(2, 0, 1)) - weights
        given = distances[np.arange(len(distances)), found[rows]]
        wrong += np.count_nonzero(given > distances.min(axis=1) + 1e-14)
    return wrong


def peak_memory(n: int) -> float:
    """MB that a diagram takes above its sites, at most, in a process of its own."""
    code = (
        "import re, numpy as np, saddleback as sb\n"
        "def peak(): return int(re.search(r'VmHWM:\\s+(\\d+)', open('/proc/self/status').read()).group(1)) / 1024\n"
        f"sites = np.random.default_rng(0).random(({n}, 2))\n"
        "sb.voronoi_2d(sites[:1000])\n"
        "before = peak()\n"
        "sb.voronoi_2d(sites, threads=1)\n"
        "print(peak() - before)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=os.environ)
    return float(done.stdout)


def print_row(label: str, times: dict[str, float]) -> None:
    names = ("cpu", "wall", "cgal", "points") if "points" in times else ("cpu", "wall", "cgal", "boost", "scipy")
    cells = (f"{times[name]:9.0f}" if name in times else " " * 9 for name in names)
    print(f"{label:24s}{''.join(cells)}", flush=True)


def main(arguments: list[str]) -> int:
    largest = int(float(arguments[0])) if arguments else 10**6
    threads = int(arguments[1]) if len(arguments) > 1 else 1
    with tempfile.TemporaryDirectory() as folder:
        peers = build_peers(Path(folder))
        print(f"ns per site, {threads} thread(s); CGAL's counts are {'equal' if peers else 'not checked'}")
        print(f"{'uniform':24s}{'cpu':>9s}{'wall':>9s}{'cgal':>9s}{'boost':>9s}{'scipy':>9s}")
        n = 1000
        while n <= largest:
            print_row(f"{n:,d}", compare("uniform", n, threads, peers, with_scipy=n <= 10**5))
            n *= 10
        for kind in KINDS:
            print_row(f"{kind}, {largest:,d}", compare(kind, largest, threads, peers, with_scipy=False))
        peers = build_peers(Path(folder), "voronoi_2d_weighted_peers")
        print(f"{'weighted':24s}{'cpu':>9s}{'wall':>9s}{'cgal':>9s}{'points':>9s}")
        for n in (1000, 10**4, 10**5):
            for share in (0.2, 1.0):
                if n <= largest:
                    print_row(f"{n:,d}, radii {share}", compare_weighted(n, share, threads, peers))
    print(f"weighted: {wrong_places(2000, 10**6)} of a million points at a wrong site")
    print(f"peak memory above the sites, {largest:,d}: {peak_memory(largest):.0f} MB")
    return 0

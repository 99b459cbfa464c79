# SPDX-License-Identifier: MIT
"""Exact distances: `python -m tests.bench exact FOLDER [FACTOR]`.

Errors against closed forms and against pygeodesic (from vertices and from inside faces), and CPU time of one thread
beside pygeodesic's in the same run. FACTOR: how many times slower than the reference this machine is; bars in seconds
are multiplied by it.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numpy as np
import pygeodesic.geodesic as mmp
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes
from tests.native.exact import exact_distances, random_points, with_vertex_at

Floats = NDArray[np.float64]
T = TypeVar("T")
COMPARED = (
    "bunny-35k-holes",
    "kitten-53k",
    "elephant-25k",
    "face-17k-open",
    "octopus-17k-4parts",
    "double-torus-14k",
    "turbine-9k-genus11",
    "camelhead-11k-open",
)
CLOSED = "bunny-35k-closed"
BARS = {"bunny-35k-holes": (0.20, 0.14), "armadillo-loop1-173k": (4.0, 2.5)}


def timed(work: Callable[[], T], repeats: int = 5) -> tuple[T, float]:
    """The result and the shortest CPU time of this thread, seconds."""
    best = np.inf
    for _ in range(repeats):
        start = time.thread_time()
        result = work()
        best = min(best, time.thread_time() - start)
    return result, float(best)


def row(measure: str, value: str, bar: str = "") -> None:
    print(f"{measure:<64} {value:>12}  {bar}", flush=True)


def error(found: Floats, expected: Floats) -> float:
    """Largest relative error; infinite where only one of the two is."""
    if not np.array_equal(np.isfinite(found), np.isfinite(expected)):
        return np.inf
    known = np.isfinite(expected) & (expected > 0)
    return float(np.abs(found[known] / expected[known] - 1).max())


def closed_forms() -> None:
    bar = "1e-12"
    mesh, rng = sb.Mesh(*meshes.grid(300, 300)), np.random.default_rng(0)
    for name, sources in (
        ("corner", [0]),
        ("center", [150 * 300 + 150]),
        ("random vertices", rng.integers(len(mesh.vertices), size=3).tolist()),
    ):
        errors = [
            error(sb.exact_distances(mesh, [s]), np.linalg.norm(mesh.vertices - mesh.vertices[s], axis=1))
            for s in sources
        ]
        row(f"flat grid 300 x 300, {name}", f"{max(errors):.1e}", bar)
    points = random_points(mesh, 3, seed=1)
    errors = [
        error(sb.exact_distances(mesh, p), np.linalg.norm(mesh.vertices - p.positions(mesh), axis=1)) for p in points
    ]
    row("flat grid 300 x 300, random points of faces", f"{max(errors):.1e}", bar)
    row("cylinder of 12,000 vertices", f"{error(*cylinder()):.1e}", bar)
    row("cube of 6,146 vertices", f"{error(*cube()):.1e}", bar)
    row("cone of 9,601 vertices", f"{error(*cone()):.1e}", bar)


def cylinder() -> tuple[Floats, Floats]:
    """Unrolled, a prism is a strip: the shorter way round counts."""
    around, along, source = 120, 100, 37 * 120 + 11
    mesh = sb.Mesh(*meshes.cylinder(around, along, 1.0, 4.0))
    step = np.abs(np.arange(len(mesh.vertices)) % around - source % around)
    gap = np.minimum(step, around - step) * 2 * np.sin(np.pi / around)
    expected = np.hypot(gap, mesh.vertices[:, 2] - mesh.vertices[source, 2])
    return sb.exact_distances(mesh, [source]), expected


def cube() -> tuple[Floats, Floats]:
    """From a corner: on the far sides over either of two edges."""
    vertices, triangles = meshes.cube()
    for _ in range(5):
        vertices, triangles = meshes.subdivide(vertices, triangles)
    source = int(np.flatnonzero((vertices == 0).all(axis=1))[0])
    x, y, z = np.sort(vertices, axis=1).T
    far = np.minimum(np.hypot(1 + x, y), np.hypot(x, 1 + y))
    return sb.exact_distances(sb.Mesh(vertices, triangles), [source]), np.where(x == 0, np.hypot(y, z), far)


def cone() -> tuple[Floats, Floats]:
    """Unrolled, a pyramid is a sector."""
    around, along, source = 120, 80, 1 + 40 * 120
    mesh = sb.Mesh(*meshes.cone(around, along))
    slant = np.linalg.norm(mesh.vertices - mesh.vertices[0], axis=1)
    step = np.abs((np.arange(len(mesh.vertices)) - 1) % around - (source - 1) % around)
    turn = np.minimum(step, around - step) * mesh.total_angles[0] / around
    # As squares of sines: the law of cosines would lose digits next to the source.
    squares = (slant - slant[source]) ** 2 + 4 * slant * slant[source] * np.sin(turn / 2) ** 2
    return sb.exact_distances(mesh, [source]), np.sqrt(squares)


def against_pygeodesic(folder: Path) -> None:
    rng = np.random.default_rng(4)
    for name in COMPARED:
        mesh = sb.read_mesh(folder / f"{name}.ply")
        sources = rng.integers(len(mesh.vertices), size=2).tolist()
        errors = [error(sb.exact_distances(mesh, [s]), exact_distances(mesh, s)) for s in sources]
        row(f"{name}, from 2 vertices, against pygeodesic", f"{max(errors):.1e}", "1e-9")
        points = random_points(mesh, 2, seed=5)
        errors = [
            error(
                sb.exact_distances(mesh, point),
                exact_distances(with_vertex_at(mesh, point), len(mesh.vertices))[:-1],
            )
            for point in points
        ]
        row(f"{name}, from inside 2 faces, against pygeodesic", f"{max(errors):.1e}", "1e-9")


def speed(folder: Path, factor: float) -> None:
    for name, (bar, goal) in BARS.items():
        mesh = sb.read_mesh(folder / f"{name}.ply")
        _, spent = timed(lambda mesh=mesh: sb.exact_distances(mesh, [0]))  # type: ignore[misc]
        row(f"{name}, one source, s", f"{spent:.3f}", f"{bar * factor:.2f} ({goal * factor:.2f})")
    mesh = sb.read_mesh(folder / f"{CLOSED}.ply")
    algorithm = mmp.PyGeodesicAlgorithmExact(mesh.vertices, mesh.triangles)
    _, theirs = timed(lambda: algorithm.geodesicDistances(np.array([0])), 3)
    _, ours = timed(lambda: sb.exact_distances(mesh, [0]))
    row(f"{CLOSED}, s (pygeodesic {theirs:.2f} s): times faster", f"{theirs / ours:.1f}", "6 (9)")


def main(arguments: list[str]) -> int:
    folder = Path(arguments[0])
    row("measure", "found", "bar (goal)")
    closed_forms()
    against_pygeodesic(folder)
    speed(folder, float(arguments[1]) if len(arguments) > 1 else 1.0)
    return 0

# SPDX-License-Identifier: MIT
"""Progress of long calls: it rises, never stands still for long, ends at 1, and costs nothing."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

import numpy as np
import pytest

import saddleback as sb
from tests import meshes

Call = Callable[[sb.Job], object]


def graded_disk(rings: int, spokes: int) -> tuple[np.ndarray, np.ndarray]:
    """A disk of rings that each are larger than the one inside by the same factor: what its middle sees takes long."""
    radius = np.geomspace(1e-3, 1, rings)
    angle = np.linspace(0, 2 * np.pi, spokes, endpoint=False)
    ring = np.stack([np.outer(radius, np.cos(angle)), np.outer(radius, np.sin(angle)), np.zeros((rings, spokes))], -1)
    j = np.arange(spokes)
    next_j = (j + 1) % spokes
    middle = np.stack([np.zeros_like(j), 1 + j, 1 + next_j], 1)
    inside = (1 + spokes * np.arange(rings - 1))[:, None]
    a, b = inside + j, inside + next_j
    sides = np.stack([np.stack([a, a + spokes, b + spokes], -1), np.stack([a, b + spokes, b], -1)])
    triangles = np.concatenate([middle, sides.reshape(-1, 3)])
    return np.concatenate([np.zeros((1, 3)), ring.reshape(-1, 3)]), triangles.astype(np.int32)


def calls() -> dict[str, Call]:
    mesh = sb.Mesh(*meshes.icosphere(6))
    graph = sb.SaddleVertexGraph(mesh)
    many, some = sb.sample(mesh, 2000), sb.sample(mesh, 300, seed=1)
    vertices = np.arange(0, mesh.vertex_count, 4, dtype=np.int32)
    small = sb.Mesh(*meshes.torus(40, 16))
    torus = sb.Mesh(*meshes.torus(500, 100))
    squeezed = sb.Mesh(mesh.vertices * [1, 1, 0.3], mesh.triangles)
    open_tube = sb.Mesh(*meshes.cylinder(200, 200, 1.0, 3.0))
    finer_inside = sb.Mesh(*graded_disk(80, 100))
    finest_inside = sb.Mesh(*graded_disk(120, 150))
    between, spread = [finest_inside.vertex_count // 2], sb.sample(finest_inside, 20)
    line = graph.path(0, 1000)
    curve = sb.SurfaceCurve(mesh, sb.trace(mesh, 0, 0.3, 10.0).surface)
    balls = sb.Mesh(*meshes.merge(*(meshes.icosphere(5) for _ in range(4))))
    places, square = np.random.default_rng(1).random((400_000, 2)), [(0, 0), (1, 0), (1, 1), (0, 1)]
    none = np.zeros(100_000)
    return {
        "exact_distances": lambda job: sb.exact_distances(mesh, [0], job=job),
        "exact_distances_squeezed": lambda job: sb.exact_distances(squeezed, [0], job=job),
        "exact_distances_open": lambda job: sb.exact_distances(open_tube, [0], job=job),
        "exact_distances_graded": lambda job: sb.exact_distances(finest_inside, between, job=job),
        "exact_distances_torus": lambda job: sb.exact_distances(torus, [0], job=job),
        "exact_distances_limit": lambda job: sb.exact_distances(mesh, [0], 1.5, job=job),
        "exact_distances_parts": lambda job: sb.exact_distances(balls, [0], job=job),
        "exact_field": lambda job: sb.ExactField(mesh, [0], job=job),
        "exact_nearest_graded": lambda job: sb.exact_nearest(finest_inside, spread, job=job),
        "exact_nearest": lambda job: sb.exact_nearest(mesh, many, job=job),
        "exact_nearest_few": lambda job: sb.exact_nearest(mesh, some, job=job),
        "nearest": lambda job: graph.nearest(many, job=job),
        "build": lambda job: sb.SaddleVertexGraph(mesh, threads=1, job=job),
        "build_graded": lambda job: sb.SaddleVertexGraph(finer_inside, accuracy=0.02, threads=1, job=job),
        "build_count": lambda job: sb.SaddleVertexGraph(mesh, k=50, threads=1, job=job),
        "build_exact": lambda job: sb.SaddleVertexGraph(small, exact=True, threads=1, job=job),
        "distances_to": lambda job: graph.distances_to(some, many, job=job),
        "paths": lambda job: graph.paths(some, many, threads=1, job=job),
        "paths_few": lambda job: graph.paths(some, some, threads=1, job=job),
        "paths_to_vertices": lambda job: graph.paths([0], vertices, threads=1, job=job),
        "log_map": lambda job: graph.log_map(0, 1.0, job=job),
        "polar_coordinates": lambda job: sb.polar_coordinates(graph, line, 0.5, job=job),
        "distances_from_curve": lambda job: graph.distances(curve, job=job),
        "diagram_in_a_domain": lambda job: sb.voronoi_2d(places, domain=square, device="cpu", job=job),
        "powers_in_a_domain": lambda job: sb.power_diagram_2d(places[: len(none)], none, square, job=job),
    }


@pytest.fixture(scope="module")
def long_calls() -> dict[str, Call]:
    return calls()


def watch(call: Call) -> tuple[list[float], float]:
    """Return the shares that another thread saw, and the longest time in which neither share nor text changed."""
    job = sb.Job()
    worker = threading.Thread(target=call, args=(job,))
    shares, told, silence = [0.0], (0.0, ""), 0.0
    worker.start()
    since = time.perf_counter()
    while worker.is_alive():
        time.sleep(0.02)
        seen = job.fraction, job.text
        shares.append(seen[0])
        silence = max(silence, time.perf_counter() - since)
        if seen != told:
            told, since = seen, time.perf_counter()
    return [*shares, job.fraction], silence


@pytest.mark.parametrize(
    "name",
    [
        "exact_distances",
        "exact_distances_squeezed",
        "exact_distances_open",
        "exact_distances_graded",
        "exact_distances_torus",
        "exact_distances_limit",
        "exact_distances_parts",
        "exact_field",
        "exact_nearest_graded",
        "exact_nearest",
        "exact_nearest_few",
        "nearest",
        "build",
        "build_graded",
        "build_count",
        "build_exact",
        "distances_to",
        "paths",
        "paths_few",
        "paths_to_vertices",
        "log_map",
        "polar_coordinates",
        "distances_from_curve",
        "diagram_in_a_domain",
        "powers_in_a_domain",
    ],
)
def test_progress_rises_stands_nowhere_still_and_ends(long_calls: dict[str, Call], name: str) -> None:
    silences = []
    for _ in range(4):  # other work may hold the core
        shares, silence = watch(long_calls[name])
        assert shares == sorted(shares) and shares[-1] == 1
        silences.append(silence)
        if silence < 0.5:
            break
    assert min(silences) < 0.5


def test_dots_tell_that_work_goes_on_where_nothing_is_counted() -> None:
    """The text as it is while the fraction moves; behind it one to three dots while it does not."""
    job = sb.Job()
    mesh = sb.Mesh(*meshes.icosphere(6))
    worker = threading.Thread(target=lambda: sb.ExactField(mesh, [0], job=job))
    worker.start()
    texts = set()
    while worker.is_alive():
        texts.add(job.text)
    assert {text.rstrip(".") for text in texts} <= {"", "Measuring exact distances"}
    assert "Measuring exact distances." in texts
    ended = [job.text for _ in range(3)]
    assert ended[1] == ended[2]  # nobody works


@pytest.mark.parametrize("arrays", [meshes.needles(4, 60), graded_disk(30, 16), meshes.torus()])
def test_exact_distances_end_with_all_done(arrays):
    """What is left of a forecast that was too high is told at the end."""
    mesh = sb.Mesh(*arrays)
    for call in (sb.exact_distances, sb.exact_nearest, sb.ExactField):
        for sources in (np.array([0], np.int32), sb.sample(mesh, 7)):
            job = sb.Job()
            call(mesh, sources, job=job)
            assert job.fraction == 1


def test_watching_changes_no_distance() -> None:
    for case in meshes.good():
        for limit in (0.0, 0.2 * case.mesh.area**0.5, np.inf):
            seen = sb.exact_distances(case.mesh, [0], limit, job=sb.Job())
            assert np.array_equal(seen, sb.exact_distances(case.mesh, [0], limit))

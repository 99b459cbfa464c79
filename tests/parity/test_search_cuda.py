# SPDX-License-Identifier: MIT
"""Distance fields and nearest sources that a CUDA device finds are the processor's, to the bit."""

from __future__ import annotations

import threading
import time
from typing import Any

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.parity.test_graph_cuda import LARGER

RULES: tuple[dict[str, Any], ...] = ({"accuracy": 5e-3}, {"k": 12})
RULE_NAMES = [next(f"{name}={value}" for name, value in rule.items()) for rule in RULES]
CASES = [(case.name, sb.repair(case.vertices, case.triangles)[0]) for case in meshes.good() + meshes.broken()]


def expect_twins(graph: sb.SaddleVertexGraph, sources: Any, limit: float = np.inf) -> None:
    """Of all three queries."""
    for query in (graph.distances, graph.fields):
        assert query(sources, limit, device="cuda").tobytes() == query(sources, limit, device="cpu").tobytes()
    for twin, own in zip(
        graph.nearest(sources, limit, device="cuda"), graph.nearest(sources, limit, device="cpu"), strict=True
    ):
        assert twin.tobytes() == own.tobytes()


def some(count: int, vertex_count: int) -> np.ndarray:
    return np.random.default_rng(count).integers(0, vertex_count, count).astype(np.int32)


def graph_of(mesh: sb.Mesh, rule: dict[str, Any]) -> sb.SaddleVertexGraph:
    return sb.SaddleVertexGraph(
        mesh, device="cpu", **({"k": min(rule["k"], len(mesh.vertices))} if "k" in rule else rule)
    )


@pytest.mark.parametrize("rule", RULES, ids=RULE_NAMES)
@pytest.mark.parametrize("mesh", [mesh for _, mesh in CASES], ids=[name for name, _ in CASES])
def test_the_same_fields(mesh: sb.Mesh, rule: dict[str, Any]) -> None:
    graph = graph_of(mesh, rule)
    for count in (1, 2, 7):
        expect_twins(graph, some(count, len(mesh.vertices)))


@pytest.mark.parametrize("name", LARGER)
def test_the_same_fields_of_larger_meshes(name: str) -> None:
    mesh = sb.Mesh(*LARGER[name]())
    graph = graph_of(mesh, RULES[0])
    for count in (1, 3, 40, 300, len(mesh.vertices)):
        sources = some(count, len(mesh.vertices))
        expect_twins(graph, sources[:300])
        for twin, own in zip(graph.nearest(sources, device="cuda"), graph.nearest(sources, device="cpu"), strict=True):
            assert twin.tobytes() == own.tobytes()


def test_ties_go_to_the_smaller_source() -> None:
    # Nearly all is a tie on a regular grid with sources on a coarser one, told twice.
    mesh = sb.Mesh(*meshes.grid(64, 64))
    sources = np.arange(len(mesh.vertices), dtype=np.int32).reshape(64, 64)[::8, ::8].ravel()
    expect_twins(graph_of(mesh, RULES[0]), np.concatenate([sources[::-1], sources]))


@pytest.mark.parametrize("limit", [0.0, 0.1, 0.5, 100.0])
def test_a_limit(limit: float) -> None:
    expect_twins(graph_of(sb.Mesh(*meshes.icosphere(4)), RULES[0]), [5, 17, 400], limit)


def test_points_inside_of_faces_and_curves() -> None:
    mesh = sb.Mesh(*meshes.icosphere(4))
    graph = graph_of(mesh, RULES[0])
    expect_twins(graph, sb.sample(mesh, 30, seed=2))
    expect_twins(graph, [sb.SurfaceCurve(mesh, graph.path(*ends).surface) for ends in ((3, 900), (7, 60))])


def test_an_exact_graph() -> None:
    expect_twins(sb.SaddleVertexGraph(sb.Mesh(*meshes.icosphere(3)), exact=True), [1, 2, 3])


def test_more_fields_than_the_device_takes_at_once() -> None:
    graph = graph_of(sb.Mesh(*meshes.icosphere(3)), RULES[0])
    sources = some(3000, len(graph.mesh.vertices))
    assert graph.fields(sources, device="cuda").tobytes() == graph.fields(sources, device="cpu").tobytes()


def test_several_threads_may_ask() -> None:
    graph = graph_of(sb.Mesh(*meshes.icosphere(5)), RULES[0])
    own = [graph.distances([i], device="cpu") for i in range(8)]
    are_equal: list[bool] = []

    def ask(number: int) -> None:
        are_equal.extend(np.array_equal(graph.distances([number], device="cuda"), own[number]) for _ in range(5))

    threads = [threading.Thread(target=ask, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert are_equal == [True] * 40


def test_the_device_tells_its_times() -> None:
    graph = graph_of(sb.Mesh(*meshes.icosphere(4)), RULES[0])
    assert graph.query_times is None
    graph.distances([0], device="cpu")
    assert graph.query_times is None
    graph.distances([0], device="cuda")
    assert graph.query_times is not None and graph.query_times["find"] > 0


def test_what_the_processor_refuses_is_refused_in_the_same_words() -> None:
    graph = graph_of(sb.Mesh(*meshes.icosphere(2)), RULES[0])
    for arguments in ([[]], [[-1]], [[0], -1.0], [[0], np.nan], [[100_000]]):
        with pytest.raises(sb.InputError) as own:
            graph.nearest(*arguments, device="cpu")
        with pytest.raises(sb.InputError) as twin:
            graph.nearest(*arguments, device="cuda")
        assert str(own.value) == str(twin.value)
    with pytest.raises(sb.InputError, match="'dijkstra' runs on the processor only"):
        graph.distances([0], method="dijkstra", device="cuda")


def test_too_little_memory_is_told_before_anything_runs() -> None:
    graph = graph_of(sb.Mesh(*meshes.icosphere(5)), RULES[0])
    sb.limit_device_memory(1 << 20)
    try:
        with pytest.raises(sb.DeviceError, match=r"the graph needs about \d+ MB of the device's memory, and 1 MB"):
            graph.distances([0], device="cuda")
        assert graph.distances([0], device="auto").tobytes() == graph.distances([0], device="cpu").tobytes()
    finally:
        sb.limit_device_memory(0)


def test_cancel_is_heard_within_a_moment() -> None:
    graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.grid(500, 500, 0.2)), device="cuda")
    sources = some(4000, len(graph.mesh.vertices))
    graph.distances([0], device="cuda")  # the arcs are there
    for delay in (0.01, 0.05, 0.15):
        job = sb.Job()
        stopped: list[float] = []

        def run(job: sb.Job = job, stopped: list[float] = stopped) -> None:
            with pytest.raises(sb.Cancelled):
                graph.fields(sources, device="cuda", job=job)
            stopped.append(time.perf_counter())

        thread = threading.Thread(target=run)
        thread.start()
        time.sleep(delay)
        cancelled = time.perf_counter()
        job.cancel()
        thread.join()
        assert stopped and stopped[0] - cancelled < 0.5
    assert graph.distances([7], device="cuda").tobytes() == graph.distances([7], device="cpu").tobytes()

# SPDX-License-Identifier: MIT
"""Graphs that a CUDA device builds are the processor's, to the bit: files of both are compared."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.parity.cancelling import expect_to_stop_within_a_moment

RULES: tuple[dict[str, Any], ...] = ({"accuracy": 0.05}, {"accuracy": 5e-3}, {"accuracy": 1e-3}, {"k": 6}, {"k": 40})
DEVICES = ("cuda", "cuda:0,0,0", "cuda:all")  # one, one in three parts, and all, a part each
RULE_NAMES = [next(f"{name}={value}" for name, value in rule.items()) for rule in RULES]


def saved(graph: sb.SaddleVertexGraph, folder: Path) -> bytes:
    """What a file holds of a graph, but for how long it took to build and the sum of all bytes at the end."""
    path = folder / "graph"
    graph.save(path)
    data = path.read_bytes()
    return data[:72] + data[80:-4]


def expect_twins(mesh: sb.Mesh, folder: Path, **rule: Any) -> None:
    if "k" in rule:
        rule["k"] = min(rule["k"], len(mesh.vertices))
    own = saved(sb.SaddleVertexGraph(mesh, device="cpu", **rule), folder)
    for device in DEVICES:
        twin = sb.SaddleVertexGraph(mesh, device=device, **rule)
        assert twin.device == "cuda"
        assert saved(twin, folder) == own, device


@pytest.mark.parametrize("rule", RULES, ids=RULE_NAMES)
@pytest.mark.parametrize("case", meshes.good(), ids=lambda case: case.name)
def test_the_same_graph(case: meshes.Case, rule: dict[str, Any], tmp_path: Path) -> None:
    expect_twins(sb.Mesh(case.vertices, case.triangles), tmp_path, **rule)


@pytest.mark.parametrize("rule", RULES, ids=RULE_NAMES)
@pytest.mark.parametrize("case", meshes.broken(), ids=lambda case: case.name)
def test_the_same_graph_of_what_was_repaired(case: meshes.Case, rule: dict[str, Any], tmp_path: Path) -> None:
    expect_twins(sb.repair(case.vertices, case.triangles)[0], tmp_path, **rule)


LARGER: dict[str, Callable[[], meshes.Arrays]] = {
    "needles": lambda: meshes.needles(4, 400),
    "graded": meshes.graded_disk,
    "sphere": lambda: meshes.icosphere(5),
    "grid": lambda: meshes.grid(120, 90),
    "jittered": lambda: meshes.grid(90, 80, 0.3),
    "spikes": meshes.spikes,
}


@pytest.mark.parametrize("rule", RULES, ids=RULE_NAMES)
@pytest.mark.parametrize("name", LARGER)
def test_the_same_graph_of_larger_meshes(name: str, rule: dict[str, Any], tmp_path: Path) -> None:
    expect_twins(sb.Mesh(*LARGER[name]()), tmp_path, **rule)


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_the_same_graph_at_any_scale(scale: float, tmp_path: Path) -> None:
    vertices, triangles = meshes.torus(60, 24)
    expect_twins(sb.Mesh(vertices * scale, triangles), tmp_path, accuracy=5e-3)


def fan(rim: int) -> meshes.Arrays:
    angles = np.linspace(0, 2 * np.pi, rim, endpoint=False)
    around = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(rim)])
    along = np.arange(rim, dtype=np.int32) + 1
    spokes = np.column_stack([np.zeros(rim, np.int32), along, np.roll(along, -1)])
    return np.vstack([np.zeros(3), around]), spokes.astype(np.int32)


@pytest.mark.parametrize("k", [40, 100, 150])
def test_disks_in_creases_are_bounded_by_edges_on_the_device(k: int, tmp_path: Path) -> None:
    mesh = sb.Mesh(*meshes.spikes())
    expect_twins(mesh, tmp_path, k=k)
    assert sb.SaddleVertexGraph(mesh, k=k, device="cuda").device_times["by_processor"] == 0


def test_what_is_too_much_for_the_device_the_processor_does(tmp_path: Path) -> None:
    expect_twins(sb.Mesh(*fan(6000)), tmp_path, k=8)  # more windows at the hub than there is room for


@pytest.mark.parametrize("rule", RULES, ids=RULE_NAMES)
def test_edges_of_very_different_lengths_the_processor_follows(rule: dict[str, Any], tmp_path: Path) -> None:
    vertices, triangles = meshes.torus(30, 12)
    count = len(vertices)
    both = sb.Mesh(np.vstack([vertices, 1e-13 * vertices]), np.vstack([triangles, triangles + count]))
    expect_twins(both, tmp_path, **rule)
    assert sb.SaddleVertexGraph(both, device="cuda", **rule).device_times["by_processor"] == 2 * count


@pytest.mark.parametrize("rule", RULES, ids=RULE_NAMES)
def test_two_runs_give_the_same_bytes(rule: dict[str, Any], tmp_path: Path) -> None:
    mesh = sb.Mesh(*meshes.grid(80, 80, 0.3))
    runs = {saved(sb.SaddleVertexGraph(mesh, device="cuda", **rule), tmp_path) for _ in range(3)}
    assert len(runs) == 1


def test_auto_takes_the_device_where_it_pays() -> None:
    large, small = sb.Mesh(*meshes.grid(160, 160)), sb.Mesh(*meshes.grid(20, 20))
    assert sb.SaddleVertexGraph(large).device == "cuda"
    assert sb.SaddleVertexGraph(small).device == "cpu"


def test_too_little_memory_is_refused_with_the_figure() -> None:
    mesh = sb.Mesh(*meshes.grid(160, 160))
    sb.limit_device_memory(1 << 20)
    try:
        with pytest.raises(sb.DeviceError, match=r"needs about \d+ MB .* 1 MB"):
            sb.SaddleVertexGraph(mesh, device="cuda")
        assert sb.SaddleVertexGraph(mesh, device="auto").device == "cpu"
    finally:
        sb.limit_device_memory(0)
    assert sb.SaddleVertexGraph(mesh, device="cuda").device == "cuda"


def test_a_device_that_does_not_exist() -> None:
    with pytest.raises(sb.DeviceError, match="no CUDA device 99"):
        sb.SaddleVertexGraph(sb.Mesh(*meshes.cube()), device="cuda:99")
    with pytest.raises(sb.DeviceError, match="no CUDA device 99"):
        sb.SaddleVertexGraph(sb.Mesh(*meshes.cube()), device="cuda:0,99")


def test_exact_graphs_stay_on_the_processor() -> None:
    with pytest.raises(sb.DeviceError, match="exact"):
        sb.SaddleVertexGraph(sb.Mesh(*meshes.cube()), exact=True, device="cuda")


@pytest.mark.parametrize("device", DEVICES)
def test_progress_and_cancel(device: str) -> None:
    mesh = sb.Mesh(*meshes.grid(100, 100, 0.3))
    job = sb.Job()
    sb.SaddleVertexGraph(mesh, device=device, job=job)
    assert job.fraction == 1
    job.cancel()
    with pytest.raises(sb.Cancelled):
        sb.SaddleVertexGraph(mesh, device=device, job=job)


@pytest.mark.parametrize("rule", [{"accuracy": 5e-3}, {"k": 100}], ids=["accuracy", "k"])
def test_cancelled_within_a_moment_among_needles(rule: dict[str, Any]) -> None:
    vertices, triangles = meshes.cylinder(500, 40)
    mesh = sb.Mesh(vertices * [1, 1, 250], triangles)
    sb.SaddleVertexGraph(sb.Mesh(*meshes.grid(40, 40)), device="cuda", **rule)  # the device is awake
    expect_to_stop_within_a_moment(lambda job: sb.SaddleVertexGraph(mesh, device="cuda", job=job, **rule), after=0.1)

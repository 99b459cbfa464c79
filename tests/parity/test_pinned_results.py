# SPDX-License-Identifier: MIT
"""Results in memory that a CUDA device writes by itself are the same, one after the other."""

from __future__ import annotations

import ctypes
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.native import plane_sites
from tests.parity.cancelling import expect_to_stop_within_a_moment
from tests.parity.test_graph_cuda import saved
from tests.parity.test_voronoi_cuda import ARRAYS, DEVICES, weights_of

PINNED = 1  # cudaMemoryTypeHost
WRITTEN = ("vertices", "edges", "edge_sites", "site_of")  # the rest is made of these


def is_pinned_at(address: int) -> bool:
    import cupy  # nobody has it without a device

    return bool(cupy.cuda.runtime.pointerGetAttributes(address).type == PINNED)


def is_pinned(array: np.ndarray) -> bool:
    return is_pinned_at(array.ctypes.data)


def in_pinned_memory(array: np.ndarray) -> np.ndarray:
    import cupy

    memory = cupy.cuda.alloc_pinned_memory(array.nbytes)
    copy = np.frombuffer(memory, array.dtype, array.size).reshape(array.shape)
    copy[...] = array
    return copy


def expect_pinned_twin(sites: np.ndarray, own: sb.Voronoi2d, device: str, weights: np.ndarray | None = None) -> None:
    twin = sb.voronoi_2d(sites, weights, device=device, pinned=True)
    assert twin.device == "cuda"
    assert all(is_pinned(getattr(twin, name)) for name in WRITTEN)
    for name in ARRAYS if weights is None else WRITTEN:
        assert getattr(twin, name).tobytes() == getattr(own, name).tobytes(), (device, name)


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("kind", ["uniform", "clusters", "grid", "duplicates", "circle"])
def test_one_pinned_diagram_after_the_other(kind: str, device: str) -> None:
    for n in (40, 30_000, 29_000, 3000, 30_000):  # in what was pinned for others, and not
        sites = plane_sites.KINDS[kind](n, np.random.default_rng(n))
        expect_pinned_twin(sites, sb.voronoi_2d(sites, device="cpu"), device)


def test_pinned_sites_are_read_by_the_device() -> None:
    sites = plane_sites.KINDS["uniform"](300_000, np.random.default_rng(1))
    there = in_pinned_memory(sites)
    assert is_pinned(there)
    own = sb.voronoi_2d(sites, device="cpu")
    expect_pinned_twin(there, own, "cuda")
    assert not is_pinned(sb.voronoi_2d(there, device="cuda").vertices)
    kept = sb.voronoi_2d_on_device(there)
    assert kept.vertices.numpy().tobytes() == own.vertices.tobytes()


def test_a_pinned_weighted_diagram() -> None:
    rng = np.random.default_rng(2)
    sites = rng.random((50_000, 2))
    weights = weights_of("small", sites, rng)
    own = sb.voronoi_2d(sites, weights, device="cpu")
    for _ in range(2):
        expect_pinned_twin(sites, own, "cuda", weights)


def test_what_the_processor_finds_is_not_pinned() -> None:
    few = sb.voronoi_2d([[0, 0], [1, 0]], device="cuda", pinned=True)
    assert few.device == "cpu" and len(few.edges) == 1
    many = sb.voronoi_2d(np.random.default_rng(3).random((1000, 2)), device="cpu", pinned=True)
    assert not is_pinned(many.vertices)


def test_results_outlive_what_is_released_and_others_results() -> None:
    sites = [np.random.default_rng(seed).random((20_000, 2)) for seed in range(4)]
    twins = [sb.voronoi_2d(one, device="cuda", pinned=True) for one in sites]
    vertices = [twin.vertices for twin in twins]
    dropped, kept = vertices[::2], vertices[1::2]
    copies = [one.copy() for one in kept]
    del twins, vertices, dropped
    sb.release_pinned_memory()
    for one in sites:
        sb.voronoi_2d(one[::-1], device="cuda", pinned=True)
    for one, copy in zip(kept, copies, strict=True):
        np.testing.assert_array_equal(one, copy)


def test_what_is_freed_is_used_again_and_given_back_in_the_end() -> None:
    sb.release_pinned_memory()
    sites = np.random.default_rng(5).random((100_000, 2))
    places = {sb.voronoi_2d(sites, device="cuda", pinned=True).vertices.ctypes.data for _ in range(4)}
    assert len(places) == 1
    place = places.pop()
    assert is_pinned_at(place)
    sb.release_pinned_memory()
    assert not is_pinned_at(place)


@pytest.mark.parametrize("rule", [{"accuracy": 5e-3}, {"k": 30}], ids=["accuracy", "k"])
@pytest.mark.parametrize("device", DEVICES)
def test_one_pinned_graph_after_the_other(device: str, rule: dict[str, Any], tmp_path: Path) -> None:
    for arrays in (meshes.icosphere(4), meshes.grid(60, 50, 0.3), meshes.icosphere(4), meshes.needles(3, 200)):
        mesh = sb.Mesh(*arrays)
        own = saved(sb.SaddleVertexGraph(mesh, device="cpu", **rule), tmp_path)
        graph = sb.SaddleVertexGraph(mesh, device=device, pinned=True, **rule)
        assert graph.device == "cuda"
        assert saved(graph, tmp_path) == own


def test_sites_that_change_meanwhile_break_nothing() -> None:
    """Nobody can say what comes out; it has the shape of a diagram all the same."""
    sites = np.random.default_rng(6).random((1_000_000, 2))

    def change() -> None:
        for step in range(200):
            ctypes.memset(sites.ctypes.data + 65536 * step, step, 65536)

    changing = threading.Thread(target=change)
    changing.start()
    try:
        diagram = sb.voronoi_2d(sites, device="cuda")
        assert diagram.edges.max() < len(diagram.vertices)
    except sb.Error:
        pass
    changing.join()


def test_cancelled_within_a_moment() -> None:
    sites = np.random.default_rng(4).random((5_000_000, 2))
    for after in (0.01, 0.03, 0.05):
        expect_to_stop_within_a_moment(
            lambda job: sb.voronoi_2d(sites, device="cuda", pinned=True, job=job), after=after
        )

# SPDX-License-Identifier: MIT
"""Cells and relaxations whose nearest sites a CUDA device finds are the processor's, to the bit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.parity.test_graph_cuda import LARGER
from tests.parity.test_search_cuda import CASES, RULES, graph_of, some

PARTS = ("vertex_cell", "vertex_distance", "areas", "edge_points", "edge_cells", "edge_closed")


def expect_twins(twin: sb.GeodesicVoronoi, own: sb.GeodesicVoronoi) -> None:
    assert (twin.device, own.device) == ("cuda", "cpu")
    for part in PARTS:
        assert np.asarray(getattr(twin, part)).tobytes() == np.asarray(getattr(own, part)).tobytes(), part


def cells_by_both(graph: sb.SaddleVertexGraph, sites: Any) -> None:
    expect_twins(
        sb.geodesic_voronoi(graph, sites, device="cuda"),
        sb.geodesic_voronoi(graph, sites, device="cpu"),
    )


@pytest.mark.parametrize("mesh", [mesh for _, mesh in CASES], ids=[name for name, _ in CASES])
def test_the_same_cells(mesh: sb.Mesh) -> None:
    graph = graph_of(mesh, RULES[0])
    one_each = [int(np.flatnonzero(mesh.components == part)[0]) for part in range(mesh.components.max() + 1)]
    cells_by_both(graph, np.array(one_each, np.int32))
    cells_by_both(graph, np.arange(len(mesh.vertices), dtype=np.int32)[:: max(1, len(mesh.vertices) // 50)])


@pytest.mark.parametrize("name", LARGER)
def test_the_same_cells_of_larger_meshes(name: str) -> None:
    mesh = sb.Mesh(*LARGER[name]())
    cells_by_both(graph_of(mesh, RULES[0]), some(40, len(mesh.vertices)))


@pytest.mark.parametrize("name", ["sphere", "grid", "jittered"])
def test_the_same_relaxation(name: str) -> None:
    graph = graph_of(sb.Mesh(*LARGER[name]()), RULES[0])
    for method in ("lloyd", "lbfgs"):
        twin, own = (
            sb.centroidal_voronoi(graph, count=150, method=method, max_iterations=8, tolerance=0, seed=3, device=device)
            for device in ("cuda", "cpu")
        )
        assert twin.energy.tobytes() == own.energy.tobytes()
        expect_twins(twin.cells, own.cells)


def test_a_start_from_coarse_cells_annealing_and_resting_sites() -> None:
    graph = graph_of(sb.Mesh(*meshes.icosphere(4)), RULES[0])
    options: dict[str, Any] = {"start": "coarse_to_fine", "annealing": 5, "max_iterations": 20, "least_move": 1e-2}
    twin, own = (sb.centroidal_voronoi(graph, count=200, device=device, **options) for device in ("cuda", "cpu"))
    assert twin.energy.tobytes() == own.energy.tobytes()
    expect_twins(twin.cells, own.cells)


def test_a_cache_serves_either_device() -> None:
    graph = graph_of(sb.Mesh(*meshes.icosphere(4)), RULES[0])
    cache = sb.CellCache()
    sites = sb.sample(graph.mesh, 100, seed=1)
    for device in ("cuda", "cpu", "cuda"):
        kept = sb.centroidal_voronoi(graph, sites, max_iterations=3, tolerance=0, cache=cache, device=device)
        fresh = sb.centroidal_voronoi(graph, sites, max_iterations=3, tolerance=0, device="cpu")
        assert kept.energy.tobytes() == fresh.energy.tobytes()
        assert kept.cells.device == device


def test_auto_takes_the_device_that_keeps_the_graph() -> None:
    mesh = sb.Mesh(*meshes.icosphere(6))
    graph = sb.SaddleVertexGraph(mesh, accuracy=5e-3, device="cpu")
    assert sb.geodesic_voronoi(graph, [0, 1, 2]).device == "cpu"
    graph.nearest([0], device="cuda")
    assert sb.geodesic_voronoi(graph, [0, 1, 2]).device == "cuda"


def test_a_relaxation_is_cancelled() -> None:
    graph = graph_of(sb.Mesh(*meshes.icosphere(5)), RULES[0])
    job = sb.Job()
    job.cancel()
    with pytest.raises(sb.Cancelled):
        sb.centroidal_voronoi(graph, count=100, device="cuda", job=job)


def test_exact_cells_are_the_processors() -> None:
    graph = graph_of(sb.Mesh(*meshes.icosphere(2)), RULES[0])
    with pytest.raises(sb.InputError, match=r"exact: runs on the processor only; wanted device='cpu'"):
        sb.geodesic_voronoi(graph, [0, 5], exact=True, device="cuda")

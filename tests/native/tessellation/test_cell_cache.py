# SPDX-License-Identifier: MIT
"""Cells that stay when a few sites move, come or go: the same as all found anew, and untouched far away."""

from __future__ import annotations

import threading
from contextlib import suppress

import numpy as np
import pytest

import saddleback as sb
from tests import meshes

MESHES = [c for c in meshes.good() if len(c.vertices) >= 100]


def check_as_found_anew(graph: sb.SaddleVertexGraph, result: sb.CentroidalVoronoi) -> None:
    """Labels and distances to the bit; areas to the rounding of another order of sums."""
    anew = sb.geodesic_voronoi(graph, result.sites)
    assert np.array_equal(result.cells.vertex_cell, anew.vertex_cell)
    assert np.array_equal(result.cells.vertex_distance, anew.vertex_distance)
    np.testing.assert_allclose(result.cells.areas, anew.areas, rtol=1e-9, atol=1e-12 * anew.areas.sum())
    assert result.cells.areas.sum() == pytest.approx(anew.areas.sum(), rel=1e-12)


def changed(sites: sb.SurfacePoints, mesh: sb.Mesh, how: str, seed: int) -> tuple[sb.SurfacePoints, np.ndarray]:
    """Sites of which two were moved, added or removed, and for each which one it was before, -1 for new ones."""
    faces, barycentric, before = sites.faces.copy(), sites.barycentric.copy(), np.arange(len(sites.faces))
    chosen = np.random.default_rng(seed).choice(len(faces), 2, replace=False)
    more = sb.sample(mesh, 2, seed=seed + 1)
    if how == "moved":
        faces[chosen], barycentric[chosen], before[chosen] = more.faces, more.barycentric, -1
    if how in ("removed", "exchanged"):
        faces, barycentric, before = (np.delete(a, chosen, axis=0) for a in (faces, barycentric, before))
    if how in ("added", "exchanged"):
        faces, barycentric = np.append(faces, more.faces), np.append(barycentric, more.barycentric, axis=0)
        before = np.append(before, [-1, -1])
    return sb.SurfacePoints(faces, barycentric), before


@pytest.mark.parametrize("how", ["moved", "removed", "added", "exchanged"])
@pytest.mark.parametrize("case", MESHES, ids=str)
def test_a_few_other_sites(case: meshes.Case, how: str) -> None:
    graph, cache = sb.SaddleVertexGraph(case.mesh, k=min(40, len(case.vertices))), sb.CellCache()
    last = sb.centroidal_voronoi(graph, count=30, max_iterations=4, seed=3, cache=cache)
    for seed in range(2):
        sites, _ = changed(last.sites, case.mesh, how, seed)
        if how in ("moved", "removed") and case.components > 1:  # a part may be left without a site
            sites, _ = changed(last.sites, case.mesh, "added", seed)
        last = sb.centroidal_voronoi(graph, sites=sites, max_iterations=0, cache=cache)
        check_as_found_anew(graph, last)
    for _ in range(2):
        last = sb.centroidal_voronoi(graph, sites=last.sites, max_iterations=3, least_move=0.05, cache=cache)
        check_as_found_anew(graph, last)


@pytest.mark.parametrize("how", ["moved", "removed", "added", "exchanged"])
def test_cells_far_from_what_changed_are_the_same_to_the_bit(how: str) -> None:
    mesh = sb.Mesh(*meshes.torus(72, 30))
    graph, cache = sb.SaddleVertexGraph(mesh, k=40), sb.CellCache()
    first = sb.centroidal_voronoi(graph, count=200, max_iterations=10, cache=cache)
    sites, before = changed(first.sites, mesh, how, 5)
    second = sb.centroidal_voronoi(graph, sites=sites, max_iterations=0, cache=cache)
    check_as_found_anew(graph, second)
    near = np.zeros(len(sites.faces), bool)
    near[before < 0] = True
    gone = np.setdiff1d(np.arange(200), before)
    for a, b in first.cells.edge_cells:
        for lost, other in ((a, b), (b, a)):
            if lost in gone:
                near[before == other] = True
    for a, b in second.cells.edge_cells:
        if before[a] < 0 or before[b] < 0:
            near[[a, b]] = True
    assert 100 < np.count_nonzero(~near) < 198
    assert np.array_equal(second.cells.areas[~near], first.cells.areas[before[~near]])


def test_sites_that_hardly_move_rest() -> None:
    mesh = sb.Mesh(*meshes.torus(72, 30))
    graph = sb.SaddleVertexGraph(mesh, k=40)
    even = sb.centroidal_voronoi(graph, count=300, max_iterations=60)
    sites, before = changed(even.sites, mesh, "added", 2)
    least = 2e-2
    run = sb.centroidal_voronoi(graph, sites=sites, least_move=least, tolerance=0, max_iterations=100)
    assert run.stop_reason in ("least_move", "no step lowers the energy")
    assert run.converged
    assert (np.diff(run.energy) <= 0).all()
    check_as_found_anew(graph, run)
    rest = (run.sites.faces == sites.faces) & (run.sites.barycentric == sites.barycentric).all(axis=1)
    assert 50 < np.count_nonzero(rest) < 300
    assert not rest[before < 0].any()
    # Lloyd's step from there moves none by much more than the bound.
    free = sb.centroidal_voronoi(graph, sites=run.sites, method="lloyd", max_iterations=1, tolerance=0)
    steps = np.linalg.norm(free.sites.positions(mesh) - run.sites.positions(mesh), axis=1)
    assert (steps < 2 * least * np.sqrt(run.cells.areas)).all()
    all_move = sb.centroidal_voronoi(graph, sites=sites, max_iterations=40)
    assert run.normalized_energy == pytest.approx(all_move.normalized_energy, rel=2e-3)


def test_when_all_rest_the_run_ends() -> None:
    mesh = sb.Mesh(*meshes.torus(48, 20))
    graph = sb.SaddleVertexGraph(mesh, k=40)
    even = sb.centroidal_voronoi(graph, count=40, max_iterations=100)
    again = sb.centroidal_voronoi(graph, sites=even.sites, least_move=0.05)
    assert (again.stop_reason, again.iterations) == ("least_move", 0)
    assert np.array_equal(again.sites.barycentric, even.sites.barycentric)


def test_the_same_for_any_number_of_threads() -> None:
    mesh = sb.Mesh(*meshes.torus(72, 30))
    graph = sb.SaddleVertexGraph(mesh, k=40)
    found = []
    for threads in (1, 2, 8):
        cache = sb.CellCache()
        start = sb.centroidal_voronoi(graph, count=120, max_iterations=20, threads=threads, cache=cache)
        sites, _ = changed(start.sites, mesh, "exchanged", 4)
        run = sb.centroidal_voronoi(
            graph, sites=sites, max_iterations=20, least_move=5e-3, threads=threads, cache=cache
        )
        found.append((run.sites.barycentric.tobytes(), run.energy.tobytes(), run.cells.areas.tobytes()))
    assert found[0] == found[1] == found[2]


def test_another_density_finds_masses_and_centers_anew_and_no_cells() -> None:
    mesh = sb.Mesh(*meshes.torus(72, 30))
    graph, cache = sb.SaddleVertexGraph(mesh, k=40), sb.CellCache()
    first = sb.centroidal_voronoi(graph, count=200, max_iterations=10, cache=cache)
    dab = 1.0 + 8.0 * (np.linalg.norm(mesh.vertices - mesh.vertices[7], axis=1) < 1.0)
    for density in (dab, None, 1.0 + mesh.vertices[:, 2] ** 2):
        sites = first.sites
        still = sb.centroidal_voronoi(graph, sites=sites, density=density, max_iterations=0, cache=cache)
        assert np.array_equal(still.cells.areas, first.cells.areas)
        for steps in (0, 1, 4):
            options = {"sites": sites, "density": density, "max_iterations": steps, "least_move": 1e-3}
            cached = sb.centroidal_voronoi(graph, cache=cache, **options)
            alone = sb.centroidal_voronoi(graph, **options)
            check_as_found_anew(graph, cached)
            np.testing.assert_allclose(cached.energy, alone.energy, rtol=1e-9)
            places = cached.sites.positions(mesh), alone.sites.positions(mesh)
            np.testing.assert_allclose(*places, atol=1e-6)


def test_another_graph_or_density_begins_anew() -> None:
    cache = sb.CellCache()
    for size in (30, 24):
        mesh = sb.Mesh(*meshes.grid(size, size))
        graph = sb.SaddleVertexGraph(mesh, k=40)
        for density in (None, 1 + mesh.vertices[:, 0], None):
            options = {"count": 25, "density": density, "max_iterations": 5, "seed": 2}
            with_cache = sb.centroidal_voronoi(graph, cache=cache, **options)
            without = sb.centroidal_voronoi(graph, **options)
            assert with_cache.energy[-1] == pytest.approx(without.energy[-1], rel=1e-6)
            check_as_found_anew(graph, with_cache)
        del graph
    cache.clear()


def test_what_was_cancelled_is_found_anew() -> None:
    mesh = sb.Mesh(*meshes.torus(72, 30))
    graph, cache = sb.SaddleVertexGraph(mesh, k=40), sb.CellCache()
    sites = sb.centroidal_voronoi(graph, count=200, max_iterations=2, cache=cache).sites
    for seed, wait in enumerate((0.0, 0.002, 0.005, 0.01)):
        job = sb.Job()
        timer = threading.Timer(wait, job.cancel)
        timer.start()
        moved, _ = changed(sites, mesh, "moved", seed)
        with suppress(sb.Cancelled):
            sb.centroidal_voronoi(graph, sites=moved, cache=cache, job=job, tolerance=0)
        timer.join()
        check_as_found_anew(graph, sb.centroidal_voronoi(graph, sites=sites, max_iterations=0, cache=cache))


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"least_move": -1}, "least_move: wanted 0 or more, got -1"),
        ({"least_move": np.nan}, "least_move: wanted 0 or more, got nan"),
        ({"least_move": np.inf}, "least_move: wanted a finite number, got inf"),
        ({"cache": {}}, "cache: wanted a CellCache, got a dict"),
    ],
)
def test_bad_options_are_refused(options: dict[str, object], text: str) -> None:
    graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.grid(5, 5)), k=10)
    with pytest.raises(sb.InputError, match=text):
        sb.centroidal_voronoi(graph, count=4, **options)  # type: ignore[arg-type]

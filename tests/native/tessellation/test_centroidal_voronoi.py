# SPDX-License-Identifier: MIT
"""Relaxation: the energy never rises, cells follow the paint, nothing depends on threads or scale."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_progress_and_cancel
from tests.native.cell_checks import triangle_areas

CONNECTED = [c for c in meshes.good() if len(c.vertices) >= 100]


@pytest.mark.parametrize("method", ["lbfgs", "lloyd"])
@pytest.mark.parametrize("case", CONNECTED, ids=str)
def test_the_energy_never_rises(case: meshes.Case, method: str) -> None:
    graph = sb.SaddleVertexGraph(case.mesh, k=min(40, len(case.vertices)))
    relaxed = sb.centroidal_voronoi(graph, count=20, max_iterations=15, seed=3, method=method)
    assert len(relaxed.energy) == relaxed.iterations + 1
    assert (np.diff(relaxed.energy) <= 0).all()
    assert relaxed.energy[-1] < relaxed.energy[0]
    assert len(relaxed.sites) == 20
    assert relaxed.cells.areas.sum() == pytest.approx(case.mesh.area, rel=1e-9)
    assert (relaxed.cells.areas > 0).all()


def test_the_plane_comes_near_the_honeycomb() -> None:
    """Scale-free energy E n / (2 G A^2), G = 5 / (36 sqrt 3): 1 for regular hexagons without a border."""
    mesh = sb.Mesh(*meshes.grid(40, 40))
    relaxed = sb.centroidal_voronoi(sb.SaddleVertexGraph(mesh, k=60), count=100, max_iterations=80)
    assert relaxed.energy[-1] * 100 / (2 * 5 / (36 * np.sqrt(3))) < 1.05
    areas = relaxed.cells.areas
    assert areas.std() / areas.mean() < 0.15


def test_lbfgs_comes_as_far_in_a_third_of_the_steps() -> None:
    mesh = sb.Mesh(*meshes.torus(72, 30))
    graph = sb.SaddleVertexGraph(mesh, k=60)
    slow = sb.centroidal_voronoi(graph, count=120, max_iterations=60, tolerance=0, method="lloyd")
    fast = sb.centroidal_voronoi(graph, count=120, max_iterations=20, tolerance=0, method="lbfgs")
    assert fast.energy[-1] <= slow.energy[-1]
    assert 1 < fast.normalized_energy < 1.04
    assert fast.normalized_energy == pytest.approx(
        fast.energy[-1] * 120 / (2 * 5 / (36 * np.sqrt(3)) * mesh.area**2), rel=1e-12
    )


def test_coarse_cells_leave_few_irregular_vertices() -> None:
    mesh = sb.Mesh(*meshes.torus(108, 45))
    graph = sb.SaddleVertexGraph(mesh, k=40)
    irregular = {}
    for start in ("coarse_to_fine", "sample"):
        relaxed = sb.centroidal_voronoi(graph, count=400, max_iterations=40, start=start)
        assert len(relaxed.sites) == 400
        dual = relaxed.cells.dual("strict")
        irregular[start] = sb.triangle_quality(dual.vertices, dual.triangles).irregular
    assert irregular["coarse_to_fine"] < 0.15
    assert irregular["coarse_to_fine"] < 0.75 * irregular["sample"]


def test_fixed_sites_stay() -> None:
    mesh = sb.Mesh(*meshes.grid(30, 30))
    graph = sb.SaddleVertexGraph(mesh, k=60)
    start = sb.sample(mesh, 40, seed=1)
    relaxed = sb.centroidal_voronoi(graph, sites=start, fixed=[3, 17], max_iterations=10)
    before, after = start.positions(mesh), relaxed.sites.positions(mesh)
    moved = np.linalg.norm(after - before, axis=1)
    assert (moved[[3, 17]] == 0).all()
    assert (np.delete(moved, [3, 17]) > 0).all()
    assert (np.diff(relaxed.energy) <= 0).all()


def test_sites_in_one_place_part() -> None:
    """Coincident sites have no cell; put elsewhere, each has one."""
    mesh = sb.Mesh(*meshes.torus(40, 16))
    graph = sb.SaddleVertexGraph(mesh, k=40)
    relaxed = sb.centroidal_voronoi(graph, sites=[5] * 12 + [300, 301], max_iterations=12)
    areas = relaxed.cells.areas
    assert (areas > 0.2 * areas.mean()).all()


def test_cancelled_with_what_there_is() -> None:
    mesh = sb.Mesh(*meshes.grid(80, 80))
    graph = sb.SaddleVertexGraph(mesh, k=20)
    job = sb.Job()

    def stop() -> None:
        while job.fraction < 0.405:  # the start has 0.4
            time.sleep(0.001)
        job.cancel()

    watcher = threading.Thread(target=stop)
    watcher.start()
    relaxed = sb.centroidal_voronoi(
        graph, count=100, max_iterations=2000, tolerance=0, return_when_cancelled=True, job=job
    )
    watcher.join()
    assert relaxed.stop_reason == "cancelled"
    assert not relaxed.converged
    assert 0 < relaxed.iterations < 2000
    assert len(relaxed.energy) == relaxed.iterations + 1
    assert relaxed.cells.areas.sum() == pytest.approx(mesh.area, rel=1e-9)


def test_a_watch_shows_every_step() -> None:
    mesh = sb.Mesh(*meshes.grid(30, 30))
    graph = sb.SaddleVertexGraph(mesh, k=20)
    watch = sb.RelaxationWatch()
    assert watch.latest() is None
    relaxed = sb.centroidal_voronoi(graph, count=40, max_iterations=12, tolerance=0, start="sample", watch=watch)
    last = watch.latest()
    assert last is not None
    assert (last.iterations, last.energy) == (relaxed.iterations, relaxed.energy[-1])
    np.testing.assert_array_equal(last.sites.faces, relaxed.sites.faces)
    np.testing.assert_array_equal(last.sites.barycentric, relaxed.sites.barycentric)
    with pytest.raises(sb.InputError, match="watch: wanted a RelaxationWatch, got a"):
        sb.centroidal_voronoi(graph, count=40, watch=object())  # type: ignore[arg-type]


def test_what_is_seen_on_the_way_is_a_step_of_the_run() -> None:
    mesh = sb.Mesh(*meshes.grid(60, 60))
    graph = sb.SaddleVertexGraph(mesh, k=20)
    watch, job, seen = sb.RelaxationWatch(), sb.Job(), []

    def look() -> None:
        while len(seen) < 3:
            step = watch.latest()
            if step is not None and (not seen or step.iterations > seen[-1].iterations):
                seen.append(step)
            time.sleep(0.001)
        job.cancel()

    watcher = threading.Thread(target=look)
    watcher.start()
    relaxed = sb.centroidal_voronoi(
        graph, count=150, max_iterations=5000, tolerance=0, start="sample", return_when_cancelled=True, watch=watch,
        job=job,
    )  # fmt: skip
    watcher.join()
    for step in seen:
        assert step.energy == relaxed.energy[step.iterations]
        cells = sb.geodesic_voronoi(graph, step.sites)
        assert len(cells.areas) == 150


def test_the_energy_is_the_integral_of_the_squared_distance() -> None:
    """One site in the middle of the unit square: 1/6. With density 1 + x: the integral of (1 + x)^2 r^2."""
    mesh = sb.Mesh(*meshes.grid(9, 9))
    graph = sb.SaddleVertexGraph(mesh, k=81)
    center = sb.project(mesh, [[0.5, 0.5, 0.0]])
    plain = sb.centroidal_voronoi(graph, sites=center, max_iterations=0)
    assert plain.energy.tolist() == pytest.approx([1 / 6], rel=1e-6)
    assert plain.iterations == 0
    weighted = sb.centroidal_voronoi(graph, sites=center, density=1 + mesh.vertices[:, 0], max_iterations=0)
    # u = x - 1/2: integral of (3/2 + u)^2 (u^2 + v^2) over the square
    expected = 9 / 4 / 6 + (1 / 80 + 1 / 144)
    assert weighted.energy[0] == pytest.approx(expected, rel=1e-6)


def test_one_site_goes_to_the_weighted_middle() -> None:
    mesh = sb.Mesh(*meshes.grid(21, 21))
    graph = sb.SaddleVertexGraph(mesh, k=441)
    density = 1 + mesh.vertices[:, 0]
    relaxed = sb.centroidal_voronoi(graph, sites=[25], density=density, max_iterations=50, tolerance=0)
    x = np.linspace(0, 1, 200001)
    middle = ((1 + x) ** 2 * x).sum() / ((1 + x) ** 2).sum()
    np.testing.assert_allclose(relaxed.sites.positions(mesh)[0], [middle, 0.5, 0], atol=1e-5)


def test_painted_density_is_the_number_of_cells_per_area() -> None:
    """Paint from 1 to 8 across a plane, 2,000 cells: cells per area in 40 strips against the paint."""
    mesh = sb.Mesh(*meshes.grid(130, 130, 0.2))
    paint = 1 + 7 * mesh.vertices[:, 0]
    relaxed = sb.centroidal_voronoi(sb.SaddleVertexGraph(mesh, k=40), count=2000, density=paint, max_iterations=25)
    x = relaxed.sites.positions(mesh)[:, 0]
    counts, edges = np.histogram(x, bins=40, range=(0, 1))
    wanted = 1 + 7 * (edges[:-1] + edges[1:]) / 2
    assert np.corrcoef(counts, wanted)[0, 1] >= 0.97
    per_cell = np.corrcoef(1 / relaxed.cells.areas, 1 + 7 * x)[0, 1]
    assert per_cell >= 0.95


@pytest.mark.parametrize("unit", [2.0**100, 1e200, 1e-300, 1e-310])
def test_only_ratios_of_densities_count(unit: float) -> None:
    mesh = sb.Mesh(*meshes.icosphere(3))
    graph = sb.SaddleVertexGraph(mesh, k=30)
    density = 1 + mesh.vertices[:, 2]
    density[density < 0.1] = 0
    wanted, found = (sb.centroidal_voronoi(graph, count=20, density=density * u, max_iterations=10) for u in (1, unit))
    np.testing.assert_allclose(found.sites.positions(mesh), wanted.sites.positions(mesh), atol=1e-6)
    assert np.isfinite(found.energy).all()
    assert found.energy[-1] < found.energy[0]
    centers = (wanted.cells.centers(density * u).positions(mesh) for u in (1, unit))
    np.testing.assert_allclose(*centers, atol=1e-9)


def test_a_sharp_step_of_density_is_followed() -> None:
    """Paint of 1 and 16, side by side: cells per area against the paint that a cell covers, and in 20 strips."""
    mesh = sb.Mesh(*meshes.grid(70, 70, 0.2))
    paint = np.where(mesh.vertices[:, 0] > 0.5, 16.0, 1.0)
    cells = sb.centroidal_voronoi(
        sb.SaddleVertexGraph(mesh, k=30), count=600, density=paint, max_iterations=15, start="coarse_to_fine"
    ).cells
    split = cells.split()
    middles = split.vertices[split.triangles].mean(axis=1)[:, 0]
    areas = triangle_areas(split.vertices, split.triangles)
    covered = np.bincount(split.triangle_cell, areas * np.where(middles > 0.5, 16.0, 1.0)) / cells.areas
    assert np.corrcoef(1 / cells.areas, covered)[0, 1] >= 0.97
    strips = np.histogram(middles, bins=20, range=(0, 1), weights=areas / cells.areas[split.triangle_cell])[0]
    assert np.corrcoef(strips, np.where(np.arange(20) < 10, 1.0, 16.0))[0, 1] >= 0.97


def rough_torus() -> meshes.Arrays:
    """Full of places where a little more or less of a distance decides what is seen across which edge."""
    vertices, triangles = meshes.torus(72, 30)
    x, y, z = vertices.T
    return vertices * (1 + 0.5 * np.sin(11 * x) * np.cos(13 * y + 1) * np.cos(12 * z))[:, None], triangles


def in_unit_cube(vertices: meshes.Floats) -> meshes.Floats:
    """The same bits for copies enlarged, shrunk or moved, as `docs/tessellation.md` says."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    place = (vertices - (low + high) / 2) / ((high - low).max() / 2)
    rounded: meshes.Floats = np.floor(place * 2**26 + 0.71828) / 2**26
    return rounded


@pytest.mark.parametrize("method", ["lbfgs", "lloyd"])
def test_scale_and_place_change_nothing_else_where_meshes_are_rounded(method: str) -> None:
    """To the bit, until the relaxation ends: without rounding some site would be elsewhere by a cell."""
    vertices, triangles = rough_torus()

    def relaxed(factor: float, shift: float) -> sb.SurfacePoints:
        there = in_unit_cube(vertices * factor + shift * np.array([3, -2, 7]))
        graph = sb.SaddleVertexGraph(sb.Mesh(there, triangles))
        return sb.centroidal_voronoi(graph, count=100, max_iterations=60, method=method).sites

    sites = relaxed(1, 0)
    for factor, shift in ((1e-3, 0), (2.54, 0), (1, 1), (0.3, -2)):
        other = relaxed(factor, shift)
        assert other.faces.tobytes() == sites.faces.tobytes()
        assert other.barycentric.tobytes() == sites.barycentric.tobytes()


def in_unit(factor: float, iterations: int, along: bool) -> tuple[sb.Mesh, sb.CentroidalVoronoi]:
    vertices, triangles = rough_torus()
    mesh = sb.Mesh(vertices * factor, triangles)
    curves = [sb.SurfaceCurve(mesh, np.arange(30), closed=True)] if along else []
    graph = sb.SaddleVertexGraph(mesh)
    return mesh, sb.centroidal_voronoi(graph, count=60, curves=curves, max_iterations=iterations)


@pytest.mark.parametrize("along", [False, True])
def test_powers_of_two_change_no_bit(along: bool) -> None:
    _, result = in_unit(1, 60, along)
    assert (result.held >= 0).any() == along
    for factor in (2.0**-10, 2.0**10):
        _, other = in_unit(factor, 60, along)
        assert other.sites.faces.tobytes() == result.sites.faces.tobytes()
        assert other.sites.barycentric.tobytes() == result.sites.barycentric.tobytes()
        assert (other.energy / factor**4).tobytes() == result.energy.tobytes()
        assert (other.cells.areas / factor**2).tobytes() == result.cells.areas.tobytes()


@pytest.mark.parametrize("factor", [1e-3, 2.54, 1e3])
def test_other_units_change_what_nobody_sees(factor: float) -> None:
    mesh, result = in_unit(1, 20, along=False)
    copy, other = in_unit(factor, 20, along=False)
    moved = np.linalg.norm(other.sites.positions(copy) / factor - result.sites.positions(mesh), axis=1)
    assert moved.max() < 1e-6 * np.sqrt(mesh.area / 60)


def test_the_seed_decides_and_threads_do_not() -> None:
    graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.torus(40, 16)), k=30)

    def places(seed: int, threads: int) -> bytes:
        relaxed = sb.centroidal_voronoi(graph, count=25, max_iterations=6, seed=seed, threads=threads)
        return relaxed.sites.barycentric.tobytes() + relaxed.energy.tobytes() + relaxed.cells.areas.tobytes()

    assert places(1, 1) == places(1, 2) == places(1, 8)
    assert places(1, 1) != places(2, 1)


def test_tolerance_ends_it() -> None:
    graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.grid(20, 20)), k=60)
    relaxed = sb.centroidal_voronoi(graph, count=6, max_iterations=500, tolerance=1e-3)
    assert relaxed.converged
    assert relaxed.iterations < 500
    assert relaxed.stop_reason in ("tolerance", "no step lowers the energy")
    stopped = sb.centroidal_voronoi(graph, count=6, max_iterations=1, tolerance=0)
    assert not stopped.converged
    assert stopped.stop_reason == "max_iterations"


def test_as_many_cells_as_parts_are_relaxed() -> None:
    """A quarter of the cells, and three for each part that is a disk, are no fewer than all: no start to refine."""
    parts = 96
    corners = np.tile([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], (parts, 1)) + np.repeat(np.eye(3)[:1], 3 * parts, axis=0)
    corners[:, 2] = np.repeat(np.arange(parts), 3)
    mesh = sb.Mesh(corners, np.arange(3 * parts).reshape(-1, 3))
    found = sb.centroidal_voronoi(sb.SaddleVertexGraph(mesh), count=parts)
    assert sorted(found.sites.faces.tolist()) == list(range(parts))


def test_every_part_gets_a_cell() -> None:
    mesh = sb.Mesh(*meshes.two_components())
    graph = sb.SaddleVertexGraph(mesh, k=20)
    relaxed = sb.centroidal_voronoi(graph, count=2, max_iterations=3)
    assert np.isfinite(relaxed.cells.vertex_distance).all()
    with pytest.raises(sb.InputError, match="2 separate parts"):
        sb.centroidal_voronoi(graph, count=1)


def test_unpainted_regions_keep_their_cells() -> None:
    """Density 0 over half of the surface: those sites have no reason to move, and nothing becomes NaN."""
    mesh = sb.Mesh(*meshes.grid(20, 20))
    paint = np.where(mesh.vertices[:, 0] > 0.5, 1.0, 0.0)
    relaxed = sb.centroidal_voronoi(
        sb.SaddleVertexGraph(mesh, k=40), sites=np.arange(0, 400, 23), density=paint, max_iterations=10
    )
    assert np.isfinite(relaxed.sites.positions(mesh)).all()
    assert (np.diff(relaxed.energy) <= 0).all()


def test_progress_rises_and_cancel_is_quick() -> None:
    mesh = sb.Mesh(*meshes.grid(150, 150))
    graph = sb.SaddleVertexGraph(mesh, k=20)
    check_progress_and_cancel(lambda job: sb.centroidal_voronoi(graph, count=300, max_iterations=1000, job=job), 0.005)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({}, "sites, count"),
        ({"count": 3, "sites": [0]}, "sites, count"),
        ({"count": 0}, "count"),
        ({"count": -5}, "count"),
        ({"count": 2.0}, "count"),
        ({"count": 2, "density": [1.0] * 7}, "density"),
        ({"count": 2, "density": [1.0] * 7 + [-1.0]}, "-1"),
        ({"count": 2, "density": [1.0] * 7 + [np.nan]}, "nan"),
        ({"count": 2, "density": [1.0] * 7 + [np.inf]}, "inf"),
        ({"count": 2, "density": [0.0] * 8}, "density"),
        ({"sites": [0], "density": [0.0] * 8}, "density"),
        ({"count": 2, "method": "newton"}, "newton"),
        ({"count": 2, "max_iterations": -1}, "max_iterations"),
        ({"count": 2, "tolerance": -1.0}, "tolerance"),
        ({"count": 2, "tolerance": np.nan}, "tolerance"),
        ({"count": 2, "seed": -1}, "seed"),
        ({"count": 2, "fixed": [2]}, "fixed: wanted sites from 0 to 1, got 2"),
        ({"count": 2, "fixed": [-1]}, "fixed"),
        ({"count": 2, "annealing": -1}, "annealing: wanted 0 or more, got -1"),
        ({"count": 2, "annealing": 0.5}, "annealing"),
        (
            {"count": 2, "start": "guess"},
            "start: wanted 'auto', 'coarse_to_fine', 'coarse_mesh' or 'sample', got 'guess'",
        ),
    ],
)
def test_bad_arguments(arguments: dict[str, object], words: str) -> None:
    graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.cube()))
    with pytest.raises(sb.InputError, match=words):
        sb.centroidal_voronoi(graph, **arguments)


def test_of_several_starts_the_one_with_the_least_energy() -> None:
    mesh = sb.Mesh(*meshes.torus(40, 16))
    graph = sb.SaddleVertexGraph(mesh, k=30)
    one_by_one = [sb.centroidal_voronoi(graph, count=30, max_iterations=12, seed=seed) for seed in range(4, 8)]
    energies = [relaxed.energy[-1] for relaxed in one_by_one]
    assert len(set(energies)) == 4
    best = int(np.argmin(energies))
    assert best > 0  # the first alone would not do
    relaxed = sb.centroidal_voronoi(graph, count=30, max_iterations=12, seed=4, starts=4)
    assert relaxed.energy.tobytes() == one_by_one[best].energy.tobytes()
    assert relaxed.sites.barycentric.tobytes() == one_by_one[best].sites.barycentric.tobytes()
    for arguments, words in (
        ({"count": 30, "starts": 0}, "starts: wanted 1 or more, got 0"),
        ({"sites": [1, 2], "starts": 2}, "starts: wanted 1 where the sites are given"),
    ):
        with pytest.raises(sb.InputError, match=words):
            sb.centroidal_voronoi(graph, **arguments)


@pytest.mark.parametrize("closed", [True, False])
def test_cells_of_a_fine_mesh_begin_on_a_coarse_one(closed: bool) -> None:
    """As even as by as many iterations on the mesh itself, of which a tenth are made there; a start of its own."""
    mesh = sb.Mesh(*(meshes.torus(400, 140) if closed else meshes.grid(240, 240, jitter=0.3)))
    graph = sb.SaddleVertexGraph(mesh)
    density = 1 + 3 * (mesh.vertices[:, 0] > mesh.vertices[:, 0].mean())
    options = {"count": 200, "density": density, "max_iterations": 40}
    one, two = (sb.centroidal_voronoi(graph, start="coarse_mesh", threads=t, **options) for t in (1, 2))
    np.testing.assert_array_equal(one.sites.barycentric, two.sites.barycentric)
    assert one.iterations == 5 and len(one.energy) == 6 and len(one.sites) == 200
    sampled = sb.centroidal_voronoi(graph, start="sample", **options)
    assert one.normalized_energy < 1.005 * sampled.normalized_energy
    assert one.energy[0] < 0.95 * sampled.energy[0]
    assert (one.cells.areas > 0.2 * sampled.cells.areas.min()).all()
    check_progress_and_cancel(
        lambda job: sb.centroidal_voronoi(graph, count=200, max_iterations=1000, start="coarse_mesh", job=job), 0.005
    )


def test_a_mesh_that_is_not_much_finer_is_its_own_start() -> None:
    """Nor one with a part too small for samples to show it."""
    whole, small = meshes.icosphere(4), meshes.icosphere(1)
    fine = meshes.torus(400, 140)
    speck = np.concatenate([fine[0], 1e-3 * small[0]]), np.concatenate([fine[1], small[1] + len(fine[0])])
    for arrays in (whole, speck):
        check_usual_start(sb.SaddleVertexGraph(sb.Mesh(*arrays)))


def check_usual_start(graph: sb.SaddleVertexGraph) -> None:
    found, usual = (sb.centroidal_voronoi(graph, count=40, max_iterations=8, start=s) for s in ("coarse_mesh", "auto"))
    np.testing.assert_array_equal(found.sites.barycentric, usual.sites.barycentric)


def test_annealed_cells_are_more_even_than_relaxed_ones() -> None:
    """At equal numbers of steps, from the same samples: a relaxation ends at the next rest, which luck decides."""
    mesh = sb.Mesh(*meshes.torus(72, 30))
    graph = sb.SaddleVertexGraph(mesh, k=20)
    irregular, energy = np.empty((2, 16)), np.empty((2, 16))
    for row, (annealing, iterations) in enumerate(((0, 200), (150, 50))):
        for seed in range(16):
            relaxed = sb.centroidal_voronoi(
                graph,
                count=400,
                annealing=annealing,
                max_iterations=iterations,
                tolerance=0,
                seed=seed,
                start="sample",
                threads=1,
            )
            assert len(relaxed.sites) == 400
            assert (np.diff(relaxed.energy) <= 0).all()
            dual = relaxed.cells.dual("strict")
            irregular[row, seed] = sb.triangle_quality(dual.vertices, dual.triangles).irregular
            energy[row, seed] = relaxed.normalized_energy
    assert irregular[1].mean() < 0.9 * irregular[0].mean()
    assert energy[1].mean() < energy[0].mean() - 0.0008
    assert energy[1].mean() < 1.0086 < 1.009 < energy[0].mean()


def test_annealing_never_ends_with_more_energy_than_it_began_with() -> None:
    """Two cells at rest and a hundred, with as few steps as leave no time to cool: the sites are returned to."""
    mesh = sb.Mesh(*meshes.torus(40, 16))
    graph = sb.SaddleVertexGraph(mesh, k=30)
    for count in (2, 100):
        rest = sb.centroidal_voronoi(graph, count=count, max_iterations=300, tolerance=1e-9, threads=1)
        shaken = sb.centroidal_voronoi(graph, sites=rest.sites, annealing=3, max_iterations=0, threads=1)
        assert shaken.energy.tobytes() == rest.energy[-1:].tobytes()
        assert shaken.sites.barycentric.tobytes() == rest.sites.barycentric.tobytes()


def test_annealing_is_stopped_and_gives_what_there_is() -> None:
    mesh = sb.Mesh(*meshes.grid(80, 80))
    graph = sb.SaddleVertexGraph(mesh, k=20)
    job = sb.Job()

    def stop() -> None:
        while "Annealing" not in job.text or job.fraction < 0.01:
            time.sleep(0.001)
        job.cancel()

    start = sb.sample(mesh, 100, seed=2)
    watcher = threading.Thread(target=stop)
    watcher.start()
    found = sb.centroidal_voronoi(graph, sites=start, annealing=2000, return_when_cancelled=True, job=job)
    watcher.join()
    assert found.stop_reason == "cancelled"
    assert found.iterations == 0
    assert len(found.energy) == 1
    assert found.energy[0] <= sb.centroidal_voronoi(graph, sites=start, max_iterations=0).energy[0]
    check_progress_and_cancel(lambda job: sb.centroidal_voronoi(graph, count=100, annealing=2000, job=job), 0.005)


def test_many_cells_in_two_faces_take_little_longer_than_in_many() -> None:
    square = np.array([(0.0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]), np.array([(0, 1, 2), (0, 2, 3)])
    spent = []
    for vertices, triangles in (square, meshes.grid(21, 21)):
        graph = sb.SaddleVertexGraph(sb.Mesh(vertices, triangles))
        start = time.process_time()
        sb.centroidal_voronoi(graph, count=4000, max_iterations=5, threads=1)
        spent.append(time.process_time() - start)
    assert spent[0] < 5 * spent[1]  # 3 times; 7.5 where each cell is cut by all others of its face

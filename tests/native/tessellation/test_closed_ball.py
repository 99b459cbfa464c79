# SPDX-License-Identifier: MIT
"""A triangulation with as many vertices as were asked for: sites move until the dual has the surface's topology."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_progress_and_cancel
from tests.native.tessellation.test_dual_mesh import characteristic, check_triangulation, double_sheet


def needle() -> meshes.Arrays:
    """A ball drawn out until its ends are thinner than a cell."""
    vertices, triangles = meshes.icosphere(4)
    return vertices * (0.15, 0.15, 2.0), triangles


def fine(arrays: meshes.Arrays) -> sb.Mesh:
    vertices, triangles = arrays
    while len(triangles) < 3000:
        vertices, triangles = meshes.subdivide(vertices, triangles)
    return sb.Mesh(vertices, triangles)


def graph_of(arrays: meshes.Arrays) -> sb.SaddleVertexGraph:
    return sb.SaddleVertexGraph(fine(arrays), k=60)


def balls_on_a_string() -> meshes.Arrays:
    """Two balls joined by a tube that is thinner than a cell."""
    radii = [0.6 * np.sin(a) for a in np.linspace(0.1, np.pi - 0.18, 20)]
    radii = [*radii, *[radii[-1]] * 16, *radii[::-1]]
    steps = [0.06] * (len(radii) - 1)
    return meshes.lathed(radii, steps, 24)


def strip() -> meshes.Arrays:
    """Two narrow sheets that almost touch, joined along their border: a flat tube, closed at its ends."""
    vertices, triangles = double_sheet(40, 0.002)
    return vertices * (1.0, 0.08, 1.0), triangles


SOLVABLE = [
    ("balls on a string", balls_on_a_string(), 60, 0),
    ("double strip", strip(), 40, 0),
    ("needle", needle(), 60, 0),
    ("needle", needle(), 120, 1),
    ("spike", meshes.cone(32, 40, 1.0, 20.0), 400, 0),  # closed bisectors up to the tip, however small cells are
    ("thin tube", meshes.cylinder(32, 60, 0.2, 3.0), 16, 0),  # closed bisectors, with a border
    ("sheet with holes", meshes.holes(25), 40, 0),
    ("sheet with holes", meshes.holes(25), 50, 0),
    ("two parts", meshes.two_components(), 30, 0),
    ("two parts", meshes.two_components(), 40, 1),
    ("double torus", meshes.double_torus(), 30, 0),
]


@pytest.mark.parametrize(
    ("arrays", "count", "seed"), [c[1:] for c in SOLVABLE], ids=[f"{c[0]} {c[2]}" for c in SOLVABLE]
)
def test_the_number_stays_and_the_topology_is_the_surfaces(arrays: meshes.Arrays, count: int, seed: int) -> None:
    graph = graph_of(arrays)
    plain = sb.centroidal_voronoi(graph, count=count, max_iterations=30, seed=seed)
    assert plain.cells.dual("strict").issues  # else there is nothing to test
    assert plain.exchanged == 0 and plain.issues == []
    closed = sb.centroidal_voronoi(graph, count=count, max_iterations=30, seed=seed, closed_ball=True)
    assert closed.issues == [] and closed.exchanged > 0
    dual = closed.cells.dual("strict")
    assert len(dual.vertices) == count and len(np.unique(dual.triangles)) == count
    check_triangulation(fine(arrays), dual)
    assert (np.diff(closed.energy) <= 0).all() and len(closed.energy) == closed.iterations + 1
    assert closed.cells.areas.sum() == pytest.approx(fine(arrays).area, rel=1e-9)


IMPOSSIBLE = [
    ("torus", meshes.torus(60, 24), 3),  # seven vertices are the least
    ("annulus", meshes.cylinder(48, 12, 1.0, 0.5), 2),
    ("ball", meshes.icosphere(3), 3),
    ("two parts", meshes.two_components(), 8),
]


@pytest.mark.parametrize(("arrays", "count"), [c[1:] for c in IMPOSSIBLE], ids=[c[0] for c in IMPOSSIBLE])
def test_where_it_cannot_be_the_cells_are_what_they_were_and_it_is_told(arrays: meshes.Arrays, count: int) -> None:
    graph = graph_of(arrays)
    plain = sb.centroidal_voronoi(graph, count=count, max_iterations=20, seed=1)
    closed = sb.centroidal_voronoi(graph, count=count, max_iterations=20, seed=1, closed_ball=True)
    np.testing.assert_array_equal(closed.sites.faces, plain.sites.faces)
    np.testing.assert_array_equal(closed.sites.barycentric, plain.sites.barycentric)
    np.testing.assert_array_equal(closed.energy, plain.energy)
    assert (closed.iterations, closed.stop_reason) == (plain.iterations, plain.stop_reason)
    assert closed.exchanged == 0
    assert [str(i) for i in closed.issues] == [str(i) for i in plain.cells.dual("strict").issues] != []
    check_triangulation(fine(arrays), closed.cells.dual("repair"))  # which adds some, as ever


def test_where_nothing_is_wrong_nothing_is_done() -> None:
    graph = graph_of(meshes.torus(60, 24))
    plain = sb.centroidal_voronoi(graph, count=60, max_iterations=20)
    closed = sb.centroidal_voronoi(graph, count=60, max_iterations=20, closed_ball=True)
    assert closed.exchanged == 0 and closed.issues == []
    np.testing.assert_array_equal(closed.energy, plain.energy)
    np.testing.assert_array_equal(closed.sites.barycentric, plain.sites.barycentric)


def test_the_same_for_any_number_of_threads_and_powers_of_two() -> None:
    vertices, triangles = needle()
    first = None
    for threads, size in ((1, 1.0), (2, 1.0), (8, 1.0), (1, 2.0**-10), (1, 2.0**10)):
        graph = sb.SaddleVertexGraph(sb.Mesh(vertices * size, triangles), k=60)
        made = sb.centroidal_voronoi(graph, count=60, max_iterations=30, closed_ball=True, threads=threads)
        assert made.exchanged > 0 and made.issues == []
        told = (made.sites.faces.tobytes(), made.sites.barycentric.tobytes(), made.exchanged, made.iterations)
        first = first or told
        assert told == first


def test_fixed_sites_stay_and_are_never_the_ones_to_go() -> None:
    graph = graph_of(needle())
    mesh = fine(needle())
    start = sb.centroidal_voronoi(graph, count=60, max_iterations=20).sites
    for fixed in (np.arange(0, 50), np.arange(0, 60, 2)):
        made = sb.centroidal_voronoi(graph, sites=start, fixed=fixed, max_iterations=20, closed_ball=True)
        moved = np.linalg.norm(made.sites.positions(mesh) - start.positions(mesh), axis=1)
        assert (moved[fixed] == 0).all()
        assert made.exchanged <= 60 - len(fixed)
    all_fixed = sb.centroidal_voronoi(graph, sites=start, fixed=np.arange(60), max_iterations=20, closed_ball=True)
    np.testing.assert_array_equal(all_fixed.sites.barycentric, start.barycentric)
    assert all_fixed.issues and all_fixed.exchanged == 0


def test_sites_on_curves_stay_there() -> None:
    mesh = fine(balls_on_a_string())
    graph = sb.SaddleVertexGraph(mesh, k=60)
    borders = [sb.SurfaceCurve(mesh, loop, closed=True) for loop in mesh.boundary_loops]
    plain = sb.centroidal_voronoi(graph, count=80, curves=borders, max_iterations=20)
    assert plain.cells.dual("strict").issues
    made = sb.centroidal_voronoi(graph, count=80, curves=borders, max_iterations=20, closed_ball=True)
    assert made.exchanged > 0
    height = made.sites.positions(mesh)[:, 2]
    ends = mesh.vertices[:, 2].min(), mesh.vertices[:, 2].max()
    for curve, end in enumerate(ends if height[made.held == 0].max() < ends[1] else ends[::-1]):
        assert (made.held == curve).sum() >= 3
        np.testing.assert_allclose(height[made.held == curve], end, atol=1e-9)
    dual = made.cells.dual("strict")
    check_triangulation(mesh, dual)
    assert len(dual.vertices) == 80


def test_the_paint_is_followed_all_the_same() -> None:
    """Sites leave where they are least needed by the density: four times as many per area above as below."""
    mesh = fine(needle())
    graph = sb.SaddleVertexGraph(mesh, k=60)
    paint = np.where(mesh.vertices[:, 2] > 0, 4.0, 1.0)
    plain, closed = (
        sb.centroidal_voronoi(graph, count=120, density=paint, max_iterations=30, closed_ball=wanted)
        for wanted in (False, True)
    )
    assert plain.cells.dual("strict").issues and not closed.issues and closed.exchanged > 0
    above = [int((made.sites.positions(mesh)[:, 2] > 0).sum()) for made in (plain, closed)]
    assert above[0] == pytest.approx(96, abs=4)
    assert abs(above[1] - above[0]) <= closed.exchanged
    assert closed.normalized_energy < 1.15 * plain.normalized_energy


def test_of_several_starts_one_without_faults_is_taken() -> None:
    graph = graph_of(meshes.two_components())
    each = [sb.centroidal_voronoi(graph, count=24, max_iterations=15, closed_ball=True, seed=seed) for seed in (0, 1)]
    assert each[1].issues and each[1].energy[-1] < each[0].energy[-1]
    made = sb.centroidal_voronoi(graph, count=24, max_iterations=15, closed_ball=True, starts=2)
    assert made.issues == []
    np.testing.assert_array_equal(made.sites.barycentric, each[0].sites.barycentric)


def test_without_iterations_only_what_was_moved_settles() -> None:
    graph = graph_of(needle())
    start = sb.centroidal_voronoi(graph, count=60, max_iterations=30).sites
    made = sb.centroidal_voronoi(graph, sites=start, max_iterations=0, closed_ball=True)
    assert made.issues == [] and 0 < made.exchanged < 20 and made.iterations == 0
    stayed = (made.sites.barycentric == start.barycentric).all(axis=1) & (made.sites.faces == start.faces)
    assert stayed.sum() == 60 - made.exchanged


def test_it_can_be_watched_and_stopped() -> None:
    graph = graph_of(needle())

    def call(job: sb.Job) -> object:
        return sb.centroidal_voronoi(
            graph, count=200, max_iterations=400, tolerance=0, start="sample", closed_ball=True, job=job
        )

    for fraction in (0.2, 0.7):
        check_progress_and_cancel(call, fraction)


def test_stopped_it_returns_cells_whose_dual_is_whole_or_those_before() -> None:
    graph = graph_of(needle())
    watch, job = sb.RelaxationWatch(), sb.Job()

    def stop() -> None:
        most = 0
        while not ended.is_set():
            step = watch.latest()
            if step is not None and step.iterations < most:  # it has begun again, after the exchange
                job.cancel()
            most = max(most, 0 if step is None else step.iterations)
            time.sleep(0.001)

    ended = threading.Event()
    stopper = threading.Thread(target=stop)
    stopper.start()
    made = sb.centroidal_voronoi(
        graph, count=120, max_iterations=3000, tolerance=0, start="sample", closed_ball=True,
        return_when_cancelled=True, watch=watch, job=job,
    )  # fmt: skip
    ended.set()
    stopper.join()
    assert made.stop_reason == "cancelled"
    assert made.exchanged > 0 and made.issues == []
    last = watch.latest()
    assert last is not None
    np.testing.assert_array_equal(last.sites.barycentric, made.sites.barycentric)
    assert (last.iterations, last.energy) == (made.iterations, made.energy[-1])


def test_a_dual_of_the_number_is_the_surfaces_in_figures() -> None:
    """Exchanging a few sites costs little: as even as before but for what the thin ends need."""
    mesh = fine(balls_on_a_string())
    graph = sb.SaddleVertexGraph(mesh, k=60)
    qualities = []
    for wanted in (False, True):
        made = sb.centroidal_voronoi(graph, count=80, max_iterations=60, closed_ball=wanted, seed=1)
        dual = made.cells.dual("strict")
        qualities.append(sb.triangle_quality(dual.vertices, dual.triangles).mean_quality)
    assert qualities[1] > qualities[0] - 0.03
    assert characteristic(sb.Mesh(dual.vertices, dual.triangles)) == characteristic(mesh) == 0

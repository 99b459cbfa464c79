# SPDX-License-Identifier: MIT
"""The graph's distances: closed forms, an exact library, the axioms of a metric."""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_progress_and_cancel
from tests.native.exact import exact_distances, random_points, with_vertex_at

# Arc lengths are kept in single precision: distances may fall short of the exact ones by its rounding and no more.
SINGLE = 2e-7
FINE = [meshes.Case("a fine torus", *meshes.torus(90, 40)), meshes.Case("a fine sphere", *meshes.icosphere(4))]
SMALL = [case for case in meshes.good() if len(case.vertices) <= 1200 and case.components == 1]


@pytest.mark.parametrize("case", SMALL, ids=str)
def test_a_graph_of_whole_disks_is_exact(case: meshes.Case) -> None:
    """A shortest path is a chain of straight geodesics that bends at saddle vertices: with unlimited disks, exact."""
    graph = sb.SaddleVertexGraph(case.mesh, k=len(case.vertices))
    for source in (0, len(case.vertices) // 2):
        np.testing.assert_allclose(graph.distances([source]), exact_distances(case.mesh, source), rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("case", SMALL, ids=str)
def test_distances_are_never_too_short_and_little_too_long(case: meshes.Case) -> None:
    exact = exact_distances(case.mesh, 1)
    found = sb.SaddleVertexGraph(case.mesh, k=min(50, len(case.vertices))).distances([1])
    assert np.array_equal(np.isinf(found), np.isinf(exact))
    far = np.isfinite(exact) & (exact > 0)
    error = found[far] / exact[far] - 1
    assert error.min() >= -SINGLE
    # On needles 50 vertices are a thin strip: k says nothing of accuracy there, and only a larger one helps.
    assert error.mean() <= (0.006 if case.name != "needles" else 0.1)


@pytest.mark.parametrize("accuracy", [2e-2, 5e-3, 2e-3])
@pytest.mark.parametrize("case", [*SMALL, *FINE], ids=str)
def test_errors_stay_below_the_accuracy(case: meshes.Case, accuracy: float) -> None:
    graph = sb.SaddleVertexGraph(case.mesh, accuracy=accuracy)
    for source in (1, len(case.vertices) // 2):
        exact = np.asarray(sb.exact_distances(case.mesh, [source]))
        far = np.isfinite(exact) & (exact > 0)
        error = graph.distances([source])[far] / exact[far] - 1
        assert error.min() >= -SINGLE
        assert error.max() <= accuracy
        assert error.mean() <= accuracy / 3


@pytest.mark.parametrize("accuracy", [2e-2, 5e-3, 2e-3])
@pytest.mark.parametrize("stretch", [3.0, 5.0])
def test_errors_stay_below_the_accuracy_on_wavy_lattices(stretch: float, accuracy: float) -> None:
    vertices, triangles = meshes.grid(60, 60)
    vertices = vertices * [60 * stretch, 60, 1]
    vertices[:, 2] = np.sin(0.12 * vertices[:, 0]) * np.cos(0.2 * vertices[:, 1])
    mesh = sb.Mesh(vertices, triangles)
    graph = sb.SaddleVertexGraph(mesh, accuracy=accuracy)
    for source in (0, 1830):
        exact = np.asarray(sb.exact_distances(mesh, [source]))
        far = exact > 0
        assert (graph.distances([source])[far] / exact[far] - 1).max() <= accuracy


@pytest.mark.parametrize("accuracy", [2e-2, 5e-3, 2e-3])
@pytest.mark.parametrize("stretch", [1.0, 2.0, 3.0, 4.0, 10.0])
def test_errors_stay_below_the_accuracy_on_lattices(stretch: float, accuracy: float) -> None:
    """What follows an arc has the same detour again there: nothing averages out."""
    vertices, triangles = meshes.grid(60, 60)
    vertices = vertices * [stretch, 1, 1]
    graph = sb.SaddleVertexGraph(sb.Mesh(vertices, triangles), accuracy=accuracy)
    for source in (0, 1830, 2222):
        exact = np.linalg.norm(vertices - vertices[source], axis=1)
        far = exact > 0
        error = graph.distances([source])[far] / exact[far] - 1
        assert error.max() <= accuracy
        assert error.mean() <= accuracy / 4


@pytest.mark.parametrize(
    ("around", "tube", "tube_radius", "sources"), [(92, 10, 0.58, (1, 4, 9)), (66, 30, 0.24, (2, 10, 20))]
)
def test_errors_of_fine_graphs_stay_below_the_accuracy(
    around: int, tube: int, tube_radius: float, sources: tuple[int, ...]
) -> None:
    """Tori of stretched cells, where many small detours add up."""
    expect_accuracy(sb.Mesh(*meshes.torus(around, tube, 1.0, tube_radius)), sources, 1e-3)


@pytest.mark.parametrize("accuracy", [5e-3, 1e-3])
@pytest.mark.parametrize(("around", "tube", "tube_radius"), [(114, 13, 0.33), (80, 11, 0.35), (94, 35, 0.61)])
def test_errors_along_strips_between_saddles_stay_below_the_accuracy(
    around: int, tube: int, tube_radius: float, accuracy: float
) -> None:
    """An odd number of rows leaves a flat ring, one cell wide, between the two inmost ones."""
    mesh = sb.Mesh(*meshes.torus(around, tube, 1.0, tube_radius))
    expect_accuracy(mesh, range(tube // 2 - 1, tube // 2 + 3), accuracy)


@pytest.mark.parametrize(
    ("radii", "steps", "around", "accuracy"),
    [
        ((0.762, 0.66, 0.632, 0.705, 0.705, 0.705), (0.297, 0.391, 0.024, 0.096, 0.279), 108, 5e-3),
        ((0.82, 0.82, 0.803, 0.89, 0.766), (0.288, 0.051, 0.052, 0.208), 123, 1e-3),
        ((0.605, 0.804, 0.554, 0.566, 0.566), (0.073, 0.07, 0.365, 0.191), 103, 1e-3),
    ],
)
def test_errors_on_lathed_cylinders_stay_below_the_accuracy(
    radii: tuple[float, ...], steps: tuple[float, ...], around: int, accuracy: float
) -> None:
    """One ring of long faces between rims, or up to the border."""
    mesh = sb.Mesh(*meshes.lathed(radii, steps, around))
    expect_accuracy(mesh, range(0, len(mesh.vertices), around), accuracy)


def expect_accuracy(mesh: sb.Mesh, sources: Iterable[int], accuracy: float) -> None:
    graph = sb.SaddleVertexGraph(mesh, accuracy=accuracy)
    for source in sources:
        exact = np.asarray(sb.exact_distances(mesh, [source]))
        far = exact > 0
        assert (graph.distances([source])[far] / exact[far] - 1).max() <= accuracy


@pytest.mark.parametrize("case", SMALL, ids=str)
def test_the_exact_graph_is_exact(case: meshes.Case) -> None:
    graph = sb.SaddleVertexGraph(case.mesh, exact=True)
    for source in (0, len(case.vertices) // 2):
        exact = np.asarray(sb.exact_distances(case.mesh, [source]))
        np.testing.assert_allclose(graph.distances([source]), exact, rtol=2e-9, atol=1e-12)


def test_an_exact_graph_beyond_the_memory_is_refused() -> None:
    """On a sphere all vertices see each other: 164,000 of them would take 450 GB."""
    with pytest.raises(sb.InputError, match=r"exact: the exact graph of 163842 vertices needs about \d+\.?\d* GB and"):
        sb.SaddleVertexGraph(sb.Mesh(*meshes.icosphere(7)), exact=True)


def test_disks_end_where_few_vertices_are_in_sight() -> None:
    """Spikes hide all but some thirty neighbors: bounds by edges end what is in sight but not by a shortest way."""
    vertices, triangles = meshes.spikes()
    mesh = sb.Mesh(vertices, triangles)
    graph, all_in_sight = sb.SaddleVertexGraph(mesh, k=200), sb.SaddleVertexGraph(mesh, exact=True)
    assert graph.mean_degree < 1.05 * all_in_sight.mean_degree
    for source in (0, len(vertices) // 2):
        exact = np.asarray(sb.exact_distances(mesh, [source]))
        np.testing.assert_allclose(graph.distances([source]), exact, rtol=1e-3)


def mean_error(vertices: np.ndarray, triangles: np.ndarray, expected: np.ndarray, source: int) -> float:
    found = sb.SaddleVertexGraph(sb.Mesh(vertices, triangles), k=50).distances([source])
    away = expected > 0
    return float(np.abs(found[away] / expected[away] - 1).mean())


@pytest.mark.parametrize("source", [0, 37, 60 * 30 + 30])
def test_plane(source: int) -> None:
    vertices, triangles = meshes.grid(60, 60)
    assert mean_error(vertices, triangles, np.linalg.norm(vertices - vertices[source], axis=1), source) <= 0.006


def test_sphere() -> None:
    vertices, triangles = meshes.icosphere(5)
    angle = np.arccos(np.clip(vertices @ vertices[0], -1, 1))
    assert mean_error(vertices, triangles, angle, 0) <= 0.006


def test_cylinder() -> None:
    """Unrolled, a prism of many sides is a strip: the shorter way round counts."""
    around, radius = 96, 1.0
    vertices, triangles = meshes.cylinder(around, 60, radius, 4.0)
    side = 2 * radius * np.sin(np.pi / around) * around
    turn = np.arctan2(vertices[:, 1], vertices[:, 0])
    source = len(vertices) // 2
    gap = np.abs((turn - turn[source] + np.pi) % (2 * np.pi) - np.pi) / (2 * np.pi) * side
    assert mean_error(vertices, triangles, np.hypot(gap, vertices[:, 2] - vertices[source, 2]), source) <= 0.006


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_it_is_a_metric(case: meshes.Case) -> None:
    graph = sb.SaddleVertexGraph(case.mesh, k=min(20, len(case.vertices)))
    rng = np.random.default_rng(1)
    chosen = rng.choice(len(case.vertices), min(40, len(case.vertices)), replace=False)
    table = np.array([graph.distances([v])[chosen] for v in chosen])
    assert np.array_equal(table, table.T)  # to the bit
    assert np.array_equal(table == 0, np.eye(len(chosen), dtype=bool))
    detour = (table[:, :, None] + table[None, :, :]).min(axis=1)
    finite = np.isfinite(table)
    assert (table[finite] <= detour[finite] * (1 + 1e-12)).all()


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_both_methods_return_the_same_bits(case: meshes.Case) -> None:
    graph = sb.SaddleVertexGraph(case.mesh, k=min(30, len(case.vertices)))
    sources = random_points(case.mesh, 5)
    buckets = graph.nearest(sources, method="label_correcting")
    heap = graph.nearest(sources, method="dijkstra")
    assert np.array_equal(buckets[0], heap[0])
    assert np.array_equal(buckets[1], heap[1])


def test_another_component_is_infinitely_far() -> None:
    mesh = sb.Mesh(*meshes.two_components())
    distances, source = sb.SaddleVertexGraph(mesh, k=20).nearest([0])
    reached = np.isfinite(distances)
    assert 0 < reached.sum() < len(reached)
    assert (source[reached] == 0).all()
    assert (source[~reached] == -1).all()


def test_nearest_is_the_least_of_the_fields_and_ties_go_to_the_smaller() -> None:
    mesh = sb.Mesh(*meshes.torus())
    graph = sb.SaddleVertexGraph(mesh, k=30)
    sources = np.array([5, 100, 100, 300])  # one twice
    fields = np.array([graph.distances([s]) for s in sources])
    distance, nearest = graph.nearest(sources)
    assert np.array_equal(distance, fields.min(axis=0))
    assert np.array_equal(nearest, fields.argmin(axis=0))
    assert 2 not in nearest


def test_limit_leaves_what_is_farther() -> None:
    graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.torus()), k=30)
    whole, part = graph.distances([7]), graph.distances([7], limit=0.8)
    assert np.array_equal(part, np.where(whole <= 0.8, whole, np.inf))


@pytest.mark.parametrize("case", SMALL, ids=str)
def test_sources_inside_faces(case: meshes.Case) -> None:
    point = random_points(case.mesh, 1, seed=3)
    exact = exact_distances(with_vertex_at(case.mesh, point), len(case.vertices))[:-1]
    found = sb.SaddleVertexGraph(case.mesh, k=len(case.vertices)).distances(point)
    np.testing.assert_allclose(found, exact, rtol=1e-6, atol=1e-9)


def test_sources_on_edges_and_vertices() -> None:
    mesh = sb.Mesh(*meshes.grid(9, 9))
    graph = sb.SaddleVertexGraph(mesh, k=81)
    points = sb.SurfacePoints([3, 3, 40, 40], [[0.5, 0.5, 0], [0, 0.25, 0.75], [0, 1, 0], [0.3, 0, 0.7]])
    for i in range(len(points)):
        expected = np.linalg.norm(mesh.vertices - points[i : i + 1].positions(mesh), axis=1)
        np.testing.assert_allclose(graph.distances(points[i : i + 1]), expected, rtol=1e-6, atol=1e-9)


def test_larger_disks_are_more_accurate() -> None:
    mesh = sb.Mesh(*meshes.torus(60, 24))
    exact = exact_distances(mesh, 0)[1:]
    errors = [(sb.SaddleVertexGraph(mesh, k=k).distances([0])[1:] / exact - 1).mean() for k in (5, 20, 80, 320)]
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < errors[0] / 10


@pytest.mark.parametrize("scale", [1e-40, 1e-9, 1e9, 1e40])
def test_scale_changes_nothing_else(scale: float) -> None:
    vertices, triangles = meshes.torus()
    small = sb.SaddleVertexGraph(sb.Mesh(vertices, triangles), k=20).distances([0])
    large = sb.SaddleVertexGraph(sb.Mesh(vertices * scale, triangles), k=20).distances([0])
    np.testing.assert_allclose(large / scale, small, rtol=1e-6)


def arcs_of(graph: sb.SaddleVertexGraph, folder: Path) -> bytes:
    """Orders, degrees and arcs; the header before them says how long the build took."""
    graph.save(folder / "graph.svg")
    return (folder / "graph.svg").read_bytes()[96:-4]


HOWS = [{"k": 30}, {"accuracy": 5e-3}, {"exact": True}]


@pytest.mark.parametrize("how", HOWS, ids=str)
def test_the_same_for_any_number_of_threads(how: dict[str, object], tmp_path: Path) -> None:
    mesh = sb.Mesh(*meshes.torus(60, 24) if "exact" not in how else meshes.torus(24, 12))
    built = [arcs_of(sb.SaddleVertexGraph(mesh, threads=threads, **how), tmp_path) for threads in (1, 2, 8)]
    assert built[0] == built[1] == built[2]


@pytest.mark.parametrize("how", HOWS[:2], ids=str)
@pytest.mark.parametrize("case", [*meshes.good(), *FINE], ids=str)
def test_the_same_for_any_instruction_set(case: meshes.Case, how: dict[str, object], tmp_path: Path) -> None:
    how = {name: min(value, len(case.vertices)) for name, value in how.items()}
    expected = arcs_of(sb.SaddleVertexGraph(case.mesh, **how), tmp_path)
    for instructions in ("avx512", "avx2", "neon", "plain"):
        try:
            graph = sb.SaddleVertexGraph(case.mesh, instructions=instructions, **how)
        except sb.InputError:  # not on this machine
            continue
        assert arcs_of(graph, tmp_path) == expected, instructions


OLD_PROCESSOR = """
import saddleback as sb
from tests.digests import main
try:
    sb.SaddleVertexGraph(sb.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]), k=3, instructions="avx2")
except sb.InputError:
    raise SystemExit(main())
"""


@pytest.mark.skipif(
    platform.machine() != "x86_64" or not shutil.which("qemu-x86_64-static"),
    reason="older processors are emulated by qemu-user-static, on x86-64",
)
def test_a_processor_without_avx_answers_the_same() -> None:
    """Nothing that is compiled for newer ones may run there, in whichever file the linker found it."""
    qemu = ["qemu-x86_64-static", "-cpu", "Nehalem", sys.executable, "-c", OLD_PROCESSOR]
    options = ["--portable", "--threads", "1", "--only", "icosphere/"]
    root = Path(__file__).resolve().parents[3]
    own = {name: value for name, value in os.environ.items() if name != "OPENBLAS_CORETYPE"}  # of the real processor
    done = subprocess.run(
        [*qemu, *options], cwd=root, env=own, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, f"{done.returncode}: {done.stdout}{done.stderr}"
    assert " 0 of them different" in done.stdout


def test_progress_rises_and_cancel_is_quick() -> None:
    mesh = sb.Mesh(*meshes.icosphere(6))
    check_progress_and_cancel(lambda job: sb.SaddleVertexGraph(mesh, k=200, job=job), 0.02)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"k": 0}, "k: wanted at least 1"),
        ({"k": 1000}, "1000 vertices per geodesic disk are more than the mesh has"),
        ({"k": 2.5}, "k"),
        ({"k": -3}, "k: wanted at least 1"),
        ({"accuracy": 0}, "accuracy: wanted a relative error above 0"),
        ({"accuracy": -0.1}, "accuracy: wanted a relative error above 0"),
        ({"accuracy": 1.0}, "accuracy: wanted a relative error above 0"),
        ({"accuracy": float("nan")}, "accuracy"),
        ({"k": 4, "accuracy": 0.01}, "k, accuracy, exact: give one"),
        ({"k": 4, "exact": True}, "k, accuracy, exact: give one"),
        ({"accuracy": 0.01, "exact": True}, "k, accuracy, exact: give one"),
        ({"instructions": "abacus"}, "instructions: this machine runs 'auto'.*not 'abacus'"),
        ({"threads": -1}, "threads"),
        ({"device": "abacus"}, "abacus"),
    ],
)
def test_bad_options(arguments: dict[str, object], words: str) -> None:
    with pytest.raises(sb.InputError, match=words):
        sb.SaddleVertexGraph(sb.Mesh(*meshes.cube()), **arguments)


def test_a_graph_says_how_it_was_built() -> None:
    mesh = sb.Mesh(*meshes.torus())
    built = [sb.SaddleVertexGraph(mesh, **how) for how in ({}, {"accuracy": 0.02}, {"k": 20}, {"exact": True})]
    assert [graph.accuracy for graph in built] == [5e-3, 0.02, None, None]
    assert [graph.k for graph in built] == [None, None, 20, None]
    assert [graph.is_exact for graph in built] == [False, False, False, True]
    assert ["accuracy=0.005" in repr(built[0]), "k=20" in repr(built[2]), "exact" in repr(built[3])] == [True] * 3


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (([],), "sources"),
        (([99],), "99"),
        (([-1],), "-1"),
        (([0.5],), "sources"),
        (([0], -1.0), "limit"),
        (([0], float("nan")), "limit"),
        (([0], 1.0, "guess"), "guess"),
        ((sb.SurfacePoints([500], [[1, 0, 0]]),), "500"),
    ],
)
def test_bad_queries(arguments: tuple[object, ...], words: str) -> None:
    graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.cube()), k=8)
    with pytest.raises(sb.InputError, match=words):
        graph.distances(*arguments)
    with pytest.raises(sb.InputError, match=words):
        graph.nearest(*arguments)


def test_the_graph_keeps_its_mesh_alive() -> None:
    graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.torus()), k=10)
    assert np.isfinite(graph.distances([0])).all()
    assert graph.arc_count == round(graph.mean_degree * 36 * 14)
    assert 8 * graph.arc_count <= graph.nbytes <= 8 * graph.arc_count + 20 * 36 * 14
    assert graph.k == 10
    assert graph.device == "cpu"
    assert graph.build_seconds > 0

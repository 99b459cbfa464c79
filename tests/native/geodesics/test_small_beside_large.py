# SPDX-License-Identifier: MIT
"""Graphs of meshes whose parts or edges differ by up to twelve orders of magnitude."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import Delaunay

import saddleback as sb
from tests import meshes

RATIOS = [10.0**-power for power in range(3, 15)]
ACCURACY = 5e-3
# Lengths near the shortest edge's keep 24 bits.
ROUNDING = 1e-7


def checked_path(graph: sb.SaddleVertexGraph, source: int, target: int) -> float:
    """A path's length, which is its polyline's and the distance."""
    path = graph.path(source, target)
    steps = sum(float(np.linalg.norm(b - a)) for a, b in pairwise(path.points))
    assert steps == pytest.approx(path.length, rel=1e-9)
    assert path.length == pytest.approx(graph.distance(source, target), rel=ROUNDING)
    return path.length


def beside(small: meshes.Arrays, large: meshes.Arrays, ratio: float) -> sb.Mesh:
    return sb.Mesh(*meshes.merge((small[0] * ratio, small[1]), (large[0] + [5.0, 0, 0], large[1])))


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("rule", [{}, {"k": 20}, {"exact": True}])
def test_a_part_is_measured_as_alone(ratio: float, rule: dict[str, int]) -> None:
    small, large = meshes.torus(18, 9), meshes.icosphere(2)
    alone, both = sb.Mesh(*small), beside(small, large, ratio)
    graph, reference = sb.SaddleVertexGraph(both, **rule), sb.SaddleVertexGraph(alone, **rule)
    count = alone.vertex_count
    for source in (0, 77):
        found, right = graph.distances(source), reference.distances(source)
        assert np.isinf(found[count:]).all()
        np.testing.assert_allclose(found[:count] / ratio, right, rtol=ROUNDING if "k" in rule else ACCURACY)
    exact = sb.exact_distances(alone, 0)
    assert checked_path(graph, 0, count // 2) / ratio == pytest.approx(exact[count // 2], rel=0.02)
    sites = [0, 50, 110, count, count + 100]
    cells = sb.geodesic_voronoi(graph, sites)
    right_cells = sb.geodesic_voronoi(reference, sites[:3])
    np.testing.assert_allclose(cells.areas[:3] / ratio**2, right_cells.areas, rtol=0.02)
    assert cells.areas[3:].sum() == pytest.approx(sb.Mesh(*large).area)


def test_a_part_has_as_many_arcs_as_alone() -> None:
    """Bounds that are meant for mean edges do not keep windows where all edges are far shorter."""
    small, large = meshes.icosphere(3), meshes.icosphere(2)
    alone = sb.SaddleVertexGraph(sb.Mesh(*small)).arc_count + sb.SaddleVertexGraph(sb.Mesh(*large)).arc_count
    for ratio in RATIOS:
        assert sb.SaddleVertexGraph(beside(small, large, ratio)).arc_count == pytest.approx(alone, rel=0.1)


def square_with_cluster(spacing: float, count: int, seed: int) -> sb.Mesh:
    """A square of side 2 about a square `spacing` times smaller, with `count` vertices inside; flat."""
    rng = np.random.default_rng(seed)
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], dtype=float)
    inside = Delaunay(np.vstack([corners, rng.uniform(-0.9, 0.9, (count, 2))]))
    points = np.vstack([inside.points * spacing, corners])
    outer = range(len(points) - 4, len(points))
    frame = [(a, b, c) for i in range(4) for a, b, c in ((outer[i], outer[i - 3], i), (outer[i - 3], (i + 1) % 4, i))]
    triangles = np.vstack([inside.simplices, frame]).astype(np.int32)
    return sb.Mesh(np.column_stack([points, np.zeros(len(points))]), triangles)


@pytest.mark.parametrize("spacing", RATIOS[:9])
@pytest.mark.parametrize("count", [1, 5, 20])
def test_near_coincident_vertices(spacing: float, count: int) -> None:
    """On a flat square every distance and path is Euclid's within the accuracy, however near vertices are."""
    for seed in range(3):
        mesh = square_with_cluster(spacing, count, seed)
        graph = sb.SaddleVertexGraph(mesh, accuracy=ACCURACY)
        last = mesh.vertex_count - 1
        for source in (0, last, last - 4):
            right = np.linalg.norm(mesh.vertices - mesh.vertices[source], axis=1)
            found = graph.distances(source)
            assert (found >= right * (1 - ROUNDING)).all()
            assert (found <= right * (1 + ACCURACY)).all()
            for target in range(mesh.vertex_count):
                checked_path(graph, source, target)
        cells = sb.geodesic_voronoi(graph, [0, last, last - 4])
        assert cells.areas.sum() == pytest.approx(mesh.area)


@pytest.mark.parametrize("ratio", RATIOS[::3])
def test_methods_agree_to_the_bit(ratio: float) -> None:
    mesh = sb.Mesh(*meshes.graded_disk(ratio, rings=20, around=12))
    one = sb.SaddleVertexGraph(mesh, threads=1)
    two = sb.SaddleVertexGraph(mesh, threads=2)
    sources = np.array([0, 50, mesh.vertex_count - 1], dtype=np.int32)
    assert (one.fields(sources) == two.fields(sources)).all()
    for source in sources:
        found = one.distances(int(source))
        assert (found == one.distances(int(source), method="dijkstra")).all()
        for target in (1, 100, mesh.vertex_count - 5):
            assert one.distance(int(source), target) == found[target]
            assert one.distances(target)[source] == pytest.approx(found[target], rel=1e-15)
    distance, which = one.nearest(sources)
    fields = one.fields(sources)
    assert (distance == fields.min(axis=0)).all()
    assert (which == fields.argmin(axis=0)).all()


def test_files_hold_such_graphs(tmp_path: Path) -> None:
    for ratio in RATIOS:
        mesh = beside(meshes.icosphere(1), meshes.tetrahedron(), ratio)
        graph = sb.SaddleVertexGraph(mesh)
        graph.save(tmp_path / "graph")
        again = sb.SaddleVertexGraph.load(tmp_path / "graph", mesh)
        assert (again.distances(0) == graph.distances(0)).all()


def test_what_no_graph_holds_is_refused() -> None:
    mesh = beside(meshes.icosphere(1), meshes.tetrahedron(), 1e-20)
    with pytest.raises(sb.InputError, match=r"its shortest edge \(.*\) is so small a part of its longest paths"):
        sb.SaddleVertexGraph(mesh)


def test_disks_of_needle_rings_are_right() -> None:
    """By count a ring's disks are small, and what lies beyond the needles belongs to none."""
    for around in (500, 4000):
        mesh = sb.Mesh(*meshes.cylinder(around, 2, height=50.0))
        graph = sb.SaddleVertexGraph(mesh, k=50)
        found = graph.distances(0)
        step = 2 * np.sin(np.pi / around)
        steps = np.minimum(np.arange(around), around - np.arange(around))
        np.testing.assert_allclose(found[:around], step * steps, rtol=1e-6)

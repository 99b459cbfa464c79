# SPDX-License-Identifier: MIT
"""Rings of needles, fans and ribbons, which windows cross at once: right, alike everywhere, and fast."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.meshes import Arrays

Lines = meshes.Floats


def between(first: Lines, second: Lines, *, closed: bool) -> Arrays:
    """Two lines joined by triangles; which goes on next is told by its share of the way."""
    n, m = len(first), len(second)
    ends = (n, m) if closed else (n - 1, m - 1)
    triangles, i, j = [], 0, 0
    while i < ends[0] or j < ends[1]:
        if j == ends[1] or (i < ends[0] and (i + 1) / ends[0] <= (j + 1) / ends[1]):
            triangles.append([i % n, (i + 1) % n, n + j % m])
            i += 1
        else:
            triangles.append([i % n, n + (j + 1) % m, n + j % m])
            j += 1
    return np.vstack([first, second]), np.array(triangles, dtype=np.int32)


def circle(count: int, radius: float, height: float, turned: float = 0.0, wave: float = 0.0) -> Lines:
    angles = turned + 2 * np.pi * np.arange(count) / count
    radii = radius * (1 + wave * np.cos(3 * angles))
    return np.column_stack([radii * np.cos(angles), radii * np.sin(angles), np.full(count, height)])


def fan(count: int, height: float = 0.0, wave: float = 0.0) -> Arrays:
    rim = circle(count, 1.0, 0.0, wave=wave)
    along = np.arange(count, dtype=np.int32)
    return np.vstack([rim, [0, 0, height]]), np.column_stack([along, np.roll(along, -1), np.full_like(along, count)])


def ring(count: int, height: float) -> Arrays:
    return between(circle(count, 1.0, 0.0), circle(count, 1.0, height), closed=True)


def ribbon(count: int, bend: float, width: float) -> Arrays:
    """A flat annulus' sector: its inner border is hidden behind itself."""
    inner, outer = (
        np.column_stack([r * np.sin(a), r * np.cos(a), 0 * a])
        for r, a in ((1.0, np.linspace(0, bend, count)), (1.0 + width, np.linspace(0, bend, count // 2)))
    )
    return between(inner, outer, closed=False)


STRIPS: dict[str, Callable[[], Arrays]] = {
    "tall ring": lambda: ring(200, 50.0),
    "ring": lambda: ring(200, 1.0),
    "flat ring": lambda: ring(200, 0.05),
    "twisted ring": lambda: between(circle(150, 1.0, 0.0), circle(150, 1.0, 2.0, turned=2.0), closed=True),
    "lampshade": lambda: between(circle(190, 1.0, 0.0), circle(60, 0.6, 2.0), closed=True),
    "steep lampshade": lambda: between(circle(190, 1.0, 0.0), circle(60, 0.95, 3.0), closed=True),
    "annulus": lambda: between(circle(190, 1.0, 0.0), circle(150, 0.5, 0.0), closed=True),
    "waves": lambda: between(circle(190, 1.0, 0.0, wave=0.2), circle(170, 0.5, 0.3), closed=True),
    "wheel": lambda: fan(300),
    "cone": lambda: fan(300, 1.0),
    "spike": lambda: fan(300, 4.0),
    "flower": lambda: fan(300, 0.4, wave=0.3),
    "ribbon": lambda: ribbon(200, 1.4, 0.3),
    "long ribbon": lambda: ribbon(200, 5.0, 0.2),
    "two": lambda: meshes.merge(ring(100, 1.0), fan(100)),
    "tiny beside large": lambda: meshes.merge(ring(100, 1.0), tuple_scaled(fan(100), 1e-4)),
}


def tuple_scaled(arrays: Arrays, factor: float) -> Arrays:
    return factor * arrays[0] + [5.0, 0, 0], arrays[1]


@pytest.mark.parametrize("name", STRIPS)
def test_distances_on_strips_are_within_the_accuracy(name: str) -> None:
    mesh = sb.Mesh(*STRIPS[name]())
    graph = sb.SaddleVertexGraph(mesh)
    count = mesh.vertex_count
    for source in {0, 1, count // 3, count // 2, count - 2, count - 1}:
        exact = sb.exact_distances(mesh, source)
        reached = np.isfinite(exact) & (exact > 0)
        ratio = graph.distances(source)[reached] / exact[reached]
        assert ratio.min() >= 1 - 1e-9
        assert ratio.max() <= 1 + graph.accuracy


@pytest.mark.parametrize("name", STRIPS)
def test_strips_give_the_same_graph_everywhere(name: str) -> None:
    mesh = sb.Mesh(*STRIPS[name]())
    graphs = [
        sb.SaddleVertexGraph(mesh, threads=threads, instructions=instructions)
        for threads, instructions in ((1, "auto"), (3, "auto"), (1, "plain"))
    ]
    fields = [graph.distances(2) for graph in graphs]
    for graph, field in zip(graphs[1:], fields[1:], strict=True):
        assert graph.arc_count == graphs[0].arc_count
        assert np.array_equal(field, fields[0])


def time_of(mesh: sb.Mesh) -> tuple[float, sb.SaddleVertexGraph]:
    """The least of three CPU times of a build, and what it built."""
    times = []
    for _ in range(3):
        before = time.process_time()
        graph = sb.SaddleVertexGraph(mesh, threads=1)
        times.append(time.process_time() - before)
    return min(times), graph


def test_rings_take_no_longer_a_vertex_when_they_have_more() -> None:
    usual, _ = time_of(sphere := sb.Mesh(*meshes.icosphere(4)))
    for count in (500, 2000, 8000):
        took, _ = time_of(mesh := sb.Mesh(*ring(count // 2, 50.0)))
        assert took / mesh.vertex_count <= 3 * usual / sphere.vertex_count  # mostly once


@pytest.mark.parametrize("make", [lambda n: ring(n // 2, 1.0), fan], ids=["ring", "fan"])
def test_where_accuracy_asks_for_many_arcs_each_takes_as_long_as_elsewhere(make: Callable[[int], Arrays]) -> None:
    usual, usual_graph = time_of(sb.Mesh(*meshes.icosphere(4)))
    took, graph = time_of(sb.Mesh(*make(8000)))
    assert took / graph.arc_count <= 4 * usual / usual_graph.arc_count  # about twice

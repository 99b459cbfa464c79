# SPDX-License-Identifier: MIT
"""Exact distances, log maps and their inverse where vertices or lines nearly coincide: Euclid, unrolled and folded."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes
from tests.truth.distances import exact_by_truth
from tests.truth.families import Arrays, delaunay, square

Floats = NDArray[np.float64]
Random = np.random.Generator
GAPS = [1e-3, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-11]


def twins(rng: Random, gap: float) -> Arrays:
    points = rng.random((int(rng.integers(3, 25)), 2))
    return delaunay(square(np.clip(np.vstack([points, points + gap * rng.normal(size=points.shape)]), 0, 1)))


def on_a_lattice(rng: Random, gap: float) -> Arrays:
    """Nearly in line with one another, in twos and threes."""
    points = rng.integers(1, 8, size=(int(rng.integers(4, 20)), 2)) / 8.0
    moved = points + gap * rng.normal(size=points.shape) * (rng.random((len(points), 1)) < 0.6)
    again = rng.choice(moved, len(moved) // 2) + gap * rng.normal(size=(len(moved) // 2, 2))
    return delaunay(square(np.vstack([moved, again])))


def two_lines(rng: Random, gap: float) -> Arrays:
    along, at = np.sort(rng.random((2, 20)), axis=1), rng.uniform(0.1, 0.9)
    lines = [np.column_stack([along[side], np.full(20, at + side * gap)]) for side in (0, 1)]
    return delaunay(square(np.vstack(lines)[:, :: int(rng.choice([-1, 1]))]))


def moved_columns(rng: Random, gap: float) -> Arrays:
    """A grid of which some vertices lie next to their neighbors."""
    columns, rows = (int(n) for n in rng.integers(3, 9, size=2))
    x, y = np.meshgrid(np.arange(columns), np.arange(rows))
    inside = np.flatnonzero(((x > 0) & (x < columns - 2) & (y > 0) & (y < rows - 1)).ravel())
    vertices = np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()]).astype(float)
    if len(inside):
        vertices[rng.choice(inside, min(5, len(inside)), replace=False), 0] += 1 - gap
    return vertices, meshes.grid(columns, rows)[1]


def clusters(rng: Random, gap: float) -> Arrays:
    points = [gap * rng.normal(size=(6, 2)) + place for place in rng.uniform(0.1, 0.9, (4, 2))]
    wider = [np.sqrt(gap) * 0.1 * rng.normal(size=(4, 2)) + cluster[0] for cluster in points]
    return delaunay(square(np.clip(np.vstack(points + wider), 0, 1)))


def graded_grid(rng: Random, gap: float) -> Arrays:
    steps = [np.append(0, gap ** np.linspace(1, 0, int(rng.integers(3, 10)))) for _ in range(2)]
    x, y = np.meshgrid(*steps)
    return np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()]), meshes.grid(len(steps[0]), len(steps[1]))[1]


FAMILIES = [twins, on_a_lattice, two_lines, moved_columns, clusters, graded_grid]


def assert_exact(found: Floats, expected: Floats, longest: float, share: float = 1e-10) -> None:
    """Rounding is one of the edges that lie between as well."""
    np.testing.assert_array_less(np.abs(found - expected), share * expected + 4e-15 * longest + 1e-300)


@pytest.mark.parametrize("gap", GAPS)
@pytest.mark.parametrize("family", FAMILIES)
def test_a_flat_mesh_knows_euclid(family: Callable[[Random, float], Arrays], gap: float) -> None:
    for seed in range(25):
        rng = np.random.default_rng(seed)
        try:
            mesh = sb.Mesh(*family(rng, gap))
        except sb.MeshError:  # points so near to the border that a face has no area
            continue
        vertices, longest = mesh.vertices, float(np.ptp(mesh.vertices))
        source = int(rng.integers(len(vertices)))
        true = np.linalg.norm(vertices - vertices[source], axis=1)
        assert_exact(sb.exact_distances(mesh, [source]), true, longest)
        assert_exact(sb.exact_nearest(mesh, [source, source])[0], true, longest)
        field = sb.ExactField(mesh, [source])
        faces = rng.integers(len(mesh.triangles), size=6).astype(np.int32)
        inside = sb.SurfacePoints(faces, rng.dirichlet([1, 1, 1], 6))
        straight = np.linalg.norm(inside.positions(mesh) - vertices[source], axis=1)
        assert_exact(field.distance_to(inside), straight, longest)
        assert_exact(np.array([path.length for path in field.paths(inside)]), straight, longest, 2e-9)
        graph = sb.SaddleVertexGraph(mesh, exact=True, threads=1)
        lengths = graph.distances([source])
        assert_exact(lengths, true, 1e4 * longest, 2.5e-10)  # rounded up to 32 bits, and a share of the longest path
        assert (lengths >= true * (1 - 1e-12) - 4e-15 * longest).all()
        found = graph.log_map(source, np.inf)
        assert np.array_equal(found.vertices, np.arange(len(vertices)))
        assert_exact(np.linalg.norm(found.uv, axis=1), true, longest)


@pytest.mark.parametrize("power", [10, 17, 23, 30])
def test_folding_changes_nothing(power: int) -> None:
    """A sheet of two close columns between others, folded along all of them; all coordinates are exact."""
    gap = 2.0**-power
    steps = np.array([1, gap, 1, 0.5, gap, gap, 0.25, 1])
    flat = np.append(0, np.cumsum(steps))
    corners = np.zeros((len(flat), 2))
    for i, step in enumerate(steps):
        corners[i + 1] = corners[i] + step * np.array([(1, 0), (0, 1)][i % 2])
    y = np.arange(7) / 4.0
    across, along = np.meshgrid(np.arange(len(flat)), y)
    vertices = np.column_stack([corners[across.ravel()], along.ravel()])
    mesh = sb.Mesh(vertices, meshes.grid(len(flat), len(y))[1])
    for source in range(0, len(vertices), 5):
        true = np.hypot(flat[across.ravel()] - flat[across.ravel()[source]], along.ravel() - along.ravel()[source])
        assert_exact(sb.exact_distances(mesh, [source]), true, 8.0)


@pytest.mark.parametrize("gap", [1e-4, 1e-6, 1e-8])
def test_bumpy_grids_as_every_straight_line_by_itself(gap: float) -> None:
    for seed in range(4):
        rng = np.random.default_rng(seed)
        vertices, triangles = meshes.grid(5, 5)
        vertices[:, 2] = 0.1 * rng.random(len(vertices))
        for i in rng.choice([6, 7, 11, 12, 16], 3, replace=False):
            vertices[i] = vertices[i + 1] + gap * (vertices[i] - vertices[i + 1])
        mesh = sb.Mesh(vertices, triangles)
        source = int(rng.integers(len(vertices)))
        true = exact_by_truth(vertices, triangles, source)
        assert_exact(sb.exact_distances(mesh, [source]), true, 1.0)
        found = sb.SaddleVertexGraph(mesh, exact=True).log_map(source, np.inf)
        assert_exact(np.linalg.norm(found.uv, axis=1), true, 1.0)


def test_boxes_as_every_straight_line_by_itself() -> None:
    """Closed, with a vertex next to a corner on one of three sides."""
    for gap in (1e-3, 1e-6, 1e-9):
        vertices, triangles = meshes.cube()
        extra = np.array([(gap, gap / 2, 0.0)])
        face = next(
            i
            for i, t in enumerate(triangles)
            if (vertices[t, 2] == 0).all()
            and (vertices[t] == 0).all(1).any()
            and contains(vertices[t, :2], extra[0, :2])
        )
        a, b, c = triangles[face]
        split = np.array([(a, b, 8), (b, c, 8), (c, a, 8)], dtype=np.int32)
        triangles = np.vstack([np.delete(triangles, face, axis=0), split])
        vertices = np.vstack([vertices * (1, 2, 0.5), extra])
        mesh = sb.Mesh(vertices, triangles)
        for source in (0, 3, 8):
            assert_exact(sb.exact_distances(mesh, [source]), exact_by_truth(vertices, triangles, source), 2.0)


def contains(corners: Floats, place: Floats) -> bool:
    u, v = corners[1] - corners[0], corners[2] - corners[0]
    b = np.linalg.solve(np.column_stack([u, v]), place - corners[0])
    return bool((b >= 0).all() and b.sum() <= 1)


def test_an_offset_of_maps_changes_nothing() -> None:
    """Coordinates in meters as surveys give them, here multiples of 2^-20 so that moving them is exact."""
    rng = np.random.default_rng(5)
    vertices, triangles = meshes.grid(15, 15, 0.3)
    vertices = np.round(vertices * (100, 100, 0) * 2**20) / 2**20
    vertices[:, 2] = np.round(rng.random(len(vertices)) * 2**20) / 2**18
    vertices[36:200:9] = vertices[37:201:9] + (2.0**-18, 0, 0)
    moved = vertices + (448_500.0, 5_411_930.0, 312.0)
    for source in (0, 37, 112):
        here, there = (sb.exact_distances(sb.Mesh(v, triangles), [source]) for v in (vertices, moved))
        assert np.array_equal(here, there)


def test_many_close_vertices_leave_nothing_in_the_dark() -> None:
    rng = np.random.default_rng(3)
    along, across = rng.random(400), rng.choice([0.3, 0.3 + 1e-9, 0.3 + 1e-6], 400)
    vertices, triangles = delaunay(square(np.column_stack([along, across])))
    mesh = sb.Mesh(vertices, triangles)
    for source in range(0, len(vertices), 40):
        found = sb.exact_distances(mesh, [source])
        assert_exact(found, np.linalg.norm(vertices - vertices[source], axis=1), 1.0)


# --- along the border -------------------------------------------------------------------------------------------------


def test_a_curve_runs_along_a_border() -> None:
    mesh = sb.Mesh(*meshes.grid(9, 5))
    for direction, length in (((1, 0, 0), 0.7), ((0, 1, 0), 1.0)):
        path = sb.trace(mesh, 0, direction, length)
        assert not path.hit_boundary
        np.testing.assert_allclose(path.points[-1], length * np.array(direction), atol=1e-14)
    path = sb.trace(mesh, 0, (1.0, 0, 0), 2.0)
    assert path.hit_boundary
    assert path.length == pytest.approx(1.0)
    assert len(path.points) == 9
    middle = sb.SurfacePoints([0], [[0.5, 0.5, 0]])
    assert not sb.trace(mesh, middle, (1.0, 0, 0), 0.5).hit_boundary


def test_across_a_border_a_curve_stops() -> None:
    mesh = sb.Mesh(*meshes.grid(5, 5))
    for direction in ((1.0, 0, 0), (0, 1.0, 0), (1.0, 1.0, 0), (2.0, 1.0, 0)):
        assert sb.trace(mesh, 12, direction, 3.0).hit_boundary


def test_a_curve_goes_on_past_a_corner_that_it_touches() -> None:
    """A square without one quarter: the diagonal touches its inner corner."""
    vertices, triangles = meshes.grid(3, 3)
    centers = vertices[triangles].mean(axis=1)
    mesh = sb.Mesh(*meshes.without_unused(vertices, triangles[(centers[:, :2] < 0.5).any(axis=1)]))
    at = {tuple(place): i for i, place in enumerate(mesh.vertices[:, :2].tolist())}
    path = sb.trace(mesh, at[1.0, 0.0], (-1.0, 1.0, 0), np.sqrt(2))
    assert not path.hit_boundary
    np.testing.assert_allclose(path.points[-1], (0, 1, 0), atol=1e-14)
    assert sb.trace(mesh, at[0.0, 0.0], (1.0, 1.0, 0), 1.0).hit_boundary


def test_a_curve_runs_round_a_rim() -> None:
    around = 24
    mesh = sb.Mesh(*meshes.cylinder(around))
    side = 2 * np.sin(np.pi / around)
    path = sb.trace(mesh, 0, mesh.vertices[1] - mesh.vertices[0], (around + 7) * side)
    assert not path.hit_boundary
    np.testing.assert_allclose(path.points[-1], mesh.vertices[7], atol=1e-12)


@pytest.mark.parametrize("jitter", [0.0, 0.3])
def test_exp_undoes_log_from_the_border(jitter: float) -> None:
    mesh = sb.Mesh(*meshes.grid(9, 7, jitter))
    graph = sb.SaddleVertexGraph(mesh)
    border = np.unique(np.concatenate(mesh.boundary_loops))
    for center in border:
        found = graph.log_map(int(center), np.inf)
        assert len(found.vertices) == len(mesh.vertices)
        ends = sb.exp_map(mesh, int(center), found.uv).positions(mesh)
        np.testing.assert_allclose(ends, mesh.vertices[found.vertices], atol=1e-9)
    assert {0, 8} <= set(border.tolist())

# SPDX-License-Identifier: MIT
"""Riemannian centers of points and of cells."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import Delaunay

import saddleback as sb
from tests import meshes
from tests.native.exact import random_points
from tests.truth import families


def test_in_the_plane_it_is_the_mean() -> None:
    mesh = sb.Mesh(*meshes.grid(12, 12, 0.3))
    graph = sb.SaddleVertexGraph(mesh, k=20)
    points = random_points(mesh, 25, seed=4)
    weights = np.random.default_rng(2).random(25)
    found = sb.geodesic_center(graph, points, weights).positions(mesh)[0]
    np.testing.assert_allclose(found, weights @ points.positions(mesh) / weights.sum(), atol=1e-9)
    vertices = [3, 40, 77, 130]
    np.testing.assert_allclose(
        sb.geodesic_center(graph, vertices).positions(mesh)[0], mesh.vertices[vertices].mean(axis=0), atol=1e-9
    )


def test_of_a_ring_round_a_pole() -> None:
    """All vertices at one height of an icosphere: the pole, but for its own curvature, from which the sum falls."""
    mesh = sb.Mesh(*meshes.icosphere(3))
    pole = int(np.argmax(mesh.vertices @ [0, 0.5257311, 0.8506508]))  # a corner of the icosahedron: five fold
    heights = mesh.vertices @ mesh.vertices[pole]
    ring = np.flatnonzero(np.abs(heights - heights[np.argsort(-heights)[30]]) < 1e-9)
    assert len(ring) >= 5
    found = sb.geodesic_center(sb.SaddleVertexGraph(mesh, k=20), ring)
    np.testing.assert_allclose(found.positions(mesh)[0], mesh.vertices[pole], atol=0.005)


def test_no_step_lowers_the_sum() -> None:
    mesh = sb.Mesh(*meshes.torus(60, 24))
    points = random_points(mesh, 200, seed=7)
    near = points.positions(mesh) @ [1, 0, 0] > 0.9
    points = sb.SurfacePoints(points.faces[near], points.barycentric[near])
    center = sb.geodesic_center(sb.SaddleVertexGraph(mesh, k=20), points)

    def energy(place: sb.SurfacePoints) -> float:
        return float((sb.ExactField(mesh, place).distance_to(points) ** 2).sum())

    least = energy(center)
    for angle in np.linspace(0, 2 * np.pi, 8, endpoint=False):
        moved = sb.exp_map(mesh, center, 0.02 * np.array([[np.cos(angle), np.sin(angle)]]))
        assert energy(moved) > least


def test_cells_of_the_plane_have_their_centroids() -> None:
    mesh = sb.Mesh(*meshes.grid(15, 15, 0.2))
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=225), random_points(mesh, 12, seed=5))
    split = cells.split()
    corners = split.vertices[split.triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    moments = [np.bincount(split.triangle_cell, areas * corners.mean(axis=1)[:, i]) for i in range(2)]
    centroids = np.column_stack(moments) / cells.areas[:, None]
    np.testing.assert_allclose(cells.centers().positions(mesh)[:, :2], centroids, atol=1e-4)
    painted = cells.centers(density=1 + 3 * mesh.vertices[:, 0]).positions(mesh)
    assert (painted[:, 0] > centroids[:, 0]).all()


@pytest.mark.parametrize("seed", [19, 25, 35, 37, 74, 87, 101])
def test_centers_where_ways_become_straight_bit_by_bit(seed: int) -> None:
    """Rings of three, so that corners are placed again and again, each time by a straighter way: masses balance."""
    mesh = sb.Mesh(*meshes.graded_disk(0.007, 10, 3))
    sites = sb.sample(mesh, 2, seed=seed)
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=3), sites, exact=True)
    balance = cells.areas @ cells.centers().positions(mesh) / mesh.area
    np.testing.assert_allclose(balance, 0, atol=1e-9)


def test_relaxed_sites_lie_at_the_centers() -> None:
    """Two ways to the same points: moments by the graph's maps, and maps of patches."""
    mesh = sb.Mesh(*meshes.torus(72, 30))
    relaxed = sb.centroidal_voronoi(
        sb.SaddleVertexGraph(mesh, k=40), count=60, max_iterations=200, tolerance=1e-12, start="sample"
    )
    away = relaxed.cells.centers().positions(mesh) - relaxed.sites.positions(mesh)
    assert np.linalg.norm(away, axis=1).max() < 0.01 * np.sqrt(mesh.area / 60)


def test_threads_change_nothing() -> None:
    mesh = sb.Mesh(*meshes.double_torus())
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=20), random_points(mesh, 40, seed=1))
    assert cells.centers(threads=1).barycentric.tobytes() == cells.centers(threads=8).barycentric.tobytes()


def test_degenerate_sets() -> None:
    mesh = sb.Mesh(*meshes.torus(30, 12))
    graph = sb.SaddleVertexGraph(mesh, k=20)
    np.testing.assert_array_equal(sb.geodesic_center(graph, [17]).positions(mesh)[0], mesh.vertices[17])
    same = sb.geodesic_center(graph, [17, 17, 17])
    np.testing.assert_allclose(same.positions(mesh)[0], mesh.vertices[17])
    whole = sb.geodesic_voronoi(graph, [5]).centers()  # a cell without a border, its cut locus inside
    assert np.isfinite(whole.positions(mesh)).all()


@pytest.mark.parametrize(
    ("points", "weights", "words"),
    [
        ([], None, "points"),
        ([0, 1], [1.0], "weights"),
        ([0, 1], [1.0, -1.0], "-1"),
        ([0, 1], [1.0, np.nan], "nan"),
        ([0, 1], [0.0, 0.0], "weights"),
        ([0, 10**6], None, "points"),
    ],
)
def test_bad_arguments(points: list[int], weights: list[float] | None, words: str) -> None:
    graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.torus(20, 8)), k=10)
    with pytest.raises(sb.InputError, match=words):
        sb.geodesic_center(graph, points, weights)


def test_points_on_separate_parts() -> None:
    mesh = sb.Mesh(*meshes.two_components())
    graph = sb.SaddleVertexGraph(mesh, k=10)
    with pytest.raises(sb.InputError, match="separate parts"):
        sb.geodesic_center(graph, [0, len(mesh.vertices) - 1])
    with pytest.raises(sb.InputError, match="density"):
        sb.geodesic_voronoi(graph, [0, len(mesh.vertices) - 1]).centers(density=np.zeros(len(mesh.vertices)))


def test_centers_among_twins_come_to_an_end() -> None:
    """Rounding shortened ways about a sliver again and again, for ever."""
    family, arrays = families.random_mesh(2363)
    assert family == "near_coincident"
    mesh = sb.Mesh(*arrays)
    sites = sb.sample(mesh, 4, seed=46711751)
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh), sites)
    assert np.isfinite(cells.centers().positions(mesh)).all()


@pytest.mark.parametrize("gap", [1e-5, 1e-7, 1e-9])
def test_cells_about_twins(gap: float) -> None:
    """Vertices that lie side by side do not make each other nearer for ever."""
    for seed in range(40):
        rng = np.random.default_rng(seed)
        points = rng.random((int(rng.integers(5, 25)), 2))
        twins = np.clip(points + gap * rng.normal(size=points.shape), 0, 1)
        flat = Delaunay(np.vstack([points, twins, [(0, 0), (1, 0), (0, 1), (1, 1)]]))
        mesh, _ = sb.repair(np.column_stack([flat.points, np.zeros(len(flat.points))]), flat.simplices)
        sites = sb.sample(mesh, int(rng.integers(1, 6)), seed=seed)
        cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=3, threads=1), sites, exact=True)
        centers = cells.centers(threads=1)
        split = cells.split()
        corners = split.vertices[split.triangles]
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
        moments = [np.bincount(split.triangle_cell, areas * corners.mean(axis=1)[:, i], len(sites)) for i in range(2)]
        missed = centers.positions(mesh)[:, :2] - np.column_stack(moments) / cells.areas[:, None]
        assert (np.hypot(*missed.T) <= 0.05 * np.sqrt(cells.areas)).all()

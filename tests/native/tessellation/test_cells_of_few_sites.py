# SPDX-License-Identifier: MIT
"""Cells tell what the graph tells that they are made from, however few or close the sites; nothing is too short."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.spatial import Delaunay  # type: ignore[import-untyped]

import saddleback as sb
from tests import meshes
from tests.truth.cells import any_graph, check_points, check_vertices


@cache
def rough_torus(around: int, tube: int, seed: int) -> sb.Mesh:
    u, w = np.meshgrid(*(np.linspace(0, 2 * np.pi, n, endpoint=False) for n in (around, tube)))
    radius = 0.4 + 0.005 * np.random.default_rng(seed).normal(size=u.shape)
    places = np.stack([(1 + radius * np.cos(w)) * np.cos(u), (1 + radius * np.cos(w)) * np.sin(u), radius * np.sin(w)])
    return sb.Mesh(places.reshape(3, -1).T, meshes.torus(around, tube)[1])


@cache
def rough_sphere() -> sb.Mesh:
    vertices, triangles = meshes.icosphere(4)
    return sb.Mesh(vertices * (1 + 0.05 * np.random.default_rng(2).random((len(vertices), 1))), triangles)


def sites_of_kind(mesh: sb.Mesh, kind: str, seed: int) -> sb.SurfacePoints:
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 12))
    faces, weights = rng.integers(mesh.face_count, size=count), rng.dirichlet([1.0, 1.0, 1.0], count)
    if kind == "clustered":
        faces = faces[0] + rng.integers(20, size=count)
    elif kind == "few faces":
        faces, weights = rng.choice(faces[:2], 25), rng.dirichlet([1.0, 1.0, 1.0], 25)
    elif kind == "twins":
        faces, weights = np.repeat(faces, 2), np.repeat(weights, 2, axis=0)
        weights[::4] += 1e-9 * rng.random((len(weights[::4]), 3))
        weights /= weights.sum(axis=1, keepdims=True)
    elif kind == "vertices":
        weights = np.eye(3)[rng.integers(3, size=count)]
    return sb.SurfacePoints(np.minimum(faces, mesh.face_count - 1).astype(np.int32), weights)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("kind", ["scattered", "clustered", "few faces", "twins", "vertices"])
@pytest.mark.parametrize("mesh", [rough_torus(60, 30, 1), rough_sphere()], ids=["torus", "sphere"])
def test_vertices_belong_to_their_nearest_site(mesh: sb.Mesh, kind: str, seed: int) -> None:
    graph, accuracy = any_graph(mesh)
    check_vertices(mesh, graph, sites_of_kind(mesh, kind, seed), accuracy)


@pytest.mark.parametrize("name", ["tetrahedron", "cube", "sphere", "torus"])
def test_points_are_never_nearer_than_they_are(name: str) -> None:
    """Where geodesics pass a corner on both sides, what one side tells of a face is too short on the other."""
    coarse = {"tetrahedron": meshes.tetrahedron(), "cube": meshes.cube()}
    fine = {"sphere": rough_sphere(), "torus": rough_torus(60, 30, 1)}
    mesh = sb.Mesh(*coarse[name]) if name in coarse else fine[name]
    graph, accuracy = any_graph(mesh)
    for seed in range(4):
        check_points(mesh, graph, sb.sample(mesh, 1 + 2 * seed, seed=seed), accuracy)


@pytest.mark.parametrize("shrunk", [1e-4, 1e-6, 1e-7])
def test_what_is_hidden_behind_short_edges_is_not_nearer(shrunk: float) -> None:
    """Around a vertex close to another, what is hidden by less than single precision tells is nearer by 1e-8."""
    for seed in range(6):
        rough = rough_torus(13, 8, seed)
        vertices, triangles = rough.vertices.copy(), rough.triangles
        center = vertices[seed].copy()
        near = np.linalg.norm(vertices - center, axis=1) < 0.8
        vertices[near] = center + shrunk * (vertices[near] - center)
        mesh = sb.Mesh(vertices, triangles)
        graph, accuracy = any_graph(mesh)
        check_vertices(mesh, graph, sb.sample(mesh, 5, seed=seed), accuracy)


def test_points_far_from_the_origin_are_never_nearer_than_they_are() -> None:
    rough = rough_torus(20, 10, 2)
    mesh = sb.Mesh(rough.vertices + [5e5, 5e6, 0], rough.triangles)
    graph, accuracy = any_graph(mesh)
    for seed in range(6):
        check_points(mesh, graph, sb.sample(mesh, 2, seed=seed), accuracy)


def test_areas_of_few_cells() -> None:
    mesh = rough_torus(60, 30, 1)
    graph = sb.SaddleVertexGraph(mesh)
    for seed in range(3):
        sites = sb.sample(mesh, 4, seed=seed)
        areas, exact = (sb.geodesic_voronoi(graph, sites, exact=flag).areas for flag in (False, True))
        np.testing.assert_allclose(areas, exact, atol=5e-3 * mesh.area / 4)


def test_relaxation_from_few_sites_goes_on() -> None:
    """It once ended after a step, since cells were wrong in other ways from one place to the next."""
    mesh = rough_torus(100, 50, 1)
    graph = sb.SaddleVertexGraph(mesh)
    relaxed = sb.centroidal_voronoi(graph, np.array([2511, 2014, 1017, 4517, 669, 1915]), max_iterations=40)
    assert relaxed.iterations > 10
    assert relaxed.energy[-1] < 0.5 * relaxed.energy[0]
    _, nearest = sb.exact_nearest(mesh, relaxed.sites)
    assert (sb.geodesic_voronoi(graph, relaxed.sites).vertex_cell != nearest).mean() < 0.005


@pytest.mark.parametrize("jitter", [0.0, 0.3])
def test_the_plane_beyond_what_a_site_sees(jitter: float) -> None:
    """Distances between Euclid's and those within the accuracy."""
    mesh = sb.Mesh(*meshes.grid(40, 40, jitter))
    sites = sb.sample(mesh, 4, seed=3)
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh), sites)
    table = np.linalg.norm(mesh.vertices[:, None] - sites.positions(mesh)[None], axis=2)
    np.testing.assert_allclose(cells.vertex_distance, table.min(axis=1), atol=5e-3 * table.max())
    assert (cells.vertex_distance >= table.min(axis=1) * (1 - 1e-9)).all()


def plate(kind: str, seed: int) -> sb.Mesh:
    """Flat and coarse but for small holes or cones: ways on both sides of one fit a plane."""
    count, size, rng = 12, 0.1, np.random.default_rng(seed)
    around = np.stack(np.meshgrid(np.arange(10.0), np.arange(10.0)), -1).reshape(-1, 2)
    inner = ((around > 0) & (around < 9)).all(axis=1)
    around[inner] += 0.3 * (rng.random((inner.sum(), 2)) - 0.5)
    cells = rng.choice(81, count, replace=False)
    centers = np.column_stack([cells % 9, cells // 9]) + 0.5
    angles = 2 * np.pi * (rng.random((count, 1)) + np.arange(3) / 3)
    rims = centers[:, None] + size * np.stack([np.cos(angles), np.sin(angles)], -1)
    places = np.vstack([around, rims.reshape(-1, 2), centers])
    triangles = Delaunay(places[: 100 + 3 * count]).simplices
    rim = np.where(triangles < 100, -1, (triangles - 100) // 3)
    open_ = (rim[:, 0] >= 0) & (rim == rim[:, :1]).all(axis=1)
    height = np.append(np.zeros(100 + 3 * count), np.full(count, 0.3))
    if kind == "cones":
        tips, corners = 100 + 3 * count + rim[open_, 0], triangles[open_]
        sides = [np.column_stack([corners[:, i], corners[:, (i + 1) % 3], tips]) for i in range(3)]
        return sb.repair(np.column_stack([places, height]), np.vstack([triangles[~open_], *sides]))[0]
    return sb.repair(np.column_stack([places, height]), triangles[~open_])[0]


@pytest.mark.parametrize("kind", ["holes", "cones"])
@pytest.mark.parametrize("seed", range(4))
def test_no_distance_leads_through_what_is_no_surface(kind: str, seed: int) -> None:
    mesh = plate(kind, seed)
    sites = sb.sample(mesh, 2, seed=seed)
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, threads=1), sites, threads=1)
    table = np.array([sb.exact_distances(mesh, sites[i : i + 1]) for i in range(2)])
    exact = table[cells.vertex_cell, np.arange(mesh.vertex_count)]
    assert (cells.vertex_distance >= exact * (1 - 1e-12)).all()


@pytest.mark.parametrize("finest", [1e-16, 1e-17])
def test_edges_shorter_than_the_rounding_of_the_way_to_them(finest: float) -> None:
    """No vertex of the cell is nearer than those in the middle, each reached by an arc that adds nothing to the way;
    of twelve sites some cells go on behind them. Under `tests/sanitize`, nothing is read that is not there.
    """
    mesh = sb.Mesh(*meshes.graded_disk(finest))
    graph = sb.SaddleVertexGraph(mesh)
    for sites in (np.array([mesh.vertex_count - 1]), sb.sample(mesh, 12, seed=0)):
        cells = sb.geodesic_voronoi(graph, sites)
        np.testing.assert_allclose(cells.vertex_distance, sb.exact_distances(mesh, sites), rtol=5e-3)
        assert (cells.vertex_distance <= graph.distances(sites) * (1 + 1e-8)).all()
        assert cells.areas.sum() == pytest.approx(mesh.area, rel=1e-9)

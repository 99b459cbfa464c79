# SPDX-License-Identifier: MIT
"""What holds for the cells of any sites on any mesh."""

from __future__ import annotations

import numpy as np
import pytest

import saddleback as sb


def triangle_areas(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def check(mesh: sb.Mesh, cells: sb.GeodesicVoronoi) -> None:
    """Everything that holds for any sites on any mesh."""
    count = len(cells.sites)
    assert cells.areas.shape == (count,)
    assert cells.areas.min() >= 0
    assert cells.areas.sum() == pytest.approx(mesh.area, rel=1e-9)
    assert ((cells.vertex_cell >= 0) & (cells.vertex_cell < count)).all()
    assert np.isfinite(cells.vertex_distance).all()
    check_edges(mesh, cells)
    check_split(mesh, cells)


def check_edges(mesh: sb.Mesh, cells: sb.GeodesicVoronoi) -> None:
    np.testing.assert_allclose(cells.edge_surface.positions(mesh), cells.edge_points, rtol=0, atol=1e-9)
    weights = cells.edge_surface.barycentric
    assert (weights >= 0).all()
    np.testing.assert_allclose(weights.sum(axis=1), 1, rtol=0, atol=1e-12)
    assert (np.diff(cells.edge_offsets) >= 2).all()
    assert (cells.edge_cells[:, 0] != cells.edge_cells[:, 1]).all()
    starts, ends = cells.edge_points[cells.edge_offsets[:-1]], cells.edge_points[cells.edge_offsets[1:] - 1]
    assert np.array_equal((starts == ends).all(axis=1) & cells.edge_closed, cells.edge_closed)


def check_split(mesh: sb.Mesh, cells: sb.GeodesicVoronoi) -> None:
    split = cells.split()
    areas = triangle_areas(split.vertices, split.triangles)
    per_cell = np.bincount(split.triangle_cell, areas, minlength=len(cells.sites))
    np.testing.assert_allclose(per_cell, cells.areas, rtol=1e-7, atol=1e-12 * mesh.area)
    old = split.vertex_origin >= 0
    assert np.array_equal(split.vertices[old], mesh.vertices[split.vertex_origin[old]])
    assert np.array_equal(np.flatnonzero(old), np.arange(len(mesh.vertices)))
    # No crack, no overlap: the same surface again.
    edges = np.sort(split.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    unique, uses = np.unique(edges, axis=0, return_counts=True)
    assert uses.max() <= 2
    characteristic = len(split.vertices) - len(unique) + len(split.triangles)
    assert characteristic == len(mesh.vertices) - mesh.edge_count + len(mesh.triangles)


def points_of_cells(cells: sb.GeodesicVoronoi, count: int, seed: int, by_area: bool) -> tuple[np.ndarray, np.ndarray]:
    """Random places in the triangles of the split mesh, and the cells that those belong to."""
    split = cells.split()
    areas = triangle_areas(split.vertices, split.triangles)
    random = np.random.default_rng(seed)
    chosen = random.choice(len(areas), count, p=areas / areas.sum() if by_area else None)
    weights = random.dirichlet([1.0, 1.0, 1.0], count)
    return np.einsum("ij,ijk->ik", weights, split.vertices[split.triangles[chosen]]), split.triangle_cell[chosen]


def lag(mesh: sb.Mesh, cells: sb.GeodesicVoronoi, places: np.ndarray, owners: np.ndarray) -> np.ndarray:
    """By how much, in sizes of a cell, the owners' sites are farther from places than the nearest site.

    Each by exact distances of its own.
    """
    points = sb.project(mesh, places)
    nearest, least = cells.locate(points)
    lags = np.zeros(len(places))
    for cell in np.unique(owners[nearest != owners]):
        wrong = np.flatnonzero((nearest != owners) & (owners == cell))
        field = sb.ExactField(mesh, cells.sites[int(cell) : int(cell) + 1])
        those = sb.SurfacePoints(points.faces[wrong], points.barycentric[wrong])
        lags[wrong] = field.distance_to(those) - least[wrong]
    return np.asarray(lags / np.sqrt(mesh.area / len(cells.sites)))

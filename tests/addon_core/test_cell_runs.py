# SPDX-License-Identifier: GPL-3.0-or-later
"""Raised cells on creases: they neither cross nor wrinkle, and are as thick as asked, or told."""

from __future__ import annotations

import numpy as np
import pytest

import saddleback as sb
from saddleback_blender.core import runs
from saddleback_blender.core.cache import Cache
from saddleback_blender.core.cell_runs import cells_of, directions
from saddleback_blender.core.figures import cell_faults_of, lost_of
from saddleback_blender.core.solids.cell_mesh import CellShape
from saddleback_blender.core.solids.crossings import find_crossings, is_deep
from saddleback_blender.core.surfaces.normals import normals_at
from tests import synthetic_cells


def folded(fold: float, columns: int = 81, rows: int = 41) -> sb.Mesh:
    """A sheet of 2 x 1, bent along its middle line by the angle: up is concave."""
    vertices, triangles = synthetic_cells.grid(columns, rows, 2.0, 1.0)
    x = vertices[:, 0] - 1.0
    bent = np.column_stack([np.where(x > 0, x * np.cos(fold), x), vertices[:, 1], np.maximum(x, 0) * np.sin(fold)])
    return sb.Mesh(bent, triangles)


def ruffled(height: float) -> sb.Mesh:
    """A sheet with waves of height and width alike."""
    vertices, triangles = synthetic_cells.grid(121, 121)
    x, y = 40.0 * vertices[:, 0], 31.0 * vertices[:, 1]
    return sb.Mesh(np.column_stack([vertices[:, :2], height * np.sin(x) * np.cos(y)]), triangles)


def made(mesh: sb.Mesh, shape: CellShape, count: int = 40):
    cells = sb.centroidal_voronoi(sb.SaddleVertexGraph(mesh, k=40), count=count, max_iterations=10).cells
    return cells.split(), cells_of(mesh, cells.split(), shape, ("test",), runs.new_progress(), Cache(2**28))


@pytest.mark.parametrize("fold", [-2.2, -1.5708, 0.8, 1.5708, 2.2])
@pytest.mark.parametrize("inset", [0.0, 0.02])
def test_cells_over_a_crease_do_not_cross_and_are_as_thick_as_asked_or_told(fold, inset):
    mesh = folded(fold)
    shape = CellShape(gap=0.02, inset=inset, thickness=0.04)
    _, cells = made(mesh, shape)
    assert not len(find_crossings(cells.vertices, cells.triangles))
    assert not len(cells.crossing) and cell_faults_of(cells) == []
    height = np.linalg.norm(cells.vertices - cells.feet, axis=1)
    tallest = np.zeros(40)
    np.maximum.at(tallest, np.repeat(cells.triangle_cell, 3), height[cells.triangles].ravel())
    np.testing.assert_allclose(np.delete(tallest, cells.thinner), 0.04, rtol=1e-9)
    assert len(cells.thinner) <= 12  # those on the crease at most


def test_cells_over_ruffles_do_not_cross():
    """Heights like the waves': normals alone would cross by thousands."""
    _, cells = made(ruffled(0.03), CellShape(gap=0.012, inset=0.015, thickness=0.03))
    assert not len(find_crossings(cells.vertices, cells.triangles)) and not len(cells.crossing)


def pebbles(places: np.ndarray, triangles: np.ndarray, count: int, seed: int):
    """Round cells with the lengths of the look, on vertices as Blender stores them."""
    mesh = sb.Mesh(places.astype(np.float32).astype(np.float64), triangles)
    size = np.sqrt(mesh.area / count)
    cells = sb.centroidal_voronoi(sb.SaddleVertexGraph(mesh, k=40), count=count, max_iterations=12, seed=seed).cells
    shape = CellShape(0.08 * size, 0.24 * size, 0.24 * size, dome=1.0)
    return cells_of(mesh, cells.split(), shape, ("test",), runs.new_progress(), Cache(2**28))


@pytest.mark.parametrize("seed", [3, 6])
def test_pebbles_on_a_flat_sheet_have_room_though_needles_turn_over_when_rounded(seed):
    made_ones = pebbles(*synthetic_cells.grid(61, 61), count=200, seed=seed)
    assert not len(made_ones.crossing) and not len(made_ones.thinner)


@pytest.mark.parametrize("seed", [0, 1, 7])
def test_pebbles_on_a_roll_become_as_low_as_they_must(seed):
    places, triangles = synthetic_cells.grid(61, 61)
    around = 4.0 * places[:, 0]
    rolled = np.column_stack([0.25 * np.cos(around), 0.25 * np.sin(around), places[:, 1]])
    assert not len(pebbles(rolled, triangles, count=100, seed=seed).crossing)


def test_crossings_deeper_than_rounding_are_told_from_others():
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], float)
    for depth, deep in ((1e-3, True), (1e-5, True), (2e-7, False)):
        through = np.array([[0.2, 0.2, -depth], [0.3, 0.2, 0.5], [0.2, 0.3, 0.5]])
        vertices, triangles = np.concatenate([corners, through]), np.arange(6, dtype=np.int32).reshape(2, 3)
        pairs = find_crossings(vertices, triangles)
        assert pairs.tolist() == [[0, 1]] and is_deep(vertices, triangles, pairs).tolist() == [deep]
        assert is_deep(1e-3 * vertices, triangles, pairs).tolist() == [deep]
        is_far = is_deep(vertices + 2000.0, triangles, pairs).tolist()
        assert is_far == [depth > 5e-4]


def test_a_surface_that_crosses_itself_is_told_and_does_not_take_for_ever():
    sheet = folded(0.0, 21, 11)
    vertices = np.asarray(sheet.vertices)
    through = np.column_stack([vertices[:, 0], 0.5 + vertices[:, 2], vertices[:, 1] - 0.5])
    both = sb.Mesh(
        np.concatenate([vertices, through]), np.concatenate([sheet.triangles, sheet.triangles + len(vertices)])
    )
    _, cells = made(both, CellShape(gap=0.02, thickness=0.03))
    assert len(cells.crossing) and len(cells.thinner) >= len(cells.crossing) // 2
    (told,) = cell_faults_of(cells)
    assert f"{len(cells.crossing)} cells pass through others" in told
    assert "Remesh modifier" in told and "repair" not in told  # which would change nothing
    assert lost_of(0, len(cells.thinner)) == f", {len(cells.thinner)} made thinner where there was no room"


def test_places_that_the_split_adds_go_as_the_mesh_does_there():
    vertices, triangles = synthetic_cells.sphere(3)
    mesh = sb.Mesh(vertices, triangles)
    split = made(mesh, CellShape())[0]
    ways = directions(mesh, split, 0.05, runs.new_progress())
    places = sb.project(mesh, split.vertices)
    expected = normals_at(vertices, triangles, places.faces, places.barycentric)
    turned = np.einsum("ij,ij->i", ways / np.linalg.norm(ways, axis=1, keepdims=True), expected)
    assert np.degrees(np.arccos(turned.min())) < 2.0
    assert not directions(mesh, split, 0.0, runs.new_progress()).any()


def test_another_height_finds_gaps_and_directions_once():
    mesh = folded(1.0)
    split = made(mesh, CellShape())[0]
    cache = Cache(2**28)
    for thickness in (0.01, 0.02, 0.02, 0.025):
        cells_of(mesh, split, CellShape(0.02, 0.02, thickness), ("test",), runs.new_progress(), cache)
    assert cache.builds["cell pieces"] == 1 and cache.builds["cell mesh"] == 3

# SPDX-License-Identifier: GPL-3.0-or-later
"""Line networks, colors and turns: what the output objects are made of."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from saddleback_blender.core.solids.edge_network import EdgeNetwork, edge_network, long_lines
from saddleback_blender.core.surfaces.cell_colors import ALIKE, cell_colors, oklab_to_linear_rgb
from saddleback_blender.core.surfaces.centers import cell_size, euler_to_normal
from tests import synthetic_cells
from tests.synthetic_cells import SplitCells, split_cells


def voronoi(levels: int = 3, count: int = 25) -> SplitCells:
    vertices, triangles = synthetic_cells.sphere(levels)
    return split_cells(vertices, triangles, np.linspace(0, len(vertices) - 1, count).astype(np.int32))


def network_of(cells: SplitCells) -> EdgeNetwork:
    return edge_network(cells.edge_points, cells.edge_offsets, cells.edge_cells, cells.edge_closed)


def make(*lines: list[tuple[float, float, float]], closed: tuple[bool, ...] | None = None) -> EdgeNetwork:
    offsets = np.cumsum([0] + [len(line) for line in lines]).astype(np.int32)
    cells = np.column_stack([np.arange(len(lines)), np.arange(len(lines)) + 1]).astype(np.int32)
    flags = np.array(closed or [False] * len(lines), dtype=np.bool_)
    points = np.array([p for line in lines for p in line], dtype=np.float64).reshape(-1, 3)
    return edge_network(points, offsets, cells, flags)


def total_length(network: EdgeNetwork) -> float:
    a, b = (network.vertices[ids] for ids in network.segments()[0].T)
    return float(np.linalg.norm(b - a, axis=1).sum())


def test_three_cells_share_their_branch_points() -> None:
    cells = voronoi()
    network = network_of(cells)
    segments, line = network.segments()
    degree = np.bincount(segments.ravel(), minlength=len(network.vertices))
    assert set(degree) == {2, 3}
    # Closed surface, cells are disks, three at each corner: 2 (n - 2) corners and 3 (n - 2) lines.
    assert (degree == 3).sum() == 2 * (25 - 2)
    assert len(network.closed) == 3 * (25 - 2)
    assert np.bincount(line).min() >= 1


def test_a_closed_line_comes_back_to_its_start_whether_or_not_it_repeats_the_point() -> None:
    square = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    for line in (square, [*square, square[0]]):
        network = make(line, closed=(True,))
        segments, _ = network.segments()
        assert len(network.vertices) == 4
        assert (np.bincount(segments.ravel()) == 2).all()
        assert total_length(network) == pytest.approx(4.0)


def test_repeated_points_leave_no_piece_without_length() -> None:
    line = [(0, 0, 0), (0, 0, 0), (0.5, 0, 0), (0.5, 0, 1e-12), (1, 0, 0), (1, 0, 0)]
    network = make(line, [(1, 0, 0), (1, 1, 0)], [(1, 0, -0.0), (1, -1, 0)])
    segments, _ = network.segments()
    a, b = (network.vertices[ids] for ids in segments.T)
    assert np.linalg.norm(b - a, axis=1).min() > 0.4
    assert np.bincount(segments.ravel()).max() == 3
    assert total_length(network) == pytest.approx(3.0)


def test_a_line_without_length_is_dropped_and_the_others_keep_their_cells() -> None:
    network = make([(0, 0, 0), (0, 0, 0)], [(1, 0, 0), (1, 1, 0)])
    np.testing.assert_array_equal(network.cells, [[1, 2]])
    assert len(network.vertices) == 2


def test_no_lines_at_all() -> None:
    network = make()
    assert len(network.vertices) == 0
    assert network.segments()[0].shape == (0, 2)
    assert long_lines(network) == []


@given(st.integers(2, 40), st.integers(0, 2))
def test_long_lines_cover_every_piece_once(count: int, levels: int) -> None:
    vertices, triangles = synthetic_cells.sphere(levels + 1)
    sites = np.unique(np.linspace(0, len(vertices) - 1, min(count, len(vertices) // 2)).astype(np.int32))
    network = network_of(split_cells(vertices, triangles, sites))
    lines = long_lines(network)
    pieces = []
    for ids, closed in lines:
        pieces.append(np.column_stack([ids[:-1], ids[1:]]))
        if closed:
            pieces.append([[ids[-1], ids[0]]])
    found = np.sort(np.concatenate(pieces), axis=1)
    wanted = np.sort(network.segments()[0], axis=1)
    np.testing.assert_array_equal(found[np.lexsort(found.T)], wanted[np.lexsort(wanted.T)])


def test_long_lines_are_fewer_and_go_straight_on() -> None:
    network = make([(-1, 0, 0), (0, 0, 0)], [(0, 0, 0), (1, 0.1, 0)], [(0, 0, 0), (0, 1, 0)])
    lines = long_lines(network)
    assert sorted(len(ids) for ids, _ in lines) == [2, 3]
    longest = max((network.vertices[ids] for ids, _ in lines), key=len)
    assert {tuple(p) for p in longest[[0, 2]]} == {(-1, 0, 0), (1, 0.1, 0)}
    assert len(long_lines(network_of(voronoi()))) < 0.7 * 3 * 23


@pytest.mark.parametrize("count", [1, 2, 25, 200])
def test_colors_are_stable_and_within_the_gamut(count: int) -> None:
    neighbors = np.random.default_rng(0).integers(0, count, (3 * count, 2)).astype(np.int32)
    colors = cell_colors(count, neighbors)
    assert colors.shape == (count, 3)
    assert colors.min() >= 0
    assert colors.max() <= 1
    np.testing.assert_array_equal(colors, cell_colors(count, neighbors))


def test_neighbors_have_different_colors() -> None:
    cells = voronoi(4, 150)
    colors = cell_colors(150, cells.edge_cells)
    a, b = (colors[cells.edge_cells[:, i]] for i in range(2))
    assert np.abs(a - b).max(axis=1).min() > 0.04
    many = np.concatenate([cells.edge_cells, [[-1, 3], [4, 4]]]).astype(np.int32)
    np.testing.assert_array_equal(cell_colors(150, many), colors)
    assert ALIKE > 0


def test_oklab_white_and_black() -> None:
    np.testing.assert_allclose(oklab_to_linear_rgb(np.array([[1.0, 0, 0], [0, 0, 0]])), [[1] * 3, [0] * 3], atol=1e-6)


def rotation(euler: np.ndarray) -> np.ndarray:
    (a, b, c) = euler
    turn_x = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    turn_y = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    turn_z = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]])
    return turn_z @ turn_y @ turn_x


AXES = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]


def test_the_turn_takes_z_to_the_normal_by_the_shortest_way() -> None:
    rng = np.random.default_rng(5)
    nearly_down = np.column_stack([rng.normal(size=(100, 2)) * np.logspace(-12, -1, 100)[:, None], np.full(100, -1.0)])
    normals = np.concatenate([rng.normal(size=(300, 3)), np.array(AXES, dtype=float), nearly_down])
    turns = euler_to_normal(normals * rng.uniform(0.5, 2, (len(normals), 1)))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    for normal, euler in zip(normals, turns, strict=True):
        matrix = rotation(euler)
        np.testing.assert_allclose(matrix[:, 2], normal, atol=1e-9)
        angle = np.arccos(np.clip((np.trace(matrix) - 1) / 2, -1, 1))
        assert angle == pytest.approx(np.arccos(np.clip(normal[2], -1, 1)), abs=1e-5)


def test_no_normal_no_turn_and_a_disk_has_its_radius() -> None:
    np.testing.assert_array_equal(euler_to_normal(np.zeros((2, 3))), np.zeros((2, 3)))
    np.testing.assert_allclose(cell_size(np.array([np.pi, 4 * np.pi, 0.0])), [1, 2, 0])

# SPDX-License-Identifier: MIT
"""Plain triangle arrays: closed forms on planes, and errors that name the culprit."""

from __future__ import annotations

import time

import numpy as np
import pytest

import saddleback as sb
from tests import meshes, synthetic_cells


def test_border_of_a_sheet_is_its_rim_once_round() -> None:
    vertices, triangles = meshes.grid(5, 4)
    ends, owners = sb.border_edges(triangles, len(vertices))
    rim = np.flatnonzero(np.isin(vertices[:, :2], [vertices[:, :2].min(0), vertices[:, :2].max(0)]).any(axis=1))
    np.testing.assert_array_equal(np.sort(ends[:, 0]), np.sort(ends[:, 1]))
    assert set(ends.ravel()) <= set(rim)
    assert len(ends) == len(set(ends[:, 0]))
    for (start, end), owner in zip(ends, owners, strict=True):
        assert (start, end) in {(triangles[owner, i], triangles[owner, (i + 1) % 3]) for i in range(3)}


def test_closed_surfaces_have_no_border() -> None:
    vertices, triangles = synthetic_cells.sphere(2)
    ends, owners = sb.border_edges(triangles, len(vertices))
    assert ends.shape == (0, 2) and owners.shape == (0,)


def test_edges_are_numbered_once_each_as_they_come() -> None:
    """Against a dictionary: a large fan, three triangles about one edge, a triangle with one vertex twice."""
    fan = [[0, i, i + 1] for i in range(1, 2000)]
    triangles = np.array([*fan, [1, 2, 3000], [2, 1, 3001], [5, 5, 9], [1, 0, 2]], np.int32)
    ends, corner_edges = sb.triangle_edges(triangles, 3002)
    numbers: dict[tuple[int, int], int] = {}
    users: dict[tuple[int, int], set[int]] = {}
    expected = []
    for t, corners in enumerate(triangles.tolist()):
        for a, b in zip(corners, [*corners[1:], corners[0]], strict=True):
            edge = (min(a, b), max(a, b))
            expected.append(numbers.setdefault(edge, len(numbers)))
            users.setdefault(edge, set()).add(t)
    assert ends.dtype == corner_edges.dtype == np.int32
    np.testing.assert_array_equal(corner_edges, expected)
    np.testing.assert_array_equal(np.sort(ends, axis=1), list(numbers))
    rim, owners = sb.border_edges(triangles, 3002)
    alone = {edge: next(iter(by)) for edge, by in users.items() if len(by) == 1}
    assert {(min(a, b), max(a, b)) for a, b in rim.tolist()} == set(alone)
    assert (np.diff(owners) >= 0).all()
    assert all(alone[min(a, b), max(a, b)] == t for (a, b), t in zip(rim.tolist(), owners.tolist(), strict=True))


def test_means_count_a_neighbor_on_two_triangles_twice() -> None:
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    means = sb.neighbor_means(triangles, [[1.0], [2.0], [4.0], [8.0], [9.0]])
    np.testing.assert_allclose(means[:, 0], [(2 + 4 + 4 + 8) / 4, (1 + 4) / 2, (1 + 2 + 1 + 8) / 4, (1 + 4) / 2, 0.0])
    with pytest.raises(sb.InputError, match=r"values: wanted \(V, k\) floats"):
        sb.neighbor_means(triangles, np.zeros(5))
    with pytest.raises(sb.InputError, match="values: 0 numbers are no rows of 0"):
        sb.neighbor_means(triangles, np.zeros((5, 0)))


def test_directions_turn_towards_their_neighbors() -> None:
    vertices, triangles = meshes.icosphere(4)
    rng = np.random.default_rng(0)
    rough = vertices + 0.5 * rng.normal(size=vertices.shape)
    rough /= np.linalg.norm(rough, axis=1)[:, None]
    smooth = sb.smoothed_directions(triangles, rough, 20)
    assert (smooth * vertices).sum(axis=1).min() > 0.95 > (rough * vertices).sum(axis=1).min()
    np.testing.assert_array_equal(sb.smoothed_directions(triangles, rough, 0), rough)
    opposite = np.array([[0.0, 0, 1], [0, 0, 1], [0, 0, -1], [0, 0, -0.2]])
    np.testing.assert_array_equal(sb.smoothed_directions([[3, 1, 2]], opposite, 1)[0], opposite[0])
    with pytest.raises(sb.InputError, match="rounds: wanted 0 or more, got -1"):
        sb.smoothed_directions(triangles, rough, -1)


def test_points_are_measured_to_the_segments_of_their_own_group() -> None:
    points = [[0.0, 0, 3], [0, 0, 3], [5, 0, 0], [0, 0, 3], [2, 4, 3]]
    starts, ends = [[-1.0, 0, 0], [-4, 1, 3], [0, 0, 1]], [[1.0, 0, 0], [4, 1, 3], [0, 0, 1]]
    found = sb.segment_distances(points, [7, 0, 7, 1, 0], starts, ends, [7, 0, 7])
    np.testing.assert_allclose(found, [2, 1, np.hypot(4, 0), np.inf, 3])
    assert sb.segment_distances(np.zeros((0, 3)), [], starts, ends, [7, 0, 7]).shape == (0,)
    for groups, owners, words in (
        ([0], [0, 0, 0], "point_group: wanted 5, got 1"),
        ([0] * 5, [0, 0], "segment_group: wanted 3, got 2"),
        ([0, -1, 0, 0, 0], [0] * 3, r"point_group\[1\] is -1, but must be 0 or more"),
    ):
        with pytest.raises(sb.InputError, match=words):
            sb.segment_distances(points, groups, starts, ends, owners)
    with pytest.raises(sb.InputError, match="ends: wanted 3, got 2"):
        sb.segment_distances(points, [0] * 5, starts, ends[:2], [0] * 3)


def test_normals_of_a_sphere_point_outwards_and_unused_vertices_have_none() -> None:
    vertices, triangles = synthetic_cells.sphere(4)
    normals = sb.vertex_normals(np.vstack([vertices, [[9.0, 9.0, 9.0]]]), triangles)
    assert np.einsum("ij,ij->i", normals[:-1], vertices).min() > 0.999
    np.testing.assert_array_equal(normals[-1], 0)


@pytest.mark.parametrize("level", [0.1, 0.37, 0.5])
def test_a_cut_parts_the_area_at_the_level_and_opens_no_crack(level: float) -> None:
    vertices, triangles = synthetic_cells.grid(11, 11)
    fields = np.column_stack([vertices, vertices[:, 0], vertices[:, 1] * 2])
    out, cut, parents, aboves = sb.cut_at_level(fields, triangles, 3, level)
    assert aboves.dtype == bool and (np.diff(parents) >= 0).all()
    a, b, c = (out[cut[:, i], :3] for i in range(3))
    areas = 0.5 * np.cross(b - a, c - a)[:, 2]
    assert areas.min() >= 0
    assert areas[aboves].sum() == pytest.approx(1 - level, rel=1e-12)
    np.testing.assert_allclose(out[:, 3], out[:, 0], atol=1e-12)  # linear functions stay what they are
    np.testing.assert_allclose(out[:, 4], 2 * out[:, 1], atol=1e-12)
    ends, _ = sb.border_edges(cut, len(out))
    on_rim = np.isin(out[ends, :2], [0.0, 1.0])
    assert (on_rim[:, 0] & on_rim[:, 1]).any(axis=1).all()
    side = np.where(aboves, out[cut, 0].min(axis=1), out[cut, 0].max(axis=1)) - level
    assert (np.where(aboves, side, -side) > -1e-9).all()


@pytest.mark.parametrize("turned", [False, True])
def test_cell_boundary_is_found_once_each_whatever_the_orientation(turned: bool) -> None:
    vertices, triangles = synthetic_cells.grid(5, 5)
    cell = (vertices[triangles, 0].mean(axis=1) > 0.5).astype(np.int32)
    if turned:  # one side of the boundary the other way round
        triangles = np.where(cell[:, None] == 1, triangles[:, ::-1], triangles)
    segments, cells = sb.cell_boundary(triangles, cell, len(vertices))
    assert len(segments) == 4
    np.testing.assert_allclose(vertices[segments, 0], 0.5)
    np.testing.assert_array_equal(np.sort(cells, axis=1), [[0, 1]] * 4)


def test_distance_is_infinite_in_a_cell_without_a_boundary() -> None:
    vertices, triangles = synthetic_cells.grid(4, 4)
    cell = np.zeros(len(triangles), np.int32)
    assert np.isinf(sb.cell_boundary_distance(vertices, triangles, cell)).all()


@pytest.mark.parametrize("level", [0.05, 0.2, 0.4])
@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_cells_of_two_triangles_are_refined_for_their_inner_lines(level: float, size: float) -> None:
    """Nine rectangles, 4 by 1, all of whose corners lie on the boundary; what is left of them is known."""
    vertices, triangles = synthetic_cells.grid(4, 4, 12 * size, 3 * size)
    column, row = np.floor(vertices[triangles, :2].mean(axis=1) / [4 * size, size]).astype(np.int32).T
    fields = np.column_stack([vertices, np.arange(16.0), np.zeros(16)])
    refined, parts, cell = sb.refine_to_cell_boundary(fields, triangles, 3 * row + column, [level * size], 0.02)
    np.testing.assert_array_equal(refined[:16, :4], fields[:, :4])
    ends = refined[sb.border_edges(parts, len(refined))[0], :2] / (12 * size, 3 * size)
    assert (np.isin(ends, [0.0, 1.0]).all(axis=1)).any(axis=1).all()  # no crack
    np.testing.assert_allclose(refined[:, 4], sb.cell_boundary_distance(refined[:, :3], parts, cell), atol=1e-9 * size)
    out, cut, parents, above = sb.cut_at_level(refined, parts, 4, level * size)
    a, b, c = (out[cut[above, i], :3] / size for i in range(3))
    left = np.bincount(cell[parents[above]], 0.5 * np.cross(b - a, c - a)[:, 2], minlength=9)
    assert left[4] == pytest.approx((4 - 2 * level) * (1 - 2 * level), rel=0.03)


def test_where_the_distance_is_linear_nothing_is_refined() -> None:
    vertices, triangles = synthetic_cells.grid(9, 9)
    cell = (vertices[triangles, 0].mean(axis=1) > 0.5).astype(np.int32)
    fields = np.column_stack([vertices, np.zeros(81)])
    refined, parts, owners = sb.refine_to_cell_boundary(fields, triangles, cell, [0.1, 0.3], 0.01)
    np.testing.assert_array_equal(parts, triangles)
    np.testing.assert_array_equal(owners, cell)
    np.testing.assert_allclose(refined[:, 3], abs(vertices[:, 0] - 0.5), atol=1e-12)


def test_parts_hang_together_over_common_vertices() -> None:
    vertices, triangles = synthetic_cells.grid(4, 4)
    alone = np.array([[0, 1, 2], [2, 3, 4]], np.int32)  # two triangles that share a corner
    both = np.concatenate([alone + len(vertices), triangles, alone + len(vertices) + 5])
    parts = sb.connected_parts(both, len(vertices) + 10)
    np.testing.assert_array_equal(parts, [0, 0, *[1] * len(triangles), 2, 2])
    assert len(sb.connected_parts(np.empty((0, 3), np.int32), 0)) == 0


def test_what_is_wrong_is_named() -> None:
    vertices, triangles = synthetic_cells.grid(3, 3)
    bad = triangles.copy()
    bad[4, 1] = 9
    for ask in (sb.triangle_edges, sb.border_edges, sb.connected_parts):
        with pytest.raises(sb.InputError, match="vertex_count: 2147483647 is one more than 32-bit indices allow"):
            ask([(0, 1, 2)], 2**31 - 1)
    with pytest.raises(sb.InputError, match="triangle 4 names vertex 9, but there are 9"):
        sb.border_edges(bad, 9)
    with pytest.raises(sb.InputError, match="triangle 4 names vertex 9"):
        sb.triangle_edges(bad, 9)
    with pytest.raises(sb.InputError, match="triangle 4 names vertex 9"):
        sb.connected_parts(bad, 9)
    with pytest.raises(sb.InputError, match="triangle 4 names vertex 9"):
        sb.vertex_normals(vertices, bad)
    with pytest.raises(sb.InputError, match="triangle 4 names vertex 9"):
        sb.neighbor_means(bad, vertices)
    with pytest.raises(sb.InputError, match="column: wanted 3 to 3, got 4"):
        sb.cut_at_level(np.column_stack([vertices, vertices[:, 0]]), triangles, 4, 0.5)
    with pytest.raises(sb.InputError, match="fields: wanted a position and a value"):
        sb.cut_at_level(vertices, triangles, 2, 0.5)
    with pytest.raises(sb.InputError, match="triangle_cell: wanted one cell for each of the 8 triangles, got 2"):
        sb.cell_boundary_distance(vertices, triangles, np.zeros(2, np.int32))
    fields, cells = np.column_stack([vertices, np.zeros(9)]), np.zeros(8, np.int32)
    with pytest.raises(sb.InputError, match="tolerance: wanted a share above 0, got 0"):
        sb.refine_to_cell_boundary(fields, triangles, cells, [0.1], 0.0)
    with pytest.raises(sb.InputError, match="fields: wanted a position and room for a distance, got 3"):
        sb.refine_to_cell_boundary(vertices, triangles, cells, [0.1], 0.1)
    with pytest.raises(sb.InputError, match="triangle 4 names vertex 9"):
        sb.refine_to_cell_boundary(fields, bad, cells, [0.1], 0.1)
    with pytest.raises(sb.InputError, match="triangle_cell: wanted one cell for each of the 8 triangles, got 2"):
        sb.refine_to_cell_boundary(fields, triangles, cells[:2], [0.1], 0.1)


@pytest.mark.parametrize("level", [0.1, 0.35, 0.4999, 0.5, 0.7])
@pytest.mark.parametrize("beyond", [np.inf, -np.inf])
def test_a_level_cut_of_distances_up_to_a_limit(level, beyond):
    """What is infinite lies wholly beyond: no place that is no number, no crack, nothing lost."""
    vertices, triangles = meshes.grid(9, 9, jitter=0.3)
    distance = np.linalg.norm(vertices - vertices[40], axis=1) / np.linalg.norm(vertices[0] - vertices[40])
    values = np.where(distance <= 0.5, distance, beyond)
    fields, parts, parents, above = sb.cut_at_level(np.column_stack([vertices, values, values]), triangles, 3, level)
    assert np.isfinite(fields[:, :3]).all()
    assert not np.isnan(fields).any()
    areas = sb.Mesh(fields[:, :3], parts).face_areas
    assert np.allclose(np.bincount(parents, areas), sb.Mesh(vertices, triangles).face_areas)
    assert sb.border_edges(parts, len(fields))[0].shape == sb.border_edges(triangles, len(vertices))[0].shape
    highest, lowest = fields[parts, 3].max(axis=1), fields[parts, 3].min(axis=1)
    assert (above[np.isinf(fields[parts, 3]).any(axis=1)] == (beyond > 0)).all()
    whole = np.isfinite(lowest) & np.isfinite(highest)
    assert (lowest[whole & above] >= level).all()
    assert (highest[whole & ~above] <= level).all()


def test_a_level_must_be_finite():
    vertices, triangles = meshes.grid(2, 2)
    with pytest.raises(sb.InputError, match="level"):
        sb.cut_at_level(np.column_stack([vertices, vertices[:, 0]]), triangles, 3, np.inf)


def test_a_wheel_takes_no_longer_than_its_spokes_are_many() -> None:
    """Thousands of triangles about one vertex: the first and the last of the vertices, since edges go by their ends."""
    count = 80_000
    angles = 2 * np.pi * np.arange(count) / count
    rim = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    begun = time.process_time()
    for hub in (0, count):
        vertices = np.insert(rim, hub, 0, axis=0)
        around = np.delete(np.arange(count + 1), hub)
        triangles = np.column_stack([np.full(count, hub), around, np.roll(around, -1)]).astype(np.int32)
        ends, owners = sb.border_edges(triangles, len(vertices))
        np.testing.assert_array_equal(owners, np.arange(count))
        np.testing.assert_array_equal(ends, triangles[:, 1:])
        cells = (np.arange(count) % 2).astype(np.int32)
        segments, sides = sb.cell_boundary(triangles, cells, len(vertices))
        assert len(segments) == count and (np.sort(sides, axis=1) == [0, 1]).all()
        assert len(np.unique(np.sort(segments, axis=1), axis=0)) == count and (segments == hub).any(axis=1).all()
        fields = np.column_stack([vertices, np.hypot(vertices[:, 0], vertices[:, 1])])
        cut, pieces, *_ = sb.cut_at_level(fields, triangles, 3, 0.5)
        assert len(cut) == 2 * count + 1 and len(pieces) == 3 * count
        np.testing.assert_allclose(np.hypot(cut[count + 1 :, 0], cut[count + 1 :, 1]), 0.5)
    assert time.process_time() - begun < 4  # the square of the spokes would take a hundred times as long

# SPDX-License-Identifier: GPL-3.0-or-later
"""Repairs as the operator asks for them, and what they leave of polygons."""

import numpy as np
import pytest

from saddleback_blender.core.repair_runs import repair
from saddleback_blender.core.requests import Surface
from saddleback_blender.core.runs import new_progress
from saddleback_blender.core.settings import RepairSettings
from saddleback_blender.core.surfaces.repair_plan import plan_repair


def grid(n):
    """A square of n x n quads as vertices, quads and triangles, two a quad."""
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0))
    vertices = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    quads = np.stack([corner, corner + 1, corner + n + 2, corner + n + 1], axis=1).astype(np.int32)
    return vertices, quads, quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


def run(vertices, triangles, **settings):
    surface = Surface("Test", np.asarray(vertices, float), np.asarray(triangles, np.int32), len(vertices))
    return repair(surface, RepairSettings(**settings), new_progress())


def border_edges(triangles):
    edges, counts = np.unique(np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0, return_counts=1)
    return edges[counts == 1]


def plan_of(result, triangles, polygons):
    corners = [np.array(polygon, np.int32) for polygon in polygons]
    owners = np.repeat(np.arange(len(polygons)), [len(polygon) - 2 for polygon in polygons]).astype(np.int32)
    maps = result.vertex_map, result.face_map, result.filled
    return plan_repair(triangles, owners, corners, result.vertices, result.triangles, *maps)


def sheets_apart(gap):
    """Two squares of 4 x 4 quads side by side, whose borders are a gap apart."""
    vertices, _, triangles = grid(4)
    other = vertices + [4 + gap, 0, 0]
    return np.concatenate([vertices, other]), np.concatenate([triangles, triangles + len(vertices)])


@pytest.mark.parametrize("gap", [1e-5, 3e-7])
def test_cracks_are_told_with_what_closes_them_and_closed_on_request(gap):
    vertices, triangles = sheets_apart(gap)
    told = run(vertices, triangles)
    assert not told.changes and len(told.advice) == 1
    assert told.advice[0].startswith("10 border vertices lie close") and "Close Cracks" in told.advice[0]
    closed = run(vertices, triangles, close_cracks=True)
    assert not closed.advice and closed.changes["vertices_welded"] == 5 and "5 vertices welded" in closed.text
    assert len(border_edges(closed.triangles)) == 24 and len(closed.vertices) == 45
    distance = float(told.advice[0].split("Weld Distance of ")[1].split(",")[0])
    assert len(run(vertices, triangles, weld_distance=1.01 * distance).vertices) == 45


def test_t_junctions_are_told_and_closed_and_their_quads_become_triangles():
    vertices, quads, triangles = grid(2)
    big = np.array([[2, 0, 0], [4, 0, 0], [4, 2, 0], [2, 2, 0.0]])
    polygons = [*quads.tolist(), [9, 10, 11, 12]]
    soup = np.concatenate([vertices, big]), np.concatenate([triangles, [[9, 10, 11], [9, 11, 12]]]).astype(np.int32)
    told = run(*soup)
    assert any("amid the edge of another border: Close Cracks joins" in line for line in told.advice)
    closed = run(*soup, close_cracks=True)
    assert not closed.advice and len(border_edges(closed.triangles)) == 8 - 2 + 3
    plan = plan_of(closed, soup[1], polygons)
    assert not plan.changes_nothing and not plan.filled and list(plan.replaced) == [4] and len(plan.replaced[4]) == 3


def test_a_good_sheet_is_left_alone_and_nothing_is_advised():
    vertices, quads, triangles = grid(3)
    result = run(vertices, triangles, close_cracks=True)
    assert not result.changes and not result.advice and result.text == ""
    assert plan_of(result, triangles, quads).changes_nothing


@pytest.mark.parametrize("seed", range(8))
def test_holes_are_filled_and_each_face_in_them_has_a_lender_beside_its_hole(seed):
    rng = np.random.default_rng(seed)
    vertices, quads, _ = grid(9)
    vertices[:, 2] = rng.uniform(-0.3, 0.3, len(vertices))
    # Two holes of one to four quads each, apart from each other and from the rim.
    missing = [{20, 21, 22}, {60, 61}] if seed % 2 else [{20}, {51, 60, 59}]
    kept = np.array([quad for number, quad in enumerate(quads) if number not in set().union(*missing)])
    triangles = kept[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    sizes = sorted(len(border_edges(quads[list(hole)][:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3))) for hole in missing)
    only_small = run(vertices, triangles, fill_holes=sizes[0])
    assert only_small.changes == {"holes_filled": 1} and only_small.text == "1 hole filled"
    assert len(only_small.filled) == sizes[0] - 2 and "2 holes are left open" in only_small.advice[0]
    result = run(vertices, triangles, fill_holes=sizes[1])
    assert result.changes == {"holes_filled": 2} and len(border_edges(result.triangles)) == 36
    plan = plan_of(result, triangles, kept)
    assert not (plan.kept or plan.replaced or plan.dropped or plan.changes_nothing)
    assert sorted(plan.filled) == result.filled.tolist()
    for hole in missing:
        rim = set(np.unique(quads[list(hole)]).tolist())
        own = {face for face in plan.filled if set(result.triangles[face].tolist()) <= rim}
        assert own and all(len(rim & set(kept[plan.filled[face]].tolist())) >= 2 for face in own)


def test_holes_beside_divided_and_welded_faces():
    vertices, triangles = sheets_apart(1e-5)
    # A hole that lies on the crack: its rim is whole only once the crack is closed.
    hole = ((vertices[triangles][:, :, 1].mean(axis=1) - 2) ** 2 < 0.3) & (
        np.abs(vertices[triangles][:, :, 0].mean(axis=1) - 4) < 1
    )
    result = run(vertices, triangles[~hole], close_cracks=True, fill_holes=12)
    assert result.changes["holes_filled"] == 1 and result.changes["vertices_welded"] > 0
    assert "welded" in result.text and result.text.endswith("1 hole filled")
    again = run(result.vertices, result.triangles, fill_holes=12)
    assert not again.changes and len(again.filled) == 0

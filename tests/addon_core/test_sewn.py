# SPDX-License-Identifier: GPL-3.0-or-later
"""Borders that lie on each other are joined, and nothing else is."""

import meshes_of_core as shapes
import numpy as np
import pytest

import saddleback as sb
from saddleback_blender.core import runs
from saddleback_blender.core.cache import Cache
from saddleback_blender.core.requests import Surface, TessellateRequest
from saddleback_blender.core.settings import TessellateSettings
from saddleback_blender.core.solids.sewn import sewn


def box(n):
    """The unit cube as six grids of n by n squares that share no vertex."""
    surface = shapes.grid(n)
    flat = surface.vertices - [0.5, 0.5, 0.0] + [0.0, 0.0, 0.5]
    turns = [np.eye(3), np.diag([1.0, -1, -1])]
    turns += [np.roll(turn, shift, axis=0) for turn in turns for shift in (1, 2)]
    vertices = np.concatenate([flat @ turn.T for turn in turns])
    triangles = np.concatenate([surface.triangles + i * len(flat) for i in range(6)]).astype(np.int32)
    return vertices, triangles


def border_count(triangles):
    return len(sb.border_edges(triangles, int(triangles.max()) + 1)[0])


@pytest.mark.parametrize("n", [1, 2, 8])
def test_a_box_of_six_sheets_becomes_closed(n):
    vertices, triangles = box(n)
    found = sewn(vertices, triangles)
    assert border_count(found) == 0
    assert np.array_equal(vertices[found], vertices[triangles])
    assert len(np.unique(found)) == 6 * n * n + 2
    order = np.random.default_rng(n).permutation(len(vertices)).astype(np.int32)  # whatever the numbers are
    places = np.empty_like(vertices)
    places[order] = vertices
    assert border_count(sewn(places, order[triangles])) == 0


def test_sheets_that_touch_in_a_point_or_are_three_to_an_edge_stay_apart():
    vertices = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 0), (-1, 0, 0), (0, -1, 0)], float)
    point = np.array([(0, 1, 2), (3, 4, 5)], np.int32)
    assert np.array_equal(sewn(vertices, point), point)
    fan = np.array(
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 0, 0), (0, 0, 0), (0, -1, 0), (1, 0, 0), (0, 0, 0), (0, 0, 1)], float
    )
    three = np.arange(9, dtype=np.int32).reshape(-1, 3)
    assert np.array_equal(sewn(fan, three), three)
    assert not np.array_equal(sewn(fan[:6], three[:2]), three[:2])
    same_way = np.array([(0, 1, 2), (3, 4, 5)], np.int32)  # one is turned over: no surface joins them
    turned = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 0), (1, 0, 0), (0, -1, 0)], float)
    assert np.array_equal(sewn(turned, same_way), same_way)


def test_a_closed_mesh_is_left_alone():
    vertices, triangles = box(4)
    found = sewn(vertices, triangles)
    assert sewn(vertices, found) is found


def shell_of(vertices, triangles, progress=None):
    surface = Surface("Box", vertices, triangles, len(vertices))
    settings = TessellateSettings(count=12, iterations=3, make_shell=True, make_edges=False, rib_width=0.08)
    request = TessellateRequest(surface, settings)
    return runs.tessellate(request, progress or runs.new_progress(), Cache(2**30)).shell


def test_the_lamp_shell_of_sheets_that_are_not_joined_is_one_solid():
    shell = shell_of(*box(4))
    assert (shell.pieces, shell.crossing) == (1, 0)
    edges = np.stack([shell.triangles, np.roll(shell.triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    ways, uses = np.unique(edges, axis=0, return_counts=True)
    assert (uses == 1).all() and np.array_equal(ways, np.unique(edges[:, ::-1], axis=0))


def test_a_round_can_be_stopped_in_its_midst(monkeypatch):
    progress = runs.new_progress()
    asked = []

    def crossings(vertices, triangles, among, job):
        asked.append(job)
        progress.cancel()
        return sb.self_crossings(vertices.astype(np.float32), triangles, among, job=job)

    monkeypatch.setattr(runs, "find_crossings", crossings)
    with pytest.raises(sb.Cancelled):
        shell_of(*box(4), progress)
    assert len(asked) == 1


def test_a_shell_that_never_gets_better_ends(monkeypatch):
    looks = []

    def crossings(vertices, triangles, among, job):
        looks.append(len(among))
        return np.stack([np.arange(20), np.arange(1, 21)], axis=1).astype(np.int32)

    monkeypatch.setattr(runs, "find_crossings", crossings)
    shell = shell_of(*box(4))
    assert shell.crossing == 21 and len(looks) < 40

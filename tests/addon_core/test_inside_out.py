# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed parts that face inward are told, walls of hollows are not."""

import time

import numpy as np
import pytest

from saddleback_blender.core.requests import Surface
from saddleback_blender.core.surfaces.inside_out import inside_out_of, inside_out_parts, lie_within
from tests.meshes import grid, icosphere


def surface(*parts):
    """Parts (vertices, triangles) as one surface."""
    starts = np.cumsum([0] + [len(vertices) for vertices, _ in parts])
    triangles = [triangles + start for (_, triangles), start in zip(parts, starts, strict=False)]
    vertices = np.concatenate([vertices for vertices, _ in parts])
    return Surface("Ball", vertices, np.concatenate(triangles).astype(np.int32), len(vertices))


def ball(x=0.0, radius=1.0, inward=False):
    vertices, triangles = icosphere(2, radius)
    return vertices + [x, 0.0, 0.0], triangles[:, ::-1] if inward else triangles


@pytest.mark.parametrize("place", [0.0, 1e5])
def test_inward_parts_are_counted_and_walls_of_hollows_are_not(place):
    def of(*parts):
        return inside_out_parts(surface(*((vertices + place, triangles) for vertices, triangles in parts)))

    assert of(ball()) == (0, 1)
    assert of(ball(inward=True)) == (1, 1)
    assert of(ball(), ball(4.0, inward=True)) == (1, 2)
    assert of(ball(), ball(radius=0.5, inward=True)) == (0, 2)  # a hollow ball
    assert of(ball(inward=True), ball(radius=0.5)) == (1, 2)  # and one inside out
    assert of(grid(5, 5)) == (0, 1)
    vertices, triangles = grid(5, 5)
    assert of((vertices[:, [1, 0, 2]], triangles)) == (0, 1)  # what is open has no inside
    both = np.concatenate([triangles, triangles[:, ::-1]])
    assert of((vertices, both))[0] == 0  # nor has what is flat


def test_the_sentence_says_how_many_and_what_helps():
    assert inside_out_of(surface(ball())) == []
    (told,) = inside_out_of(surface(ball(inward=True)))
    assert told.startswith("'Ball' is inside out") and "press Repair" in told
    (told,) = inside_out_of(surface(ball(), ball(4.0, inward=True)))
    assert told.startswith("'Ball' has 1 of 2 parts that are inside out")


@pytest.mark.parametrize("size", [0.01, 0.3, 1.0])
def test_boxes_within_others_are_found_as_by_asking_all(size):
    rng = np.random.default_rng(1)
    for count in (0, 1, 2, 7, 300):
        centers, halves = rng.random((2, count, 3)) * [[[1]], [[size]]]
        asked, small = rng.random((400, 3)), 0.1 * size * rng.random((400, 3))
        asked[: count // 2], small[: count // 2] = centers[: count // 2], halves[: count // 2]  # the same boxes
        least, most, outer_least, outer_most = asked - small, asked + small, centers - halves, centers + halves
        truth = (outer_least <= least[:, None]).all(axis=2) & (outer_most >= most[:, None]).all(axis=2)
        assert np.array_equal(lie_within(least, most, outer_least, outer_most), truth.any(axis=1))


def test_many_inward_parts_among_many_take_no_time_for_every_two_of_them():
    """Confetti, one half of it inside out, froze Blender for half a minute."""
    count = 30_000
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    places = 1000 * np.random.default_rng(2).random((count, 1, 3))
    triangles = 4 * np.arange(count)[:, None, None] + faces
    triangles[::2] = triangles[::2, :, ::-1]
    whole = Surface("Confetti", (places + corners).reshape(-1, 3), triangles.reshape(-1, 3).astype(np.int32), 4 * count)
    begin = time.process_time()
    inward, parts = inside_out_parts(whole)
    assert time.process_time() - begin < 5.0  # 16 s before, 0.3 s now
    assert (inward, parts) == (count // 2, count)

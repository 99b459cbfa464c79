# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed parts that face inward are told, walls of hollows are not."""

import numpy as np
import pytest

from saddleback_blender.core.requests import Surface
from saddleback_blender.core.surfaces.inside_out import inside_out_of, inside_out_parts
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

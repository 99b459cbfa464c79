# SPDX-License-Identifier: MIT
"""What is no argument of ours is refused in a sentence, whichever call it is given to."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import saddleback as sb

WINDOWS = {"show"}  # opens one for what it takes
CALLS = sorted(name for name in set(sb.__all__) - WINDOWS if callable(getattr(sb, name)) and not name.endswith("Error"))
MOST = 6  # arguments by position: no call needs more


class Stranger:
    """Converts to nothing."""


def refusal_of(call: Callable[..., object], *arguments: object) -> str:
    try:
        call(*arguments)
    except (TypeError, ValueError, AttributeError, OSError) as error:
        return str(error)
    return ""


@pytest.mark.parametrize("name", CALLS)
def test_strangers_are_refused(name):
    mesh = sb.Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]], np.int32))
    for first in (Stranger(), mesh, 1, "a", None):
        for count in range(MOST + 1):
            told = refusal_of(getattr(sb, name), first, *[Stranger()] * count)
            assert "Unable to cast" not in told
            assert "C++" not in told


def some_objects() -> list[object]:
    mesh = sb.Mesh(
        np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]),
        np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], np.int32),
    )
    graph = sb.SaddleVertexGraph(mesh)
    cells = sb.geodesic_voronoi(graph, [0, 1, 2, 3])
    path = graph.path(0, 3)
    objects = [mesh, graph, cells, cells.dual(), cells.polygons(), cells.split(), sb.direction_field(mesh)]
    objects += [sb.ExactField(mesh, [1]), graph.log_map(1, 0.3), sb.voronoi_2d(np.eye(3)[:, :2]), path]
    objects += [sb.SurfaceCurve(mesh, path.surface), sb.sample(mesh, 5), sb.Job(), graph.paths([1], [2, 3])]
    return [*objects, sb.CellCache(), sb.SweepCircles(np.eye(3)[:, :2], np.zeros((1, 2)))]


METHODS = [(o, name) for o in some_objects() for name in dir(o) if not name.startswith("_")]


@pytest.mark.parametrize(("owner", "name"), METHODS, ids=[f"{type(o).__name__}.{name}" for o, name in METHODS])
def test_methods_refuse_strangers(owner, name):
    """In a process of its own a crash would name no method; here the last one begun is the one."""
    method = getattr(owner, name)
    if not callable(method) or name.startswith(("to_", "save")):  # of other packages, and files by the name of a
        return
    for first in (Stranger(), owner, -1, 10**9, "a", None, float("nan"), [Stranger()], np.zeros((0, 3)), {}):
        for count in range(3):
            told = refusal_of(method, first, *[Stranger()] * count)
            assert "Unable to cast" not in told

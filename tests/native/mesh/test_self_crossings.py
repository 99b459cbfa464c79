# SPDX-License-Identifier: MIT
"""Triangles that pass through each other."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_it_stops_when_silent

Point = list[Fraction]


def side(a: Point, b: Point, c: Point, d: Point) -> int:
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = ([x - y for x, y in zip(p, d, strict=True)] for p in (a, b, c))
    value = az * (bx * cy - by * cx) + bz * (cx * ay - cy * ax) + cz * (ax * by - ay * bx)
    return (value > 0) - (value < 0)


def pierces(p: Point, q: Point, t: list[Point]) -> bool:
    if side(*t, p) * side(*t, q) >= 0:
        return False
    sides = {side(p, q, t[i], t[(i + 1) % 3]) for i in range(3)}
    return len(sides) == 1 and 0 not in sides


def crossings_by_fractions(vertices: np.ndarray, triangles: np.ndarray) -> list[tuple[int, int]]:
    points = [[Fraction(float(x)) for x in vertex] for vertex in vertices]
    found = []
    for i, j in combinations(range(len(triangles)), 2):
        if len(set(triangles[i]) & set(triangles[j])) > 1:
            continue
        for one, other in ((triangles[i], triangles[j]), (triangles[j], triangles[i])):
            edges = ((one[k], one[(k + 1) % 3]) for k in range(3))
            if any(pierces(points[a], points[b], [points[v] for v in other]) for a, b in edges):
                found.append((i, j))
                break
    return found


@pytest.mark.parametrize("grain", [0, 2, 4, 16])
def test_as_fractions_tell(grain: int) -> None:
    """Random triangles over few vertices, many in one plane or with a corner on a side where these lie on a lattice."""
    random = np.random.default_rng(grain)
    vertices = random.random((14, 3))
    if grain:
        vertices = np.round(grain * vertices) / (3 * grain)
    triangles = np.array(list(combinations(range(14), 3)), np.int32)[random.permutation(364)[:70]]
    expected = crossings_by_fractions(vertices, triangles)
    found = sb.self_crossings(vertices, triangles)
    assert found.dtype == np.int32 and [tuple(pair) for pair in found.tolist()] == expected
    assert expected
    among = np.flatnonzero(random.random(len(triangles)) < 0.2)
    some = [pair for pair in expected if np.isin(pair, among).any()]
    assert [tuple(pair) for pair in sb.self_crossings(vertices, triangles, among).tolist()] == some
    owners = random.integers(-3, 4, len(triangles))
    for named, pairs in ((None, expected), (among, some)):
        found = sb.self_crossings(vertices, triangles, named, owners=owners)
        assert [tuple(pair) for pair in found.tolist()] == [(i, j) for i, j in pairs if owners[i] != owners[j]]


def test_a_needle_that_pricks_its_neighbor_by_a_millionth() -> None:
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.5], [0.3, 0.3, -1e-6], [1, 1, 0.51]])
    triangles = np.array([[0, 1, 2], [3, 4, 5]], np.int32)
    assert sb.self_crossings(vertices, triangles).tolist() == [[0, 1]]
    vertices[4, 2] = 1e-6
    assert len(sb.self_crossings(vertices, triangles)) == 0


def test_closed_surfaces_have_none_and_two_balls_a_ring_of_them() -> None:
    vertices, triangles = meshes.icosphere(4)
    assert sb.self_crossings(vertices, triangles).shape == (0, 2)
    both = np.concatenate([vertices, vertices + [0.9, 0.05, 0.02]])
    twice = np.concatenate([triangles, triangles + len(vertices)])
    found = sb.self_crossings(both, twice, threads=1)
    assert len(found) and (found[:, 0] < len(triangles)).all() and (found[:, 1] >= len(triangles)).all()
    # All lie about the plane in which the balls meet.
    middles = both[twice].mean(axis=1)[found.ravel()]
    way = np.array([0.9, 0.05, 0.02])
    assert np.abs((middles - way / 2) @ way / np.linalg.norm(way)).max() < 0.1
    assert sb.self_crossings(both, twice, threads=8).tobytes() == found.tobytes()
    assert sb.self_crossings(both, twice, np.unique(found[:, 1]), threads=8).tobytes() == found.tobytes()
    assert sb.self_crossings(both, twice, []).shape == (0, 2)
    whose = np.arange(len(twice)) // 100
    for threads in (1, 8):
        owned = sb.self_crossings(both, twice, owners=whose, threads=threads)
        assert owned.tobytes() == found.tobytes()  # no patch of a ball passes through itself
    assert sb.self_crossings(both, twice, owners=np.zeros(len(twice), int)).shape == (0, 2)
    order = np.random.default_rng(1).permutation(len(twice))
    again = np.sort(order[sb.self_crossings(both, twice[order])], axis=1)
    assert {tuple(pair) for pair in again.tolist()} == {tuple(pair) for pair in found.tolist()}


def test_nothing_and_bad_input() -> None:
    assert sb.self_crossings(np.zeros((0, 3)), np.zeros((0, 3), np.int32)).shape == (0, 2)
    with pytest.raises(sb.InputError, match="triangle 0 names vertex 3"):
        sb.self_crossings(np.zeros((3, 3)), [[0, 1, 3]])
    with pytest.raises(sb.InputError, match="vertex 1 is not finite"):
        sb.self_crossings([[0, 0, 0], [np.nan, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    for among in ([1, 0], [0, 0], [-1], [2]):
        with pytest.raises(sb.InputError, match=r"among: entry .* name each of 2 triangles once, in order"):
            sb.self_crossings(np.eye(3), [[0, 1, 2], [0, 2, 1]], among)
    with pytest.raises(sb.InputError, match="owners: 1 of them; name that of each of 2 triangles"):
        sb.self_crossings(np.eye(3), [[0, 1, 2], [0, 2, 1]], owners=[0])
    job = sb.Job()
    job.cancel()
    with pytest.raises(sb.Cancelled):
        sb.self_crossings(*meshes.icosphere(3), job=job)


def test_a_heap_in_which_all_cross_is_stopped_at_once() -> None:
    corners = np.random.default_rng(1).random((60_000, 3))
    heap = np.arange(60_000).reshape(-1, 3)
    check_it_stops_when_silent(lambda job: sb.self_crossings(corners, heap, job=job), 0.0)

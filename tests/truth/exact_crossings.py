# SPDX-License-Identifier: MIT
"""Whether triangles pass through each other, in fractions: for `self_crossings`."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations

import numpy as np

import saddleback as sb
from tests.truth.registry import guards

Point = tuple[Fraction, Fraction, Fraction]
Random = np.random.Generator


def minus(a: Point, b: Point) -> Point:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def side(a: Point, b: Point, c: Point, d: Point) -> int:
    """On which side of the plane (a, b, c) d lies: -1, 0, 1."""
    u, v, w = minus(b, a), minus(c, a), minus(d, a)
    det = u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0])
    return (det > 0) - (det < 0)


def segment_crosses(p: Point, q: Point, triangle: tuple[Point, Point, Point]) -> bool:
    """Whether the open segment passes through the open triangle, from one side of its plane to the other."""
    a, b, c = triangle
    if side(a, b, c, p) * side(a, b, c, q) >= 0:
        return False
    turns = {side(p, q, a, b), side(p, q, b, c), side(p, q, c, a)}
    return turns in ({1}, {-1})


def triangles_cross(s: tuple[Point, Point, Point], t: tuple[Point, Point, Point]) -> bool:
    """Whether an edge of one passes through the inside of the other."""
    return any(segment_crosses(one[i], one[(i + 1) % 3], other) for one, other in ((s, t), (t, s)) for i in range(3))


@guards("self_crossings")
def crossings(mesh: sb.Mesh, rng: Random) -> None:
    """Every pair of triangles of which an edge of one passes through the inside of the other is found."""
    chosen = rng.permutation(mesh.face_count)[:25]
    shift = rng.choice([0.0, 0.3]) * float(np.ptp(mesh.vertices)) * rng.normal(size=3)
    vertices = np.vstack([mesh.vertices, mesh.vertices + shift])
    triangles = np.vstack([mesh.triangles[chosen], mesh.triangles[chosen] + mesh.vertex_count]).astype(np.int32)
    found = {tuple(pair) for pair in sb.self_crossings(vertices, triangles).tolist()}
    corners = [tuple(tuple(map(Fraction, vertices[v].tolist())) for v in face) for face in triangles.tolist()]
    low, high = vertices[triangles].min(axis=1), vertices[triangles].max(axis=1)
    for a, b in combinations(range(len(triangles)), 2):
        if (low[a] > high[b]).any() or (low[b] > high[a]).any():
            assert (a, b) not in found, f"{a} and {b} lie apart"
            continue
        if triangles_cross(corners[a], corners[b]):  # type: ignore[arg-type]
            assert (a, b) in found or len({*triangles[a], *triangles[b]}) < 5, f"{a} and {b} cross"

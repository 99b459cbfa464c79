# SPDX-License-Identifier: MIT
"""Sites of the plane that sweeps find hard, and the proof that a diagram of any sites is right."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import saddleback as sb
from saddleback._saddleback import predicates

Points = NDArray[np.float64]


def uniform(n: int, rng: np.random.Generator) -> Points:
    return rng.random((n, 2))


def clusters(n: int, rng: np.random.Generator) -> Points:
    centers = rng.random((min(100, n), 2))
    return centers[rng.integers(len(centers), size=n)] + rng.normal(size=(n, 2)) * 0.003


def circle(n: int, rng: np.random.Generator) -> Points:
    angles = rng.random(n) * 2 * np.pi
    return np.column_stack([np.cos(angles), np.sin(angles)])


def grid(n: int, rng: np.random.Generator) -> Points:
    side = int(np.sqrt(n))
    points = np.column_stack([k.ravel() for k in np.meshgrid(np.arange(side), np.arange(side))])
    return rng.permutation(points).astype(float)


def nearly_collinear(n: int, rng: np.random.Generator) -> Points:
    x = rng.random(n)
    return np.column_stack([x, 0.3 * x + 1e-9 * rng.random(n)])


def duplicates(n: int, rng: np.random.Generator) -> Points:
    points = rng.random((max(1, n // 10), 2))
    return points[rng.integers(len(points), size=n)]


def collinear(n: int, rng: np.random.Generator) -> Points:
    return rng.permutation(n)[:, None] * np.array([3.0, 7.0])


def two_rings(n: int, rng: np.random.Generator) -> Points:
    inner = circle(n // 2, rng)
    return np.vstack([inner, 2 * inner])


def regular_polygon(n: int, _rng: np.random.Generator) -> Points:
    angles = 2 * np.pi * np.arange(n) / n
    return np.column_stack([np.cos(angles), np.sin(angles)])


def all_scales(n: int, rng: np.random.Generator) -> Points:
    return np.exp(8 * rng.normal(size=(n, 2))) * np.sign(rng.normal(size=(n, 2)))


def small_integers(n: int, rng: np.random.Generator) -> Points:
    return rng.integers(0, max(2, int(n**0.5)), size=(n, 2)).astype(float)


def near_twins(n: int, rng: np.random.Generator) -> Points:
    """Each second site next to another, 1e-6 to 1e-16 apart."""
    sites = rng.random((n, 2))
    apart = 10.0 ** rng.uniform(-16, -6, (n // 2, 1))
    sites[: n // 2] = sites[n - n // 2 :] + apart * rng.normal(size=(n // 2, 2))
    return sites


def huge(n: int, rng: np.random.Generator) -> Points:
    return 1e300 * (rng.random((n, 2)) - 0.5)


def tiny(n: int, rng: np.random.Generator) -> Points:
    return 1e-300 * (rng.random((n, 2)) - 0.5)


def far_away(n: int, rng: np.random.Generator) -> Points:
    return 1e9 + rng.random((n, 2))


KINDS: dict[str, Callable[[int, np.random.Generator], Points]] = {
    kind.__name__: kind
    for kind in (
        uniform, clusters, circle, grid, nearly_collinear, duplicates, collinear, two_rings, regular_polygon,
        all_scales, small_integers, near_twins, huge, tiny, far_away,
    )
}  # fmt: skip


def scaled(sites: Points) -> Points:
    """Exactly the same up to a power of two, so that the predicates can multiply."""
    largest = np.abs(sites).max(initial=0)
    return sites * 2.0**-900 if largest > 1e100 else sites * 2.0**900 if 0 < largest < 1e-100 else sites


def faults(diagram: sb.Voronoi2d) -> list[str]:
    """What is wrong with a diagram, by exact tests that share nothing with its making; empty: nothing."""
    sites, triangles, site_of = scaled(diagram.sites), diagram.delaunay, diagram.site_of
    n, edge_count, vertex_count = len(np.unique(sites + 0.0, axis=0)), len(diagram.edges), len(diagram.vertices)
    wrong = []
    if len(np.unique(site_of)) != n or (sites[site_of] != sites).any() or (site_of > np.arange(len(sites))).any():
        wrong.append("duplicates")
    if len(triangles) == 0:
        if vertex_count or edge_count != max(0, n - 1):
            wrong.append("strips")
        return wrong
    corners = [sites[column] for column in triangles.T]
    if (predicates.orient_2d(*corners) != 1).any():
        wrong.append("a triangle does not turn counter-clockwise")
    halves = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    opposite = triangles[:, [2, 0, 1]].ravel()
    key, twin_key = halves @ [len(sites), 1], halves @ [1, len(sites)]
    order = np.argsort(key)
    twin = order[np.minimum(np.searchsorted(key[order], twin_key), len(key) - 1)]
    inner = key[twin] == twin_key
    hull_count = np.count_nonzero(~inner)
    if len(np.unique(key)) != len(key) or len(triangles) != 2 * n - 2 - hull_count:
        wrong.append("not a triangulation")
    a, b = halves[inner].T
    signs = predicates.in_circle(*(sites[i] for i in (a, b, opposite[inner], opposite[twin[inner]])))
    if (signs > 0).any():
        wrong.append(f"{np.count_nonzero(signs > 0) // 2} edges are not Delaunay's")
    flat_count = np.count_nonzero(signs == 0) // 2
    if edge_count != (len(key) - hull_count) // 2 + hull_count - flat_count or n - edge_count + vertex_count != 1:
        wrong.append("edges of no length")
    following = dict(halves[~inner].tolist())
    hull = [next(iter(following))]
    while following[hull[-1]] != hull[0]:
        hull.append(following[hull[-1]])
    ring = [sites[np.roll(hull, -k)] for k in range(3)]
    if len(hull) != hull_count or (predicates.orient_2d(*ring) < 0).any():
        wrong.append("the border is not convex")
    return wrong

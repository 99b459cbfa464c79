# SPDX-License-Identifier: MIT
"""Weighted sites of the plane that are hard, and what brute force says of them."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from tests.native import plane_sites

Floats = NDArray[np.float64]


def spread(sites: Floats, rng: np.random.Generator, share: float = 1.0) -> Floats:
    """Weights up to a share of the mean distance of sites, so that some disks lie in others."""
    return rng.random(len(sites)) * share * np.ptp(sites, axis=0).max(initial=0) / max(1, len(sites)) ** 0.5


def random_disks(n: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    sites = rng.random((n, 2))
    return sites, spread(sites, rng)


def small_disks(n: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    sites = rng.random((n, 2))
    return sites, spread(sites, rng, 0.2) - 5


def clustered_disks(n: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    sites = plane_sites.clusters(n, rng)
    return sites, spread(sites, rng, 0.1)


def grid_of_integers(n: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    sites = plane_sites.grid(n, rng)
    return sites, rng.integers(0, 3, len(sites)).astype(float)


def tangent_disks(n: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Pythagorean triples: many disks touch others from inside."""
    steps = np.array([[0, 0], [3, 4], [4, 3], [-3, 4], [5, 0], [0, -5], [8, 6]])
    places = rng.integers(0, max(2, int(n**0.5)), (n, 2)) * 5 + steps[rng.integers(len(steps), size=n)]
    return places.astype(float), rng.integers(0, 3, n) * 5.0


def one_ring(n: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """All the same distance from the rims of a heavy disk in the middle: up to rounding one vertex, far in or out."""
    angles = rng.random(n) * 2 * np.pi
    distances = 2 + rng.random(n)
    sites = distances[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    return sites, distances - 1


def heavy_and_light(n: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    sites = rng.random((n, 2))
    return sites, np.where(rng.random(n) < 0.1, 0.2, 0.0) * rng.random(n)


def steep(n: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Weights that grow nearly as fast as distance, so that cells are long."""
    sites = rng.random((n, 2))
    return sites, 0.99 * sites[:, 0]


def in_line(n: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    sites = plane_sites.collinear(n, rng)
    return sites, rng.integers(0, 8, n).astype(float)


def repeated(n: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    sites = plane_sites.duplicates(n, rng)
    return sites, rng.integers(0, 3, n) * 0.01


def huge(n: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    sites = plane_sites.huge(n, rng)
    return sites, spread(sites, rng)


def tiny(n: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    sites = plane_sites.tiny(n, rng)
    return sites, spread(sites, rng)


KINDS: dict[str, Callable[[int, np.random.Generator], tuple[Floats, Floats]]] = {
    kind.__name__: kind
    for kind in (
        random_disks, small_disks, clustered_disks, grid_of_integers, tangent_disks, one_ring, heavy_and_light, steep,
        in_line, repeated, huge, tiny,
    )
}  # fmt: skip


def hidden(sites: Floats, weights: Floats) -> list[int]:
    """Sites whose disks lie in a heavier one's, or touch its rim from inside: exactly."""
    found = []
    for j, (p, w) in enumerate(zip(sites, weights, strict=True)):
        reach = np.maximum(weights - w, 0.0)
        away = np.hypot(*(sites - p).T)
        for i in np.nonzero((weights > w) & (away <= reach * (1 + 1e-9)))[0]:
            x, y = (Fraction(float(a)) - Fraction(float(b)) for a, b in zip(sites[i], p, strict=True))
            if x * x + y * y <= (Fraction(float(weights[i])) - Fraction(float(w))) ** 2:
                found.append(j)
                break
    return found


def weighted_distances(points: Floats, sites: Floats, weights: Floats) -> Floats:
    """(m, n)."""
    return np.hypot(*(points[:, None] - sites).transpose(2, 0, 1)) - weights

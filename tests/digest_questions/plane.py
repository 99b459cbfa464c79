# SPDX-License-Identifier: MIT
"""Questions about the plane: diagrams, their cells and sweeps, relaxation, predicates."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

import saddleback as sb
from saddleback._saddleback import predicates
from tests.digest_questions.asking import Way, all_of, asked, rounded
from tests.native import plane_sites, weighted_sites

FROM_DEVIATES = ("clusters", "circle", "two_rings", "regular_polygon", "all_scales")
SQUARE = np.array([(0.1, 0.1), (0.9, 0.1), (0.9, 0.9), (0.1, 0.9)])
HOLED = [SQUARE, np.array([(0.4, 0.4), (0.4, 0.6), (0.6, 0.6), (0.6, 0.4)])]
DIAGRAM = "site_of hidden vertices edges edge_sites edge_directions delaunay"
CLIPPED = "points loop_offsets loop_sites areas centroids"


def _plane(n: int) -> dict[str, NDArray[np.float64]]:
    kinds = {
        name: make(n, np.random.default_rng(n)) for name, make in plane_sites.KINDS.items() if name != "near_twins"
    }
    return {f"{name}-{n}": rounded(sites) if name in FROM_DEVIATES else sites for name, sites in kinds.items()}


def _weighted(n: int) -> dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]:
    made = {name: make(n, np.random.default_rng(n)) for name, make in weighted_sites.KINDS.items()}
    angular = ("clustered_disks", "one_ring")
    return {f"{k}-{n}": (rounded(v[0]), rounded(v[1])) if k in angular else v for k, v in made.items()}


PLANE = {**_plane(60), **_plane(5000)}
WEIGHTED = {**_weighted(60), **_weighted(1500)}
USUAL = {name: sites for name, sites in _plane(60).items() if name != "huge-60"}


@asked(PLANE, portable=True)
def diagram(sites: NDArray[np.float64], way: Way) -> Iterable[object]:
    made = sb.voronoi_2d(sites, threads=way.threads, device=way.device)
    return [*all_of(made, DIAGRAM), *made.cells, made.locate(sites[::3] * 1.01, threads=way.threads)]


@asked(PLANE, portable=True)
def diagram_areas(sites: NDArray[np.float64], way: Way) -> Iterable[object]:
    return all_of(sb.voronoi_2d(sites, threads=way.threads, device=way.device), "areas centroids")


@asked(WEIGHTED, portable=True)
def weighted_diagram(disks: tuple[NDArray[np.float64], NDArray[np.float64]], way: Way) -> Iterable[object]:
    made = sb.voronoi_2d(*disks, threads=way.threads, device=way.device)
    return [*all_of(made, DIAGRAM), *made.cells, made.locate(disks[0][::3] * 1.01, threads=way.threads)]


@asked({name: disks for name, disks in WEIGHTED.items() if not name.startswith("huge")}, portable=True)
def power_diagram(disks: tuple[NDArray[np.float64], NDArray[np.float64]], way: Way) -> Iterable[object]:
    made = sb.power_diagram_2d(disks[0], disks[1] * np.abs(disks[1]), threads=way.threads)
    clipped = made.clip(disks[0].min(axis=0) + float(np.ptp(disks[0], axis=0).max()) * SQUARE, threads=way.threads)
    return [*all_of(made, DIAGRAM), *made.cells, made.locate(disks[0][::3] * 1.01), *all_of(clipped, CLIPPED)]


PERIODIC = "vertices edges edge_shifts edge_sites edge_site_shifts corner_vertices corner_shifts delaunay areas"


@asked({name: PLANE[name] for name in ("uniform-60", "grid-60", "duplicates-60", "uniform-5000")}, portable=True)
def periodic_diagram(sites: NDArray[np.float64], way: Way) -> Iterable[object]:
    weights = 1e-3 * np.random.default_rng(1).random(len(sites))
    answer: list[object] = []
    for given in (None, weights):
        made = sb.periodic_voronoi_2d(sites, [(0, 0), (1, 0.5)], given, threads=way.threads)
        answer += [*all_of(made, PERIODIC), *made.cells, made.locate(sites[::3] * 1.01)]
    return answer


@asked({name: disks for name, disks in WEIGHTED.items() if not name.startswith("huge")})
def weighted_curves(disks: tuple[NDArray[np.float64], NDArray[np.float64]], way: Way) -> Iterable[object]:
    made = sb.voronoi_2d(*disks, threads=way.threads, device=way.device)
    size = float(np.ptp(disks[0], axis=0).max())
    low = disks[0].min(axis=0)
    clipped = made.clip(low + size * SQUARE, tolerance=1e-3 * size, threads=way.threads)
    lines = [made.edge_polyline(edge, 1e-3 * size, size) for edge in range(min(10, len(made.edges)))]
    return [*all_of(made, "areas centroids"), *lines, *all_of(clipped, CLIPPED)]


@asked({**USUAL, "uniform-5000": PLANE["uniform-5000"]}, portable=True)
def clipped_diagram(sites: NDArray[np.float64], way: Way) -> Iterable[object]:
    size, low = float(np.ptp(sites, axis=0).max()), sites.min(axis=0)
    made = sb.voronoi_2d(sites, threads=way.threads, device=way.device)
    return [
        *all_of(made.clip([low + size * loop for loop in HOLED], threads=way.threads), CLIPPED),
        *all_of(made.clip(low + size * SQUARE, gap=0.02 * size, threads=way.threads), CLIPPED),
    ]  # fmt: skip


@asked({"uniform-60": PLANE["uniform-60"], "uniform-5000": PLANE["uniform-5000"]}, portable=True)
def relaxed_2d(sites: NDArray[np.float64], way: Way) -> Iterable[object]:
    density = np.random.default_rng(1).random((8, 8))
    answer: list[object] = []
    for given in (None, density):
        done = sb.relax_2d(sites, HOLED, given, max_iterations=6, threads=way.threads)
        answer += all_of(done, "sites energy iterations converged")
    return answer


@asked({"uniform-60": PLANE["uniform-60"], "uniform-5000": PLANE["uniform-5000"]}, portable=True)
def balanced_2d(sites: NDArray[np.float64], way: Way) -> Iterable[object]:
    density = np.random.default_rng(1).random((8, 8))
    answer: list[object] = []
    for given in (None, density):
        done = sb.balance_2d(sites, HOLED, given, max_iterations=3, threads=way.threads)
        answer += all_of(done, "sites weights shares energy iterations converged")
    return answer


@asked({"uniform-60": PLANE["uniform-60"]})
def weighted_gaps_and_areas(sites: NDArray[np.float64], way: Way) -> Iterable[object]:
    weights = 0.1 * np.random.default_rng(1).random(len(sites))
    clipped = sb.voronoi_2d(sites, weights, threads=way.threads).clip(HOLED, gap=0.02, threads=way.threads)
    relaxed = sb.relax_2d(sites, HOLED, max_iterations=4, weights=weights, threads=way.threads)
    found = sb.weights_for_areas(0.1 + 0.8 * sites, SQUARE, max_iterations=4, threads=way.threads)
    answer: list[object] = []
    answer += all_of(clipped, "points loop_offsets loop_sites areas")
    answer += all_of(relaxed, "sites energy iterations converged")
    return answer + all_of(found, "weights shares lacks iterations converged")


@asked(USUAL)
def sweep_circle(sites: NDArray[np.float64]) -> Iterable[object]:
    size = float(np.ptp(sites, axis=0).max())
    sweep = sb.SweepCircle(sites, sites.mean(axis=0))
    sweep.grow(0.3 * size)
    answer: list[object] = [sweep.radius, sweep.beach_curve(16), np.array(sweep.arcs)]
    while (event := sweep.step()) is not None:
        answer += [event.kind == "touch", event.radius, event.sites, event.point]
    return [*answer, *sweep.edges]


@asked({**_weighted(60), **{name: (sites, None) for name, sites in _plane(60).items()}})
def sweep_circles(disks: tuple[NDArray[np.float64], Any]) -> Iterable[object]:
    sites, weights = disks
    size = float(np.ptp(sites, axis=0).max())
    sweep = sb.SweepCircles(sites, sites[[0, len(sites) // 2]], weights)
    sweep.grow(0.4 * size)
    steps = 0
    while sweep.step() is not None and steps < 200:
        steps += 1
    return [steps, sweep.radii, sweep.done, *sweep.edges(0), *sweep.edges(1)]


@asked({"nearly": 2.0**-52, "coarse": 2.0**-10}, portable=True)
def signs(step: float) -> Iterable[object]:
    """Of points nearly in a row and nearly on a circle."""
    random = np.random.default_rng(1)
    grid = lambda *shape: random.integers(-3, 4, shape) * step  # noqa: E731
    a, b, c, d = (np.array(place) + grid(400, 2) for place in ((0.5, 0.5), (12.0, 12.0), (24.0, 24.0), (12.0, 0.5)))
    p, q, r = (np.array(place) + grid(400, 3) for place in ((1.0, 1.0, 1.0), (2.0, 2.0, 2.0), (4.0, 4.0, 4.0)))
    circle = [np.array(place) + grid(400, 2) for place in ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))]
    return [
        predicates.orient_2d(a, b, c), predicates.in_circle(a, b, d, c), predicates.in_circle(*circle),
        predicates.collinear_3d(p, q, r),
    ]  # fmt: skip

# SPDX-License-Identifier: MIT
"""Weighted sites that get given areas, or go to the centers of their cells."""

from __future__ import annotations

import numpy as np
import pytest

import saddleback as sb
from tests.native.cancelling import check_progress_and_cancel

SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1]]
HOLED = [SQUARE, [[0.3, 0.3], [0.6, 0.3], [0.5, 0.7]]]
COMB = [[0, 0], [1, 0], [1, 1], [0.8, 1], [0.8, 0.2], [0.2, 0.2], [0.2, 1], [0, 1]]


def outside_the_hole(n, rng):
    places = rng.random((4 * n, 2))
    return places[(np.abs(places - 0.45) > 0.3).any(axis=1)][:n]


def test_what_is_hard_is_told():
    """Sites crowded into a corner, all of whose cells reach to the other: what is missing falls in every step."""
    rng = np.random.default_rng(8)
    found = sb.weights_for_areas(0.2 * rng.random((60, 2)), SQUARE, 0.3 + rng.random(60), max_iterations=9)
    assert (np.diff(found.lacks) < 0).all() and found.converged == (found.error <= 1e-4)


@pytest.mark.parametrize("domain", [SQUARE, HOLED])
@pytest.mark.parametrize("n", [1, 2, 10, 100])
def test_cells_have_the_wanted_areas(domain, n):
    rng = np.random.default_rng(n)
    sites, wanted = outside_the_hole(n, rng), 0.3 + rng.random(n)
    found = sb.weights_for_areas(sites, domain, 5 * wanted)
    assert found.converged and found.stop_reason == "tolerance" and found.error <= 1e-4
    assert (np.diff(found.lacks) < 0).all()
    areas = sb.voronoi_2d(sites, found.weights).clip(domain, tolerance=1e-7).areas
    np.testing.assert_allclose(areas / areas.sum(), wanted / wanted.sum(), rtol=3e-4)
    np.testing.assert_allclose(found.shares, areas / areas.sum(), rtol=3e-4)


def test_equal_areas_and_a_density():
    rng = np.random.default_rng(1)
    sites, tone = rng.random((40, 2)), rng.random((5, 7)) + 0.2
    found = sb.weights_for_areas(sites, SQUARE, density=tone, tolerance=1e-5)
    assert found.converged and np.ptp(found.shares) < 1e-6
    grid = (np.arange(1400) + 0.5) / 1400
    places = np.stack(np.meshgrid(grid, grid), axis=-1).reshape(-1, 2)
    masses = np.bincount(
        sb.voronoi_2d(sites, found.weights).locate(places),
        tone.repeat(280, axis=0).repeat(200, axis=1).ravel(),
    )
    assert np.ptp(masses) < 0.02 * masses.mean()


def test_two_sites():
    """All is symmetric about the way between two sites, and the weights are those of the border in the middle."""
    found = sb.weights_for_areas([[0.25, 0.5], [0.75, 0.5]], SQUARE, tolerance=1e-9)
    assert np.abs(found.weights).max() < 1e-9 and found.iterations == 0
    lopsided = sb.weights_for_areas([[0.1, 0.5], [0.3, 0.5]], SQUARE, [1, 1e-3])
    assert lopsided.converged and np.diff(lopsided.weights)[0] == pytest.approx(-0.2, abs=1e-2)


def test_few_steps_are_told():
    sites = np.random.default_rng(2).random((50, 2))
    found = sb.weights_for_areas(sites, SQUARE, max_iterations=1)
    assert found.iterations == 1 and not found.converged and found.stop_reason == "max_iterations"
    assert found.error > 1e-4
    assert "off" in repr(found)


def test_threads_and_units_change_nothing():
    sites = outside_the_hole(200, np.random.default_rng(3))
    one, two = (sb.weights_for_areas(sites, HOLED, threads=threads) for threads in (1, 2))
    assert one.weights.tobytes() == two.weights.tobytes()
    unit = sb.weights_for_areas(2.0**20 * sites, [2.0**20 * np.array(loop) for loop in HOLED])
    np.testing.assert_allclose(unit.weights, 2.0**20 * one.weights, rtol=1e-9)


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"sites": np.zeros((0, 2))}, "sites: wanted at least one"),
        ({"areas": [1, 0, 2]}, "areas: area 1 is 0, wanted a positive number"),
        ({"areas": [1, 2, -3]}, "areas: area 2 is -3, wanted a positive number"),
        ({"areas": [np.inf, 2, 3]}, "areas: area 0 is inf, wanted a positive number"),
        ({"areas": [1e308, 1e308, 1e308]}, "areas: their sum is more than any number"),
        ({"areas": [1, 2]}, r"areas: wanted shape \(3,\)"),
        ({"max_iterations": -1}, "max_iterations: wanted 0 or more, got -1"),
        ({"tolerance": -1.0}, "tolerance: wanted 0 or more, got -1"),
        ({"density": np.zeros((3, 3))}, "density: it is 0 all over the domain"),
        ({"sites": [[0.5, 0.5], [3, 3], [0.2, 0.2]]}, "sites: the cell of site 1 has no mass: it lies outside"),
        ({"sites": [[0.5, 0.5], [0.5, 0.5], [0.2, 0.2]]}, "sites: the cell of site 1 has no mass: .* another site is"),
    ],
)
def test_what_makes_no_sense_is_refused(options, sentence):
    with pytest.raises(sb.InputError, match=sentence):
        sb.weights_for_areas(**{"sites": [[0.1, 0.1], [0.9, 0.2], [0.4, 0.8]], "domain": SQUARE, **options})


def test_it_can_be_watched_and_stopped():
    sites = np.random.default_rng(1).random((8000, 2))
    check_progress_and_cancel(lambda job: sb.weights_for_areas(sites, SQUARE, job=job), 0.1)


@pytest.mark.parametrize("domain", [SQUARE, HOLED, COMB])
def test_weighted_sites_rest_in_the_centers_of_their_cells(domain):
    rng = np.random.default_rng(5)
    sites, weights = rng.random((60, 2)), 0.06 * rng.random(60)
    done = sb.relax_2d(sites, domain, max_iterations=2000, tolerance=1e-6, weights=weights)
    assert done.converged and done.stop_reason == "tolerance"
    cells = sb.voronoi_2d(done.sites, weights).clip(domain)
    alive = cells.areas > 0
    assert alive.sum() >= 40  # the others are hidden, or outside
    assert np.linalg.norm(cells.centroids - done.sites, axis=1)[alive].max() < 1e-4
    start = sb.voronoi_2d(sites, weights).clip(domain)
    off = np.linalg.norm(start.centroids - sites, axis=1)[start.areas > 0]
    assert off.max() > 1e-2


def test_equal_weights_relax_as_none():
    sites = np.random.default_rng(6).random((40, 2))
    plain, equal = (sb.relax_2d(sites, SQUARE, max_iterations=9, tolerance=0, weights=w) for w in (None, np.ones(40)))
    assert plain.sites.tobytes() == equal.sites.tobytes() and plain.energy.tobytes() == equal.energy.tobytes()


def test_hidden_sites_stay():
    sites = np.array([[0.4, 0.5], [0.45, 0.5], [0.9, 0.5]])
    done = sb.relax_2d(sites, SQUARE, max_iterations=3, weights=[0.3, 0.1, 0.0])
    assert (done.sites[1] == sites[1]).all() and (done.sites[0] != sites[0]).any()


@pytest.mark.parametrize(
    ("weights", "sentence"),
    [([1.0], r"weights: wanted shape \(2,\)"), ([0, np.nan], "weight 1 is nan"), ([0, np.inf], "weight 1 is inf")],
)
def test_weights_that_are_none(weights, sentence):
    with pytest.raises(sb.InputError, match=sentence):
        sb.relax_2d([[0.2, 0.2], [0.7, 0.7]], SQUARE, weights=weights)


def test_sites_in_clusters_share_the_area() -> None:
    """Six of them on a ten-thousandth of the square: all but steps of a millionth lost the cells in the middle."""
    missed = 0
    for seed in range(12):
        rng = np.random.default_rng(seed)
        sites = np.vstack([rng.random((6, 2)), 1e-4 * rng.random((6, 2)) + 0.5, 1e-4 * rng.random((6, 2)) + 0.1])
        missed += not sb.weights_for_areas(sites, SQUARE).converged
    assert missed == 0  # all 12

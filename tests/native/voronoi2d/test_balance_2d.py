# SPDX-License-Identifier: MIT
"""Cells of given capacities: met in domains of every sort, from sites of every sort, or refused in a sentence."""

from __future__ import annotations

import numpy as np
import pytest

import saddleback as sb
from tests.native.cancelling import check_progress_and_cancel, seconds_to_stop
from tests.native.voronoi2d.test_voronoi_2d_cells import COMB, DOMAINS, HOLES, SQUARE

HEXAGON_ENERGY = 5 / (18 * np.sqrt(3))
"""Of regular hexagons, in squares of their area: no cells of one size have less (L. Fejes Toth)."""


@pytest.mark.parametrize("domain", DOMAINS)
@pytest.mark.parametrize("count", [1, 2, 40, 700])
def test_cells_have_one_size_in_any_domain(domain: str, count: int) -> None:
    sites = np.random.default_rng(count).random((count, 2))
    done = sb.balance_2d(sites, DOMAINS[domain], max_iterations=8)
    clipped = sb.power_diagram_2d(done.sites, done.weights, DOMAINS[domain]).clipped
    assert clipped is not None
    assert clipped.areas == pytest.approx(clipped.areas.sum() / count, rel=1e-5)
    assert done.shares == pytest.approx(1 / count, rel=1e-5)
    assert (np.diff(done.energy) <= 0).all()
    assert abs(done.weights.mean()) < 1e-12


def test_they_become_regular_hexagons_nearly() -> None:
    done = sb.balance_2d(np.random.default_rng(1).random((300, 2)), SQUARE, max_iterations=100)
    assert HEXAGON_ENERGY < done.energy[-1] * 300 < 1.04 * HEXAGON_ENERGY
    areas = sb.power_diagram_2d(done.sites, done.weights, SQUARE).clipped.areas
    plain = sb.relax_2d(np.random.default_rng(1).random((300, 2)), SQUARE)
    assert np.std(areas) * 300 < 1e-5
    assert np.std(sb.voronoi_2d(plain.sites, domain=SQUARE).clipped.areas) * 300 > 0.03  # what it is for


def test_sites_stay_where_they_have_to_and_capacities_are_their_own() -> None:
    rng = np.random.default_rng(3)
    sites, shares = rng.random((60, 2)), rng.random(60) + 0.2
    shares /= shares.sum()
    done = sb.balance_2d(sites, SQUARE, capacities=shares, max_iterations=0, capacity_tolerance=1e-9)
    assert (done.sites == sites).all()
    assert done.converged
    assert done.shares == pytest.approx(shares, rel=1e-8)
    # Of all partitions with these masses none has less energy: not the one by other weights of the same sites either.
    other = sb.voronoi_2d(sites, domain=SQUARE).clipped.areas
    again = sb.balance_2d(sites, SQUARE, capacities=other / other.sum(), max_iterations=0)
    assert np.abs(again.weights).max() < 1e-9


def test_dots_have_the_tone_of_an_image_with_white_parts() -> None:
    rows, columns = np.mgrid[0:64, 0:64] / 63
    tone = np.where((rows - 0.5) ** 2 + (columns - 0.5) ** 2 < 0.16, 0.2 + columns, 0.0)
    sites = np.random.default_rng(5).random((800, 2))  # half of them in the white part
    sites[7] = sites[8]
    done = sb.balance_2d(sites, SQUARE, tone, max_iterations=10)
    assert done.capacity_error < 1e-5
    assert ((done.sites - 0.5) ** 2).sum(axis=1).max() < 0.19
    assert np.ptp(done.shares) < 1e-7
    columns_of = np.histogram(done.sites[:, 0], bins=4, range=(0, 1))[0] / 800
    wanted = tone.reshape(64, 4, 16).sum(axis=(0, 2)) / tone.sum()
    assert np.abs(columns_of - wanted).max() < 0.01


def test_masses_apart_are_shared_all_the_same() -> None:
    """Between two bars of ink lies nothing: cells beside each other there have no mass along their common side."""
    tone = np.zeros((1, 10))
    tone[0, [0, 9]] = 1, 2
    done = sb.balance_2d(np.random.default_rng(2).random((30, 2)), SQUARE, tone, max_iterations=30)
    assert done.capacity_error < 1e-5
    assert (done.sites[:, 0] < 0.1).sum() == 10


def test_a_function_an_outline_far_away_and_any_unit() -> None:
    sites = np.random.default_rng(4).random((50, 2))
    far = [np.array(loop) * 1e3 + 1e6 for loop in HOLES]
    done = sb.balance_2d(sites * 1e3 + 1e6, far, lambda at: at[:, 0] - 1e6 + 100, max_iterations=5)
    assert done.capacity_error < 1e-5
    for unit in (1e-6, 1e9):
        scaled = sb.balance_2d(sites * unit, np.array(COMB) * unit, max_iterations=5)
        assert scaled.capacity_error < 1e-5
        assert scaled.energy[-1] / unit**4 == pytest.approx(sb.balance_2d(sites, COMB, max_iterations=5).energy[-1])


def test_threads_change_nothing() -> None:
    sites = np.random.default_rng(6).random((3000, 2))
    one, three = (sb.balance_2d(sites, HOLES, max_iterations=2, threads=threads) for threads in (1, 3))
    assert one.sites.tobytes() == three.sites.tobytes()
    assert one.weights.tobytes() == three.weights.tobytes()


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"sites": np.zeros((0, 2))}, "sites: wanted at least one"),
        (
            {"capacities": [0.5, 0.2, 0.1]},
            "capacities: they sum to 0.8, wanted shares of the whole mass, which sum to 1",
        ),
        ({"capacities": [1.5, -0.2, -0.3]}, "capacities: capacity 1 is -0.2, wanted a positive number"),
        ({"capacities": [0.5, np.nan, 0.5]}, "capacities: capacity 1 is nan"),
        ({"capacities": [0.5, 0.5]}, r"capacities: wanted shape \(3,\)"),
        ({"density": np.zeros((3, 3))}, "density: it is 0 all over the domain"),
        ({"density": [[1, -1]]}, "density: wanted finite values of 0 or more, got -1 in row 0, column 1"),
        ({"max_iterations": -1}, "max_iterations: wanted 0 or more, got -1"),
        ({"capacity_tolerance": -1.0}, "capacity_tolerance: wanted 0 or more, got -1"),
        ({"tolerance": np.nan}, "tolerance: wanted 0 or more, got nan"),
        (
            {"sites": [[0.5, 0.5], [3, 3], [0.2, 0.2]], "max_iterations": 0},
            "sites: the cell of site 1 has no mass: it lies outside",
        ),
        (
            {"sites": [[0.5, 0.5], [0.5, 0.5], [0.2, 0.2]], "max_iterations": 0},
            "sites: the cell of site 1 has no mass: .* where another site is",
        ),
    ],
)
def test_what_makes_no_sense_is_refused(options: dict[str, object], sentence: str) -> None:
    given: dict[str, object] = {"sites": [[0.1, 0.1], [0.9, 0.2], [0.4, 0.8]], "domain": SQUARE, **options}
    with pytest.raises(sb.InputError, match=sentence):
        sb.balance_2d(**given)  # type: ignore[arg-type]


def test_it_can_be_watched_and_stopped() -> None:
    sites = np.random.default_rng(1).random((20_000, 2))
    check_progress_and_cancel(lambda job: sb.balance_2d(sites, SQUARE, job=job), 0.05)
    assert seconds_to_stop(lambda job: sb.balance_2d(sites, SQUARE, job=job), lambda job: job.fraction > 0.01) < 0.1

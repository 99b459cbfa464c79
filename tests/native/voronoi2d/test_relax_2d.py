# SPDX-License-Identifier: MIT
"""Relaxation in the plane: exact integrals, an energy that never rises, cells that follow a density."""

from __future__ import annotations

import numpy as np
import pytest

import saddleback as sb
from tests.native.cancelling import check_progress_and_cancel

SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
HOLED = [[(0, 0), (3, 0), (3, 2), (0, 2)], [(1, 0.5), (1, 1.5), (2, 1.5), (2, 0.5)]]
NOTCHED = [(0, 0), (2, 0), (2, 1), (1.2, 0.4), (0.7, 1.6), (0, 1)]


def middles(rows: int, columns: int, low=(0, 0), high=(1, 1)) -> np.ndarray:
    x = low[0] + (np.arange(columns) + 0.5) / columns * (high[0] - low[0])
    y = low[1] + (np.arange(rows) + 0.5) / rows * (high[1] - low[1])
    return np.stack(np.meshgrid(x, y), axis=-1)


def test_one_site_goes_to_the_center_of_mass():
    density = np.random.default_rng(0).random((7, 5))
    center = np.average(middles(7, 5).reshape(-1, 2), axis=0, weights=density.ravel() ** 2)
    done = sb.relax_2d([(0.9, 0.1)], SQUARE, density)
    np.testing.assert_allclose(done.sites, [center], atol=1e-14)
    assert done.converged and done.iterations == 2 and done.stop_reason == "tolerance"


def test_the_energy_is_that_of_fine_sums():
    """Every rectangle of the density is cut into so many that sums over middles are good to 1e-5."""
    rng = np.random.default_rng(1)
    sites, density = rng.random((40, 2)) * (2, 1.6), rng.random((6, 9))
    fine = middles(6 * 160, 9 * 160, high=(2, 1.6)).reshape(-1, 2)
    corners = np.array(NOTCHED)
    inside = np.zeros(len(fine), bool)
    for (ax, ay), (bx, by) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        crosses = (ay > fine[:, 1]) != (by > fine[:, 1])
        inside ^= crosses & (fine[:, 0] < ax + (fine[:, 1] - ay) / (by - ay if by != ay else 1) * (bx - ax))
    weights = np.kron(density, np.ones((160, 160))).ravel() ** 2 * inside
    nearest = sb.voronoi_2d(sites).locate(fine)
    squared = ((fine - sites[nearest]) ** 2).sum(axis=1)
    energy = (weights * squared).sum() * (2 * 1.6) / len(fine)
    assert sb.relax_2d(sites, NOTCHED, density, max_iterations=0).energy[0] == pytest.approx(energy, rel=2e-4)


@pytest.mark.parametrize("domain", [SQUARE, HOLED, NOTCHED], ids=["square", "holed", "notched"])
@pytest.mark.parametrize("shape", [None, (1, 1), (13, 17)], ids=str)
def test_the_energy_never_rises_and_cells_become_even(domain, shape):
    rng = np.random.default_rng(2)
    sites = rng.random((150, 2))
    density = None if shape is None else 0.2 + rng.random(shape)
    done = sb.relax_2d(sites, domain, density, max_iterations=25, tolerance=0)
    assert (np.diff(done.energy) <= 0).all() and len(done.energy) == done.iterations + 1
    assert done.energy[-1] < 0.8 * done.energy[0]
    if shape is None:
        cells = sb.voronoi_2d(done.sites, domain=domain).clipped
        assert np.nanmax(np.linalg.norm(cells.centroids - done.sites, axis=1)) < 0.1
        before = sb.voronoi_2d(sites, domain=domain).clipped.areas
        assert cells.areas.std() < 0.5 * before.std()


def test_uniform_by_any_name():
    sites = np.random.default_rng(3).random((80, 2))
    plain = sb.relax_2d(sites, SQUARE, max_iterations=20)
    for density in (np.full((1, 1), 3.0), np.full((31, 20), 0.5), lambda places: np.ones(len(places))):
        np.testing.assert_allclose(
            sb.relax_2d(sites, SQUARE, density, max_iterations=20).sites, plain.sites, atol=1e-10
        )


@pytest.mark.parametrize("share", [0.75, 0.6])
def test_sites_per_area_follow_the_density(share):
    """Three times the density on the right: three times the cells rest there, and fewer draw others over."""
    rng = np.random.default_rng(4)
    sites = rng.random((120, 2)) * (0.5, 1)
    sites[: round(share * 120), 0] += 0.5
    done = sb.relax_2d(sites, SQUARE, [[1.0, 3.0]], max_iterations=300, tolerance=0)
    reached = np.count_nonzero(done.sites[:, 0] > 0.5) / 120
    # The unsquared density would rest at 0.634; rows of cells along the jump take a little off.
    assert reached == pytest.approx(0.75, abs=0.05) if share == 0.75 else reached > 0.66


def test_a_callable_is_asked_in_the_middles_of_rectangles():
    seen = []

    def density(places):
        seen.append(places)
        return places[:, 0]

    sites = np.random.default_rng(5).random((50, 2))
    by_callable = sb.relax_2d(sites, SQUARE, density, max_iterations=10, samples=16)
    np.testing.assert_allclose(seen[0].reshape(16, 16, 2), middles(16, 16))
    by_array = sb.relax_2d(sites, SQUARE, middles(16, 16)[:, :, 0], max_iterations=10)
    assert by_callable.sites.tobytes() == by_array.sites.tobytes()


def test_far_away_is_the_same():
    sites = np.random.default_rng(6).random((60, 2))
    near = sb.relax_2d(sites, SQUARE, max_iterations=15)
    far = sb.relax_2d(sites + 1e6, np.array(SQUARE) + 1e6, max_iterations=15)
    np.testing.assert_allclose(far.sites - 1e6, near.sites, atol=1e-7)


def test_sites_without_mass_stay():
    sites = [(0.2, 0.3), (0.2, 0.3), (0.9, 0.9), (5, 5), (0.3, 0.8)]
    density = np.zeros((8, 8))
    density[:4, :4] = 1
    done = sb.relax_2d(sites, SQUARE, density, max_iterations=1)
    assert (done.sites[[1, 3]] == np.array(sites)[[1, 3]]).all()
    assert (done.sites[2] == sites[2]).all()
    assert (done.sites[0] != sites[0]).any()


def test_any_number_of_threads_gives_the_same():
    rng = np.random.default_rng(7)
    sites, density = rng.random((3000, 2)), rng.random((64, 64))
    one, two, seven = (sb.relax_2d(sites, SQUARE, density, max_iterations=4, threads=n) for n in (1, 2, 7))
    assert one.sites.tobytes() == two.sites.tobytes() == seven.sites.tobytes()
    assert one.energy.tobytes() == two.energy.tobytes() == seven.energy.tobytes()


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"sites": np.zeros((0, 2))}, "at least one site"),
        ({"sites": [(np.nan, 0)]}, "site"),
        ({"domain": SQUARE[:2]}, "2 corners"),
        ({"density": [[1.0, -1.0]]}, "got -1 in row 0, column 1"),
        ({"density": [[1.0, np.inf]]}, "got inf in row 0, column 1"),
        ({"density": np.zeros((3, 3))}, "0 all over the domain"),
        ({"density": np.zeros(3)}, r"shape \(rows, columns\)"),
        ({"density": "dark"}, r"shape \(rows, columns\)"),
        ({"density": lambda places: places}, "density"),
        ({"max_iterations": -1}, "max_iterations"),
        ({"tolerance": -1.0}, "tolerance"),
        ({"samples": 0, "density": lambda places: places[:, 0]}, "samples"),
    ],
)
def test_what_is_refused(arguments, text):
    with pytest.raises(sb.InputError, match=text):
        sb.relax_2d(**{"sites": [(0.5, 0.5)], "domain": SQUARE, **arguments})


def test_progress_and_cancel():
    sites = np.random.default_rng(8).random((100_000, 2))
    check_progress_and_cancel(lambda job: sb.relax_2d(sites, SQUARE, max_iterations=30, job=job), 0.1)


@pytest.mark.parametrize("unit", [2.0**-1000, 1e-300, 1e-200, 2.0**400, 1e200, 1e307])
def test_only_ratios_of_densities_count(unit):
    rng = np.random.default_rng(8)
    sites, density = rng.random((20, 2)), rng.random((13, 17)) + 0.1
    plain = sb.relax_2d(sites, SQUARE, density, max_iterations=20)
    other = sb.relax_2d(sites, SQUARE, unit * density, max_iterations=20)
    assert np.allclose(other.sites, plain.sites, rtol=0, atol=1e-12)
    assert other.iterations == plain.iterations

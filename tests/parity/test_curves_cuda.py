# SPDX-License-Identifier: MIT
"""Diagrams of sites along lines and circles, whose circles are far larger than the sites are apart."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pytest

import saddleback as sb
from tests.native import plane_sites
from tests.parity.cancelling import expect_to_stop_within_a_moment
from tests.parity.test_voronoi_cuda import DEVICES, expect_kept, expect_twins

Points = plane_sites.Points
Rng = np.random.Generator
ARRAYS = ("site_of", "vertices", "edges", "edge_sites", "delaunay")


def near_a_line(angle: float, n: int, rng: Rng) -> Points:
    """A billionth of its length off it at most."""
    along, across = rng.random(n), 1e-9 * rng.random(n)
    c, s = np.cos(angle), np.sin(angle)
    return np.column_stack([c * along - s * across, s * along + c * across])


def lines(n: int, rng: Rng) -> Points:
    parts = [near_a_line(angle, n // 3, rng) for angle in (0.1, 1.3, 2.2)]
    return np.concatenate([part + [0.3 * i, 0.1 * i] for i, part in enumerate(parts)])


def parallel_lines(n: int, rng: Rng) -> Points:
    return np.concatenate([near_a_line(0.4, n // 2, rng) + [0, y] for y in (0, 0.01)])


def circle_and_center(n: int, rng: Rng) -> Points:
    return np.vstack([plane_sites.circle(n - 1, rng), [[0, 0]]])


def part_of_a_large_circle(n: int, rng: Rng) -> Points:
    angles = 0.3 + 0.01 * rng.random(n)
    return 100 + 1e3 * np.column_stack([np.cos(angles), np.sin(angles)])


def parabola(n: int, rng: Rng) -> Points:
    x = rng.uniform(-1, 1, n)
    return np.column_stack([x, x * x])


def line_among_others(n: int, rng: Rng) -> Points:
    return np.vstack([rng.random((n - n // 2, 2)), near_a_line(0.4, n // 2, rng)])


def circle_among_others(n: int, rng: Rng) -> Points:
    return np.vstack([rng.uniform(-1, 1, (n - n // 2, 2)), 0.7 * plane_sites.circle(n // 2, rng)])


CURVES: dict[str, Callable[[int, Rng], Points]] = {
    **{f"line at {angle}": lambda n, rng, angle=angle: near_a_line(angle, n, rng) for angle in (0.0, 0.3, 0.785, 1.57)},
    "line down": lambda n, rng: near_a_line(-1.1, n, rng),
    "circle": plane_sites.circle,
    "circle far away": lambda n, rng: 1e6 + plane_sites.circle(n, rng),
    "part of a large circle": part_of_a_large_circle,
    "line among others": line_among_others,
    "circle among others": circle_among_others,
    "lines": lines,
    "parallel lines": parallel_lines,
    "circle and center": circle_and_center,
    "parabola": parabola,
    "two rings": plane_sites.two_rings,
}
ALONE = tuple(CURVES)[:8]  # those that a device finds by itself, whatever their number


def expect_large_twins(sites: np.ndarray) -> Iterator[sb.Voronoi2d]:
    """As expect_twins, one after the other and without all cells, which take a while."""
    own = sb.voronoi_2d(sites, device="cpu")
    for device in DEVICES[:2]:
        twin = sb.voronoi_2d(sites, device=device)
        for name in ARRAYS:
            assert getattr(twin, name).tobytes() == getattr(own, name).tobytes(), (device, name)
        yield twin


@pytest.mark.parametrize("n", [4, 11, 100, 1000])
@pytest.mark.parametrize("kind", CURVES)
def test_the_same_diagram(kind: str, n: int) -> None:
    expect_twins(CURVES[kind](n, np.random.default_rng(n)))


@pytest.mark.parametrize(
    ("kind", "n"),
    [(kind, n) for kind in CURVES for n in (10_000, 30_000)] + [(kind, n) for kind in ALONE for n in (10**5, 10**6)],
)
def test_the_same_large_diagram(kind: str, n: int) -> None:
    for twin in expect_large_twins(CURVES[kind](n, np.random.default_rng(n))):
        if kind in ALONE:
            assert twin.device.startswith("cuda")
            assert twin.device_times is not None and twin.device_times["find"] > 0


@pytest.mark.parametrize("kind", ["parabola", "two rings"])
def test_long_merges_are_left_to_the_processor(kind: str) -> None:
    for twin in expect_large_twins(CURVES[kind](10**6, np.random.default_rng(1))):
        assert twin.device == "cpu"


def test_long_merges_go_on_where_nobody_else_can_do_them() -> None:
    sites = CURVES["parabola"](300_000, np.random.default_rng(1))
    expect_kept(sb.voronoi_2d_on_device(sites), sb.voronoi_2d(sites, device="cpu"))


@pytest.mark.parametrize("after", [0, 0.04])
def test_cells_with_many_sides_are_left_within_a_moment(after: float) -> None:
    """To unite the widest takes a lane a fifth of a second."""
    sites = CURVES["lines"](300_000, np.random.default_rng(1))
    expect_to_stop_within_a_moment(lambda job: sb.voronoi_2d(sites, device="cuda", job=job), after, beyond=0.5)


def test_triangles_of_cells_with_many_sides_are_left_within_a_moment() -> None:
    """To count those of the widest cell takes a lane a tenth of a second."""
    sites = CURVES["lines"](1_000_000, np.random.default_rng(1))

    def work(job: sb.Job | None = None) -> sb.DeviceVoronoi2d:
        return sb.voronoi_2d_on_device(sites, only_triangles=True, job=job)

    work()  # or the driver would be about its memory when asked
    expect_to_stop_within_a_moment(work, after=0, beyond=0.5, within=0.06)


@pytest.mark.parametrize("kind", ALONE)
def test_what_stays_on_the_device_is_the_same(kind: str) -> None:
    sites = CURVES[kind](20_000, np.random.default_rng(1))
    own = sb.voronoi_2d(sites, device="cpu")
    expect_kept(sb.voronoi_2d_on_device(sites), own)
    assert sb.voronoi_2d_on_device(sites, only_triangles=True).triangles.numpy().tobytes() == own.delaunay.tobytes()


@pytest.mark.parametrize("seed", range(30))
def test_strips_of_integers(seed: int) -> None:
    """Most of them on one line, or on one circle with others."""
    rng = np.random.default_rng(seed)
    sites = rng.integers([0, 0], [int(rng.integers(5, 400)), int(rng.integers(2, 5))], (int(rng.integers(5, 300)), 2))
    turn = np.array([[1, 0], [0, 1]] if seed % 3 == 0 else [[3, 1], [-1, 3]] if seed % 3 == 1 else [[0, 1], [1, 0]])
    expect_twins((sites @ turn).astype(float))


@pytest.mark.parametrize("seed", range(10))
def test_integers_on_one_circle(seed: int) -> None:
    """A hundred and more exactly on it, some beside it."""
    radius = 5 * 13 * 17 * 29
    x = np.arange(-radius, radius + 1)
    y = np.sqrt(radius**2 - x * x).round().astype(np.int64)
    on = x[x * x + y * y == radius**2]
    up = np.sqrt(radius**2 - on * on).round().astype(np.int64)
    sites = np.concatenate([np.column_stack([on, up]), np.column_stack([on, -up])])
    rng = np.random.default_rng(seed)
    sites = rng.permutation(
        np.concatenate([sites, sites[: 3 * seed] + rng.integers(-1, 2, (min(3 * seed, len(sites)), 2))])
    )
    expect_twins(sites.astype(float))

# SPDX-License-Identifier: MIT
"""The sweep circle made visible: events, ellipse arcs, growing edges."""

from __future__ import annotations

import numpy as np
import pytest

import saddleback as sb
from tests.native import plane_sites


def run(sweep):
    events = []
    while (event := sweep.step()) is not None:
        events.append(event)
    return events


CENTERS = {"inside": [0.4, 0.6], "outside": [3.0, -2.0], "far": [500.0, 40.0], "on a site": None}


@pytest.mark.parametrize("center", CENTERS)
@pytest.mark.parametrize("n", [1, 2, 3, 4, 10, 300])
def test_the_triangles_do_not_depend_on_the_center(n, center):
    sites = plane_sites.uniform(n, np.random.default_rng(n))
    place = sites[0] if CENTERS[center] is None else CENTERS[center]
    events = run(sb.SweepCircle(sites, place))
    assert [event.kind for event in events].count("touch") == n
    found = {frozenset(event.sites.tolist()) for event in events if event.kind == "vanish"}
    assert found == {frozenset(t) for t in sb.voronoi_2d(sites).delaunay.tolist()}


def test_events_come_in_the_order_of_their_radius():
    sites = plane_sites.uniform(200, np.random.default_rng(1))
    center = np.array([0.5, 0.5])
    sweep = sb.SweepCircle(sites, center)
    last = 0.0
    while (event := sweep.step()) is not None:
        assert event.radius == sweep.radius >= last
        last = event.radius
        to_point = np.linalg.norm(event.point - center)
        to_site = np.linalg.norm(event.point - sites[event.sites], axis=1)
        assert np.allclose(to_point + to_site, event.radius, rtol=1e-9)  # 0 for the site touched


@pytest.mark.parametrize("radius", [0.2, 0.45, 0.8, 3.0])
def test_the_beach_curve_is_equally_far_from_the_sites_and_the_circle(radius):
    sites = plane_sites.uniform(100, np.random.default_rng(2))
    sweep = sb.SweepCircle(sites, [0.5, 0.4])
    sweep.grow(radius)
    curve = sweep.beach_curve(360)
    from_center = np.linalg.norm(curve - sweep.center, axis=1)
    to_sites = np.linalg.norm(curve[:, None] - sites, axis=2)
    assert np.allclose(to_sites.min(axis=1), radius - from_center, atol=1e-12)
    covered = sum(end - begin for _, begin, end in sweep.arcs)
    assert covered == pytest.approx(2 * np.pi)
    for site, begin, end in sweep.arcs:
        angle = 0.5 * (begin + end)
        nearest = curve[round(angle / np.pi * 180) % 360]
        if end - begin > 0.1:
            assert np.linalg.norm(nearest - sites, axis=1).argmin() == site


def test_edges_grow_along_the_beach_curve():
    sites = plane_sites.uniform(60, np.random.default_rng(3))
    sweep = sb.SweepCircle(sites, [0.5, 0.5])
    for radius in (0.1, 0.3, 0.6, 1.0):
        sweep.grow(radius)
        ends, pairs, finished = sweep.edges
        to_sites = np.linalg.norm(ends[:, :, None] - sites[pairs][:, None], axis=3)
        assert np.allclose(to_sites[..., 0], to_sites[..., 1])
        tips, tip_distance = ends[~finished, 1], to_sites[~finished, 1, 0]
        assert np.allclose(np.linalg.norm(tips - sweep.center, axis=1) + tip_distance, radius)
        assert (np.linalg.norm(ends[finished] - sweep.center, axis=2) <= radius).all()


def test_a_finished_sweep_has_the_diagrams_edges():
    sites = plane_sites.uniform(80, np.random.default_rng(4))
    sweep = sb.SweepCircle(sites, [0.2, 0.2])
    run(sweep)
    pairs = {frozenset(pair) for pair in sweep.edges[1].tolist()}
    assert pairs == {frozenset(pair) for pair in sb.voronoi_2d(sites).edge_sites.tolist()}


@pytest.mark.parametrize("radius", [0.0, 0.2, 0.7, 1e3, 1e308])
def test_what_is_grown_over_is_what_steps_go_through(radius):
    sites = plane_sites.uniform(100, np.random.default_rng(5))
    stepped, grown = sb.SweepCircle(sites, [0.5, 0.4]), sb.SweepCircle(sites, [0.5, 0.4])
    grown.grow(radius)
    later = [event for event in run(stepped) if event.radius > radius]
    rest = run(grown)
    assert [(event.kind, *event.sites, *event.point) for event in rest] == [
        (event.kind, *event.sites, *event.point) for event in later
    ]
    assert np.array_equal(grown.edges[1], stepped.edges[1])


@pytest.mark.parametrize("corners", [2, 3, 4, 12])
def test_several_nearest_sites_meet_in_the_center(corners):
    directions = [
        (3, 4),
        (-3, -4),
        (-4, 3),
        (4, -3),
        (5, 0),
        (0, 5),
        (-5, 0),
        (0, -5),
        (4, 3),
        (-4, -3),
        (3, -4),
        (-3, 4),
    ]
    sites = np.array([*directions[:corners], (9, 1), (-1, 8), (-7, -6)], dtype=float)
    sweep = sb.SweepCircle(sites, [0, 0])
    events = run(sweep)
    assert [event.kind for event in events].count("touch") == len(sites)
    about_center = [event for event in events if event.kind == "vanish" and not event.point.any()]
    assert len(about_center) == max(0, corners - 2)
    assert all(event.radius == 5 and set(event.sites) <= set(range(corners)) for event in about_center)
    assert [event.kind for event in events].count("vanish") == len(sb.voronoi_2d(sites).delaunay)
    grown = sb.SweepCircle(sites, [0, 0])
    grown.grow(5)
    assert repr(grown.step()) == repr(events[corners + len(about_center)])
    pairs = {frozenset(pair) for pair in sweep.edges[1].tolist()}
    assert pairs >= {frozenset(pair) for pair in sb.voronoi_2d(sites).edge_sites.tolist()}
    assert len(sweep.edges[0]) == len(sb.voronoi_2d(sites).delaunay) + len(sites) - 1


def test_equal_sites_are_touched_once():
    events = run(sb.SweepCircle([[1, 0], [1, 0], [0, 2]], [0, 0]))
    assert [event.sites.tolist() for event in events] == [[0], [2]]


def test_nothing_happens_without_sites():
    sweep = sb.SweepCircle(np.zeros((0, 2)), [0, 0])
    assert sweep.step() is None
    assert len(sweep.beach_curve(4)) == len(sweep.arcs) == 0


@pytest.mark.parametrize(
    ("sites", "center", "text"),
    [([[0, np.nan]], [0, 0], "site 0"), ([[0, 0]], [np.inf, 0], "center"), ([[0, 0]], [1, 2, 3], "center")],
)
def test_bad_sweeps_are_named(sites, center, text):
    with pytest.raises(sb.InputError, match=text):
        sb.SweepCircle(sites, center)


def test_bad_radius_is_named():
    with pytest.raises(sb.InputError, match="radius"):
        sb.SweepCircle([[0, 0]], [1, 1]).grow(-1)


@pytest.mark.parametrize("samples", [0, 100_001, 2**31 - 1])
def test_more_samples_than_one_can_wait_for_are_refused(samples):
    for ask in (
        lambda: sb.SweepCircle([[0, 0]], [1, 1]).beach_curve(samples),
        lambda: sb.SweepCircles([[0, 0]], [[1, 1]]).beach_curve(0, samples),
    ):
        with pytest.raises(sb.InputError, match="samples: wanted 1 to 100000"):
            ask()

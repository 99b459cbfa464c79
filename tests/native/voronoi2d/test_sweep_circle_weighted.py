# SPDX-License-Identifier: MIT
"""Sweep circles over weighted sites, and several at once: events, ellipse arcs, growing edges."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import saddleback as sb
from tests.native import plane_sites
from tests.native.weighted_sites import KINDS, weighted_distances


def run(sweep):
    events = []
    while (event := sweep.step()) is not None:
        events.append(event)
    return events


def disks(n, seed):
    return KINDS["random_disks"](n, np.random.default_rng(seed))


@pytest.mark.parametrize("center", [[0.4, 0.6], [3.0, -2.0], [500.0, 40.0], None])
@pytest.mark.parametrize("n", [1, 2, 3, 10, 200])
def test_events_come_by_radius_for_every_cell_and_vertex(n, center):
    sites, weights = disks(n, n)
    center = sites[0] if center is None else np.array(center)
    diagram, sweep = sb.voronoi_2d(sites, weights), sb.SweepCircle(sites, center, weights)
    last, touched, vertices = sweep.radius, [], []
    while (event := sweep.step()) is not None:
        assert event.radius == sweep.radius >= last
        last = event.radius
        if event.kind == "touch":
            touched += event.sites.tolist()
            assert event.radius == pytest.approx(np.linalg.norm(event.point - center) - weights[event.sites[0]])
        else:
            vertices.append(event.point)
            distances = np.linalg.norm(event.point - sites[event.sites], axis=1) - weights[event.sites]
            assert np.allclose(np.linalg.norm(event.point - center) + distances, event.radius, rtol=1e-9)
    assert sorted(touched) == np.setdiff1d(np.arange(n), diagram.hidden).tolist()
    assert len(vertices) == len(diagram.vertices)


@pytest.mark.parametrize("radius", [0.1, 0.2, 0.45, 0.8, 3.0])
def test_the_beach_curve_is_equally_far_from_the_sites_and_the_circle(radius):
    sites, weights = disks(100, 2)
    sweep = sb.SweepCircle(sites, [0.5, 0.4], weights)
    sweep.grow(radius)
    curve = sweep.beach_curve(360)
    from_center = np.linalg.norm(curve - sweep.center, axis=1)
    distances = weighted_distances(curve, sites, weights)
    assert np.allclose(distances.min(axis=1), radius - from_center, atol=1e-12)
    arcs = sweep.arcs
    assert sum(end - begin for _, begin, end in arcs) == pytest.approx(2 * np.pi)
    assert all(first[2] == pytest.approx(then[1]) for first, then in pairwise(arcs))
    for site, begin, end in arcs:
        if end - begin > 0.1:
            assert distances[round(0.5 * (begin + end) / np.pi * 180) % 360].argmin() == site


def test_edges_grow_along_the_beach_curve():
    sites, weights = disks(80, 3)
    sweep = sb.SweepCircle(sites, [0.5, 0.5], weights)
    grown = 0
    for radius in (0.05, 0.1, 0.3, 0.6, 1.0):
        sweep.grow(radius)
        ends, pairs, finished = sweep.edges
        grown += np.count_nonzero(~finished)
        distances = np.linalg.norm(ends[:, :, None] - sites[pairs][:, None], axis=3) - weights[pairs][:, None]
        assert np.allclose(distances[..., 0], distances[..., 1])
        reached = np.linalg.norm(ends - sweep.center, axis=2) + distances[..., 0]
        assert np.allclose(reached[~finished, 1], radius)
        assert (reached <= radius + 1e-12).all()
        lines = sweep.edge_polylines(1e-4)
        assert [(line[0].tolist(), line[-1].tolist()) for line in lines] == [tuple(pair) for pair in ends.tolist()]
        for line, pair in zip(lines, pairs, strict=True):
            along = weighted_distances(line, sites[pair], weights[pair])
            assert np.allclose(along[:, 0], along[:, 1])
    assert grown > 50


def expect_a_finished_sweep(sites, center, weights):
    """After the last event there are the diagram's edges, to the bit where they end, those with two ends finished."""
    diagram, sweep = sb.voronoi_2d(sites, weights), sb.SweepCircle(sites, center, weights)
    run(sweep)
    ends, pairs, finished = sweep.edges
    closed = (diagram.edges >= 0).all(axis=1)
    assert sorted(map(sorted, pairs.tolist())) == sorted(map(sorted, diagram.edge_sites.tolist()))
    assert sorted(ends[finished].tolist()) == sorted(diagram.vertices[diagram.edges[closed]].tolist())
    begun = {tuple(diagram.vertices[v]) for v in diagram.edges[~closed].ravel() if v >= 0}
    assert begun <= set(map(tuple, ends[~finished][:, 0].tolist()))
    assert np.isfinite(ends).all()


@pytest.mark.parametrize("n", [1, 2, 3, 5, 80])
def test_a_finished_sweep_has_the_diagrams_edges(n):
    for seed in range(40 if n < 80 else 2):
        sites, weights = disks(n, seed)
        center = np.random.default_rng(seed).normal(size=2) * (0.5, 3)[seed % 2]
        expect_a_finished_sweep(sites, center, weights)
    expect_a_finished_sweep([[0.87, 0.47], [0.91, 0.77], [0.92, 0.13]], [-2.53, 2.06], [-0.04, -0.04, 0.12])


def test_equal_weights_only_shift_the_radius():
    sites = plane_sites.uniform(50, np.random.default_rng(5))
    plain, shifted = sb.SweepCircle(sites, [0.5, 0.5]), sb.SweepCircle(sites, [0.5, 0.5], np.full(50, 0.25))
    plain.grow(0.75)
    shifted.grow(0.5)
    assert np.allclose(plain.beach_curve(90), shifted.beach_curve(90), atol=1e-12)
    assert len(plain.edges[0]) == len(shifted.edges[0])
    assert [len(line) for line in plain.edge_polylines(0.1)] == [2] * len(plain.edges[0])


def test_a_disk_about_the_center_is_touched_before_the_radius_is_0():
    sweep = sb.SweepCircle([[0, 0], [4, 0]], [0.5, 0], [1, 0])
    assert sweep.radius == -0.5
    assert [event.radius for event in run(sweep)] == [-0.5, 3.5]


@pytest.mark.parametrize("with_weights", [False, True])
def test_several_circles_close_their_own_cells(with_weights):
    sites, weights = disks(150, 6) if with_weights else (plane_sites.uniform(150, np.random.default_rng(6)), None)
    centers = np.array([[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75], [0.5, 0.5]])
    diagram = sb.voronoi_2d(sites, weights)
    sweep = sb.SweepCircles(sites, centers, weights)
    owner = np.linalg.norm(sites[:, None] - centers, axis=2).argmin(axis=1)
    found = {circle: set() for circle in range(5)}
    last = -np.inf
    while (step := sweep.step()) is not None:
        circle, event = step
        assert event.radius >= last
        last = event.radius
        if event.kind == "vanish":
            found[circle].add(tuple(event.point))
    assert sweep.done.all()
    for circle in range(5):
        own = [v for site in np.nonzero(owner == circle)[0] for v in diagram.cell_vertices(site) if v >= 0]
        assert {tuple(diagram.vertices[v]) for v in own} <= found[circle]
        assert len(sweep.beach_curve(circle, 12)) == 12
    assert len(found[4]) < len(diagram.vertices)  # the one in the middle need not see all
    assert sweep.radii[4] < sweep.radii.max()
    ends, pairs, finished = sweep.edges(4)
    assert len(ends) == len(pairs) == len(finished) == len(sweep.edge_polylines(4, 0.01))
    assert sum(end - begin for _, begin, end in sweep.arcs(4)) == pytest.approx(2 * np.pi)


@pytest.mark.parametrize("with_weights", [False, True])
def test_more_circles_in_a_domain_have_less_to_do_each(with_weights):
    rng = np.random.default_rng(3)
    sites, weights = rng.random((1000, 2)), rng.uniform(0, 0.003, 1000) if with_weights else None
    square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    diagram = sb.voronoi_2d(sites, weights)
    inside = ((diagram.vertices >= 0) & (diagram.vertices <= 1)).all(axis=1)
    means = []
    for m in (1, 2, 3, 5):
        places = (np.arange(m) + 0.5) / m
        sweep = sb.SweepCircles(sites, [(x, y) for x in places for y in places], weights, domain=square)
        events, found = np.zeros(m * m, int), set()
        while (step := sweep.step()) is not None:
            events[step[0]] += 1
            if step[1].kind == "vanish":
                found.add(tuple(step[1].point))
        assert sweep.done.all() and {tuple(vertex) for vertex in diagram.vertices[inside]} <= found
        means.append(events.mean())
    # Of circles that lie like the squares of a board each should tell one share of all and a margin.
    assert means[0] > 2500 and (np.array(means[1:]) < means[0] / [2.5, 4.5, 9]).all()


def test_circles_grow_together():
    sites, weights = disks(100, 7)
    sweep = sb.SweepCircles(sites, [[0.2, 0.2], [0.8, 0.8]], weights)
    sweep.grow(0.3)
    assert sweep.radii.tolist() == [0.3, 0.3]
    for circle, center in enumerate(sweep.centers):
        alone = sb.SweepCircle(sites, center, weights)
        alone.grow(0.3)
        assert np.array_equal(alone.beach_curve(30), sweep.beach_curve(circle, 30))


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda: sb.SweepCircle([[0, 0], [1, 0]], [0, 0], [1]), "weights"),
        (lambda: sb.SweepCircle([[0, 0], [1, 0]], [0, 0], [1, np.nan]), "weight 1"),
        (lambda: sb.SweepCircles([[0, 0]], np.zeros((0, 2))), "centers"),
        (lambda: sb.SweepCircles([[0, 0]], [[0, np.inf]]), "center"),
        (lambda: sb.SweepCircles([[0, 0]], [[0, 0]], domain=[(0, 0), (1, 0)]), "domain"),
        (lambda: sb.SweepCircles([[0, 0]], [[0, 0]]).edges(1), "circle"),
        (lambda: sb.SweepCircles([[0, 0]], [[0, 0]]).beach_curve(0, 0), "samples"),
        (lambda: sb.SweepCircles([[0, 0]], [[0, 0]]).edge_polylines(0, 0), "tolerance"),
        (lambda: sb.SweepCircle([[0, 0]], [0, 0]).edge_polylines(-1), "tolerance"),
        (lambda: sb.SweepCircles([[0, 0]], [[0, 0]]).grow(np.inf), "radius"),
    ],
)
def test_wrong_arguments_are_named(call, text):
    with pytest.raises(sb.InputError, match=text):
        call()

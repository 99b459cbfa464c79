# SPDX-License-Identifier: MIT
"""Truths about sweep circles and the lists of a plane diagram's cells: circles through three sites, in fractions."""

from __future__ import annotations

import numpy as np

import saddleback as sb
from tests.truth.disks import random_weights
from tests.truth.plane import Floats, Random, exact, some_of, squared, voronoi_vertices
from tests.truth.registry import guards


def size_of(sites: Floats, center: Floats) -> float:
    return float(np.abs(np.vstack([sites, center])).max())


def random_center(sites: Floats, rng: Random) -> Floats:
    """Among the sites, beside them, or on one."""
    if rng.random() < 0.2:
        return sites[int(rng.integers(len(sites)))].copy()
    extent = float(np.ptp(sites, axis=0).max()) or 1.0
    return np.asarray(sites.mean(axis=0) + extent * rng.choice([0.3, 3.0]) * rng.normal(size=2))


def is_plain(sites: Floats) -> bool:
    """Sites so far apart that rounding leaves their circles as they are."""
    gaps = np.linalg.norm(sites[:, None] - sites, axis=2)
    return bool((gaps[gaps > 0] > 1e-6 * np.abs(sites).max()).all())


def far_of(vertex: tuple, sites: set[int], points: list, center: Floats) -> float:
    """How far a circle about the center reaches when the last arc at a vertex vanishes."""
    (c,) = exact(center[None])
    return float(squared(vertex, c)) ** 0.5 + float(squared(vertex, points[min(sites)])) ** 0.5


def is_tie(events: list[sb.SweepEvent], size: float) -> bool:
    """Whether a site is touched in the moment in which an arc vanishes."""
    radii = {kind: [event.radius for event in events if event.kind == kind] for kind in ("touch", "vanish")}
    return any(abs(a - b) <= 1e-9 * size for a in radii["touch"] for b in radii["vanish"])


@guards("SweepCircle", "SweepCircle.step", "SweepEvent", "SweepCircle.grow", on="plane")
def steps_of_a_circle(sites: Floats, rng: Random) -> None:
    """Every site is touched once at its distance, every vertex found once, three sites at a time, where the circle
    through its sites says; radii only grow; growing to a radius does all steps up to it.
    """
    sites = some_of(sites, rng, 8)
    if not is_plain(sites):
        return
    center = random_center(sites, rng)
    sweep, points, size = sb.SweepCircle(sites, center), exact(sites), size_of(sites, center)
    truth, events = voronoi_vertices(sites), []
    last = -np.inf
    while event := sweep.step():
        events.append(event)
        assert event.radius >= last - 1e-9 * size
        last = max(last, event.radius)
        assert abs(sweep.radius - event.radius) <= 1e-12 * max(size, abs(event.radius))
    touched = [int(e.sites[0]) for e in events if e.kind == "touch"]
    own = [i for i, p in enumerate(points) if p not in points[:i]]
    assert sorted(points[i] for i in touched) == sorted(points[i] for i in own)
    for event in events:
        if event.kind == "touch":
            site = sites[event.sites[0]]
            assert abs(event.point - site).max() <= 1e-15 * size
            assert abs(event.radius - np.hypot(*(site - center))) <= 1e-12 * size
    vanished = [event for event in events if event.kind == "vanish"]
    if is_tie(events, size):
        return
    assert len(vanished) == sum(len(key) - 2 for key in truth)
    for event in vanished:  # of nearly simultaneous ones rounding decides which: the circle is empty, but for that
        reaches = np.linalg.norm(sites - event.point, axis=1)
        slack = 1e-7 * max(reaches.min(), size)
        assert reaches[event.sites].max() <= reaches.min() + slack, f"vertex of {event.sites} at {event.point}"
        if reaches.min() < 1e6 * size:  # the last ones come at no radius of their own
            assert abs(event.radius - reaches.min() - np.hypot(*(event.point - center))) <= slack
    for key, vertex in truth.items():
        off = min(float(squared(vertex, exact(event.point[None])[0])) ** 0.5 for event in vanished)
        assert off <= 1e-7 * max(far_of(vertex, key, points, center), size), f"{sorted(key)} meet {off} beside"
    grown = sb.SweepCircle(sites, center)
    radius = float(rng.uniform(0, max(last, 1e-3)))
    grown.grow(radius)
    after = grown.step()
    passed = [e for e in events if e.radius <= radius]
    own_radii = all(np.abs(event.point).max() < 1e6 * size for event in events)
    if own_radii and all(abs(e.radius - radius) > 1e-9 * max(size, e.radius) for e in events):
        assert (after is None) == (len(passed) == len(events))
        assert after is None or abs(after.radius - events[len(passed)].radius) <= 1e-9 * max(size, after.radius)


@guards("SweepCircle.step", on="plane")
def ties_of_a_circle(sites: Floats, rng: Random) -> None:
    """In the end a sweep has as many vertices and edges as the diagram, whatever happens at once.

    A vertex of many cells is found three sites at a time, or at once. So is one in which the circle begins.
    """
    sites = some_of(sites, rng, 8)
    diagram = sb.voronoi_2d(sites, threads=1)
    center = random_center(sites, rng)
    if len(diagram.vertices) and rng.random() < 0.3:
        center = rng.choice(diagram.vertices)
    sweep = sb.SweepCircle(sites, center)
    vanished = 0
    while event := sweep.step():
        vanished += event.kind == "vanish"
    assert vanished in (len(diagram.delaunay), len(diagram.vertices))
    assert len(sweep.edges[1]) - (vanished - len(diagram.vertices)) == len(diagram.edges)


def assert_is_beach(curve: Floats, sites: Floats, weights: Floats, center: Floats, radius: float, size: float) -> None:
    """Points as far from the circle's rim as from the nearest disk; weights bring a rim nearer."""
    to_center = np.hypot(*(curve - center).T)
    to_sites = np.linalg.norm(curve[:, None] - sites, axis=2) - weights
    inside = np.linalg.norm(sites - center, axis=1) - weights <= radius
    rim = radius - to_center
    off = abs(to_sites[:, inside].min(axis=1) - rim).max()
    assert off <= 1e-6 * max(size, radius), f"{off} off the curve"
    directions = np.unwrap(np.arctan2(*(curve - center)[to_center > 1e-6 * size].T[::-1]))
    assert (np.diff(directions) >= -1e-6).all() or (np.diff(directions) <= 1e-6).all()


def assert_are_arcs(arcs: list[tuple[int, float, float]], sites: Floats, center: Floats, radius: float) -> None:
    """Arcs go round once, and in the middle of each its site's ellipse is the farthest from the center of all."""
    widths = np.array([end - begin for _, begin, end in arcs])
    assert abs(widths.sum() - 2 * np.pi) <= 1e-6, f"arcs go round by {widths.sum()}"
    offset = sites - center
    for site, begin, end in arcs:
        if end - begin < 1e-6:
            continue
        toward = np.array([np.cos((begin + end) / 2), np.sin((begin + end) / 2)])
        above = radius**2 - (offset**2).sum(axis=1)
        reach = np.where(above > 0, above / (2 * (radius - offset @ toward)), 0)  # where |p - site| = radius - |p|
        assert reach[site] >= reach.max() - 1e-6 * radius, f"site {site} in direction {(begin + end) / 2}"


@guards("SweepCircle.beach_curve", "SweepCircle.edge_polylines", on="plane")
def curves_of_a_circle(sites: Floats, rng: Random) -> None:
    """The beach curve is as far from the rim as from the nearest disk, its arcs are the farthest ellipses, and edges'
    points are as far from one disk as from the other.
    """
    sites = some_of(sites, rng, 8)
    if not is_plain(sites):
        return
    size = float(np.ptp(sites, axis=0).max()) or 1.0
    sites = sites - sites.mean(axis=0)  # far from the origin a curve is as rough as its coordinates
    weights = random_weights(sites, rng) if rng.random() < 0.5 and len(sites) > 1 else np.zeros(len(sites))
    center = random_center(sites, rng)
    sweep = sb.SweepCircle(sites, center, weights)
    reach = np.linalg.norm(sites - center, axis=1) - weights
    radius = float(reach.min() + size * rng.uniform(0.05, 4))
    sweep.grow(radius)
    assert abs(sweep.radius - radius) <= 1e-12 * max(size, abs(radius))
    if radius > 0:
        curve = sweep.beach_curve(50)
        assert curve.shape == (50, 2)
        assert_is_beach(curve, sites, weights, center, radius, size)
        if not weights.any():
            assert_are_arcs(sweep.arcs, sites, center, radius)
    tolerance = size * 10.0 ** float(rng.uniform(-6, -1))
    _, pairs, _ = sweep.edges
    for line, (a, b) in zip(sweep.edge_polylines(tolerance), pairs, strict=True):
        assert_parts(line, sites, weights, int(a), int(b), size)


def assert_parts(line: Floats, sites: Floats, weights: Floats, a: int, b: int, size: float) -> None:
    """Points of an edge's polyline are as far from both its disks."""
    one, other = (np.linalg.norm(line - sites[i], axis=1) - weights[i] for i in (a, b))
    off = abs(one - other) / np.maximum(size, np.abs(line).max(axis=1))
    assert off.max() <= 1e-6, f"the edge of {a} and {b} is {off.max()} nearer to one"


@guards(
    "SweepCircles", "SweepCircles.step", "SweepCircles.grow", "SweepCircles.arcs", "SweepCircles.beach_curve",
    "SweepCircles.edges", "SweepCircles.edge_polylines", on="plane",
)  # fmt: skip
def circles_that_grow_together(sites: Floats, rng: Random) -> None:
    """Events come in the order of their radii, each at a site or a vertex that fractions tell; all cells are closed in
    the end, by one circle or another; curves and arcs are as one circle's.
    """
    sites = some_of(sites, rng, 8)
    if not is_plain(sites):
        return
    sites = sites - sites.mean(axis=0)
    size = float(np.ptp(sites, axis=0).max()) or 1.0
    centers = np.array([random_center(sites, rng) for _ in range(int(rng.integers(1, 4)))])
    sweeps, points = sb.SweepCircles(sites, centers), exact(sites)
    truth = voronoi_vertices(sites)
    assert (sweeps.centers == centers).all()
    last, seen = -np.inf, set()
    while step := sweeps.step():
        circle, event = step
        assert 0 <= circle < len(centers)
        assert event.radius >= last - 1e-9 * size
        last = max(last, event.radius)
        first = [min(i for i in range(len(points)) if points[i] == points[s]) for s in event.sites.tolist()]
        if event.kind == "touch":
            wanted = float(np.hypot(*(sites[first[0]] - centers[circle])))
        else:
            (key,) = [k for k in truth if set(first) <= k]
            seen.add(key)
            wanted = far_of(truth[key], key, points, centers[circle])
            off = float(squared(truth[key], exact(event.point[None])[0])) ** 0.5
            assert off <= 1e-7 * max(wanted, size)
        assert abs(event.radius - wanted) <= 1e-7 * max(wanted, size), f"{event.kind} at {event.radius} for {wanted}"
    assert seen == set(truth)
    assert sweeps.done.all()
    again = sb.SweepCircles(sites, centers)
    radius = float(size * rng.uniform(0.05, 3))
    again.grow(radius)
    for circle, center in enumerate(centers):
        _, pairs, _ = again.edges(circle)
        for line, (a, b) in zip(again.edge_polylines(circle, 1e-3 * size), pairs, strict=True):
            assert_parts(line, sites, np.zeros(len(sites)), int(a), int(b), size)
        reached = float(again.radii[circle])
        arcs = again.arcs(circle)
        if arcs and np.isfinite(reached) and reached > np.linalg.norm(sites - center, axis=1).min() * (1 + 1e-9):
            assert reached <= radius * (1 + 1e-12)
            assert_are_arcs(arcs, sites, center, reached)
            curve = again.beach_curve(circle, 30)
            assert_is_beach(curve, sites, np.zeros(len(sites)), center, reached, size)


def cut_by(polygon: list[Floats], site: Floats, other: Floats) -> list[Floats]:
    """What of a convex polygon is nearer to a site than to another."""
    across, middle = other - site, (site + other) / 2
    side = [float(np.dot(point - middle, across)) for point in polygon]
    kept: list[Floats] = []
    for a, b, u, v in zip(polygon, polygon[1:] + polygon[:1], side, side[1:] + side[:1], strict=True):
        if u <= 0:
            kept.append(a)
        if (u < 0 < v) or (v < 0 < u):
            kept.append(a + (b - a) * (u / (u - v)))
    return kept


@guards("SweepCircles", on="plane")
def circles_stop_where_their_part_of_the_domain_ends(sites: Floats, rng: Random) -> None:
    """A circle stops when it has passed the last corner of what lies in a box of the cells of the sites nearest to it,
    cut out of the box by all bisectors; until then it tells the same events as without a domain.
    """
    sites = some_of(sites, rng, 8)
    if not is_plain(sites) or len(np.unique(sites, axis=0)) < len(sites):
        return
    sites = sites - sites.mean(axis=0)
    size = float(np.ptp(sites, axis=0).max()) or 1.0
    centers = np.array([random_center(sites, rng) for _ in range(int(rng.integers(1, 4)))])
    low = size * rng.normal(size=2)
    high = low + size * rng.uniform(0.2, 3, 2)
    box = [np.array(corner) for corner in (low, (high[0], low[1]), high, (low[0], high[1]))]
    away = np.linalg.norm(sites[:, None] - centers, axis=2)
    if len(centers) > 1 and np.diff(np.sort(away, axis=1)[:, :2]).min() < 1e-9 * size:
        return
    stops = np.full(len(centers), -np.inf)
    for site, circle in zip(sites, away.argmin(axis=1).tolist(), strict=True):
        cell = box
        for other in sites:
            cell = cut_by(cell, site, other) if cell and (other != site).any() else cell
        for corner in cell:
            stops[circle] = max(stops[circle], np.hypot(*(corner - centers[circle])) + np.hypot(*(corner - site)))
    sweeps, free = sb.SweepCircles(sites, centers, domain=box), sb.SweepCircles(sites, centers)
    told = {circle: [] for circle in range(len(centers))}
    while step := sweeps.step():
        told[step[0]].append((step[1].kind, step[1].radius, *step[1].sites.tolist()))
    every = {circle: [] for circle in range(len(centers))}
    while step := free.step():
        every[step[0]].append((step[1].kind, step[1].radius, *step[1].sites.tolist()))
    sweeps.grow(100 * float(max(away.max(), np.abs(box).max(), 1)))
    reached = sweeps.radii
    for circle, stop in enumerate(stops.tolist()):
        assert (
            (reached[circle] == -np.inf) if stop == -np.inf else abs(reached[circle] - stop) <= 1e-6 * max(size, stop)
        )
        shorter = min(len(told[circle]), len(every[circle]))
        assert told[circle][:shorter] == every[circle][:shorter]
        assert all(event[1] <= stop + 1e-6 * size for event in told[circle])


@guards("Voronoi2d.cell_vertices", "Voronoi2d.cell_edges", "Voronoi2d", on="plane")
def rings_of_cells(sites: Floats, rng: Random) -> None:
    """Around a cell go the edges that name its site, each once, from vertex to vertex, counter-clockwise."""
    weights = random_weights(sites, rng) if rng.random() < 0.5 else None
    diagram = sb.voronoi_2d(sites, weights, threads=1)
    offsets, vertices = diagram.cells
    for site in range(len(sites)):
        ring, edges = diagram.cell_vertices(site), diagram.cell_edges(site)
        if diagram.site_of[site] != site or site in diagram.hidden:
            assert len(ring) == len(edges) or diagram.site_of[site] != site
            continue
        assert (ring == vertices[offsets[site] : offsets[site + 1]]).all()
        mine = np.flatnonzero((diagram.edge_sites == site).any(axis=1))
        assert sorted(edges[edges >= 0].tolist()) == mine.tolist(), f"cell {site}"
        for k, edge in enumerate(edges.tolist()):
            if edge < 0:
                continue
            on_left = diagram.edge_sites[edge, 0] == site
            begin, end = diagram.edges[edge] if on_left else diagram.edges[edge][::-1]
            assert end == ring[k], f"edge {edge} of cell {site} leads to {end}, not {ring[k]}"
            if len(ring) > 1:
                assert begin == ring[k - 1], f"edge {edge} of cell {site} comes from {begin}, not {ring[k - 1]}"

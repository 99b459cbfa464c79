# SPDX-License-Identifier: MIT
"""Truths about the diagram of disks, additively weighted sites of the plane, by brute force in 250 digits."""

from __future__ import annotations

from decimal import Decimal, localcontext
from fractions import Fraction
from itertools import pairwise

import numpy as np

import saddleback as sb
from tests import meshes
from tests.truth.cell_parts import assert_is_split
from tests.truth.plane import (
    ROUNDINGS,
    SQUARE,
    Floats,
    Random,
    box_about,
    depth_within,
    exact,
    random_domain,
    some_of,
)
from tests.truth.registry import guards


def random_weights(sites: Floats, rng: Random) -> Floats:
    """Radii of every sort: small, large, and so that some disks nearly touch others from inside."""
    size = float(np.ptp(sites, axis=0).max()) or 1.0
    weights = size * float(rng.choice([0.02, 0.2, 0.6])) * rng.uniform(-1, 1, len(sites))
    for i in rng.permutation(len(sites))[: int(rng.integers(0, 3))]:
        j = int(rng.integers(len(sites)))
        apart = float(np.hypot(*(sites[i] - sites[j])))
        weights[i] = weights[j] - apart * (1 - 10.0 ** rng.uniform(-9, -1))
    return weights


def scaled_distances(point: Floats, sites: Floats, weights: Floats) -> list[Decimal]:
    """|point - site| - weight, in 250 digits."""
    with localcontext() as context:
        context.prec = 250
        x, y = (Decimal(c) for c in point.tolist())
        rows = zip(*([Decimal(c) for c in column.tolist()] for column in (*sites.T, weights)), strict=True)
        return [((x - a) ** 2 + (y - b) ** 2).sqrt() - w for a, b, w in rows]


def distances_to_polyline(points: Floats, line: Floats) -> Floats:
    """The distance of each point from the nearest chord."""
    best = np.full(len(points), np.inf)
    for a, b in pairwise(line):
        along = b - a
        share = np.clip((points - a) @ along / max(float(along @ along), 1e-300), 0, 1)
        best = np.minimum(best, np.hypot(*(points - a - share[:, None] * along).T))
    return best


def curve_between(light: Floats, heavy: Floats, weight: float, ends: Floats) -> Floats:
    """Points of the curve |x - light| = |x - heavy| - weight, seen from its focus, the lighter site, between two points
    of it: r (d.u + weight) = (d^2 - weight^2) / 2 with d the way to the heavier one and u the direction.
    """
    d = heavy - light
    exact = [Fraction(float(b)) - Fraction(float(a)) for a, b in zip(light, heavy, strict=True)]
    above = float(sum(c * c for c in exact) - Fraction(weight) ** 2)
    toward = np.arctan2(d[1], d[0])
    angles = [np.remainder(np.arctan2(*(end - light)[::-1]) - toward + np.pi, 2 * np.pi) - np.pi for end in ends]
    turn = np.linspace(min(angles), max(angles), 400)  # the curve passes the way to the heavier site, or stays aside
    rest = np.hypot(*d) * np.cos(turn) + weight
    reach = 0.5 * above / np.where(rest > 1e-7 * np.hypot(*d), rest, np.nan)
    points = light + reach[:, None] * np.column_stack([np.cos(turn + toward), np.sin(turn + toward)])
    return points[np.isfinite(reach)]


@guards("Voronoi2d.edge_polyline", on="plane")
def polylines_of_edges(sites: Floats, rng: Random) -> None:
    """Every point of a curved edge is within the tolerance of its polyline, whatever the tolerance."""
    sites = some_of(sites, rng, 8)
    weights = random_weights(sites, rng)
    diagram = sb.voronoi_2d(sites, weights, threads=1)
    if len(diagram.weights) == 0:
        return
    for edge, (left, right) in enumerate(diagram.edge_sites):
        apart = float(np.hypot(*(sites[right] - sites[left])))
        tolerance = apart * 10.0 ** rng.uniform(-6, 1)
        line = diagram.edge_polyline(edge, tolerance)
        assert len(line) < 500_000
        light, heavy = (left, right) if weights[left] <= weights[right] else (right, left)
        difference = float(weights[heavy] - weights[light])
        if Fraction(difference) != Fraction(float(weights[heavy])) - Fraction(float(weights[light])):
            continue  # the sampled curve would be another
        curve = curve_between(sites[light], sites[heavy], difference, line[[0, -1]])
        size = np.abs(line).max() + np.abs(sites).max()
        if len(curve):
            off = distances_to_polyline(curve, line).max()
            assert off <= tolerance * (1 + 1e-6) + 1e-9 * size, f"edge {edge}: {off} for {tolerance}"


@guards("Voronoi2d.locate", "Voronoi2d.hidden", on="plane")
def nearest_disks(sites: Floats, rng: Random) -> None:
    """The nearest disk of points everywhere, in 250 digits; hidden ones are nowhere nearest."""
    weights = random_weights(sites, rng)
    diagram = sb.voronoi_2d(sites, weights, threads=1)
    corner, side = box_about(sites, rng)
    points = np.vstack([corner + side * rng.random((6, 2)), sites[:3]])
    seen = sorted(set(range(len(sites))) - set(diagram.hidden.tolist()))
    for point, found in zip(points, diagram.locate(points, threads=1), strict=True):
        distances = scaled_distances(point, sites, weights)
        assert found == min(seen, key=lambda i: (distances[i], i))
        assert distances[found] == min(distances)


@guards("voronoi_2d", "Voronoi2d.vertices", on="plane")
def vertices_of_disks(sites: Floats, rng: Random) -> None:
    """Vertices are as far from all disks about them, and from no other less, in 250 digits."""
    sites = some_of(sites, rng, 14)
    weights = random_weights(sites, rng)
    diagram = sb.voronoi_2d(sites, weights, threads=1)
    about: list[set[int]] = [set() for _ in diagram.vertices]
    for ends, pair in zip(diagram.edges.tolist(), diagram.edge_sites.tolist(), strict=True):
        for vertex in ends:
            if vertex >= 0:
                about[vertex] |= set(pair)
    for vertex, of in zip(diagram.vertices, about, strict=True):
        distances = scaled_distances(vertex, sites, weights)
        size = max(np.abs(sites).max(), np.abs(vertex).max())
        mine = [float(distances[i] - min(distances)) for i in of]
        assert max(mine) <= 8 * ROUNDINGS * size, f"{vertex}: {mine}"


@guards("Voronoi2d.clip", on="plane")
def clipped_disks(sites: Floats, rng: Random) -> None:
    """Cells of disks within domains: areas sum, points of the plane are in their nearest disk's loops."""
    assert_clipped(sites, random_weights(sites, rng), random_domain(sites, rng), rng)


@guards("Voronoi2d.clip", on="nothing")
def clipped_disks_in_line(rng: Random) -> None:
    """Cells of disks nearly in line, of any size, whose vertices are far out or none: as those of any disks."""
    count = int(rng.integers(3, 12))
    along = rng.permutation(2 * count)[:count] if rng.random() < 0.5 else rng.random(count) * count
    direction, size = rng.integers(1, 9, 2), 10.0 ** rng.uniform(-6, 6)
    sites = size * (along[:, None] * direction) * (1 + 2.0**-52 * rng.integers(-2, 3, (count, 2)))
    weights = rng.integers(0, 8, count) * size if rng.random() < 0.5 else random_weights(sites, rng)
    assert_clipped(sites, weights, random_domain(sites, rng), rng)


def assert_clipped(sites: Floats, weights: Floats, loops: list[Floats], rng: Random) -> None:
    size = float(np.ptp(loops[0], axis=0).max())
    tolerance = size * 10.0 ** rng.uniform(-12, -2)
    clipped = sb.voronoi_2d(sites, weights, threads=1).clip(loops if len(loops) > 1 else loops[0], tolerance=tolerance)
    assert (clipped.areas >= 0).all()
    total = 0.0
    for k, loop in enumerate(loops):
        x, y = (loop - loop[0]).T
        area = 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))
        total += area if k == 0 else -area
    scale = max(np.abs(sites).max(), np.abs(loops[0]).max())
    assert abs(clipped.areas.sum() - total) <= 1e-11 * size * scale
    assert len(clipped.points) < 200_000 * (1 + len(sites))
    owners = np.repeat(clipped.loop_sites, np.diff(clipped.loop_offsets))
    some = rng.permutation(len(clipped.points))[:40]
    for point, owner in zip(clipped.points[some], owners[some], strict=True):
        distances = scaled_distances(point, sites, weights)
        assert float(distances[owner] - min(distances)) <= 4 * max(tolerance, 2.0**-24 * size) + 1e-12 * scale


def least_lead(places: Floats, radius: Floats, mine: Floats, other: Floats, lead: float) -> Floats:
    """The least of |q - other| - |q - mine| + lead for q on circles about places: below 0 where the disk of `other` has
    a part of the circle. By 128 directions, and closer and closer about the best of them.
    """
    turns = np.broadcast_to(np.linspace(0, 2 * np.pi, 128, endpoint=False), (len(places), 128))
    width = 2 * np.pi / 128
    for _ in range(5):
        points = places[:, None] + radius[:, None, None] * np.stack([np.cos(turns), np.sin(turns)], axis=-1)
        leads = np.linalg.norm(points - other, axis=2) - np.linalg.norm(points - mine, axis=2) + lead
        best = leads.argmin(axis=1)
        turns = turns[np.arange(len(places)), best][:, None] + width * np.linspace(-1, 1, 33)
        width /= 16
    least: Floats = leads.min(axis=1)
    return least


@guards("Voronoi2d.clip", on="plane")
def inset_disks(sites: Floats, rng: Random) -> None:
    """With a gap a place is in a cell's loops just when the circle of half the gap about it is in the cell."""
    sites = some_of(sites, rng, 8)
    weights = random_weights(sites, rng)
    diagram = sb.voronoi_2d(sites, weights, threads=1)
    loops = random_domain(sites, rng)
    size = float(np.ptp(loops[0], axis=0).max())
    scale = float(max(np.abs(sites).max(), np.abs(loops[0]).max(), np.abs(weights).max()))
    tolerance, half = size * 10.0 ** rng.uniform(-7, -3), 0.5 * size * 10.0 ** rng.uniform(-3, -0.3)
    clipped = diagram.clip(loops if len(loops) > 1 else loops[0], gap=2 * half, tolerance=tolerance, threads=1)
    assert len(clipped.points) < 200_000 * (1 + len(sites))
    off = 2 * max(tolerance, 2.0**-24 * size) + 1e-11 * scale
    if half <= 2 * off or scale > 1e6 * size:
        return
    near = clipped.points[rng.permutation(len(clipped.points))[:20]] + 20 * off * rng.uniform(-1, 1, (1, 2))
    places = np.vstack([loops[0].min(axis=0) + size * rng.random((20, 2)), near])
    places = places[[depth_within(loops, place) > off for place in exact(places)]]
    found = [
        [k for k, site in enumerate(clipped.loop_sites) if site == owner] for owner in range(len(sites))
    ]  # fmt: skip
    distances = np.linalg.norm(places[:, None] - sites, axis=2) - weights
    owners = distances.argmin(axis=1)
    for owner in np.setdiff1d(owners, diagram.hidden):  # a hidden site is nearest by rounding only
        mine = places[owners == owner]
        keeps, comes_near = np.ones(len(mine), bool), np.zeros(len(mine), bool)
        for other in range(len(sites)):
            lead = float(weights[owner] - weights[other])
            apart = float(np.hypot(*(sites[other] - sites[owner])))
            if apart == 0 or other in diagram.hidden:
                continue  # equal sites share a cell
            if apart - abs(lead) < 1e-6 * apart:
                return  # a cell so thin that a circle by numbers misses it
            every = np.ones(len(mine))
            keeps &= least_lead(mine, (half + off) * every, sites[owner], sites[other], lead) > 1e-12 * scale
            comes_near |= least_lead(mine, (half - off) * every, sites[owner], sites[other], lead) < -1e-12 * scale
        own = [clipped.points[clipped.loop_offsets[k] : clipped.loop_offsets[k + 1]] for k in found[owner]]
        inside = [depth_within(own, place) > 0 for place in exact(mine)]
        assert not (keeps & ~np.array(inside)).any(), f"{mine[keeps & ~np.array(inside)][0]} is missing in cell {owner}"
        assert not (comes_near & inside).any(), f"{mine[comes_near & inside][0]} is too near to another cell"
    strangers = set(clipped.loop_sites.tolist()) & set(diagram.hidden.tolist())
    assert not strangers, f"hidden sites {sorted(strangers)} have loops"


def polar_moments(sites: Floats, weights: Floats, low: Floats, side: float) -> tuple[Floats, Floats]:
    """Areas and centers of mass of cells within a square, about sites in it, which see all of their cells: by how far
    it is to the nearest side and to each other site's curve, r (d.u + w) = (d^2 - w^2) / 2, in 8,192 directions.
    """
    turn = 2 * np.pi * (np.arange(8192) + 0.5) / 8192
    u = np.column_stack([np.cos(turn), np.sin(turn)])
    areas, centers = np.zeros(len(sites)), np.array(sites)
    for i, (site, weight) in enumerate(zip(sites, weights, strict=True)):
        sides = np.where(u > 0, (low + side - site) / u, (low - site) / u)
        reach = sides.min(axis=1)
        for other, lead in zip(sites, weights - weight, strict=True):
            d = other - site
            if d @ d <= lead * lead:  # one of them is hidden, or it is the same
                reach = reach * (not (lead > 0))
                continue
            rest = u @ d + lead
            reach = np.minimum(
                reach, np.where(rest > 0, 0.5 * (d @ d - lead * lead) / np.where(rest > 0, rest, 1), np.inf)
            )
        areas[i] = np.pi * (reach**2).mean()
        if areas[i] > 0:
            centers[i] = site + 2 * np.pi / 3 * (reach[:, None] ** 3 * u).mean(axis=0) / areas[i]
    return areas, centers


@guards("weights_for_areas", "AreaWeights", on="plane")
def wanted_areas(sites: Floats, rng: Random) -> None:
    """Areas of disks' cells are the wanted ones, by integrals over directions; what is missing falls in each step."""
    low, side = box_about(sites, rng)
    if np.abs(low).max() > 1e6 * side:
        return
    sites = low + side * rng.random((int(rng.integers(1, 9)), 2))
    wanted = rng.random(len(sites)) + 0.05
    found = sb.weights_for_areas(sites, low + side * np.array(SQUARE), wanted, tolerance=1e-5, threads=1)
    assert found.converged and found.error <= 1e-5, found.stop_reason
    assert (np.diff(found.lacks) < 0).all() and len(found.lacks) == found.iterations + 1
    areas, _ = polar_moments(sites, found.weights, low, side)
    assert abs(found.weights.mean()) <= 1e-9 * side
    assert np.abs(found.shares / wanted * wanted.sum() - 1).max() <= 1.01e-5
    assert np.abs(areas / side**2 / wanted * wanted.sum() - 1).max() <= 1e-3


@guards("relax_2d", "Relaxation2d", on="plane")
def resting_disks(sites: Floats, rng: Random) -> None:
    """Disks at rest are in the centers of mass of their cells, by integrals over directions; hidden ones stayed."""
    low, side = box_about(sites, rng)
    if np.abs(low).max() > 1e6 * side:
        return
    sites = low + side * rng.random((int(rng.integers(1, 9)), 2))
    weights = rng.choice([0.05, 0.3]) * side * rng.random(len(sites)) / len(sites) ** 0.5
    done = sb.relax_2d(
        sites, low + side * np.array(SQUARE), max_iterations=400, tolerance=1e-5, weights=weights, threads=1
    )
    areas, centers = polar_moments(done.sites, weights, low, side)
    off = np.linalg.norm(centers - done.sites, axis=1)
    if done.converged:
        assert off[areas > 1e-4 * side**2].max() <= 3e-3 * side, f"{off.max()} off"


@guards("SweepCircle", "SweepCircles", on="plane")
def finished_sweeps(sites: Floats, rng: Random) -> None:
    """After its last event a sweep over disks has the edges of the diagram, those with two ends finished."""
    sites = some_of(sites, rng, 8)
    weights = random_weights(sites, rng)
    diagram = sb.voronoi_2d(sites, weights, threads=1)
    center = sites.mean(axis=0) + np.ptp(sites, axis=0).max() * rng.normal(size=2)
    sweep = sb.SweepCircle(sites, center, weights)
    found = 0
    while event := sweep.step():
        found += event.kind == "vanish"
    assert found == len(diagram.vertices)
    ends, pairs, finished = sweep.edges
    closed = (diagram.edges >= 0).all(axis=1)
    assert np.isfinite(ends).all()
    assert sorted(map(sorted, pairs[finished].tolist())) == sorted(map(sorted, diagram.edge_sites[closed].tolist()))
    assert sorted(map(sorted, pairs.tolist())) == sorted(map(sorted, diagram.edge_sites.tolist()))


@guards("Chart.lift", "LiftedVoronoi.locate", on="plane")
def lifted_disks(sites: Floats, rng: Random) -> None:
    """On a flat mesh: the nearest disk of its points in 250 digits, and edges as far from both within the tolerance."""
    sites = some_of(sites, rng, 10)
    weights = random_weights(sites, rng)
    corner, side = box_about(sites, rng)
    size = max(np.abs(corner).max() + side, np.abs(sites).max())
    if side < 1e-6 * size:
        return  # what lies where is a matter of rounding
    vertices, triangles = meshes.grid(
        int(rng.integers(2, 6)), int(rng.integers(2, 6)), jitter=0.2, seed=int(rng.integers(99))
    )
    uv = corner + side * vertices[:, :2]
    mesh = sb.Mesh(np.column_stack([uv, np.zeros(len(uv))]), triangles)
    tolerance = side * 10.0 ** rng.uniform(-7, -1)
    diagram = sb.voronoi_2d(sites, weights, threads=1)
    lifted = sb.Chart(mesh, uv).lift(diagram, tolerance=tolerance, threads=1)
    least = max(tolerance, 2.0**-28 * side)  # finer ones are taken as that
    slack = 2.01 * least + 1e-13 * size
    points = sb.sample(mesh, 12, seed=int(rng.integers(1 << 30)))
    places = points.positions(mesh)[:, :2]
    for place, found in zip(places, lifted.locate(points).tolist(), strict=True):
        distances = scaled_distances(place, sites, weights)
        assert float(distances[found] - min(distances)) <= slack, f"{found} for {distances.index(min(distances))}"
    for k, pair in enumerate(lifted.edge_cells):
        for place in lifted.edge_points[lifted.edge_offsets[k] : lifted.edge_offsets[k + 1], :2]:
            distances = scaled_distances(place, sites[pair], weights[pair])
            assert abs(float(distances[0] - distances[1])) <= slack
    assert abs(lifted.areas.sum() - mesh.area) <= 64 * ROUNDINGS * size * side
    split = lifted.split()
    assert_is_split(mesh, split, lifted.areas)

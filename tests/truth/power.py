# SPDX-License-Identifier: MIT
"""Truths about power diagrams by rational numbers: every vertex from all triples of sites, cells by half planes."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations

import numpy as np

import saddleback as sb
from tests.truth import plane
from tests.truth.plane import Floats, Point, Random, cross, exact, rounded, squared
from tests.truth.registry import guards


def random_powers(sites: Floats, rng: Random) -> tuple[Floats, list[Fraction]]:
    """Weights with ties, hidden sites, cells of no area, and none of all that: rounded ones, squares, all alike."""
    spacing = float(np.ptp(sites, axis=0).max()) / np.sqrt(len(sites)) or float(np.abs(sites).max()) or 1.0
    kind = rng.integers(5)
    if kind == 0:
        powers = spacing**2 * rng.normal(size=len(sites)) * 10 ** rng.uniform(-3, 1)
    elif kind == 1:  # few values: ties wherever the sites have some
        powers = 2.0 ** np.round(np.log2(spacing**2)) * rng.integers(-2, 3, len(sites)) / 2
    elif kind == 2:  # on one plane or paraboloid, as far as doubles can say so: cells that shrink to points
        powers = (sites**2).sum(axis=1) + rng.integers(0, 2, len(sites)) * spacing**2
    elif kind == 3:  # one site hides most others
        powers = np.where(np.arange(len(sites)) == rng.integers(len(sites)), 4 * spacing**2 * len(sites), 0.0)
    else:
        powers = np.full(len(sites), float(rng.normal()))
    return powers, [Fraction(power) for power in powers.tolist()]


def power(at: Point, site: Point, weight: Fraction) -> Fraction:
    return squared(at, site) - weight


def center_of_powers(sites: list[Point], weights: list[Fraction], triple: tuple[int, int, int]) -> Point | None:
    """Where three powers are equal, by Cramer's rule; None on a line."""
    a, b, c = (sites[i] for i in triple)
    twice = 2 * cross(a, b, c)
    if twice == 0:
        return None
    wa, wb, wc = (weights[i] for i in triple)
    u, v = squared(a, b) + wa - wb, squared(a, c) + wa - wc
    return (
        a[0] + (u * (c[1] - a[1]) - v * (b[1] - a[1])) / twice,
        a[1] + (v * (b[0] - a[0]) - u * (c[0] - a[0])) / twice,
    )


def power_vertices(sites: list[Point], weights: list[Fraction]) -> dict[Point, frozenset[int]]:
    """Each vertex and all sites (the first of equal ones) with the least power there. O(n^4)."""
    own = [i for i in range(len(sites)) if (sites[i], weights[i]) not in zip(sites[:i], weights[:i], strict=True)]
    found: dict[Point, frozenset[int]] = {}
    for triple in combinations(own, 3):
        place = center_of_powers(sites, weights, triple)
        if place is None or place in found:
            continue
        powers = {i: power(place, sites[i], weights[i]) for i in own}
        least = min(powers.values())
        if powers[triple[0]] == least:
            found[place] = frozenset(i for i in own if powers[i] == least)
    return found


def half_by_power(loop: list[Point], mine: tuple[Point, Fraction], other: tuple[Point, Fraction]) -> list[Point]:
    """What of a polygon has no more power of one site than of another (Sutherland and Hodgman)."""
    gains = [power(p, *other) - power(p, *mine) for p in loop]
    kept = []
    for i, (p, q) in enumerate(zip(loop, loop[1:] + loop[:1], strict=True)):
        at_p, at_q = gains[i], gains[(i + 1) % len(loop)]
        if at_p >= 0:
            kept.append(p)
        if (at_p > 0 > at_q) or (at_p < 0 < at_q):
            share = at_p / (at_p - at_q)
            kept.append((p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])))
    return kept


def cells_by_power(sites: list[Point], weights: list[Fraction], loop: list[Point]) -> list[list[Point]]:
    """The part of a convex polygon in each site's cell: of equal sites only the first one has it."""
    both = list(zip(sites, weights, strict=True))
    cells = []
    for i, mine in enumerate(both):
        cell = [] if mine in both[:i] else loop
        for other in set(both) - {mine}:
            cell = half_by_power(cell, mine, other) if cell else cell
        cells.append(cell)
    return cells


def wide_box(sites: Floats, powers: Floats, vertices: dict[Point, frozenset[int]]) -> list[Point]:
    """A square that holds all vertices, all sites, and a part of every cell that has an area."""
    places = [*exact(sites), *vertices]
    reach = max(max(abs(p[0]), abs(p[1])) for p in places)
    distinct = np.unique(sites, axis=0)
    gaps = [float(np.hypot(*(p - q))) for p, q in combinations(distinct, 2)]
    middle = Fraction(float(np.ptp(powers)) / min(gaps)) if gaps else Fraction(0)
    far = 4 * (reach + middle + 1)
    return [(-far, -far), (far, -far), (far, far), (-far, far)]


@guards("power_diagram_2d", on="plane")
def vertices_by_power(sites: Floats, rng: Random) -> None:
    """Which cells there are, which meet in which vertices, and where, against all triples of sites, in fractions."""
    sites = plane.some_of(sites, rng, 11)
    powers, weights = random_powers(sites, rng)
    diagram, points = sb.power_diagram_2d(sites, powers, threads=1), exact(sites)
    truth = power_vertices(points, weights)
    box = wide_box(sites, powers, truth)
    areas = [plane.signed_area(cell) if len(cell) > 2 else Fraction(0) for cell in cells_by_power(points, weights, box)]
    visible = {i for i, area in enumerate(areas) if area > 0}
    first = {both: i for i, both in reversed(list(enumerate(zip(points, weights, strict=True))))}
    assert diagram.site_of.tolist() == [first[both] for both in zip(points, weights, strict=True)]
    assert diagram.hidden.tolist() == [i for i in range(len(sites)) if diagram.site_of[i] not in visible]
    about = plane.sites_about_vertices(diagram)
    right = {frozenset(meeting & visible): place for place, meeting in truth.items()}
    right = {meeting: place for meeting, place in right.items() if len(meeting) > 2}
    assert sorted(map(sorted, about)) == sorted(map(sorted, right))
    largest = np.abs(sites).max()
    for meeting, place in zip(about, diagram.vertices, strict=True):
        wanted = rounded([right[meeting]])[0]
        off = np.abs(place - wanted).max() / max(largest, np.abs(wanted).max(), 1e-300)
        assert off <= plane.VERTEX_ROUNDINGS, f"{place} for {wanted}"


@guards("power_diagram_2d", on="plane")
def cells_of_powers(sites: Floats, rng: Random) -> None:
    """Areas within a square, their sum, and the least power of points everywhere, in fractions."""
    sites = plane.some_of(sites, rng, 10)
    powers, weights = random_powers(sites, rng)
    corner, side = plane.box_about(sites, rng)
    loop = corner + side * np.array(plane.SQUARE)
    diagram, points = sb.power_diagram_2d(sites, powers, loop, threads=1), exact(sites)
    clipped = diagram.clipped
    assert clipped is not None
    areas = [
        float(plane.signed_area(cell)) if len(cell) > 2 else 0.0
        for cell in cells_by_power(points, weights, exact(loop))
    ]
    # A border's place is rounded by what it is computed from: the sites' coordinates and how far their weights move it.
    apart = [float(np.hypot(*(p - q))) for p, q in combinations(np.unique(sites, axis=0), 2)]
    moved = float(np.ptp(powers)) / min(apart) if apart else 0.0
    size = max(np.abs(loop).max(), np.abs(sites).max(), min(moved, 1e3 * side))
    assert np.abs(clipped.areas - areas).max() <= 8 * plane.ROUNDINGS * size * side * len(sites)
    places = np.vstack([corner + side * rng.random((5, 2)), sites[:3], diagram.vertices[:3]])
    shown = [i for i in range(len(sites)) if i not in set(diagram.hidden.tolist())]
    for place, found in zip(exact(places), diagram.locate(places, threads=1), strict=True):
        assert found == min(shown, key=lambda i: (power(place, points[i], weights[i]), i))


def masses_of(sites: Floats, weights: Floats, low: Floats, side: float, density: Floats) -> Floats:
    """Mass of each cell: density, constant in rectangles over a square, times areas in fractions."""
    points, powers = exact(sites), [Fraction(weight) for weight in weights.tolist()]
    rows, columns = density.shape
    masses = np.zeros(len(sites))
    x = low[0] + side * np.arange(columns + 1) / columns
    y = low[1] + side * np.arange(rows + 1) / rows
    for row in range(rows):
        for column in range(columns):
            loop = [(x[column], y[row]), (x[column + 1], y[row]), (x[column + 1], y[row + 1]), (x[column], y[row + 1])]
            cells = cells_by_power(points, powers, exact(np.array(loop)))
            areas = [float(plane.signed_area(cell)) if len(cell) > 2 else 0.0 for cell in cells]
            masses += density[row, column] * np.array(areas)
    return masses


@guards("balance_2d", "Balance2d", on="plane")
def masses_of_cells(sites: Floats, rng: Random) -> None:
    """Capacities of cells against areas in fractions; sites that may move rest at their cells' centers of mass."""
    low, side = plane.box_about(sites, rng)
    count = int(rng.integers(1, 9))
    inside = low + side * rng.random((count, 2))
    density = rng.random((int(rng.integers(1, 4)), int(rng.integers(1, 4)))) + 0.05
    capacities = rng.random(count) + 0.1
    capacities /= capacities.sum()
    may_move = rng.random() < 0.5
    loop = low + side * np.array(plane.SQUARE)
    # Borders of cells are rounded as far as the box is from the origin, in its sides.
    rounding = 256 * plane.ROUNDINGS * (np.abs(loop).max() / side + 1) / capacities.min()
    if rounding > 1e-2:
        return  # a box of a few roundings
    tolerance = max(1e-9, rounding)
    done = sb.balance_2d(
        inside, loop, density, capacities, 200 if may_move else 0, 1e-12, capacity_tolerance=tolerance, threads=1
    )
    assert done.capacity_error <= tolerance, done.stop_reason
    assert (np.diff(done.energy) <= 0).all()
    if not may_move:
        assert (done.sites == inside).all()
    masses = masses_of(done.sites, done.weights, low, side, density)
    assert np.abs(masses / masses.sum() / capacities - 1).max() <= tolerance + rounding
    assert np.abs(done.shares / capacities - 1).max() <= tolerance + rounding
    if may_move and done.stop_reason == "tolerance":
        clipped = sb.power_diagram_2d(done.sites, done.weights, loop).clipped
        assert clipped is not None
        if density.size == 1:
            assert np.abs(clipped.centroids - done.sites).max() <= (1e-4 + rounding) * side


def corners_of(loop: list[Point]) -> list[Point]:
    """The places where a convex polygon turns."""
    return [
        place
        for before, place, after in zip(loop[-1:] + loop[:-1], loop, loop[1:] + loop[:1], strict=True)
        if cross(before, place, after) != 0
    ]


@guards("periodic_voronoi_2d", "PeriodicVoronoi2d", "PeriodicVoronoi2d.locate", on="plane")
def cells_of_a_torus(sites: Floats, rng: Random) -> None:
    """Each cell, its corners and neighbors, against half planes of all copies two periods around, in fractions."""
    sites = plane.some_of(sites, rng, 9)
    low, side = plane.box_about(sites, rng)
    box = np.array([low, low + side * np.array([1.0, rng.choice([1.0, 0.3, 0.05])])])
    powers = random_powers(sites, rng)[0] if rng.random() < 0.4 else None
    diagram = sb.periodic_voronoi_2d(sites, box, powers, threads=1)
    points, weights = exact(diagram.sites), [Fraction(w) for w in (np.zeros(len(sites)) if powers is None else powers)]
    size = exact(diagram.box)[1][0] - exact(diagram.box)[0][0], exact(diagram.box)[1][1] - exact(diagram.box)[0][1]
    assert (diagram.sites >= diagram.box[0]).all()
    assert (diagram.sites < diagram.box[1]).all()
    unit = np.abs([*box, *(box + side)]).max() * 2.0**-50
    period = np.array([float(c) for c in size])
    periods = np.round((diagram.sites - sites) / period)
    off = np.abs(diagram.sites - sites - periods * period)
    assert (off <= (4 + np.abs(periods)) * unit + 4e-16 * np.abs(sites).max()).all()
    shifts = [(x, y) for x in range(-2, 3) for y in range(-2, 3)]
    copies = {
        (j, shift): ((points[j][0] + shift[0] * size[0], points[j][1] + shift[1] * size[1]), weights[j])
        for j in range(len(points))
        for shift in shifts
    }
    both = list(zip(points, weights, strict=True))
    offsets, places = diagram.cells
    total = Fraction(0)
    slack = plane.VERTEX_ROUNDINGS * (np.abs(diagram.box).max() + 2 * float(max(size)))
    for i, mine in enumerate(both):
        assert diagram.site_of[i] == both.index(mine)
        (x, y), (across, up) = mine[0], size
        loop = [(x - across, y - up), (x + across, y - up), (x + across, y + up), (x - across, y + up)]
        for other in sorted(set(copies.values()) - {mine}, key=lambda c, at=mine[0]: squared(c[0], at)):  # type: ignore[misc]
            loop = half_by_power(loop, mine, other) if loop else loop
        area = plane.signed_area(loop) if len(loop) > 2 else Fraction(0)
        assert (i in diagram.hidden) == (area == 0)
        assert abs(diagram.areas[i] - float(area)) <= 8 * slack * float(max(size))
        if both.index(mine) < i or area == 0:
            assert offsets[i] == offsets[i + 1]
            continue
        total += area
        wanted, found = rounded(corners_of(loop)), places[offsets[i] : offsets[i + 1]]
        assert len(wanted) == len(found)
        off_by_turn = [float(np.abs(np.roll(wanted, -turn, axis=0) - found).max()) for turn in range(len(wanted))]
        turn = int(np.argmin(off_by_turn))
        assert off_by_turn[turn] <= slack
        ends = corners_of(loop)[turn:] + corners_of(loop)[:turn]
        for k in range(len(found)):
            edge = diagram.side_edges[offsets[i] + k]
            left, right = diagram.edge_sites[edge].tolist()
            shift = tuple(diagram.edge_site_shifts[edge].tolist())
            seen = {(right, shift)} if left == i else set()
            seen |= {(left, (-shift[0], -shift[1]))} if right == i else set()
            assert any(
                all(power(end, *copies[beyond]) == power(end, *mine) for end in (ends[k], ends[k - 1]))
                for beyond in seen
            ), "a side is not midway between its sites"
    assert total == size[0] * size[1]
    steps = diagram.vertices[diagram.edges[:, 1]] - diagram.vertices[diagram.edges[:, 0]]
    steps += diagram.edge_shifts * period
    across_sites = diagram.sites[diagram.edge_sites[:, 1]] - diagram.sites[diagram.edge_sites[:, 0]]
    across_sites += diagram.edge_site_shifts * period
    assert (np.abs((steps * across_sites).sum(axis=1)) <= 4 * slack * np.abs(across_sites).sum(axis=1)).all()
    corners = diagram.sites[diagram.delaunay] + diagram.delaunay_shifts * period
    turns = [cross(*exact(triangle)) for triangle in corners]
    assert all(turn > 0 for turn in turns)
    assert sum(turns) == 2 * size[0] * size[1]
    places = np.vstack([diagram.box[0] + (diagram.box[1] - diagram.box[0]) * rng.random((4, 2)), diagram.vertices[:2]])
    for place, nearest in zip(exact(places), diagram.locate(places, threads=1), strict=True):
        powers_there = {j: min(power(place, *copies[j, shift]) for shift in shifts) for j in range(len(points))}
        assert powers_there[int(nearest)] == min(powers_there.values())

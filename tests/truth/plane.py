# SPDX-License-Identifier: MIT
"""Truths about the plane by rational numbers and brute force: doubles are taken as the fractions that they are."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes
from tests.truth.registry import guards

Point = tuple[Fraction, Fraction]
Floats = NDArray[np.float64]
Random = np.random.Generator

ROUNDINGS = 16 * 2.0**-53
"""What a coordinate may be off, relative to the coordinates and distances that it is computed from."""
VERTEX_ROUNDINGS = 4 * 32 * 2.0**-53
"""The same for a vertex of the diagram: its determinant may lose five bits before it is summed up exactly."""


def exact(points: Floats) -> list[Point]:
    return [(Fraction(x), Fraction(y)) for x, y in np.asarray(points, dtype=float).tolist()]


def rounded(points: list[Point]) -> Floats:
    return np.array([(float(x), float(y)) for x, y in points]).reshape(-1, 2)


def squared(a: Point, b: Point) -> Fraction:
    return (a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2


def cross(o: Point, a: Point, b: Point) -> Fraction:
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])


def center_of_circle(a: Point, b: Point, c: Point) -> Point:
    """Where the lines |p - a| = |p - b| and |p - a| = |p - c| meet, by Cramer's rule."""
    ux, uy, vx, vy = b[0] - a[0], b[1] - a[1], c[0] - a[0], c[1] - a[1]
    u, v, twice = ux * ux + uy * uy, vx * vx + vy * vy, 2 * (ux * vy - uy * vx)
    return a[0] + (u * vy - v * uy) / twice, a[1] + (v * ux - u * vx) / twice


def in_whole_numbers(sites: Floats) -> list[tuple[int, int]]:
    """The same sites in a unit in which all coordinates are whole."""
    points = exact(sites)
    unit = max(c.denominator for point in points for c in point)  # all are powers of two
    return [(int(x * unit), int(y * unit)) for x, y in points]


def voronoi_vertices(sites: Floats) -> dict[frozenset[int], Point]:
    """Each vertex by the sites (the first of equal ones) on its circle, which holds no other. O(n^4)."""
    points, given = in_whole_numbers(sites), exact(sites)
    own = [i for i, point in enumerate(points) if point not in points[:i]]
    found: dict[frozenset[int], Point] = {}
    done: set[tuple[int, int, int]] = set()
    for triple in combinations(own, 3):
        if triple in done:
            continue
        (ax, ay), (bx, by), (cx, cy) = (points[i] for i in triple)
        ux, uy, vx, vy = bx - ax, by - ay, cx - ax, cy - ay
        twice = 2 * (ux * vy - uy * vx)
        if twice == 0:
            continue
        u, v = ux * ux + uy * uy, vx * vx + vy * vy
        x, y = u * vy - v * uy, v * ux - u * vx  # the center, from the first site, times `twice`
        sign = 1 if twice > 0 else -1
        on_circle = []
        for i in own:
            px, py = points[i][0] - ax, points[i][1] - ay
            power = sign * (twice * (px * px + py * py) - 2 * (x * px + y * py))
            if power < 0:
                break
            if power == 0:
                on_circle.append(i)
        else:
            done.update(combinations(on_circle, 3))
            found[frozenset(on_circle)] = center_of_circle(*(given[i] for i in triple))
    return found


def half_of(loop: list[Point], mine: Point, other: Point) -> list[Point]:
    """What of a polygon is as near to one site as to another (Sutherland and Hodgman). Where it falls into parts these
    stay joined by bridges of no width.
    """

    def gain(p: Point) -> Fraction:
        return squared(p, other) - squared(p, mine)

    kept = []
    gains = [gain(p) for p in loop]
    for i, (p, q) in enumerate(zip(loop, loop[1:] + loop[:1], strict=True)):
        at_p, at_q = gains[i], gains[(i + 1) % len(loop)]
        if at_p >= 0:
            kept.append(p)
        if (at_p > 0 > at_q) or (at_p < 0 < at_q):
            share = at_p / (at_p - at_q)
            kept.append((p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])))
    return kept


def signed_area(loop: list[Point]) -> Fraction:
    return sum((cross(loop[0], p, q) for p, q in pairwise(loop)), Fraction(0)) / 2


def cells_within(sites: Floats, loops: list[Floats]) -> list[list[list[Point]]]:
    """What of each loop, outlines counter-clockwise and holes clockwise, lies in each site's cell. O(n^2 m)."""
    points = exact(sites)
    within = [exact(loop) for loop in loops]
    within = [loop if (signed_area(loop) > 0) == (i == 0) else loop[::-1] for i, loop in enumerate(within)]
    cells = []
    for i, mine in enumerate(points):
        others = set(points) - {mine}
        cell = []
        for left in within if mine not in points[:i] else []:
            for other in sorted(others, key=lambda p, mine=mine: squared(p, mine)):  # type: ignore[misc]
                left = half_of(left, mine, other) if left else left
            cell.append(left)
        cells.append(cell)
    return cells


def areas_within(sites: Floats, loops: list[Floats]) -> Floats:
    return np.array([float(sum(map(signed_area, cell), Fraction(0))) for cell in cells_within(sites, loops)])


def some_of(sites: Floats, rng: Random, most: int) -> Floats:
    """No more sites than slow truths take."""
    return sites[rng.permutation(len(sites))[:most]]


def box_about(sites: Floats, rng: Random) -> tuple[Floats, float]:
    """The corner and the side of a square about the sites, or about some of them."""
    low, high = sites.min(axis=0), sites.max(axis=0)
    size = float((high - low).max()) or float(np.abs(sites).max()) or 1.0
    return low - size * rng.uniform(-0.2, 0.5, 2), size * float(rng.uniform(0.8, 2.0))


SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
DOMAINS = (
    [SQUARE],
    [[(0, 0), (1, 0), (1, 0.25), (0.25, 0.25), (0.25, 0.75), (1, 0.75), (1, 1), (0, 1)]],
    [SQUARE, [(0.25, 0.25), (0.5, 0.25), (0.375, 0.5)], [(0.5, 0.75), (0.75, 0.75), (0.75, 0.875)]],
    [[(0.5, 0), (0.625, 0.375), (1, 0.5), (0.625, 0.625), (0.5, 1), (0.375, 0.625), (0, 0.5), (0.375, 0.375)]],
)


def random_domain(sites: Floats, rng: Random) -> list[Floats]:
    corner, side = box_about(sites, rng)
    return [corner + side * np.array(loop) for loop in DOMAINS[rng.integers(len(DOMAINS))]]


def sites_about_vertices(diagram: sb.Voronoi2d) -> list[frozenset[int]]:
    about: list[set[int]] = [set() for _ in diagram.vertices]
    for ends, sites in zip(diagram.edges.tolist(), diagram.edge_sites.tolist(), strict=True):
        for vertex in ends:
            if vertex >= 0:
                about[vertex] |= set(sites)
    return [frozenset(sites) for sites in about]


def distance_to_segment(point: Floats, a: Floats, b: Floats) -> float:
    along = b - a
    share = np.clip((point - a) @ along / max(along @ along, 1e-300), 0, 1)
    return float(np.linalg.norm(point - a - share * along))


def depth_within(loops: list[Floats], point: Point) -> float:
    """How far a point is from the loops; 0 outside and in holes."""
    sides = [(p, q) for loop in map(exact, loops) for p, q in zip(loop, loop[1:] + loop[:1], strict=True)]
    crossed = [(q[1] > p[1]) == (cross(p, q, point) > 0) for p, q in sides if (p[1] > point[1]) != (q[1] > point[1])]
    if sum(crossed) % 2 == 0:
        return 0.0
    place = rounded([point])[0]
    return min(distance_to_segment(place, *rounded([p, q])) for p, q in sides)


@guards("voronoi_2d", "Voronoi2d", on="plane")
def vertices_of_points(sites: Floats, rng: Random) -> None:
    """Which cells meet in which vertices, and where, against all circles through three sites, in fractions."""
    sites = some_of(sites, rng, 14)
    diagram, truth = sb.voronoi_2d(sites, threads=1), voronoi_vertices(sites)
    about = sites_about_vertices(diagram)
    assert sorted(map(sorted, about)) == sorted(map(sorted, truth))
    largest = np.abs(sites).max()
    for vertex, place in zip(about, diagram.vertices, strict=True):
        right = rounded([truth[vertex]])[0]
        off = np.abs(place - right).max() / max(largest, np.abs(right).max())
        assert off <= VERTEX_ROUNDINGS, f"{place} for {right}"
    first = {point: i for i, point in reversed(list(enumerate(exact(sites))))}
    assert diagram.site_of.tolist() == [first[point] for point in exact(sites)]


@guards("Voronoi2d.areas", "Voronoi2d.centroids", on="plane")
def areas_of_points(sites: Floats, rng: Random) -> None:
    """Areas and centers of mass of bounded cells, against polygons of fractions."""
    sites = some_of(sites, rng, 14)
    diagram, vertices = sb.voronoi_2d(sites, threads=1), voronoi_vertices(sites)
    points = exact(sites)
    assert (diagram.areas >= 0).all()
    for i in np.flatnonzero(np.isfinite(diagram.areas)):
        first = points.index(points[i])
        corners = [place for about, place in vertices.items() if first in about]
        reach = max(abs(c - m) for place in corners for c, m in zip(place, points[i], strict=True))
        m = points[i]
        box = [(m[0] + x * 2 * reach, m[1] + y * 2 * reach) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        for other in set(points) - {m}:
            box = half_of(box, m, other)
        size = float(reach)
        rounding = 8 * ROUNDINGS * size * (size + np.abs(sites).max())
        assert abs(diagram.areas[i] - float(signed_area(box))) <= rounding
        low, high = rounded(corners).min(axis=0), rounded(corners).max(axis=0)
        slack = ROUNDINGS * (size + np.abs(sites).max())
        assert (diagram.centroids[i] >= low - slack).all()
        assert (diagram.centroids[i] <= high + slack).all()


@guards("Voronoi2d.clip", "ClippedCells", on="plane")
def clipped_cells(sites: Floats, rng: Random) -> None:
    """Cells within domains of every sort, against polygons of fractions: areas, their sum, corners."""
    sites = some_of(sites, rng, 10)
    loops = random_domain(sites, rng)
    diagram = sb.voronoi_2d(sites, threads=1)
    clipped = diagram.clip(loops if len(loops) > 1 else loops[0], threads=1)
    areas = areas_within(sites, loops)
    size = max(np.ptp(loops[0], axis=0).max(), np.abs(loops[0]).max(), np.abs(sites).max())
    rounding = ROUNDINGS * size * np.ptp(loops[0], axis=0).max()
    assert (clipped.areas >= 0).all()
    assert np.abs(clipped.areas - areas).max() <= 8 * rounding
    assert abs(clipped.areas.sum() - areas.sum()) <= 8 * rounding
    vertices = voronoi_vertices(sites)
    for site in range(len(sites)):
        mine = [k for k, owner in enumerate(clipped.loop_sites) if owner == site]
        own = [clipped.points[clipped.loop_offsets[k] : clipped.loop_offsets[k + 1]] for k in mine]
        points = np.concatenate([np.zeros((0, 2)), *own])
        distances = np.sqrt([[float(squared(p, q)) for q in exact(sites)] for p in exact(points)]).reshape(
            -1, len(sites)
        )
        assert (distances[:, site] <= distances.min(axis=1) + 4 * ROUNDINGS * size).all()
        sides = [(a, b) for loop in own for a, b in zip(loop, np.roll(loop, -1, axis=0), strict=True)]
        for about, vertex in vertices.items():
            if site in about and depth_within(loops, vertex) > 1e-9 * size:
                # At its place to rounding: where twins an ulp apart meet a cell its sides are in line, to rounding.
                off = min(distance_to_segment(rounded([vertex])[0], a, b) for a, b in sides)
                assert off <= VERTEX_ROUNDINGS * size, f"{vertex} is not on the border"


@guards("Voronoi2d.locate", on="plane")
def nearest_sites(sites: Floats, rng: Random) -> None:
    """The nearest site of points everywhere, at vertices and at sites, in fractions; of equally near ones the first."""
    corner, side = box_about(sites, rng)
    diagram = sb.voronoi_2d(sites, threads=1)
    places = np.vstack([corner + side * rng.random((5, 2)), sites[:3], diagram.vertices[:3]])
    points = exact(sites)
    for place, found in zip(exact(places), diagram.locate(places, threads=1), strict=True):
        assert found == min(range(len(points)), key=lambda i: (squared(points[i], place), i))


@guards(
    "Chart.lift",
    "LiftedVoronoi",
    "Chart",
    on="plane",
)
def lifted_cells(sites: Floats, rng: Random) -> None:
    """A diagram lifted to a flat mesh is the diagram: areas against fractions, edges midway between their sites."""
    sites = some_of(sites, rng, 10)
    corner, side = box_about(sites, rng)
    vertices, triangles = meshes.grid(
        int(rng.integers(2, 6)), int(rng.integers(2, 6)), jitter=0.2, seed=int(rng.integers(99))
    )
    if rng.random() < 0.5:
        vertices[:, :2] = np.round(64 * vertices[:, :2]) / 64
    uv = corner + side * vertices[:, :2] / vertices[:, :2].max(axis=0)
    mesh = sb.Mesh(np.column_stack([uv, np.zeros(len(uv))]), triangles)
    diagram = sb.voronoi_2d(sites, threads=1)
    lifted = sb.Chart(mesh, uv).lift(diagram, threads=1)
    border = np.array([uv[v] for v in mesh.boundary_loops[0]])
    size = max(np.abs(uv).max(), np.abs(sites).max())
    rounding = 64 * ROUNDINGS * size * side
    assert np.abs(lifted.areas - areas_within(sites, [border])).max() <= rounding
    for k, (left, other) in enumerate(lifted.edge_cells):
        points = lifted.edge_points[lifted.edge_offsets[k] : lifted.edge_offsets[k + 1], :2]
        across = sites[other] - sites[left]
        middle = 0.5 * sites[left] + 0.5 * sites[other]
        assert np.abs((points - middle) @ across).max() <= 16 * ROUNDINGS * size * np.abs(across).max()
    split = lifted.split()
    a, b, c = (split.vertices[split.triangles[:, i], :2] for i in range(3))
    of_triangles = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    areas = np.bincount(split.triangle_cell, of_triangles, minlength=len(sites))
    assert np.abs(areas - lifted.areas).max() <= rounding

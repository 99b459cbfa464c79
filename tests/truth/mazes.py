# SPDX-License-Identifier: MIT
"""Mazes in the plane: distances around barriers against the visibility graph of all walls, and the ways to and fro.

Ways in the plane bend at ends of walls only. A point at which walls end is there once for each sector between them: a
way comes and leaves within one of these. Whatever touches a wall elsewhere is blocked.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import dijkstra

import saddleback as sb
from tests import meshes
from tests.truth.registry import guards

Floats = NDArray[np.float64]
Random = np.random.Generator
Wall = tuple[int, int]


def area_between(u: Floats, v: Floats) -> Floats:
    """Signed areas of the parallelograms of vectors in the plane."""
    areas: Floats = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    return areas


def meet(a: Floats, b: Floats, c: Floats, d: Floats) -> NDArray[np.bool_]:
    """Whether the closed segment from a to b has a point in common with those from c (n, 2) to d."""
    sides = [np.sign(area_between(q - p, r - p)) for p, q, r in ((a, b, c), (a, b, d), (c, d, a), (c, d, b))]
    crossing = (sides[0] * sides[1] <= 0) & (sides[2] * sides[3] <= 0)
    first = np.maximum(np.minimum(a, b), np.minimum(c, d))
    apart = (first > np.minimum(np.maximum(a, b), np.maximum(c, d))).any(axis=1)  # where all are on one line
    found: NDArray[np.bool_] = crossing & ~apart
    return found


class Maze:
    """Walls between points of the unit square (n, 2), and triangles of these points that are filled with wall.

    The square's border is wall as well, from each point on it to the next.
    """

    def __init__(self, points: Floats, walls: set[Wall], filled: list[list[int]]) -> None:
        sides = [(face[i], face[(i + 1) % 3]) for face in filled for i in range(3)]
        for axis, at in itertools.product((0, 1), (0.0, 1.0)):
            row = np.flatnonzero(points[:, axis] == at)
            sides += itertools.pairwise(row[np.argsort(points[row, 1 - axis])].tolist())
        self.points, self.filled = points, filled
        self.walls = walls | {(min(side), max(side)) for side in sides}
        self.ends = np.array(sorted(self.walls))
        self.beside: list[list[int]] = [[] for _ in points]
        for a, b in self.walls:
            self.beside[a].append(b)
            self.beside[b].append(a)
        self.rays = [sorted(self.angle(a, b) for b in ends) for a, ends in enumerate(self.beside)]
        self.nodes = [
            (point, sector)
            for point, rays in enumerate(self.rays)
            for sector in range(max(len(rays), 1))
            if not self.is_filled(point, sector)
        ]

    def angle(self, a: int, b: int) -> float:
        x, y = self.points[b] - self.points[a]
        return math.atan2(y, x)

    def is_filled(self, point: int, sector: int) -> bool:
        """Whether the middle of a sector leads into a filled triangle or out of the square."""
        rays = self.rays[point]
        if not rays:
            return False
        width = (rays[(sector + 1) % len(rays)] - rays[sector]) % (2 * math.pi) or 2 * math.pi
        middle = rays[sector] + width / 2
        way = np.array([math.cos(middle), math.sin(middle)])
        if (((self.points[point] == 0) & (way < 0)) | ((self.points[point] == 1) & (way > 0))).any():
            return True
        for face in self.filled:
            if point in face:
                i = face.index(point)
                right, left = (self.points[face[(i + k) % 3]] - self.points[point] for k in (1, 2))
                if area_between(right, way) > 0 and area_between(way, left) > 0:
                    return True
        return False

    def sectors(self, a: int, b: int) -> list[int]:
        """The sectors at a in which b lies: two where it is along a wall."""
        rays = self.rays[a]
        if len(rays) < 2:
            return [0]
        angle = self.angle(a, b)
        after = sum(ray <= angle for ray in rays) - 1
        return [after % len(rays), (after - 1) % len(rays)] if angle in rays else [after % len(rays)]

    def sees(self, a: int, b: int) -> bool:
        """Whether nothing but walls at its ends meets the line between two points."""
        one, other = self.points[a], self.points[b]
        c, d = self.points[self.ends[:, 0]], self.points[self.ends[:, 1]]
        at = ((self.ends == a) | (self.ends == b)).sum(axis=1)
        if meet(one, other, c, d)[at == 0].any():
            return False
        for wall in self.ends[at == 1].tolist():  # along the wall, beyond the shorter of both ends
            corner = a if a in wall else b
            u = self.points[a + b - corner] - self.points[corner]
            v = self.points[sum(wall) - corner] - self.points[corner]
            if area_between(u, v) == 0 and u @ v > 0:
                return False
        return True

    def joined(self, a: int, b: int) -> list[tuple[int, int]]:
        """The pairs of sectors at a and b between which a line runs: along a wall one on either side of it."""
        here, there = self.sectors(a, b), self.sectors(b, a)
        if len(here) == len(there) == 2:
            return [(here[0], there[1]), (here[1], there[0])]
        return list(itertools.product(here, there))

    def distances(self, source: int) -> Floats:
        """(n,) from a point to all: the least of what reaches their sectors."""
        number = {node: i for i, node in enumerate(self.nodes)}
        weights = np.full((len(self.nodes), len(self.nodes)), np.inf)
        for a, b in itertools.combinations(range(len(self.points)), 2):
            for i, j in self.joined(a, b) if self.sees(a, b) else ():
                if (a, i) in number and (b, j) in number:
                    length = np.linalg.norm(self.points[b] - self.points[a])
                    weights[number[a, i], number[b, j]] = weights[number[b, j], number[a, i]] = length
        starts = [number[node] for node in self.nodes if node[0] == source]
        reached = dijkstra(weights, indices=starts).min(axis=0)
        found = np.full(len(self.points), np.inf)
        for (point, _), distance in zip(self.nodes, reached, strict=True):
            found[point] = min(found[point], distance)
        return found


def points_at(mesh: sb.Mesh, places: Floats) -> sb.SurfacePoints:
    """Points of a flat mesh by places (n, 2) in it, without the library's help."""
    corners = mesh.vertices[mesh.triangles, :2]
    faces, weights = [], []
    for place in places:
        to = corners - place
        parts = np.stack([area_between(to[:, (i + 1) % 3], to[:, (i + 2) % 3]) for i in range(3)], axis=1)
        parts /= parts.sum(axis=1, keepdims=True)
        faces.append(int(parts.min(axis=1).argmax()))
        weights.append(np.maximum(parts[faces[-1]], 0))
    return sb.SurfacePoints(np.array(faces, np.int32), np.array(weights))


def curve_through(mesh: sb.Mesh, places: Floats) -> sb.SurfaceCurve:
    """The straight lines through places of a flat mesh, with a point on each edge that they cross."""
    ends = mesh.vertices[mesh.edges, :2]
    along = ends[:, 1] - ends[:, 0]
    passed = [places[:1]]
    for a, b in itertools.pairwise(places):
        way = b - a
        with np.errstate(divide="ignore", invalid="ignore"):
            there = area_between(ends[:, 0] - a, along) / area_between(way, along)
            across = area_between(ends[:, 0] - a, way) / area_between(way, along)
        shares = np.sort(there[(there > 0) & (there < 1) & (across > 0) & (across < 1)])
        passed += [a + shares[:, None] * way, b[None]]
    return sb.SurfaceCurve(mesh, points_at(mesh, np.vstack(passed)))


def crosses_itself(places: Floats) -> bool:
    starts, ends = places[:-1], places[1:]
    return any(meet(starts[i], ends[i], starts[i + 2 :], ends[i + 2 :]).any() for i in range(len(starts)))


@guards(
    "add_barriers",
    "BarredMesh",
    "BarredMesh.to_barred",
    "BarredMesh.to_whole",
    "BarredMesh.values_to_barred",
    "BarredMesh.least",
    "BarredMesh.least_copies",
    "exact_distances",
    on="nothing",
)
def mazes(rng: Random) -> None:
    """Distances in random mazes of edges, curves and faces against visibility graphs, within 1e-9."""
    side = int(rng.integers(3, 7))
    mesh = sb.Mesh(*meshes.grid(side, side, jitter=0.3, seed=int(rng.integers(1 << 30))))
    count = mesh.vertex_count
    edges = mesh.edges[rng.permutation(len(mesh.edges))[: rng.integers(0, 3 * side)]]
    filled = rng.permutation(mesh.face_count)[: rng.integers(0, side)]
    lines = [rng.uniform(0.02, 0.98, (int(rng.integers(2, 5)), 2)) for _ in range(int(rng.integers(0, 4)))]
    curves = [curve_through(mesh, line) for line in lines]
    if any(map(crosses_itself, lines)):
        try:
            sb.add_barriers(mesh, edges=edges, curves=curves, faces=filled)
        except sb.InputError as error:
            assert "crosses or touches itself at (" in str(error), error
            return
        raise AssertionError("a curve that crosses itself was taken")
    barred = sb.add_barriers(mesh, edges=edges, curves=curves, faces=filled)

    targets = rng.uniform(0, 1, (4, 2))
    where = points_at(mesh, targets)
    kept = ~np.isin(where.faces, filled)
    places = np.vstack([mesh.vertices[:, :2], targets[kept], *lines])
    walls = {(min(edge), max(edge)) for edge in edges.tolist()}
    first = count + int(kept.sum())
    for line in lines:
        walls |= {(first + i, first + i + 1) for i in range(len(line) - 1)}
        first += len(line)
    source = int(rng.choice(np.unique(np.delete(mesh.triangles, filled, axis=0))))
    true = Maze(places, walls, mesh.triangles[filled].tolist()).distances(source)

    starts, index = barred.to_barred([source])
    assert not index.any()
    on_barred = sb.exact_distances(barred.mesh, starts)
    assert_near(barred.least(on_barred), true[:count], "exact_distances")
    copies = barred.least_copies(on_barred)
    assert np.array_equal(copies >= 0, np.isin(np.arange(count), np.delete(mesh.triangles, filled, axis=0)))
    assert np.array_equal(on_barred[copies[copies >= 0]], barred.least(on_barred)[copies >= 0])
    graph = sb.SaddleVertexGraph(barred.mesh, exact=True, threads=1)
    assert_near(barred.least(graph.distances(starts)), true[:count], "the exact graph")

    chosen = sb.SurfacePoints(where.faces[kept], where.barycentric[kept])
    ends, index = barred.to_barred(chosen)
    assert np.array_equal(index, np.arange(len(chosen))), "a point off all barriers is there once"
    found = sb.ExactField(barred.mesh, starts).distance_to(ends)
    assert_near(found, true[count : count + len(chosen)], "ExactField")
    back = barred.to_whole(ends).positions(mesh)
    assert np.abs(back - chosen.positions(mesh)).max(initial=0.0) <= 1e-12
    assert np.abs(barred.mesh.vertices - barred.vertex_points.positions(mesh)).max() <= 1e-12
    for axis in (0, 1):
        spread = barred.values_to_barred(mesh.vertices[:, axis])
        assert np.abs(spread - barred.mesh.vertices[:, axis]).max() <= 1e-12
    area = mesh.area - mesh.face_areas[filled].sum()
    assert abs(barred.mesh.area - area) <= 1e-12 * mesh.area


def assert_near(found: Floats, true: Floats, what: str) -> None:
    assert np.array_equal(np.isfinite(found), np.isfinite(true)), f"{what}: other points are reached"
    ends = np.isfinite(true)
    worst = np.abs(found[ends] - true[ends]).max(initial=0.0)
    assert worst <= 1e-9, f"{what}: off by {worst}"

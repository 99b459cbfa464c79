# SPDX-License-Identifier: MIT
"""Truths about distances: Euclid where a mesh is a convex piece of the plane, else all straight lines one by one.

`exact_by_truth` unfolds every sequence of faces that light from a root can run through, in decimal arithmetic of 50
digits: no filters, no windows that hide one another, no tolerance that doubles would need.
"""

from __future__ import annotations

import heapq
from decimal import Decimal, localcontext
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components, dijkstra

import saddleback as sb
from tests.truth.registry import guards

Floats = NDArray[np.float64]
Indices = NDArray[np.int32]
Random = np.random.Generator
Place = tuple[Decimal, Decimal]

DIGITS, NOTHING = 50, Decimal("1e-36")
MOST_FACES = 60  # that the slow truth is asked about in a random check
# Edges that the slow truth crosses from one root in a random check: about a neck of a thousandth of the way lines wind
# thousands of times, each turn of them a line of its own.
MOST_CROSSINGS = 100_000


def area_between(u: Floats, v: Floats) -> Floats:
    """Signed areas (n,) of the parallelograms of vectors (n, 2) in the plane."""
    areas: Floats = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    return areas


def cross(a: Place, b: Place) -> Decimal:
    return a[0] * b[1] - a[1] * b[0]


class TooSlowError(Exception):
    """The slow truth would not answer in time."""


class Unfolder:
    """A triangle mesh by its edges' squared lengths."""

    def __init__(self, vertices: Floats, triangles: Indices) -> None:
        places = [[Decimal(float(x)) for x in place] for place in vertices]
        self.apex: dict[tuple[int, int], int] = {}
        self.square: dict[tuple[int, int], Decimal] = {}
        for face in triangles.tolist():
            for i in range(3):
                a, b, c = face[i], face[(i + 1) % 3], face[(i + 2) % 3]
                self.apex[a, b] = c
                square = sum(((q - p) ** 2 for p, q in zip(places[a], places[b], strict=True)), Decimal(0))
                self.square[a, b] = self.square[b, a] = square

    def beyond(self, a: int, b: int, at_a: Place, at_b: Place) -> tuple[int, Place]:
        """The corner of the face behind the edge from a to b, which lies left of the line from a to b."""
        c = self.apex[a, b]
        base, left, right = self.square[a, b], self.square[a, c], self.square[b, c]
        along = (base + left - right) / (2 * base)
        off = max(left / base - along**2, Decimal(0)).sqrt()
        x, y = at_b[0] - at_a[0], at_b[1] - at_a[1]
        return c, (at_a[0] + along * x - off * y, at_a[1] + along * y + off * x)

    def seen_from(self, root: int, farthest: Decimal, most_crossings: float) -> dict[int, Decimal]:
        """Vertices along straight lines from a vertex, no longer than that, and how far they are.

        Raises TooSlowError where the lines cross more than `most_crossings` edges.
        """
        crossings = 0
        found: dict[int, Decimal] = {}

        def see(vertex: int, place: Place) -> None:
            distance = (place[0] ** 2 + place[1] ** 2).sqrt()
            found[vertex] = min(distance, found.get(vertex, distance))

        light = []
        origin = (Decimal(0), Decimal(0))
        for (start, a), b in self.apex.items():
            if start != root:
                continue
            at_a = (self.square[root, a].sqrt(), Decimal(0))
            at_b = self.beyond(root, a, origin, at_a)[1]
            see(a, at_a)
            see(b, at_b)
            light.append((a, b, at_a, at_b, at_a, at_b))
        while light:
            a, b, at_a, at_b, right, left = light.pop()  # an edge from right to left, and the rays that come through it
            if (b, a) not in self.apex or self.nearest(at_a, at_b, right, left) > farthest:
                continue
            crossings += 1
            if crossings > most_crossings:
                raise TooSlowError
            c, at_c = self.beyond(b, a, at_b, at_a)
            from_right, to_left = cross(right, at_c), cross(at_c, left)
            if from_right >= -NOTHING and to_left >= -NOTHING:
                see(c, at_c)
            if from_right > NOTHING:
                light.append((a, c, at_a, at_c, right, at_c if to_left > 0 else left))
            if to_left > NOTHING:
                light.append((c, b, at_c, at_b, at_c if from_right > 0 else right, left))
        return found

    @staticmethod
    def nearest(at_a: Place, at_b: Place, right: Place, left: Place) -> Decimal:
        """How far the part of an edge between two rays is from the origin, or less."""
        along = (at_b[0] - at_a[0], at_b[1] - at_a[1])
        size = (along[0] ** 2 + along[1] ** 2).sqrt()
        to_line = abs(cross(at_a, along)) / size
        foot = (along[1], -along[0]) if cross(at_a, along) > 0 else (-along[1], along[0])
        if cross(right, foot) >= 0 and cross(foot, left) >= 0:
            return to_line
        reaches = []
        for ray in (right, left):
            speed = cross(ray, along)
            if abs(speed) <= NOTHING:
                return to_line
            part = cross(at_a, along) / speed
            reaches.append(part * (ray[0] ** 2 + ray[1] ** 2).sqrt())
        return min(reaches)


def by_edges(vertices: Floats, triangles: Indices, source: int) -> Floats:
    """Distances along edges (V,): never too short."""
    a, b = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    lengths = np.linalg.norm(vertices[a] - vertices[b], axis=1)
    edges = coo_matrix((lengths, (np.minimum(a, b), np.maximum(a, b))), shape=2 * (len(vertices),)).tocsr()
    count = coo_matrix((np.ones(len(a)), (np.minimum(a, b), np.maximum(a, b))), shape=2 * (len(vertices),)).tocsr()
    edges.data = edges.data / count.data
    return np.asarray(dijkstra(edges, directed=False, indices=source))


def bending(vertices: Floats, triangles: Indices) -> NDArray[np.bool_]:
    """Where a shortest path may bend (V,): at the border, or where there is more than a full turn, or nearly."""
    angle = np.zeros(len(vertices))
    degree = np.zeros(len(vertices), dtype=int)
    for i in range(3):
        u, v = (vertices[triangles[:, (i + k) % 3]] - vertices[triangles[:, i]] for k in (1, 2))
        np.add.at(angle, triangles[:, i], np.arctan2(np.linalg.norm(np.cross(u, v), axis=1), (u * v).sum(axis=1)))
        np.add.at(degree, triangles[:, i], 1)
    neighbors = {tuple(edge) for face in triangles.tolist() for edge in zip(face, face[1:] + face[:1], strict=True)}
    border = np.zeros(len(vertices), dtype=bool)
    for a, b in neighbors:
        if (b, a) not in neighbors:
            border[[a, b]] = True
    return border | (angle > 2 * np.pi - 1e-9)


def exact_by_truth(vertices: Floats, triangles: Indices, source: int, most_crossings: float = np.inf) -> Floats:
    """The length of the shortest path from one vertex to every vertex (V,); inf where there is none. Slow.

    Raises TooSlowError where lines from one vertex cross more than `most_crossings` edges.
    """
    most = by_edges(vertices, triangles, source)
    reached = np.flatnonzero(np.isfinite(most))
    roots = bending(vertices, triangles)
    with localcontext() as context:
        context.prec = DIGITS
        mesh = Unfolder(vertices, triangles)
        distance = {int(v): Decimal(float(most[v])) * (1 + Decimal("1e-14")) for v in reached}
        distance[source] = Decimal(0)
        queue, done = [(Decimal(0), source)], set()
        while queue:
            at, root = heapq.heappop(queue)
            if root in done:
                continue
            done.add(root)
            for vertex, length in mesh.seen_from(root, max(distance.values()) - at, most_crossings).items():
                if at + length <= distance[vertex]:
                    distance[vertex] = at + length
                    if roots[vertex]:
                        heapq.heappush(queue, (at + length, vertex))
    result = np.full(len(vertices), np.inf)
    for vertex, length in distance.items():
        result[vertex] = float(length)
    return result


def is_convex_and_flat(mesh: sb.Mesh) -> bool:
    """Whether it is one convex piece of a plane z = const, told exactly."""
    if mesh.components.max() > 0 or len(mesh.boundary_loops) != 1 or np.ptp(mesh.vertices[:, 2]) > 0:
        return False
    u = mesh.vertices[mesh.triangles[:, 1]] - mesh.vertices[mesh.triangles[:, 0]]
    v = mesh.vertices[mesh.triangles[:, 2]] - mesh.vertices[mesh.triangles[:, 0]]
    sides = np.sign(np.cross(u, v)[:, 2])
    if abs(sides.sum()) != len(sides):
        return False
    rim = [[Fraction(float(x)) for x in mesh.vertices[v, :2]] for v in mesh.boundary_loops[0]]
    turns = set()
    for a, b, c in zip(rim, rim[1:] + rim[:1], rim[2:] + rim[:2], strict=True):
        turn = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
        turns.add((turn > 0) - (turn < 0))
    return len(turns - {0}) <= 1


def longest_edge(mesh: sb.Mesh) -> float:
    corners = mesh.vertices[mesh.triangles]
    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max())


def assert_near(found: Floats, expected: Floats, mesh: sb.Mesh, what: str, share: float = 1e-9) -> None:
    """Within that share of the distance, and rounding of the edges that lie between."""
    room = share * np.where(np.isfinite(expected), expected, 0) + 1e-14 * longest_edge(mesh)
    same = found == expected
    same[~same] = np.abs(found[~same] - expected[~same]) <= room[~same]
    assert same.all(), f"{what}: {found[~same][:3]} for {expected[~same][:3]} at {np.flatnonzero(~same)[:3]}"


def log_map_distances(found: sb.LogMap, count: int) -> Floats:
    result = np.full(count, np.inf)
    result[found.vertices] = np.linalg.norm(found.uv, axis=1)
    return result


@guards("exact_distances", "exact_nearest", "ExactField", "SaddleVertexGraph.log_map", "exp_map", "trace")
def euclid_in_the_plane(mesh: sb.Mesh, rng: Random) -> None:
    """Distances, log map, paths and their inverse against coordinates, on flat convex meshes."""
    if not is_convex_and_flat(mesh):
        return
    source = int(rng.integers(len(mesh.vertices)))
    true = np.linalg.norm(mesh.vertices - mesh.vertices[source], axis=1)
    assert_near(sb.exact_distances(mesh, [source]), true, mesh, "exact_distances")
    field = sb.ExactField(mesh, [source])
    faces = rng.integers(len(mesh.triangles), size=5).astype(np.int32)
    inside = sb.SurfacePoints(faces, rng.dirichlet([1, 1, 1], 5))
    straight = np.linalg.norm(inside.positions(mesh) - mesh.vertices[source], axis=1)
    assert_near(field.distance_to(inside), straight, mesh, "ExactField.distance_to")
    assert_near(np.array([path.length for path in field.paths(inside)]), straight, mesh, "ExactField.paths")
    sources = rng.integers(len(mesh.vertices), size=3).astype(np.int32)
    gaps = np.linalg.norm(mesh.vertices[:, None] - mesh.vertices[sources], axis=2)
    distance, nearest = sb.exact_nearest(mesh, sources)
    assert_near(distance, gaps.min(axis=1), mesh, "exact_nearest")
    assert_near(gaps[np.arange(len(gaps)), nearest], gaps.min(axis=1), mesh, "exact_nearest's index")
    found = sb.SaddleVertexGraph(mesh, threads=1).log_map(source, np.inf)
    assert_near(log_map_distances(found, len(true)), true, mesh, "log_map")
    ends = sb.exp_map(mesh, source, found.uv, threads=1).positions(mesh)
    missed = np.linalg.norm(ends - mesh.vertices[found.vertices], axis=1)
    assert missed.max() <= 1e-8 * longest_edge(mesh), f"exp_map of log_map misses by {missed.max()}"


@guards("exact_distances", "SaddleVertexGraph.log_map")
def shortest_of_all_lines(mesh: sb.Mesh, rng: Random) -> None:
    """Distances and the log map against every straight line between vertices, on small meshes."""
    if len(mesh.triangles) > MOST_FACES:
        return
    source = int(rng.integers(len(mesh.vertices)))
    try:
        true = exact_by_truth(mesh.vertices, mesh.triangles, source, MOST_CROSSINGS)
    except TooSlowError:
        return
    assert_near(sb.exact_distances(mesh, [source]), true, mesh, "exact_distances")
    found = sb.SaddleVertexGraph(mesh, threads=1).log_map(source, np.inf)
    assert_near(log_map_distances(found, len(true)), true, mesh, "log_map")


@guards("exact_distances", "SaddleVertexGraph.distances", "SaddleVertexGraph.log_map")
def distances_are_a_metric(mesh: sb.Mesh, rng: Random) -> None:
    """Nothing of a part is unreached, both ways are as long, no edge is longer than it is, no graph is shorter."""
    a, b = (int(v) for v in rng.integers(len(mesh.vertices), size=2))
    found = sb.exact_distances(mesh, [a])
    whole = float(found[np.isfinite(found)].max()) + longest_edge(mesh)
    edges = np.stack([mesh.triangles, np.roll(mesh.triangles, 1, axis=1)], axis=2).reshape(-1, 2)
    joined = coo_matrix((np.ones(len(edges)), edges.T), shape=2 * (len(mesh.vertices),))
    part = connected_components(joined, directed=False)[1]
    assert np.array_equal(np.isfinite(found), part == part[a]), "unreached within a part"
    back = sb.exact_distances(mesh, [b])[a]
    assert back == found[b] or abs(back - found[b]) <= 1e-9 * back + 1e-14 * whole, f"{a} to {b}: {found[b]}, {back}"
    edges = edges[part[edges[:, 0]] == part[a]]
    lengths = np.linalg.norm(mesh.vertices[edges[:, 0]] - mesh.vertices[edges[:, 1]], axis=1)
    excess = (np.abs(found[edges[:, 0]] - found[edges[:, 1]]) - lengths).max()
    assert excess <= 1e-12 * whole, f"an edge is {excess} too short for its ends' distances"
    graph = sb.SaddleVertexGraph(mesh, threads=1)
    by_graph = graph.distances([a])
    near = part == part[a]
    # Its windows know the direction of a short edge no better than this.
    share = 1e-9 + 1e-14 * longest_edge(mesh) / lengths.min()
    assert (found[near] <= by_graph[near] * (1 + share) + 1e-12 * whole).all(), "the graph is shorter than exact"
    assert_near(log_map_distances(graph.log_map(a, np.inf), len(found)), found, mesh, "log_map")

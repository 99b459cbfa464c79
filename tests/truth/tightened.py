# SPDX-License-Identifier: MIT
"""Curves pulled tight: what they wind about, and the angles on both sides of every one of their points. Distances from
curves.

Homotopic curves have the same integrals of closed forms. A curve is locally shortest where neither side has less than
pi; at the border of the surface one side is outside.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import null_space

import saddleback as sb
from tests.truth.distances import Floats, Random, is_convex_and_flat, longest_edge
from tests.truth.graph import ROUNDING, promised, random_rule
from tests.truth.lines_and_maps import polyline_length
from tests.truth.registry import guards
from tests.truth.ways import assert_is_way, random_points

SLACK = 1e-6
"""Radians."""


def random_curve(mesh: sb.Mesh, rng: Random, closed: bool) -> sb.SurfaceCurve | None:
    """Ways between random points of one component, one after the other, or a walk along random edges."""
    if rng.random() < 0.5:
        graph = sb.SaddleVertexGraph(mesh, threads=1)
        component = rng.integers(mesh.component_count)
        own = np.flatnonzero(mesh.components[mesh.triangles[:, 0]] == component)
        stops = random_points(mesh, rng, int(rng.integers(2, 6)), own)
        order = [*range(len(stops)), *([0] if closed else [])]
        ways = [graph.path(stops[i], stops[j]).surface for i, j in pairwise(order)]
        faces = np.concatenate([way.faces for way in ways])
        points = sb.SurfacePoints(faces, np.concatenate([way.barycentric for way in ways]))
    else:
        sides = mesh.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        beside = [sides[(sides == v).any(axis=1)].sum(axis=1) - v for v in range(mesh.vertex_count)]
        walk = [int(rng.integers(mesh.vertex_count))]
        for _ in range(int(rng.integers(1, 30))):
            walk.append(int(rng.choice(beside[walk[-1]])))
        points = np.array(walk + walk[-2:0:-1] if closed else walk, dtype=np.int32)
        if closed and rng.random() < 0.7 and len(mesh.boundary_loops) > 0:
            points = np.asarray(mesh.boundary_loops[int(rng.integers(len(mesh.boundary_loops)))], dtype=np.int32)
    try:
        return sb.SurfaceCurve(mesh, points, closed=closed)
    except sb.InputError:  # all in one point
        return None


def closed_forms(mesh: sb.Mesh) -> Floats:
    """(forms, F, 3): the forms that are closed but no gradients, as what they are from corner 0 to each corner."""
    edges = {tuple(edge): i for i, edge in enumerate(np.sort(mesh.edges, axis=1).tolist())}
    vertices = np.zeros((len(edges), mesh.vertex_count))
    for (a, b), i in edges.items():
        vertices[i, a], vertices[i, b] = -1, 1
    around = np.zeros((mesh.face_count, len(edges)))
    index, sign = np.zeros((mesh.face_count, 3), int), np.zeros((mesh.face_count, 3))
    for f, face in enumerate(mesh.triangles.tolist()):
        for k in range(3):
            a, b = face[k], face[(k + 1) % 3]
            index[f, k], sign[f, k] = edges[min(a, b), max(a, b)], 1 if a < b else -1
            around[f, index[f, k]] += sign[f, k]
    forms = null_space(np.vstack([around, vertices.T])).T
    along = forms[:, index] * sign
    return np.stack([0 * along[..., 0], along[..., 0], -along[..., 2]], axis=-1)


def integrals(mesh: sb.Mesh, forms: Floats, points: sb.SurfacePoints, closed: bool) -> Floats:
    """Of the forms along the curve."""
    total = np.zeros(len(forms))
    for one, other in pairwise([*range(len(points)), *([0] if closed else [])]):
        face = shared_face(mesh, points, one, other)
        change = weights_in(mesh, points, other, face) - weights_in(mesh, points, one, face)
        total += forms[:, face] @ change
    return total


def weights_in(mesh: sb.Mesh, points: sb.SurfacePoints, i: int, face: int) -> Floats:
    """Barycentric coordinates in a face that the point lies in, too."""
    own = dict(zip(mesh.triangles[points.faces[i]].tolist(), points.barycentric[i].tolist(), strict=True))
    return np.array([own.get(v, 0.0) for v in mesh.triangles[face].tolist()])


def shared_face(mesh: sb.Mesh, points: sb.SurfacePoints, i: int, j: int) -> int:
    """A face that holds both points."""
    shared = faces_with(mesh, np.union1d(held_by(mesh, points, i), held_by(mesh, points, j)))
    assert shared, f"points {i} and {j} share no face"
    return shared[0]


def angle(u: Floats, v: Floats) -> float:
    return float(np.arctan2(np.linalg.norm(np.cross(u, v)), u @ v))


def held_by(mesh: sb.Mesh, points: sb.SurfacePoints, i: int) -> NDArray[np.int32]:
    """The corners of its face that a point lies between, but for rounding."""
    found: NDArray[np.int32] = mesh.triangles[points.faces[i]][points.barycentric[i] > 1e-9]
    return found


def faces_with(mesh: sb.Mesh, vertices: NDArray[np.int32]) -> list[int]:
    return np.flatnonzero(np.isin(mesh.triangles, vertices).sum(axis=1) == len(vertices)).tolist()


def link(mesh: sb.Mesh, held: NDArray[np.int32]) -> list[tuple[int, int, int]]:
    """The sectors about a point, counter-clockwise: a face, and its corners on the right and on the left."""
    about = {face: mesh.triangles[face].tolist() for face in faces_with(mesh, held)}
    if len(held) == 1:
        corners = [(face, *np.roll(t, -t.index(held[0]))[1:].tolist()) for face, t in about.items()]
    else:  # a face has two about a point on its edge, and three about one within it
        corners = [
            (face, t[k], t[(k + 1) % 3])
            for face, t in about.items()
            for k in range(3)
            if {t[k], t[(k + 1) % 3]} != set(held.tolist())
        ]
    first = next((c for c in corners if c[1] not in [other[2] for other in corners]), corners[0])
    ring = [first]
    while len(ring) < len(corners):
        ring.append(next(c for c in corners if c[1] == ring[-1][2] and c not in ring))
    return ring


def sides(mesh: sb.Mesh, points: sb.SurfacePoints, places: Floats, before: int, at: int, after: int) -> list[float]:
    """The angles on the sides of a curve at one of its points that are on the surface."""
    held = held_by(mesh, points, at)
    ring = link(mesh, held)
    sectors = [
        (face, mesh.vertices[right] - places[at], mesh.vertices[left] - places[at]) for face, right, left in ring
    ]
    starts = np.concatenate([[0], np.cumsum([angle(right, left) for _, right, left in sectors])])
    goes_round = ring[0][1] == ring[-1][2]

    def direction(to: int) -> float:
        way = places[to] - places[at]
        shared = faces_with(mesh, np.union1d(held, held_by(mesh, points, to)))
        off = [
            angle(right, way) + angle(way, left) - angle(right, left) if face in shared else np.inf
            for face, right, left in sectors
        ]
        best = int(np.argmin(off))
        assert off[best] <= SLACK, f"the way from point {at} to point {to} is off the surface by {off[best]}"
        return float(starts[best] + angle(sectors[best][1], way))

    turn = abs(direction(before) - direction(after))
    return [turn, starts[-1] - turn] if goes_round else [turn]


def assert_tight(mesh: sb.Mesh, points: sb.SurfacePoints, closed: bool) -> None:
    """Neither side has less than pi, in all places that are apart, but for what the coordinates are rounded by."""
    places = points.positions(mesh)
    lengths = np.linalg.norm(np.diff(places, axis=0, append=places[:1]), axis=1)
    apart = lengths > 1e-6 * longest_edge(mesh)
    rounding = 4 * np.spacing(np.abs(mesh.vertices).max())
    count = len(points)
    for i in range(0 if closed else 1, count if closed else count - 1):
        if not (apart[i - 1] and apart[i]):
            continue
        found = sides(mesh, points, places, (i - 1) % count, i, (i + 1) % count)
        slack = SLACK + rounding / min(lengths[i - 1], lengths[i])
        assert min(found) >= np.pi - slack, f"point {i} of {count}: {found}"


def is_shapely(mesh: sb.Mesh) -> bool:
    return float(mesh.face_areas.min()) > 1e-4 * longest_edge(mesh) ** 2


@guards("shorten_curve", "SurfaceCurve", "GeodesicPath")
def tight_curves(mesh: sb.Mesh, rng: Random) -> None:
    """A curve pulled tight winds as before (closed forms), has pi on both sides everywhere, and is never longer."""
    if not is_shapely(mesh):
        return
    closed = bool(rng.random() < 0.6)
    curve = random_curve(mesh, rng, closed)
    if curve is None:
        return
    tight = sb.shorten_curve(curve)
    assert tight.length <= curve.length * (1 + 1e-12)
    forms = closed_forms(mesh)
    wound = integrals(mesh, forms, curve.points, closed)
    if len(tight.points) == 1:
        assert tight.length == 0
        places = curve.points.positions(mesh)
        assert closed or (places[0] == places[-1]).all()
        np.testing.assert_allclose(wound, 0, atol=1e-9)
        return
    if closed:
        places = np.vstack([tight.points, tight.points[:1]])
        assert abs(np.linalg.norm(np.diff(places, axis=0), axis=1).sum() - tight.length) <= 1e-9 * tight.length
    else:
        ends = curve.points.positions(mesh)[[0, -1]]
        assert_is_way(tight, mesh, ends[0], ends[1])
        if is_convex_and_flat(mesh):
            assert abs(tight.length - np.linalg.norm(ends[1] - ends[0])) <= 1e-9 * longest_edge(mesh)
    np.testing.assert_allclose(integrals(mesh, forms, tight.surface, closed), wound, atol=1e-8)
    assert_tight(mesh, tight.surface, closed)
    assert not (closed and is_convex_and_flat(mesh))


@guards("SaddleVertexGraph.path", "ExactField.distance_to")
def straightened_paths(mesh: sb.Mesh, rng: Random) -> None:
    """By graphs however coarse, between points anywhere: ways over the surface with pi on both sides of every point,
    neither longer than the graph's nor shorter than the exact distance.
    """
    if not is_shapely(mesh):
        return
    rule = random_rule(mesh, rng) if rng.random() < 0.5 else {"k": int(rng.integers(1, 5))}
    graph = sb.SaddleVertexGraph(mesh, threads=1, **rule)
    own = np.flatnonzero(mesh.components[mesh.triangles[:, 0]] == rng.integers(mesh.component_count))
    points = random_points(mesh, rng, 5, own)
    if rng.random() < 0.5:  # from a vertex, which may be one of the boundary
        points = sb.SurfacePoints(points.faces, np.concatenate([np.eye(3)[:1], points.barycentric[1:]]))
    exact = sb.ExactField(mesh, points[0]).distance_to(points)
    places = points.positions(mesh)
    for i in range(1, len(points)):
        path, plain = (graph.path(points[0], points[i], shorten=shorten) for shorten in (True, False))
        assert_is_way(path, mesh, places[0], places[i])
        assert exact[i] * (1 - 1e-9) - 1e-12 * longest_edge(mesh) <= path.length <= plain.length * (1 + 1e-12)
        assert_tight(mesh, path.surface, closed=False)


def halved(polygon: Floats, halvings: int) -> Floats:
    """The control polygons of the pieces of a Bezier curve of the plane, one after the other."""
    if halvings == 0:
        return polygon
    left, right = [polygon[0]], [polygon[-1]]
    while len(polygon) > 1:
        polygon = (polygon[1:] + polygon[:-1]) / 2
        left.append(polygon[0])
        right.append(polygon[-1])
    return np.vstack([halved(np.array(left), halvings - 1), halved(np.array(right[::-1]), halvings - 1)])


def distances_to_line(points: Floats, line: Floats) -> Floats:
    """Of points from a polyline in space."""
    begins, ways = line[:-1], np.diff(line, axis=0)
    squares = np.maximum((ways**2).sum(axis=1), 1e-300)
    shares = np.clip(((points[:, None] - begins) * ways).sum(axis=2) / squares, 0, 1)
    found: Floats = np.linalg.norm(points[:, None] - begins - shares[..., None] * ways, axis=2).min(axis=1)
    return found


@guards("curve_through", "bezier_curve", "SurfaceCurve")
def drawn_curves(mesh: sb.Mesh, rng: Random) -> None:
    """Curves meet their points, are as long as the ways between them, and are those of the plane where that is flat."""
    if not is_shapely(mesh):
        return
    graph = sb.SaddleVertexGraph(mesh, threads=1)
    own = np.flatnonzero(mesh.components[mesh.triangles[:, 0]] == rng.integers(mesh.component_count))
    stops = random_points(mesh, rng, int(rng.integers(3, 6)), own)
    places, closed = stops.positions(mesh), bool(rng.random() < 0.5)
    apart = np.linalg.norm(places - np.roll(places, 1, axis=0), axis=1)
    if apart.min() < 1e-6 * longest_edge(mesh):
        return
    rounding = 1e-15 * float(np.abs(mesh.vertices).max())  # of places
    size = 1e-9 * longest_edge(mesh) + rounding
    order = [*range(len(stops)), *([0] if closed else [])]
    through = sb.curve_through(graph, stops, closed=closed)
    ways = [graph.path(stops[i], stops[j], shorten=True).length for i, j in pairwise(order)]
    assert abs(through.length - sum(ways)) <= 1e-9 * sum(ways)
    halvings = int(rng.integers(0, 5))
    smooth = sb.curve_through(graph, stops, closed=closed, smooth=True, halvings=halvings)
    bezier = sb.bezier_curve(graph, stops, halvings=halvings)
    for curve, met in ((through, places), (smooth, places), (bezier, places[[0, -1]])):
        line = curve.points.positions(mesh)
        line = np.vstack([line, line[:1]]) if closed and curve is not bezier else line
        assert abs(polyline_length(line) - curve.length) <= 1e-9 * curve.length + len(line) * rounding
        assert distances_to_line(met, line).max() <= size
    if is_convex_and_flat(mesh):
        flat, line = halved(places, halvings), bezier.points.positions(mesh)
        assert distances_to_line(flat, line).max() <= 10 * size
        assert distances_to_line(line, flat).max() <= 10 * size


@guards("SaddleVertexGraph.distances", "SaddleVertexGraph", "SurfaceCurve")
def from_curves(mesh: sb.Mesh, rng: Random) -> None:
    """Distances from a curve: graphs within their accuracy of exact distances from points all along it, which are
    longer by less than half the way from one to the next; both as Euclid says on flat convex pieces of the plane.
    """
    if mesh.edge_lengths.min() < 1e-5 * longest_edge(mesh):
        return  # exact distances take long
    curve = random_curve(mesh, rng, closed=bool(rng.random() < 0.4))
    if curve is None:
        return
    rule = random_rule(mesh, rng)
    found = sb.SaddleVertexGraph(mesh, **rule, threads=1).distances(curve)
    rounding = 1e-12 * longest_edge(mesh) + 1e-14 * np.abs(mesh.vertices).max()
    line = curve.points.positions(mesh)
    line = np.vstack([line, line[:1]]) if curve.closed else line
    if is_convex_and_flat(mesh):
        high = low = distances_to_line(mesh.vertices, line)
    else:
        faces, weights, apart = all_along(mesh, curve, 300)
        high = sb.exact_distances(mesh, sb.SurfacePoints(faces, weights))
        low = high - apart / 2
    near = np.isfinite(high)
    assert (np.isfinite(found) == near).all()
    found, low, high = found[near], low[near], high[near]
    under, over = low * (1 - ROUNDING) - rounding - found, found - high * (1 + ROUNDING) - rounding
    assert (under <= 0).all(), f"{under.max()} too short, {rule}"
    assert (over <= high * min(promised(rule), 1e3)).all(), f"{over.max()} too long, {rule}"


def all_along(mesh: sb.Mesh, curve: sb.SurfaceCurve, count: int) -> tuple[NDArray[np.int32], Floats, float]:
    """Points on every piece of a curve, as faces and barycentric coordinates, and how far they are apart at most."""
    points, order = curve.points, [*range(len(curve.points)), *([0] if curve.closed else [])]
    step, apart = curve.length / count, 0.0
    faces, weights = [], []
    for i, j in pairwise(order):
        face = shared_face(mesh, points, i, j)
        begin, end = (weights_in(mesh, points, k, face) for k in (i, j))
        length = float(np.linalg.norm((end - begin) @ mesh.vertices[mesh.triangles[face]]))
        pieces = max(1, int(np.ceil(length / step)))
        apart = max(apart, length / pieces)
        share = np.linspace(0, 1, pieces + 1)[:, None]
        weights.append((1 - share) * begin + share * end)
        faces.append(np.full(pieces + 1, face, np.int32))
    return np.concatenate(faces), np.concatenate(weights), apart

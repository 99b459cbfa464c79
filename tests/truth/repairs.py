# SPDX-License-Identifier: MIT
"""What a repair must do whatever comes in: end in a mesh that it then leaves alone, face outward, close cracks.

And whether triangles pass through each other, in fractions: for `self_crossings`.
"""

from __future__ import annotations

import functools
from fractions import Fraction
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes
from tests.truth.registry import guards

Floats = NDArray[np.float64]
Arrays = tuple[Floats, NDArray[np.int32]]
Random = np.random.Generator
Point = tuple[Fraction, Fraction, Fraction]
STRANGE = np.array([np.nan, np.inf, -np.inf, 0.0, -0.0, 1e300, 1e-300, 1e60, 1e-40, 1.0, -1.0])


def volume(vertices: Floats, triangles: NDArray[np.int32]) -> float:
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def normals(vertices: Floats, triangles: NDArray[np.int32]) -> Floats:
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    return np.asarray(np.cross(b - a, c - a))


def junk(rng: Random) -> Arrays:
    """Indices without sense, in and out of range; coordinates on a small lattice, or strange."""
    count, faces = int(rng.integers(3, 9)), int(rng.integers(1, 12))
    is_strange = rng.random() < 0.2
    vertices = rng.choice(STRANGE, (count, 3)) if is_strange else rng.integers(-2, 3, (count, 3)).astype(np.float64)
    slack = int(rng.random() < 0.2)
    return vertices, rng.integers(-slack, count + slack, (faces, 3)).astype(np.int32)


@guards("repair", "RepairReport", on="nothing")
def junk_is_repaired_for_good(rng: Random) -> None:
    """A second repair finds nothing to mend, and changes no number."""
    mesh, _ = sb.repair(*junk(rng))
    again, report = sb.repair(mesh.vertices, mesh.triangles)
    assert report.changes == {}, str(report)
    assert again.vertices.tobytes() == mesh.vertices.tobytes()
    assert again.triangles.tobytes() == mesh.triangles.tobytes()


def ball(center: Floats, radius: float, rng: Random) -> Arrays:
    vertices, triangles = meshes.icosphere(int(rng.integers(0, 3)), radius)
    return vertices + center, triangles


@guards("repair", on="nothing")
def bodies_face_outward(rng: Random) -> None:
    """Solids, hollow ones, one in a torus's hole, some of them inside out: the volume is what it was meant to be."""
    parts: list[Arrays] = []
    wanted = 0.0
    for i in range(int(rng.integers(1, 4))):
        place = np.array([10.0 * i, 0, 0])
        whole = [ball(place, 2.0, rng)]
        if rng.random() < 0.5:
            inner = ball(place + 0.1, 1.0, rng)
            whole.append((inner[0], inner[1][:, ::-1]))
        if rng.random() < 0.5:  # stands apart in the torus's hole, though its box contains it
            ring = meshes.torus(24, 8, 5.0, 0.5)
            whole = [(ring[0] + place, ring[1]), ball(place, 2.0, rng)]
        arrays = meshes.merge(*whole)
        wanted += volume(*arrays)
        parts.append((arrays[0], arrays[1][:, ::-1]) if rng.random() < 0.5 else arrays)
    vertices, triangles = meshes.merge(*parts)
    order = rng.permutation(len(triangles))
    mesh, _ = sb.repair(vertices, triangles[order])
    found = volume(mesh.vertices, mesh.triangles)
    assert abs(found - wanted) <= 1e-9 * abs(wanted), f"{found} for {wanted}"


@guards("repair", on="nothing")
def open_bodies_face_outward(rng: Random) -> None:
    """Bodies of which a side is missing, all other faces turned at random: they face as they did."""
    make = [lambda: meshes.icosphere(2), lambda: meshes.torus(24, 12, 2.0, 0.8)][int(rng.integers(2))]
    parts: list[Arrays] = []
    for i in range(int(rng.integers(1, 4))):
        vertices, triangles = make()
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        height = vertices[triangles].mean(axis=1) @ turn[0]
        kept = height < np.quantile(height, rng.uniform(0.7, 0.99))
        parts.append((vertices @ (turn * np.sign(np.linalg.det(turn))) + [6.0 * i, 0, 0], triangles[kept]))
    vertices, triangles = meshes.merge(*parts)
    mixed = triangles.copy()
    turned = rng.random(len(mixed)) < rng.random()
    mixed[turned] = mixed[turned, ::-1]
    mesh, report = sb.repair(vertices * 10.0 ** rng.integers(-6, 7), mixed)
    wanted, found = normals(vertices, triangles), normals(mesh.vertices, mesh.triangles[report.face_map])
    body = mesh.components[mesh.triangles[report.face_map, 0]]
    is_crumb = (np.bincount(body) < 20)[body]  # of the ragged border, which shows as much of both sides
    assert (is_crumb | (np.einsum("ij,ij->i", wanted, found) > 0)).all()


def two_halves(rng: Random) -> tuple[Arrays, Arrays]:
    """The unit square in two halves that meet along x = 1/2, divided there in two ways."""
    halves = []
    for side in (0.0, 0.5):
        vertices, triangles = meshes.grid(int(rng.integers(2, 6)), int(rng.integers(2, 9)))
        vertices[:, 0] = side + vertices[:, 0] / 2
        halves.append((vertices, triangles))
    return halves[0], halves[1]


@guards("repair", on="nothing")
def cracks_are_stitched(rng: Random) -> None:
    """T-junctions are told, and gone after stitching; the area stays."""
    first, second = two_halves(rng)
    rows = [len(np.unique(vertices[:, 1])) for vertices, _ in (first, second)]
    vertices, triangles = meshes.merge(first, second)
    angle = rng.uniform(0, 6)
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    vertices = vertices @ turn.T * 10.0 ** rng.integers(-6, 7)
    plain, told = sb.repair(vertices, triangles)
    stitched, report = sb.repair(vertices, triangles, 1e-9 * np.ptp(vertices), stitch=True)
    assert abs(stitched.area - plain.area) <= 1e-9 * plain.area
    assert stitched.component_count == 1
    assert len(stitched.boundary_loops) == 1
    assert report.t_junctions == 0
    inner = [set(np.round(np.linspace(0, 1, n)[1:-1], 12)) for n in rows]
    if inner[0] ^ inner[1]:
        assert told.t_junctions > 0


@guards("repair", on="nothing")
def near_borders_are_told(rng: Random) -> None:
    """A soup whose corners are off by little: welded by the distance that the report tells, it is whole again."""
    vertices, triangles = meshes.torus(int(rng.integers(6, 20)), int(rng.integers(4, 9)))
    corners = vertices[triangles].reshape(-1, 3)
    corners = corners + 10.0 ** rng.uniform(-12, -6) * rng.uniform(-1, 1, corners.shape)
    numbers = np.arange(len(corners), dtype=np.int32).reshape(-1, 3)
    _, told = sb.repair(corners, numbers)
    assert told.joining_distance > 0
    mesh, _ = sb.repair(corners, numbers, told.joining_distance)
    assert mesh.is_closed
    assert (mesh.vertex_count, mesh.genus) == (len(vertices), 1)


def least_area(points: Floats) -> float:
    """Over all triangulations of a loop."""

    @functools.cache
    def least(i: int, j: int) -> float:
        if j - i < 2:
            return 0.0
        sides = (np.linalg.norm(np.cross(points[j] - points[i], points[k] - points[i])) / 2 for k in range(i + 1, j))
        return min(float(a) + least(i, k) + least(k, j) for k, a in zip(range(i + 1, j), sides, strict=True))

    return least(0, len(points) - 1)


@guards("repair", on="nothing")
def holes_are_filled(rng: Random) -> None:
    """A star of faces taken out of a rough sphere is closed again, by no more area than any triangulation's."""
    vertices, triangles = meshes.icosphere(2)
    vertices = vertices * (1 + 0.1 * rng.random((len(vertices), 1)))
    center = int(rng.integers(len(vertices)))
    star = (triangles == center).any(axis=1)
    arrays = meshes.without_unused(vertices, triangles[~star])
    mesh, report = sb.repair(*arrays, fill_holes=12)
    assert report.changes == {"holes_filled": 1}
    assert mesh.is_closed
    assert (mesh.component_count, mesh.genus) == (1, 0)
    (loop,) = sb.Mesh(*arrays).boundary_loops
    added = mesh.area - sb.Mesh(*arrays).area
    assert abs(added - least_area(arrays[0][loop])) <= 1e-9 * mesh.area
    left, report = sb.repair(*arrays, fill_holes=3)
    assert report.changes == {} or report.changes == {"holes_left": 1}
    assert not left.is_closed


def minus(a: Point, b: Point) -> Point:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def side(a: Point, b: Point, c: Point, d: Point) -> int:
    """On which side of the plane (a, b, c) d lies: -1, 0, 1."""
    u, v, w = minus(b, a), minus(c, a), minus(d, a)
    det = u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0])
    return (det > 0) - (det < 0)


def segment_crosses(p: Point, q: Point, triangle: tuple[Point, Point, Point]) -> bool:
    """Whether the open segment passes through the open triangle, from one side of its plane to the other."""
    a, b, c = triangle
    if side(a, b, c, p) * side(a, b, c, q) >= 0:
        return False
    turns = {side(p, q, a, b), side(p, q, b, c), side(p, q, c, a)}
    return turns in ({1}, {-1})


def triangles_cross(s: tuple[Point, Point, Point], t: tuple[Point, Point, Point]) -> bool:
    """Whether an edge of one passes through the inside of the other."""
    return any(segment_crosses(one[i], one[(i + 1) % 3], other) for one, other in ((s, t), (t, s)) for i in range(3))


@guards("self_crossings")
def crossings(mesh: sb.Mesh, rng: Random) -> None:
    """Every pair of triangles of which an edge of one passes through the inside of the other is found."""
    chosen = rng.permutation(mesh.face_count)[:25]
    shift = rng.choice([0.0, 0.3]) * float(np.ptp(mesh.vertices)) * rng.normal(size=3)
    vertices = np.vstack([mesh.vertices, mesh.vertices + shift])
    triangles = np.vstack([mesh.triangles[chosen], mesh.triangles[chosen] + mesh.vertex_count]).astype(np.int32)
    pairs = sb.self_crossings(vertices, triangles)
    found = {tuple(pair) for pair in pairs.tolist()}
    whose = rng.integers(0, 6, len(triangles))
    owned = sb.self_crossings(vertices, triangles, owners=whose)
    assert np.array_equal(owned, pairs[whose[pairs[:, 0]] != whose[pairs[:, 1]]]), "other pairs of different owners"
    corners = [tuple(tuple(map(Fraction, vertices[v].tolist())) for v in face) for face in triangles.tolist()]
    low, high = vertices[triangles].min(axis=1), vertices[triangles].max(axis=1)
    for a, b in combinations(range(len(triangles)), 2):
        if (low[a] > high[b]).any() or (low[b] > high[a]).any():
            assert (a, b) not in found, f"{a} and {b} lie apart"
            continue
        if triangles_cross(corners[a], corners[b]):  # type: ignore[arg-type]
            assert (a, b) in found or len({*triangles[a], *triangles[b]}) < 5, f"{a} and {b} cross"

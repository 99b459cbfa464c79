# SPDX-License-Identifier: MIT
"""Coordinates along curves: closed forms, feet that are as far as said, sides, curves that cross and double back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_progress_and_cancel
from tests.native.exact import random_points

Floats = NDArray[np.float64]


def polar(mesh: sb.Mesh, curve: object, radius: float = np.inf) -> sb.PolarCoordinates:
    return sb.polar_coordinates(sb.SaddleVertexGraph(mesh, k=3), curve, radius)  # type: ignore[arg-type]


@dataclass
class Feet:
    """Nearest points of a polyline of the plane."""

    distance: Floats
    along: Floats
    side: Floats  # 1 left, -1 right, 0 where the foot is a corner
    unique: NDArray[np.bool_]


def feet_in_plane(places: Floats, line: Floats) -> Feet:
    distances, along, sides, start = [], [], [], 0.0
    for a, b in zip(line[:-1, :2], line[1:, :2], strict=True):
        length = float(np.linalg.norm(b - a))
        if length < 1e-13:
            continue
        share = (places[:, :2] - a) @ (b - a) / length**2
        inside = np.clip(share, 0, 1)
        offset = places[:, :2] - (a + inside[:, None] * (b - a))
        distances.append(np.linalg.norm(offset, axis=1))
        along.append(start + inside * length)
        turn = np.sign((b - a)[0] * offset[:, 1] - (b - a)[1] * offset[:, 0])
        sides.append(np.where((share > 1e-9) & (share < 1 - 1e-9), turn, 0))
        start += length
    table = np.array(distances)
    nearest, each = table.argmin(axis=0), np.arange(len(places))
    unique = (table <= table.min(axis=0) * (1 + 1e-9) + 1e-12).sum(axis=0) == 1
    return Feet(table[nearest, each], np.array(along)[nearest, each], np.array(sides)[nearest, each], unique)


def assert_as_in_plane(mesh: sb.Mesh, points: sb.SurfacePoints, closed: bool = False) -> None:
    curve = sb.SurfaceCurve(mesh, points, closed)
    line = points.positions(mesh)
    expected = feet_in_plane(mesh.vertices, np.vstack([line, line[:1]]) if closed else line)
    found = polar(mesh, curve)
    assert len(found) == len(mesh.vertices)
    size = float(np.ptp(mesh.vertices, axis=0).max())
    np.testing.assert_allclose(np.abs(found.distance), expected.distance, rtol=1e-11, atol=1e-13 * size)
    gap = np.abs(found.along - expected.along)
    gap = np.minimum(gap, np.abs(curve.length - gap)) if closed else gap
    assert gap[expected.unique].max(initial=0) <= 1e-9 * size
    sided = expected.unique & (expected.side != 0) & (expected.distance > 1e-9 * size)
    assert np.array_equal(np.sign(found.distance[sided]), expected.side[sided])


def zigzag(mesh: sb.Mesh, rng: np.random.Generator, corners: int, step: float) -> sb.SurfacePoints:
    """Straight pieces, end to end, in any direction: crosses itself at will and runs into the boundary."""
    at = random_points(mesh, 1, int(rng.integers(1 << 30)))
    faces, weights = [at.faces], [at.barycentric]
    for _ in range(corners):
        line = sb.trace(mesh, at, float(rng.uniform(0, 7)), float(rng.exponential(step))).surface
        faces.append(line.faces[1:])
        weights.append(line.barycentric[1:])
        at = line[len(line) - 1 :]
    return sb.SurfacePoints(np.concatenate(faces), np.concatenate(weights))


# --- closed forms -----------------------------------------------------------------------------------------------------

PLANES = {
    "grid": meshes.grid(12, 12),
    "jittered": meshes.grid(12, 12, 0.3, 3),
    "coarse": meshes.grid(4, 4, 0.3),
    "square": meshes.grid(2, 2),
    "needles": meshes.needles(4, 60),
}


@pytest.mark.parametrize("name", PLANES)
@pytest.mark.parametrize("step", [0.02, 0.1, 0.5])
def test_zigzags_of_the_plane(name: str, step: float) -> None:
    mesh, rng = sb.Mesh(*PLANES[name]), np.random.default_rng(0)
    for _ in range(20):
        points = zigzag(mesh, rng, int(rng.integers(1, 20)), step)
        if np.ptp(points.positions(mesh), axis=0).max() > 1e-12:
            assert_as_in_plane(mesh, points)


@pytest.mark.parametrize("name", PLANES)
def test_walks_along_edges_there_and_back(name: str) -> None:
    mesh, rng = sb.Mesh(*PLANES[name]), np.random.default_rng(1)
    for _ in range(20):
        walk = [int(rng.integers(len(mesh.vertices)))]
        for _ in range(int(rng.integers(1, 12))):
            ring = mesh.triangles[(mesh.triangles == walk[-1]).any(axis=1)].ravel()
            walk.append(int(rng.choice(ring[ring != walk[-1]])))
        corners = np.array([np.argwhere(mesh.triangles == vertex)[0] for vertex in walk])
        assert_as_in_plane(mesh, sb.SurfacePoints(corners[:, 0], np.eye(3)[corners[:, 1]]))


@pytest.mark.parametrize("name", PLANES)
@pytest.mark.parametrize("closed", [False, True])
def test_curves_inside_one_face(name: str, closed: bool) -> None:
    """Some points on edges and corners, so that pieces lie on each other and on the rim of the face."""
    mesh, rng = sb.Mesh(*PLANES[name]), np.random.default_rng(2)
    for trial in range(30):
        weights = rng.dirichlet([0.5] * 3, int(rng.integers(3, 8)))
        weights[::3] = np.eye(3)[rng.integers(3)]
        weights[1::4, int(rng.integers(3))] = 0
        weights /= weights.sum(axis=1)[:, None]
        faces = np.full(len(weights), trial % len(mesh.triangles))
        assert_as_in_plane(mesh, sb.SurfacePoints(faces, weights), closed)


def test_many_folded_curves_of_the_plane() -> None:
    mesh = sb.Mesh(*meshes.grid(12, 12, 0.3))
    rng = np.random.default_rng(5)
    for _ in range(150):
        assert_as_in_plane(mesh, zigzag(mesh, rng, int(rng.integers(10, 25)), 0.1))


def test_a_helix_of_a_cylinder() -> None:
    """Unrolled, both are straight; the strip is cut where the way round the back becomes shorter."""
    around, along = 24, 41
    mesh = sb.Mesh(*meshes.cylinder(around, along, 1.0, 8.0))
    side = 2 * np.sin(np.pi / around)
    start = sb.project(mesh, [[1.0, 0.02, 2.0]])
    line = sb.trace(mesh, start, [0.0, 1.0, 0.5], 2.0)
    found = polar(mesh, line)
    facet = np.arange(len(mesh.vertices)) % around
    best: list[Feet] = []
    rise = float(line.points[-1][2] - line.points[0][2])
    step = np.array([np.sqrt(line.length**2 - rise**2), rise])
    flat_start = np.array([first_on_facet(mesh, start) * side, start.positions(mesh)[0][2]])
    for turns in (-1, 0, 1):
        flat = np.column_stack([(facet + turns * around) * side, mesh.vertices[:, 2]])
        best.append(feet_in_plane(flat, np.array([flat_start, flat_start + step])))
    lengths = np.array([feet.distance for feet in best])
    which, each = lengths.argmin(axis=0), np.arange(len(facet))
    np.testing.assert_allclose(np.abs(found.distance), lengths.min(axis=0), rtol=1e-11, atol=1e-12)
    unique = (lengths <= lengths.min(axis=0) * (1 + 1e-9)).sum(axis=0) == 1
    feet = np.array([f.along for f in best])[which, each]
    np.testing.assert_allclose(found.along[unique], feet[unique], atol=1e-11)
    sides = np.array([f.side for f in best])[which, each]
    sided = unique & (sides != 0)
    assert np.array_equal(np.sign(found.distance[sided]), sides[sided])


def first_on_facet(mesh: sb.Mesh, point: sb.SurfacePoints) -> float:
    """Where a point is round a prism of 24 sides, counted in sides."""
    columns = mesh.triangles[point.faces[0]] % 24
    return float((point.barycentric[0] * columns).sum())


@pytest.mark.parametrize("ring", [1, 4, 8])
def test_a_ring_of_a_cone(ring: int) -> None:
    """A closed curve through vertices: its bends face the rim, behind the other side lies the apex."""
    around, rings = 24, 8
    mesh = sb.Mesh(*meshes.cone(around, rings))
    loop = 1 + (ring - 1) * around + np.arange(around)
    curve = sb.SurfaceCurve(mesh, loop, closed=True)
    found = polar(mesh, curve)
    slant = np.linalg.norm(mesh.vertices - mesh.vertices[0], axis=1)
    corner = mesh.total_angles[0] / around
    height, side = slant[loop[0]] * np.cos(corner / 2), 2 * slant[loop[0]] * np.sin(corner / 2)
    # In the sector of one side: a chord at `height` from the apex, its ends at slant[loop].
    expected = np.where(slant < slant[loop[0]], height - slant * np.cos(corner / 2), slant - slant[loop[0]])
    expected[0] = height
    level = np.isclose(slant, slant[loop[0]], rtol=1e-9)
    np.testing.assert_allclose(np.abs(found.distance[~level]), expected[~level], rtol=1e-11)
    assert (found.distance[level] == 0).all()
    outside = found.distance[slant > slant[loop[0]] * (1 + 1e-9)]
    inside = found.distance[slant < slant[loop[0]] * (1 - 1e-9)]
    assert (np.sign(outside) == -np.sign(inside[0])).all() and (np.sign(inside) == np.sign(inside[0])).all()
    np.testing.assert_allclose(found.along[loop], side * np.arange(around), atol=1e-12)
    below = slice(1 + ring * around, None)  # straight down the slant from a vertex of the ring
    np.testing.assert_allclose(
        found.along[below], np.tile(side * np.arange(around), rings - ring), atol=1e-9 * curve.length
    )


def test_the_equator_of_a_sphere() -> None:
    """Latitude and longitude of the smooth sphere, up to the polyhedron's own error."""
    errors = []
    for level in (3, 4, 5):
        mesh = sb.Mesh(*meshes.icosphere(level))
        start = sb.project(mesh, [[1.0, 0.0, 1e-3]])
        circle = sb.trace(mesh, start, [0.0, 1.0, 0.0], 5.0)
        x = start.positions(mesh)[0] / np.linalg.norm(start.positions(mesh)[0])
        found = polar(mesh, circle, 0.5)
        pole = np.cross(x, [0.0, 1.0, 0.0])
        there = mesh.vertices[found.vertices]
        latitude = np.arcsin(there @ pole)
        longitude = np.arctan2(there @ [0, 1, 0], there @ x) % (2 * np.pi)
        beside = (longitude > 0.3) & (longitude < 4.5)
        errors.append(
            max(
                np.abs(found.distance - latitude)[beside].max(),
                (np.cos(latitude) * np.abs(found.along - longitude))[beside].max(),
            )
        )
    assert errors[0] > 1.4 * errors[1] > 1.4**2 * errors[2]
    assert errors[2] < 0.05


# --- any surface ------------------------------------------------------------------------------------------------------


def along_curve(mesh: sb.Mesh, curve: sb.SurfaceCurve, where: Floats) -> sb.SurfacePoints:
    line = curve.points.positions(mesh)
    line = np.vstack([line, line[:1]]) if curve.closed else line
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    starts = np.concatenate([[0.0], np.cumsum(steps)])
    i = np.clip(np.searchsorted(starts, where, side="right") - 1, 0, len(steps) - 1)
    share = np.where(steps[i] > 0, (where - starts[i]) / np.maximum(steps[i], 1e-300), 0.0)[:, None]
    return sb.project(mesh, line[i] * (1 - share) + line[i + 1] * share)


def curves_on(mesh: sb.Mesh) -> list[sb.SurfaceCurve]:
    rng = np.random.default_rng(4)
    size = np.sqrt(mesh.area)
    result = [
        sb.SurfaceCurve(mesh, zigzag(mesh, rng, corners, share * size)) for corners, share in ((1, 0.6), (9, 0.1))
    ]
    result.append(sb.SurfaceCurve(mesh, mesh.triangles[len(mesh.triangles) // 2], closed=True))
    graph = sb.SaddleVertexGraph(mesh, k=min(12, len(mesh.vertices)))
    here = np.flatnonzero(mesh.components == 0)
    result.append(sb.SurfaceCurve(mesh, graph.path(int(here[0]), int(here[len(here) // 2])).surface))
    result += [sb.SurfaceCurve(mesh, loop, closed=True) for loop in mesh.boundary_loops[:2]]
    return result


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_feet_are_as_far_as_said_and_nothing_is_nearer(case: meshes.Case) -> None:
    mesh, rng = case.mesh, np.random.default_rng(6)
    for curve in curves_on(mesh):
        found = polar(mesh, curve)
        component = mesh.components[mesh.triangles[curve.points.faces[0], 0]]
        assert np.array_equal(found.vertices, np.flatnonzero(mesh.components == component))
        distance = np.abs(found.distance)
        assert found.along.min() >= 0 and found.along.max() <= curve.length
        samples = along_curve(mesh, curve, np.linspace(0, curve.length, 120))
        sampled = sb.exact_distances(mesh, samples)[found.vertices]
        assert (distance <= sampled * (1 + 1e-9) + 1e-12).all()
        assert (sampled <= distance + curve.length / 119 / 2 + 1e-9).all()
        for i in rng.integers(len(found), size=4):
            foot = along_curve(mesh, curve, found.along[i : i + 1])
            assert sb.exact_distances(mesh, foot)[found.vertices[i]] == pytest.approx(distance[i], rel=1e-8, abs=1e-9)


@pytest.mark.parametrize("case", meshes.boundary(), ids=str)
def test_the_surface_lies_left_of_its_boundary(case: meshes.Case) -> None:
    for loop in case.mesh.boundary_loops:
        found = polar(case.mesh, sb.SurfaceCurve(case.mesh, loop, closed=True))
        assert (found.distance >= 0).all()
        assert np.array_equal(np.flatnonzero(found.distance == 0), np.sort(loop))
        assert found.along[np.searchsorted(found.vertices, loop[0])] == 0


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_run_backwards_sides_swap(case: meshes.Case) -> None:
    mesh, rng = case.mesh, np.random.default_rng(8)
    points = zigzag(mesh, rng, 1, 0.4 * np.sqrt(mesh.area))
    back = sb.SurfacePoints(points.faces[::-1], points.barycentric[::-1])
    length = sb.SurfaceCurve(mesh, points).length
    one, other = polar(mesh, points), polar(mesh, back)
    np.testing.assert_allclose(np.abs(one.distance), np.abs(other.distance), rtol=1e-11, atol=1e-13)
    same_foot = np.abs(one.along - (length - other.along)) < 1e-9
    inner = same_foot & (one.along > 1e-9) & (one.along < length - 1e-9) & (np.abs(one.distance) > 1e-9)
    assert same_foot.mean() > 0.5
    assert np.array_equal(np.sign(one.distance[inner]), -np.sign(other.distance[inner]))


def test_behind_saddles_the_foot_is_that_of_the_way_by_them() -> None:
    mesh = sb.Mesh(*meshes.holes(25))
    line = sb.trace(mesh, sb.project(mesh, [[0.02, 0.1, 0]]), [1.0, 0.0, 0.0], 0.9)
    found = polar(mesh, line)
    assert 0 < found.shadowed.sum() < len(found)
    inside = ~found.shadowed & (found.along > 1e-9) & (found.along < line.length - 1e-9)
    np.testing.assert_allclose(found.along[inside], mesh.vertices[found.vertices[inside], 0] - 0.02, atol=1e-12)
    np.testing.assert_allclose(found.distance[inside], mesh.vertices[found.vertices[inside], 1] - 0.1, atol=1e-12)


@pytest.mark.parametrize("radius", [1e-6, 0.1, 0.37])
def test_radius_leaves_what_is_farther(radius: float) -> None:
    mesh = sb.Mesh(*meshes.torus())
    line = sb.trace(mesh, 5, 0.3, 1.5)
    whole, part = polar(mesh, line), polar(mesh, line, radius)
    near = np.abs(whole.distance) <= radius
    assert np.array_equal(part.vertices, whole.vertices[near])
    np.testing.assert_allclose(part.distance, whole.distance[near], rtol=1e-13)
    np.testing.assert_allclose(part.along, whole.along[near], rtol=1e-12, atol=1e-14)


def test_a_path_a_curve_and_its_points_are_the_same() -> None:
    mesh = sb.Mesh(*meshes.double_torus())
    graph = sb.SaddleVertexGraph(mesh, k=20)
    path = graph.path(3, 200)
    results = [sb.polar_coordinates(graph, c, 1.0) for c in (path, path.surface, sb.SurfaceCurve(mesh, path.surface))]
    for other in results[1:]:
        assert other.distance.tobytes() == results[0].distance.tobytes()
        assert other.along.tobytes() == results[0].along.tobytes()
    ring = sb.polar_coordinates(graph, mesh.triangles[0], 1.0)
    assert len(ring) > 3


# --- the call ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("curve", "radius", "sentence"),
    [
        ([0, 1], 0.0, "radius: wanted a distance above 0, got 0"),
        ([0, 1], -2.0, "radius: wanted a distance above 0, got -2"),
        ([0, 1], float("nan"), "radius: wanted a distance above 0, got nan"),
        ([0, 1], None, "radius"),
        ([3], 1.0, "curve: wanted at least two points, got 1"),
        ([3, 3], 1.0, "curve: all are the same point"),
        ([0, 1, 140], 1.0, r"curve: points 1 \(face \d+\) and 2 \(face \d+\) share no face"),
        ([0, 144], 1.0, r"curve: vertex 144 at \[1\] is out of range"),
        ([[0.0, 0.0, 0.0]], 1.0, "curve: wanted vertex indices or a SurfacePoints"),
        (None, 1.0, "curve"),
    ],
)
def test_bad_input_is_named(curve: object, radius: object, sentence: str) -> None:
    mesh = sb.Mesh(*meshes.grid())
    with pytest.raises(sb.InputError, match=sentence):
        sb.polar_coordinates(sb.SaddleVertexGraph(mesh, k=3), curve, radius)  # type: ignore[arg-type]


def test_a_curve_of_another_mesh_is_refused() -> None:
    mesh, other = sb.Mesh(*meshes.grid()), sb.Mesh(*meshes.torus())
    with pytest.raises(sb.InputError, match="curve: it lies on another mesh"):
        polar(mesh, sb.SurfaceCurve(other, other.triangles[0]))
    with pytest.raises(sb.InputError, match="graph: wanted a SaddleVertexGraph"):
        sb.polar_coordinates(mesh, [0, 1], 1.0)  # type: ignore[arg-type]


def test_progress_rises_and_cancel_is_quick() -> None:
    mesh = sb.Mesh(*meshes.icosphere(6))
    graph = sb.SaddleVertexGraph(mesh, k=3)
    line = sb.trace(mesh, 7, 0.3, 1.0)
    check_progress_and_cancel(lambda job: sb.polar_coordinates(graph, line, np.inf, job=job), 0.3)

# SPDX-License-Identifier: MIT
"""Straightest geodesics against closed forms: plane, cylinder, sphere, cube; reversal; degenerate starts; an end."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import ArrayLike, NDArray

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_progress_and_cancel

Floats = NDArray[np.float64]


def in_face(face: int, weights: ArrayLike) -> sb.SurfacePoints:
    return sb.SurfacePoints([face], np.array([weights]))


def chart_angle(mesh: sb.Mesh, face: int, direction: Floats) -> float:
    """Angle of a direction of the face's plane in the face's chart."""
    a, b, c = mesh.vertices[mesh.triangles[face]]
    x = (b - a) / np.linalg.norm(b - a)
    normal = np.cross(b - a, c - a)
    return math.atan2(direction @ np.cross(normal / np.linalg.norm(normal), x), direction @ x)


def assert_is_curve_on(mesh: sb.Mesh, path: sb.TracedPath) -> None:
    """Points lie where the surface points say, consecutive ones share a face, and their distances add up."""
    assert np.abs(path.surface.positions(mesh) - path.points).max() <= 1e-14 * (1 + np.abs(mesh.vertices).max())
    assert (path.surface.barycentric >= 0).all()
    assert np.allclose(path.surface.barycentric.sum(axis=1), 1, rtol=0, atol=1e-15)
    steps = np.linalg.norm(np.diff(path.points, axis=0), axis=1)
    assert steps.sum() == pytest.approx(path.length, rel=1e-10, abs=1e-12)
    vertex_faces = [set[int]() for _ in mesh.vertices]
    for face, triangle in enumerate(mesh.triangles):
        for vertex in triangle:
            vertex_faces[vertex].add(face)
    faces_of = []
    for face, weights in zip(path.surface.faces, path.surface.barycentric, strict=True):
        corners = mesh.triangles[face][weights > 0]
        faces_of.append(set.intersection(*(vertex_faces[v] for v in corners)))
    assert all(here & following for here, following in itertools.pairwise(faces_of))


weights_strategy = st.sampled_from(
    [
        (1, 0, 0),
        (0, 1, 0),
        (0.5, 0.5, 0),
        (0, 0.25, 0.75),
        (1 / 3, 1 / 3, 1 / 3),
        (0.7, 0.2, 0.1),
        (1e-15, 1 - 1e-15, 0),
    ]
)
angle_strategy = st.one_of(st.sampled_from([i * math.pi / 4 for i in range(-8, 9)]), st.floats(-7, 7))


@given(
    jitter=st.sampled_from([0.0, 0.3]),
    face=st.integers(0, 241),
    weights=weights_strategy,
    angle=angle_strategy,
    length=st.floats(0, 2),
)
def test_lines_of_the_plane_are_straight(
    jitter: float, face: int, weights: tuple[float, float, float], angle: float, length: float
) -> None:
    mesh = sb.Mesh(*meshes.grid(jitter=jitter))
    start = in_face(face, weights)
    direction = np.array([math.cos(angle), math.sin(angle), 0.0])
    path = sb.trace(mesh, start, direction, length)
    origin = start.positions(mesh)[0]
    assert np.abs(path.points[-1] - (origin + path.length * direction)).max() < 1e-11
    assert np.abs(np.array(path.end_direction) - direction).max() < 1e-11
    assert_is_curve_on(mesh, path)
    if path.hit_boundary:
        end = path.points[-1][:2]
        assert min(end.min(), 1 - end.max()) < 1e-12
    else:
        assert path.length == length


@pytest.mark.parametrize("direction", [(1, 0, 0), (0, -1, 0), (1, 1, 0), (-1, -1, 0)])
def test_along_edges_and_diagonals_the_vertices_are_met_exactly(direction: tuple[int, int, int]) -> None:
    mesh = sb.Mesh(*meshes.grid(13, 13))
    path = sb.trace(mesh, 6 * 13 + 6, direction, 10.0)
    assert len(path.points) == 7
    assert path.hit_boundary
    assert (path.surface.barycentric.max(axis=1) == 1).all()


def test_a_vertex_reached_with_the_last_of_the_length_ends_the_curve_exactly_there() -> None:
    mesh = sb.Mesh(*meshes.grid(11, 11))
    path = sb.trace(mesh, 5 * 11 + 5, [1.0, 1.0, 0.0], 0.2 * math.sqrt(2))
    assert path.surface.barycentric[-1].max() == 1
    assert np.abs(path.points[-1] - mesh.vertices[7 * 11 + 7]).max() < 1e-15
    assert not path.hit_boundary


def test_angles_about_a_vertex_run_counter_clockwise() -> None:
    mesh = sb.Mesh(*meshes.grid(3, 3))
    ends = [sb.trace(mesh, 4, angle, 0.25).points[-1] for angle in np.linspace(0, 2 * np.pi, 9)]
    offsets = np.array(ends) - mesh.vertices[4]
    assert np.allclose(np.linalg.norm(offsets, axis=1), 0.25, atol=1e-15)
    angles = np.unwrap(np.arctan2(offsets[:, 1], offsets[:, 0]))
    assert np.allclose(np.diff(angles), np.pi / 4, atol=1e-14)


@pytest.mark.parametrize("slope", [0.0, 0.3, 1.0, -2.5])
def test_lines_of_a_cylinder_are_helices(slope: float) -> None:
    """Unrolled, a prism is a plane: a line of it advances as in the plane, so that the height grows linearly."""
    around, radius = 24, 1.0
    mesh = sb.Mesh(*meshes.cylinder(around, 9, radius, 2.0))
    side = 2 * radius * math.sin(math.pi / around)
    middle = int(np.argmin(np.abs(mesh.vertices[mesh.triangles].mean(axis=1)[:, 2] - mesh.vertices[:, 2].mean())))
    start = in_face(middle, (0.4, 0.35, 0.25))
    origin = start.positions(mesh)[0]
    corners = mesh.vertices[mesh.triangles[middle]]
    outward = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    eastward = np.cross([0.0, 0.0, 1.0], outward)
    direction = eastward / np.linalg.norm(eastward) + [0, 0, slope]
    length = 0.7 / max(abs(slope), 0.2)
    path = sb.trace(mesh, start, direction, length)
    assert not path.hit_boundary
    unit = direction / np.linalg.norm(direction)
    assert path.points[-1][2] - origin[2] == pytest.approx(length * unit[2], abs=1e-13)
    # Crossings of the 24 upright edges are one side apart.
    on_upright = np.isclose(np.linalg.norm(path.points[:, :2], axis=1), radius, atol=1e-12)
    heights = np.unique(path.points[on_upright][:, 2].round(12)) if slope else None
    if heights is not None and len(heights) > 1:
        assert np.allclose(np.diff(heights), side * abs(slope), atol=1e-11)


def test_great_circles_of_a_sphere_converge_with_refinement() -> None:
    errors = []
    for level in (2, 3, 4, 5):
        mesh = sb.Mesh(*meshes.icosphere(level))
        rng = np.random.default_rng(4)
        worst = 0.0
        for _ in range(30):
            start = sb.project(mesh, rng.normal(size=(1, 3)))
            x = start.positions(mesh)[0]
            tangent = np.cross(x, rng.normal(size=3))
            tangent /= np.linalg.norm(tangent)
            path = sb.trace(mesh, start, tangent, 1.0)
            unit = x / np.linalg.norm(x)
            circle = math.cos(1.0) * unit + math.sin(1.0) * tangent
            worst = max(worst, float(np.linalg.norm(path.points[-1] - circle)))
        errors.append(worst)
    assert errors[-1] < 0.01
    assert all(finer < 0.75 * coarser for coarser, finer in itertools.pairwise(errors))


def test_a_line_round_the_cube_unfolds_to_its_start() -> None:
    """Parallel to an edge, a line meets four squares and closes after four sides, whatever the triangles' diagonals."""
    mesh = sb.Mesh(*meshes.cube())
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    side = float((high - low)[0])
    for height in (0.1, 0.37, 0.5, 0.93):
        point = low + side * np.array([0.3, 0.0, height])
        start = sb.project(mesh, [point])
        path = sb.trace(mesh, start, [1.0, 0.0, 0.0], 4 * side)
        assert np.abs(path.points[-1] - point).max() < 1e-13
        assert np.abs(np.array(path.end_direction) - [1, 0, 0]).max() < 1e-13
        assert np.ptp(path.points[:, 2]) < 1e-13


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_traced_forward_and_back_a_curve_returns_to_its_start(case: meshes.Case) -> None:
    mesh = case.mesh
    rng = np.random.default_rng(1)
    size = float(np.ptp(mesh.vertices, axis=0).max())
    for i, start in enumerate(sb.sample(mesh, 60, seed=2)):
        angle = float(rng.uniform(0, 7))
        path = sb.trace(mesh, start, angle, float(rng.uniform(0, size)))
        if path.length == 0:
            continue
        assert_is_curve_on(mesh, path)
        end = path.surface[len(path.surface) - 1]
        at_vertex = end.barycentric.max() == 1
        back_direction = -np.array(path.end_direction) if at_vertex or i % 2 else path.end_angle + math.pi
        back = sb.trace(mesh, end, back_direction, path.length)
        assert np.abs(back.points[-1] - path.points[0]).max() < 1e-11 * size


@pytest.mark.parametrize("case", meshes.closed(), ids=str)
def test_through_a_vertex_half_of_the_total_angle_lies_on_either_side(case: meshes.Case) -> None:
    mesh = case.mesh
    corners = mesh.vertices[mesh.triangles]
    for vertex in range(min(len(mesh.vertices), 30)):
        total = 0.0
        for i in range(3):
            for a, b, c in corners[mesh.triangles[:, i] == vertex][:, [i, (i + 1) % 3, (i + 2) % 3]]:
                u, w = b - a, c - a
                total += math.atan2(float(np.linalg.norm(np.cross(u, w))), float(u @ w))
        reach = 0.05 * float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).min())
        for angle in (0.0, 0.4, 0.5 * total, 0.9 * total):
            towards = sb.trace(mesh, vertex, angle, reach)
            end = towards.surface[len(towards.surface) - 1]
            through = sb.trace(mesh, end, -np.array(towards.end_direction), 2 * reach)
            opposite = sb.trace(mesh, vertex, angle + total / 2, reach)
            assert np.abs(through.points[-1] - opposite.points[-1]).max() < 1e-9 * reach


def test_a_curve_over_a_hundred_thousand_faces_stays_straight() -> None:
    """On the thin prism each turn crosses all sides; unrolled it is one straight line."""
    mesh = sb.Mesh(*meshes.cylinder(24, 9, 0.001, 20.0))
    start = sb.project(mesh, [[0.001, 0.0, 0.01 + mesh.vertices[:, 2].min()]])
    direction = np.array([0.0, 1.0, 0.5])
    path = sb.trace(mesh, start, direction, 20.0)
    assert len(path.points) > 50_000
    rise = path.points[-1][2] - path.points[0][2]
    flat = start.positions(mesh)[0]
    assert flat[2] == pytest.approx(path.points[0][2])
    slopes = np.diff(path.points[:, 2]) / np.linalg.norm(np.diff(path.points, axis=0), axis=1).clip(1e-300)
    used = np.linalg.norm(np.diff(path.points, axis=0), axis=1) > 1e-6
    assert np.ptp(slopes[used]) < 1e-7
    assert rise == pytest.approx(np.median(slopes[used]) * path.length, rel=1e-9)


def test_needles_are_crossed_in_a_straight_line() -> None:
    mesh = sb.Mesh(*meshes.needles())
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    start = sb.project(mesh, [low + (high - low) * [0.013, 0.02, 0]])
    direction = (high - low) * [0.97, 0.95, 0]
    path = sb.trace(mesh, start, direction, float(np.linalg.norm(direction)))
    assert not path.hit_boundary
    assert np.abs(path.points[-1] - path.points[0] - direction).max() < 1e-11 * np.abs(direction).max()


def test_no_length_gives_the_start() -> None:
    mesh = sb.Mesh(*meshes.icosphere(2))
    for start in (3, in_face(5, (0.2, 0.3, 0.5))):
        path = sb.trace(mesh, start, 1.25, 0)
        assert len(path.points) == len(path.surface) == 1
        assert path.length == 0
        assert not path.hit_boundary
    assert sb.trace(mesh, in_face(5, (0.2, 0.3, 0.5)), 1.25, 0.0).end_angle == 1.25


def test_off_the_rim_a_curve_stops_where_it_stands() -> None:
    mesh = sb.Mesh(*meshes.grid(5, 5))
    for start in (2, sb.project(mesh, [[0.6, 0.0, 0.0]])):
        path = sb.trace(mesh, start, [0.3, -1.0, 0.0], 0.5)
        assert path.hit_boundary
        assert path.length == pytest.approx(0, abs=1e-15)


def test_a_length_without_end_stops_at_the_rim_or_with_a_sentence() -> None:
    path = sb.trace(sb.Mesh(*meshes.grid()), 40, 0.3, 1e300)
    assert path.hit_boundary
    assert path.length < 2
    with pytest.raises(sb.InputError, match=r"length 1e\+300 is too long to follow: after \d+ faces"):
        sb.trace(sb.Mesh(*meshes.tetrahedron()), 0, 0.3, 1e300)


@given(
    which=st.integers(0, len(meshes.good()) - 1),
    face=st.integers(0, 10_000),
    weights=weights_strategy,
    angle=st.floats(allow_nan=False, allow_infinity=False),
    length=st.one_of(st.floats(0, 3), st.sampled_from([5e-324, 1e-300, 1e-15])),
)
def test_every_finite_input_ends(
    which: int, face: int, weights: tuple[float, float, float], angle: float, length: float
) -> None:
    mesh = meshes.good()[which].mesh
    path = sb.trace(mesh, in_face(face % len(mesh.triangles), weights), angle, length)
    assert np.isfinite(path.points).all()
    assert path.length == length or (path.hit_boundary and path.length < length)


@pytest.mark.parametrize(
    ("point", "direction", "length", "sentence"),
    [
        (0, math.nan, 1, "direction is nan"),
        (0, math.inf, 1, "direction is inf"),
        (0, [0.0, 0.0, 0.0], 1, r"direction is \(0, 0, 0\), but must be finite and not zero"),
        (40, [0.0, 0.0, 1.0], 1, r"direction \(0, 0, 1\) has no part along the surface"),
        (0, [1.0, 0.0], 1, r"direction: wanted shape \(3,\)"),
        (0, "east", 1, "direction"),
        (0, 0.0, -1, "length is -1"),
        (0, 0.0, math.nan, "length is nan"),
        (0, 0.0, math.inf, "length is inf"),
        (-1, 0.0, 1, r"point: vertex -1 at \[0\] is out of range"),
        (144, 0.0, 1, "the mesh has 144 vertices"),
        ([0, 1], 0.0, 1, "point: wanted one point, got 2"),
        ([0.5], 0.0, 1, "point: wanted vertex indices or a SurfacePoints"),
        (None, 0.0, 1, "point"),
    ],
)
def test_bad_input_is_named(point: object, direction: object, length: object, sentence: str) -> None:
    mesh = sb.Mesh(*meshes.grid())
    with pytest.raises(sb.InputError, match=sentence):
        sb.trace(mesh, point, direction, length)  # type: ignore[arg-type]


def test_progress_is_the_share_of_the_length_and_cancel_is_quick() -> None:
    mesh, job = sb.Mesh(*meshes.torus()), sb.Job()
    watched = sb.trace(mesh, 0, 0.3, 50.0, job=job)
    assert job.fraction == 1
    assert np.array_equal(watched.points, sb.trace(mesh, 0, 0.3, 50.0).points)
    check_progress_and_cancel(lambda job: sb.trace(mesh, 0, 0.3, 1e5, job=job), 0.05)


def test_what_is_no_mesh_is_named() -> None:
    with pytest.raises(sb.InputError, match="mesh: wanted a Mesh, got a str"):
        sb.trace("mesh", 0, 0.0, 1.0)  # type: ignore[arg-type]

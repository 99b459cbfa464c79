# SPDX-License-Identifier: MIT
"""Log map and exponential map: closed forms, each the other's inverse, marks of what has no straight way."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_progress_and_cancel
from tests.native.exact import with_vertex_at

Floats = NDArray[np.float64]
GENTLE = [c for c in meshes.good() if c.name in ("icosphere", "torus", "double_torus", "saddle", "grid_jittered")]


def graph_of(mesh: sb.Mesh) -> sb.SaddleVertexGraph:
    return sb.SaddleVertexGraph(mesh, k=3)


def points_of(mesh: sb.Mesh) -> list[int | sb.SurfacePoints]:
    """A vertex, and a point inside a face and on an edge."""
    face = len(mesh.triangles) // 2
    return [
        len(mesh.vertices) // 2,
        sb.SurfacePoints([face], [[0.2, 0.3, 0.5]]),
        sb.SurfacePoints([face], [[0.4, 0.0, 0.6]]),
    ]


def position_of(mesh: sb.Mesh, point: int | sb.SurfacePoints) -> Floats:
    return mesh.vertices[point] if isinstance(point, int) else point.positions(mesh)[0]


def turned(uv: Floats, angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return uv @ np.array([[c, s], [-s, c]])


def assert_same_up_to_a_turn(found: Floats, expected: Floats, tolerance: float) -> None:
    """The chart's x axis is the mesh's own: the maps agree but for one rotation."""
    product = (found[:, 0] + 1j * found[:, 1]) @ np.conj(expected[:, 0] + 1j * expected[:, 1])
    assert np.abs(found - turned(expected, float(np.angle(product)))).max() <= tolerance


# --- closed forms -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "arrays", [meshes.grid(30, 30), meshes.grid(30, 30, 0.3), meshes.needles(), meshes.graded_disk()]
)
def test_of_the_plane_is_the_plane(arrays: meshes.Arrays) -> None:
    mesh = sb.Mesh(*arrays)
    for center in points_of(mesh):
        found = graph_of(mesh).log_map(center, np.inf)
        assert len(found) == len(mesh.vertices)
        plane = (mesh.vertices - position_of(mesh, center))[:, :2]
        assert_same_up_to_a_turn(found.uv, plane, 1e-11 * np.abs(plane).max())
        assert not found.shadowed[np.isin(found.vertices, np.setdiff1d(found.vertices, mesh.boundary_loops[0]))].any()


@pytest.mark.parametrize("source", [4 * 24 + 3, 30 * 24 + 7])
def test_of_a_cylinder_unrolls_it(source: int) -> None:
    around, along = 24, 61
    mesh = sb.Mesh(*meshes.cylinder(around, along, 1.0, 4.0))
    side = 2 * np.sin(np.pi / around)
    found = graph_of(mesh).log_map(source, np.inf)
    step = (np.arange(len(mesh.vertices)) - source) % around
    seam = step == around // 2  # either way round is as short
    step = np.where(step > around // 2, step - around, step)
    flat = np.column_stack([step * side, mesh.vertices[:, 2] - mesh.vertices[source, 2]])
    assert_same_up_to_a_turn(found.uv[~seam], flat[~seam], 1e-12)
    np.testing.assert_allclose(found.distance, np.linalg.norm(flat, axis=1), rtol=1e-12, atol=1e-15)


def test_of_a_cone_about_its_apex_scales_angles() -> None:
    """The apex has less than 2 pi about it: its directions are spread over the whole circle."""
    around, along = 24, 8
    mesh = sb.Mesh(*meshes.cone(around, along))
    found = graph_of(mesh).log_map(0, np.inf)
    slant = np.linalg.norm(mesh.vertices - mesh.vertices[0], axis=1)
    turn = -2 * np.pi * ((np.arange(len(mesh.vertices)) - 1) % around) / around  # rings go round clockwise from above
    flat = slant[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    mirrored = flat * (1, -1)
    expected = flat if np.abs(found.uv - turned(flat, angle_between(found.uv, flat))).max() < 1e-9 else mirrored
    assert_same_up_to_a_turn(found.uv, expected, 1e-13)
    assert found.angle.max() < mesh.total_angles[0]


def angle_between(found: Floats, expected: Floats) -> float:
    return float(np.angle((found[:, 0] + 1j * found[:, 1]) @ np.conj(expected[:, 0] + 1j * expected[:, 1])))


def test_of_a_cone_off_its_apex_unrolls_it_to_the_seam() -> None:
    around, along = 24, 8
    mesh = sb.Mesh(*meshes.cone(around, along))
    source = 1 + 3 * around
    slant = np.linalg.norm(mesh.vertices - mesh.vertices[0], axis=1)
    step = (np.arange(len(mesh.vertices)) - source) % around
    seam = (step == around // 2) | (slant == 0)
    turn = np.where(step > around // 2, step - around, step) * mesh.total_angles[0] / around
    flat = slant[:, None] * np.column_stack([np.cos(turn), np.sin(turn)]) - (slant[source], 0)
    keep = ~seam & (np.abs(turn) < np.pi)
    found = graph_of(mesh).log_map(source, np.inf)
    straight = keep & ~found.shadowed
    expected = flat[straight] if is_counter_clockwise(mesh, source) else flat[straight] * (1, -1)
    assert straight.sum() > 100
    assert_same_up_to_a_turn(found.uv[straight], expected, 1e-12)


def is_counter_clockwise(mesh: sb.Mesh, source: int) -> bool:
    """Whether the next vertex of the ring lies left of the way to the apex's far side, seen from outside."""
    outward = mesh.vertices[source] * (1, 1, 0)
    east = mesh.vertices[source + 1] - mesh.vertices[source]
    down = mesh.vertices[source] - mesh.vertices[0]
    return bool(np.cross(down, east) @ outward > 0)


def test_of_a_sphere_converges_to_great_circles() -> None:
    """A polyhedron's geodesics are those of the smooth sphere up to its own error."""
    errors = []
    for level in (3, 4, 5):
        mesh = sb.Mesh(*meshes.icosphere(level))
        found = graph_of(mesh).log_map(0, 1.0)
        x = mesh.vertices[0]
        there = mesh.vertices[found.vertices]
        axis = np.cross(x, [0.3, 0.4, 0.5])
        axis /= np.linalg.norm(axis)
        turn = np.arctan2(there @ np.cross(x, axis), there @ axis)
        length = np.arccos(np.clip(there @ x, -1, 1))
        flat = length[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
        errors.append(float(np.abs(found.uv - turned(flat, angle_between(found.uv, flat))).max()))
    assert errors[0] > 1.5 * errors[1] > 1.5**2 * errors[2]


# --- inverse of the exponential map -----------------------------------------------------------------------------------


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_exp_of_log_is_the_vertex(case: meshes.Case) -> None:
    """But for ways that touch the boundary or a saddle vertex: straightest curves do not go on there as they do."""
    mesh = case.mesh
    for center in points_of(mesh):
        found = graph_of(mesh).log_map(center, np.inf)
        ends = sb.exp_map(mesh, center, found.uv)
        gap = np.linalg.norm(ends.positions(mesh) - mesh.vertices[found.vertices], axis=1)
        straight = ~found.shadowed & ~touches(mesh, found, center)
        assert straight.any()
        assert gap[straight].max() <= 1e-9 * max(1.0, float(found.distance.max()))
        for i in np.flatnonzero(straight)[:10]:
            path = sb.trace(mesh, center, float(found.angle[i]), float(found.distance[i]))
            np.testing.assert_allclose(path.points[-1], mesh.vertices[found.vertices[i]], atol=1e-9)


def touches(mesh: sb.Mesh, found: sb.LogMap, center: int | sb.SurfacePoints) -> NDArray[np.bool_]:
    saddles = set(mesh.saddle_vertices.tolist())
    result = []
    for angle, distance in zip(found.angle.tolist(), found.distance.tolist(), strict=True):
        path = sb.trace(mesh, center, angle, distance)
        held = path.surface.barycentric[1:-1].max(axis=1) == 1
        corners = path.surface.barycentric[1:-1].argmax(axis=1)
        passed = mesh.triangles[path.surface.faces[1:-1], corners][held]
        result.append(path.hit_boundary or bool(saddles & set(passed.tolist())))
    return np.array(result)


@pytest.mark.parametrize("case", GENTLE, ids=str)
def test_log_of_exp_is_the_vector(case: meshes.Case) -> None:
    """Inside the injectivity radius, which is told by another way: the curve is as long as the distance."""
    mesh, rng = case.mesh, np.random.default_rng(3)
    checked = 0
    for center in points_of(mesh):
        uv = rng.normal(size=(12, 2)) * 2 * mesh.mean_edge_length
        ends = sb.exp_map(mesh, center, uv)
        for i in range(len(uv)):
            end = ends[i : i + 1]
            length = float(np.linalg.norm(uv[i]))
            sources = [center] if isinstance(center, int) else center
            if abs(sb.ExactField(mesh, sources).distance_to(end)[0] - length) > 1e-9 or end.barycentric.min() < 1e-6:
                continue
            if not isinstance(center, int) and end.faces[0] == center.faces[0]:
                continue  # the cut removes the center's face
            refined = with_vertex_at(mesh, end)
            same = center if isinstance(center, int) else moved(mesh, refined, center)
            found = graph_of(refined).log_map(same, 1.01 * length)
            there = found.uv[found.vertices == len(mesh.vertices)][0]
            if isinstance(same, int):  # the cut may have changed the vertex's first edge
                there = turned(there[None], first_angle(mesh, refined, same))[0]
            assert np.linalg.norm(there - uv[i]) <= 1e-6 * length
            checked += 1
    assert checked > 15


def moved(mesh: sb.Mesh, refined: sb.Mesh, point: sb.SurfacePoints) -> sb.SurfacePoints:
    """The same point: its face keeps its corners, in order, and only its number may change."""
    face = int(np.flatnonzero((refined.triangles == mesh.triangles[point.faces[0]]).all(axis=1))[0])
    return sb.SurfacePoints([face], point.barycentric)


def first_angle(mesh: sb.Mesh, refined: sb.Mesh, vertex: int) -> float:
    """Scaled angle of the refined mesh's first edge about a vertex, in the mesh."""
    reach = 1e-3 * mesh.mean_edge_length
    towards = sb.trace(refined, vertex, 0.0, reach).points[-1]
    ends = [sb.trace(mesh, vertex, float(a), reach).points[-1] for a in np.linspace(0, mesh.total_angles[vertex], 2001)]
    rough = np.argmin(np.linalg.norm(np.array(ends) - towards, axis=1)) * mesh.total_angles[vertex] / 2000
    for step in (1e-3, 1e-5, 1e-7, 1e-9):
        tries = rough + step * np.arange(-200, 201)
        gaps = [np.linalg.norm(sb.trace(mesh, vertex, float(a), reach).points[-1] - towards) for a in tries]
        rough = float(tries[int(np.argmin(gaps))])
    return rough * 2 * np.pi / float(mesh.total_angles[vertex]) if vertex not in boundary_of(mesh) else rough


def boundary_of(mesh: sb.Mesh) -> set[int]:
    return {int(v) for loop in mesh.boundary_loops for v in loop}


# --- what it says of the mesh -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_distances_are_exact_and_cut_at_the_radius(case: meshes.Case) -> None:
    mesh = case.mesh
    for center in [0, *points_of(mesh)]:
        exact = sb.exact_distances(mesh, [center] if isinstance(center, int) else center)
        for radius in (np.inf, 1e9, float(np.median(exact[np.isfinite(exact)])) * (1 + 1e-9), 1e-9):
            found = graph_of(mesh).log_map(center, radius)
            inside = np.flatnonzero(exact <= min(radius, 1e300))
            assert np.array_equal(found.vertices, inside)
            np.testing.assert_allclose(found.distance, exact[inside], rtol=1e-11, atol=1e-15)
            np.testing.assert_allclose(np.linalg.norm(found.uv, axis=1), found.distance, rtol=1e-13, atol=1e-300)


def test_behind_a_saddle_vertex_all_lies_in_its_direction() -> None:
    mesh = sb.Mesh(*meshes.saddle())
    found = graph_of(mesh).log_map(6 * 13 + 6, np.inf)
    assert 0 < found.shadowed.sum() < len(found)
    directions = set(np.round(found.angle[~found.shadowed], 9))
    assert all(round(float(angle), 9) in directions for angle in found.angle[found.shadowed])


def test_on_the_boundary_angles_fill_what_surface_there_is() -> None:
    mesh = sb.Mesh(*meshes.grid(9, 9))
    for center, span in ((0, np.pi / 2), (4, np.pi), (sb.SurfacePoints([0], [[0.5, 0.5, 0]]), np.pi)):
        found = graph_of(mesh).log_map(center, np.inf)
        away = found.distance > 0
        assert np.ptp(found.angle[away]) == pytest.approx(span, abs=1e-12)
        plane = (mesh.vertices - position_of(mesh, center))[:, :2]
        assert_same_up_to_a_turn(found.uv, plane, 1e-13)


def test_of_one_component_only() -> None:
    mesh = sb.Mesh(*meshes.two_components())
    found = graph_of(mesh).log_map(0, np.inf)
    assert np.array_equal(found.vertices, np.flatnonzero(mesh.components == 0))


def test_near_a_vertex_is_as_at_it() -> None:
    mesh = sb.Mesh(*meshes.torus())
    at = graph_of(mesh).log_map(0, 1.0)
    face, corner = np.argwhere(mesh.triangles == 0)[0]
    for shift in (1e-15, 1e-12, 1e-9):
        weights = np.full(3, shift / 2)
        weights[corner] = 1 - shift
        near = graph_of(mesh).log_map(sb.SurfacePoints([face], [weights]), 1.0)
        assert np.array_equal(near.vertices, at.vertices)
        np.testing.assert_allclose(near.distance, at.distance, atol=3 * shift * mesh.mean_edge_length + 1e-12)


def test_scale_and_order_change_nothing_else() -> None:
    vertices, triangles = meshes.double_torus()
    first = graph_of(sb.Mesh(vertices, triangles)).log_map(5, 2.0)
    for scale in (1e-30, 1e30):
        scaled = graph_of(sb.Mesh(vertices * scale, triangles)).log_map(5, 2.0 * scale)
        assert np.array_equal(scaled.vertices, first.vertices)
        np.testing.assert_allclose(scaled.uv / scale, first.uv, rtol=1e-10, atol=1e-12)


def test_the_exponential_map_is_the_same_for_any_number_of_threads() -> None:
    mesh = sb.Mesh(*meshes.torus())
    uv = np.random.default_rng(0).normal(size=(500, 2))
    one = sb.exp_map(mesh, 3, uv, threads=1)
    for threads in (2, 8):
        many = sb.exp_map(mesh, 3, uv, threads=threads)
        assert many.faces.tobytes() == one.faces.tobytes()
        assert many.barycentric.tobytes() == one.barycentric.tobytes()
    assert len(sb.exp_map(mesh, 3, np.zeros((0, 2)))) == 0
    np.testing.assert_allclose(sb.exp_map(mesh, 3, np.zeros((1, 2))).positions(mesh)[0], mesh.vertices[3])


# --- the call ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("center", "radius", "sentence"),
    [
        (500, 1.0, "center: vertex 500 at"),
        (-1, 1.0, "center: vertex -1 at"),
        ([0, 1], 1.0, "center: wanted one point, got 2"),
        (sb.SurfacePoints([900], [[1, 0, 0]]), 1.0, "center: point 0 has face 900"),
        (0.5, 1.0, "center"),
        (0, 0.0, "radius: wanted a distance above 0, got 0"),
        (0, -1.0, "radius: wanted a distance above 0, got -1"),
        (0, float("nan"), "radius: wanted a distance above 0, got nan"),
        (0, "far", "radius"),
    ],
)
def test_bad_input_is_named(center: object, radius: object, sentence: str) -> None:
    graph = graph_of(sb.Mesh(*meshes.grid()))
    with pytest.raises(sb.InputError, match=sentence):
        graph.log_map(center, radius)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ((500, [[0, 0]]), "center: vertex 500 at"),
        ((0, [[0, 0, 0]]), "uv"),
        ((0, [[0, 0], [np.nan, 0]]), r"uv: vector 1 is \(nan, 0\), which is not finite"),
        ((0, [[0, 0], [0, np.inf]]), r"uv: vector 1 is \(0, inf\)"),
    ],
)
def test_bad_vectors_are_named(arguments: tuple[int, list[list[float]]], sentence: str) -> None:
    with pytest.raises(sb.InputError, match=sentence):
        sb.exp_map(sb.Mesh(*meshes.grid()), *arguments)
    with pytest.raises(sb.InputError, match="threads"):
        sb.exp_map(sb.Mesh(*meshes.grid()), 0, [[0, 0]], threads=-1)
    with pytest.raises(sb.InputError, match="too long to follow"):
        sb.exp_map(sb.Mesh(*meshes.tetrahedron()), 0, [[1e300, 0]])


@pytest.mark.parametrize("radius", [np.inf, 2.5])
def test_progress_rises_and_cancel_is_quick(radius: float) -> None:
    graph = graph_of(sb.Mesh(*meshes.icosphere(6)))
    check_progress_and_cancel(lambda job: graph.log_map(0, radius, job=job), 0.3)


@pytest.mark.parametrize("height", [1.0, 1e3, 1e7])
def test_round_a_tip_of_needles(height: float) -> None:
    """Rays go round the tip once, not pi / (its angle) times; a curve's from both of its sides do as well."""
    mesh = sb.Mesh(*meshes.spike_on_a_plate(height))
    graph = graph_of(mesh)
    exact = sb.exact_distances(mesh, [12])
    found = graph.log_map(12, 3 * height + 10)
    assert found.vertices.tolist() == list(range(mesh.vertex_count))
    np.testing.assert_allclose(found.distance, exact, rtol=1e-12)
    curve = sb.SurfacePoints([24, 24], [[0.9, 0.05, 0.05], [0.1, 0.5, 0.4]])
    beside = sb.polar_coordinates(graph, curve, 3 * height + 10)
    ends = np.min([sb.exact_distances(mesh, curve[i]) for i in range(2)], axis=0)
    assert beside.vertices.tolist() == list(range(mesh.vertex_count))
    assert (beside.distance <= ends * (1 + 1e-12)).all()

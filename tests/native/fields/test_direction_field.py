# SPDX-License-Identifier: MIT
"""Direction fields: exact indices, strokes that are met, smoothness where nothing is asked."""

from __future__ import annotations

import os
import re
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_progress_and_cancel
from tests.native.field_indices import euler_characteristic, indices, loop_indices, turns, twins
from tests.truth.surfaces import rough, sides

Floats = NDArray[np.float64]
SYMMETRIES = (1, 2, 4)


def random_indices(mesh: sb.Mesh, symmetry: int, total: int, rng: np.random.Generator) -> dict[int, float]:
    """Singularities of single units whose indices sum to `total`, none next to another."""
    inner = rng.permutation(np.setdiff1d(np.arange(mesh.vertex_count), mesh.boundary_vertices))
    neighbors: dict[int, set[int]] = {}
    for a, b in mesh.edges.tolist():
        neighbors.setdefault(a, set()).add(b)
        neighbors.setdefault(b, set()).add(a)
    pairs = int(rng.integers(0, 4))
    units = [np.sign(total)] * abs(symmetry * total) + [1, -1] * pairs
    result: dict[int, float] = {}
    taken: set[int] = set()
    for vertex in inner.tolist():
        if len(result) == len(units):
            break
        # A vertex of few faces or much curvature cannot turn a unit more between faces that large.
        if vertex in taken or len(neighbors[vertex]) < 5:
            continue
        taken |= {vertex} | neighbors[vertex]
        result[vertex] = float(units[len(result)]) / symmetry
    assert len(result) == len(units)
    return result


def fine(arrays: meshes.Arrays) -> sb.Mesh:
    """Cut into faces small enough for a dozen singularities."""
    while len(arrays[1]) < 1500:
        arrays = meshes.subdivide(*arrays)
    return sb.Mesh(*arrays)


def line_across(mesh: sb.Mesh, vertex: int, angle: float, length: float) -> sb.SurfaceCurve:
    return sb.SurfaceCurve(mesh, sb.trace(mesh, vertex, angle, length).surface)


def angles_between(field: sb.DirectionField, curve: sb.SurfaceCurve, mesh: sb.Mesh) -> Floats:
    """Radians between the field and each piece of a curve, in the piece's face."""
    positions = curve.points.positions(mesh)
    pieces = np.diff(positions, axis=0)
    length = np.linalg.norm(pieces, axis=1)
    keep = length > 1e-9 * length.max()
    middles = sb.project(mesh, (positions[:-1] + positions[1:])[keep] / 2)
    across = np.cross(pieces[keep] / length[keep, None], field.vectors[middles.faces])
    cosine = (pieces[keep] / length[keep, None] * field.vectors[middles.faces]).sum(axis=1)
    angle = np.arctan2(np.linalg.norm(across, axis=1), cosine)
    quantum = 2 * np.pi / field.symmetry
    return np.abs(angle - quantum * np.round(angle / quantum))


# --- given singularities ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("symmetry", SYMMETRIES)
@pytest.mark.parametrize("case", [case for case in meshes.good() if case.components == 1], ids=str)
def test_indices_are_those_given(case: meshes.Case, symmetry: int) -> None:
    mesh = fine((case.vertices, case.triangles))
    rng = np.random.default_rng(symmetry)
    total = euler_characteristic(mesh) if case.loops == 0 else 0
    wanted = random_indices(mesh, symmetry, total, rng)
    field = sb.direction_field(mesh, symmetry, wanted)
    assert field.singularities == wanted
    assert sum(field.singularities.values()) + field.loop_indices.sum() == euler_characteristic(mesh)
    if field.largest_turn < np.pi / symmetry:
        assert indices(mesh, field.vectors, symmetry) == wanted
        assert loop_indices(mesh, field.vectors, symmetry) == field.loop_indices.tolist()
        np.testing.assert_allclose(turns(mesh, field.vectors, symmetry), field.turns, atol=1e-6)


@pytest.mark.parametrize("symmetry", SYMMETRIES)
@pytest.mark.parametrize("arrays", [meshes.icosphere(4), meshes.torus(70, 30), meshes.double_torus()])
def test_the_vectors_alone_tell_the_indices(arrays: meshes.Arrays, symmetry: int) -> None:
    mesh = fine(arrays)
    for seed in range(3):
        wanted = random_indices(mesh, symmetry, euler_characteristic(mesh), np.random.default_rng(seed))
        field = sb.direction_field(mesh, symmetry, wanted)
        assert field.largest_turn < np.pi / symmetry
        assert indices(mesh, field.vectors, symmetry) == wanted


# Least turning of these would turn once around the tube of three edges, faster than its faces can tell.
NARROW = {35: -1, 3: 1, 18: -1, 10: 1, 2: -1, 4: 1, 32: -1, 13: 1}


def test_narrow_handles_are_not_turned_around_faster_than_their_faces_tell() -> None:
    mesh = sb.Mesh(*meshes.torus(12, 3))
    for symmetry in SYMMETRIES:
        wanted = {vertex: unit / symmetry for vertex, unit in NARROW.items()}
        field = sb.direction_field(mesh, symmetry, wanted)
        assert field.largest_turn < np.pi / symmetry and len(field.sharp_edges) == 0
        assert indices(mesh, field.vectors, symmetry) == wanted


def test_a_vertex_that_has_to_turn_too_fast_is_named() -> None:
    """Five edges share a turn of more than twice 2 pi: each turns by more than pi / 2, whatever one does."""
    mesh = sb.Mesh(*meshes.icosphere(3))
    vertex, far = 0, int(np.argmin(mesh.vertices @ mesh.vertices[0]))
    field = sb.direction_field(mesh, 2, {vertex: -2, far: 4})
    assert field.singularities == {vertex: -2, far: 4} != indices(mesh, field.vectors, 2)
    named = {frozenset(pair) for pair in field.sharp_edges.tolist()}
    about = [set(np.flatnonzero((mesh.triangles == v).any(axis=1)).tolist()) for v in (vertex, far)]
    across = twins(mesh.triangles)
    for faces in about:
        edges = {frozenset((f, int(t) // 3)) for f in faces for t in across[f] if int(t) // 3 in faces}
        assert len(edges) == 5 and edges <= named
    sharp = np.abs(field.turns) >= np.pi / 2
    assert named == {frozenset((f, int(across[f, i]) // 3)) for f, i in np.argwhere(sharp).tolist()}


def test_a_sphere_has_a_source_and_a_sink_or_eight_quarters() -> None:
    mesh = sb.Mesh(*meshes.icosphere(3))
    assert sb.direction_field(mesh, 1, {0: 1, 3: 1}).singularities == {0: 1.0, 3: 1.0}
    corners = sb.project(mesh, np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T.astype(float))
    vertices = mesh.triangles[corners.faces, corners.barycentric.argmax(axis=1)]
    field = sb.direction_field(mesh, 4, {int(v): Fraction(1, 4) for v in vertices})
    assert len(field.singularities) == 8


def test_the_plane_needs_no_turning() -> None:
    mesh = sb.Mesh(*meshes.grid(20, 20, 0.3))
    for field in (sb.direction_field(mesh, 1, {}), sb.direction_field(mesh, 1)):
        assert np.abs(field.vectors - field.vectors[0]).max() < 1e-6
        assert field.loop_indices.tolist() == [1.0]


def test_a_torus_needs_no_singularity_and_closes_around_its_handle() -> None:
    mesh = sb.Mesh(*meshes.torus(60, 24))
    field = sb.direction_field(mesh, 1, {})
    assert field.singularities == {} and indices(mesh, field.vectors, 1) == {}
    # By symmetry the field that turns least keeps its angle to the circles of latitude.
    around = np.cross([0, 0, 1.0], mesh.vertices[mesh.triangles].mean(axis=1))
    cosine = (field.vectors * around / np.linalg.norm(around, axis=1, keepdims=True)).sum(axis=1)
    assert cosine.std() < 0.02


def test_free_loops_share_what_is_left() -> None:
    mesh = sb.Mesh(*meshes.holes(25))
    field = sb.direction_field(mesh, 1, {})
    # A constant field turns once against the outer loop, and once the other way against each hole.
    assert sorted(field.loop_indices.tolist()) == [-1.0, -1.0, 1.0]
    assert np.abs(field.vectors - field.vectors[0]).max() < 1e-6


def test_loops_take_the_indices_given() -> None:
    mesh = sb.Mesh(*meshes.holes(25))
    field = sb.direction_field(mesh, 2, {}, loop_indices={0: 0, 1: 0.5, 2: -1.5})
    assert field.loop_indices.tolist() == [0.0, 0.5, -1.5]
    assert loop_indices(mesh, field.vectors, 2) == [0.0, 0.5, -1.5]
    with pytest.raises(sb.InputError, match=r"sum to 0 but must sum to -1: -1 is missing"):
        sb.direction_field(mesh, 2, {}, loop_indices={0: 0, 1: 0, 2: 0})


def test_each_component_has_its_own_sum() -> None:
    mesh = sb.Mesh(*meshes.merge(meshes.icosphere(2), meshes.torus(), meshes.grid()))
    field = sb.direction_field(mesh, 1, {0: 1, 5: 1})
    assert field.singularities == {0: 1.0, 5: 1.0}
    message = r"component 1 \(genus 1, 0 boundary loops\) sum to 1/2 but must sum to 0: -1/2 is missing"
    with pytest.raises(sb.InputError, match=message):
        sb.direction_field(mesh, 2, {0: 1, 5: 1, 200: 0.5})


@pytest.mark.parametrize("symmetry", SYMMETRIES)
@pytest.mark.parametrize("case", [case for case in meshes.closed() if case.components == 1], ids=str)
def test_wrong_sums_are_refused_with_what_is_missing(case: meshes.Case, symmetry: int) -> None:
    rng = np.random.default_rng(case.genus)
    wanted = {int(v): int(k) / symmetry for v, k in zip(rng.permutation(4), rng.integers(-3, 4, 4), strict=True)}
    lacking = Fraction(euler_characteristic(case.mesh)) - Fraction(sum(wanted.values()))
    if lacking == 0:
        wanted[0] += 1
        lacking = Fraction(-1)
    with pytest.raises(sb.InputError, match=rf"component 0 .*: {re.escape(str(lacking))} is missing"):
        sb.direction_field(case.mesh, symmetry, wanted)


# --- strokes ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("symmetry", SYMMETRIES)
@pytest.mark.parametrize("given", [True, False])
def test_strokes_are_met(symmetry: int, given: bool) -> None:
    mesh = sb.Mesh(*meshes.icosphere(5))
    singularities = random_indices(mesh, symmetry, 2, np.random.default_rng(0)) if given else None
    curves = [line_across(mesh, v, 1.0, 0.5) for v in (1300, 3900, 7700)]
    for hard, mean in ((True, 1e-6), (False, np.radians(2))):
        field = sb.direction_field(mesh, symmetry, singularities, [sb.Stroke(curve, hard) for curve in curves])
        off = np.concatenate([angles_between(field, curve, mesh) for curve in curves])
        assert (off.max() if hard else off.mean()) < mean
        if given:
            assert field.singularities == singularities == indices(mesh, field.vectors, symmetry)


def test_strokes_never_change_an_index() -> None:
    mesh = sb.Mesh(*meshes.torus(60, 24))
    rng = np.random.default_rng(5)
    wanted = {100: 1.0, 700: -1.0, 1000: 1.0, 1300: -1.0}
    for _ in range(10):
        curves = [line_across(mesh, int(v), float(rng.uniform(0, 6)), 0.6) for v in rng.integers(0, 1440, 6)]
        field = sb.direction_field(mesh, 1, wanted, curves)
        assert field.singularities == wanted


def test_a_stronger_stroke_wins() -> None:
    mesh = sb.Mesh(*meshes.grid(30, 30, 0.2))
    across = sb.SurfaceCurve(mesh, sb.trace(mesh, 15 * 30 + 5, [1.0, 0, 0], 0.6).surface)
    upright = sb.SurfaceCurve(mesh, sb.trace(mesh, 5 * 30 + 15, [0, 1.0, 0], 0.6).surface)
    for strong, weak in ((across, upright), (upright, across)):
        field = sb.direction_field(mesh, 1, {}, [sb.Stroke(strong, weight=10), sb.Stroke(weak, weight=0.1)])
        assert angles_between(field, strong, mesh).mean() < angles_between(field, weak, mesh).mean() / 3


def test_strokes_come_in_any_form() -> None:
    mesh = sb.Mesh(*meshes.grid(10, 10))
    path = sb.trace(mesh, 11, [1.0, 0, 0], 0.5)
    curve = sb.SurfaceCurve(mesh, path.surface)
    fields = [sb.direction_field(mesh, 1, {}, [stroke]) for stroke in (path, curve, path.surface, sb.Stroke(curve))]
    assert all(np.array_equal(field.vectors, fields[0].vectors) for field in fields)
    assert np.abs(fields[0].vectors - [1, 0, 0]).max() < 1e-6


# --- automatic --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("symmetry", SYMMETRIES)
@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_the_smoothest_field_tells_its_singularities(case: meshes.Case, symmetry: int) -> None:
    field = sb.direction_field(case.mesh, symmetry)
    if field.largest_turn < np.pi / symmetry - 1e-9:  # or one of two turns is as good as the other
        assert field.singularities == indices(case.mesh, field.vectors, symmetry)
        assert field.loop_indices.tolist() == loop_indices(case.mesh, field.vectors, symmetry)
    assert sum(field.singularities.values()) + field.loop_indices.sum() == euler_characteristic(case.mesh)
    np.testing.assert_allclose(np.linalg.norm(field.vectors, axis=1), 1)


def test_the_smoothest_fields_of_a_sphere_have_the_fewest_singularities() -> None:
    mesh = sb.Mesh(*meshes.icosphere(3))
    counts = [len(sb.direction_field(mesh, symmetry).singularities) for symmetry in SYMMETRIES]
    assert counts == [2, 4, 8]


def test_curvature_of_a_cylinder() -> None:
    mesh = sb.Mesh(*meshes.cylinder(40, 20))
    for singularities in (None, {}):
        lines = sb.direction_field(mesh, 2, singularities, align="curvature")
        assert np.abs(np.abs(lines.vectors[:, 2]) - 1).max() < 1e-3
        crosses = sb.direction_field(mesh, 4, singularities, align="curvature")
        assert np.minimum(np.abs(crosses.vectors[:, 2]), 1 - np.abs(crosses.vectors[:, 2])).max() < 1e-3


@pytest.mark.parametrize("singularities", [None, {180: 1}])
def test_boundaries_are_followed(singularities: dict[int, float] | None) -> None:
    mesh = sb.Mesh(*meshes.graded_disk(0.05, 12, 40))
    if singularities:
        singularities = {0: 1}
    field = sb.direction_field(mesh, 1, singularities, align="boundary")
    loop = mesh.boundary_loops[0]
    sides = dict(zip(loop.tolist(), np.roll(loop, -1).tolist(), strict=True))
    for face, triangle in enumerate(mesh.triangles.tolist()):
        for i in range(3):
            if sides.get(triangle[i]) == triangle[(i + 1) % 3]:
                edge = mesh.vertices[triangle[(i + 1) % 3]] - mesh.vertices[triangle[i]]
                assert abs(abs(field.vectors[face] @ edge) / np.linalg.norm(edge) - 1) < 1e-9
    assert field.loop_indices.tolist() == [0.0]
    if singularities:
        assert field.singularities == {0: 1.0}


# --- between faces ----------------------------------------------------------------------------------------------------


def across_edges(mesh: sb.Mesh, share: float) -> tuple[sb.SurfacePoints, sb.SurfacePoints]:
    """The same points of all inner edges, seen from either face."""
    place = {}
    for face, triangle in enumerate(mesh.triangles.tolist()):
        for i in range(3):
            place[triangle[i], triangle[(i + 1) % 3]] = (face, i)
    sides: tuple[list[int], list[int]] = ([], [])
    weights: tuple[list[Floats], list[Floats]] = ([], [])
    for (a, b), (face, i) in place.items():
        if a > b or (b, a) not in place:
            continue
        other, j = place[b, a]
        for side, (f, k, t) in enumerate(((face, i, share), (other, j, 1 - share))):
            coordinates = np.zeros(3)
            coordinates[k], coordinates[(k + 1) % 3] = 1 - t, t
            sides[side].append(f)
            weights[side].append(coordinates)
    return sb.SurfacePoints(sides[0], weights[0]), sb.SurfacePoints(sides[1], weights[1])


@pytest.mark.parametrize("share", [0.02, 0.5, 0.9])
def test_the_field_is_continuous_across_edges(share: float) -> None:
    mesh = sb.Mesh(*meshes.icosphere(2))
    field = sb.direction_field(mesh, 1, {0: 2, 40: 1, 100: -1})
    here, there = across_edges(mesh, share)
    triangles = mesh.triangles
    on_edge = here.barycentric > 0
    ends = np.array([triangles[f][keep] for f, keep in zip(here.faces, on_edge, strict=True)])
    edge = mesh.vertices[ends[:, 1]] - mesh.vertices[ends[:, 0]]

    def angle(points: sb.SurfacePoints) -> Floats:
        corners = mesh.vertices[triangles[points.faces]]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        vectors = field.directions(points)
        return np.arctan2((np.cross(normal, edge) * vectors).sum(axis=1), (edge * vectors).sum(axis=1))

    step = angle(here) - angle(there)
    assert np.abs(np.angle(np.cos(step) + 1j * np.sin(step))).max() < 1e-9


def test_the_field_at_the_center_of_a_face_is_its_vector() -> None:
    mesh = sb.Mesh(*meshes.icosphere(2))
    field = sb.direction_field(mesh, 2, {0: 1, 7: 1})
    centers = sb.SurfacePoints(np.arange(mesh.face_count), np.full((mesh.face_count, 3), 1 / 3))
    np.testing.assert_allclose(field.directions(centers), field.vectors, atol=1e-12)


def test_turned_fields() -> None:
    mesh = sb.Mesh(*meshes.icosphere(2))
    field = sb.direction_field(mesh, 1, {0: 1, 7: 1})
    across = field.turned(np.pi / 2)
    assert np.abs((field.vectors * across.vectors).sum(axis=1)).max() < 1e-12
    assert across.singularities == field.singularities


# --- invariance -------------------------------------------------------------------------------------------------------


def rotation() -> Floats:
    q, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
    return q * np.sign(np.linalg.det(q))


@pytest.mark.parametrize("singularities", [None, {0: 1, 50: 1, 90: 1, 120: -1}])
def test_moved_and_scaled_meshes_have_the_moved_field(singularities: dict[int, float] | None) -> None:
    vertices, triangles = meshes.icosphere(3)
    vertices = vertices * (1.0, 0.8, 1.3)
    field = sb.direction_field(sb.Mesh(vertices, triangles), 1, singularities)
    turn = rotation()
    moved = sb.direction_field(sb.Mesh(1000 * vertices @ turn.T + 5, triangles), 1, singularities)
    # The smoothest field is searched for until its energy stays the same to 1e-4.
    assert np.abs(moved.vectors - field.vectors @ turn.T).max() < (1e-4 if singularities else 0.03)


def test_renumbered_meshes_have_the_same_field() -> None:
    vertices, triangles = meshes.torus(40, 20)
    rng = np.random.default_rng(3)
    order, faces = rng.permutation(len(vertices)), rng.permutation(len(triangles))
    place = np.argsort(order)
    mesh = sb.Mesh(vertices, triangles)
    other = sb.Mesh(vertices[order], place[triangles[faces]])
    wanted = {100: 1, 300: -1}
    path = sb.trace(mesh, 500, 0.3, 0.5)
    stroke = sb.SurfaceCurve(mesh, path.surface)
    same = sb.SurfaceCurve(other, sb.SurfacePoints(np.argsort(faces)[path.surface.faces], path.surface.barycentric))
    first = sb.direction_field(mesh, 1, wanted, [stroke])
    second = sb.direction_field(other, 1, {int(place[v]): k for v, k in wanted.items()}, [same])
    assert np.abs(second.vectors - first.vectors[faces]).max() < 1e-4


@pytest.mark.parametrize(
    "arrays", [meshes.double_torus(), meshes.torus(240, 80)], ids=["small", "many faces for each core"]
)
@pytest.mark.parametrize(
    "options", [{"singularities": {3: -1, 20: -1}}, {}, {"symmetry": 4, "align": "curvature"}], ids=str
)
def test_the_same_bytes_every_time_and_on_one_core(arrays: meshes.Arrays, options: dict[str, Any]) -> None:
    mesh = sb.Mesh(*arrays)
    if mesh.genus == 1 and "singularities" in options:
        options = {"singularities": {3: -1, 20: 1}}
    angles = sb.direction_field(mesh, **options).angles
    assert np.array_equal(sb.direction_field(mesh, **options).angles, angles)
    if not hasattr(os, "sched_setaffinity"):
        return
    cores = os.sched_getaffinity(0)
    try:
        os.sched_setaffinity(0, {min(cores)})
        assert np.array_equal(sb.direction_field(mesh, **options).angles, angles)
    finally:
        os.sched_setaffinity(0, cores)


def test_an_editor_says_what_a_new_field_says() -> None:
    mesh = sb.Mesh(*meshes.icosphere(4))
    curves = [line_across(mesh, v, 1.0, 0.5) for v in (300, 900, 1700)]
    editor = sb.DirectionFieldEditor(mesh, 2)
    for singularities in ({0: 1, 3: 1}, {0: 1, 900: 0.5, 30: 0.5}, None):
        for chosen in (curves[:1], curves[1:], []):
            edited = editor.field(singularities, chosen)
            new = sb.direction_field(mesh, 2, singularities, chosen)
            assert edited.singularities == new.singularities
            assert np.abs(edited.vectors - new.vectors).max() < 1e-4


# --- bad input --------------------------------------------------------------------------------------------------------


def test_bad_input_is_told() -> None:
    mesh = sb.Mesh(*meshes.grid(6, 6))
    other = sb.Mesh(*meshes.grid(6, 6))
    stroke = sb.SurfaceCurve(mesh, [7, 8])
    crossing = sb.SurfaceCurve(mesh, sb.trace(mesh, sb.SurfacePoints([12], [[0.4, 0.3, 0.3]]), 1.0, 0.1).surface)
    along = sb.SurfaceCurve(mesh, sb.trace(mesh, sb.SurfacePoints([12], [[0.3, 0.4, 0.3]]), 2.0, 0.1).surface)
    back_and_forth = [[0.2, 0.6, 0.2], [0.5, 0, 0.5], [0.2, 0.2, 0.6], [0.8, 0.2, 0], [0.1, 0.8, 0.1]]
    itself = sb.SurfaceCurve(mesh, sb.SurfacePoints([12, 12, 13, 13, 12], back_and_forth))
    for message, call in {
        "symmetry is 3, but must be": lambda: sb.direction_field(mesh, 3),
        "vertex 99 is out of range, the mesh has 36 vertices": lambda: sb.direction_field(mesh, 1, {99: 1}),
        "vertex -1 is out of range": lambda: sb.direction_field(mesh, 1, {-1: 1}),
        "vertex 0 lies on the boundary": lambda: sb.direction_field(mesh, 1, {0: 1}),
        "vertex 7 has index 0.5, which is not a whole number": lambda: sb.direction_field(mesh, 1, {7: 0.5}),
        "vertex 7 has index nan": lambda: sb.direction_field(mesh, 1, {7: np.nan}),
        "singularities: wanted a dict": lambda: sb.direction_field(mesh, 1, [7]),
        "singularities: wanted an integer": lambda: sb.direction_field(mesh, 1, {7.5: 1}),
        "boundary loop 3 is out of range, the mesh has 1": lambda: sb.direction_field(mesh, 1, {}, loop_indices={3: 1}),
        "loop_indices: only together": lambda: sb.direction_field(mesh, 1, loop_indices={0: 1}),
        'align: wanted "none", "curvature" or "boundary", got \'x\'': lambda: sb.direction_field(mesh, 2, align="x"),
        "curvature has no head": lambda: sb.direction_field(mesh, 1, align="curvature"),
        "align_weight is 0": lambda: sb.direction_field(mesh, 2, align="curvature", align_weight=0),
        "stroke 0 lies on another mesh": lambda: sb.direction_field(other, 1, {}, [stroke]),
        "stroke 0 has weight -1": lambda: sb.direction_field(mesh, 1, {}, [sb.Stroke(stroke, weight=-1)]),
        "strokes: stroke 0: vertex 77 at": lambda: sb.direction_field(mesh, 1, {}, [[7, 77]]),
        "strokes: stroke 1: points 0 .* share no face": lambda: sb.direction_field(mesh, 1, {}, [stroke, [7, 28]]),
        "strokes: wanted a list": lambda: sb.direction_field(mesh, 1, {}, stroke),
        "hard strokes 0 and 1 cross in face 12": lambda: sb.direction_field(
            mesh, 1, {}, [sb.Stroke(crossing, True), sb.Stroke(along, True)]
        ),
        "hard stroke 0 crosses itself in face 12": lambda: sb.direction_field(mesh, 1, {}, [sb.Stroke(itself, True)]),
        "curve: wanted a SurfaceCurve": lambda: sb.Stroke([7, 8]),
        "mesh: wanted a Mesh": lambda: sb.direction_field(3),
    }.items():
        with pytest.raises(sb.InputError, match=message):
            call()


def test_progress_and_cancel() -> None:
    mesh = sb.Mesh(*meshes.torus(700, 250))
    check_progress_and_cancel(lambda job: sb.direction_field(mesh, 1, {5: 1, 9000: -1}, job=job), 0.3)
    check_progress_and_cancel(lambda job: sb.direction_field(mesh, 4, job=job), 0.5)


@pytest.mark.parametrize("symmetry", SYMMETRIES)
def test_a_field_is_the_same_from_its_own_vectors(symmetry: int) -> None:
    mesh = fine(meshes.icosphere(3))
    field = sb.direction_field(mesh, symmetry)
    again = sb.DirectionField.from_vectors(mesh, 3 * field.vectors + mesh_normals(mesh), symmetry)
    assert again.singularities == field.singularities
    np.testing.assert_allclose(again.vectors, field.vectors, atol=1e-9)
    np.testing.assert_allclose(again.turns, field.turns, atol=1e-9)


def test_vectors_that_are_no_directions_are_refused() -> None:
    mesh = sb.Mesh(*meshes.icosphere(2))
    vectors = sb.direction_field(mesh, 1).vectors.copy()
    with pytest.raises(sb.InputError, match="symmetry is 3"):
        sb.DirectionField.from_vectors(mesh, vectors, 3)
    with pytest.raises(sb.InputError, match=f"each of the {mesh.face_count} faces, got 7"):
        sb.DirectionField.from_vectors(mesh, vectors[:7])
    given = sb.DirectionField.from_vectors(mesh, vectors)
    for unit in (1e-308, 1e200, 1e308):  # lengths do not count
        np.testing.assert_allclose(
            sb.DirectionField.from_vectors(mesh, unit * vectors).vectors, given.vectors, atol=1e-12
        )
    vectors[5] = mesh_normals(mesh)[5]
    with pytest.raises(sb.InputError, match="face 5 has no direction"):
        sb.DirectionField.from_vectors(mesh, vectors)
    vectors[4] = np.nan
    with pytest.raises(sb.InputError, match=r"vectors"):
        sb.DirectionField.from_vectors(mesh, vectors)


def test_fields_are_turned_by_any_angle() -> None:
    field = sb.direction_field(sb.Mesh(*meshes.icosphere(2)), 1)
    for angle in (1e6, 1e300):
        turned = field.turned(angle)
        np.testing.assert_allclose(turned.vectors, field.turned(np.remainder(angle, 2 * np.pi)).vectors, atol=1e-9)
    for angle in (np.nan, np.inf):
        with pytest.raises(sb.InputError, match="angle is"):
            field.turned(angle)


def mesh_normals(mesh: sb.Mesh) -> Floats:
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def test_rounding_does_not_choose_the_field() -> None:
    """By lengths instead of places all measures differ in their last digits: weights that are equal stay so."""
    mesh = rough(np.random.default_rng(235))
    moved = sb.Mesh(mesh.vertices, mesh.triangles, lengths=sides(mesh.vertices, mesh.triangles))
    one, other = (sb.direction_field(m, 4, strokes=[sb.SurfaceCurve(m, m.edges[0])]) for m in (mesh, moved))
    assert one.singularities == other.singularities
    np.testing.assert_allclose(np.remainder(4 * (one.angles - other.angles) + 1, 2 * np.pi), 1, atol=1e-6)

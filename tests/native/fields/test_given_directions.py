# SPDX-License-Identifier: MIT
"""Directions that are given in part: met where they are, smooth elsewhere, indices kept."""

from __future__ import annotations

import time

import numpy as np
import pytest
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes

Floats = NDArray[np.float64]
SYMMETRIES = (1, 2, 4)
SURFACES = {
    "sphere": meshes.subdivide(*meshes.icosphere(4)),
    "torus": meshes.torus(120, 50),
    "grid": meshes.grid(60, 40),
}


def off(field: sb.DirectionField, wanted: Floats) -> Floats:
    """Degrees between a field's angles and others, by its symmetry."""
    quantum = 2 * np.pi / field.symmetry
    difference = field.angles - wanted
    return np.asarray(np.degrees(np.abs(difference - quantum * np.round(difference / quantum))))


def painted(mesh: sb.Mesh, symmetry: int, seed: int) -> tuple[Floats, Floats]:
    """Directions (F, 3) as a painter might want them, and their angles: a field turned by up to 100 degrees, otherwise
    in each place.
    """
    rng = np.random.default_rng(seed)
    field = sb.direction_field(mesh, symmetry)
    centers = mesh.vertices[mesh.triangles].mean(axis=1)
    extent = np.ptp(mesh.vertices, axis=0).max()
    turn = 1.7 * np.sin(centers @ rng.normal(size=3) * 2 / extent + rng.uniform(0, 6))
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    up = np.cross(b - a, c - a)
    up /= np.linalg.norm(up, axis=1)[:, None]
    across = np.cross(up, field.vectors)
    return np.cos(turn)[:, None] * field.vectors + np.sin(turn)[:, None] * across, field.angles + turn


def chosen(mesh: sb.Mesh, share: float, is_scattered: bool, seed: int) -> NDArray[np.bool_]:
    """A share of the faces: any, or those in a dozen spots."""
    rng = np.random.default_rng(seed)
    if is_scattered:
        return np.asarray(rng.random(mesh.face_count) < share)
    centers = mesh.vertices[mesh.triangles].mean(axis=1)
    spots = centers[rng.choice(len(centers), 12)]
    distance = np.linalg.norm(centers[:, None] - spots, axis=2).min(axis=1)
    return np.asarray(distance <= np.quantile(distance, share))


@pytest.mark.parametrize("symmetry", SYMMETRIES)
@pytest.mark.parametrize("is_scattered", [True, False], ids=["scattered", "spots"])
@pytest.mark.parametrize("name", SURFACES)
def test_a_tenth_of_the_faces(name: str, is_scattered: bool, symmetry: int) -> None:
    """The measure: 3 degrees on the mean where directions are given, with the indices of the smoothest field kept."""
    mesh = sb.Mesh(*SURFACES[name])
    wanted, angles = painted(mesh, symmetry, 5)
    given = chosen(mesh, 0.1, is_scattered, 7)
    directions = np.where(given[:, None], wanted, 0)
    smooth = sb.direction_field(mesh, symmetry)
    loops = dict(enumerate(smooth.loop_indices.tolist()))
    free = sb.direction_field(mesh, symmetry, directions=directions)
    kept = sb.direction_field(mesh, symmetry, smooth.singularities, loop_indices=loops, directions=directions)
    for field in (free, kept):
        assert off(field, angles)[given].mean() < 3
        assert off(field, angles)[given].max() < 10
    assert kept.singularities == smooth.singularities
    assert kept.loop_indices.tolist() == smooth.loop_indices.tolist()


@pytest.mark.parametrize("symmetry", SYMMETRIES)
@pytest.mark.parametrize("name", SURFACES)
def test_a_turned_field_is_found_from_a_few_spots(name: str, symmetry: int) -> None:
    """Nothing is smoother than the smoothest field of these indices, turned evenly."""
    mesh = sb.Mesh(*SURFACES[name])
    smooth = sb.direction_field(mesh, symmetry)
    loops = dict(enumerate(smooth.loop_indices.tolist()))
    trivial = sb.direction_field(mesh, symmetry, smooth.singularities, loop_indices=loops)
    wanted = trivial.turned(0.6)
    some = np.where(chosen(mesh, 0.02, False, 3)[:, None], wanted.vectors, 0)
    found = sb.direction_field(mesh, symmetry, smooth.singularities, loop_indices=loops, directions=some)
    assert off(found, wanted.angles).max() < 1
    np.testing.assert_allclose((found.turns**2).sum(), (trivial.turns**2).sum(), rtol=1e-2, atol=1e-9)


@pytest.mark.parametrize("symmetry", SYMMETRIES)
def test_directions_of_vertices(symmetry: int) -> None:
    mesh = sb.Mesh(*SURFACES["sphere"])
    wanted = sb.direction_field(mesh, symmetry).turned(0.4)
    vectors = wanted.directions(np.arange(mesh.vertex_count, dtype=np.int32))
    found = sb.direction_field(mesh, symmetry, directions=vectors)
    assert off(found, wanted.angles).mean() < 1
    half = np.where((mesh.vertices[:, 0] > 0.3)[:, None], vectors, 0)
    faces = (mesh.vertices[mesh.triangles][:, :, 0] > 0.3).all(axis=1)
    assert off(sb.direction_field(mesh, symmetry, directions=half), wanted.angles)[faces].mean() < 1


def test_only_their_direction_along_the_surface_counts() -> None:
    mesh = sb.Mesh(*SURFACES["torus"])
    wanted, _ = painted(mesh, 2, 1)
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    up = np.cross(b - a, c - a)
    field = sb.direction_field(mesh, 2, directions=wanted)
    longer = sb.direction_field(mesh, 2, directions=1e200 * wanted + 1e199 * up / np.abs(up).max())
    shorter = sb.direction_field(mesh, 2, directions=-1e-200 * wanted)
    np.testing.assert_allclose(off(longer, field.angles), 0, atol=1e-6)
    np.testing.assert_allclose(off(shorter, field.angles), 0, atol=1e-6)


def test_weights_decide_and_zero_gives_nothing() -> None:
    mesh = sb.Mesh(*SURFACES["grid"])
    east = np.tile([1.0, 0, 0], (mesh.face_count, 1))
    left = mesh.vertices[mesh.triangles][:, :, 0].mean(axis=1) < np.median(mesh.vertices[:, 0])
    both = np.where(left[:, None], east, [0.0, 1, 0])
    only_left = sb.direction_field(mesh, 1, directions=both, weights=left.astype(float))
    np.testing.assert_allclose(only_left.vectors, east, atol=1e-5)
    nothing = sb.direction_field(mesh, 1, directions=both, weights=np.zeros(mesh.face_count))
    np.testing.assert_array_equal(nothing.angles, sb.direction_field(mesh, 1).angles)
    stroke = sb.SurfaceCurve(mesh, sb.trace(mesh, 0, 0.3, 0.8 * np.ptp(mesh.vertices[:, 0])).surface)
    means = []
    for weight in (1e-3, 1.0):
        mixed = sb.direction_field(mesh, 1, {}, [stroke], directions=both, weights=np.full(mesh.face_count, weight))
        means.append(np.degrees(np.arccos(np.clip((mixed.vectors * both).sum(axis=1), -1, 1))).mean())
    assert means[1] < means[0] / 2


@pytest.mark.parametrize(("weight", "singularities"), [(1e-300, None), (1e308, None), (1e308, {})])
def test_weights_of_any_size(weight: float, singularities: dict[int, float] | None) -> None:
    """Those beyond what single precision holds gave directions that nobody had asked for."""
    mesh = sb.Mesh(*meshes.grid(16, 12))
    wanted = np.tile([1.0, 1.0, 0.0], (mesh.face_count, 1))
    field = sb.direction_field(mesh, 2, singularities, directions=wanted, weights=np.full(mesh.face_count, weight))
    assert np.abs(field.vectors @ [1, 1, 0]).min() >= 0.999 * np.sqrt(2)


@pytest.mark.parametrize("weight", [1e-300, 1e308])
def test_strokes_and_alignment_of_any_weight(weight: float) -> None:
    mesh = sb.Mesh(*meshes.cylinder(24, 15, height=3.0))
    bent = sb.direction_field(mesh, 2, align="curvature", align_weight=weight)
    assert np.abs(bent.vectors[:, 2]).min() > 0.99
    grid = sb.Mesh(*meshes.grid(16, 12))
    first = np.flatnonzero(grid.vertices[:, 1] == grid.vertices[:, 1].min())
    stroke = sb.Stroke(sb.SurfaceCurve(grid, first[grid.vertices[first, 0].argsort()]), weight=weight)
    assert np.abs(sb.direction_field(grid, 2, strokes=[stroke]).vectors[:, 0]).min() > 0.99


def test_hard_strokes_are_met_all_the_same() -> None:
    mesh = sb.Mesh(*SURFACES["grid"])
    stroke = sb.SurfaceCurve(mesh, sb.trace(mesh, 0, 0.3, 0.8 * np.ptp(mesh.vertices[:, 0])).surface)
    north = np.tile([0.0, 1, 0], (mesh.face_count, 1))
    along = np.diff(stroke.points.positions(mesh), axis=0)
    for singularities in (None, {}):
        field = sb.direction_field(mesh, 1, singularities, [sb.Stroke(stroke, True)], directions=north)
        crossed = np.unique(np.asarray(sb.project(mesh, stroke.points.positions(mesh)[:-1] + along / 2).faces))
        unit = along.sum(axis=0) / np.linalg.norm(along.sum(axis=0))
        np.testing.assert_allclose(field.vectors[crossed], np.tile(unit, (len(crossed), 1)), atol=1e-6)


def test_an_editor_says_what_a_new_field_says() -> None:
    mesh = sb.Mesh(*SURFACES["torus"])
    wanted, _ = painted(mesh, 4, 3)
    editor = sb.DirectionFieldEditor(mesh, 4)
    editor.field({})
    first = editor.field({}, directions=wanted, weights=np.full(mesh.face_count, 0.5))
    again = sb.direction_field(mesh, 4, {}, directions=wanted, weights=np.full(mesh.face_count, 0.5))
    np.testing.assert_allclose(first.vectors, again.vectors, atol=1e-4)


def test_bad_directions_are_told() -> None:
    mesh = sb.Mesh(*meshes.grid(6, 6))
    flat = np.tile([1.0, 0, 0], (mesh.face_count, 1))
    up, lost = flat.copy(), flat.copy()
    up[4] = [0, 0, 2]
    lost[3, 1] = np.nan
    ones = np.ones(mesh.face_count)
    below, endless = ones.copy(), ones.copy()
    below[2], endless[5] = -1, np.inf
    counts = f"each of the {mesh.face_count} faces or of the {mesh.vertex_count} vertices"
    for message, arguments in {
        f"directions: wanted one for {counts}, got 7": (flat[:7], None),
        f"directions: wanted one for {counts}, got 0": (flat[:0], None),
        "directions: the one of face 3 is not finite": (lost, None),
        "directions: the one of face 4 has no direction within the face": (up, None),
        f"weights: wanted one for each of the {mesh.face_count} directions, got 3": (flat, ones[:3]),
        "weights: wanted finite numbers of 0 or more, got -1 for face 2": (flat, below),
        "weights: wanted finite numbers of 0 or more, got inf for face 5": (flat, endless),
        "weights: only together with directions": (None, ones),
        "directions": ("north", None),
    }.items():
        for symmetry, singularities in ((1, None), (4, {})):
            with pytest.raises(sb.InputError, match=message):
                sb.direction_field(mesh, symmetry, singularities, directions=arguments[0], weights=arguments[1])


@pytest.mark.parametrize("arrays", [meshes.grid(6, 6), meshes.icosphere(2)], ids=["flat", "curved"])
def test_directions_of_vertices_that_leave_the_surface_are_told(arrays: meshes.Arrays) -> None:
    """On a curved surface they have parts within the faces about them, which point to all sides."""
    mesh = sb.Mesh(*arrays)
    directions = np.zeros_like(mesh.vertices)
    directions[7] = 3 * sb.vertex_normals(*arrays)[7]
    for singularities in (None, {}):
        with pytest.raises(sb.InputError, match="directions: the one of vertex 7 has no direction along the surface"):
            sb.direction_field(mesh, 2, singularities, directions=directions)


def test_triangles_with_right_and_obtuse_angles_take_no_longer() -> None:
    """Over the longest edges of such triangles directions hardly turn: to the solver pairs of them are one."""
    vertices, triangles = meshes.grid(200, 200)
    sheared = vertices + np.outer(0.5 * np.sin(6 * vertices[:, 1]), [1, 0, 0])
    given = np.arange(len(triangles)) % 997 == 0

    def seconds(mesh: sb.Mesh) -> float:
        directions = np.where(given[:, None], mesh.vertices[triangles[:, 1]] - mesh.vertices[triangles[:, 0]], 0.0)
        begin = time.thread_time()
        sb.direction_field(mesh, 2, directions=directions, weights=given.astype(float))
        return time.thread_time() - begin

    plain, other = (min(seconds(sb.Mesh(places, triangles)) for _ in range(3)) for places in (vertices, sheared))
    assert other < 2 * plain  # with pairs that others had broken up it took three times as long


@pytest.mark.parametrize("symmetry", SYMMETRIES)
@pytest.mark.parametrize("around_tube", [1, -2])
def test_given_turns_around_handles_are_met(around_tube: int, symmetry: int) -> None:
    """Directions that turn around the tube, without singularities: the least turning around handles is another."""
    mesh = sb.Mesh(*SURFACES["torus"])
    x, y, z = mesh.vertices[mesh.triangles].mean(axis=1).T
    tube = np.arctan2(z, np.hypot(x, y) - np.hypot(*mesh.vertices[:, :2].T).mean())
    wanted = sb.direction_field(mesh, symmetry, {})
    angles = wanted.angles + around_tube * tube / symmetry
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    up = np.cross(b - a, c - a)
    across = np.cross(up / np.linalg.norm(up, axis=1)[:, None], wanted.vectors)
    turn = (angles - wanted.angles)[:, None]
    directions = np.cos(turn) * wanted.vectors + np.sin(turn) * across
    found = sb.direction_field(mesh, symmetry, {}, directions=directions)
    assert found.singularities == {}
    assert off(found, angles).max() < 3
    editor = sb.DirectionFieldEditor(mesh, symmetry)
    assert off(editor.field({}), wanted.angles).max() < 1e-9
    np.testing.assert_array_equal(editor.field({}, directions=directions).angles, found.angles)
    np.testing.assert_array_equal(editor.field({}).angles, wanted.angles)


@pytest.mark.parametrize("symmetry", SYMMETRIES)
@pytest.mark.parametrize("is_hard", [True, False], ids=["hard", "soft"])
def test_strokes_and_directions_that_agree_do_not_part(is_hard: bool, symmetry: int) -> None:
    """Of equal angles strokes took others than directions did: the field turned around between them."""
    mesh = sb.Mesh(*SURFACES["torus"])
    one, other = 1000, 4000
    singularities = {one: 1 / symmetry, other: -1 / symmetry}
    lines = [sb.trace(mesh, vertex, heading, 0.8).surface for vertex, heading in ((50, 0.4), (2500, 2.0), (5200, 4.5))]
    strokes = [sb.Stroke(sb.SurfaceCurve(mesh, line), is_hard) for line in lines]
    wanted = sb.direction_field(mesh, symmetry, singularities, strokes)
    some = np.where(chosen(mesh, 0.1, True, 3)[:, None], wanted.vectors, 0)
    found = sb.direction_field(mesh, symmetry, singularities, strokes, directions=some)
    assert found.singularities == singularities
    assert off(found, wanted.angles).mean() < 1
    assert (found.turns**2).sum() < 1.1 * (wanted.turns**2).sum()

# SPDX-License-Identifier: MIT
"""Truths about direction fields: turns and indices recounted from the vectors alone, and what fields go through."""

from __future__ import annotations

import numpy as np

import saddleback as sb
from tests.native.field_indices import index_sums, turns, twins
from tests.truth.lines_and_maps import Floats, Random
from tests.truth.registry import guards

UNTANGLED = 0.6 * np.pi  # a field that turns less across an edge, times its symmetry, is left as it is


def frames(mesh: sb.Mesh) -> tuple[Floats, Floats, Floats]:
    """Of each face: along its first edge, across that, and up."""
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    along, up = b - a, np.cross(b - a, c - a)
    along /= np.linalg.norm(along, axis=1)[:, None]
    up /= np.linalg.norm(up, axis=1)[:, None]
    return along, np.cross(up, along), up


def angles_of(mesh: sb.Mesh, vectors: Floats) -> Floats:
    along, across, _ = frames(mesh)
    return np.asarray(np.arctan2((vectors * across).sum(axis=1), (vectors * along).sum(axis=1)))


def between(a: Floats, b: Floats, symmetry: int) -> Floats:
    """The least angle between directions of that symmetry."""
    quantum = 2 * np.pi / symmetry
    return np.asarray(abs(a - b - quantum * np.round((a - b) / quantum)))


def is_usual(mesh: sb.Mesh) -> bool:
    """Whether faces are wide enough for their directions to be told from coordinates."""
    longest = np.linalg.norm(mesh.vertices[mesh.triangles] - np.roll(mesh.vertices[mesh.triangles], 1, axis=1), axis=2)
    heights = 2 * mesh.face_areas / longest.max(axis=1)
    return bool(heights.min() > 1e-9 * np.abs(mesh.vertices).max())


def characteristic(mesh: sb.Mesh, part: int) -> int:
    """Vertices less edges plus faces of a part."""
    faces = mesh.triangles[mesh.components[mesh.triangles[:, 0]] == part]
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    return len(np.unique(faces)) - len(np.unique(edges, axis=0)) + len(faces)


def assert_is_field(mesh: sb.Mesh, field: sb.DirectionField) -> None:
    """What holds for every field: unit vectors in the faces, angles that are theirs, turns that lead from one to the
    next, indices that are their sums, and sum to the Euler characteristic.
    """
    up = frames(mesh)[2]
    assert abs(np.linalg.norm(field.vectors, axis=1) - 1).max() < 1e-9
    assert abs((field.vectors * up).sum(axis=1)).max() < 1e-6
    assert between(angles_of(mesh, field.vectors), field.angles, 1).max() < 1e-6
    inside = twins(mesh.triangles) >= 0
    assert (field.turns[~inside] == 0).all()
    quantum = 2 * np.pi / field.symmetry
    steps = (field.turns - turns(mesh, field.vectors, field.symmetry)) / quantum
    assert abs(steps - np.round(steps)).max() < 1e-6, "turns do not lead from direction to direction"
    across = twins(mesh.triangles)
    assert abs(field.turns.ravel()[across[inside]] + field.turns[inside]).max(initial=0) < 1e-9
    assert abs(field.largest_turn - abs(field.turns).max()) < 1e-9
    sums = index_sums(mesh, field.vectors, field.symmetry)
    np.add.at(sums, np.roll(mesh.triangles, -1, axis=1), np.where(inside, np.round(steps) / field.symmetry, 0))
    border = mesh.boundary_vertices
    inner = np.setdiff1d(np.arange(mesh.vertex_count), border)
    told = {v: round(field.symmetry * x) / field.symmetry for v, x in zip(inner.tolist(), sums[inner], strict=True)}
    assert field.singularities == {v: index for v, index in told.items() if index}
    loops = np.array([sums[loop].sum() for loop in mesh.boundary_loops])
    np.testing.assert_allclose(field.loop_indices, loops, atol=1e-6)
    of_loop = [int(mesh.components[loop[0]]) for loop in mesh.boundary_loops]
    for part in range(mesh.component_count):
        total = sum(index for v, index in field.singularities.items() if mesh.components[v] == part)
        total += sum(x for x, p in zip(field.loop_indices, of_loop, strict=True) if p == part)
        assert abs(total - characteristic(mesh, part)) < 1e-6, f"indices of part {part} sum to {total}"


@guards("direction_field", "DirectionField")
def smooth_fields(mesh: sb.Mesh, rng: Random) -> None:
    """Smooth fields and given singularities: every turn and every index recounted from the vectors."""
    if not is_usual(mesh):
        return
    symmetry = int(rng.choice([1, 2, 4]))
    assert_is_field(mesh, sb.direction_field(mesh, symmetry))
    inner = np.setdiff1d(np.arange(mesh.vertex_count), mesh.boundary_vertices)
    wanted: dict[int, float] = {}
    for part in range(mesh.component_count):
        mine = inner[mesh.components[inner] == part]
        left = characteristic(mesh, part) * symmetry if (mesh.components[mesh.boundary_vertices] != part).all() else 0
        units = [int(np.sign(left))] * abs(left) + [1, -1] * int(rng.integers(0, 2))
        if len(mine) < len(units):
            return
        wanted |= {int(v): u / symmetry for v, u in zip(rng.permutation(mine), units, strict=False)}
    field = sb.direction_field(mesh, symmetry, wanted)
    assert field.singularities == wanted
    assert_is_field(mesh, field)


@guards("direction_field", "DirectionFieldEditor.field")
def given_in_part(mesh: sb.Mesh, rng: Random) -> None:
    """Directions of a field that was turned, given in some faces or all vertices: indices recounted from the vectors
    are those asked for; where all are given with great weights the field is the turned one. With indices that is to
    the hundredth of a turn across a face that rounds over faces leave, and unless it turns so fast that it would have
    to be untangled.
    """
    if not is_usual(mesh):
        return
    symmetry = int(rng.choice([1, 2, 4]))
    smooth = sb.direction_field(mesh, symmetry)
    turned = smooth.turned(float(rng.uniform(-7, 7)))
    loops = dict(enumerate(smooth.loop_indices.tolist()))
    some = np.where((rng.random(mesh.face_count) < rng.random())[:, None], turned.vectors, 0)
    field = sb.direction_field(mesh, symmetry, smooth.singularities, loop_indices=loops, directions=some)
    assert field.singularities == smooth.singularities
    assert_is_field(mesh, field)
    assert_is_field(mesh, sb.direction_field(mesh, symmetry, directions=some))
    weights = np.full(mesh.face_count, 1e9)
    for singularities, loop_indices in ((None, None), (smooth.singularities, loops)):
        found = sb.direction_field(
            mesh, symmetry, singularities, loop_indices=loop_indices, directions=turned.vectors, weights=weights
        )
        if singularities is None or smooth.largest_turn < UNTANGLED / symmetry:
            most = 1e-6 if singularities is None else 0.03
            assert between(found.angles, turned.angles, symmetry).max() < most


@guards("DirectionField.from_vectors", "DirectionField.from_turns", "DirectionField.turned")
def made_of_numbers(mesh: sb.Mesh, rng: Random) -> None:
    """A field of vectors has their directions in the faces and turns the nearer way; one of turns is the same to the
    bit; one that was turned has all angles larger by as much and the same turns.
    """
    if not is_usual(mesh):
        return
    symmetry = int(rng.choice([1, 2, 4]))
    vectors = rng.normal(size=(mesh.face_count, 3)) * 10.0 ** rng.uniform(-6, 6, (mesh.face_count, 1))
    along, across, up = frames(mesh)
    flat = vectors - (vectors * up).sum(axis=1)[:, None] * up
    vectors = np.where((np.linalg.norm(flat, axis=1) > 0.05 * np.linalg.norm(vectors, axis=1))[:, None], vectors, along)
    field = sb.DirectionField.from_vectors(mesh, vectors, symmetry)
    assert field.symmetry == symmetry
    assert_is_field(mesh, field)
    assert between(field.angles, angles_of(mesh, vectors), symmetry).max() < 1e-6
    assert field.largest_turn <= np.pi / symmetry * (1 + 1e-9)
    again = sb.DirectionField.from_turns(mesh, field.angles, field.turns, symmetry)
    for name in ("vectors", "angles", "turns", "loop_indices"):
        assert getattr(again, name).tobytes() == getattr(field, name).tobytes(), name
    assert again.singularities == field.singularities
    angle = float(rng.uniform(-7, 7))
    turned = field.turned(angle)
    there = np.cos(field.angles + angle)[:, None] * along + np.sin(field.angles + angle)[:, None] * across
    np.testing.assert_allclose(turned.vectors, there, atol=1e-6)
    np.testing.assert_allclose(turned.turns, field.turns, atol=1e-9)
    assert turned.singularities == field.singularities
    bad = field.turns.copy()
    bad[tuple(rng.integers(0, bad.shape))] += 0.5
    try:
        sb.DirectionField.from_turns(mesh, field.angles, bad, symmetry)
    except sb.InputError:
        return
    raise AssertionError("turns that do not fit made a field")


@guards("DirectionField.directions")
def directions_at_points(mesh: sb.Mesh, rng: Random) -> None:
    """Unit vectors in the planes of the points' faces; the face's own at its center; the same from both sides of an
    edge.
    """
    if not is_usual(mesh):
        return
    symmetry = int(rng.choice([1, 2, 4]))
    field = sb.direction_field(mesh, symmetry)
    up = frames(mesh)[2]
    points = sb.sample(mesh, 10, seed=int(rng.integers(1 << 30)))
    found = field.directions(points)
    assert abs(np.linalg.norm(found, axis=1) - 1).max() < 1e-9
    assert abs((found * up[points.faces]).sum(axis=1)).max() < 1e-6
    centers = sb.SurfacePoints(np.arange(mesh.face_count), np.full((mesh.face_count, 3), 1 / 3))
    assert between(angles_of(mesh, field.directions(centers)), field.angles, symmetry).max() < 1e-6
    twin = twins(mesh.triangles).ravel()
    sides = rng.permutation(np.flatnonzero(twin >= 0))[:10]
    if len(sides) == 0:
        return
    share = rng.uniform(0.2, 0.8, len(sides))
    here, there = np.zeros((len(sides), 3)), np.zeros((len(sides), 3))
    rows, other = np.arange(len(sides)), twin[sides]
    here[rows, sides % 3], here[rows, (sides + 1) % 3] = 1 - share, share
    there[rows, other % 3], there[rows, (other + 1) % 3] = share, 1 - share
    edge = (
        mesh.vertices[np.roll(mesh.triangles, -1, axis=1).ravel()[sides]] - mesh.vertices[mesh.triangles.ravel()[sides]]
    )
    edge /= np.linalg.norm(edge, axis=1)[:, None]
    told = []
    for faces, weights in ((sides // 3, here), (other // 3, there)):
        vectors = field.directions(sb.SurfacePoints(faces, weights))
        left = np.cross(up[faces], edge)
        told.append(np.arctan2((vectors * left).sum(axis=1), (vectors * edge).sum(axis=1)))
    assert between(*told, symmetry).max() < 1e-5, "another direction beyond an edge"


@guards("DirectionFieldEditor", "DirectionFieldEditor.field", "Stroke")
def edited_fields(mesh: sb.Mesh, rng: Random) -> None:
    """An editor's field is the function's; a hard stroke is met in every face that it crosses; the editor forgets it
    afterwards.
    """
    if not is_usual(mesh):
        return
    symmetry = int(rng.choice([1, 2, 4]))
    editor = sb.DirectionFieldEditor(mesh, symmetry)
    plain = sb.direction_field(mesh, symmetry)
    assert between(editor.field().angles, plain.angles, symmetry).max() < 1e-3
    start = sb.sample(mesh, 1, seed=int(rng.integers(1 << 30)))
    line = sb.trace(mesh, start, float(rng.uniform(0, 7)), float(mesh.mean_edge_length))
    if line.length < 1e-3 * mesh.mean_edge_length:
        return
    weight = float(rng.uniform(0.1, 5))
    stroke = sb.Stroke(sb.SurfaceCurve(mesh, line.surface), True, weight)
    assert stroke.hard
    assert stroke.weight == weight
    field = editor.field(strokes=[stroke])
    assert_is_field(mesh, field)
    along, across, _ = frames(mesh)
    for k, piece in enumerate(np.diff(line.points, axis=0)):
        touched = [mesh.triangles[line.surface.faces[i]][line.surface.barycentric[i] > 1e-9] for i in (k, k + 1)]
        faces = np.flatnonzero(np.isin(mesh.triangles, np.concatenate(touched)).sum(axis=1) == 3)
        if np.linalg.norm(piece) < 1e-3 * line.length or len(faces) != 1:
            continue  # too short for a direction, or along an edge
        wanted = np.arctan2(across[faces] @ piece, along[faces] @ piece)
        assert between(wanted, field.angles[faces], symmetry)[0] < 1e-4, f"not met in face {faces[0]}"
    assert between(editor.field().angles, plain.angles, symmetry).max() < 1e-3

# SPDX-License-Identifier: MIT
"""Streamlines: curves that follow the field inside faces, and say why they end."""

from __future__ import annotations

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_progress_and_cancel
from tests.native.fields.test_direction_field import fine
from tests.native.shapes.test_distribution import opposite_turns


def circles_of_latitude(level: int) -> tuple[sb.Mesh, sb.DirectionField]:
    """A sphere with a singularity at either pole, and the field that runs around it."""
    mesh = sb.Mesh(*meshes.icosphere(level))
    poles = mesh.vertices[:, 2].argsort()[[0, -1]]
    field = sb.direction_field(mesh, 1, {int(v): 1 for v in poles})
    center = mesh.vertices[mesh.triangles[0]].mean(axis=0)
    east = np.cross([0, 0, 1.0], center)
    angle = np.arctan2(np.cross(field.vectors[0], east) @ center / np.linalg.norm(center), field.vectors[0] @ east)
    return mesh, field.turned(float(angle))


def test_a_constant_field_gives_straight_lines() -> None:
    mesh = sb.Mesh(*meshes.grid(15, 15, 0.3))
    field = sb.direction_field(mesh, 1, {}).turned(0.4)
    start = sb.SurfacePoints([200], [[0.2, 0.5, 0.3]])
    line = sb.streamline(mesh, field, start, 0.3)
    along = line.points - line.points[0]
    assert np.abs(along - np.outer(along @ field.vectors[0], field.vectors[0])).max() < 1e-6
    assert line.length == pytest.approx(0.3, abs=1e-6) and line.end_reason == "length" and line.start == 0
    assert np.abs(np.linalg.norm(np.diff(line.points, axis=0), axis=1).sum() - line.length) < 1e-12


def test_lines_along_the_edges_of_a_grid() -> None:
    mesh = sb.Mesh(*meshes.grid(12, 12))
    stroke = sb.SurfaceCurve(mesh, [13, 14])
    field = sb.direction_field(mesh, 1, {}, [stroke])
    line = sb.streamline(mesh, field, 66 + 2, 5.0)
    assert line.end_reason == "boundary"
    assert np.abs(line.points[:, 1:] - line.points[0, 1:]).max() < 1e-5 and line.points[-1, 0] == pytest.approx(1)


def test_circles_of_latitude_close() -> None:
    gaps = []
    for level in (3, 4, 5):
        mesh, field = circles_of_latitude(level)
        start = sb.project(mesh, [[np.cos(0.5), 0, np.sin(0.5)]])
        line = sb.streamline(mesh, field, start, 2 * np.pi * np.cos(0.5))
        gaps.append(np.abs(line.points[:, 2] - line.points[0, 2]).max())
    assert gaps[2] < 0.01 and gaps[2] < gaps[0] / 2


def test_they_are_curves_on_the_surface() -> None:
    mesh = fine(meshes.torus(50, 20))
    field = sb.direction_field(mesh, 2, {50: 0.5, 300: 0.5, 700: -1})
    for vertex in (10, 400, 901):
        line = sb.streamline(mesh, field, vertex, 4.0, True)
        curve = sb.SurfaceCurve(mesh, line.surface)
        assert curve.length == pytest.approx(line.length, rel=1e-9)
        assert np.allclose(line.surface.positions(mesh), line.points)


def test_both_sides_meet_at_the_start() -> None:
    mesh, field = circles_of_latitude(5)
    for start in (sb.SurfacePoints([77], [[0.3, 0.3, 0.4]]), 200):
        both = sb.streamline(mesh, field, start, 1.0, True)
        ahead = sb.streamline(mesh, field, start, 0.5)
        assert np.array_equal(both.points[both.start :], ahead.points)
        before, after = np.diff(both.points, axis=0)[both.start - 1 : both.start + 1]
        assert before @ after / np.linalg.norm(before) / np.linalg.norm(after) > 0.99
        assert both.length == pytest.approx(1.0, rel=1e-3)


def test_every_direction_of_a_cross_field_can_be_followed() -> None:
    mesh = sb.Mesh(*meshes.grid(15, 15, 0.2))
    field = sb.direction_field(mesh, 4, {})
    for start in (sb.SurfacePoints([150], [[0.2, 0.5, 0.3]]), 7 * 15 + 7):
        for heading in ([1, 0.2, 0], [0.1, -1, 0], [-1, 0, 0], [0, 1, 0.0]):
            line = sb.streamline(mesh, field, start, 0.3, True, heading=heading)
            direction = (line.points[-1] - line.points[0]) / 0.3
            assert direction @ heading > 0.9 and line.end_reason == line.begin_reason == "length"


def test_why_they_end() -> None:
    mesh = sb.Mesh(*meshes.icosphere(4))
    field = sb.direction_field(mesh, 1, {0: 1, 3: 1})
    line = sb.streamline(mesh, field, 1000, 20.0, True)
    if {line.begin_reason, line.end_reason} == {"singularity"}:
        assert {tuple(line.points[0]), tuple(line.points[-1])} == {tuple(v) for v in mesh.vertices[[0, 3]]}
    alone = sb.streamline(mesh, field, 0, 1.0)
    assert len(alone.points) == 1 and alone.end_reason == "singularity" and alone.length == 0
    square = sb.Mesh(*meshes.grid())
    across = sb.direction_field(square, 1, {}, [sb.SurfaceCurve(square, [14, 15])])
    line = sb.streamline(square, across, 66, 3.0, True)
    assert line.end_reason == line.begin_reason == "boundary" and line.length == pytest.approx(1, abs=1e-4)
    outwards = sb.streamline(square, across, 71, 1.0)
    assert outwards.end_reason == "boundary" and outwards.length < 1e-6


def test_a_source_and_a_sink_are_reached() -> None:
    mesh, field = circles_of_latitude(4)
    line = sb.streamline(mesh, field.turned(np.pi / 2), 1000, 20.0, True)
    assert line.end_reason == line.begin_reason == "singularity"
    np.testing.assert_allclose(np.abs(line.points[[0, -1], 2]), 1)
    assert line.length == pytest.approx(np.pi, rel=0.01)


def test_limited_curvature() -> None:
    mesh = sb.Mesh(*meshes.grid(60, 60, 0.2))
    field = sb.direction_field(mesh, 1, {30 * 60 + 30: 1})
    radius = 0.2
    for vertex in (20 * 60 + 30, 35 * 60 + 20, 40 * 60 + 45):
        line = sb.streamline(mesh, field, vertex, 0.4, True, max_curvature=1 / radius)
        pieces = np.diff(line.points, axis=0)
        keep = np.linalg.norm(pieces, axis=1) > 1e-7
        heading = np.unwrap(np.arctan2(pieces[keep, 1], pieces[keep, 0]))
        along = np.concatenate([[0], np.cumsum(np.linalg.norm(pieces[keep], axis=1))])
        middle = (along[1:] + along[:-1]) / 2
        # Over any stretch, not only from piece to piece.
        turned = np.abs(heading[:, None] - heading[None, :])
        apart = np.abs(middle[:, None] - middle[None, :])
        longest = np.diff(along).max()
        assert (turned <= (apart + longest) / radius + 1e-5).all()
    free = sb.streamline(mesh, field, 30 * 60 + 26, 0.4)
    stiff = sb.streamline(mesh, field, 30 * 60 + 26, 0.4, max_curvature=1e-3)
    chords = [np.linalg.norm(line.points[-1] - line.points[0]) / line.length for line in (free, stiff)]
    assert chords[1] > 0.9999


@pytest.mark.parametrize("turns", [0, 1, 10])
def test_fields_that_turn_far_within_a_face_are_followed(turns) -> None:
    mesh = sb.Mesh(*meshes.grid(8, 8))
    field = sb.direction_field(mesh, 1, {42: 1})
    field = sb.DirectionField.from_turns(mesh, field.angles, field.turns + opposite_turns(mesh, 2 * np.pi * turns))
    for face in range(5, len(mesh.triangles), 9):
        line = sb.streamline(mesh, field, sb.SurfacePoints([face], [[0.3, 0.3, 0.4]]), 0.3)
        pieces = np.diff(line.points, axis=0)
        lengths = np.linalg.norm(pieces, axis=1)
        assert line.end_reason != "length" or lengths.sum() == pytest.approx(0.3, rel=0.01)
        middles = sb.project(mesh, (line.points[1:] + line.points[:-1]) / 2)
        along = (pieces * field.directions(middles)).sum(axis=1)
        assert along.sum() > 0.98 * lengths.sum()


@pytest.mark.parametrize("height", [1.0, 1e-3, 1e-6])
def test_slivers_take_no_more_steps_than_other_faces(height) -> None:
    vertices, triangles = meshes.grid(10, 10)
    mesh = sb.Mesh(vertices * [1, height, 1], triangles)
    field = sb.direction_field(mesh, 1, {}, [sb.SurfaceCurve(mesh, [50, 51])])
    line = sb.streamline(mesh, field, sb.SurfacePoints([99], [[0.3, 0.3, 0.4]]), 0.3)
    assert line.end_reason == "length" and line.length == pytest.approx(0.3) and len(line.points) < 200


def test_long_curves_tell_how_far_they_are_and_can_be_cancelled() -> None:
    mesh = sb.Mesh(*meshes.torus(50, 20))
    field, job = sb.direction_field(mesh, 1, {}), sb.Job()
    start = sb.SurfacePoints([30], [[0.3, 0.3, 0.4]])
    sb.streamline(mesh, field, start, 5.0, True, job=job)
    assert job.fraction == 1
    check_progress_and_cancel(lambda job: sb.streamline(mesh, field, start, 20_000.0, job=job), 0.05)


def test_bad_input_is_told() -> None:
    mesh, other = sb.Mesh(*meshes.grid(6, 6)), sb.Mesh(*meshes.grid(6, 6))
    field = sb.direction_field(mesh, 1, {})
    for message, call in {
        "length is 0": lambda: sb.streamline(mesh, field, 7, 0),
        "length is nan": lambda: sb.streamline(mesh, field, 7, np.nan),
        "length is inf": lambda: sb.streamline(mesh, field, 7, np.inf),
        "max_curvature is -1": lambda: sb.streamline(mesh, field, 7, 1, max_curvature=-1),
        "field: it belongs to another mesh": lambda: sb.streamline(other, field, 7, 1),
        "field: wanted a DirectionField": lambda: sb.streamline(mesh, 3, 7, 1),
        "vertex 99 at": lambda: sb.streamline(mesh, field, 99, 1),
        "start: wanted one point, got 2": lambda: sb.streamline(mesh, field, [1, 2], 1),
        "heading: wanted shape": lambda: sb.streamline(mesh, field, 7, 1, heading=[1, 2]),
        "heading: a direction must be finite": lambda: sb.streamline(mesh, field, 7, 1, heading=[np.nan, 0, 0]),
        "direction": lambda: sb.streamline(
            mesh, field, sb.SurfacePoints([3], [[0.3, 0.3, 0.4]]), 1, heading=[0, 0, 1.0]
        ),
    }.items():
        with pytest.raises(sb.InputError, match=message):
            call()

# SPDX-License-Identifier: MIT
"""Maps along curves: a straight strip, a circle, a bent stroke on a solid, and curves that are refused."""

from __future__ import annotations

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.truth.ways import flipped, overlapping

GRID = sb.Mesh(*meshes.grid(21, 21))


def circle(radius: float, count: int = 48) -> sb.SurfaceCurve:
    """A closed polygon about the middle of the grid, straight from corner to corner."""
    turn = np.linspace(0, 2 * np.pi, count, endpoint=False)
    places = np.column_stack([0.5 + radius * np.cos(turn), 0.5 + radius * np.sin(turn), np.zeros(count)])
    points = sb.project(GRID, places)
    ways = [sb.ExactField(GRID, points[i]).path(points[(i + 1) % count]).surface for i in range(count)]
    faces, weights = (np.concatenate([getattr(way, name) for way in ways])[:-1] for name in ("faces", "barycentric"))
    return sb.SurfaceCurve(GRID, sb.SurfacePoints(faces, weights), closed=True)


def test_a_straight_strip_is_nearly_the_plane_itself():
    row = np.arange(21 * 10 + 4, 21 * 10 + 17, dtype=np.int32)
    found = sb.stroke_map(GRID, row, 0.17)
    np.testing.assert_allclose(found.uv[:, 1], found.vertices[:, 1] - 0.5, atol=1e-5)
    # Weights of edges that are not Delaunay are raised, which moves vertices along the curve by some of an edge.
    np.testing.assert_allclose(found.uv[:, 0], found.vertices[:, 0] - 0.2, atol=0.1 * 0.17)
    assert found.area == pytest.approx(0.6 * 0.34, rel=1e-3)
    assert found.coverage == pytest.approx(1, abs=1e-3)
    assert found.length == pytest.approx(0.6)
    assert flipped(found) == overlapping(found) == 0


def test_distances_at_the_radius_are_those_beside_ends_and_about_bends():
    """Where edges are cut at the radius, whose ends see past an end of the curve or round a bend."""
    points = sb.project(GRID, np.array([[0.31, 0.42, 0], [0.53, 0.44, 0], [0.5, 0.72, 0]]))
    there, back = (sb.ExactField(GRID, points[i]).path(points[i + 1]).surface for i in range(2))
    radius, places = 0.21, points.positions(GRID)[:, :2]
    straight = sb.stroke_map(GRID, sb.SurfaceCurve(GRID, there), radius)
    along, offset = places[1] - places[0], straight.vertices[:, :2] - places[0]
    across = (along[0] * offset[:, 1] - along[1] * offset[:, 0]) / np.hypot(*along)
    np.testing.assert_allclose(straight.uv[:, 1], across, atol=1e-12)
    both = (np.concatenate([getattr(way, name) for way in (there, back)]) for name in ("faces", "barycentric"))
    bent = sb.stroke_map(GRID, sb.SurfaceCurve(GRID, sb.SurfacePoints(*both)), radius)
    offset = bent.vertices[:, :2] - places[1]
    turn = np.arctan2(offset[:, 1], offset[:, 0])
    # Edges are a third of the radius long at most: in these directions both of their ends see the bend.
    about_it = (bent.uv[:, 1] == -radius) & (turn > -1.4 + 1 / 3) & (turn < 0.1 - 1 / 3)
    assert about_it.sum() > 5
    np.testing.assert_allclose(np.hypot(*offset[about_it].T), radius, rtol=1e-12)


@pytest.mark.parametrize("radius", [0.05, 0.2])
def test_a_circle_is_cut_open_and_its_left_is_within(radius: float):
    found = sb.stroke_map(GRID, circle(0.25), radius)
    assert flipped(found) == overlapping(found) == 0
    assert found.coverage > 0.99
    from_center = np.hypot(*(found.vertices[:, :2] - 0.5).T)
    # Corners and sides of the polygon differ by 6e-4, chords of the sheet's edges by as much again.
    np.testing.assert_allclose(found.uv[:, 1], 0.25 - from_center, atol=0.02 * radius + 1e-3)
    turn = np.arctan2(*(found.vertices[:, :2] - 0.5).T[::-1]) % (2 * np.pi)
    inner = (turn > 0.3) & (turn < 6.0) & (np.abs(found.uv[:, 1]) < 0.1)
    # As above: by .028 of the length at most.
    np.testing.assert_allclose(found.uv[inner, 0] / found.length, turn[inner] / (2 * np.pi), atol=0.03)


def test_a_stroke_that_bends_on_a_solid():
    mesh = sb.Mesh(*meshes.icosphere(3))
    graph = sb.SaddleVertexGraph(mesh)
    there, back = graph.path(0, 40).surface, graph.path(40, 7).surface
    curve = sb.SurfaceCurve(
        mesh,
        sb.SurfacePoints(
            np.concatenate([there.faces, back.faces]), np.concatenate([there.barycentric, back.barycentric])
        ),
    )
    for radius in (0.05, 0.3, 5.0):
        found = sb.stroke_map(mesh, curve, radius)
        assert flipped(found) == overlapping(found) == 0
        assert found.coverage > 0.95
        assert np.array_equal(np.unique(found.triangles), np.arange(len(found.vertices)))
        np.testing.assert_allclose(found.points.positions(mesh), found.vertices, atol=1e-9)


def test_needles_side_by_side_become_ladders():
    mesh = sb.Mesh(*meshes.cylinder(120, 2, height=50.0))
    way = sb.ExactField(mesh, 3).path(120 + 70).surface
    radius = 1.5
    found = sb.stroke_map(mesh, sb.SurfaceCurve(mesh, way), radius)
    assert flipped(found) == overlapping(found) == 0
    assert found.coverage > 0.99
    # Rungs at either end of the parts of each edge, which are at least half as long as wanted.
    least = mesh.edge_count * 50 / (radius / 3)
    assert len(found.triangles) < 2.5 * least


LARGE_FACES = sb.Mesh(*meshes.grid(6, 6))


def across_large_faces() -> sb.SurfaceCurve:
    points = sb.project(LARGE_FACES, np.array([[0.13, 0.22, 0], [0.87, 0.71, 0]]))
    return sb.SurfaceCurve(LARGE_FACES, sb.ExactField(LARGE_FACES, points[0]).path(points[1]).surface)


@pytest.mark.parametrize("radius", [1e-2, 1e-3])
def test_a_narrow_band_on_large_faces_has_triangles_by_its_length_alone(radius: float):
    curve = across_large_faces()
    found = sb.stroke_map(LARGE_FACES, curve, radius)
    assert flipped(found) == 0
    assert found.coverage > 0.9999
    assert len(found.triangles) < 125 * curve.length / radius


def test_a_radius_that_takes_too_many_triangles_is_told_with_the_least_that_works():
    curve = across_large_faces()
    with pytest.raises(sb.InputError, match=r"radius: 2e-05 .* 5547029 triangles, of 1000000 at most") as told:
        sb.stroke_map(LARGE_FACES, curve, 2e-5)
    job = sb.Job()
    job.cancel()
    with pytest.raises(sb.Cancelled):
        sb.stroke_map(LARGE_FACES, curve, float(str(told.value).rsplit(" ", 1)[1]), job=job)


def test_no_map_between_parts_of_the_curve_that_come_near_to_each_other():
    """A stroke that turns back beside itself: each part has its half of the wedge between, no triangle has both."""
    corners = np.array([[0.1, 0.5, 0], [0.9, 0.503, 0], [0.15, 0.52, 0]])
    points = sb.project(GRID, corners)
    ways = [sb.ExactField(GRID, points[i]).path(points[i + 1]).surface for i in range(2)]
    faces, weights = (np.concatenate([getattr(way, name) for way in ways]) for name in ("faces", "barycentric"))
    found = sb.stroke_map(GRID, sb.SurfaceCurve(GRID, sb.SurfacePoints(faces, weights)), 0.1)
    assert flipped(found) == overlapping(found) == 0
    assert np.isfinite(found.uv).all()
    assert np.ptp(found.uv[found.triangles, 0], axis=1).max() < 0.2 * found.length
    assert found.coverage > 0.95


@pytest.mark.parametrize("radius", [0.0, -1.0, np.inf, np.nan])
def test_a_radius_that_is_none(radius: float):
    with pytest.raises(sb.InputError, match="radius: wanted a finite distance above 0"):
        sb.stroke_map(GRID, [0, 1], radius)


def test_a_curve_that_crosses_itself_is_told_where():
    corners = np.array([[0.2, 0.21, 0], [0.8, 0.8, 0], [0.8, 0.2, 0], [0.2, 0.8, 0]])
    points = sb.project(GRID, corners)
    ways = [sb.ExactField(GRID, points[i]).path(points[i + 1]).surface for i in range(3)]
    faces, weights = (np.concatenate([getattr(way, name) for way in ways]) for name in ("faces", "barycentric"))
    curve = sb.SurfaceCurve(GRID, sb.SurfacePoints(faces, weights))
    with pytest.raises(
        sb.InputError, match=r"curve: it crosses or touches itself at \(0\.497\d*, 0\.502\d*, 0\); give"
    ):
        sb.stroke_map(GRID, curve, 0.1)


def test_a_curve_of_another_mesh():
    other = sb.Mesh(*meshes.grid(4, 4))
    with pytest.raises(sb.InputError, match="curve: it lies on another mesh"):
        sb.stroke_map(GRID, sb.SurfaceCurve(other, [0, 1]), 0.1)

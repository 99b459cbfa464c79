# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances from curves and their isolines; exact ones."""

import meshes_of_core as shapes
import numpy as np
import pytest

from saddleback_blender.core import runs
from saddleback_blender.core.cache import Cache
from saddleback_blender.core.fields.curve_points import places_along
from saddleback_blender.core.requests import DistanceRequest, Polyline, Surface
from saddleback_blender.core.settings import DistanceSettings


def distance(surface, sources, cache=None, **settings):
    request = DistanceRequest(surface, DistanceSettings(**settings), sources)
    return runs.distance(request, runs.new_progress(), cache or Cache(2**30))


def test_places_along_a_curve_are_close_and_keep_its_corners():
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [1, 0, 0], [1, 0.05, 0]])
    places = places_along(Polyline(corners, False), 0.1)
    assert np.linalg.norm(np.diff(places, axis=0), axis=1).max() <= 0.1 + 1e-12
    for corner in corners:
        assert (places == corner).all(axis=1).any()
    ring = places_along(Polyline(corners, True), 0.1)
    assert len(ring) > len(places) and np.linalg.norm(ring[-1] - corners[0]) <= 0.1 + 1e-12
    assert len(places_along(Polyline(corners[1:3], False), 0.1)) >= 1  # no length at all


@pytest.mark.parametrize("quality", ["NORMAL", "EXACT"])
def test_distance_to_a_curve_and_not_to_its_points(quality):
    """A straight line across a plane, given by its ends alone, above the surface."""
    surface = shapes.grid(20)
    line = Polyline(np.array([[-0.2, 0.33, 0.5], [1.3, 0.33, 0.5]]), False)
    values = distance(surface, (line,), quality=quality).vertex_distance
    np.testing.assert_allclose(values, np.abs(surface.vertices[:, 1] - 0.33), atol=5e-3)


def test_a_curve_is_the_same_for_exact_distances():
    """A line through the air above a ditch leaps from wall to wall; the little way between is joined for both."""
    surface = shapes.grid(40)
    places = np.column_stack([surface.vertices[:, :2], 0.3 * np.abs(surface.vertices[:, 0] - 0.5)])
    surface = Surface("Ditch", places, surface.triangles, len(places))
    line = (Polyline(np.array([[0.1, 0.52, 0.25], [0.9, 0.52, 0.25]]), False),)
    exact = distance(surface, line, quality="EXACT").vertex_distance
    near = distance(surface, line, quality="FINE").vertex_distance
    np.testing.assert_allclose(near, exact, rtol=2e-3, atol=1 / 40 / 16)


def test_several_curves_and_closed_ones():
    surface = shapes.grid(24)
    turn = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    ring = np.column_stack([0.5 + 0.3 * np.cos(turn), 0.5 + 0.3 * np.sin(turn), 0 * turn])
    corner = Polyline(np.array([[0.0, 0, 0], [0.0, 0.01, 0]]), False)
    values = distance(surface, (Polyline(ring, True), corner)).vertex_distance
    radius = np.linalg.norm(surface.vertices[:, :2] - 0.5, axis=1)
    exact = np.minimum(np.abs(radius - 0.3), np.linalg.norm(surface.vertices, axis=1))
    np.testing.assert_allclose(values, exact, atol=0.012)


def test_exact_distances_are_exact_and_need_no_graph():
    cache, surface = Cache(2**30), shapes.grid(20, loose=2)
    values = distance(surface, np.array([2, 200], np.int32), cache, quality="EXACT", limit=0.5).vertex_distance
    places = surface.vertices
    exact = np.minimum(*(np.linalg.norm(places - places[v], axis=1) for v in (0, 198)))
    assert np.isinf(values[:2]).all()
    near = exact <= 0.5 - 1e-9
    np.testing.assert_allclose(values[2:][near], exact[near], atol=1e-12)
    assert np.isinf(values[2:][exact > 0.5 + 1e-9]).all()
    assert cache.builds == {"mesh": 1, "distance": 1}
    distance(surface, np.array([2, 200], np.int32), cache, limit=0.5)
    assert cache.builds == {"mesh": 1, "graph": 1, "distance": 2}


def test_a_neighborhood_stands_for_the_quality():
    cache, surface = Cache(2**30), shapes.grid(10)
    for quality in ("EXACT", "FAST"):
        distance(surface, np.array([0], np.int32), cache, k=30, quality=quality)
    assert cache.builds == {"mesh": 1, "graph": 1, "distance": 1}
    for quality in ("FAST", "NORMAL", "FINE"):
        distance(surface, np.array([0], np.int32), cache, quality=quality)
    assert cache.builds == {"mesh": 1, "graph": 4, "distance": 4}


def test_isolines_of_a_run():
    surface = shapes.grid(30)
    assert distance(surface, np.array([0], np.int32)).isolines is None
    found = distance(surface, np.array([0], np.int32), make_isolines=True, isolines_by="SPACING", isoline_spacing=0.25)
    assert found.isolines.level.tolist() == [0.25, 0.5, 0.75, 1.0, 1.25]
    radius = np.linalg.norm(found.isolines.points, axis=1)
    np.testing.assert_allclose(radius, np.repeat(found.isolines.level, np.diff(found.isolines.offsets)), atol=0.01)
    few = distance(surface, np.array([0], np.int32), make_isolines=True, isoline_count=3)
    assert len(few.isolines.level) == 3

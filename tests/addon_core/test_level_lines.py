# SPDX-License-Identifier: GPL-3.0-or-later
"""Isolines: on the level to rounding, whole, with the higher side on their left."""

import numpy as np
import pytest

from saddleback_blender.core import native, runs
from saddleback_blender.core.cache import Cache
from saddleback_blender.core.errors import BadInputError
from saddleback_blender.core.requests import DistanceRequest, Surface
from saddleback_blender.core.settings import DistanceSettings
from saddleback_blender.core.solids.level_lines import MOST_LEVELS, isoline_levels, isoline_spacing, level_lines
from saddleback_blender.core.surfaces.halved_edges import HalvedEdges
from tests import meshes


def lines_of(found):
    return [found.points[part] for part, _ in found.lines()]


def value_at(vertices, triangles, values, points, faces):
    """The field at points of faces."""
    a, b, c = (vertices[triangles[faces, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    area = np.einsum("ij,ij->i", normal, normal)
    u, v = (
        np.einsum("ij,ij->i", np.cross(*pair), normal) / area
        for pair in ((b - points, c - points), (c - points, a - points))
    )
    return (np.stack([u, v, 1 - u - v], axis=1) * values[triangles[faces]]).sum(axis=1)


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_points_lie_on_their_level_and_lines_are_whole(case):
    rng = np.random.default_rng(4)
    direction = rng.normal(size=3)
    values = case.vertices @ direction + 0.05 * rng.normal(size=len(case.vertices))
    levels = np.quantile(values, [0.1, 0.35, 0.5, 0.8])
    found = level_lines(case.vertices, case.triangles, values, levels)
    assert len(found.closed) == len(found.level) == len(found.offsets) - 1 > 0
    level = np.repeat(found.level, np.diff(found.offsets))
    at = value_at(case.vertices, case.triangles, values, found.points, found.faces)
    np.testing.assert_allclose(at, level, atol=1e-9 * np.abs(values).max())
    on_border = np.zeros(len(case.vertices), bool)
    sides = np.sort(np.concatenate([case.triangles[:, [0, 1]], case.triangles[:, [1, 2]], case.triangles[:, [2, 0]]]))
    edges, count = np.unique(sides, axis=0, return_counts=True)
    on_border[edges[count == 1].ravel()] = True
    for points, closed in zip(lines_of(found), found.closed, strict=True):
        assert (np.linalg.norm(np.diff(points, axis=0), axis=1) > 0).all()
        if not on_border.any():
            assert closed


def crossings(values, triangles, level):
    """Triangles that the level crosses, by the definition."""
    above = values[triangles] > level
    return int((above.any(axis=1) & ~above.all(axis=1)).sum())


@pytest.mark.parametrize("seed", range(5))
def test_every_triangle_that_is_crossed_is_crossed_once(seed):
    vertices, triangles = meshes.torus()
    values = np.random.default_rng(seed).normal(size=len(vertices))
    found = level_lines(vertices, triangles, values, np.array([0.1]))
    pieces = sum(len(points) - (not closed) for points, closed in zip(lines_of(found), found.closed, strict=True))
    assert pieces == crossings(values, triangles, 0.1)


def test_circles_on_a_plane_turn_round_the_higher_side():
    vertices, triangles = meshes.grid(40, 40)
    middle = vertices.mean(axis=0)
    values = -np.linalg.norm(vertices - middle, axis=1)  # highest in the middle
    found = level_lines(vertices, triangles, values, np.array([-0.3, -0.2, -0.1]) * np.ptp(vertices[:, 0]))
    assert found.closed.tolist() == [True] * 3
    for points, level in zip(lines_of(found), found.level, strict=True):
        radius = np.linalg.norm(points - middle, axis=1)
        np.testing.assert_allclose(radius, -level, rtol=0.03)
        x, y = (points - middle)[:, :2].T
        assert (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2 == pytest.approx(np.pi * level**2, rel=0.03)


def test_levels_through_vertices_and_plateaus():
    vertices, triangles = meshes.grid(6, 6)
    values = np.round(vertices[:, 0] / np.ptp(vertices[:, 0]) * 5)  # whole numbers, columns of equal ones
    found = level_lines(vertices, triangles, values, np.array([0.0, 1.0, 2.5, 5.0]))
    assert found.level.tolist() == [0.0, 1.0, 2.5]  # nothing is above the highest
    for points, level in zip(lines_of(found), found.level, strict=True):
        np.testing.assert_allclose(points[:, 0], level / 5 * np.ptp(vertices[:, 0]), atol=1e-12)
        assert np.ptp(points[:, 1]) == pytest.approx(np.ptp(vertices[:, 1]))


def test_nothing_where_nothing_is_reached():
    vertices, triangles = meshes.grid(8, 8)
    values = vertices[:, 0].copy()
    values[values > 0.5 * values.max()] = np.inf
    found = level_lines(vertices, triangles, values, np.array([0.3, 0.7]) * vertices[:, 0].max())
    assert len(found.level) == 1
    assert len(level_lines(vertices, triangles, np.full(len(vertices), np.inf), np.array([1.0])).closed) == 0
    assert len(level_lines(vertices, triangles, values, np.empty(0)).points) == 0


def test_levels():
    by_count = DistanceSettings(isoline_count=4)
    np.testing.assert_allclose(isoline_levels(by_count, 5.0, "A"), [1, 2, 3, 4])
    assert isoline_spacing(by_count, 5.0) == 1.0
    by_spacing = DistanceSettings(isolines_by="SPACING", isoline_spacing=0.5)
    np.testing.assert_allclose(isoline_levels(by_spacing, 1.7, "A"), [0.5, 1, 1.5])
    np.testing.assert_allclose(isoline_levels(by_spacing, 1.5, "A"), [0.5, 1])  # the farthest point is no line
    assert len(isoline_levels(by_spacing, 0.0, "A")) == len(isoline_levels(by_spacing, 0.4, "A")) == 0
    with pytest.raises(BadInputError, match=r"'A': isolines every 0.5 up to 1e\+04 would be more than 2,000 lines"):
        isoline_levels(by_spacing, 1e4, "A")
    assert len(isoline_levels(by_spacing, 0.5 * MOST_LEVELS, "A")) == MOST_LEVELS - 1


@pytest.mark.parametrize("quality", ["EXACT", "FAST"])
def test_circles_on_a_face_that_is_wide_beside_their_spacing(quality):
    """A square of two triangles, and a source at its middle, as far from all vertices: there were no lines at all."""
    corners = np.array([(-1.0, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
    surface = Surface("Plate", corners, np.array([(0, 1, 2), (0, 2, 3)], np.int32), 4)
    settings = DistanceSettings(quality=quality, make_isolines=True, isolines_by="COUNT", isoline_count=9)
    request = DistanceRequest(surface, settings, np.zeros((1, 3)))
    result = runs.distance(request, runs.new_progress(), Cache(2**20))
    assert result.vertex_distance == pytest.approx(2**0.5, rel=5e-3)
    lines = result.isolines
    assert len(set(lines.level)) == 9
    for (part, is_closed), level in zip(lines.lines(), lines.level, strict=True):
        assert np.linalg.norm(lines.points[part], axis=1) == pytest.approx(level, abs=0.02)
        assert is_closed == (level < 1.0)


def test_halved_edges_are_where_they_are_said_to_be():
    vertices, triangles = meshes.icosphere(1)
    halved = HalvedEdges.of(vertices, triangles, 2)
    assert len(halved.triangles) == 16 * len(triangles) and (halved.vertices[: len(vertices)] == vertices).all()
    corners = vertices[triangles[halved.faces]]
    assert np.allclose(np.einsum("vi,vij->vj", halved.barycentric, corners), halved.vertices)
    mesh = native.load().Mesh(halved.vertices, halved.triangles)  # every edge between two triangles
    assert mesh.genus == 0 and not len(mesh.boundary_loops)
    assert mesh.area == pytest.approx(native.load().Mesh(vertices, triangles).area)

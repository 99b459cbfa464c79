# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities that are computed: from curvature, from curves, from a few painted places; and colors of images."""

import meshes_of_core as shapes
import numpy as np
import pytest

from saddleback_blender.core import runs
from saddleback_blender.core.cache import Cache
from saddleback_blender.core.errors import BadInputError
from saddleback_blender.core.fields.image_colors import colors_at, to_linear
from saddleback_blender.core.requests import (
    CurvatureDensity,
    DistanceDensity,
    Polyline,
    SpreadDensity,
    Surface,
    TessellateRequest,
)
from saddleback_blender.core.settings import TessellateSettings
from tests import meshes


def density(surface, recipe, **settings):
    request = TessellateRequest(surface, TessellateSettings(count=5, iterations=0, **settings), recipe)
    return runs.tessellate(request, runs.new_progress(), Cache(2**28)).vertex_density


def edge_line():
    return Polyline(np.array([[0.0, 0.0, 0.1], [0.0, 1.0, 0.1]]), False)


def test_a_density_about_a_curve_falls_with_the_distance():
    surface = shapes.grid(20, loose=2)
    found = density(surface, DistanceDensity((edge_line(),)), density_reach=0.5, density_beyond=0.25)
    x = surface.vertices[:, 0]
    assert len(found) == surface.vertex_count and not found[:2].any()
    share = np.minimum(x / 0.5, 1)
    np.testing.assert_allclose(found[2:], 1 - 0.75 * share**2 * (3 - 2 * share), atol=0.01)
    turned = density(
        surface, DistanceDensity((edge_line(),)), density_reach=0.5, density_beyond=0.25, density_invert=True,
        density_contrast=2.0,
    )  # fmt: skip
    np.testing.assert_allclose(turned[2:], (1 - found[2:]) ** 2, atol=1e-12)


def test_a_density_spread_from_painted_places_meets_them():
    surface = shapes.grid(12, loose=1)
    left, right = 1 + np.flatnonzero(surface.vertices[:, 0] == 0), 1 + np.flatnonzero(surface.vertices[:, 0] == 1)
    vertices = np.concatenate([left, right]).astype(np.int32)
    values = np.concatenate([np.full(len(left), 0.2), np.full(len(right), 1.0)])
    found = density(surface, SpreadDensity(vertices, values, "vertex group 'Few'"))
    np.testing.assert_allclose(found[1:], 0.2 + 0.8 * surface.vertices[:, 0], atol=0.01)
    few = density(surface, SpreadDensity(vertices[[0, -1]], values[[0, -1]], "vertex group 'Few'"))
    np.testing.assert_allclose(few[vertices[[0, -1]]], [0.2, 1.0], atol=1e-6)
    with pytest.raises(BadInputError, match="no vertex of a face is painted in vertex group 'Few'"):
        density(surface, SpreadDensity(np.array([0], np.int32), np.ones(1), "vertex group 'Few'"))
    with pytest.raises(BadInputError, match="what spreads from vertex group 'Few' is zero everywhere"):
        density(surface, SpreadDensity(vertices, np.zeros(len(vertices)), "vertex group 'Few'"))


def test_a_density_by_curvature_is_high_at_the_thin_end():
    vertices, triangles = meshes.icosphere(3)
    vertices = vertices * np.where(vertices[:, :1] > 0, [4.0, 1.0, 1.0], 1.0)
    found = density(Surface("Drop", vertices, triangles, len(vertices)), CurvatureDensity())
    assert found[vertices[:, 0].argmax()] > 3 * np.median(found) and (found > 0).all()


def test_colors_of_an_image_are_mixed_from_four_pixels():
    pixels = np.zeros((2, 4, 4), np.float32)
    pixels[:, :, 0] = [0.0, 0.2, 0.4, 0.6]
    pixels[1, :, 1] = 1.0
    pixels[:, :, 3] = 0.5
    places = np.array([(0.125, 0.25), (0.25, 0.25), (0.25, 0.5), (1.0, 0.75)])
    found = colors_at(pixels, places, False)
    np.testing.assert_allclose(found[:, 0], [0, 0.1, 0.1, 0.3], atol=1e-7)
    np.testing.assert_allclose(found[:, 1], [0, 0, 0.5, 1], atol=1e-7)
    np.testing.assert_allclose(colors_at(pixels, places, True)[3, 1:], [1, 0, 0.5], atol=1e-7)
    assert to_linear(np.array(0.5)) == pytest.approx(0.21404, abs=1e-5)

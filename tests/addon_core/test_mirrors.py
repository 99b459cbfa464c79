# SPDX-License-Identifier: GPL-3.0-or-later
"""Both sides of surfaces whose vertices are several at one place."""

import numpy as np
import pytest

from saddleback_blender.core.requests import Surface
from saddleback_blender.core.surfaces.mirrors import Mirror
from tests import meshes


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("side_strips", [False, True])
def test_vertices_of_seams_that_are_not_joined_have_partners_of_their_own(seed, side_strips):
    """All but the last at each place got no values on the mirrored side: as after imports, which split UV seams."""
    vertices, triangles = meshes.grid(9, 9)
    vertices = vertices - vertices.mean(axis=0)
    middle = vertices[triangles].mean(axis=1)
    part = np.digitize(middle[:, 1], [-0.25, 0.25])
    if side_strips:
        part += 3 * (np.abs(middle[:, 0]) > 0.25)
    numbers, corners = np.unique(part[:, None] * len(vertices) + triangles, return_inverse=True)
    order = np.random.default_rng(seed).permutation(len(numbers)).astype(np.int32)
    places, home = np.empty((len(numbers), 3)), np.empty(len(numbers), np.int64)
    places[order], home[order] = vertices[numbers % len(vertices)], numbers // len(vertices)
    whole = Surface("Split", places, order[corners.reshape(-1, 3)], len(places))
    assert len(places) > len(vertices)
    mirror = Mirror.of(whole, whole, places, np.eye(3))
    partner = mirror.partner
    assert np.array_equal(partner[partner], np.arange(len(places)))
    np.testing.assert_allclose(places[partner], places * [-1, 1, 1], atol=1e-12)
    assert np.array_equal(home[partner], home)
    values = np.where(places[:, 0] >= -1e-9, home + np.abs(places[:, 0]), np.nan)
    assert mirror.spread(values) == pytest.approx(home + np.abs(places[:, 0]))

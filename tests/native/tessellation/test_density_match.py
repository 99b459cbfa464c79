# SPDX-License-Identifier: MIT
"""How well copies follow a density: exact shares, the law of large numbers, and copies that ignore it."""

from __future__ import annotations

import numpy as np
import pytest

import saddleback as sb
from saddleback.density_match import equal_areas
from tests import meshes


def copies(points: sb.SurfacePoints) -> sb.Placements:
    n = len(points)
    return sb.Placements(np.zeros(n, int), points, np.zeros(n), np.ones(n))


@pytest.mark.parametrize("cells", [2, 7, 200])
def test_the_parts_are_equally_large(cells: int) -> None:
    mesh = sb.Mesh(*meshes.icosphere(5))
    labels = equal_areas(mesh, cells)
    a, b, c = mesh.vertices[mesh.triangles].transpose(1, 0, 2)
    areas = np.bincount(labels, 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1))
    assert len(areas) == cells and np.abs(areas / areas.mean() - 1).max() < 0.06


def test_copies_that_follow_a_ramp_and_copies_that_do_not() -> None:
    mesh = sb.Mesh(*meshes.grid(60, 60))
    ramp = 1 + 7 * mesh.vertices[:, 0]
    follows = sb.density_match(mesh, copies(sb.sample(mesh, 20_000, ramp, seed=1)), ramp)
    assert follows.correlation > 0.95 and follows.found.sum() == 20_000
    assert follows.wanted.sum() == pytest.approx(20_000)
    even = copies(sb.sample(mesh, 20_000, seed=1))
    assert abs(sb.density_match(mesh, even, ramp).correlation) < 0.3
    assert sb.density_match(mesh, even, ramp.max() - ramp).correlation < 0.3
    assert np.isnan(sb.density_match(mesh, even, np.ones(len(ramp))).correlation)


def test_parts_that_large_faces_leave_without_any_do_not_count() -> None:
    """Beside a face that has nearly all of the area there are no faces for its share of the parts."""
    count = 12
    vertices = [(0, 0, 0), (0, 1, 0), *((100 + 0.01 * i, i % 2, 0) for i in range(count))]
    strip = [(i, i + 1, i + 2) if i % 2 == 0 else (i + 1, i, i + 2) for i in range(count)]
    mesh = sb.Mesh(vertices, strip)
    ramp = 1 + mesh.vertices[:, 0]
    match = sb.density_match(mesh, copies(sb.sample(mesh, 2000, ramp)), ramp, 6)
    assert match.correlation > 0.99 and match.found.sum() == 2000


def test_areas_are_those_of_the_mesh_and_only_ratios_count() -> None:
    mesh = sb.Mesh(*meshes.grid(40, 40))
    wide = mesh.vertices * [1, 1, 0]
    wide[:, 0] += 9 * np.maximum(wide[:, 0] - wide[:, 0].mean(), 0)
    wide = sb.Mesh(wide, mesh.triangles)
    own = sb.Mesh(mesh.vertices, mesh.triangles, lengths=wide.edge_lengths)
    even = copies(sb.sample(own, 4000, seed=2))
    halves = sb.density_match(own, even, np.full(own.vertex_count, 1e308), 2)
    np.testing.assert_allclose(halves.wanted, 2000, rtol=0.1)
    np.testing.assert_allclose(halves.found, 2000, rtol=0.1)


def test_bad_input() -> None:
    mesh = sb.Mesh(*meshes.grid())
    one = copies(sb.SurfacePoints([3], [[1, 0, 0]]))
    for density, message in ((np.ones(3), "wanted 144 values"), (np.zeros(144), "not all zero")):
        with pytest.raises(sb.InputError, match=message):
            sb.density_match(mesh, one, density)
    with pytest.raises(sb.InputError, match="cells is 1"):
        sb.density_match(mesh, one, np.ones(144), 1)
    with pytest.raises(sb.InputError, match="placements: the center of 0 lies in face 500"):
        sb.density_match(mesh, copies(sb.SurfacePoints([500], [[1, 0, 0]])), np.ones(144))

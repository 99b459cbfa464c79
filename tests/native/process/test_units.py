# SPDX-License-Identifier: MIT
"""Every function of lengths at units of a millionth to a million: the same answers, but for rounding.

Powers of two are equal to the bit, see `tests/truth/units.py`, whose questions are asked here.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.truth import units

UNITS = [1e-6, 1e-3, 1e3, 1e6]


def rough_torus() -> meshes.Arrays:
    vertices, triangles = meshes.torus(24, 11)
    return vertices + 0.02 * np.random.default_rng(1).normal(size=vertices.shape), triangles


def rough_sheet() -> meshes.Arrays:
    vertices, triangles = meshes.grid(14, 11, 0.3)
    vertices[:, 2] = 0.1 * np.random.default_rng(2).random(len(vertices))
    return vertices, triangles


ON_MESHES = [units.distances_of, units.cells_of, units.surface_of, units.repaired, units.fields_of]


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("ask", ON_MESHES)
@pytest.mark.parametrize("arrays", [rough_torus(), rough_sheet()], ids=["torus", "sheet"])
def test_on_meshes(arrays: meshes.Arrays, ask: Callable[[sb.Mesh, float, int], units.Answer], unit: float) -> None:
    vertices, triangles = arrays
    units.assert_scales(ask.__name__, lambda u: ask(sb.Mesh(u * vertices, triangles), u, 5), unit, 1e-6)


@pytest.mark.parametrize("unit", UNITS)
def test_in_the_plane(unit: float) -> None:
    rng = np.random.default_rng(3)
    sites, weights = rng.random((40, 2)), 0.1 * rng.random(40)
    square = np.array([(0, 0), (1, 0), (1, 1), (0, 1.0)])
    units.assert_scales("the plane", lambda u: units.plane_of(u * sites, u * weights, [u * square], u, 5), unit, 1e-9)


@pytest.mark.parametrize("unit", UNITS)
def test_shapes(unit: float) -> None:
    """What is laid, copies and proof: those of the unit 1."""
    mesh, rng = sb.Mesh(*rough_sheet()), np.random.default_rng(4)
    shapes = [sb.Shape.star(5), sb.Shape.leaf(), sb.Shape.crescent()]
    middle = np.flatnonzero((abs(mesh.vertices[mesh.triangles].mean(axis=1)[:, :2] - 0.5) < 0.3).all(axis=1))
    centers = sb.SurfacePoints(rng.choice(middle, 3, replace=False).astype(np.int32), np.full((3, 3), 1 / 3))
    poses = sb.Placements([0, 1, 2], centers, [0.1, 1.0, 2.0], [0.03, 0.04, 0.05])
    units.assert_scales("shapes", lambda u: units.shapes_of(mesh, shapes, poses, u, 5, "random"), unit, 1e-6)
    units.assert_scales("shapes of the plane", lambda u: units.shapes_in_the_plane(shapes[0], shapes[1], u), unit, 1e-6)

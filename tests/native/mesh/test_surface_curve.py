# SPDX-License-Identifier: MIT
"""Curves on the surface: what traces and boundaries give is one, what leaves the surface is not."""

from __future__ import annotations

import numpy as np
import pytest

import saddleback as sb
from tests import meshes


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_traces_are_curves_of_their_own_length(case: meshes.Case) -> None:
    rng = np.random.default_rng(0)
    mesh = case.mesh
    for _ in range(30):
        start = sb.SurfacePoints([rng.integers(mesh.face_count)], [rng.dirichlet([1, 1, 1])])
        path = sb.trace(mesh, start, rng.uniform(0, 2 * np.pi), rng.uniform(0.1, 2))
        curve = sb.SurfaceCurve(mesh, path.surface)
        assert curve.length == pytest.approx(path.length, rel=1e-12)
        assert len(curve) == len(path.surface)


@pytest.mark.parametrize("case", meshes.boundary(), ids=str)
def test_boundary_loops_are_closed_curves(case: meshes.Case) -> None:
    for loop in case.mesh.boundary_loops:
        ring = case.mesh.vertices[loop]
        curve = sb.SurfaceCurve(case.mesh, loop, closed=True)
        assert curve.closed
        assert curve.length == pytest.approx(np.linalg.norm(ring - np.roll(ring, -1, axis=0), axis=1).sum(), rel=1e-12)


@pytest.mark.parametrize("first", [0, 1, 2])
def test_short_sides_of_needles_are_as_long_as_they_are(first: int) -> None:
    corners = np.roll([(-0.3, -0.2, 0.4), (-0.3 + 3e-8, -0.2 - 1e-8, 0.4 + 2e-8), (0.2, 0.3, 0.5)], first, axis=0)
    mesh = sb.Mesh(corners, [(0, 1, 2)])
    for edge in ((0, 1), (1, 2), (2, 0)):
        length = np.linalg.norm(corners[edge[1]] - corners[edge[0]])
        assert sb.SurfaceCurve(mesh, edge).length == pytest.approx(length, rel=1e-15, abs=0)


def test_points_of_a_shared_edge_or_vertex_need_not_be_given_in_the_same_face() -> None:
    mesh = sb.Mesh(*meshes.grid(4, 4))
    face = mesh.triangles.tolist()
    first, second = face[0], face[1]  # (0, 1, 5) and (0, 5, 4): they share the edge 0-5
    points = sb.SurfacePoints([0, 0, 1], [[0.2, 0.6, 0.2], [0.5, 0.0, 0.5], [0.2, 0.2, 0.6]])
    assert first[0] == second[0] and first[2] == second[1]
    assert sb.SurfaceCurve(mesh, points).length > 0
    nearly = sb.SurfacePoints([0, 0, 1], [[0.2, 0.6, 0.2], [0.5, 5e-7, 0.5 - 5e-7], [0.2, 0.2, 0.6]])
    assert sb.SurfaceCurve(mesh, nearly).length == pytest.approx(sb.SurfaceCurve(mesh, points).length, rel=1e-5)


def test_what_is_no_curve_is_refused() -> None:
    mesh = sb.Mesh(*meshes.grid(6, 6))
    with pytest.raises(sb.InputError, match="at least two points, got 1"):
        sb.SurfaceCurve(mesh, [3])
    with pytest.raises(sb.InputError, match="no length"):
        sb.SurfaceCurve(mesh, [3, 3, 3])
    with pytest.raises(sb.InputError, match=r"points 1 \(face \d+\) and 2 \(face \d+\) share no face"):
        sb.SurfaceCurve(mesh, [0, 1, 30])
    with pytest.raises(sb.InputError, match=r"points 2 .* and 0 .* share no face"):
        sb.SurfaceCurve(mesh, [0, 1, 2], closed=True)
    with pytest.raises(sb.InputError, match="points: vertex 36 at"):
        sb.SurfaceCurve(mesh, [0, 36])
    with pytest.raises(sb.InputError, match="points: point 1 has face 99"):
        sb.SurfaceCurve(mesh, sb.SurfacePoints([0, 99], [[1, 0, 0], [0, 1, 0]]))

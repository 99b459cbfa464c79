# SPDX-License-Identifier: MIT
"""Feature curves: every sharp, border or chosen edge once, cut at corners; a remesh keeps them."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes


def vertices_of(mesh: sb.Mesh, curve: sb.SurfaceCurve) -> list[int]:
    """The vertices through which a curve runs."""
    corner = np.argmax(curve.points.barycentric, axis=1)
    assert (curve.points.barycentric.max(axis=1) == 1).all()
    return [int(v) for v in mesh.triangles[curve.points.faces, corner]]


def edges_of(mesh: sb.Mesh, curves: list[sb.SurfaceCurve]) -> list[frozenset[int]]:
    """All edges on which the curves run."""
    edges = []
    for curve in curves:
        chain = vertices_of(mesh, curve)
        edges += [frozenset(pair) for pair in pairwise([*chain, chain[0]] if curve.closed else chain)]
    return edges


def creases(mesh: sb.Mesh, angle: float) -> set[frozenset[int]]:
    """Edges whose faces' unit normals differ by more than an angle, or that have one face."""
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    beside: dict[frozenset[int], list[int]] = {}
    for face, triangle in enumerate(mesh.triangles.tolist()):
        for pair in pairwise([*triangle, triangle[0]]):
            beside.setdefault(frozenset(pair), []).append(face)
    return {
        edge
        for edge, faces in beside.items()
        if len(faces) == 1 or math.acos(np.clip(normals[faces[0]] @ normals[faces[1]], -1, 1)) > angle
    }


def box(size: int) -> sb.Mesh:
    """A cube of many triangles."""
    arrays = meshes.cube()
    for _ in range(size):
        arrays = meshes.subdivide(*arrays)
    return sb.Mesh(*arrays)


def test_the_edges_of_a_cube() -> None:
    mesh = box(3)
    curves = sb.feature_curves(mesh)
    assert len(curves) == 12
    assert not any(curve.closed for curve in curves)
    lengths = [curve.length for curve in curves]
    side = np.ptp(mesh.vertices[:, 0])
    np.testing.assert_allclose(lengths, side, rtol=1e-12)
    ends = {vertices_of(mesh, curve)[i] for curve in curves for i in (0, -1)}
    assert len(ends) == 8


@pytest.mark.parametrize("case", meshes.good(), ids=lambda case: case.name)
@pytest.mark.parametrize("angle", [0.1, 0.7, math.pi])
def test_every_feature_edge_once(case: meshes.Case, angle: float) -> None:
    mesh = sb.Mesh(case.vertices, case.triangles)
    found = edges_of(mesh, sb.feature_curves(mesh, angle))
    assert len(set(found)) == len(found)
    assert set(found) == creases(mesh, angle)


def test_lines_end_where_they_turn_and_are_closed_elsewhere() -> None:
    tube = sb.Mesh(*meshes.cylinder(24, 9))
    rims = sb.feature_curves(tube)
    assert [curve.closed for curve in rims] == [True, True]
    assert [curve.closed for curve in sb.feature_curves(tube, corner_angle=0.2)] == [False] * 48
    square = sb.Mesh(*meshes.grid(9, 9))
    sides = sb.feature_curves(square)
    assert len(sides) == 4
    assert not any(curve.closed for curve in sides)
    (round_it,) = sb.feature_curves(square, corner_angle=math.pi)
    assert round_it.closed
    assert sb.feature_curves(square, boundary=False) == []


def test_chosen_edges() -> None:
    mesh = sb.Mesh(*meshes.torus(36, 14))
    ring = np.flatnonzero(np.linalg.norm(mesh.vertices[:, :2], axis=1) > 1.35 - 1e-9)
    ring = ring[np.argsort(np.arctan2(mesh.vertices[ring, 1], mesh.vertices[ring, 0]))]
    edges = np.stack([ring, np.roll(ring, -1)], axis=1)
    (whole,) = sb.feature_curves(mesh, math.pi, edges=edges)
    assert whole.closed
    assert set(vertices_of(mesh, whole)) == set(ring.tolist())
    (part,) = sb.feature_curves(mesh, math.pi, edges=edges[3:6])
    assert not part.closed
    assert len(part) == 4
    assert sb.feature_curves(mesh, math.pi, edges=np.empty((0, 2), np.int32)) == []


def test_short_lines_are_left_out() -> None:
    """A box with a dent of one vertex in a face: the edges about the dent are many, and short in all."""
    vertices, triangles = box(4).vertices.copy(), box(4).triangles
    top = np.append(vertices[:, :2].mean(axis=0), vertices[:, 2].max())
    dent = int(np.linalg.norm(vertices - top, axis=1).argmin())
    vertices[dent, 2] -= 0.1 * np.ptp(vertices[:, 2])
    mesh = sb.Mesh(vertices, triangles)
    every, few = sb.feature_curves(mesh), sb.feature_curves(mesh, least_length=2.0 * np.ptp(vertices[:, 2]))
    assert len(every) > len(few) == 12
    assert sb.feature_curves(mesh, least_length=1e9) == []
    around = np.flatnonzero((triangles == dent).any(axis=1))[:1]
    edge = [[dent, int(next(v for v in triangles[around[0]] if v != dent))]]
    (kept,) = sb.feature_curves(mesh, least_length=1e9, edges=edge)
    assert set(vertices_of(mesh, kept)) == set(edge[0])
    assert len(sb.feature_curves(sb.Mesh(*meshes.grid(9, 9)), least_length=1e9)) == 4, "the border stays"


def test_a_remesh_of_a_box_keeps_its_edges() -> None:
    """The dual's edges along the box's are chords of straight lines: volume and area are the box's."""
    mesh = box(4)
    graph = sb.SaddleVertexGraph(mesh, k=40)
    curves = sb.feature_curves(mesh)
    relaxed = sb.centroidal_voronoi(graph, count=400, curves=curves, max_iterations=15)
    dual = relaxed.cells.dual()
    remesh = sb.Mesh(dual.vertices, dual.triangles)
    assert volume(remesh.vertices, remesh.triangles) == pytest.approx(volume(mesh.vertices, mesh.triangles), rel=1e-9)
    assert remesh.area == pytest.approx(mesh.area, rel=1e-9)
    assert len(sb.feature_curves(remesh)) == 12
    plain = sb.centroidal_voronoi(graph, count=400, max_iterations=15).cells.dual()
    assert volume(plain.vertices, plain.triangles) < 0.99 * volume(mesh.vertices, mesh.triangles)


def test_corners_within_a_cell_are_one() -> None:
    """A line along a grid's edges that turns at each vertex, in cells of several edges: each turn ends a curve."""
    mesh = sb.Mesh(*meshes.grid(31, 31))
    step = mesh.edge_lengths.min()
    line = [np.array([8 + (i + 1) // 2, 8 + i // 2]) * step for i in range(29)]
    ends = [int(np.linalg.norm(mesh.vertices[:, :2] - place, axis=1).argmin()) for place in line]
    curves = sb.feature_curves(mesh, math.pi, boundary=False, edges=list(pairwise(ends)))
    assert len(curves) == 28
    cells = sb.centroidal_voronoi(sb.SaddleVertexGraph(mesh, k=30), count=40, curves=curves, max_iterations=10).cells
    assert cells.dual().issues == []
    places = cells.sites.positions(mesh)
    held = places[np.linalg.norm(places[:, None] - mesh.vertices[ends], axis=2).min(axis=1) < 1e-9]
    gaps = np.linalg.norm(held[:, None] - held, axis=2)[~np.eye(len(held), dtype=bool)]
    assert 2 <= len(held) < 28
    assert gaps.min() > 0.3 * math.sqrt(mesh.area / 40)


def volume(vertices: NDArray[np.float64], triangles: NDArray[np.int32]) -> float:
    """What a closed mesh encloses."""
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"angle": -0.1}, "angle: wanted radians from 0 to pi, got -0.1"),
        ({"angle": math.nan}, "angle: wanted radians"),
        ({"angle": "sharp"}, "angle"),
        ({"corner_angle": 4.0}, "corner_angle: wanted radians from 0 to pi, got 4"),
        ({"least_length": -1.0}, "least_length: wanted a finite length of 0 or more, got -1"),
        ({"least_length": math.inf}, "least_length: wanted a finite length of 0 or more, got inf"),
        ({"edges": [[0, 99]]}, "edges: wanted vertices from 0 to 7, got 99 in edge 0"),
        ({"edges": [[0, 0]]}, "no edge of the mesh joins vertices 0 and 0 of edge 0"),
        ({"edges": [0, 1]}, "edges: wanted shape"),
    ],
)
def test_bad_arguments(arguments: dict[str, object], words: str) -> None:
    with pytest.raises(sb.InputError, match=words):
        sb.feature_curves(sb.Mesh(*meshes.cube()), **arguments)

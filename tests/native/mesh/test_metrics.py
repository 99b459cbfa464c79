# SPDX-License-Identifier: MIT
"""Lengths of a mesh's own: what is refused and how, and that they travel. Their truths: tests.truth.surfaces.py."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.truth.surfaces import sides

VERTICES, TRIANGLES = meshes.icosphere(1)
LENGTHS = sides(VERTICES, TRIANGLES)


def changed(face: int, side: int, value: float) -> np.ndarray:
    lengths = LENGTHS.copy()
    lengths[face, side] = value
    return lengths


def elsewhere() -> sb.Mesh:
    places = np.random.default_rng(0).normal(size=VERTICES.shape)
    return sb.Mesh(places, TRIANGLES, lengths=LENGTHS)


@pytest.mark.parametrize(
    ("lengths", "error", "says"),
    [
        (LENGTHS[:-1], sb.InputError, r"lengths: wanted shape \(80, 3\) or \(edges,\) of real numbers, got \(79, 3\)"),
        (LENGTHS[:, :2], sb.InputError, r"lengths: wanted shape .* got \(80, 2\)"),
        (np.ones(7), sb.InputError, "lengths: wanted one for each of the 120 edges or of the 240 sides .* got 7"),
        ([], sb.InputError, "lengths: wanted one for each of the 120 edges .* got 0"),
        ("long", sb.InputError, "lengths: .* got a str"),
        (
            changed(3, 1, np.nan),
            sb.MeshError,
            r"1 length is not finite and positive: face 3 has nan from vertex",
        ),
        (changed(3, 1, -1), sb.MeshError, "1 length is not finite and positive: face 3 has -1 from"),
        (changed(3, 1, 1e70), sb.MeshError, "1 length is beyond 1e60: face 3 has"),
        (changed(3, 1, 0.5), sb.MeshError, r"1 edge has two lengths: face \d+ has .* from .* but face \d+ has"),
        (np.tile([1.0, 1.0, 2.0], (80, 1)), sb.MeshError, "edges have two lengths|faces have lengths of no triangle"),
    ],
)
def test_lengths_of_no_metric_are_refused(lengths, error, says):
    with pytest.raises(error, match=says):
        sb.Mesh(VERTICES, TRIANGLES, lengths=lengths)


def test_the_first_face_whose_sides_do_not_meet_is_named():
    with pytest.raises(sb.MeshError, match=r"1 face has lengths of no triangle: face 0 \(0, 1, 2\) has 1, 1, 2; each"):
        sb.Mesh(np.eye(3), [(0, 1, 2)], lengths=[1, 1, 2])
    with pytest.raises(sb.MeshError, match="1 face has lengths of no triangle"):
        sb.Mesh(np.eye(3), [(0, 1, 2)], lengths=[[1, 5, 1]])


@pytest.mark.parametrize("dimension", [4, 7])
def test_coordinates_beyond_three_are_checked(dimension):
    places = np.random.default_rng(1).normal(size=(len(VERTICES), dimension))
    places[5, dimension - 1] = np.inf
    with pytest.raises(sb.MeshError, match=r"1 vertex is not finite: vertex 5 \(.*, inf\)"):
        sb.Mesh(places, TRIANGLES)
    places[5, dimension - 1] = 1e70
    with pytest.raises(sb.MeshError, match="beyond 1e60"):
        sb.Mesh(places, TRIANGLES)


def test_positions_need_no_area_where_lengths_are_given():
    mesh = sb.Mesh(np.zeros((len(VERTICES), 3)), TRIANGLES, lengths=LENGTHS)
    plain = sb.Mesh(VERTICES, TRIANGLES)
    np.testing.assert_allclose(sb.exact_distances(mesh, [0]), sb.exact_distances(plain, [0]), rtol=1e-12)
    path = sb.SaddleVertexGraph(mesh, exact=True).path(0, 41)
    assert len(path.surface) > 2


@pytest.mark.parametrize(
    "ask",
    [
        lambda mesh, _: sb.project(mesh, np.zeros((1, 3))),
        lambda mesh, plain: sb.hausdorff_distance(plain, mesh),
        lambda mesh, _: sb.feature_curves(mesh),
        lambda mesh, _: sb.add_barriers(mesh, edges=mesh.edges[:1]),
        lambda mesh, _: sb.principal_curvatures(mesh),
        lambda mesh, _: sb.direction_field(mesh, 4, align="curvature"),
        lambda mesh, _: sb.direction_field(mesh, 2, directions=np.ones((mesh.face_count, 3))),
        lambda mesh, _: sb.trace(mesh, 0, (1.0, 0, 0), 1.0),
        lambda mesh, _: sb.stroke_map(mesh, sb.SurfaceCurve(mesh, mesh.edges[0]), 0.1),
        lambda mesh, _: sb.distribute(mesh, [sb.Shape.disk()], 2, size=0.1).conform([(0, 0)], 0),
        lambda mesh, _: sb.distribute(mesh, [sb.Shape.disk()], 2, size=0.1).mapped.frames(),
    ],
)
def test_what_needs_a_shape_in_space_says_so(ask):
    with pytest.raises(sb.InputError, match="needs the shape in space, but the mesh has lengths of its own"):
        ask(elsewhere(), sb.Mesh(VERTICES, TRIANGLES))


def test_lengths_travel_with_the_mesh():
    mesh = elsewhere()
    for again in (copy.deepcopy(mesh), *(pickle.loads(pickle.dumps(mesh, p)) for p in range(6))):
        assert again.is_intrinsic
        assert again.fingerprint == mesh.fingerprint
        assert np.array_equal(again.edge_lengths, mesh.edge_lengths)
    longer = sb.Mesh(mesh.vertices, TRIANGLES, lengths=2 * LENGTHS)
    assert longer.fingerprint != mesh.fingerprint
    assert sb.Mesh(mesh.vertices, TRIANGLES).fingerprint != mesh.fingerprint


def test_graphs_know_the_lengths(tmp_path):
    mesh = elsewhere()
    graph = sb.SaddleVertexGraph(mesh)
    graph.save(tmp_path / "graph")
    again = sb.SaddleVertexGraph.load(tmp_path / "graph", mesh)
    assert np.array_equal(again.distances([3]), graph.distances([3]))
    with pytest.raises(sb.InputError, match="another mesh"):
        sb.SaddleVertexGraph.load(tmp_path / "graph", sb.Mesh(mesh.vertices, TRIANGLES, lengths=2 * LENGTHS))
    parts = [sb.find_arcs(mesh, part, 2) for part in range(2)]
    joined = sb.SaddleVertexGraph.from_parts(mesh, parts)
    assert np.array_equal(joined.distances([3]), graph.distances([3]))


def test_rounding_between_the_two_faces_of_an_edge_is_no_fault():
    rounded = LENGTHS * (1 + 1e-15 * np.random.default_rng(2).normal(size=LENGTHS.shape))
    mesh = sb.Mesh(VERTICES, TRIANGLES, lengths=rounded)
    np.testing.assert_allclose(mesh.edge_lengths, sb.Mesh(VERTICES, TRIANGLES).edge_lengths, rtol=1e-13)


def test_a_curve_between_points_of_one_place_in_space_is_drawn():
    mesh = sb.Mesh(np.zeros((len(VERTICES), 3)), TRIANGLES, lengths=LENGTHS)
    graph = sb.SaddleVertexGraph(mesh, exact=True)
    curve = sb.curve_through(graph, [0, 20, 41], smooth=False)
    assert abs(curve.length - graph.distance(0, 20) - graph.distance(20, 41)) < 1e-9
    with pytest.raises(sb.InputError, match="smooth needs the shape in space"):
        sb.curve_through(graph, [0, 20, 41], smooth=True)


def test_a_line_that_ends_beside_an_edge_is_as_long_as_asked():
    vertices, triangles = meshes.grid(6, 6, jitter=0.3, seed=1)
    mesh = sb.Mesh(vertices, triangles, lengths=sides(vertices, triangles))
    field = sb.direction_field(mesh, 1, strokes=[sb.SurfaceCurve(mesh, mesh.edges[0])])
    start = sb.SurfacePoints([25], [[0.3, 0.3, 0.4]])
    line = sb.streamline(mesh, field, start, 0.5).surface
    crossings = np.flatnonzero(np.diff(line.faces)) + 1
    assert len(crossings) >= 4
    for crossing in crossings:
        length = sb.SurfaceCurve(mesh, line[:crossing]).length + 1e-8
        assert abs(sb.streamline(mesh, field, start, length).length - length) <= 1e-12

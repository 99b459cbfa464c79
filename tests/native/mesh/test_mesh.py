# SPDX-License-Identifier: MIT
"""Mesh: what it measures, what it refuses, and that it never crashes."""

import copy
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import saddleback as sb
from tests import meshes

TRIANGLE = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_topology(case):
    mesh = case.mesh
    assert (mesh.genus, len(mesh.boundary_loops), mesh.component_count) == (case.genus, case.loops, case.components)
    assert mesh.is_closed == (case.loops == 0)
    assert np.unique(mesh.components).tolist() == list(range(case.components))
    euler = mesh.vertex_count - mesh.edge_count + mesh.face_count
    assert euler == 2 * case.components - 2 * case.genus - case.loops


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_gauss_bonnet(case):
    """Angle deficits at inner vertices and turns of the boundary sum to 2 pi times the Euler number."""
    mesh = case.mesh
    full = np.full(mesh.vertex_count, 2 * np.pi)
    full[mesh.boundary_vertices] = np.pi
    euler = mesh.vertex_count - mesh.edge_count + mesh.face_count
    assert (full - mesh.total_angles).sum() == pytest.approx(2 * np.pi * euler, abs=1e-8)


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_measures_agree_with_the_coordinates(case):
    mesh = case.mesh
    a, b, c = (case.vertices[case.triangles[:, i]] for i in range(3))
    assert mesh.face_areas == pytest.approx(np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2, rel=1e-12)
    assert mesh.area == pytest.approx(mesh.face_areas.sum(), rel=1e-12)
    assert mesh.corner_angles.sum(axis=1) == pytest.approx(np.pi, abs=1e-12)
    ends = case.vertices[mesh.edges]
    assert mesh.edge_lengths == pytest.approx(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1), rel=1e-14)
    assert mesh.mean_edge_length == pytest.approx(mesh.edge_lengths.mean(), rel=1e-12)
    assert len(np.unique(np.sort(mesh.edges, axis=1), axis=0)) == mesh.edge_count
    total = np.bincount(case.triangles.ravel(), mesh.corner_angles.ravel(), mesh.vertex_count)
    assert mesh.total_angles == pytest.approx(total, abs=1e-12)


def test_closed_forms():
    assert sb.Mesh(*meshes.cube()).area == pytest.approx(6, rel=1e-15)
    assert sb.Mesh(*meshes.cube()).total_angles == pytest.approx(1.5 * np.pi, rel=1e-15)
    assert sb.Mesh(*meshes.grid()).area == pytest.approx(1, rel=1e-14)
    assert sb.Mesh(*meshes.tetrahedron()).corner_angles == pytest.approx(np.pi / 3, rel=1e-15)


@pytest.mark.parametrize("size", [1e-12, 1e-8, 1e-3])
def test_needle_keeps_its_small_angle(size):
    """The tip of a needle twice as long as 1/size: the law of cosines would lose it below 1e-8."""
    mesh = sb.Mesh([(0, 0, 0), (1, 0, 0), (1, 8 * size, 0)], [(0, 1, 2)])
    assert mesh.corner_angles[0, 0] == pytest.approx(np.arctan(8 * size), rel=1e-14)
    assert mesh.corner_angles.sum() == pytest.approx(np.pi, abs=1e-15)


def test_boundary_loops_run_with_the_surface_on_the_left():
    vertices, triangles = meshes.holes()
    loops = sb.Mesh(vertices, triangles).boundary_loops
    halfedges = {(a, b) for t in triangles.tolist() for a, b in zip(t, t[1:] + t[:1], strict=True)}
    for loop in loops:
        ring = loop.tolist()
        for a, b in zip(ring, ring[1:] + ring[:1], strict=True):
            assert (a, b) in halfedges
            assert (b, a) not in halfedges
    signed = [np.cross(vertices[r], np.roll(vertices[r], -1, axis=0))[:, 2].sum() for r in loops]
    assert sorted(np.sign(signed)) == [-1, -1, 1]  # the rim counter-clockwise, the holes clockwise


def test_saddle_vertices():
    mesh = sb.Mesh(*meshes.saddle())
    assert mesh.saddle_vertices.tolist() == list(range(mesh.vertex_count))
    for flat in (meshes.grid(jitter=0.3), meshes.cylinder(), meshes.needles()):
        mesh = sb.Mesh(*flat)
        assert mesh.saddle_vertices.tolist() == mesh.boundary_vertices.tolist()
    assert len(sb.Mesh(*meshes.icosphere(3)).saddle_vertices) == 0


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_scaling_scales(case):
    bigger = sb.Mesh(case.vertices * 2.0**100, case.triangles)
    assert np.array_equal(bigger.corner_angles, case.mesh.corner_angles)
    assert np.array_equal(bigger.edge_lengths, case.mesh.edge_lengths * 2.0**100)
    assert np.array_equal(bigger.saddle_vertices, case.mesh.saddle_vertices)


@pytest.mark.parametrize("case", meshes.broken(), ids=str)
def test_broken_meshes_are_refused_with_a_remedy(case):
    with pytest.raises(sb.MeshError, match=case.fault) as caught:
        sb.Mesh(case.vertices, case.triangles)
    assert str(caught.value).endswith("saddleback.repair mends this")
    assert "\n" not in str(caught.value)


def test_messages_name_three_offenders_and_the_count():
    with pytest.raises(sb.MeshError) as caught:
        sb.Mesh(np.vstack([TRIANGLE, np.ones((5, 3))]), [(0, 1, 2)])
    assert str(caught.value).startswith("5 vertices belong to no face: vertex 3, vertex 4, vertex 5, ...;")


@pytest.mark.parametrize(
    ("vertices", "triangles", "error", "says"),
    [
        ([], [], sb.MeshError, "no faces"),
        (TRIANGLE, [], sb.MeshError, "no faces"),
        (TRIANGLE, [(0, 1, 3)], sb.MeshError, "face 0 has vertex 3; the mesh has 3 vertices"),
        (TRIANGLE, [(0, 1, -1)], sb.MeshError, "face 0 has vertex -1"),
        (np.multiply(TRIANGLE, 1e300), [(0, 1, 2)], sb.MeshError, "beyond 1e60"),
        (np.multiply(TRIANGLE, 1e-300), [(0, 1, 2)], sb.MeshError, "no area"),
        (
            np.zeros((4, 1)),
            [(0, 1, 2)],
            sb.InputError,
            r"vertices: wanted shape \(n, d\) of real numbers, d at least 2, got \(4, 1\)",
        ),
        (TRIANGLE, [0, 1, 2], sb.InputError, r"triangles: wanted shape \(n, 3\) of integers, got \(3,\)"),
        (TRIANGLE, [(0.0, 1.0, 2.0)], sb.InputError, "triangles: .* got type float64"),
        (TRIANGLE, [(0, 1, 2**33)], sb.InputError, r"value 8589934592 at \[0, 2\] does not fit"),
        (np.array(TRIANGLE, dtype=complex), [(0, 1, 2)], sb.InputError, "got type complex128"),
        ("mesh", [(0, 1, 2)], sb.InputError, "got a str"),
        (None, [(0, 1, 2)], sb.InputError, "got None"),
        ([(0, 0), (1,)], [(0, 1, 2)], sb.InputError, "vertices: .* a list that numpy makes no array of"),
    ],
)
def test_bad_arguments(vertices, triangles, error, says):
    with pytest.raises(error, match=says):
        sb.Mesh(vertices, triangles)


@pytest.mark.parametrize("real", ["f2", "f4", ">f8", "i4", "u1", "longdouble"])
@pytest.mark.parametrize("integer", ["i1", "u2", "i4", ">i4", "i8", "u8"])
def test_any_number_type_and_layout(real, integer):
    vertices, triangles = meshes.cube()
    wide = np.zeros((len(vertices), 6), dtype=real)[:, ::2]
    wide[:] = vertices
    mesh = sb.Mesh(wide, np.asfortranarray(triangles.astype(integer)))
    assert np.array_equal(mesh.vertices, vertices)
    assert np.array_equal(mesh.triangles, triangles)


def test_arrays_are_read_only_and_outlive_the_mesh():
    vertices, triangles = meshes.cube()
    mesh = sb.Mesh(vertices, triangles)
    views = [mesh.vertices, mesh.triangles, mesh.total_angles, mesh.corner_angles, mesh.edge_lengths, mesh.components]
    for view in views:
        with pytest.raises(ValueError, match="read-only"):
            view[0] = 0
    vertices[:] = 7  # the mesh has copies
    del mesh
    assert np.array_equal(views[0], meshes.cube()[0])


def test_fingerprint_pickle_and_repr():
    mesh = sb.Mesh(*meshes.torus())
    again = pickle.loads(pickle.dumps(mesh))
    assert again.fingerprint == mesh.fingerprint == copy.deepcopy(mesh).fingerprint
    vertices, triangles = meshes.torus()
    vertices[3, 0] = np.nextafter(vertices[3, 0], 9)
    assert sb.Mesh(vertices, triangles).fingerprint != mesh.fingerprint
    assert repr(mesh) == "<saddleback.Mesh: 504 vertices, 1008 faces, 1 component, genus 1, 0 boundary loops>"


def test_crowd_on_one_edge_is_refused_quickly():
    """A hundred thousand faces on one edge: comparing all pairs would take minutes."""
    n = 100_000
    angle = np.linspace(0, 6, n)
    vertices = np.vstack([[(0, 0, 0), (0, 0, 1)], np.column_stack([np.cos(angle), np.sin(angle), angle])])
    triangles = np.column_stack([np.zeros(n, int), np.ones(n, int), np.arange(2, n + 2)])
    with pytest.raises(sb.MeshError, match="non-manifold edge"):
        sb.Mesh(vertices, triangles)


awkward = st.one_of(
    st.integers(0, 2).map(float), st.floats(-1, 1), st.sampled_from([np.nan, np.inf, 1e300, 1e-300, 1 + 1e-15])
)


@given(
    hnp.arrays(np.float64, st.tuples(st.integers(0, 8), st.just(3)), elements=awkward),
    hnp.arrays(np.int32, st.tuples(st.integers(0, 12), st.just(3)), elements=st.integers(-1, 8)),
)
def test_any_arrays_make_a_mesh_or_a_sentence(vertices, triangles):
    try:
        mesh = sb.Mesh(vertices, triangles)
    except sb.MeshError as error:
        assert ";" in str(error)
    else:
        assert np.isfinite(mesh.area)
        assert mesh.area > 0
        assert np.isfinite(mesh.total_angles).all()

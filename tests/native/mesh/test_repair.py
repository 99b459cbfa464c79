# SPDX-License-Identifier: MIT
"""repair: whatever goes in, a valid mesh comes out, changed no more than needed."""

from time import process_time

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_it_stops_when_silent


def volume(mesh):
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def check_maps(mesh, report, vertices, triangles):
    """Maps have the right lengths, hit the new mesh, and send unmoved vertices to their own place."""
    assert report.vertex_map.shape == (len(vertices),)
    assert report.face_map.shape == (len(triangles),)
    assert report.vertex_map.max(initial=-1) < mesh.vertex_count
    assert report.face_map.max(initial=-1) < mesh.face_count
    kept = report.face_map[report.face_map >= 0]
    assert len(np.unique(kept)) == len(kept)


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_a_good_mesh_is_left_alone(case):
    mesh, report = sb.repair(case.vertices, case.triangles)
    assert report.changes == {}
    assert str(report) == "nothing to mend"
    assert np.array_equal(mesh.vertices, case.vertices)
    assert np.array_equal(mesh.triangles, case.triangles)
    assert report.vertex_map.tolist() == list(range(len(case.vertices)))
    assert report.face_map.tolist() == list(range(len(case.triangles)))


@pytest.mark.parametrize("case", meshes.broken(), ids=str)
def test_broken_meshes_are_mended_for_good(case):
    mesh, report = sb.repair(case.vertices, case.triangles)
    assert report.changes
    check_maps(mesh, report, case.vertices, case.triangles)
    again, second = sb.repair(mesh.vertices, mesh.triangles)
    assert second.changes == {}
    assert again.fingerprint == mesh.fingerprint


def test_soup_is_welded():
    mesh, report = sb.repair(*meshes.soup())
    assert (mesh.vertex_count, mesh.genus, mesh.is_closed) == (240, 1, True)
    assert report.changes == {"vertices_welded": 1200}
    assert np.array_equal(mesh.vertices[report.vertex_map], meshes.soup()[0])


def test_moebius_strip_gets_a_seam():
    mesh, report = sb.repair(*meshes.moebius())
    assert report.changes == {"edges_cut": 4, "vertices_split": 5}
    assert (mesh.component_count, len(mesh.boundary_loops), mesh.genus) == (1, 1, 0)


def test_bow_tie_becomes_two():
    mesh, report = sb.repair(*meshes.bow_tie())
    assert (mesh.component_count, mesh.vertex_count, mesh.is_closed) == (2, 8, True)
    assert report.changes["vertices_split"] == 1


def test_zero_edge_collapses_and_the_surface_stays_closed():
    mesh, report = sb.repair(*meshes.collapsed_edge())
    assert mesh.is_closed
    assert (mesh.vertex_count, mesh.face_count) == (161, 318)
    assert report.changes == {"faces_without_area": 2, "vertices_welded": 1}


def test_cap_is_flipped_without_a_crack():
    vertices, triangles = meshes.with_cap()
    mesh, report = sb.repair(vertices, triangles)
    assert mesh.is_closed
    assert np.array_equal(mesh.vertices, vertices)
    assert mesh.area == pytest.approx(sb.Mesh(*meshes.tetrahedron()).area, rel=1e-14)
    assert report.changes == {"faces_without_area": 1}


def test_needle_next_to_zero_collapses():
    vertices, triangles = meshes.icosphere(2)
    a, b = triangles[30, :2]
    vertices[a] = vertices[b] * (1 + 1e-15)
    mesh, report = sb.repair(vertices, triangles)
    assert mesh.is_closed
    assert (mesh.vertex_count, mesh.face_count) == (161, 318)
    assert report.vertex_map[a] == report.vertex_map[b]


@pytest.mark.parametrize("case", meshes.closed(), ids=str)
def test_closed_components_face_outward(case):
    rng = np.random.default_rng(5)
    mixed = case.triangles.copy()
    turned = rng.random(len(mixed)) < 0.5
    mixed[turned] = mixed[turned, ::-1]
    for triangles in (case.triangles[:, ::-1], mixed):
        mesh, report = sb.repair(case.vertices, triangles)
        assert volume(mesh) == pytest.approx(volume(case.mesh), rel=1e-12)
        assert set(report.changes) == {"faces_flipped"}


def test_wall_of_a_cavity_keeps_facing_inward():
    outer, inner = meshes.icosphere(2), meshes.icosphere(1, radius=0.5)
    hollow = meshes.merge(outer, (inner[0], inner[1][:, ::-1]))
    mesh, report = sb.repair(*hollow)
    assert report.changes == {}
    assert volume(mesh) == pytest.approx(volume(sb.Mesh(*outer)) - volume(sb.Mesh(*inner)), rel=1e-12)


def test_cubes_that_touch_along_an_edge_come_apart():
    touching = np.zeros((2, 2, 1), dtype=bool)
    touching[0, 0] = touching[1, 1] = True
    mesh, report = sb.repair(*meshes.voxels(touching))
    assert (mesh.component_count, mesh.is_closed, mesh.area) == (2, True, pytest.approx(12))
    assert report.changes == {"edges_non_manifold": 1, "vertices_split": 2}


def test_wall_on_a_floor_leaves_the_floor_whole():
    floor = meshes.grid(3, 3)
    wall = (np.array([[0.5, 0, 0], [0.5, 0.5, 0], [0.5, 0.25, 1]]), np.array([[0, 1, 2]], dtype=np.int32))
    mesh, _ = sb.repair(*meshes.merge(floor, wall))
    assert mesh.component_count == 2
    assert np.bincount(mesh.components).tolist() == [9, 3]


def test_weld_distance():
    vertices, triangles = meshes.soup()
    moved = vertices + np.random.default_rng(0).uniform(-1e-6, 1e-6, vertices.shape)
    mesh, _ = sb.repair(moved, triangles, 1e-5)
    assert (mesh.vertex_count, mesh.is_closed) == (240, True)
    mesh, _ = sb.repair(moved, triangles, weld_distance=1e-9)
    assert mesh.vertex_count == 1440
    with pytest.raises(sb.MeshError, match="no face of the mesh can be used"):
        sb.repair(moved, triangles, 100.0)


def test_unusable_parts_are_dropped_and_reported():
    vertices, triangles = meshes.icosphere(2)
    vertices = np.vstack([vertices, [(np.inf, 0, 0), (1e300, 0, 0), (0, 0, 5)]])
    triangles = np.vstack([triangles, [(0, 1, 162), (0, 1, 163), (0, 1, 999), (2, 2, 3)]])
    mesh, report = sb.repair(vertices, triangles)
    assert mesh.fingerprint == sb.Mesh(*meshes.icosphere(2)).fingerprint
    assert report.changes == {
        "vertices_not_finite": 2,
        "vertices_unreferenced": 1,
        "faces_with_bad_index": 1,
        "faces_repeating_a_vertex": 1,
    }
    assert report.vertex_map[-3:].tolist() == [-1, -1, -1]
    assert report.face_map[-4:].tolist() == [-1] * 4


@pytest.mark.parametrize(
    ("arguments", "error", "says"),
    [
        (([], []), sb.MeshError, "no face of the mesh can be used"),
        ((np.zeros((3, 3)), [(0, 1, 2)]), sb.MeshError, "no face of the mesh can be used"),
        ((*meshes.cube(), -1), sb.InputError, "weld_distance: wanted a finite number >= 0, got -1"),
        ((*meshes.cube(), np.nan), sb.InputError, "weld_distance"),
        ((*meshes.cube(), "far"), sb.InputError, "weld_distance: wanted a real number, got a str"),
        ((np.zeros((3, 2)), [(0, 1, 2)]), sb.InputError, "vertices: wanted shape"),
    ],
)
def test_bad_arguments(arguments, error, says):
    with pytest.raises(error, match=says):
        sb.repair(*arguments)


def test_cancelled_job_stops_it():
    job = sb.Job()
    job.cancel()
    with pytest.raises(sb.Cancelled):
        sb.repair(*meshes.torus(), job=job)


def test_time_of_a_crowd_on_one_edge_grows_with_it():
    """Many large faces lie behind each other wherever they are seen from: 5 times as long for 4 times as many."""

    def seconds(count):
        angle = np.linspace(0, 6, count)
        vertices = np.vstack([[(0, 0, 0), (0, 0, 1)], np.column_stack([np.cos(angle), np.sin(angle), angle])])
        triangles = np.column_stack([np.zeros(count, int), np.ones(count, int), np.arange(2, count + 2)])
        start = process_time()
        mesh, _ = sb.repair(vertices, triangles)
        assert mesh.face_count >= count
        return process_time() - start

    assert seconds(20_000) < 10 * seconds(5_000)  # 16 times by faces and the pixels of each


awkward = st.one_of(
    st.integers(0, 2).map(float), st.floats(-1, 1), st.sampled_from([np.nan, np.inf, 1e300, 1e-300, 1 + 1e-15, 1e-13])
)


@given(
    hnp.arrays(np.float64, st.tuples(st.integers(0, 9), st.just(3)), elements=awkward),
    hnp.arrays(np.int32, st.tuples(st.integers(0, 16), st.just(3)), elements=st.integers(-1, 9)),
    st.sampled_from([0.0, 1e-13, 0.1, 1.0]),
)
def test_any_arrays_are_repaired_or_refused(vertices, triangles, weld_distance):
    try:
        mesh, report = sb.repair(vertices, triangles, weld_distance)
    except sb.MeshError as error:
        assert "no face of the mesh can be used" in str(error)  # and never a fault that repair left in
    else:
        check_maps(mesh, report, vertices, triangles)


def turned(arrays):
    return arrays[0], arrays[1][:, ::-1]


def moved(arrays, by):
    return arrays[0] + np.asarray(by, dtype=np.float64), arrays[1]


def test_a_hollow_ball_that_is_inside_out_is_turned_whole():
    outer, inner = meshes.icosphere(2, radius=2.0), meshes.icosphere(2)
    mesh, report = sb.repair(*meshes.merge(turned(outer), inner))
    assert volume(mesh) == pytest.approx(volume(sb.Mesh(*outer)) - volume(sb.Mesh(*inner)), rel=1e-12)
    assert set(report.changes) == {"faces_flipped"}


def test_nested_walls_alternate_when_the_outermost_is_inside_out():
    shells = [meshes.icosphere(1, radius=radius) for radius in (4.0, 3.0, 2.0, 1.0)]
    whole = meshes.merge(*(turned(shell) if i % 2 else shell for i, shell in enumerate(shells)))
    mesh, _ = sb.repair(*turned(whole))
    assert volume(mesh) == pytest.approx(volume(sb.Mesh(*whole)), rel=1e-12)
    assert sb.repair(*whole)[1].changes == {}


def test_solids_within_a_solid_stay_as_they_are():
    """A body in its clothes: both face outward, and neither is wrong."""
    whole = meshes.merge(meshes.icosphere(2, radius=2.0), meshes.icosphere(1))
    assert sb.repair(*whole)[1].changes == {}


def bowl(lowest=-0.2, radius=1.0):
    """A ball without what lies above a height."""
    vertices, triangles = meshes.icosphere(3, radius=radius)
    return vertices, triangles[(vertices[triangles, 2] < lowest * radius).all(axis=1)]


@pytest.mark.parametrize("whole", [bowl(), bowl(0.9), moved(bowl(), (3, 1, 2))])
def test_open_bodies_show_their_front(whole):
    mesh, report = sb.repair(*turned(whole))
    assert set(report.changes) == {"faces_flipped", "vertices_unreferenced"}
    assert report.changes["faces_flipped"] == len(whole[1])
    again, second = sb.repair(mesh.vertices, mesh.triangles)
    assert second.changes == {} and np.array_equal(again.triangles, mesh.triangles)
    kept, report = sb.repair(*whole)
    assert set(report.changes) == {"vertices_unreferenced"}
    normals = [sb.vertex_normals(found.vertices, found.triangles) for found in (mesh, kept)]
    assert normals[0] == pytest.approx(normals[1], abs=1e-12)


def test_each_open_body_is_turned_by_what_is_seen_of_it_among_all():
    """The inner wall of a thick bowl faces the hollow, in which nobody sees its other side."""
    outer, inner = bowl(0.5), bowl(0.5, 0.9)
    inner = turned(inner)
    for wrong in (turned(outer), outer):
        for hidden in (turned(inner), inner):
            mesh, _ = sb.repair(*meshes.merge(wrong, hidden))
            middles = mesh.vertices[mesh.triangles].mean(axis=1)
            corners = mesh.vertices[mesh.triangles]
            normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            faces_out = np.einsum("ij,ij->i", normals, middles) > 0
            assert np.array_equal(faces_out, np.linalg.norm(middles, axis=1) > 0.95)


@pytest.mark.parametrize("sheet", [meshes.grid(5, 5), bowl(-0.95)])
def test_sheets_of_which_both_sides_are_seen_stay_as_they_came(sheet):
    for arrays in (sheet, turned(sheet)):
        assert "faces_flipped" not in sb.repair(*arrays)[1].changes


def test_a_ball_in_the_hole_of_a_torus_is_not_within_it():
    ring, ball = meshes.torus(24, 8, 5.0, 0.5), meshes.icosphere(1)
    mesh, _ = sb.repair(*meshes.merge(ring, turned(moved(ball, (0, 0, 0.1)))))
    assert volume(mesh) == pytest.approx(volume(sb.Mesh(*ring)) + volume(sb.Mesh(*ball)), rel=1e-12)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_t_junctions_are_told_and_stitched_on_request(scale):
    vertices = scale * np.array([(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 1, 0), (2, 1, 0), (0, -1, 0), (2, -1, 0)])
    triangles = [(0, 1, 3), (1, 2, 4), (1, 4, 3), (0, 5, 6), (0, 6, 2)]
    mesh, report = sb.repair(vertices, triangles)
    assert (mesh.component_count, report.t_junctions) == (2, 1)
    assert "stitch=True" in str(report)
    mesh, report = sb.repair(vertices, triangles, stitch=True)
    assert report.changes == {"edges_stitched": 1}
    assert (mesh.component_count, len(mesh.boundary_loops), report.t_junctions) == (1, 1, 0)
    ends = report.vertex_map[[3, 6]]
    assert sb.exact_distances(mesh, ends[:1])[ends[1]] == pytest.approx(scale * 8**0.5, rel=1e-12)


def test_a_face_with_many_vertices_on_all_its_sides_is_divided():
    """A large triangle framed by strips of small ones."""
    count = 7
    corners = np.array([(0.0, 0, 0), (1.0, 0, 0), (0.0, 1.0, 0)])
    parts = [(corners, np.array([(0, 1, 2)], dtype=np.int32))]
    share = np.linspace(0, 1, count)[:, None]
    for i in range(3):
        a, b = corners[i], corners[(i + 1) % 3]
        out = np.array([(b - a)[1], -(b - a)[0], 0]) / 5
        row = a + share * (b - a)
        row[[0, -1]] = a, b
        strip = np.vstack([row, row + out])
        lower = [(k + 1, k, count + k) for k in range(count - 1)]
        lower += [(k + 1, count + k, count + k + 1) for k in range(count - 1)]
        parts.append((strip, np.array(lower, dtype=np.int32)))
    mesh, report = sb.repair(*meshes.merge(*parts), 1e-9, stitch=True)
    assert report.changes["edges_stitched"] == 3
    assert mesh.component_count == 1
    assert mesh.area == pytest.approx(0.5 + (2 + 2) / 5, rel=1e-9)


def test_a_soup_off_by_a_rounding_tells_what_joins_it():
    vertices, triangles = meshes.icosphere(3)
    corners = vertices[triangles].reshape(-1, 3).astype(np.float32)
    up = np.random.default_rng(1).random(corners.shape) < 0.05
    corners = np.where(up, np.nextafter(corners, np.float32(9)), corners)
    numbers = np.arange(len(corners)).reshape(-1, 3)
    mesh, report = sb.repair(corners, numbers)
    assert mesh.component_count > 1
    assert 0 < report.joining_distance < 1e-6
    assert f"weld_distance={report.joining_distance:g}" in str(report)
    mesh, report = sb.repair(corners, numbers, report.joining_distance)
    assert (mesh.component_count, mesh.is_closed, report.near_border_vertices) == (1, True, 0)


def test_copies_at_one_place_are_no_crack():
    """Where a repair parted sheets, welding would bring back what it mended."""
    assert sb.repair(*meshes.bow_tie())[1].near_border_vertices == 0


def test_holes_up_to_a_size_are_filled():
    arrays = meshes.holes()
    mesh, report = sb.repair(*arrays, fill_holes=20)
    assert report.changes["holes_filled"] == 2
    assert report.changes["holes_left"] == 1
    assert len(mesh.boundary_loops) == 1
    assert mesh.area == pytest.approx(1.0, rel=1e-12)
    assert (report.face_map >= 0).all()
    tube, report = sb.repair(*meshes.cylinder(24, 9), fill_holes=24)
    assert report.changes == {"holes_filled": 2}
    assert tube.is_closed
    assert volume(tube) == pytest.approx(12 * np.sin(2 * np.pi / 24) * 2, rel=1e-12)


def test_filling_makes_no_edge_that_is_there_already():
    """Two faces that share an edge, as an open book: the only diagonal of the hole is the back of the book."""
    vertices = [(0, 0, 0), (0, 0, 1), (1, 0, 0.5), (0, 1, 0.5)]
    mesh, report = sb.repair(vertices, [(0, 2, 1), (1, 3, 0)], fill_holes=10)
    assert report.changes == {"holes_filled": 1}
    assert (mesh.is_closed, mesh.face_count) == (True, 4)
    lone, report = sb.repair(vertices[:3], [(0, 1, 2)], fill_holes=10)
    assert (lone.face_count, report.changes) == (1, {})


def test_it_stops_soon_while_it_welds_many_vertices():
    vertices, triangles = meshes.icosphere(7)
    check_it_stops_when_silent(lambda job: sb.repair(vertices, triangles, 1e-6, job=job), 0)


def test_time_of_many_holes_grows_with_the_mesh():
    """Not with the holes times its faces: 20 times as long for 10 times as many at the most."""

    def seconds(rows):
        vertices, triangles = meshes.grid(41, rows)
        kept = np.ones(len(triangles), bool)
        kept.reshape(rows - 1, 40, 2)[1:-1:2, 1:-1:2] = False
        start = process_time()
        _, report = sb.repair(vertices, triangles[kept], fill_holes=8)
        assert report.changes["holes_filled"] == 19 * ((rows - 2) // 2)
        assert report.changes["holes_left"] == 1
        return process_time() - start

    assert seconds(2001) < 20 * seconds(201)


@pytest.mark.parametrize("edges", [-1, 2001, 2**31 - 1])
def test_holes_too_large_to_fill_are_refused(edges):
    with pytest.raises(sb.InputError, match="fill_holes: wanted 0 to 2000 edges"):
        sb.repair(*meshes.grid(3, 3), fill_holes=edges)

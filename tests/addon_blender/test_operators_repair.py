# SPDX-License-Identifier: GPL-3.0-or-later
"""The repair makes a mesh usable and keeps what the artist put on it."""

import bpy
import numpy as np
import pytest
from scenes import add_object, fingerprint, grid, grid_arrays, positions, sphere

import saddleback as sb
from saddleback_blender import jobs


def is_good(item):
    """Whether the library takes the object's mesh as it is."""
    item.data.calc_loop_triangles()
    triangles = np.array([tuple(triangle.vertices) for triangle in item.data.loop_triangles])
    used = np.unique(triangles)
    sb.Mesh(positions(item.data).astype(float)[used], np.searchsorted(used, triangles))
    return True


def paint(item):
    """Data of every kind, each a function of the place, so that it can be checked wherever it ends up."""
    mesh = item.data
    group = item.vertex_groups.new(name="Weight")
    for vertex in mesh.vertices:
        group.add([vertex.index], weight_at(vertex.co), "REPLACE")
    attribute = mesh.attributes.new("Height", "FLOAT", "POINT")
    attribute.data.foreach_set("value", positions(mesh)[:, 0] * 3)
    layer = mesh.uv_layers.new(name="Map")
    for loop in mesh.loops:
        layer.data[loop.index].uv = mesh.vertices[loop.vertex_index].co[:2]
    for name in ("Red", "Blue"):
        mesh.materials.append(bpy.data.materials.new(name))
    for polygon in mesh.polygons:
        polygon.material_index = material_at(polygon.center)
        polygon.use_smooth = True


def weight_at(place):
    return 0.25 + 0.5 * max(0.0, min(1.0, place[0]))


def material_at(place):
    return int(place[1] > 0.5)


def check_paint(item):
    mesh = item.data
    index = item.vertex_groups["Weight"].index
    height = mesh.attributes["Height"].data
    for vertex in mesh.vertices:
        weights = {element.group: element.weight for element in vertex.groups}
        assert weights[index] == pytest.approx(weight_at(vertex.co), abs=1e-6)
        assert height[vertex.index].value == pytest.approx(3 * vertex.co.x, abs=1e-5)
    layer = mesh.uv_layers["Map"].data
    for loop in mesh.loops:
        assert tuple(layer[loop.index].uv) == pytest.approx(tuple(mesh.vertices[loop.vertex_index].co[:2]), abs=1e-6)
    for polygon in mesh.polygons:
        assert polygon.material_index == material_at(polygon.center) and polygon.use_smooth
    assert [material.name for material in mesh.materials] == ["Red", "Blue"]


def test_a_good_mesh_stays_to_the_bit():
    item = sphere()
    paint_before = fingerprint(told=False)
    assert bpy.ops.saddleback.repair() == {"FINISHED"}
    assert fingerprint(told=False) == paint_before
    assert is_good(item)


def test_doubled_vertices_are_welded_and_quads_stay_quads():
    vertices, faces = grid_arrays(6)
    # Cut in two along a column, as an import that splits at UV seams does.
    left, right = faces[vertices[faces][:, :, 0].mean(axis=1) < 0.5], faces[vertices[faces][:, :, 0].mean(axis=1) > 0.5]
    item = add_object("Seam", np.concatenate([vertices, vertices]), np.concatenate([left, right + len(vertices)]))
    paint(item)
    seams = [edge for edge in item.data.edges if all(abs(item.data.vertices[v].co.y) < 1e-6 for v in edge.vertices)]
    for edge in seams:
        edge.use_seam = edge.use_edge_sharp = True
    assert bpy.ops.saddleback.repair() == {"FINISHED"}
    assert is_good(item)
    assert len(item.data.polygons) == 36 and all(len(polygon.vertices) == 4 for polygon in item.data.polygons)
    faces_of = np.bincount([loop.vertex_index for loop in item.data.loops], minlength=len(item.data.vertices))
    assert (faces_of > 0).sum() == 49
    seam_edges = [edge for edge in item.data.edges if edge.use_seam]
    assert len(seam_edges) == 6 and all(edge.use_edge_sharp for edge in seam_edges)
    check_paint(item)


def test_duplicate_faces_go():
    vertices, faces = grid_arrays(4)
    item = add_object("Twice", vertices, np.concatenate([faces, faces[3:5]]))
    paint(item)
    bpy.ops.saddleback.repair()
    assert is_good(item) and len(item.data.polygons) == 16
    check_paint(item)


def test_faces_turned_the_wrong_way_are_turned_back():
    vertices, faces = grid_arrays(4)
    faces[5] = faces[5][::-1]
    item = add_object("Turned", vertices, faces)
    paint(item)
    bpy.ops.saddleback.repair()
    assert is_good(item) and len(item.data.polygons) == 16
    item.data.update()
    normals = np.array([polygon.normal[:] for polygon in item.data.polygons])
    np.testing.assert_allclose(normals, np.tile([0, 0, 1], (16, 1)), atol=1e-6)
    check_paint(item)


def test_a_third_face_on_an_edge_is_cut_loose():
    vertices, faces = grid_arrays(2)
    fin = np.array([[0.5, 0.0, 1.0], [0.5, 0.5, 1.0]])
    number = len(vertices)
    item = add_object("Fin", np.concatenate([vertices, fin]), [*faces, [1, 4, number + 1, number]])
    paint(item)
    bpy.ops.saddleback.repair()
    assert is_good(item) and len(item.data.polygons) == 5
    assert len(item.data.vertices) > len(vertices) + 2
    check_paint(item)
    again = fingerprint(told=False)
    bpy.ops.saddleback.repair()  # the copies at one place stay apart
    assert fingerprint(told=False) == again


def test_two_parts_that_touch_at_a_vertex_are_separated():
    vertices, faces = grid_arrays(1)
    item = add_object("Bow", np.concatenate([vertices, [[2, 1, 0], [2, 2, 0], [1, 2, 0]]]), [*faces, [3, 4, 5, 6]])
    paint(item)
    bpy.ops.saddleback.repair()
    assert is_good(item) and len(item.data.polygons) == 2 and len(item.data.vertices) == 8
    check_paint(item)


def test_vertices_that_are_not_finite_go_with_their_faces():
    item = grid(n=4)
    paint(item)
    item.data.vertices[12].co.x = float("nan")
    with pytest.raises(RuntimeError, match="vertex 12"):
        bpy.ops.saddleback.tessellate(count=3)
    bpy.ops.saddleback.repair()
    assert is_good(item) and np.isfinite(positions(item.data)).all()
    # Of the four quads around it at most a triangle each is left.
    assert sum(len(polygon.vertices) == 4 for polygon in item.data.polygons) == 12 and len(item.data.vertices) == 24
    check_paint(item)


def test_a_triangle_without_area_is_mended_without_a_crack():
    # A polygon whose corner lies on a straight side: its triangulation may hold a triangle without area.
    vertices = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (1, -1, 0)]
    item = add_object("Straight", vertices, [(0, 1, 2), (0, 2, 3, 4), (0, 5, 1), (1, 5, 2)])
    bpy.ops.saddleback.repair()
    assert is_good(item)
    item.data.calc_loop_triangles()
    assert sum(triangle.area for triangle in item.data.loop_triangles) == pytest.approx(5.0)
    edges = np.sort([tuple(edge) for polygon in item.data.polygons for edge in polygon.edge_keys], axis=1)
    boundary = np.unique(edges, axis=0, return_counts=True)[1] == 1
    assert boundary.sum() == 5  # no crack: the outline 0, 5, 2, 3, 4 has five sides


def test_weld_distance_is_in_world_units():
    vertices, faces = grid_arrays(4)
    moved = vertices[10:] + np.array([0.001, 0.0, 0.0])
    item = add_object("Near", np.concatenate([vertices[:15], moved]), [*faces[:8], *(faces[8:] + 5)])
    item.scale = (10, 10, 10)
    bpy.context.view_layer.update()
    bpy.ops.saddleback.repair(weld_distance=0.005)  # the gap is 0.01 in the world
    assert len(item.data.vertices) == 30
    bpy.ops.saddleback.repair(weld_distance=0.02)
    assert len(item.data.vertices) == 25 and len(item.data.polygons) == 16 and is_good(item)
    assert item.saddleback.repair.weld_distance == pytest.approx(0.02)
    np.testing.assert_allclose(np.ptp(positions(item.data), axis=0), [1, 1, 0], atol=0.002)


def test_mirrored_objects_are_repaired_the_right_way_round():
    vertices, faces = grid_arrays(4)
    item = add_object("Mirror", vertices, np.concatenate([faces, faces[3:4]]))
    item.scale.x = -1
    bpy.context.view_layer.update()
    bpy.ops.saddleback.repair()
    assert is_good(item) and len(item.data.polygons) == 16
    assert all(polygon.normal.z > 0.99 for polygon in item.data.polygons)


def test_loose_parts_and_shape_keys_stay():
    vertices, faces = grid_arrays(3)
    item = add_object("Keys", np.concatenate([vertices, [[5, 5, 5]]]), np.concatenate([faces, faces[:1]]))
    item.shape_key_add(name="Basis")
    item.shape_key_add(name="Up").data[4].co.z = 2.0
    bpy.ops.saddleback.repair()
    assert len(item.data.vertices) == 17 and len(item.data.polygons) == 9
    assert [key.name for key in item.data.shape_keys.key_blocks] == ["Basis", "Up"]
    assert item.data.shape_keys.key_blocks["Up"].data[4].co.z == 2.0


def holed(n, missing):
    """A grid without some of its quads, painted."""
    vertices, faces = grid_arrays(n)
    item = add_object("Holed", vertices, np.delete(faces, missing, axis=0))
    paint(item)
    return item


def border_count(item):
    edges = np.sort([tuple(edge) for polygon in item.data.polygons for edge in polygon.edge_keys], axis=1)
    return int((np.unique(edges, axis=0, return_counts=True)[1] == 1).sum())


def test_holes_are_filled_with_faces_that_are_painted_as_those_about_them():
    item = holed(8, [18, 19, 45])
    bpy.ops.saddleback.repair()
    assert "nothing to repair" in jobs.state.line and len(item.data.polygons) == 61
    bpy.ops.saddleback.repair(fill_holes=4)
    assert "1 hole filled" in jobs.state.line and len(item.data.polygons) == 63
    assert any("2 holes are left open" in line for line in jobs.state.figures)
    bpy.ops.saddleback.repair(fill_holes=6)
    assert "1 hole filled" in jobs.state.line and is_good(item)
    assert len(item.data.polygons) == 67 and border_count(item) == 32
    assert sum(len(polygon.vertices) == 4 for polygon in item.data.polygons) == 61  # the others stay as they are
    assert sum(polygon.area for polygon in item.data.polygons) == pytest.approx(1.0)
    assert all(polygon.normal.z > 0.99 for polygon in item.data.polygons)
    check_paint(item)
    before = fingerprint(told=False)
    bpy.ops.saddleback.repair(fill_holes=6)
    assert "nothing to repair" in jobs.state.line and fingerprint(told=False) == before


def test_a_hole_of_a_mirrored_object_is_filled_the_right_way_round():
    item = holed(6, [14])
    item.scale.x = -1
    bpy.context.view_layer.update()
    bpy.ops.saddleback.repair(fill_holes=4)
    assert border_count(item) == 24 and all(polygon.normal.z > 0.99 for polygon in item.data.polygons)
    check_paint(item)


def test_cracks_are_told_and_closed():
    vertices, faces = grid_arrays(4)
    near = vertices + [1 + 1e-6, 0, 0]
    item = add_object("Crack", np.concatenate([vertices, near]), np.concatenate([faces, faces + 25]))
    bpy.ops.saddleback.repair()
    assert "nothing to repair" in jobs.state.line and len(item.data.vertices) == 50
    assert any("10 border vertices lie close" in line and "Close Cracks" in line for line in jobs.state.figures)
    bpy.ops.saddleback.repair(close_cracks=True)
    assert "5 vertices welded" in jobs.state.line and not jobs.state.figures
    assert is_good(item) and len(item.data.vertices) == 45 and border_count(item) == 24
    assert all(len(polygon.vertices) == 4 for polygon in item.data.polygons)


def test_t_junctions_are_closed_and_the_paint_stays():
    vertices, faces = grid_arrays(2)
    side = np.array([[1, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0.0]])
    item = add_object("Crossing", np.concatenate([vertices, side]), [*faces.tolist(), [9, 10, 11, 12]])
    paint(item)
    bpy.ops.saddleback.repair()
    assert any("amid the edge" in line for line in jobs.state.figures)
    bpy.ops.saddleback.repair(close_cracks=True)
    assert is_good(item) and border_count(item) == 9 and not jobs.state.figures
    layer = item.data.uv_layers["Map"].data
    for loop in item.data.loops:
        place = item.data.vertices[loop.vertex_index].co
        assert tuple(layer[loop.index].uv) == pytest.approx(tuple(place[:2]), abs=1e-6)
    assert {polygon.material_index for polygon in item.data.polygons if polygon.center.x > 1} == {0}  # as the quad was


def test_the_repair_is_one_undo_step():
    vertices, faces = grid_arrays(4)
    add_object("Twice", vertices, np.concatenate([faces, faces[3:5]]))
    bpy.ops.ed.undo_push(message="start")
    bpy.ops.saddleback.repair("EXEC_DEFAULT", True)
    assert len(bpy.data.objects["Twice"].data.polygons) == 16
    bpy.ops.ed.undo()
    assert len(bpy.data.objects["Twice"].data.polygons) == 18
    bpy.ops.ed.redo()
    assert len(bpy.data.objects["Twice"].data.polygons) == 16


@pytest.mark.parametrize("seed", range(40))
def test_any_soup_of_polygons_becomes_a_surface(seed):
    rng = np.random.default_rng(seed)
    places = rng.integers(0, 3, (14, 3)).astype(float)
    faces = [tuple(rng.choice(14, rng.integers(3, 5), replace=False)) for _ in range(20)]
    item = add_object("Soup", places, faces)
    paint(item)
    try:
        bpy.ops.saddleback.repair()
    except RuntimeError as error:
        assert "'Soup'" in str(error)
        return
    assert is_good(item)

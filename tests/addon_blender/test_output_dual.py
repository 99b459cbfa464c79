# SPDX-License-Identifier: GPL-3.0-or-later
"""The dual mesh in Blender: where it is, what it keeps of the source, how it is replaced."""

import bpy
import numpy as np
import pytest
from output_scenes import HARD_PLACE, read_attribute, sphere_source, triangles_of, world_positions
from scenes import grid

from saddleback_blender import jobs

QUICK = {"count": 40, "iterations": 4, "k": 40, "make_edges": False, "make_dual": True}


def dual_of(source):
    return next(child for child in source.children if child.get("saddleback_role") == "dual")


def remeshed(source, **settings):
    bpy.ops.saddleback.tessellate(**{**QUICK, **settings})
    bpy.context.view_layer.update()
    return dual_of(source)


@pytest.mark.parametrize("place", [None, HARD_PLACE])
def test_vertices_lie_on_the_surface_and_faces_look_outwards(place):
    source = sphere_source(place=place)
    item = remeshed(source)
    assert len(item.data.vertices) == 40 and len(item.data.polygons) == 2 * 40 - 4
    assert not item.data.validate()
    own = np.array([vertex.co for vertex in item.data.vertices])
    radius = np.linalg.norm(own, axis=1)
    assert radius.max() <= 1 + 1e-6 and radius.min() > 0.95  # within the faces of the ball
    np.testing.assert_allclose(np.array(item.matrix_world), np.array(source.matrix_world), atol=1e-5)
    normals = np.array([polygon.normal for polygon in item.data.polygons])
    centers = np.array([polygon.center for polygon in item.data.polygons])
    assert (np.einsum("ij,ij->i", normals, centers) > 0).all()


def test_groups_maps_and_attributes_come_along():
    source = grid(n=12)
    mesh = source.data
    x, y = (np.array([vertex.co[axis] for vertex in mesh.vertices], np.float32) for axis in (0, 1))
    group = source.vertex_groups.new(name="Right")
    for vertex, weight in enumerate(x.tolist()):
        if weight > 0.5:
            group.add([vertex], weight, "REPLACE")
    source.vertex_groups.new(name="Empty")
    layer = mesh.uv_layers.new(name="Map")
    corners = np.array([loop.vertex_index for loop in mesh.loops])
    layer.data.foreach_set("uv", np.column_stack([1 - x[corners], 0.5 * y[corners]]).astype(np.float32).ravel())
    mesh.attributes.new("Height", "FLOAT", "POINT").data.foreach_set("value", 2 * x - y)
    mesh.attributes.new("Where", "FLOAT_VECTOR", "CORNER").data.foreach_set(
        "vector", np.column_stack([x, y, x + y])[corners].astype(np.float32).ravel()
    )
    mesh.attributes.new("Left", "BOOLEAN", "POINT").data.foreach_set("value", x < 0.5)
    mesh.attributes.new("Row", "INT", "FACE").data.foreach_set("value", np.arange(144, dtype=np.int32) // 12)
    mesh.color_attributes.new("Paint", "FLOAT_COLOR", "POINT").data.foreach_set(
        "color", np.column_stack([x, y, x, y]).astype(np.float32).ravel()
    )
    item = remeshed(source)
    made = item.data
    places = world_positions(item)
    px, py = places[:, 0], places[:, 1]
    np.testing.assert_allclose(read_attribute(made, "Height"), 2 * px - py, atol=1e-5)
    np.testing.assert_allclose(read_attribute(made, "Where"), np.column_stack([px, py, px + py]), atol=1e-5)
    np.testing.assert_allclose(read_attribute(made, "Paint"), np.column_stack([px, py, px, py]), atol=1e-5)
    np.testing.assert_array_equal(read_attribute(made, "Row"), np.floor(py * 12).astype(int))
    assert (read_attribute(made, "Left") == (px < 0.5))[abs(px - 0.5) > 0.1].all()
    uv = np.empty(2 * len(made.loops), np.float32)
    made.uv_layers["Map"].data.foreach_get("uv", uv)
    at = triangles_of(made).ravel()
    np.testing.assert_allclose(uv.reshape(-1, 2), np.column_stack([1 - px[at], 0.5 * py[at]]), atol=1e-5)
    assert [group.name for group in item.vertex_groups] == ["Right", "Empty"]
    weights = np.array([next((g.weight for g in vertex.groups if g.group == 0), 0.0) for vertex in made.vertices])
    far = abs(px - 0.5) > 0.1
    np.testing.assert_allclose(weights[far], np.where(px > 0.5, px, 0)[far], atol=1e-5)
    assert "saddleback_cell" not in made.attributes  # ours are not the artist's


def test_shading_and_materials_are_those_of_the_source():
    source = grid(n=8)
    for name in ("Low", "High"):
        source.data.materials.append(bpy.data.materials.new(name))
    for polygon in source.data.polygons:
        polygon.material_index = int(polygon.center.x > 0.5)
        polygon.use_smooth = polygon.center.y > 0.5
    item = remeshed(source)
    assert [material.name for material in item.data.materials] == ["Low", "High"]
    for polygon in item.data.polygons:
        first = item.data.vertices[polygon.vertices[0]].co
        assert polygon.material_index == int(first.x > 0.5) and polygon.use_smooth == (first.y > 0.5)


def test_a_second_run_replaces_it_and_one_without_it_takes_it_away():
    source = sphere_source()
    source.vertex_groups.new(name="All").add(range(len(source.data.vertices)), 0.5, "REPLACE")
    first = remeshed(source)
    name = first.name
    again = remeshed(source, count=60)
    assert again.name == name and len(again.data.vertices) == 60 and len(again.vertex_groups) == 1
    assert all(vertex.groups[0].weight == 0.5 for vertex in again.data.vertices)
    assert again.users_collection[0].name == "Saddleback"
    bpy.ops.saddleback.tessellate(**{**QUICK, "make_dual": False})
    assert not source.children


def test_modifiers_are_read_with_their_attributes():
    source = grid(n=4)
    source.data.uv_layers.new(name="Map")
    source.modifiers.new("Finer", "SUBSURF").subdivision_type = "SIMPLE"
    item = remeshed(source, use_modifiers=True)
    assert len(item.data.vertices) == 40 and "Map" in item.data.uv_layers


def test_the_panel_tells_quality_and_energy_and_faults_are_a_warning(capfd):
    source = sphere_source()
    remeshed(source)
    lines = bpy.context.window_manager.saddleback_figures.splitlines()
    assert len(lines) == 2 and "irregular" in lines[0] and "Energy" in lines[1]
    remeshed(source, count=2, dual_policy="STRICT")
    assert not any("irregular" in line for line in jobs.state.figures)
    assert "has faults where cells are too large" in capfd.readouterr().out
    item = remeshed(source, count=2, dual_policy="REPAIR")
    assert len(item.data.vertices) > 3 and not item.data.validate()
    assert "vertices added to the dual mesh" in jobs.state.line
    bpy.ops.saddleback.clear()
    assert not jobs.state.figures


def test_the_count_is_kept_unless_that_is_switched_off():
    source = sphere_source()
    for vertex in source.data.vertices:
        vertex.co = (0.15 * vertex.co.x, 0.15 * vertex.co.y, 2 * vertex.co.z)
    wanted = {"count": 60, "iterations": 20, "k": 60}
    kept = remeshed(source, **wanted)
    assert len(kept.data.vertices) == 60 and len(kept.data.polygons) == 2 * 60 - 4
    assert not kept.data.validate()
    assert "moved to where the dual mesh needs them" in jobs.state.line and "added" not in jobs.state.line
    more = remeshed(source, keep_count=False, **wanted)
    assert len(more.data.vertices) > 60 and len(more.data.polygons) == 2 * len(more.data.vertices) - 4
    assert "moved" not in jobs.state.line and "vertices added to the dual mesh" in jobs.state.line


def cut_cube(cuts):
    """A cube of quads: `cuts` more lines across each face."""
    bpy.ops.mesh.primitive_cube_add(size=2)
    source = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide(number_cuts=cuts)
    bpy.ops.object.mode_set(mode="OBJECT")
    return source


def volume_of(mesh):
    places = np.array([vertex.co for vertex in mesh.vertices])
    a, b, c = places[triangles_of(mesh)].transpose(1, 0, 2)
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


def test_sharp_edges_are_kept_where_that_is_wanted():
    source = cut_cube(15)
    source.data.edges.foreach_set("use_edge_sharp", np.zeros(len(source.data.edges), bool))
    wanted = {"count": 200, "iterations": 10, "k": 0}
    plain = remeshed(source, **wanted)
    assert volume_of(plain.data) < 0.98 * 8
    kept = remeshed(source, hold_sharp=True, **wanted)
    assert len(kept.data.vertices) == 200
    assert volume_of(kept.data) == pytest.approx(8, rel=1e-5)
    np.testing.assert_allclose(np.abs([vertex.co for vertex in kept.data.vertices]).max(axis=1), 1, atol=1e-6)


def test_marked_edges_and_borders_are_kept_where_that_is_wanted():
    source = grid(n=12)
    mesh = source.data
    x = np.array([vertex.co.x for vertex in mesh.vertices])
    marked = [abs(x[edge.vertices[0]] - 0.5) + abs(x[edge.vertices[1]] - 0.5) < 1e-6 for edge in mesh.edges]
    assert sum(marked) == 12
    mesh.edges.foreach_set("use_edge_sharp", np.array(marked))
    made = remeshed(source, count=60, hold_marked=True, hold_boundary=True)
    places = world_positions(made)[:, :2]
    assert (np.abs(places[:, 0] - 0.5) < 1e-6).sum() >= 6
    for corner in ((0, 0), (1, 0), (1, 1), (0, 1)):
        assert (np.abs(places - corner).max(axis=1) < 1e-6).sum() == 1
    assert sum(polygon.area for polygon in made.data.polygons) == pytest.approx(1, rel=1e-5)


def test_too_few_cells_for_the_lines_that_are_kept():
    source = cut_cube(3)
    with pytest.raises(RuntimeError, match="the curves need"):
        bpy.ops.saddleback.tessellate(**{**QUICK, "count": 6, "hold_sharp": True})
    assert not source.children

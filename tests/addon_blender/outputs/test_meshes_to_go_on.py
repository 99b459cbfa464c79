# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that an artist goes on with: polygons of the cells, quads, marked edges, materials."""

from collections import Counter

import bpy
import numpy as np
import pytest
from output_scenes import HARD_PLACE, edges_of, read_attribute, sphere_source, world_positions
from scenes import grid, positions

from saddleback_blender import compat, jobs

QUICK = {"count": 60, "iterations": 10, "k": 60, "make_edges": False}
POLYGONS = {**QUICK, "make_cells": True, "cell_faces": "ONE"}
OUTPUTS = {
    "polygons": {"make_cells": True, "cell_faces": "ONE"},
    "triangles": {"make_dual": True},
    "quads": {"make_dual": True, "dual_faces": "QUADS"},
}


def output(source, role):
    return next((child for child in source.children if child.get("saddleback_role") == role), None)


def made(source, **settings):
    """The cells or the dual mesh."""
    bpy.ops.saddleback.tessellate(**{**QUICK, **settings})
    bpy.context.view_layer.update()
    return output(source, "cells" if settings.get("make_cells") else "dual")


def loops(mesh):
    return [list(polygon.vertices) for polygon in mesh.polygons]


def check_mesh(mesh, characteristic, is_closed=True):
    """Neighbors run along their side in opposite directions, and no vertex is left over."""
    assert not mesh.validate()
    faces = loops(mesh)
    sides = Counter((a, b) for face in faces for a, b in zip(face, face[1:] + face[:1], strict=True))
    assert max(sides.values()) == 1
    assert is_closed == all(side[::-1] in sides for side in sides)
    assert len({v for face in faces for v in face}) == len(mesh.vertices)
    assert len(mesh.vertices) - len(mesh.edges) + len(faces) == characteristic


@pytest.mark.parametrize("place", [None, HARD_PLACE])
def test_every_cell_is_one_polygon_on_the_surface(place):
    source = sphere_source(levels=4, place=place)
    item = made(source, **POLYGONS, make_centers=True)
    mesh = item.data
    check_mesh(mesh, 2)
    assert len(mesh.polygons) == 60
    assert min(len(polygon.vertices) for polygon in mesh.polygons) >= 3
    inverse = np.array(source.matrix_world.inverted(), np.float64)
    radius = np.linalg.norm(world_positions(item) @ inverse[:3, :3].T + inverse[:3, 3], axis=1)
    assert radius.max() <= 1 + 1e-5 and radius.min() > 0.99
    cell = read_attribute(mesh, "saddleback_cell")
    np.testing.assert_array_equal(cell, np.arange(60))
    places, centers = world_positions(item), world_positions(output(source, "centers"))
    middle = world_positions(source).mean(axis=0)
    for face, number in zip(loops(mesh), cell, strict=True):
        corners = places[face]
        normal = np.cross(corners - corners.mean(axis=0), np.roll(corners, -1, axis=0) - corners.mean(axis=0)).sum(
            axis=0
        )
        assert normal @ (corners.mean(axis=0) - middle) > 0  # seen from outside
        if place is None:  # on the ball the nearest center through space is the nearest along it
            assert np.linalg.norm(centers - corners.mean(axis=0), axis=1).argmin() == number
    assert mesh.color_attributes["saddleback_color"].domain == "CORNER"
    assert output(source, "dual") is None and "cells" in jobs.state.line


def test_polygons_reach_the_border_and_its_corners():
    item = made(grid(n=12), **POLYGONS)
    check_mesh(item.data, 1, is_closed=False)
    assert sum(polygon.area for polygon in item.data.polygons) == pytest.approx(1, rel=1e-5)


def test_what_cannot_be_a_polygon_is_told_or_mended(capfd):
    bpy.ops.mesh.primitive_cylinder_add(vertices=32, depth=40, end_fill_type="NOTHING")
    source = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide(number_cuts=5)
    bpy.ops.object.mode_set(mode="OBJECT")
    few = {**POLYGONS, "count": 3, "keep_count": False}
    whole = made(source, **few)
    check_mesh(whole.data, 0, is_closed=False)
    added = len(whole.data.polygons) - 3
    assert added > 0 and f"{added} cells added so that all can be polygons" in jobs.state.line
    strict = made(source, **few, dual_policy="STRICT")
    assert len(strict.data.polygons) < 3
    assert "no face, since none can be as large" in capfd.readouterr().out


def test_patches_are_as_few_as_the_error_needs(capfd):
    bpy.ops.mesh.primitive_cube_add(location=(3, 1, 0), rotation=(0.3, 0.2, 0.1))
    box = bpy.context.object
    box.modifiers.new("Finer", "SUBSURF").subdivision_type = "SIMPLE"
    patches = {**POLYGONS, "cell_faces": "PATCHES"}
    item = made(box, **patches, patch_error=0.1, use_modifiers=True)
    assert "6 patches" in capfd.readouterr().out
    check_mesh(item.data, 2)
    assert [len(polygon.vertices) for polygon in item.data.polygons] == [4] * 6
    np.testing.assert_allclose(
        sorted(map(tuple, np.round(world_positions(item), 5))), sorted(map(tuple, np.round(world_positions(box), 5)))
    )
    ball = sphere_source(levels=4)
    faces = {}
    for error in (5.0, 1.0):
        mesh = made(ball, **patches, patch_error=error).data
        check_mesh(mesh, 2)
        faces[error] = len(mesh.polygons)
        assert not any(polygon.use_smooth for polygon in mesh.polygons)
        ends = positions(mesh)[np.array([edge.vertices[:] for edge in mesh.edges])]  # in whatever triangles faces have
        assert np.linalg.norm(ends.mean(axis=1), axis=1).min() > 1 - error / 100 * 2 * 3**0.5
    assert faces[5.0] < faces[1.0]
    with pytest.raises(RuntimeError, match="patches are not mirrored"):
        bpy.ops.saddleback.tessellate(**patches, mirror_x=True)


def test_a_mirrored_pattern_has_an_edge_along_the_plane():
    source = sphere_source(levels=4)
    item = made(source, **POLYGONS, mirror_x=True)
    check_mesh(item.data, 2)
    places = positions(item.data) + np.float32(0)
    flipped = places * np.array([-1, 1, 1], np.float32) + np.float32(0)
    assert {place.tobytes() for place in places} == {place.tobytes() for place in flipped}
    assert (places[:, 0] == 0).sum() > 6
    colors = read_attribute(item.data, "saddleback_color")
    assert len(np.unique(colors, axis=0)) > 5
    quads = made(source, **OUTPUTS["quads"], mirror_x=True)
    check_mesh(quads.data, 2)
    assert {len(face) for face in loops(quads.data)} == {4}


@pytest.mark.parametrize("place", [None, HARD_PLACE])
def test_quads_have_the_vertices_of_the_dual_mesh_and_lie_on_the_surface(place):
    source = sphere_source(levels=4, place=place)
    triangles = made(source, **OUTPUTS["triangles"])
    vertices, count = positions(triangles.data), len(triangles.data.polygons)
    quads = made(source, **OUTPUTS["quads"])
    check_mesh(quads.data, 2)
    assert {len(face) for face in loops(quads.data)} == {4} and len(quads.data.polygons) == 3 * count
    np.testing.assert_array_equal(positions(quads.data)[:60], vertices)
    radius = np.linalg.norm(positions(quads.data), axis=1)
    assert radius.max() <= 1 + 1e-5 and radius.min() > 0.99
    normals = np.array([polygon.normal for polygon in quads.data.polygons])
    centers = np.array([polygon.center for polygon in quads.data.polygons])
    assert (np.einsum("ij,ij->i", normals, centers) > 0).all()


def marked_grid():
    """A square with a seam at x = 0.5, a crease at y = 0.5, sharp edges at y = 0.25, and a map in two parts."""
    source = grid(n=12)
    mesh = source.data
    middle = np.array([[mesh.vertices[v].co for v in edge.vertices] for edge in mesh.edges]).mean(axis=1)
    is_along = [abs(np.diff([mesh.vertices[v].co for v in edge.vertices], axis=0)[0]) for edge in mesh.edges]
    across_x, across_y = (np.array([way[axis] < 1e-6 for way in is_along]) for axis in (0, 1))
    seam = across_x & (abs(middle[:, 0] - 0.5) < 1e-6)
    crease = across_y & (abs(middle[:, 1] - 0.5) < 1e-6)
    sharp = across_y & (abs(middle[:, 1] - 0.25) < 1e-6)
    assert seam.sum() == crease.sum() == sharp.sum() == 12
    mesh.edges.foreach_set("use_seam", seam)
    mesh.edges.foreach_set("use_edge_sharp", sharp)
    compat.write_creases(mesh, np.where(crease, 0.75, 0.0).astype(np.float32))
    layer = mesh.uv_layers.new(name="Map")
    corners = np.array([mesh.vertices[loop.vertex_index].co for loop in mesh.loops])
    right = np.repeat([polygon.center.x > 0.5 for polygon in mesh.polygons], 4)
    layer.data.foreach_set("uv", (corners[:, :2] + np.outer(right, (3, 0))).astype(np.float32).ravel())
    return source


@pytest.mark.parametrize("kind", ["triangles", "quads"])
def test_marked_edges_are_edges_of_the_remesh_marked_alike(kind):
    source = marked_grid()
    item = made(source, **OUTPUTS[kind], count=90, hold_marked=True, hold_boundary=True)
    mesh, places = item.data, world_positions(item)[:, :2]
    ends = places[edges_of(mesh)]
    seam, sharp = (np.array([getattr(edge, name) for edge in mesh.edges]) for name in ("use_seam", "use_edge_sharp"))
    crease = compat.read_creases(mesh)
    for marked, axis, where in ((seam, 0, 0.5), (sharp, 1, 0.25), (crease > 0, 1, 0.5)):
        np.testing.assert_allclose(ends[marked][:, :, axis], where, atol=1e-6)
        assert np.linalg.norm(np.diff(ends[marked], axis=1), axis=2).sum() == pytest.approx(1, rel=1e-5)
    np.testing.assert_array_equal(np.unique(crease), [0, 0.75])
    # The map is not stretched over the seam: all corners of a face are on its side.
    uv = np.empty(2 * len(mesh.loops), np.float32)
    mesh.uv_layers["Map"].data.foreach_get("uv", uv)
    at = np.array([loop.vertex_index for loop in mesh.loops])
    sides = len(mesh.loops) // len(mesh.polygons)
    right = np.repeat([polygon.center.x > 0.5 for polygon in mesh.polygons], sides)
    np.testing.assert_allclose(uv.reshape(-1, 2), places[at] + np.outer(right, (3, 0)), atol=1e-4)


def test_without_keeping_them_no_edge_is_marked():
    item = made(marked_grid(), **OUTPUTS["triangles"])
    assert not any(edge.use_seam or edge.use_edge_sharp for edge in item.data.edges)
    assert not compat.read_creases(item.data).any()


def materials_by_nodes(source, first, second):
    """A modifier that gives faces beyond x = 0.5 the second material, and the others the first."""
    group = bpy.data.node_groups.new("Paint", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        compat.new_group_socket(group, "Geometry", way, "NodeSocketGeometry")
    names = ("NodeGroupInput", "NodeGroupOutput", "GeometryNodeSetMaterial", "GeometryNodeSetMaterial",
             "GeometryNodeInputPosition", "ShaderNodeSeparateXYZ", "FunctionNodeCompare")  # fmt: skip
    begin, end, all_of_them, some, place, split, compare = (group.nodes.new(name) for name in names)
    compare.inputs[1].default_value = 0.5
    all_of_them.inputs["Material"].default_value, some.inputs["Material"].default_value = first, second
    link = group.links.new
    link(place.outputs[0], split.inputs[0])
    link(split.outputs["X"], compare.inputs[0])
    link(compare.outputs[0], some.inputs["Selection"])
    link(begin.outputs[0], all_of_them.inputs["Geometry"])
    link(all_of_them.outputs[0], some.inputs["Geometry"])
    link(some.outputs[0], end.inputs[0])
    source.modifiers.new("Paint", "NODES").node_group = group


def check_materials(item, source):
    """Faces that lie all to one side of x = 0.5 show the material of that side."""
    places, count = world_positions(item), 0
    for polygon in item.data.polygons:
        x = places[list(polygon.vertices), 0]
        if x.max() < 0.4 or x.min() > 0.6:
            shown = item.material_slots[polygon.material_index].material
            assert shown.name == ("Left" if x.max() < 0.4 else "Right"), shown.name
            count += 1
    assert count > 20


@pytest.mark.parametrize("way", ["nodes", "object"])
@pytest.mark.parametrize("kind", OUTPUTS)
def test_materials_of_nodes_and_of_the_object_come_along(kind, way):
    source = grid(n=24)
    left, right = (bpy.data.materials.new(name) for name in ("Left", "Right"))
    if way == "nodes":
        materials_by_nodes(source, left, right)
    else:
        for number, material in enumerate((left, right)):
            source.data.materials.append(bpy.data.materials.new(f"Of the mesh {number}"))
            source.material_slots[number].link = "OBJECT"
            source.material_slots[number].material = material
        for polygon in source.data.polygons:
            polygon.material_index = int(polygon.center.x > 0.5)
    item = made(source, **OUTPUTS[kind], count=100, use_modifiers=way == "nodes")
    check_materials(item, source)


def test_materials_that_were_put_on_the_object_of_an_output_stay():
    source = grid(n=12)
    for kind, settings in OUTPUTS.items():
        item = made(source, **settings)
        own = bpy.data.materials.new(f"Own {kind}")
        if not item.material_slots:
            item.data.materials.append(None)
        item.material_slots[0].link = "OBJECT"
        item.material_slots[0].material = own
        again = made(source, **settings, count=50)
        assert again == item
        assert (item.material_slots[0].link, item.material_slots[0].material) == ("OBJECT", own)


@pytest.mark.parametrize("kind", OUTPUTS)
def test_groups_and_attributes_come_along(kind):
    source = grid(n=12)
    mesh = source.data
    x = np.array([vertex.co.x for vertex in mesh.vertices], np.float32)
    mesh.attributes.new("Height", "FLOAT", "POINT").data.foreach_set("value", 2 * x)
    group = source.vertex_groups.new(name="Right")
    for vertex, weight in enumerate(x.tolist()):
        group.add([vertex], weight, "REPLACE")
    item = made(source, **OUTPUTS[kind])
    places = world_positions(item)[:, 0]
    np.testing.assert_allclose(read_attribute(item.data, "Height"), 2 * places, atol=1e-5)
    weights = [next((g.weight for g in vertex.groups), 0.0) for vertex in item.data.vertices]
    np.testing.assert_allclose(weights, places, atol=1e-5)

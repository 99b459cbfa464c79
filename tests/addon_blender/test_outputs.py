# SPDX-License-Identifier: GPL-3.0-or-later
"""What the output objects hold, in all Blender versions."""

from dataclasses import replace

import bpy
import numpy as np
import pytest
from output_scenes import (
    HARD_PLACE,
    edges_of,
    in_world,
    read_attribute,
    result_of,
    sphere_source,
    triangles_of,
    world_positions,
)
from scenes import add_object, grid, tube_radius

from saddleback_blender import compat, nodes
from saddleback_blender.bridge.outputs.out_attributes import clear_attributes, write_vertex_attributes
from saddleback_blender.bridge.outputs.out_cells import write_cells
from saddleback_blender.bridge.outputs.out_centers import write_centers
from saddleback_blender.bridge.outputs.out_edges import write_edges
from saddleback_blender.core.errors import BadInputError
from saddleback_blender.core.settings import TessellateSettings
from saddleback_blender.core.surfaces.cell_colors import cell_colors
from tests import synthetic_cells
from tests.synthetic_cells import triangle_areas


def evaluated_mesh(item):
    bpy.context.view_layer.update()
    return item.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()


def instances_of(item):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    depsgraph.update()
    return [
        (np.array(i.matrix_world), i.object.original)
        for i in depsgraph.object_instances
        if i.is_instance and i.parent is not None and i.parent.original == item
    ]


# --- attributes -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("values", "kind"),
    [
        (np.arange(169, dtype=np.int32) - 5, "INT"),
        (np.linspace(-1, 1, 169).astype(np.float32), "FLOAT"),
        (np.arange(169) % 3 == 0, "BOOLEAN"),
        (np.arange(507, dtype=np.float32).reshape(169, 3), "FLOAT_VECTOR"),
        (np.arange(676, dtype=np.float32).reshape(169, 4), "FLOAT_COLOR"),
    ],
)
def test_arrays_come_back_exactly(values, kind):
    item = grid(n=12)
    write_vertex_attributes(item, {"mine": values})
    attribute = item.data.attributes["mine"]
    assert (attribute.data_type, attribute.domain) == (kind, "POINT")
    np.testing.assert_array_equal(read_attribute(item.data, "mine"), values)


def test_an_attribute_of_another_type_or_domain_is_replaced():
    item = grid(n=2)
    item.data.attributes.new("a", "INT", "POINT")
    item.data.attributes.new("b", "FLOAT", "FACE")
    values = np.arange(9, dtype=np.float32)
    write_vertex_attributes(item, {"a": values, "b": values})
    for name in "ab":
        assert (item.data.attributes[name].data_type, item.data.attributes[name].domain) == ("FLOAT", "POINT")
        np.testing.assert_array_equal(read_attribute(item.data, name), values)


def test_doubles_and_strided_arrays_are_taken():
    item = grid(n=2)
    values = np.arange(18, dtype=np.float64)[::2]
    write_vertex_attributes(item, {"a": values, "b": np.arange(9)})
    np.testing.assert_array_equal(read_attribute(item.data, "a"), values.astype(np.float32))
    assert item.data.attributes["b"].data_type == "INT"


def test_a_wrong_length_is_refused_in_words():
    with pytest.raises(BadInputError, match="attribute 'a' has 4 values for 9 elements"):
        write_vertex_attributes(grid(n=2), {"a": np.zeros(4)})


def test_only_our_attributes_are_cleared():
    item = grid(n=2)
    item.data.attributes.new("theirs", "FLOAT", "POINT")
    item.data["note"] = "theirs"
    before = set(item.data.attributes.keys())
    write_vertex_attributes(item, {"a": np.zeros(9), "b": np.zeros(9)})
    write_vertex_attributes(item, {"c": np.zeros(9)})
    item.data.attributes.remove(item.data.attributes["b"])  # the artist was faster
    assert clear_attributes(item) == 2
    assert set(item.data.attributes.keys()) == before
    assert list(item.data.keys()) == ["note"]


# --- edges ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("hard", [False, True])
def test_edge_mesh_lies_on_the_surface_and_shares_branch_points(hard):
    source = sphere_source(place=HARD_PLACE if hard else None)
    result = result_of(source)
    item = write_edges(bpy.context, source, result, TessellateSettings())
    bpy.context.view_layer.update()
    degree = np.bincount(edges_of(item.data).ravel())
    assert set(degree) == {2, 3}
    ends = result.edge_points[np.concatenate([result.edge_offsets[:-1], result.edge_offsets[1:] - 1])]
    assert (degree == 3).sum() == len(np.unique(ends[np.tile(~result.edge_closed, 2)], axis=0))
    places = world_positions(item)
    points = in_world(source, result.edge_points)
    nearest = np.linalg.norm(places[:, None] - points[None], axis=2).min(axis=1)
    assert nearest.max() < 1e-5
    a, b = (places[edges_of(item.data)[:, i]] for i in range(2))
    wanted = 0.0
    for i in range(len(result.edge_closed)):
        line = result.edge_points[result.edge_offsets[i] : result.edge_offsets[i + 1]]
        wanted += np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
    assert np.linalg.norm(b - a, axis=1).sum() == pytest.approx(wanted, rel=1e-4)


def test_edges_know_the_cells_on_both_sides():
    source = sphere_source()
    result = result_of(source)
    mesh = write_edges(bpy.context, source, result, TessellateSettings()).data
    pairs = np.column_stack([read_attribute(mesh, f"saddleback_cell_{side}") for side in "ab"])
    assert {tuple(pair) for pair in pairs} == {tuple(pair) for pair in result.edge_cells}


def test_tubes_are_round_and_closed_in_the_world_whatever_the_scale():
    source = sphere_source(place=HARD_PLACE)
    result = result_of(source)
    item = write_edges(bpy.context, source, result, TessellateSettings(edge_radius=0.02))
    tubes = evaluated_mesh(item)
    places = world_positions(item, tubes)
    line = world_positions(item)
    a, b = (line[edges_of(item.data)[:, i]] for i in range(2))
    along = b - a
    t = np.einsum("pek,ek->pe", places[:, None] - a[None], along) / np.einsum("ek,ek->e", along, along)
    nearest = a[None] + np.clip(t, 0, 1)[..., None] * along[None]
    away = np.linalg.norm(places[:, None] - nearest, axis=2).min(axis=1)
    assert away.max() < 0.02 * 1.001  # no spike
    assert np.median(away) > 0.02 * 0.9
    used = {tubes.materials[polygon.material_index].name for polygon in tubes.polygons}
    assert used == {"Saddleback Edges"}
    # A ball at every branch point: something is a radius away in the direction of the tubes' angle bisectors.
    joints = line[np.bincount(edges_of(item.data).ravel()) == 3]
    to_joint = np.linalg.norm(places[:, None] - joints[None], axis=2)
    assert (np.abs(to_joint - 0.02).min(axis=0) < 1e-4).all()


def test_the_radius_stays_live_and_a_second_run_sets_it():
    source = sphere_source()
    result = result_of(source)
    item = write_edges(bpy.context, source, result, TessellateSettings(edge_radius=0.02))
    modifier = nodes.modifier_of(item, nodes.TUBES)
    narrow = world_positions(item, evaluated_mesh(item))
    compat.set_modifier_input(modifier, "Radius", 0.1)
    wide = world_positions(item, evaluated_mesh(item))
    assert np.linalg.norm(wide, axis=1).max() > np.linalg.norm(narrow, axis=1).max() + 0.05
    compat.set_modifier_input(modifier, "Resolution", 5)
    assert write_edges(bpy.context, source, result, TessellateSettings(edge_radius=0.03)) == item
    modifier = nodes.modifier_of(item, nodes.TUBES)
    assert compat.modifier_input(modifier, "Radius") == pytest.approx(0.03)
    assert compat.modifier_input(modifier, "Resolution") == 5
    assert len(item.modifiers) == 1


def test_closed_lines_become_closed_tubes_and_curves():
    source = grid(n=20)
    result = result_of(source, count=2)
    middle = np.linalg.norm(result.mesh.vertices[:, :2] - 0.5, axis=1)
    assert middle.min() < 0.05
    turn = np.linspace(0, 2 * np.pi, 33)[:-1]
    loop = np.column_stack([0.5 + 0.3 * np.cos(turn), 0.5 + 0.3 * np.sin(turn), 0 * turn])
    result = replace(
        result,
        edge_points=loop,
        edge_offsets=np.array([0, 32], np.int32),
        edge_cells=np.array([[0, 1]], np.int32),
        edge_closed=np.array([True]),
    )
    item = write_edges(bpy.context, source, result, TessellateSettings())
    assert len(item.data.edges) == len(item.data.vertices) == 32
    tubes = evaluated_mesh(item)
    # A torus: as many edges as vertices and faces together.
    assert len(tubes.vertices) - len(tubes.edges) + len(tubes.polygons) == 0
    item = write_edges(bpy.context, source, result, TessellateSettings(edge_kind="CURVE"))
    assert [spline.use_cyclic_u for spline in item.data.splines] == [True]


@pytest.mark.parametrize("hard", [False, True])
def test_curve_object_holds_the_same_lines(hard):
    source = sphere_source(place=HARD_PLACE if hard else None)
    result = result_of(source)
    item = write_edges(bpy.context, source, result, TessellateSettings(edge_kind="CURVE", edge_radius=0.03))
    bpy.context.view_layer.update()
    assert item.type == "CURVE"
    assert tube_radius(item) == pytest.approx(0.03)
    assert {spline.type for spline in item.data.splines} == {"POLY"}
    assert len(item.data.splines) < 0.7 * len(result.edge_closed)
    places = []
    for spline in item.data.splines:
        co = np.empty(4 * len(spline.points), np.float32)
        spline.points.foreach_get("co", co)
        places.append(co.reshape(-1, 4)[:, :3])
    matrix = np.array(item.matrix_world, np.float64)
    places = np.concatenate(places) @ matrix[:3, :3].T + matrix[:3, 3]
    there = np.linalg.norm(places[:, None] - in_world(source, result.edge_points)[None], axis=2)
    assert there.min(axis=1).max() < 1e-5
    assert there.min(axis=0).max() < 1e-5
    assert item.data.materials[0].name == "Saddleback Edges"


# --- cells ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("hard", [False, True])
def test_cells_cover_the_surface_with_the_right_side_out(hard):
    source = sphere_source(place=HARD_PLACE if hard else None)
    result = result_of(source)
    item = write_cells(bpy.context, source, result, TessellateSettings())
    bpy.context.view_layer.update()
    mesh, places = item.data, world_positions(item)
    triangles, cell = triangles_of(mesh), read_attribute(mesh, "saddleback_cell")
    assert mesh.attributes["saddleback_cell"].domain == "FACE"
    areas = np.bincount(cell, triangle_areas(places, triangles))
    np.testing.assert_allclose(areas, result.cell_area, rtol=1e-5)
    a, b, c = (places[triangles[:, i]] - np.array(source.matrix_world)[:3, 3] for i in range(3))
    assert np.einsum("ij,ij->", a, np.cross(b, c)) > 0
    assert item.matrix_world.determinant() > 0
    assert len(mesh.vertices) == len(result.mesh.vertices)
    assert not mesh.validate()


@pytest.mark.parametrize("gap", [0.02, 0.0])
def test_every_face_of_a_cell_has_its_color_and_neighbors_differ(gap):
    source = sphere_source()
    result = result_of(source, gap=gap)
    mesh = write_cells(bpy.context, source, result, TessellateSettings()).data
    cell = np.repeat(read_attribute(mesh, "saddleback_cell"), 3)
    assert mesh.color_attributes["saddleback_color"].domain == "CORNER"
    color = read_attribute(mesh, "saddleback_color")
    first = np.array([color[cell == i][0] for i in range(25)])
    np.testing.assert_array_equal(color, first[cell])
    a, b = (first[result.edge_cells[:, i]] for i in range(2))
    assert np.abs(a - b).max(axis=1).min() > 0.03
    np.testing.assert_allclose(first[:, :3], cell_colors(25, result.edge_cells), atol=0.005)
    assert mesh.color_attributes.active_color.name == "saddleback_color"
    assert mesh.materials[0].name == "Saddleback Cells"


@pytest.mark.parametrize("shape", [{}, {"gap": 0.02, "inset": 0.02, "thickness": 0.1}])
def test_cells_have_the_edges_that_blender_gives_them(shape):
    source = sphere_source()
    mesh = write_cells(bpy.context, source, result_of(source, **shape), TessellateSettings()).data
    own = np.sort(compat.read_edge_vertices(mesh), axis=1)
    corners = compat.read_corner_vertices(mesh).reshape(-1, 3)
    sides = np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    np.testing.assert_array_equal(own[compat.read_numbers(mesh.loops, "edge_index")], sides)
    assert not mesh.validate()
    mesh.update(calc_edges=True)
    again = np.sort(compat.read_edge_vertices(mesh), axis=1)
    np.testing.assert_array_equal(np.unique(own, axis=0), np.unique(again, axis=0))
    assert len(own) == len(again)


@pytest.mark.parametrize("smooth", [False, True])
def test_cells_are_shaded_as_their_surface(smooth):
    source = sphere_source()
    source.data.polygons.foreach_set("use_smooth", np.full(len(source.data.polygons), smooth))
    result = result_of(source, gap=0.02, inset=0.02, thickness=0.1)
    mesh = write_cells(bpy.context, source, result, TessellateSettings()).data
    assert {polygon.use_smooth for polygon in mesh.polygons} == {smooth}


def test_gap_inset_and_thickness_are_world_lengths():
    """A plane, stretched, mirrored and turned, in two cells whose boundary is nearly a straight line."""
    source = add_object("Sheet", *synthetic_cells.grid(12, 12))
    source.matrix_world = HARD_PLACE
    bpy.context.view_layer.update()
    result = result_of(source, sites=[6 * 12 + 2, 6 * 12 + 9], gap=0.04, inset=0.02, thickness=0.3)
    item = write_cells(bpy.context, source, result, TessellateSettings())
    bpy.context.view_layer.update()
    matrix = np.array(HARD_PLACE, np.float64)
    across, up = matrix[:3, 0] / np.linalg.norm(matrix[:3, 0]), np.cross(matrix[:3, 1], matrix[:3, 0])
    up /= np.linalg.norm(up)  # the mirrored plane shows its upper side downwards
    places = world_positions(item) - matrix[:3, 3]
    x = places @ across - 0.5 * np.linalg.norm(matrix[:3, 0])
    assert np.abs(x).min() == pytest.approx(0.02, abs=2e-3)
    height = places @ up
    assert height.max() == pytest.approx(0.3, abs=1e-5)
    assert height.min() == pytest.approx(0.0, abs=1e-5)
    raised = np.abs(height - 0.3) < 1e-5
    assert np.abs(x)[raised].min() == pytest.approx(0.04, abs=2e-3)


def test_swallowed_cells_are_counted_and_an_empty_mesh_is_no_error():
    source = sphere_source()
    assert not len(result_of(source).mesh.vanished)
    result = result_of(source, gap=50.0, inset=0.1, thickness=0.2)
    assert len(result.mesh.vanished) == 25
    item = write_cells(bpy.context, source, result, TessellateSettings())
    assert len(item.data.polygons) == 0


# --- centers ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("hard", [False, True])
def test_centers_carry_cell_area_normal_and_size(hard):
    source = sphere_source(place=HARD_PLACE if hard else None)
    result = result_of(source)
    item = write_centers(bpy.context, source, result, TessellateSettings())
    bpy.context.view_layer.update()
    mesh = item.data
    assert (len(mesh.vertices), len(mesh.edges), len(item.modifiers)) == (25, 0, 0)
    np.testing.assert_allclose(world_positions(item), in_world(source, result.sites_position), atol=1e-5)
    np.testing.assert_array_equal(read_attribute(mesh, "saddleback_cell"), np.arange(25))
    np.testing.assert_allclose(read_attribute(mesh, "saddleback_area"), result.cell_area, rtol=1e-6)
    np.testing.assert_allclose(np.pi * read_attribute(mesh, "saddleback_size") ** 2, result.cell_area, rtol=1e-5)
    turn = np.array(item.matrix_world)[:3, :3]
    normal = read_attribute(mesh, "saddleback_normal") @ turn.T
    np.testing.assert_allclose(normal, in_world(source, result.sites_normal, 0.0), atol=1e-5)


@pytest.mark.parametrize("hard", [False, True])
def test_instances_stand_upright_on_every_center_in_the_size_of_the_cell(hard):
    source = sphere_source(place=HARD_PLACE if hard else None)
    cone = add_object("Cone", [(-1, -1, 0), (1, -1, 0), (0, 1, 0), (0, 0, 2)], [(0, 1, 2), (0, 1, 3)], active=False)
    cone.matrix_world = HARD_PLACE  # its own place and scale do not matter
    result = result_of(source)
    item = write_centers(bpy.context, source, result, TessellateSettings(instance_object="Cone", instance_scale=0.5))
    found = instances_of(item)
    assert len(found) == 25
    size = 0.5 * np.sqrt(result.cell_area / np.pi)
    sites, normals = in_world(source, result.sites_position), in_world(source, result.sites_normal, 0.0)
    for matrix, instanced in found:
        assert instanced == cone
        i = int(np.linalg.norm(sites - matrix[:3, 3], axis=1).argmin())
        np.testing.assert_allclose(matrix[:3, 3], sites[i], atol=1e-5)
        np.testing.assert_allclose(matrix[:3, 2], size[i] * normals[i], atol=1e-5)
        np.testing.assert_allclose(matrix[:3, :3].T @ matrix[:3, :3], size[i] ** 2 * np.eye(3), atol=1e-5)


def test_another_object_takes_the_place_of_the_first_and_none_leaves_points():
    source = sphere_source()
    result = result_of(source)
    for name in ("One", "Two"):
        add_object(name, [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], active=False)
    for name in ("One", "Two"):
        item = write_centers(bpy.context, source, result, TessellateSettings(instance_object=name))
        assert {instanced.name for _, instanced in instances_of(item)} == {name}
        assert len(item.modifiers) == len(bpy.data.node_groups) == 1
    item = write_centers(bpy.context, source, result, TessellateSettings())
    assert (len(item.modifiers), len(bpy.data.node_groups)) == (0, 0)
    assert instances_of(item) == []


def test_what_cannot_stand_on_the_centers_is_refused():
    source = sphere_source()
    result = result_of(source)
    with pytest.raises(BadInputError, match="no object 'Nobody'"):
        write_centers(bpy.context, source, result, TessellateSettings(instance_object="Nobody"))
    item = write_centers(bpy.context, source, result, TessellateSettings())
    with pytest.raises(BadInputError, match="holds the centers themselves"):
        write_centers(bpy.context, source, result, TessellateSettings(instance_object=item.name))

# SPDX-License-Identifier: GPL-3.0-or-later
"""A layer covers a part of its object: painted, a group, selected faces or a material."""

import bpy
import numpy as np
import pytest
from scenes import attribute, fingerprint, grid, positions, select, sphere

from saddleback_blender.bridge.inputs.mesh_in import read_surface
from saddleback_blender.core.surfaces.parts import NO_EDGES, part

QUICK = {"iterations": 2, "k": 30}


def upper(item):
    """(polygons,) whose centers lie above the middle."""
    return np.array([polygon.center.z > 0 for polygon in item.data.polygons])


def half(item, kind):
    """Makes a region of the upper half."""
    faces = upper(item)
    if kind == "MATERIAL":
        for name in ("Skin", "Belly"):
            item.data.materials.append(bpy.data.materials.new(name))
        item.data.polygons.foreach_set("material_index", faces.astype(np.int32))
        return "Belly"
    if kind == "FACES":
        select(item, [])
        item.data.polygons.foreach_set("select", faces)
        bpy.ops.saddleback.region_from_selection()
        return item.saddleback.region_name
    vertices = np.unique([v for polygon, inside in zip(item.data.polygons, faces, strict=True) if inside
                          for v in polygon.vertices])  # fmt: skip
    if kind == "VERTEX_GROUP":
        item.vertex_groups.new(name="Up").add(vertices.tolist(), 1.0, "REPLACE")
        return "Up"
    layer = item.data.color_attributes.new("Up", "FLOAT_COLOR", "CORNER")
    corners = np.repeat(faces, [polygon.loop_total for polygon in item.data.polygons])
    layer.data.foreach_set("color", np.repeat(corners.astype(np.float32), 4))
    return "Up"


@pytest.mark.parametrize("kind", ["VERTEX_GROUP", "ATTRIBUTE", "FACES", "MATERIAL"])
@pytest.mark.parametrize("subdivided", [False, True])
def test_a_layer_covers_its_region_and_nothing_else(kind, subdivided):
    item = sphere("Ball")
    name = half(item, kind)
    if subdivided:
        item.modifiers.new("Finer", "SUBSURF").levels = 1
    bpy.ops.saddleback.tessellate(
        count=20, region=kind, region_name=name, use_modifiers=subdivided, make_cells=True, **QUICK
    )
    places = positions(bpy.data.objects["Ball Cells"].data)
    assert places[:, 2].min() > -0.35 and places[:, 2].max() > 0.9
    if not subdivided:
        cells = attribute(item, "saddleback_cell")
        heights = positions(item.data)[:, 2]
        assert set(cells[heights > 0.1]) <= set(range(20)) and set(cells[heights < -0.4]) == {-1}
        assert cells.max() == 19 and np.isinf(attribute(item, "saddleback_distance")[heights < -0.4]).all()
    assert item.saddleback.region == kind
    bpy.ops.saddleback.distance(sources="CURSOR")  # in the same layer, and so in the same region
    distances = attribute(bpy.data.objects.get("Ball Surface", item), "saddleback_distance")
    assert np.isinf(distances).any() and np.isfinite(distances).any()


def test_shapes_and_the_remesh_stay_in_the_region():
    item = sphere("Ball", 4)
    half(item, "MATERIAL")
    bpy.ops.saddleback.distribute(
        shapes="STUDS", count=30, make_cut=True, write_attributes=True, region="MATERIAL", region_name="Belly"
    )
    for name in ("Ball Shapes", "Ball Shape Cut"):
        assert positions(bpy.data.objects[name].data)[:, 2].min() > -0.1, name
    slots = [slot.name for slot in bpy.data.objects["Ball Shape Cut"].material_slots]
    cut = bpy.data.objects["Ball Shape Cut"].data
    bare = [p for p, a in zip(cut.polygons, cut.attributes["saddleback_shape"].data, strict=True) if a.value < 0]
    assert bare and {slots[polygon.material_index] for polygon in bare} == {"Belly"}
    bpy.ops.saddleback.tessellate(count=60, make_edges=False, make_dual=True, **QUICK)
    dual = bpy.data.objects["Ball Dual"]
    assert positions(dual.data)[:, 2].min() > -0.1
    assert {dual.material_slots[polygon.material_index].name for polygon in dual.data.polygons} == {"Belly"}


def with_material(item, name, is_inside):
    """Gives a material to the faces whose centers are inside."""
    for label in ("Skin", name):
        item.data.materials.append(bpy.data.materials.new(label))
    item.data.polygons.foreach_set(
        "material_index", np.array([is_inside(p.center) for p in item.data.polygons], np.int32)
    )
    return {"region": "MATERIAL", "region_name": name}


def test_paths_do_not_leave_the_region():
    """Of a square with a notch: from one arm to the other the way leads around it."""
    item = grid("Square", 20)
    region = with_material(item, "Arms", lambda place: abs(place.x - 0.5) > 0.2 or place.y < 0.25)
    select(item, [20 * 21, 20 * 21 + 20])  # the upper corners
    bpy.ops.saddleback.path()
    assert bpy.data.objects["Square Paths"]["saddleback_length"] == pytest.approx(1.0, rel=1e-5)
    bpy.ops.saddleback.path(**region, quality="EXACT")
    around = 2 * np.hypot(0.3, 0.75) + 0.4
    assert bpy.data.objects["Square Paths"]["saddleback_length"] == pytest.approx(around, rel=1e-5)
    select(item, [20 * 21 + 10, 0])
    with pytest.raises(RuntimeError, match="the point at vertex 430 belongs to no face of the layer's region"):
        bpy.ops.saddleback.path()


@pytest.mark.parametrize("domain", ["POINT", "FACE"])
def test_a_field_is_zero_outside_of_the_region(domain):
    item = sphere("Ball", 3)
    half(item, "MATERIAL")
    bpy.ops.saddleback.direction_field(
        region="MATERIAL", region_name="Belly", domain=domain, make_streamlines=True, arrow_count=100
    )
    data = item.data.attributes["saddleback_direction"].data
    vectors = np.empty(3 * len(data), np.float32)
    data.foreach_get("vector", vectors)
    length = np.linalg.norm(vectors.reshape(-1, 3), axis=1)
    if domain == "POINT":
        heights = positions(item.data)[:, 2]
    else:
        heights = np.array([polygon.center.z for polygon in item.data.polygons])
    assert len(length) == len(heights)
    assert not length[heights < -0.2].any() and (length[heights > 0.2] > 0.9).all()
    assert positions(bpy.data.objects["Ball Arrows"].data)[:, 2].min() > -0.2


@pytest.mark.parametrize("space", ["OUTLINE", "UV"])
def test_diagrams_are_of_the_region_alone(space):
    """A square whose half is folded up, and whose other half alone is laid out in the UV map."""
    item = grid("Square", 12)
    for vertex in item.data.vertices:
        vertex.co.z = max(vertex.co.x - 0.5, 0.0)
    layer = item.data.uv_layers.new(name="Flat")
    for loop in item.data.loops:
        place = item.data.vertices[loop.vertex_index].co
        layer.data[loop.index].uv = (min(place.x, 0.5), place.y)
    region = with_material(item, "Floor", lambda place: place.x < 0.5)
    with pytest.raises(RuntimeError, match="'Square'"):
        bpy.ops.saddleback.voronoi_2d(space=space, count=12)
    bpy.ops.saddleback.voronoi_2d(space=space, count=12, make_cells=True, **region)
    cells = bpy.data.objects["Square Voronoi Cells"].data
    places = positions(cells)
    assert abs(places[:, 2]).max() < 1e-6
    np.testing.assert_allclose([places.min(axis=0)[:2], places.max(axis=0)[:2]], [[0, 0], [0.5, 1]], atol=1e-6)
    assert sum(polygon.area for polygon in cells.polygons) == pytest.approx(0.5, rel=1e-5)


def test_two_layers_cover_two_halves():
    item = sphere("Ball")
    half(item, "MATERIAL")
    bpy.ops.saddleback.tessellate(count=20, region="MATERIAL", region_name="Belly", **QUICK)
    bpy.ops.saddleback.layer_add()
    assert item.saddleback.region == "WHOLE"
    bpy.ops.saddleback.tessellate(count=10, region="MATERIAL", region_name="Skin", **QUICK)
    item.saddleback.layer_index = 0
    assert (item.saddleback.region, item.saddleback.region_name) == ("MATERIAL", "Belly")
    heights = positions(item.data)[:, 2]
    assert attribute(item, "saddleback_cell")[heights < -0.2].max() == -1
    assert attribute(item, "saddleback_cell_2")[heights > 0.2].max() == -1


def test_a_region_chosen_before_the_first_run_counts():
    item = sphere("Ball")
    half(item, "MATERIAL")
    item.saddleback.region, item.saddleback.region_name = "MATERIAL", "Belly"
    bpy.ops.saddleback.tessellate(count=20, **QUICK)
    assert attribute(item, "saddleback_cell").min() == -1


@pytest.mark.parametrize(
    ("region", "name", "sentence"),
    [
        ("MATERIAL", "None", "'Ball' does not show a material 'None'; choose another region for the layer"),
        ("MATERIAL", "", "'Ball' needs the name of a material for the region; choose another region"),
        ("VERTEX_GROUP", "Nobody", "no face is in the region, vertex group 'Nobody'; choose others, or choose another"),
        ("VERTEX_GROUP", "No", "'Ball' has no vertex group 'No'; paint one or choose another region"),
        ("ATTRIBUTE", "No", "'Ball' has no attribute 'No' for the region; paint one, or choose another region"),
        (
            "FACES",
            "",
            "'Ball' needs the name of an attribute for the region; select faces and press Take Selected Faces",
        ),
    ],
)
@pytest.mark.parametrize("operator", ["tessellate", "distribute", "distance", "path", "voronoi_2d", "direction_field"])
def test_a_region_without_faces_is_told_and_changes_nothing(region, name, sentence, operator):
    item = sphere("Ball")
    item.vertex_groups.new(name="Nobody")
    before = fingerprint()
    with pytest.raises(RuntimeError, match=sentence):
        getattr(bpy.ops.saddleback, operator)(region=region, region_name=name)
    assert fingerprint() == before


def test_nothing_selected_is_told():
    item = sphere("Ball")
    select(item, [])
    with pytest.raises(RuntimeError, match="'Ball': no face is selected"):
        bpy.ops.saddleback.region_from_selection()


def test_a_site_outside_of_the_region_is_named():
    item = sphere("Ball")
    half(item, "MATERIAL")
    low = int(np.argmin(positions(item.data)[:, 2]))
    select(item, [low])
    with pytest.raises(RuntimeError, match=f"the site at vertex {low} belongs to no face of the layer's region"):
        bpy.ops.saddleback.tessellate(sites_source="SELECTED", region="MATERIAL", region_name="Belly")


def test_parts_that_meet_in_a_vertex_are_parted_there():
    item = grid(n=4)
    is_inside = np.zeros(16, bool)
    is_inside[[0, 5, 10, 15]] = True  # the diagonal
    surface = read_surface(item, item.data, is_inside=is_inside)
    assert len(surface.vertices) == 16 and len(surface.triangles) == 8
    np.testing.assert_array_equal(surface.vertices, positions(item.data)[surface.used].astype(float))
    assert sorted(np.bincount(surface.used).tolist())[-3:] == [2, 2, 2]
    values = np.arange(25.0)
    np.testing.assert_array_equal(surface.spread(surface.gather(values), -1.0)[surface.used], values[surface.used])


def test_a_whole_surface_is_not_parted():
    triangles = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]], np.int32)
    parted, copies = part(triangles, 4, NO_EDGES)
    assert not len(copies)
    np.testing.assert_array_equal(parted, triangles)

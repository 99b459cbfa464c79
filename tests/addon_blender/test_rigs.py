# SPDX-License-Identifier: GPL-3.0-or-later
"""What artists keep beside a mesh: hidden assets, rigs, copies, links, overrides, scenes; read and shown as it is."""

import math

import bpy
import numpy as np
import pytest
from mathutils import Matrix, Vector
from scenes import add_object, attribute, grid, grid_arrays, positions, select, sphere

from saddleback_blender import jobs
from saddleback_blender.bridge.inputs.evaluated import evaluated, places_of
from saddleback_blender.bridge.inputs.strokes_in import _is_hard
from saddleback_blender.bridge.outputs.out_collection import find_output, outputs_of

FEW = {"count": 12, "field_source": "NONE", "packing": 0.0}


def hidden_collection(name, how, *items):
    """Takes objects into a collection that is not shown."""
    collection = bpy.data.collections.new(name)
    bpy.context.scene.collection.children.link(collection)
    for item in items:
        for home in list(item.users_collection):
            home.objects.unlink(item)
        collection.objects.link(item)
    if how == "excluded":
        bpy.context.view_layer.layer_collection.children[name].exclude = True
    elif how == "collection disabled":
        collection.hide_viewport = True
    else:
        for item in items:
            item.hide_viewport = True
    return collection


def activate(item):
    bpy.context.view_layer.objects.active = item
    bpy.context.view_layer.update()


def world_of(item):
    """(V, 3) places of the object's evaluated vertices."""
    shown = item.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = shown.to_mesh()
    matrix = np.array(shown.matrix_world)
    places = positions(mesh).astype(float) @ matrix[:3, :3].T + matrix[:3, 3]
    shown.to_mesh_clear()
    return places


def instance_places():
    instances = bpy.context.evaluated_depsgraph_get().object_instances
    # What nodes make of a curve counts as an instance, too.
    return np.array([i.matrix_world.translation[:] for i in instances if i.is_instance and i.parent.type == "MESH"])


HOW = ["excluded", "collection disabled", "object disabled"]


@pytest.mark.parametrize("how", HOW)
def test_sites_of_a_hidden_object_are_where_its_parent_and_modifiers_put_them(how):
    item = grid(n=12)
    dots = add_object("Dots", [(0, 0, 0)], [], active=False)
    array = dots.modifiers.new("Row", "ARRAY")
    array.use_relative_offset, array.use_constant_offset = False, True
    array.count, array.constant_offset_displace = 3, (0.25, 0, 0)
    holder = bpy.data.objects.new("Holder", None)
    bpy.context.scene.collection.objects.link(holder)
    dots.parent = holder
    hidden_collection("Kept", how, dots, holder)
    holder.location = (0.25, 0.5, 0)  # after it was hidden: nothing evaluates it
    activate(item)
    before = {kind: len(getattr(bpy.data, kind)) for kind in ("objects", "meshes")}
    with evaluated(bpy.context, [dots, item]) as shown:
        assert [one.name for one in shown][1] == "Grid"
        np.testing.assert_allclose(shown[0].matrix_world.translation, (0.25, 0.5, 0), atol=1e-6)
    assert before == {kind: len(getattr(bpy.data, kind)) for kind in ("objects", "meshes")}
    bpy.ops.saddleback.tessellate(sites_source="OBJECT", sites_object="Dots", iterations=0, make_centers=True)
    centers = world_of(find_output(item, "centers"))
    np.testing.assert_allclose(centers, [(0.25, 0.5, 0), (0.5, 0.5, 0), (0.75, 0.5, 0)], atol=1e-5)


@pytest.mark.parametrize("how", HOW)
def test_hidden_empties_and_curves_are_measured_from_where_they_are(how):
    item = grid(n=8)
    empty = bpy.data.objects.new("Here", None)
    curve = bpy.data.curves.new("Line", "CURVE")
    curve.dimensions = "3D"
    spline = curve.splines.new("POLY")
    spline.points.add(1)
    spline.points[1].co = (0, 1, 0, 1)
    line = bpy.data.objects.new("Line", curve)
    for one in (empty, line):
        bpy.context.scene.collection.objects.link(one)
    hidden_collection("Kept", how, empty, line)
    empty.location, line.location = (1, 1, 0), (1, 0, 0)
    activate(item)
    np.testing.assert_allclose(places_of(bpy.context, [empty, line]), [(1, 1, 0), (1, 0, 0)], atol=1e-6)
    bpy.ops.saddleback.distance(sources="EMPTIES", sources_collection="Kept")
    assert attribute(item, "saddleback_distance")[0] == pytest.approx(np.sqrt(2), rel=1e-3)
    bpy.ops.saddleback.distance(sources="CURVES", sources_object="Line")
    np.testing.assert_allclose(attribute(item, "saddleback_distance"), 1 - positions(item.data)[:, 0], atol=2e-3)


@pytest.mark.parametrize("how", HOW)
def test_hidden_shapes_have_the_outline_and_scale_that_instances_show(how):
    item = grid(n=8, size=4.0)
    plate = add_object("Plate", [(0, -1, 0), (1, -1, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2, 3)], active=False)
    plate.modifiers.new("Both", "MIRROR")  # twice as wide: a square
    hidden_collection("Assets", how, plate)
    plate.scale = (3, 1, 1)  # three by one
    activate(item)
    bpy.ops.saddleback.distribute(
        shapes="COLLECTION", shapes_collection="Assets", size=0.3, make_instances=True, make_outlines=True, **FEW
    )
    points = find_output(item, "shape outlines").data.splines[0].points
    places = np.array([point.co[:3] for point in points])
    sides = np.sort(np.linalg.norm(np.roll(places, -1, axis=0) - places, axis=1))
    reach = np.linalg.norm(places[:, None] - places, axis=2).max()
    around = sides.sum()
    assert around / reach == pytest.approx(2 * (3 + 1) / np.hypot(3, 1), rel=1e-3)
    scale = np.array(
        [point.vector for point in find_output(item, "shape instances").data.attributes["saddleback_scale"].data]
    )
    np.testing.assert_allclose(scale[:, 0], 3 * scale[:, 1], rtol=1e-4)
    bpy.ops.saddleback.check_distribution()
    assert "none touches another" in jobs.state.line


def joining_group(other, other_first):
    group = bpy.data.node_groups.new("Join", "GeometryNodeTree")
    if hasattr(group, "interface"):
        for kind in ("INPUT", "OUTPUT"):
            group.interface.new_socket(name="Geometry", in_out=kind, socket_type="NodeSocketGeometry")
    else:
        group.inputs.new("NodeSocketGeometry", "Geometry")
        group.outputs.new("NodeSocketGeometry", "Geometry")
    given, made = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    info, join = group.nodes.new("GeometryNodeObjectInfo"), group.nodes.new("GeometryNodeJoinGeometry")
    info.inputs["Object"].default_value = other
    for socket in (info.outputs["Geometry"], given.outputs[0])[:: 1 if other_first else -1]:
        group.links.new(socket, join.inputs[0])
    group.links.new(join.outputs[0], made.inputs[0])
    return group


@pytest.mark.parametrize("other_first", [True, False])
def test_groups_are_known_by_name_where_nodes_number_them_anew(other_first):
    item = sphere("Body", 3)
    z = positions(item.data)[:, 2]
    for name, chosen in (("Low", z < 0), ("Density", z > 0)):
        item.vertex_groups.new(name=name).add(np.flatnonzero(chosen).tolist(), 1.0, "REPLACE")
    vertices, faces = grid_arrays(2, 0.2)
    hat = add_object("Hat", vertices + [0, 0, 3], faces, active=False)
    for name in ("First", "Second", "Third"):
        hat.vertex_groups.new(name=name).add(range(len(vertices)), 1.0, "REPLACE")
    item.modifiers.new("Join", "NODES").node_group = joining_group(hat, other_first)
    activate(item)
    settings = {"density_source": "VERTEX_GROUP", "density_name": "Density", "use_modifiers": True}
    bpy.ops.saddleback.tessellate(count=60, make_centers=True, make_dual=True, **settings)
    height = world_of(find_output(item, "centers"))[:, 2]
    height = height[height < 2]
    assert (height > -0.1).all() and len(height) > 50
    with pytest.raises(RuntimeError, match="no vertex group 'Gone'"):
        bpy.ops.saddleback.tessellate(count=5, density_source="VERTEX_GROUP", density_name="Gone", use_modifiers=True)


def rising(item):
    """A shape key that lifts the object by 5."""
    item.shape_key_add(name="Basis")
    key = item.shape_key_add(name="Up")
    for vertex in key.data:
        vertex.co = vertex.co + Vector((0, 0, 5))
    key.value = 0.0
    return key


@pytest.mark.parametrize("use_modifiers", [False, True])
def test_shapes_follow_at_another_subdivision_level(use_modifiers):
    item = sphere("Body", 2)
    key = rising(item)
    fine = item.modifiers.new("Fine", "SUBSURF")
    fine.levels = 1
    activate(item)
    every = {"make_instances": True, "make_outlines": True, "make_cut": True}
    bpy.ops.saddleback.distribute(shapes="STUDS", use_modifiers=use_modifiers, **every, **FEW)
    key.value = 1.0
    for level in (0, 1, 2):
        fine.levels = level
        bpy.context.view_layer.update()
        body = world_of(item)
        assert body[:, 2].min() > 3.9
        for role in ("shapes", "shape outlines", "shape cut"):
            places = world_of(find_output(item, role))
            # Inside the body or out of it by what shapes rise: none was left behind, and none went astray.
            distance = np.linalg.norm(places - [0, 0, 5], axis=1)
            assert distance.min() > 0.85 and distance.max() < 1.4, (level, role)
        middles = instance_places()
        assert len(middles) == 12
        distance = np.linalg.norm(middles - [0, 0, 5], axis=1)
        assert distance.min() > 0.85 and distance.max() < 1.05, level


def test_shapes_turn_with_the_body_at_another_subdivision_level():
    item = sphere("Body", 2)
    item.shape_key_add(name="Basis")
    key = item.shape_key_add(name="Turned")
    turn = Matrix.Rotation(1.0, 3, "Y")
    for vertex in key.data:
        vertex.co = turn @ vertex.co
    key.value = 0.0
    fine = item.modifiers.new("Fine", "SUBSURF")
    fine.levels = 2
    activate(item)
    bpy.ops.saddleback.distribute(shapes="STUDS", **FEW)
    output = find_output(item, "shapes")
    before = world_of(output)
    key.value = 1.0
    bpy.context.view_layer.update()
    np.testing.assert_allclose(world_of(output), before @ np.array(turn).T, atol=2e-3)


def test_halves_of_a_mirror_are_not_taken_for_one_another():
    item = sphere("Body", 2)
    for vertex in item.data.vertices:
        vertex.co.x += 2.0
    item.modifiers.new("Both", "MIRROR").use_mirror_merge = False
    fine = item.modifiers.new("Fine", "SUBSURF")
    fine.levels = 1
    activate(item)
    bpy.ops.saddleback.distribute(shapes="STUDS", use_modifiers=True, **FEW)
    before = world_of(find_output(item, "shapes"))
    assert before[:, 0].min() < -1 and before[:, 0].max() > 1
    fine.levels = 2
    bpy.context.view_layer.update()
    np.testing.assert_allclose(world_of(find_output(item, "shapes")), before, atol=1e-5)


def test_a_duplicate_s_outputs_follow_the_duplicate():
    item = sphere("Body", 2)
    rising(item)
    activate(item)
    bpy.ops.saddleback.distribute(shapes="STUDS", make_outlines=True, make_instances=True, **FEW)
    item.select_set(True)
    for output in outputs_of(item):
        if output.users_collection:
            output.select_set(True)
    bpy.ops.object.duplicate()
    copies = {copy.name.split(".")[0]: copy for copy in bpy.context.selected_objects}
    copies["Body"].data.shape_keys.key_blocks["Up"].value = 1.0
    bpy.context.view_layer.update()
    for name in ("Body Shapes", "Body Shape Outlines"):
        assert world_of(copies[name])[:, 2].min() > 3.7
        assert world_of(bpy.data.objects[name])[:, 2].max() < 1.5
    assert sorted(np.round(instance_places()[:, 2] / 5)) == [0] * 12 + [1] * 12


def library(tmp_path, name="library.blend"):
    path = str(tmp_path / name)
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    return path


def link(path, kind):
    with bpy.data.libraries.load(path, link=True) as (source, target):
        setattr(target, kind, getattr(source, kind))
    return getattr(target, kind)


def test_a_linked_object_is_not_taken_for_a_local_one_of_its_name(tmp_path):
    add_object("Seed", *grid_arrays(3))
    (linked,) = link(library(tmp_path), "objects")
    bpy.context.scene.collection.objects.link(linked)
    add_object("Seed", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], active=False)
    item = sphere("Body", 2)
    item.saddleback.tessellate.instance_object = linked
    for _ in range(2):
        bpy.ops.saddleback.tessellate(count=5, make_centers=True)
        shown = {
            len(i.object.data.vertices) for i in bpy.context.evaluated_depsgraph_get().object_instances if i.is_instance
        }
        assert shown == {16} and item.saddleback.tessellate.instance_object == linked
    bpy.ops.saddleback.tessellate(count=5, make_centers=True, instance_object="Seed")
    assert item.saddleback.tessellate.instance_object.library is None


def test_a_linked_mesh_gets_its_attributes_on_a_copy(tmp_path):
    sphere("Body", 2)
    (mesh,) = link(library(tmp_path), "meshes")
    item = bpy.data.objects.new("Local", mesh)
    bpy.context.scene.collection.objects.link(item)
    activate(item)
    assert bpy.ops.saddleback.tessellate(count=8) == {"FINISHED"}
    assert "saddleback_cell" not in mesh.attributes
    surface = find_output(item, "surface")
    assert surface.data.library is None and attribute(surface, "saddleback_cell").max() == 7
    bpy.ops.saddleback.tessellate(count=9)
    assert find_output(item, "surface") == surface
    for operator in ("repair", "paint_density"):
        with pytest.raises(RuntimeError, match=r"is linked from .*library\.blend: make it local first"):
            getattr(bpy.ops.saddleback, operator)()
    assert bpy.ops.saddleback.clear() == {"FINISHED"} and not outputs_of(item)


def test_an_override_keeps_its_settings_and_outputs(tmp_path):
    sphere("Body", 2)
    seed = add_object("Seed", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], active=False)
    collection = bpy.data.collections.new("Character")
    bpy.context.scene.collection.children.link(collection)
    bpy.context.scene.collection.objects.unlink(bpy.data.objects["Body"])
    bpy.context.scene.collection.objects.unlink(seed)
    collection.objects.link(bpy.data.objects["Body"])
    (linked,) = link(library(tmp_path), "collections")
    own = linked.override_create(remap_local_usages=True)
    bpy.context.scene.collection.children.link(own)
    body = own.objects["Body"].override_create(remap_local_usages=True)
    activate(body)
    assert body.override_library is not None
    add_object("Seed", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], active=False)
    bpy.ops.saddleback.tessellate(count=7, make_centers=True, instance_object="Seed")
    path = str(tmp_path / "shot.blend")
    for count in (7, 7, 9):
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.open_mainfile(filepath=path)
        body = next(item for item in bpy.data.objects if item.override_library is not None and item.name == "Body")
        activate(body)
        assert body.saddleback.tessellate.count == 7
        assert body.saddleback.tessellate.instance_object == bpy.data.objects["Seed"]
        bpy.ops.saddleback.tessellate(**({} if count == 7 else {"count": count}))
        names = sorted(item.name for item in bpy.data.objects if "saddleback_role" in item)
        assert names == ["Body Centers", "Body Edges", "Body Surface"][: 3 if count == 7 else 0] or count == 9
    assert bpy.ops.saddleback.clear() == {"FINISHED"}
    assert not [item for item in bpy.data.objects if "saddleback_role" in item]


def test_outputs_lie_on_a_sheared_body_and_stay_where_the_artist_moves_them():
    holder = bpy.data.objects.new("Holder", None)
    bpy.context.scene.collection.objects.link(holder)
    holder.scale = (1, 4, 0.5)
    item = sphere("Body", 3)
    item.parent, item.rotation_euler = holder, (0.4, 0.3, 0.7)
    item.modifiers.new("Fine", "SUBSURF").levels = 1
    activate(item)
    bpy.ops.saddleback.tessellate(count=100, make_dual=True, use_modifiers=True)
    bpy.context.view_layer.update()
    body = world_of(item)
    np.testing.assert_allclose(world_of(find_output(item, "surface")), body, atol=1e-5)
    dual = find_output(item, "dual")
    far = np.linalg.norm(world_of(dual)[:, None] - body, axis=2).min(axis=1)
    assert far.max() < 0.2
    bpy.ops.saddleback.tessellate()  # again: what nobody moved does not move
    bpy.context.view_layer.update()
    np.testing.assert_allclose(np.array(dual.matrix_world), np.array(item.matrix_world), atol=1e-5)
    dual.location.x += 3.0
    bpy.context.view_layer.update()
    moved = np.array(dual.matrix_world)
    bpy.ops.saddleback.tessellate()
    bpy.context.view_layer.update()
    np.testing.assert_allclose(np.array(dual.matrix_world), moved, atol=1e-4)


@pytest.mark.parametrize("names", [("object",), ("active_object",), ("object", "active_object")])
def test_an_override_of_the_context_says_which_object_is_meant(names):
    first, second = sphere("First", 2), sphere("Second", 2)
    activate(first)
    with bpy.context.temp_override(**dict.fromkeys(names, second)):
        bpy.ops.saddleback.tessellate(count=5)
        bpy.ops.saddleback.add_singularity()
    assert "saddleback_cell" in second.data.attributes and "saddleback_cell" not in first.data.attributes
    assert [child.name for child in first.children] == []
    assert bpy.context.view_layer.objects.active == first


def test_materials_are_those_that_are_seen():
    item = sphere("Body", 2)
    red, blue, green, shown = (bpy.data.materials.new(name) for name in ("Red", "Blue", "Green", "Shown"))
    item.data.materials.append(red)
    item.data.materials.append(blue)
    item.material_slots[0].link = "OBJECT"
    item.material_slots[0].material = green
    bpy.ops.saddleback.tessellate(count=30, make_dual=True)
    assert [m.name for m in find_output(item, "dual").data.materials] == ["Green", "Blue"]
    group = joining_group(None, False)
    painted = group.nodes.new("GeometryNodeSetMaterial")
    painted.inputs["Material"].default_value = shown
    group.links.new(group.nodes["Group Input"].outputs[0], painted.inputs["Geometry"])
    group.links.new(painted.outputs[0], group.nodes["Group Output"].inputs[0])
    item.modifiers.new("Paint", "NODES").node_group = group
    bpy.ops.saddleback.tessellate(count=30, make_dual=True, use_modifiers=True)
    mesh = find_output(item, "dual").data
    seen = {mesh.materials[polygon.material_index] for polygon in mesh.polygons}
    assert seen == {shown}


def test_an_object_of_two_scenes_has_its_outputs_in_both():
    item = sphere("Body", 2)
    bpy.ops.saddleback.tessellate(count=5)
    second = bpy.data.scenes.new("Second")
    second.collection.objects.link(item)
    with bpy.context.temp_override(scene=second, view_layer=second.view_layers[0]):
        second.view_layers[0].objects.active = item
        bpy.ops.saddleback.tessellate(count=6)
    output = find_output(item, "edges")
    assert output.name in second.objects and output.name in bpy.data.scenes[0].objects
    bpy.ops.saddleback.clear()
    assert [c.name for c in bpy.data.collections] == []


def test_outputs_in_an_excluded_collection_are_told(capfd):
    item = sphere("Body", 2)
    bpy.ops.saddleback.tessellate(count=5)
    bpy.context.view_layer.layer_collection.children["Saddleback"].exclude = True
    activate(item)
    capfd.readouterr()
    bpy.ops.saddleback.tessellate(count=6)
    assert "'Body Edges': made, but not seen" in "".join(capfd.readouterr())


def test_clear_leaves_the_attributes_of_another_object_with_the_mesh():
    first = sphere("First", 2)
    second = bpy.data.objects.new("Second", first.data)
    bpy.context.scene.collection.objects.link(second)
    activate(first)
    bpy.ops.saddleback.tessellate(count=5)
    activate(second)
    bpy.ops.saddleback.distance(sources="CURSOR", distance_attribute="mine")
    assert bpy.ops.saddleback.clear() == {"FINISHED"}
    assert "mine" not in first.data.attributes and "saddleback_cell" in first.data.attributes
    assert bpy.ops.saddleback.clear() == {"CANCELLED"} and "saddleback_cell" in first.data.attributes
    activate(first)
    bpy.ops.saddleback.clear()
    assert "saddleback_cell" not in first.data.attributes


def tiled_image(folder, values, size=8):
    """Each tile of one value."""
    for tile, value in values.items():
        image = bpy.data.images.new(f"t{tile}", size, size)
        image.pixels.foreach_set(np.tile(np.array([value, value, value, 1], np.float32), size * size))
        image.filepath_raw, image.file_format = str(folder / f"d.{tile}.png"), "PNG"
        image.save()
        bpy.data.images.remove(image)
    first = min(values)
    image = bpy.data.images.load(str(folder / f"d.{first}.png"))
    image.source, image.filepath = "TILED", str(folder / "d.<UDIM>.png")
    for tile in values:
        if tile not in [known.number for known in image.tiles]:
            image.tiles.new(tile)
    image.colorspace_settings.name = "Non-Color"
    image.name = "Paint"
    return image


@pytest.mark.parametrize("is_packed", [False, True])
def test_each_part_of_the_surface_is_painted_by_its_tile(tmp_path, is_packed):
    item = grid(n=20, size=2.0)
    places = positions(item.data)[[loop.vertex_index for loop in item.data.loops], :2]
    layer = item.data.uv_layers.new(name="UV")
    layer.data.foreach_set("uv", (places * [1, 0.5] + [0, 1]).astype(np.float32).ravel())  # tiles 1011 and 1012
    image = tiled_image(tmp_path, {1001: 0.0, 1011: 0.05, 1012: 1.0})
    if is_packed:
        image.pack()
        for file in tmp_path.glob("d.*.png"):
            file.unlink()
    activate(item)
    settings = {"density_source": "IMAGE", "density_image": "Paint", "count": 100, "make_centers": True}
    images = len(bpy.data.images)
    bpy.ops.saddleback.tessellate(**settings)
    assert len(bpy.data.images) == images
    right = (world_of(find_output(item, "centers"))[:, 0] > 1).sum()
    assert right > 85
    layer.data.foreach_set("uv", (places * [1, 0.5] + [0, 2]).astype(np.float32).ravel())
    with pytest.raises(RuntimeError, match="has no tile 10"):
        bpy.ops.saddleback.tessellate(**settings)
    image.source = "SEQUENCE"
    with pytest.raises(RuntimeError, match="is a sequence"):
        bpy.ops.saddleback.tessellate(**settings)


def test_modifiers_are_told_apart_from_the_mesh_that_repair_can_mend():
    bpy.ops.mesh.primitive_cube_add()
    item = bpy.context.active_object
    item.modifiers.new("Row", "ARRAY").use_merge_vertices = True  # two walls between the two
    activate(item)
    with pytest.raises(RuntimeError, match="its modifiers make this: apply them"):
        bpy.ops.saddleback.tessellate(count=3, use_modifiers=True)
    assert not jobs.state.needs_repair
    assert bpy.ops.saddleback.repair() == {"FINISHED"} and "to repair what its modifiers make" in jobs.state.line
    bpy.ops.object.convert(target="MESH")
    with pytest.raises(RuntimeError, match="press Repair"):
        bpy.ops.saddleback.tessellate(count=3)
    assert bpy.ops.saddleback.repair() == {"FINISHED"} and "nothing to repair" not in jobs.state.line
    assert bpy.ops.saddleback.tessellate(count=3) == {"FINISHED"}


def test_a_fault_of_modifiers_is_told_where_the_mesh_itself_has_no_faces():
    mesh = bpy.data.meshes.new("Twigs")
    mesh.from_pydata([(0, 0, 0), (0, 0, 1)], [(0, 1)], [])
    item = bpy.data.objects.new("Twigs", mesh)
    bpy.context.scene.collection.objects.link(item)
    activate(item)
    item.modifiers.new("Sides", "SCREW").angle = math.radians(30)
    item.modifiers["Sides"].axis, item.modifiers["Sides"].steps = "X", 1
    item.modifiers.new("Row", "ARRAY").relative_offset_displace = (0.0, 0.0, 0.0)
    item.modifiers["Row"].use_merge_vertices = True  # the same face twice
    with pytest.raises(RuntimeError, match="its modifiers make this: apply them"):
        bpy.ops.saddleback.tessellate(count=3, use_modifiers=True)


def test_a_fault_of_the_mesh_itself_is_repaired_below_its_modifiers():
    mesh = bpy.data.meshes.new("Bow tie")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0), (-1, 0, 0), (-1, -1, 0)], [], [(0, 1, 2), (0, 3, 4)])
    item = bpy.data.objects.new("Bow tie", mesh)
    bpy.context.collection.objects.link(item)
    item.modifiers.new("Smooth", "SUBSURF")
    activate(item)
    with pytest.raises(RuntimeError, match="fan; press Repair in the Saddleback tab, then run again"):
        bpy.ops.saddleback.tessellate(count=3, use_modifiers=True)
    assert jobs.state.needs_repair == item.name
    assert bpy.ops.saddleback.repair() == {"FINISHED"} and not jobs.state.needs_repair
    assert bpy.ops.saddleback.tessellate(count=3, use_modifiers=True) == {"FINISHED"}


def test_multiresolution_in_sculpt_mode_is_not_read_as_its_cage():
    item = sphere("Body", 2)
    item.modifiers.new("Sculpt", "MULTIRES")
    bpy.ops.object.multires_subdivide(modifier="Sculpt")
    bpy.ops.object.mode_set(mode="SCULPT")
    with pytest.raises(RuntimeError, match="leave Sculpt Mode first"):
        bpy.ops.saddleback.tessellate(count=3, use_modifiers=True)
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.ops.saddleback.tessellate(count=3, use_modifiers=True) == {"FINISHED"}


@pytest.mark.parametrize(
    ("name", "is_hard"),
    [
        ("Orchard", False), ("hardly", False), ("Shard", False), ("Richard.001", False), ("", False),
        ("hard", True), ("Hard", True), ("HARD lines", True), ("eyes_hard.001", True), ("HardEdges", True),
        ("edgesHard2", True), ("Strokes (hard)", True), ("\u041a\u0440\u0430\u0439 hard", True),
    ],
)  # fmt: skip
def test_hard_is_a_word_of_its_own(name, is_hard):
    assert _is_hard(name) == is_hard


def test_a_call_says_what_it_means_and_the_panel_the_rest():
    item = sphere("Body", 2)
    group = item.vertex_groups.new(name="Up")
    group.add([0, 1, 2, 3], 1.0, "REPLACE")
    kept = item.saddleback.tessellate
    settings = {"density_source": "VERTEX_GROUP", "density_name": "Up", "make_edges": False}
    bpy.ops.saddleback.tessellate(count=5, **settings)
    bpy.ops.saddleback.tessellate()  # no setting: the same once more
    assert (kept.count, kept.density_source, kept.make_edges) == (5, "VERTEX_GROUP", False)
    bpy.ops.saddleback.tessellate(count=8)  # not what another call said
    assert (kept.count, kept.density_source, kept.make_edges) == (8, "UNIFORM", True)
    kept.iterations, kept.count = 3, 4  # in the panel
    bpy.ops.saddleback.tessellate(seed=1)
    assert (kept.count, kept.iterations, kept.seed) == (4, 3, 1)
    bpy.ops.saddleback.tessellate(count=6)
    assert (kept.count, kept.iterations, kept.seed) == (6, 3, 0)
    kept.seed = 2
    bpy.ops.saddleback.tessellate(iterations=1)
    assert (kept.count, kept.iterations, kept.seed) == (200, 1, 2)


def test_a_file_opened_again_repeats_the_last_call(tmp_path):
    item = sphere("Body", 2)
    select(item, [0])
    bpy.ops.saddleback.tessellate(count=5, iterations=2)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "file.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "file.blend"))
    item = bpy.data.objects["Body"]
    activate(item)
    bpy.ops.saddleback.tessellate()
    assert attribute(item, "saddleback_cell").max() == 4
    bpy.ops.saddleback.tessellate(seed=3, count=6)
    assert item.saddleback.tessellate.iterations == 15

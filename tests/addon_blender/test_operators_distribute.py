# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.distribute` as scripts call it: bent copies, instances, outlines, attributes, and what is replaced."""

import bpy
import numpy as np
import pytest
from mathutils import Euler
from scenes import add_object, attribute, fingerprint, grid, grid_arrays, sphere
from test_operators_direction_field import add_curve, vectors

from saddleback_blender import jobs
from saddleback_blender.bridge.outputs.out_collection import find_output, outputs_of

FEW = {"count": 20, "packing": 0.0}


def host():
    return sphere("Host", subdivisions=4)


def instances(item):
    """Names, world matrices of what an object's instances show."""
    bpy.context.view_layer.update()
    shown = bpy.context.evaluated_depsgraph_get().object_instances
    return [
        (instance.object.data.name, np.array(instance.matrix_world))
        for instance in shown
        if instance.is_instance and instance.parent and instance.parent.original == item
    ]


def add_shapes():
    collection = bpy.data.collections.new("Shapes")
    bpy.context.scene.collection.children.link(collection)
    bpy.ops.mesh.primitive_cube_add(size=0.5)
    cube = bpy.context.active_object
    vertices, faces = grid_arrays(3)
    plate = add_object("Plate", vertices - (0.5, 0.5, 0), faces, active=False)
    plate.scale, plate.location = (1, 0.5, 1), (7, 8, 9)
    for item in (cube, plate):
        bpy.context.scene.collection.objects.unlink(item)
        collection.objects.link(item)
    bpy.context.view_layer.update()
    return cube, plate


@pytest.mark.parametrize("shapes", ["SCALES", "STUDS", "FEATHERS", "LEAVES", "MOSAIC"])
def test_presets_are_bent_onto_the_surface(shapes):
    item = host()
    assert bpy.ops.saddleback.distribute(shapes=shapes, **FEW) == {"FINISHED"}
    (output,) = outputs_of(item)
    assert output.name == "Host Shapes" and output.users_collection[0].name == "Saddleback"
    mesh = output.data
    number = np.empty(len(mesh.polygons), np.int32)
    mesh.attributes["saddleback_shape"].data.foreach_get("value", number)
    assert len(np.unique(number)) == 20 and mesh.uv_layers.active.name == "UVMap"
    assert mesh.attributes["saddleback_random"].domain == "FACE"
    places = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", places)
    radius = np.linalg.norm(places.reshape(-1, 3), axis=1)
    assert radius.min() > 0.97 and 1.005 < radius.max() < 1.5
    assert jobs.state.line.startswith("'Host': 20 shapes") and jobs.state.figures[0].startswith("Covered: ")


def test_instances_stand_where_bent_copies_lie():
    item = host()
    item.location, item.rotation_euler, item.scale = (1, 2, 3), (0.3, 0.4, 0.5), (2, 2, 2)
    bpy.context.view_layer.update()
    bpy.ops.saddleback.distribute(make_instances=True, fit=0.0, **FEW)
    bent, points = find_output(item, "shapes"), find_output(item, "shape instances")
    matrix = np.array(bent.matrix_world)
    world = np.array([vertex.co for vertex in bent.data.vertices]) @ matrix[:3, :3].T + matrix[:3, 3]
    shown = instances(points)
    assert len(shown) == 20
    template = bpy.data.meshes[shown[0][0]]
    own = np.array([vertex.co for vertex in template.vertices])
    copies = world.reshape(20, len(own), 3)
    for _, placed in shown:
        rigid = own @ placed[:3, :3].T + placed[:3, 3]
        away = np.linalg.norm(copies - rigid[None], axis=2).max(axis=1)
        assert away.min() < 0.3 * np.linalg.norm(placed[:3, 0])


def test_shapes_of_a_collection_keep_materials_scale_and_center():
    item = host()
    cube, plate = add_shapes()
    cube.data.materials.append(bpy.data.materials.new("Red"))
    for name in ("Blue", "Green"):
        plate.data.materials.append(bpy.data.materials.new(name))
    plate.data.polygons[0].material_index = 1
    bpy.context.view_layer.objects.active = item
    settings = {"shapes": "COLLECTION", "shapes_collection": "Shapes", "make_instances": True}
    bpy.ops.saddleback.distribute(fit=0.0, **settings, **FEW)
    assert "10 Cube, 10 Plate" in jobs.state.line
    bent = find_output(item, "shapes")
    assert [material.name for material in bent.data.materials] == ["Red", "Blue", "Green"]
    slots = np.empty(len(bent.data.polygons), np.int32)
    bent.data.polygons.foreach_get("material_index", slots)
    assert [int((slots == slot).sum()) for slot in range(3)] == [60, 80, 10]
    shown = instances(find_output(item, "shape instances"))
    assert sorted(name for name, _ in shown) == ["Cube"] * 10 + ["Plate"] * 10
    for name, placed in shown:
        x, y = (np.linalg.norm(placed[:3, i]) for i in (0, 1))
        assert y == pytest.approx(x * (0.5 if name == "Plate" else 1.0), rel=1e-4)
    # Running again replaces, and an output that is not wanted any more goes.
    names = sorted(output.name for output in outputs_of(item))
    bpy.ops.saddleback.distribute()
    assert sorted(output.name for output in outputs_of(item)) == names
    groups = len(bpy.data.node_groups)
    bpy.ops.saddleback.distribute(fit=0.0, seed=4, **settings, **FEW)
    assert len(bpy.data.node_groups) == groups == 3  # of instances, and what lets both outputs follow
    bpy.ops.saddleback.distribute(fit=0.0, **settings | {"make_instances": False}, **FEW)
    assert find_output(item, "shape instances") is None
    assert item.saddleback.distribute.shapes_collection.name == "Shapes"


def class_materials(bent):
    """The name of the material that the faces of each class show."""
    slots, classes = (np.empty(len(bent.data.polygons), np.int32) for _ in range(2))
    bent.data.polygons.foreach_get("material_index", slots)
    bent.data.attributes["saddleback_class"].data.foreach_get("value", classes)
    shown = sorted(set(zip(classes.tolist(), slots.tolist(), strict=True)))
    return [bent.data.materials[slot].name for _, slot in shown]


def test_materials_go_with_their_classes_when_the_collection_changes():
    item = host()
    cube, plate = add_shapes()
    for shape, name in ((cube, "Red"), (plate, "Blue")):
        shape.data.materials.append(bpy.data.materials.new(name))
    bpy.context.view_layer.objects.active = item
    settings = {"shapes": "COLLECTION", "shapes_collection": "Shapes", "fit": 0.0, **FEW}
    bpy.ops.saddleback.distribute(**settings)
    bent = find_output(item, "shapes")
    assert class_materials(bent) == ["Red", "Blue"]
    bpy.ops.saddleback.distribute(seed=1, **settings)
    assert class_materials(bent) == ["Red", "Blue"]
    # The artist's own in the place of one, and one more slot: both stay, whichever classes there are.
    gold = bpy.data.materials.new("Gold")
    bent.data.materials[0] = gold
    bent.data.materials.append(bpy.data.materials.new("Spare"))
    collection = bpy.data.collections["Shapes"]
    collection.objects.unlink(plate)
    bpy.ops.saddleback.distribute(seed=2, **settings)
    assert class_materials(bent) == ["Gold"] and bent.data.materials[-1].name == "Spare"
    collection.objects.link(plate)
    collection.objects.unlink(cube)
    bpy.ops.saddleback.distribute(seed=3, **settings)
    assert class_materials(bent) == ["Blue"]
    bent.data.materials[0] = gold
    bpy.ops.saddleback.distribute(**settings | {"shapes": "MOSAIC"})
    assert class_materials(bent) == ["Saddleback Shapes"] * 3
    bent.data.materials[0] = gold
    bpy.ops.saddleback.distribute(**settings | {"shapes": "SCALES"})
    assert class_materials(bent) == ["Gold"]


def test_outlines_are_cut_into_a_copy_of_the_mesh():
    item = host()
    item.scale = (2, 1, -1)  # mirrored
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.uv.sphere_project()
    bpy.ops.object.mode_set(mode="OBJECT")
    item.data.materials.append(bpy.data.materials.new("Skin"))
    low = [vertex.index for vertex in item.data.vertices if vertex.co.z < 0]
    item.vertex_groups.new(name="Low").add(low, 0.5, "REPLACE")
    before = len(item.data.polygons), [a.name for a in item.data.attributes]
    bpy.ops.saddleback.distribute(shapes="MOSAIC", make_cut=True, make_bent=False, **FEW)
    assert (len(item.data.polygons), [a.name for a in item.data.attributes]) == before
    cut = find_output(item, "shape cut")
    mesh = cut.data
    number, kind, slot = (np.empty(len(mesh.polygons), np.int32) for _ in range(3))
    mesh.attributes["saddleback_shape"].data.foreach_get("value", number)
    mesh.attributes["saddleback_class"].data.foreach_get("value", kind)
    mesh.polygons.foreach_get("material_index", slot)
    assert sorted(set(number)) == list(range(-1, 20)) and ((kind >= 0) == (number >= 0)).all()
    np.testing.assert_array_equal(slot, kind + 1)
    assert [material.name for material in mesh.materials] == ["Skin"] + ["Saddleback Shapes"] * 3
    areas = np.array([polygon.area for polygon in mesh.polygons])
    covered = float(jobs.state.figures[0].split()[1].rstrip("%;")) / 100
    assert areas[number >= 0].sum() / areas.sum() == pytest.approx(covered, rel=0.02)
    # One closed surface, facing outwards as the source does, on it.
    world = np.array([cut.matrix_world @ vertex.co for vertex in mesh.vertices])
    np.testing.assert_allclose(np.linalg.norm(world / (2, 1, 1), axis=1), 1, atol=0.01)
    edges = {(a, b) for polygon in mesh.polygons for a, b in polygon.edge_keys}
    assert len(edges) * 2 == len(mesh.loops) and not mesh.validate()
    outwards = [polygon.normal.dot(polygon.center) > 0 for polygon in mesh.polygons if polygon.area > 1e-5]
    assert np.mean(outwards) > 0.99
    # UV maps are the source's to the seam: none of a face's corners is across the map.
    uv = np.empty(2 * len(mesh.loops), np.float32)
    mesh.uv_layers["UVMap"].data.foreach_get("uv", uv)
    own = np.empty(2 * len(item.data.loops), np.float32)
    item.data.uv_layers["UVMap"].data.foreach_get("uv", own)
    assert np.ptp(uv.reshape(-1, 3, 2), axis=1).max() <= np.ptp(own.reshape(-1, 3, 2), axis=1).max() + 1e-4
    mesh.uv_layers["saddleback_shape_uv"].data.foreach_get("uv", uv)
    inside = uv.reshape(-1, 3, 2)[number >= 0]
    assert inside.min() > -1e-6 and inside.max() < 1 + 1e-6 and np.ptp(inside) > 0.5
    assert sum(len(vertex.groups) for vertex in mesh.vertices) > 1000
    # It follows, and it goes.
    item.shape_key_add(name="Basis")
    key = item.shape_key_add(name="Large")
    for point in key.data:
        point.co = 2 * point.co
    key.value = 1.0
    np.testing.assert_allclose(np.linalg.norm(shown(cut) / (2, 1, 1), axis=1), 2, atol=0.02)
    bpy.ops.saddleback.distribute(make_cut=False)
    assert find_output(item, "shape cut") is None


def test_hidden_instances_are_made_real_and_unreachable_ones_are_not_lost():
    item = host()
    bpy.ops.saddleback.distribute(make_instances=True, make_bent=False, **FEW)
    points = find_output(item, "shape instances")
    layer = bpy.context.view_layer.layer_collection.children["Saddleback"]
    for layer.exclude, layer.hide_viewport in ((True, False), (False, True)):
        before = fingerprint()
        with pytest.raises(RuntimeError, match="is hidden with its collection; show that first"):
            bpy.ops.saddleback.make_real()
        assert fingerprint() == before
    layer.exclude = layer.hide_viewport = False
    points.hide_viewport = True
    points.hide_set(True)
    assert bpy.ops.saddleback.make_real() == {"FINISHED"}
    assert len(bpy.data.objects) == 21 and find_output(item, "shape instances") is None


def test_everything_goes_with_clear_and_nothing_else():
    item = host()
    before = fingerprint()
    bpy.ops.saddleback.distribute(make_instances=True, make_outlines=True, write_attributes=True, **FEW)
    # One of them is what instances show, one what outlines know of the surface.
    assert len(outputs_of(item)) == 4
    distance = attribute(item, "saddleback_outline_distance")
    assert 0.2 < (distance < 0).mean() < 0.6 and (attribute(item, "saddleback_shape")[distance < 0] >= 0).all()
    assert len(find_output(item, "shape outlines").data.splines) == 20
    assert bpy.ops.saddleback.clear() == {"FINISHED"}
    after = fingerprint()
    kept = [entry for entry in after if entry[0] != "Host"]
    assert kept == [entry for entry in before if entry[0] != "Host"]
    assert not bpy.data.node_groups and len(bpy.data.meshes) == 1


def test_instances_become_real():
    item = host()
    with pytest.raises(RuntimeError, match="'Host' carries no instances"):
        bpy.ops.saddleback.make_real()
    bpy.ops.saddleback.distribute(make_bent=False, make_instances=True, **FEW)
    wanted = sorted(placed[:3, 3].tolist() for _, placed in instances(find_output(item, "shape instances")))
    assert bpy.ops.saddleback.make_real() == {"FINISHED"}
    assert bpy.context.active_object == item and not outputs_of(item)
    real = [other for other in bpy.data.objects if other.name.startswith("Scale")]
    bpy.context.view_layer.update()
    np.testing.assert_allclose(sorted(list(other.matrix_world.translation) for other in real), wanted, atol=1e-5)
    assert bpy.ops.saddleback.clear() == {"CANCELLED"} and len(real) == 20


def test_the_check_finds_nothing_and_changes_nothing():
    item = host()
    bpy.ops.saddleback.distribute(**FEW)
    before = fingerprint(told=False)
    assert bpy.ops.saddleback.check_distribution() == {"FINISHED"}
    assert jobs.state.line.startswith("'Host': 20 shapes checked: none touches another")
    assert fingerprint(told=False) == before and item.saddleback.distribute.count == 20


def test_the_panels_field_is_followed_and_so_is_an_attribute():
    item = grid("Host", n=30)
    add_curve("Stroke", np.array([(0.1, 0.2, 0), (0.9, 0.8, 0)]), item)
    item.saddleback.direction_field.strokes = "COLLECTION"
    angles = []
    for source in ("PANEL", "ATTRIBUTE"):
        if source == "ATTRIBUTE":
            with pytest.raises(RuntimeError, match="has no attribute 'saddleback_direction' for directions"):
                bpy.ops.saddleback.distribute(field_source=source, **FEW)
            bpy.ops.saddleback.direction_field(make_arrows=False)
            np.testing.assert_allclose(vectors(item)[:, 1] / vectors(item)[:, 0], 0.75, atol=0.03)
        bpy.ops.saddleback.distribute(field_source=source, make_instances=True, **FEW)
        shown = instances(find_output(item, "shape instances"))
        angles.append(sorted(np.arctan2(placed[1, 0], placed[0, 0]) for _, placed in shown))
    np.testing.assert_allclose(angles, np.arctan(0.75), atol=0.03)


def test_a_vertex_group_keeps_shapes_off():
    item = host()
    group = item.vertex_groups.new(name="Face")
    group.add([v.index for v in item.data.vertices if v.co[2] > 0], 1.0, "REPLACE")
    bpy.ops.saddleback.distribute(forbidden_group="Face", make_bent=False, make_instances=True, count=10)
    assert all(placed[2, 3] < 0 for _, placed in instances(find_output(item, "shape instances")))
    with pytest.raises(RuntimeError, match="has no vertex group 'Nope'"):
        bpy.ops.saddleback.distribute(forbidden_group="Nope")


def test_what_cannot_be_done_is_told_and_changes_nothing():
    item = host()
    item.data.attributes.new("saddleback_shape", "FLOAT", "FACE")
    before = fingerprint()
    calls = [
        ({"shapes": "COLLECTION"}, "no collection is chosen to take shapes from"),
        ({"shapes": "IMAGE", "shapes_image": "Nope"}, "there is no image 'Nope'"),
        ({"size": 50.0}, "'Host': .*larger than the surface"),
        ({"write_attributes": True}, "has another kind of attribute 'saddleback_shape'"),
        ({"density_source": "VERTEX_GROUP"}, "'Host' has no vertex group"),
    ]
    for settings, text in calls:
        with pytest.raises(RuntimeError, match=text):
            bpy.ops.saddleback.distribute(**settings)
        assert fingerprint() == before


def placed(points):
    """World matrices of the instances, by the number of their point: all are of one class."""
    return np.array([matrix for _, matrix in instances(points)])


def bend_by_key(item, move):
    """Gives an object a shape key, fully on, that takes its vertices' places (n, 3) to others."""
    item.shape_key_add(name="Basis")
    key = item.shape_key_add(name="Bent")
    places = np.array([vertex.co for vertex in item.data.vertices])
    key.data.foreach_set("co", move(places).astype(np.float32).ravel())
    key.value = 1.0


def test_instances_go_with_a_mesh_that_turns():
    item = host()
    item.location, item.rotation_euler, item.scale = (1, 2, 3), (0.3, 0.4, 0.5), (2, 2, 2)
    bpy.context.view_layer.update()
    bpy.ops.saddleback.distribute(make_instances=True, make_bent=False, mirror=True, **FEW)
    points = find_output(item, "shape instances")
    before = placed(points)
    turn = np.array(Euler((0.7, -0.4, 1.1)).to_matrix())
    bend_by_key(item, lambda places: places @ turn.T + (0.2, 0.3, 0.4))
    local = np.eye(4)
    local[:3, :3], local[:3, 3] = turn, (0.2, 0.3, 0.4)
    world = np.array(item.matrix_world)
    np.testing.assert_allclose(placed(points), world @ local @ np.linalg.inv(world) @ before, atol=2e-5)


def test_instances_stand_on_a_mesh_that_is_stretched_however_its_object_is_scaled():
    item = host()
    item.scale = (1, 2, 0.5)
    bpy.context.view_layer.update()
    bpy.ops.saddleback.distribute(make_instances=True, make_bent=False, shapes="STUDS", **FEW)
    points = find_output(item, "shape instances")
    rest = placed(points)
    lift = rest[:, :3, 3] / (1, 2, 0.5)  # in the host's space: on a sphere, but for the chords of its faces
    assert np.abs(np.linalg.norm(lift, axis=1) - 1).max() < 0.02
    bend_by_key(item, lambda places: places * (1.5, 1.0, 2.0) + (0, 0, places[:, :1].mean()))
    moved = placed(points)
    on_sphere = moved[:, :3, 3] / (1.5, 2.0, 1.0)
    assert np.abs(np.linalg.norm(on_sphere, axis=1) - 1).max() < 0.02
    np.testing.assert_allclose(on_sphere, lift, atol=0.02)
    # Rigid copies: turned with the faces, of the size that they had.
    np.testing.assert_allclose(
        np.linalg.norm(moved[:, :3, :3], axis=1), np.linalg.norm(rest[:, :3, :3], axis=1), rtol=1e-4
    )
    normals = moved[:, :3, 2] / np.linalg.norm(moved[:, :3, 2], axis=1, keepdims=True)
    ellipsoid = moved[:, :3, 3] / np.square((1.5, 2.0, 1.0))
    ellipsoid /= np.linalg.norm(ellipsoid, axis=1, keepdims=True)
    assert (normals * ellipsoid).sum(axis=1).min() > 0.98


def shown(item):
    """(n, 3) places of an evaluated object's vertices in the world."""
    bpy.context.view_layer.update()
    evaluated = item.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    places = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", places)
    evaluated.to_mesh_clear()
    matrix = np.array(item.matrix_world)
    return places.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]


@pytest.mark.parametrize("role", ["shapes", "shape outlines"])
def test_bent_copies_and_outlines_go_with_a_mesh_that_turns(role):
    item = host()
    item.location, item.rotation_euler, item.scale = (1, 2, 3), (0.3, 0.4, 0.5), (2, 2, 2)
    bpy.context.view_layer.update()
    bpy.ops.saddleback.distribute(make_outlines=True, outline_radius=0.0, mirror=True, **FEW)
    output = find_output(item, role)
    before = shown(output)
    if role == "shapes":  # until then they are where they were put
        own, matrix = np.array([v.co for v in output.data.vertices]), np.array(output.matrix_world)
        np.testing.assert_allclose(before, own @ matrix[:3, :3].T + matrix[:3, 3], atol=2e-5)
    turn = np.array(Euler((0.7, -0.4, 1.1)).to_matrix())
    bend_by_key(item, lambda places: places @ turn.T + (0.2, 0.3, 0.4))
    local = np.eye(4)
    local[:3, :3], local[:3, 3] = turn, (0.2, 0.3, 0.4)
    world = np.array(item.matrix_world)
    whole = world @ local @ np.linalg.inv(world)
    np.testing.assert_allclose(shown(output), before @ whole[:3, :3].T + whole[:3, 3], atol=5e-5)


def test_bent_copies_and_outlines_stay_on_a_mesh_that_is_stretched():
    item = host()
    bpy.ops.saddleback.distribute(make_outlines=True, shapes="MOSAIC", outline_radius=0.001, **FEW)
    bodies, lines = find_output(item, "shapes"), find_output(item, "shape outlines")
    bend_by_key(item, lambda places: places * (1.5, 1.0, 2.0))
    for output, low, high in ((bodies, 0.97, 1.2), (lines, 0.98, 1.01)):
        radius = np.linalg.norm(shown(output) / (1.5, 1.0, 2.0), axis=1)
        assert low < radius.min() and radius.max() < high
    # Where they stay, and where the mesh is another one.
    bpy.ops.saddleback.distribute(make_outlines=True, shapes="MOSAIC", follow_surface=False, **FEW)
    assert not bodies.modifiers
    assert [modifier.name for modifier in find_output(item, "shape outlines").modifiers] == ["Saddleback Tubes"]
    assert [group.name for group in bpy.data.node_groups] == ["Saddleback Curve Tubes"]


def test_faces_of_bent_copies_are_divided_until_they_lie_on_the_surface():
    item = host()
    collection = bpy.data.collections.new("Flat")
    plate = add_object("Plate", np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0.0)]), [(0, 1, 2, 3)], False)
    collection.objects.link(plate)
    bpy.context.view_layer.objects.active = item
    deepest = []
    for fit in (0.0, 0.05, 0.01):
        bpy.ops.saddleback.distribute(shapes="COLLECTION", shapes_collection="Flat", fit=fit, **FEW)
        mesh = find_output(item, "shapes").data
        middles = np.array([polygon.center for polygon in mesh.polygons])
        deepest.append(1 - np.linalg.norm(middles, axis=1).min())
        uv = np.array([corner.uv for corner in mesh.uv_layers.active.data])
        assert uv.min() == 0 and uv.max() == 1
    radius = 0.28  # of twenty squares that cover 40 % of the sphere, about
    assert deepest[0] > 0.1 * radius and deepest[1] < 0.07 * radius and deepest[2] < 0.025 * radius


def test_instances_stay_where_the_mesh_becomes_another_one_or_where_wanted():
    item = host()
    bpy.ops.saddleback.distribute(make_instances=True, make_bent=False, **FEW)
    points = find_output(item, "shape instances")
    before = placed(points)
    item.add_rest_position_attribute = False
    item.modifiers.new("Fine", "SUBSURF").levels = 1
    np.testing.assert_allclose(placed(points), before, atol=1e-6)
    item.modifiers.clear()
    cast = item.modifiers.new("Cast", "CAST")
    cast.cast_type, cast.factor = "CUBOID", 1.0
    assert np.abs(placed(points) - before).max() > 1e-4
    bpy.ops.saddleback.distribute(make_instances=True, make_bent=False, follow_surface=False, **FEW)
    np.testing.assert_allclose(placed(find_output(item, "shape instances")), before, atol=1e-6)

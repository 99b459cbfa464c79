# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.direction_field` as scripts call it: strokes of every kind, empties, attributes, what is shown."""

import bpy
import numpy as np
import pytest
from scenes import add_object, fingerprint, grid, grid_arrays, sphere

from saddleback_blender import jobs
from saddleback_blender.bridge.outputs.out_collection import find_output, outputs_of

NAME = "saddleback_direction"


def vectors(item, name=NAME):
    attribute = item.data.attributes[name]
    values = np.empty(3 * len(attribute.data), np.float32)
    attribute.data.foreach_get("vector", values)
    return values.reshape(-1, 3)


def add_curve(name, places, parent=None, collection=None):
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = "3D"
    spline = data.splines.new("POLY")
    spline.points.add(len(places) - 1)
    spline.points.foreach_set("co", np.column_stack([places, np.ones(len(places))]).astype(np.float32).ravel())
    item = bpy.data.objects.new(name, data)
    (collection or bpy.context.scene.collection).objects.link(item)
    item.parent = parent
    bpy.context.view_layer.update()
    return item


def add_grease_pencil(name, layers):
    """A grease pencil object of the kind that this Blender has; `layers`: name -> places (n, 3)."""
    is_new = not hasattr(bpy.types, "GPencilStroke") or hasattr(bpy.data, "grease_pencils_v3")
    blocks = bpy.data.grease_pencils_v3 if hasattr(bpy.data, "grease_pencils_v3") else bpy.data.grease_pencils
    data = blocks.new(name)
    for layer_name, places in layers.items():
        layer = data.layers.new(layer_name)
        if is_new:
            drawing = layer.frames.new(1).drawing
            drawing.add_strokes([len(places)])
            drawing.attributes["position"].data.foreach_set("vector", np.asarray(places, np.float32).ravel())
        else:
            stroke = layer.frames.new(1).strokes.new()
            stroke.display_mode = "3DSPACE"
            stroke.points.add(len(places))
            stroke.points.foreach_set("co", np.asarray(places, np.float32).ravel())
    item = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(item)
    bpy.context.view_layer.update()
    return item


def add_empty(name, place, parent, index=None):
    empty = bpy.data.objects.new(name, None)
    empty.location = place
    bpy.context.scene.collection.objects.link(empty)
    empty.parent = parent
    if index is not None:
        empty["index"] = index
    bpy.context.view_layer.update()


def across(y=0.5):
    return np.array([(0.1, y, 0.01), (0.5, y, 0.01), (0.9, y, 0.01)])


def test_a_curve_is_followed_and_the_field_is_shown():
    item = grid(n=16)
    add_curve("Stroke", across(), item)
    assert bpy.ops.saddleback.direction_field(strokes="COLLECTION", arrow_count=50) == {"FINISHED"}
    np.testing.assert_allclose(vectors(item), np.tile([1.0, 0, 0], (17 * 17, 1)), atol=0.02)
    assert item.data["saddleback_symmetry"] == 1
    (output,) = outputs_of(item)
    assert output.name == "Grid Arrows" and output.users_collection[0].name == "Saddleback"
    assert "vectors, no singularities, along 1 stroke" in jobs.state.line
    # Again, with lines instead: the arrows go, the panel's settings stay.
    item.saddleback.direction_field.arrow_count = 51
    settings = {"strokes": "COLLECTION", "make_arrows": False, "make_streamlines": True}
    assert bpy.ops.saddleback.direction_field(**settings) == {"FINISHED"}
    (output,) = outputs_of(item)
    assert output.type == "CURVE" and len(output.data.splines) > 5 and item.saddleback.direction_field.arrow_count == 51
    assert bpy.ops.saddleback.clear() == {"FINISHED"} and NAME not in item.data.attributes


def test_directions_are_those_of_the_world_in_the_objects_own_space():
    item = grid(n=16)
    item.scale, item.rotation_euler, item.location = (2, 1, 1), (0.3, 0.2, 0.5), (4, 5, 6)
    bpy.context.view_layer.update()
    own = np.array([(0.1, 0.1, 0), (0.9, 0.9, 0)])
    matrix = np.array(item.matrix_world)
    add_curve("Stroke", own @ matrix[:3, :3].T + matrix[:3, 3])
    bpy.ops.saddleback.direction_field(strokes="OBJECT", strokes_object="Stroke", stroke_weight=10, domain="FACE")
    assert item.data.attributes[NAME].domain == "FACE"
    np.testing.assert_allclose(vectors(item), np.tile([0.7071, 0.7071, 0], (256, 1)), atol=0.02)


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_mirrored_object_turns_the_other_way_in_its_own_space(mirrored):
    item = grid(n=10)
    item.scale = (-1, 1, 1) if mirrored else (1, 1, 1)
    bpy.context.view_layer.update()
    sign = -1 if mirrored else 1
    add_curve("Stroke", across() * (sign, 1, 1))
    strokes = {"strokes": "OBJECT", "strokes_object": "Stroke"}
    bpy.ops.saddleback.direction_field(turn=np.pi / 2, **strokes)
    # Counter-clockwise in the world, where its front is still above.
    np.testing.assert_allclose(vectors(item).mean(axis=0), [0, sign, 0], atol=0.05)


def test_annotations_and_grease_pencil():
    item = grid(n=16)
    add_grease_pencil("Pencil", {"Lines": across(), "Hard ones": across(0.2)})
    assert bpy.ops.saddleback.direction_field(strokes="OBJECT", strokes_object="Pencil") == {"FINISHED"}
    np.testing.assert_allclose(vectors(item), np.tile([1.0, 0, 0], (17 * 17, 1)), atol=0.02)
    assert "along 2 strokes" in jobs.state.line
    with pytest.raises(RuntimeError, match="no annotation is drawn in this scene"):
        bpy.ops.saddleback.direction_field(strokes="ANNOTATIONS")
    if not hasattr(bpy.types, "GPencilStroke") or hasattr(bpy.data, "grease_pencils_v3"):
        return  # annotations can be drawn by hand only in these versions
    note = bpy.data.grease_pencils.new("Note")
    bpy.context.scene.grease_pencil = note
    for name, places, mode in (("Ink", across()[:, [1, 0, 2]], "3DSPACE"), ("On the screen", across(), "SCREEN")):
        stroke = note.layers.new(name).frames.new(1).strokes.new()
        stroke.display_mode = mode
        stroke.points.add(3)
        stroke.points.foreach_set("co", places.astype(np.float32).ravel())
    assert bpy.ops.saddleback.direction_field(strokes="ANNOTATIONS") == {"FINISHED"}
    np.testing.assert_allclose(vectors(item), np.tile([0, 1.0, 0], (17 * 17, 1)), atol=0.02)
    assert "along 1 stroke" in jobs.state.line


def test_empties_are_singularities_by_property_and_name():
    item = sphere(subdivisions=4)
    add_empty("North", (0, 0, 1), item, "1/2")
    add_empty("South", (0, 0, -1), item, 0.5)
    add_empty("East +1/2", (1, 0, 0), item)
    before = fingerprint()
    settings = {"symmetry": "2", "singularities": "EMPTIES", "arrow_count": 200}
    with pytest.raises(RuntimeError, match="sum to 3/2 but must sum to 2: 1/2 is missing; add empties of that index"):
        bpy.ops.saddleback.direction_field(**settings)
    assert fingerprint() == before
    add_empty("West +1/2.001", (-1, 0, 0), item)
    bpy.ops.saddleback.direction_field(**settings)
    assert "lines, 4 singularities of index sum 2" in jobs.state.line
    arrows = find_output(item, "arrows")
    assert len(arrows.data.materials) == 3
    numbers = np.empty(len(arrows.data.polygons), np.int32)
    arrows.data.polygons.foreach_get("material_index", numbers)
    assert (numbers == 1).sum() == 4 * 128 and not (numbers == 2).any()


@pytest.mark.parametrize("kind", ["POLY", "BEZIER", "NURBS"])
def test_splines_of_every_kind_are_strokes(kind):
    item = grid(n=16)
    curve = add_curve("Stroke", across(), item).data
    if kind == "BEZIER":
        curve.splines.clear()
        points = curve.splines.new(kind).bezier_points
        points.add(1)
        for point, place in zip(points, across()[[0, 2]], strict=True):
            point.co, point.handle_left_type, point.handle_right_type = place, "AUTO", "AUTO"
    else:
        curve.splines[0].type = kind
        curve.splines[0].use_endpoint_u = True
    bpy.ops.saddleback.direction_field(strokes="COLLECTION", make_arrows=False)
    np.testing.assert_allclose(vectors(item), np.tile([1.0, 0, 0], (17 * 17, 1)), atol=0.02)


def test_modifiers_of_strokes_count():
    item = grid(n=16)
    # Far above, and thick: a shrinkwrap brings it down, and its tube is no stroke.
    curve = add_curve("Stroke", across() + (0, 0, 3), item)
    curve.data.bevel_depth = 0.05
    before = fingerprint()
    with pytest.raises(RuntimeError, match="no stroke comes within"):
        bpy.ops.saddleback.direction_field(strokes="COLLECTION")
    assert fingerprint() == before
    curve.modifiers.new("Down", "SHRINKWRAP").target = item
    bpy.context.view_layer.update()
    bpy.ops.saddleback.direction_field(strokes="COLLECTION", make_arrows=False)
    np.testing.assert_allclose(vectors(item), np.tile([1.0, 0, 0], (17 * 17, 1)), atol=0.02)
    assert len(bpy.data.objects) == 2 and len(bpy.data.curves) == 1
    # Two lines, side by side, of one; and what makes a surface of it is passed over.
    array = curve.modifiers.new("Twice", "ARRAY")
    array.relative_offset_displace = (0, 0, 0)
    array.use_constant_offset, array.constant_offset_displace = True, (0, 0.2, 0)
    bpy.ops.saddleback.direction_field()
    assert "along 2 strokes" in jobs.state.line
    curve.modifiers.clear()
    curve.location = (0, 0, -3)
    bpy.context.view_layer.update()
    curve.modifiers.new("Sheet", "SCREW")
    bpy.ops.saddleback.direction_field()
    assert "along 1 stroke" in jobs.state.line


def test_modifiers_of_grease_pencil_count():
    item = grid(n=16)
    pencil = add_grease_pencil("Pencil", {"Lines": across() * (1, 0, 0)})
    if pencil.type == "GPENCIL":
        offset = pencil.grease_pencil_modifiers.new("Offset", "GP_OFFSET")
    else:
        offset = pencil.modifiers.new("Offset", "GREASE_PENCIL_OFFSET")
    offset.location, offset.rotation = (0.5, 0, 0), (0, 0, np.pi / 2)
    bpy.context.view_layer.update()
    bpy.ops.saddleback.direction_field(strokes="OBJECT", strokes_object="Pencil", make_arrows=False)
    np.testing.assert_allclose(vectors(item), np.tile([0, 1.0, 0], (17 * 17, 1)), atol=0.02)


def test_strokes_off_the_surface_are_told_and_not_counted(capfd):
    item = grid(n=16)
    add_curve("Stroke", across(), item)
    add_curve("Away", across() + (0, 0, 5), item)
    bpy.ops.saddleback.direction_field(strokes="COLLECTION", make_arrows=False)
    assert "along 1 stroke" in jobs.state.line and "strokes" not in jobs.state.line
    assert "One stroke is too far from the surface and was left out: a stroke of 'Away'" in capfd.readouterr().out
    bpy.ops.saddleback.direction_field()  # from the cache
    assert "was left out" in capfd.readouterr().out
    for curve in item.children:
        for point in curve.data.splines[0].points:
            point.co = (0.5, 0.5, 0, 1)
    with pytest.raises(RuntimeError, match="no stroke of any length is parented"):
        bpy.ops.saddleback.direction_field(strokes="COLLECTION")


def test_singularities_keep_their_colors_and_the_artists_when_run_again():
    item = sphere(subdivisions=3)
    for name, place in (("North", (0, 0, 1)), ("South", (0, 0, -1))):
        add_empty(name, place, item, 2)
    add_empty("East", (1, 0, 0), item, -2)
    mine = bpy.data.materials.new("Mine")
    for turn in (0.0, 0.5):
        bpy.ops.saddleback.direction_field(singularities="EMPTIES", turn=turn)
        arrows = find_output(item, "arrows")
        numbers = np.empty(len(arrows.data.polygons), np.int32)
        arrows.data.polygons.foreach_get("material_index", numbers)
        assert [int((numbers == kind).sum()) for kind in (1, 2)] == [2 * 128, 128]
        assert (arrows.data.materials[0] == mine) == (turn == 0.5)
        arrows.data.materials[0] = mine


def test_what_is_missing_is_told():
    item = grid(n=6)
    calls = [
        ({"strokes": "COLLECTION"}, "no stroke of any length is parented to 'Grid'"),
        ({"strokes": "COLLECTION", "strokes_collection": "Nope"}, "there is no collection 'Nope'"),
        ({"strokes": "OBJECT"}, "no object is chosen to take strokes from"),
        ({"strokes": "OBJECT", "strokes_object": "Nope"}, "there is no object 'Nope'"),
        ({"strokes": "OBJECT", "strokes_object": "Grid"}, "'Grid' has no strokes"),
        ({"singularities": "EMPTIES"}, "no empty is parented to 'Grid'"),
        ({"align": "CURVATURE"}, "choose Lines or Crosses"),
        ({"direction_attribute": "position"}, "the direction attribute cannot be called 'position'"),
    ]
    before = fingerprint()
    for settings, text in calls:
        with pytest.raises(RuntimeError, match=text):
            bpy.ops.saddleback.direction_field(**settings)
        assert fingerprint() == before
    add_empty("One", (0.5, 0.5, 0), item, "many")
    with pytest.raises(RuntimeError, match="the index of 'One' is 'many'"):
        bpy.ops.saddleback.direction_field(singularities="EMPTIES")


def test_a_band_that_is_twisted_is_refused():
    around = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    rows = []
    for side in (-0.3, 0.3):
        radius = 1 + side * np.cos(around / 2)
        rows.append(np.stack([radius * np.cos(around), radius * np.sin(around), side * np.sin(around / 2)], axis=1))
    faces = [(i, i + 1, 24 + i + 1, 24 + i) for i in range(23)] + [(23, 24, 0, 47)]
    add_object("Band", np.concatenate(rows), faces)
    with pytest.raises(RuntimeError, match=r"'Band': .*press Repair"):
        bpy.ops.saddleback.direction_field()


def test_modifiers_and_quads():
    item = add_object("Quads", *grid_arrays(6))
    item.modifiers.new("Sub", "SUBSURF").levels = 1
    bpy.ops.saddleback.direction_field(use_modifiers=True, domain="FACE", align="BOUNDARY", symmetry="4")
    surface = find_output(item, "surface")
    assert len(surface.data.attributes[NAME].data) == 144 and surface.data["saddleback_symmetry"] == 4
    found = np.abs(vectors(surface))
    np.testing.assert_allclose(np.sort(found, axis=1)[:, 2], 1, atol=0.1)

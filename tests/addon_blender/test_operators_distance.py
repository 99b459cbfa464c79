# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.distance`: curves and the cursor as sources, isolines, the preview material, graphs on disk."""

import bpy
import numpy as np
import pytest
from scenes import add_object, attribute, fingerprint, grid, grid_arrays, positions, select, sphere, tube_radius

from saddleback_blender import jobs
from saddleback_blender.bridge.inputs.curves_in import polylines_of
from saddleback_blender.bridge.outputs.out_collection import find_output


def add_curve(name, kind, points, closed=False, parent=None):
    """A curve object of one spline through points."""
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = "3D"
    spline = data.splines.new(kind)
    if kind == "BEZIER":
        spline.bezier_points.add(len(points) - 1)
        for knot, place in zip(spline.bezier_points, points, strict=True):
            knot.co = place
            knot.handle_left_type = knot.handle_right_type = "VECTOR"
    else:
        spline.points.add(len(points) - 1)
        for point, place in zip(spline.points, points, strict=True):
            point.co = (*place, 1.0)
    spline.use_cyclic_u = closed
    item = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(item)
    item.parent = parent
    bpy.context.view_layer.update()
    return item


def distances(item):
    return attribute(item, "saddleback_distance")


# --- curves -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["POLY", "BEZIER"])
def test_distance_to_a_curve(kind):
    item = grid(n=16)
    curve = add_curve("Line", kind, [(0.25, -0.5, 0.4), (0.25, 1.5, 0.4)])
    curve.data.bevel_depth = 0.1  # a tube in the view; its middle counts
    before = (len(bpy.data.curves), len(bpy.data.objects), len(bpy.data.meshes))
    assert bpy.ops.saddleback.distance(sources="CURVES", sources_object="Line") == {"FINISHED"}
    np.testing.assert_allclose(distances(item), np.abs(positions(item.data)[:, 0] - 0.25), atol=7e-3)
    assert (len(bpy.data.curves), len(bpy.data.objects), len(bpy.data.meshes)) == before
    assert item.saddleback.distance.sources_object == curve


@pytest.mark.parametrize("modifier", ["", "SMOOTH"])
def test_a_curve_without_splines_is_told(modifier):
    """As where an artist deleted all points: Blender makes no mesh of it, and the run ended in a traceback."""
    item = grid(n=4)
    curve = bpy.data.objects.new("Line", bpy.data.curves.new("Line", "CURVE"))
    bpy.context.scene.collection.objects.link(curve)
    if modifier:
        curve.modifiers.new("Again", modifier)
    item.saddleback.distance.sources_object = curve
    refuse("has no spline of two points to measure from; draw one", sources="CURVES", sources_object="Line")


def test_curves_of_a_collection_or_of_the_object_but_not_our_own():
    item = grid(n=12)
    add_curve("Left", "POLY", [(0, 0, 0), (0, 1, 0)], parent=item)
    bpy.ops.saddleback.distance(sources="CURVES", make_isolines=True)
    np.testing.assert_allclose(distances(item), positions(item.data)[:, 0], atol=7e-3)
    assert find_output(item, "isolines").parent == item
    bpy.ops.saddleback.distance(sources="CURVES")  # the isolines are children, too
    np.testing.assert_allclose(distances(item), positions(item.data)[:, 0], atol=7e-3)
    group = bpy.data.collections.new("Rails")
    bpy.context.scene.collection.children.link(group)
    group.objects.link(add_curve("Right", "POLY", [(1, 0, 0), (1, 1, 0)]))
    bpy.ops.saddleback.distance(sources="CURVES", sources_collection="Rails")
    np.testing.assert_allclose(distances(item), 1 - positions(item.data)[:, 0], atol=7e-3)


def test_splines_of_all_kinds():
    curve = add_curve("Curve", "BEZIER", [(0, 0, 0), (1, 0, 0), (1, 1, 0)], closed=True)
    for kind, count in (("POLY", 4), ("NURBS", 5), ("POLY", 1)):
        spline = curve.data.splines.new(kind)
        spline.points.add(count - 1)
        spline.points.foreach_set("co", np.array([(i, 5, 0, 1) for i in range(count)], np.float32).ravel())
    curve.data.extrude, curve.data.bevel_depth = 0.2, 0.3
    curve.scale = (2, 2, 2)
    bpy.context.view_layer.update()
    lines = polylines_of(curve)
    assert [line.closed for line in lines] == [True, False, False]  # a lone point is no line
    np.testing.assert_allclose(lines[0].points[0], 0, atol=1e-6)
    assert np.ptp(lines[0].points, axis=0) == pytest.approx([2, 2, 0], abs=1e-5)
    np.testing.assert_allclose(lines[1].points, [(2 * i, 10, 0) for i in range(4)], atol=1e-6)


def test_the_cursor_is_a_source():
    item = grid(n=16)
    bpy.context.scene.cursor.location = (0.5, 0.25, 3.0)
    bpy.ops.saddleback.distance(sources="CURSOR")
    exact = np.linalg.norm(positions(item.data)[:, :2] - (0.5, 0.25), axis=1)
    np.testing.assert_allclose(distances(item), exact, rtol=0.015, atol=1e-6)


def test_the_cursor_reaches_each_part():
    vertices, quads = grid_arrays(8, 1.0)
    away = np.asarray(vertices) + (3.0, 0.0, 0.0)
    item = add_object("Two", np.concatenate([vertices, away]), [*quads, *(np.asarray(quads) + len(vertices))])
    bpy.context.scene.cursor.location = (-1.0, 0.0, 2.0)
    bpy.ops.saddleback.distance(sources="CURSOR_PARTS", make_isolines=True)
    places, found = positions(item.data), distances(item)
    for part in (places[:, 0] < 2, places[:, 0] >= 2):
        nearest = places[part][np.linalg.norm(places[part] - (-1.0, 0.0, 2.0), axis=1).argmin()]
        np.testing.assert_allclose(found[part], np.linalg.norm(places[part] - nearest, axis=1), rtol=0.015, atol=1e-6)
    whole = grid(n=16)
    bpy.context.scene.cursor.location = (0.3, 0.2, 3.0)
    bpy.ops.saddleback.distance(sources="CURSOR_PARTS")  # of one part just the place itself
    exact = np.linalg.norm(positions(whole.data)[:, :2] - (0.3, 0.2), axis=1)
    np.testing.assert_allclose(distances(whole), exact, rtol=0.015, atol=1e-6)


def test_exact_distances():
    item = grid(n=16)
    select(item, [0])
    bpy.ops.saddleback.distance(quality="EXACT")
    np.testing.assert_allclose(distances(item), np.linalg.norm(positions(item.data), axis=1), rtol=1e-6)


# --- isolines ---------------------------------------------------------------------------------------------------------


def test_isolines_are_curves_on_the_surface_at_their_levels():
    item = grid(n=20)
    item.scale = (2, 2, 2)
    bpy.context.view_layer.update()
    select(item, [0])
    bpy.ops.saddleback.distance(make_isolines=True, isolines_by="SPACING", isoline_spacing=0.5, isoline_radius=0.03)
    output = find_output(item, "isolines")
    assert output.name == "Grid Isolines" and tube_radius(output) == pytest.approx(0.03)
    assert output.users_collection[0].name == "Saddleback"
    assert len(output.data.splines) == 5  # 0.5 to 2.5, the diagonal is 2.83
    for number, spline in enumerate(output.data.splines, 1):
        values = np.empty(4 * len(spline.points), np.float32)
        spline.points.foreach_get("co", values)
        np.testing.assert_allclose(np.linalg.norm(values.reshape(-1, 4)[:, :3], axis=1), number / 2, rtol=0.02)
    assert "5 isolines" in jobs.state.line
    bpy.ops.saddleback.distance(make_isolines=True, isolines_by="COUNT", isoline_count=1)
    assert len(find_output(item, "isolines").data.splines) == 1 and "1 isoline," in jobs.state.line
    bpy.ops.saddleback.distance(make_isolines=False)
    assert find_output(item, "isolines") is None and not bpy.data.curves


def test_isolines_close_around_a_ball():
    item = sphere()
    select(item, [0])
    bpy.ops.saddleback.distance(make_isolines=True, isoline_count=6)
    assert [spline.use_cyclic_u for spline in find_output(item, "isolines").data.splines] == [True] * 6


# --- preview ----------------------------------------------------------------------------------------------------------


def test_the_preview_shows_and_leaves_the_artists_materials():
    item = sphere()
    mine, other = bpy.data.materials.new("Mine"), bpy.data.materials.new("Other")
    item.data.materials.append(mine)
    item.data.materials.append(None)
    item.material_slots[1].link = "OBJECT"
    item.material_slots[1].material = other
    select(item, [0])
    bpy.ops.saddleback.distance(make_preview=True)
    shown = {slot.material for slot in item.material_slots}
    assert [material.name for material in shown] == ["Saddleback Distance"]
    assert list(item.data.materials) == [mine, None]
    bpy.ops.saddleback.distance(make_preview=True, distance_attribute="saddleback_far")
    assert {slot.material for slot in item.material_slots} == shown
    assert len(bpy.data.materials) == 3
    (material,) = shown
    assert material.node_tree.nodes["Distance"].attribute_name == "saddleback_far"
    assert material.node_tree.nodes["Farthest"].inputs[1].default_value == pytest.approx(distances(item).max())
    bpy.ops.saddleback.distance(make_preview=False)
    assert [slot.material for slot in item.material_slots] == [mine, other]
    assert [slot.link for slot in item.material_slots] == ["DATA", "OBJECT"]
    assert len(bpy.data.materials) == 2 and not [name for name in list(item.keys()) if "preview" in name]


def test_clear_takes_the_preview_away():
    item = sphere()
    select(item, [0])
    bpy.ops.saddleback.distance(make_preview=True, make_isolines=True)
    assert len(item.material_slots) == 1
    bpy.ops.saddleback.clear()
    assert len(item.material_slots) == len(item.data.materials) == len(bpy.data.materials) == len(bpy.data.curves) == 0
    assert list(item.keys()) in ([], ["saddleback"])


def test_what_the_artist_changed_of_the_preview_stays():
    item = sphere()
    select(item, [0])
    bpy.ops.saddleback.distance(make_preview=True)
    material = item.material_slots[0].material
    material.name = "Rust"
    ramp = next(node for node in material.node_tree.nodes if node.type == "VALTORGB")
    ramp.color_ramp.elements[0].color = (0, 1, 0, 1)
    material.node_tree.nodes.remove(material.node_tree.nodes["Line Darkness"])
    bpy.ops.saddleback.distance(make_preview=True)
    assert item.material_slots[0].material == material and material.name == "Rust"
    assert tuple(ramp.color_ramp.elements[0].color) == (0, 1, 0, 1)


def test_a_duplicate_gets_a_preview_of_its_own():
    item = sphere()
    select(item, [0])
    bpy.ops.saddleback.distance(make_preview=True)
    twin = item.copy()
    twin.data = item.data.copy()
    twin.scale = (3, 3, 3)
    bpy.context.scene.collection.objects.link(twin)
    bpy.context.view_layer.objects.active = twin
    bpy.context.view_layer.update()
    bpy.ops.saddleback.distance(make_preview=True)
    farthest = [o.material_slots[0].material.node_tree.nodes["Farthest"].inputs[1].default_value for o in (item, twin)]
    assert farthest[1] == pytest.approx(3 * farthest[0], rel=0.02)


def test_the_preview_of_a_new_surface():
    item = sphere()
    item.modifiers.new("Subdivision", "SUBSURF").levels = 1
    select(item, [0])
    bpy.ops.saddleback.distance(make_preview=True, use_modifiers=True)
    surface = find_output(item, "surface")
    assert surface.material_slots[0].material.name == "Saddleback Distance" and not item.material_slots
    bpy.ops.saddleback.clear()
    assert not bpy.data.materials


# --- graphs on disk ---------------------------------------------------------------------------------------------------


@pytest.fixture
def folder(tmp_path):
    preferences = bpy.context.preferences.addons["saddleback_blender"].preferences
    preferences.cache_folder = str(tmp_path / "graphs")
    yield tmp_path / "graphs"
    preferences.cache_folder, preferences.cache_on_disk = "", False


def test_a_graph_is_kept_on_disk_where_an_object_asks(folder):
    from saddleback_blender.core import cache

    item = grid(n=10)
    select(item, [0])
    bpy.ops.saddleback.distance(k=20)
    assert not folder.exists()
    bpy.ops.saddleback.distance(cache_on_disk=True, k=20)
    (path,) = folder.iterdir()
    assert item.saddleback.distance.cache_on_disk
    first = distances(item)
    cache.shared.clear()  # as if Blender was started anew
    path.write_bytes(path.read_bytes()[:-1])
    bpy.ops.saddleback.distance()
    np.testing.assert_array_equal(distances(item), first)
    assert list(folder.iterdir()) == [path]


def test_the_preferences_ask_for_all(folder):
    bpy.context.preferences.addons["saddleback_blender"].preferences.cache_on_disk = True
    item = grid(n=10)
    select(item, [0, 1])
    bpy.ops.saddleback.distance(k=20)
    bpy.ops.saddleback.path(k=20)
    bpy.ops.saddleback.tessellate(k=20, count=4, iterations=1)
    assert len(list(folder.iterdir())) == 1


# --- what cannot be done ----------------------------------------------------------------------------------------------


def refuse(*sentences, **options):
    for item in bpy.data.objects:
        assert item.saddleback.path.connect and item.saddleback.distance.quality and item.saddleback.tessellate.count
    before = fingerprint()
    with pytest.raises(RuntimeError) as caught:
        bpy.ops.saddleback.distance(**options)
    for sentence in sentences:
        assert sentence in str(caught.value)
    assert fingerprint() == before


def test_curves_that_are_none():
    item = grid(n=4)
    add_object("Other", *grid_arrays(2), active=False)
    refuse("'Grid': there is no object 'Gone' to measure from", sources="CURVES", sources_object="Gone")
    refuse("'Grid': 'Other' is no curve object; choose a curve", sources="CURVES", sources_object="Other")
    refuse("'Grid': there is no collection 'Gone'", sources="CURVES", sources_collection="Gone")
    refuse("'Grid': no curve is parented to 'Grid'", sources="CURVES")
    bpy.context.scene.collection.children.link(bpy.data.collections.new("Bare"))
    refuse("'Grid': no curve is in collection 'Bare'", sources="CURVES", sources_collection="Bare")
    add_curve("Dot", "POLY", [(0, 0, 0)], parent=item)
    refuse("'Grid': the curve parented to it has no spline of two points", sources="CURVES")
    add_curve("Lost", "POLY", [(0, 0, 0), (float("nan"), 0, 0)])
    refuse("'Grid': 'Lost' has a point that is not at a finite place", sources="CURVES", sources_object="Lost")


def test_too_many_isolines():
    select(grid(n=4), [0])
    refuse("'Grid': isolines every 1e-06 up to", make_isolines=True, isolines_by="SPACING", isoline_spacing=1e-6, k=8)


def test_all_vertices_are_no_source():
    item = grid(n=4)
    select(item, range(25))
    refuse("'Grid': all its 25 vertices are selected, so all distances are 0", "choose the 3D Cursor")
    item.vertex_groups.new(name="All").add(range(25), 1.0, "REPLACE")
    refuse("'Grid': all its 25 vertices are in the group", sources="VERTEX_GROUP")

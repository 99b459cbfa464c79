# SPDX-License-Identifier: GPL-3.0-or-later
"""Classes of shapes with a density, a direction and a size of their own; instances that are kept."""

import bpy
import numpy as np
import pytest
from scenes import add_object, fingerprint, grid_arrays, sphere

from saddleback_blender import jobs
from saddleback_blender.bridge.outputs.out_collection import find_output

ORDERS = {
    "shapes": "COLLECTION", "shapes_collection": "Shapes", "field_source": "NONE", "packing": 0.0, "count": 80,
    "make_instances": True, "make_bent": False,
}  # fmt: skip


def add_shapes():
    """A plate and one half as large."""
    collection = bpy.data.collections.new("Shapes")
    bpy.context.scene.collection.children.link(collection)
    made = []
    for name, size in (("Large", 1.0), ("Small", 0.5)):
        vertices, faces = grid_arrays(3)
        item = add_object(name, (vertices - (0.5, 0.5, 0)) * (size, 0.4 * size, 1), faces, active=False)
        bpy.context.scene.collection.objects.unlink(item)
        collection.objects.link(item)
        made.append(item)
    bpy.context.view_layer.update()
    return made


def column(mesh, name, width=1):
    attribute = mesh.attributes[name]
    values = np.empty(width * len(attribute.data), np.int32 if attribute.data_type == "INT" else np.float32)
    attribute.data.foreach_get("vector" if width == 3 else "value", values)
    return values.reshape(-1, width) if width > 1 else values


def laid(ball):
    """Classes, places, X axes and sizes of the copies."""
    bpy.context.view_layer.update()
    points = find_output(ball, "shape instances")
    mesh = points.data
    places = np.array([points.matrix_world @ vertex.co for vertex in mesh.vertices])
    yaw, pitch = (column(mesh, "saddleback_rotation", 3)[:, i] for i in (2, 1))
    ahead = np.column_stack([np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw), -np.sin(pitch)])
    return column(mesh, "saddleback_class"), places, ahead, column(mesh, "saddleback_scale", 3)[:, 0]


def paint(ball, name, values):
    group = ball.vertex_groups.new(name=name)
    for vertex, value in enumerate(values):
        group.add([vertex], float(value), "REPLACE")


def heights(ball):
    return np.array([vertex.co.z for vertex in ball.data.vertices])


def test_classes_follow_their_own_density_direction_and_size():
    large, small = add_shapes()
    ball = sphere("Ball", 4)
    paint(ball, "Top", np.clip(heights(ball), 0, 1))
    paint(ball, "Bottom", np.clip(-heights(ball), 0, 1))
    spin = ball.data.attributes.new("spin", "FLOAT_VECTOR", "POINT")
    around = np.array([(-vertex.co.y, vertex.co.x, 0) for vertex in ball.data.vertices])
    spin.data.foreach_set("vector", around.astype(np.float32).ravel())
    large["density"], small["density"] = "Top", "Bottom"
    large["direction"], small["direction"] = "spin", 90.0
    small["share"] = 2.0
    assert bpy.ops.saddleback.distribute(size=0.1, **ORDERS) == {"FINISHED"}
    classes, places, ahead, _ = laid(ball)
    assert np.bincount(classes).tolist() == [27, 53]
    assert (places[classes == 0, 2] > -0.1).all() and (places[classes == 1, 2] < 0.1).all()
    is_large = (classes == 0) & (np.abs(places[:, 2]) < 0.9)
    wanted = np.column_stack([-places[:, 1], places[:, 0], np.zeros(len(places))])
    wanted /= np.linalg.norm(wanted, axis=1, keepdims=True)
    assert (ahead * wanted).sum(axis=1)[is_large] == pytest.approx(1, abs=0.02)
    sizes = ball.data.attributes.new("growth", "FLOAT", "POINT")
    sizes.data.foreach_set("value", np.linspace(0.4, 1.0, len(ball.data.vertices)).astype(np.float32))
    large["size"] = "growth"
    assert bpy.ops.saddleback.distribute(size=0.1, **ORDERS) == {"FINISHED"}
    classes, _, _, scale = laid(ball)
    assert np.ptp(scale[classes == 1]) < 1e-6 and np.ptp(scale[classes == 0]) > 0.3 * scale[classes == 0].max()
    for item in (large, small):
        assert not {"layer", "saddleback_source"} & set(item.keys())


@pytest.mark.parametrize(
    ("name", "value", "sentence"),
    [
        ("density", "Nothing", "'Ball' has no attribute 'Nothing'"),
        ("density", 3.0, "the density of shape 'Large' is 3.0; write the name of a vertex group"),
        ("size", "", "the size of shape 'Large' is ''; write the name of a vertex group"),
        ("direction", "Nothing", "'Ball' has no attribute 'Nothing' for directions"),
        ("direction", [1.0, 2.0], "the direction of shape 'Large' is"),
    ],
)
def test_properties_that_say_nothing_are_named(name, value, sentence):
    large, _ = add_shapes()
    ball = sphere("Ball", 3)
    large[name] = value
    before = fingerprint()
    with pytest.raises(RuntimeError, match=sentence):
        bpy.ops.saddleback.distribute(**ORDERS)
    assert fingerprint() == before and find_output(ball, "shape instances") is None


def test_instances_are_as_large_as_the_copies_that_are_laid():
    add_shapes()
    ball = sphere("Ball", 4)
    bpy.ops.saddleback.distribute(size=0.15, **{**ORDERS, "make_bent": True})
    bent = find_output(ball, "shapes").data
    classes, places, _, scale = laid(ball)
    corners = np.array([vertex.co for vertex in bent.vertices])
    radii = np.array([0.5, 0.25]) * np.hypot(1, 0.4)
    for shape in (0, 1):
        place, size = places[classes == shape][0], scale[classes == shape][0] * radii[shape]
        away = np.linalg.norm(corners - place, axis=1)
        assert size == pytest.approx(0.15 * (1, 0.5)[shape], rel=1e-5)
        assert np.abs(away - size).min() < 0.05 * size


def test_what_is_kept_stays_and_the_rest_is_laid_around_it():
    add_shapes()
    ball = sphere("Ball", 4)
    ball.location, ball.rotation_euler, ball.scale = (1, 2, 3), (0.3, 0.4, 0.5), (2, 2, 2)
    bpy.context.view_layer.update()
    bpy.ops.saddleback.distribute(size=0.2, gap=0.01, mirror=True, **ORDERS)
    points = find_output(ball, "shape instances")
    classes, places, ahead, scale = laid(ball)
    assert len(classes) == 80
    keep = np.arange(80) % 2 == 0
    import bmesh  # of Blender

    edited = bmesh.new()
    edited.from_mesh(points.data)
    edited.verts.ensure_lookup_table()
    bmesh.ops.delete(edited, geom=[edited.verts[i] for i in np.flatnonzero(~keep).tolist()], context="VERTS")
    edited.to_mesh(points.data)
    edited.free()
    objects = len(bpy.data.objects)
    bpy.ops.saddleback.distribute(size=0.2, gap=0.01, mirror=True, keep=True, seed=5, **ORDERS)
    again, places_now, ahead_now, scale_now = laid(ball)
    assert len(again) == 80 and len(bpy.data.objects) == objects
    assert again[:40].tolist() == classes[keep].tolist()
    np.testing.assert_allclose(places_now[:40], places[keep], atol=1e-5)
    np.testing.assert_allclose(ahead_now[:40], ahead[keep], atol=1e-4)
    np.testing.assert_allclose(scale_now[:40], scale[keep], rtol=1e-4)
    assert np.linalg.norm(places_now[40:, None] - places[None, ~keep], axis=2).min(axis=1).max() > 0.02
    assert bpy.ops.saddleback.check_distribution(size=0.2, gap=0.01, mirror=True, keep=True, seed=5, **ORDERS) == {
        "FINISHED"
    }
    assert "none touches another" in jobs.state.line


def test_keep_without_anything_to_keep_is_an_ordinary_run():
    add_shapes()
    ball = sphere("Ball", 3)
    bpy.ops.saddleback.distribute(size=0.1, **ORDERS)
    first = laid(ball)
    bpy.ops.saddleback.clear(what="ALL") if "what" in bpy.ops.saddleback.clear.get_rna_type().properties else (
        bpy.ops.saddleback.clear()
    )
    bpy.ops.saddleback.distribute(size=0.1, keep=True, **ORDERS)
    assert all((a == b).all() for a, b in zip(first, laid(ball), strict=True))


@pytest.mark.parametrize(
    ("orders", "sentence"),
    [
        ({"mirror_x": True}, "Keep does not go with X Mirror"),
        ({"overlap": 0.5}, "Keep does not go with Overlap"),
        ({"make_instances": False}, "Keep keeps the points of the output Instances"),
    ],
)
def test_keep_says_what_it_does_not_go_with(orders, sentence):
    add_shapes()
    sphere("Ball", 3)
    with pytest.raises(RuntimeError, match=sentence):
        bpy.ops.saddleback.distribute(**{**ORDERS, "keep": True, **orders})


def test_points_off_the_surface_are_named():
    add_shapes()
    ball = sphere("Ball", 3)
    bpy.ops.saddleback.distribute(size=0.1, **ORDERS)
    find_output(ball, "shape instances").data.vertices[7].co *= 2
    with pytest.raises(RuntimeError, match="shape 7 of those to keep is not on the surface"):
        bpy.ops.saddleback.distribute(size=0.1, keep=True, **ORDERS)

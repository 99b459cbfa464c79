# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects of a collection as shapes: flat meshes, solids, curves, images; what is none is refused."""

import bpy
import numpy as np
import pytest
from scenes import add_object, grid_arrays

import saddleback as sb
from saddleback_blender.bridge.inputs.shapes_in import read_templates
from saddleback_blender.core.errors import BadInputError
from saddleback_blender.core.settings import DistributeSettings


@pytest.fixture
def shapes():
    collection = bpy.data.collections.new("Shapes")
    bpy.context.scene.collection.children.link(collection)
    return collection


def move(item, collection):
    bpy.context.scene.collection.objects.unlink(item)
    collection.objects.link(item)
    bpy.context.view_layer.update()
    return item


def read(collection="Shapes", **settings):
    source = bpy.data.objects.get("Host") or add_object("Host", *grid_arrays(2))
    chosen = {"shapes": "COLLECTION", "shapes_collection": collection} | settings
    return read_templates(bpy.context, source, DistributeSettings(**chosen))


def area(template):
    return sb.Shape(*[list(part) for part in template.parts]).area / template.scale**2


def add_curve(name, *loops, closed=True):
    data = bpy.data.curves.new(name, "CURVE")
    for loop in loops:
        spline = data.splines.new("POLY")
        spline.points.add(len(loop) - 1)
        for point, (x, y) in zip(spline.points, loop, strict=True):
            point.co = (x, y, 0, 1)
        spline.use_cyclic_u = closed
    item = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(item)
    return item


SQUARE = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])


def test_flat_meshes_have_their_border_as_outline(shapes):
    vertices, faces = grid_arrays(4, 2.0)
    hole = [face for number, face in enumerate(faces) if number != 5]
    item = move(add_object("Frame", vertices, hole), shapes)
    item.scale = (1, 2, 1)
    item["share"] = 3
    move(add_object("Small", vertices * 0.25, faces), shapes)
    bpy.context.view_layer.update()
    frame, small = read()
    assert (frame.name, frame.share, frame.size, frame.source) == ("Frame", 3.0, 1.0, "Frame")
    assert [len(part) for part in frame.parts] == [2] and area(frame) == pytest.approx(8 - 0.5)
    assert small.size == pytest.approx(np.hypot(0.25, 0.25) / np.hypot(1, 2)) and area(small) == pytest.approx(0.25)
    own = np.array([vertex.co for vertex in item.data.vertices]) * (1, 2, 1)
    np.testing.assert_allclose(frame.solid.vertices, (own + frame.shift) * frame.scale, atol=1e-6)


def test_solids_have_their_silhouette_as_outline(shapes):
    bpy.ops.mesh.primitive_cube_add(size=2)
    cube = bpy.context.active_object
    cube.rotation_euler = (1, 2, 3)  # how it lies about does not count
    bpy.context.view_layer.update()
    move(cube, shapes)
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1)
    move(bpy.context.active_object, shapes)
    flat, ball = read()
    assert 4 <= area(flat) < 4.2 and np.pi * 0.99 < area(ball) < 1.06 * np.pi
    assert len(flat.solid.vertices) == 8 and flat.solid.uv.shape == (24, 2)


def volume(solid):
    corners = solid.vertices[solid.corners[solid.parted()]]
    return np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6


@pytest.mark.parametrize(("scale", "parent"), [((-1, 2, 3), 1), ((1, -2, 3), 1), ((1, 2, 3), -1), ((-1, -2, 3), -1)])
def test_mirrored_objects_stand_upright(shapes, scale, parent):
    """Along X or Y, as by Ctrl M, by their own scale or a parent's: no roof becomes a cellar."""
    roof = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), (0.5, 0.25, 1)], float)
    faces = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4), (3, 2, 1, 0)]
    item = move(add_object("Roof", roof, faces), shapes)
    item.data.uv_layers.new()
    places = np.random.default_rng(1).random(2 * len(item.data.loops)).astype(np.float32)
    item.data.uv_layers.active.data.foreach_set("uv", places)
    item.scale = scale
    item.parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(item.parent)
    item.parent.scale = (1, parent, 1)
    bpy.context.view_layer.update()
    (template,) = read()
    mirrored = (-1, 2, 3) if parent < 0 else scale
    assert template.own_scale == pytest.approx(mirrored)
    tip = template.solid.vertices[4] / template.scale - template.shift
    np.testing.assert_allclose(tip, roof[4] * mirrored, atol=1e-6)
    assert volume(template.solid) == pytest.approx(2 * 4 * 3 / 3 * template.scale**3)
    corners = [(v, *uv) for v, uv in zip(template.solid.corners.tolist(), template.solid.uv.tolist(), strict=True)]
    before = [loop.vertex_index for loop in item.data.loops]
    assert set(corners) == {(v, *map(float, uv)) for v, uv in zip(before, places.reshape(-1, 2), strict=True)}


def test_modifiers_of_shapes_count(shapes):
    item = move(add_object("Square", *grid_arrays(2)), shapes)
    item.modifiers.new("Array", "ARRAY").count = 2
    (template,) = read()
    assert area(template) == pytest.approx(2.0, rel=0.05) and len(template.solid.vertices) == 18


def test_closed_curves_are_shapes_with_holes(shapes):
    move(add_curve("Ring", SQUARE, 0.5 * SQUARE), shapes)
    (template,) = read()
    assert template.solid is None and area(template) == pytest.approx(3.0)
    assert [len(part) for part in template.parts] == [2]
    move(add_curve("Line", SQUARE, closed=False), shapes)
    with pytest.raises(BadInputError, match="'Host': shape 'Line' has no closed spline"):
        read()


def test_texts_are_shapes_with_their_holes(shapes):
    bpy.ops.object.text_add()
    text = bpy.context.active_object
    text.data.body = "8"
    text.data.materials.append(bpy.data.materials.new("Ink"))
    move(text, shapes)
    (template,) = read()
    assert [len(part) for part in template.parts] == [3] and template.source == text.name


def test_flat_shapes_are_lifted_off_the_surface(shapes):
    move(add_object("Plate", *grid_arrays(2)), shapes)
    vertices, faces = grid_arrays(2)
    move(add_object("Roof", vertices + np.outer(vertices[:, 0], [0, 0, 0.5]), faces), shapes)
    plate, roof = read()
    np.testing.assert_allclose(plate.solid.vertices[:, 2], 0.02, atol=1e-9)
    assert roof.solid.vertices[:, 2].min() == 0.0 and roof.shift[2] == 0.0


def test_outlines_that_are_none_are_told(shapes):
    cases = [
        (SQUARE[[0, 2, 1, 3]], "'Curve' is no shape: its outline crosses or touches itself"),
        (SQUARE * (1, 0), "shape 'Curve' is a line seen from above"),
        (SQUARE[:2], "shape 'Curve' has no closed spline"),
    ]
    for loop, text in cases:
        item = move(add_curve("Curve", loop), shapes)
        with pytest.raises(BadInputError, match=text):
            read()
        bpy.data.objects.remove(item)
        bpy.data.curves.remove(bpy.data.curves["Curve"])


@pytest.mark.parametrize("kind", ["ramp", "noise"])
def test_images_without_a_clear_mask_are_refused_or_whole(shapes, kind):
    values = np.linspace(0, 1, 64)[None].repeat(48, 0) if kind == "ramp" else np.random.default_rng(1).random((48, 64))
    image = bpy.data.images.new("Gray", 64, 48, alpha=True)
    pixels = np.ones((48, 64, 4), np.float32)
    pixels[..., 3] = values
    image.pixels.foreach_set(pixels.ravel())
    with pytest.raises(
        BadInputError, match=r"image 'Gray' makes no shape: no clear mask, \d\d% of it is neither in nor"
    ):
        read(shapes="IMAGE", shapes_image="Gray")
    image.pixels.foreach_set(pixels[..., [3, 3, 3, 0]].ravel())
    (whole,) = read(shapes="IMAGE", shapes_image="Gray")
    ((loop,),) = whole.parts
    np.testing.assert_allclose(whole.uv_of(loop), [(0, 0), (1, 0), (1, 1), (0, 1)], atol=1e-12)
    np.testing.assert_allclose(loop * 40, [(-32, -24), (32, -24), (32, 24), (-32, 24)], atol=1e-9)


def test_images_are_shapes_where_they_are_opaque_or_dark(shapes):
    columns, rows = 40, 20
    pixels = np.zeros((rows, columns, 4), np.float32)
    pixels[5:15, 10:30] = 1.0
    image = bpy.data.images.new("Mask", columns, rows, alpha=True)
    image.pixels.foreach_set(pixels.ravel())
    empty = bpy.data.objects.new("Picture", None)
    empty.empty_display_type, empty.data = "IMAGE", image
    shapes.objects.link(empty)
    (opaque,) = read()
    assert (opaque.name, opaque.source, opaque.solid) == ("Picture", "", None)
    assert area(opaque) == pytest.approx(200, rel=0.1)
    pixels[..., :3] = 1 - pixels[..., :3]
    pixels[..., 3] = 1.0
    image.pixels.foreach_set(pixels.ravel())
    (dark,) = read(shapes="IMAGE", shapes_image="Mask")
    np.testing.assert_allclose(dark.parts[0][0], opaque.parts[0][0], atol=1e-9)
    image.pixels.foreach_set(np.ones_like(pixels).ravel())
    with pytest.raises(BadInputError, match="'Host': image 'Mask' makes no shape: nothing in it is opaque or dark"):
        read(shapes="IMAGE", shapes_image="Mask")


def test_what_is_no_shape_is_told(shapes):
    with pytest.raises(BadInputError, match="there is no collection 'Nope' to take shapes from"):
        read("Nope")
    with pytest.raises(BadInputError, match="collection 'Shapes' has no mesh, curve, text or image"):
        read()
    with pytest.raises(BadInputError, match="no image is chosen"):
        read(shapes="IMAGE")
    move(add_object("Wire", [(0, 0, 0), (1, 0, 0)], []), shapes)
    with pytest.raises(BadInputError, match="shape 'Wire' has no faces"):
        read()
    bpy.data.objects.remove(bpy.data.objects["Wire"])
    move(add_object("Upright", [(0, 0, 0), (1, 0, 0), (1, 0, 1)], [(0, 1, 2)]), shapes)
    with pytest.raises(BadInputError, match="'Upright' is no shape"):
        read()
    bpy.data.objects.remove(bpy.data.objects["Upright"])
    move(add_object("Square", *grid_arrays(2)), shapes)["share"] = "many"
    with pytest.raises(BadInputError, match="the share of shape 'Square' is 'many'; write a number of 0 or more"):
        read()

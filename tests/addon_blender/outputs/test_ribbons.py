# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.ribbon` as scripts and the panel call it: the mesh, its UV places, its materials, what is told."""

import bpy
import numpy as np
import pytest
from scenes import add_object, fingerprint, grid, positions, sphere
from test_modal import press, run_to_end

from saddleback_blender import jobs
from saddleback_blender.bridge.outputs.out_collection import find_output, outputs_of
from saddleback_blender.core.settings import RibbonSettings
from saddleback_blender.ops.ribbon import SADDLEBACK_OT_ribbon


def draw(item, points, closed=False, name="Stroke"):
    """A curve object parented to the item, as the pen leaves one."""
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions = "3D"
    spline = curve.splines.new("POLY")
    spline.points.add(len(points) - 1)
    spline.points.foreach_set("co", np.column_stack([points, np.ones(len(points))]).astype(np.float32).ravel())
    spline.use_cyclic_u = closed
    line = bpy.data.objects.new(name, curve)
    bpy.context.scene.collection.objects.link(line)
    line.parent = item
    bpy.context.view_layer.update()
    return line


def sheet(curve=((0.1, 0.5, 0.2), (0.9, 0.5, 0.2))):
    item = grid(n=10)
    draw(item, np.array(curve))
    return item


def picture(name="Flag", columns=40, rows=10, alpha=1.0):
    image = bpy.data.images.new(name, columns, rows, alpha=True)
    image.pixels.foreach_set(np.tile([0.2, 0.4, 0.8, alpha], rows * columns).astype(np.float32))
    return image


def uv(item):
    layer = item.data.uv_layers["UVMap"]
    values = np.empty(2 * len(layer.data), np.float32)
    layer.data.foreach_get("uv", values)
    return values.reshape(-1, 2)


def texture(material):
    return next(node for node in material.node_tree.nodes if node.type == "TEX_IMAGE")


def test_a_band_is_a_mesh_object_beside_its_source():
    item = sheet()
    assert bpy.ops.saddleback.ribbon(width=0.2, lift=0.02) == {"FINISHED"}
    (output,) = outputs_of(item)
    assert output.name == "Grid Ribbon" and output.users_collection[0].name == "Saddleback" and output.parent == item
    places = positions(output.data)
    np.testing.assert_allclose([places.min(axis=0), places.max(axis=0)], [[0.1, 0.4, 0], [0.9, 0.6, 0.02]], atol=1e-6)
    np.testing.assert_allclose([uv(output).min(axis=0), uv(output).max(axis=0)], [[0, 0], [4, 1]], atol=1e-5)
    assert [material.name for material in output.data.materials] == ["Saddleback Edges"]
    assert jobs.state.line.startswith("'Grid': ribbon of length 0.8,")
    bpy.ops.saddleback.ribbon(width=0.1)
    assert outputs_of(item) == [output] and positions(output.data)[:, 1].max() == pytest.approx(0.55)
    bpy.ops.saddleback.clear()
    assert "Grid Ribbon" not in bpy.data.objects and "Stroke" in bpy.data.objects


def test_an_image_is_seen_on_the_ribbon():
    item, image = sheet(), picture()
    bpy.ops.saddleback.ribbon(width=0.1, show="IMAGE", image_name="Flag")
    output = find_output(item, "ribbon")
    (material,) = output.data.materials
    assert texture(material).image == image and texture(material).extension == "REPEAT"
    np.testing.assert_allclose(uv(output).max(axis=0), [2, 1], atol=1e-5)
    assert np.ptp(positions(output.data)[:, 2]) < 1e-6
    bpy.ops.saddleback.ribbon(width=0.1, show="IMAGE", image_name="Flag", repeat="STRETCH")
    (material,) = output.data.materials
    assert texture(material).extension == "EXTEND" and uv(output).max() == pytest.approx(1.0)
    picture("Glass", alpha=0.2)
    bpy.ops.saddleback.ribbon(show="IMAGE", image_name="Glass")
    shader = next(n for n in output.data.materials[0].node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    assert shader.inputs["Alpha"].is_linked


def test_a_text_and_a_mesh_keep_what_they_have():
    item = sheet()
    text = bpy.data.objects.new("Text", bpy.data.curves.new("Text", "FONT"))
    text.data.body = "Saddle"
    text.data.materials.append(bpy.data.materials.new("Ink"))
    bpy.context.scene.collection.objects.link(text)
    bpy.context.view_layer.objects.active = item
    bpy.ops.saddleback.ribbon(width=0.2, show="OBJECT", ribbon_object="Text", lift=0.01)
    output = find_output(item, "ribbon")
    places = positions(output.data)
    np.testing.assert_allclose(
        [places.min(axis=0), places.max(axis=0)], [[0.1, 0.4, 0.01], [0.9, 0.6, 0.01]], atol=1e-4
    )
    assert [material.name for material in output.data.materials] == ["Ink"]
    tile = add_object(
        "Tile", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), (0, 0, 1)], [(0, 1, 2, 3), (0, 1, 4)], False
    )
    layer = tile.data.uv_layers.new(name="Own")
    layer.data.foreach_set("uv", np.full(14, 0.25, np.float32))
    tile.data.materials.append(bpy.data.materials.new("One"))
    tile.data.materials.append(bpy.data.materials.new("Two"))
    tile.data.polygons[1].material_index = 1
    tile.data.polygons[1].use_smooth = True
    bpy.context.view_layer.objects.active = item
    bpy.ops.saddleback.ribbon(width=0.2, show="OBJECT", ribbon_object="Tile", lift=0.0)
    assert [material.name for material in output.data.materials] == ["One", "Two"]
    assert positions(output.data)[:, 2].max() == pytest.approx(0.1) and (uv(output) == 0.25).all()
    assert {(face.material_index, face.use_smooth) for face in output.data.polygons} == {(0, False), (1, True)}
    assert np.allclose(sum(face.area for face in output.data.polygons if not face.material_index), 0.16, rtol=1e-3)


def test_a_ribbon_goes_with_its_surface():
    item = sheet()
    bpy.ops.saddleback.ribbon(width=0.2, lift=0.02)
    output = find_output(item, "ribbon")
    item.shape_key_add(name="Basis")
    key = item.shape_key_add(name="Up")
    key.data.foreach_set("co", (positions(item.data) + [0, 0, 3]).astype(np.float32).ravel())
    key.value = 1.0
    bpy.context.view_layer.update()
    shown = positions(output.evaluated_get(bpy.context.evaluated_depsgraph_get()).data)
    np.testing.assert_allclose(shown, positions(output.data) + [0, 0, 3], atol=1e-5)


@pytest.mark.parametrize("size", [0.06, 120.0])
def test_the_panel_s_first_click_makes_a_ribbon_of_a_seemly_size(size):
    item = sphere(radius=size / 2)
    t = np.linspace(0.2, 1.5, 12)
    draw(item, size / 2 * np.column_stack([np.cos(t), np.sin(t), 0.3 * np.sin(4 * t)]))
    operator, context = press(SADDLEBACK_OT_ribbon, RibbonSettings())
    operator.invoke(context, None)
    assert run_to_end(operator, context) == {"FINISHED"}
    output = find_output(item, "ribbon")
    heights = np.linalg.norm(positions(output.data), axis=1) / (size / 2)
    assert 0.95 < heights.min() < heights.max() < 1.02
    area = sum(face.area for face in output.data.polygons if face.use_smooth) / size**2
    assert 0.02 < area < 0.2


def refuse(sentence, **options):
    for item in bpy.data.objects:
        assert item.saddleback.ribbon.show  # which stores an empty group
    before = fingerprint()
    with pytest.raises(RuntimeError) as caught:
        bpy.ops.saddleback.ribbon(**options)
    assert sentence in str(caught.value)
    assert fingerprint() == before


def test_what_cannot_be_laid_is_refused_and_nothing_changes():
    item = grid(n=10)
    refuse("'Grid': no curve is parented to 'Grid'; choose one to lay a ribbon along")
    refuse("'Grid': there is no object 'Gone' to lay a ribbon along; choose a curve", curves_object="Gone")
    draw(item, np.array([[0.1, 0.5, 0.2], [0.9, 0.5, 0.2]]))
    refuse("'Grid': no image is chosen to lay along the curves; choose one", show="IMAGE")
    refuse("'Grid': there is no image 'Gone' to lay along", show="IMAGE", image_name="Gone")
    refuse("'Grid': no object is chosen to lay along the curves", show="OBJECT")
    bare = add_object("Bare", [(0, 0, 0), (1, 0, 0)], [], active=False)
    empty = bpy.data.objects.new("Empty", None)
    bpy.context.scene.collection.objects.link(empty)
    assert bare and empty
    refuse("'Grid': object 'Bare' has no faces", show="OBJECT", ribbon_object="Bare")
    refuse("'Grid': 'Empty' has no faces to lay along the curves", show="OBJECT", ribbon_object="Empty")
    add_object("Wall", [(0, 0, 0), (1, 0, 0), (1, 0, 1)], [(0, 1, 2)], active=False)
    refuse("'Grid': 'Wall' is a line seen from above", show="OBJECT", ribbon_object="Wall")
    refuse("'Grid': ribbons of width 9 are wider than the whole surface", width=9.0)
    draw(item, np.array([[0.1, 0.5, 7.0], [0.9, 0.5, 7.0]]), name="Above")
    refuse("is nowhere nearer to the surface than 7", curves_object="Above")
    cross = np.array([[0.2, 0.2, 0.0], [0.8, 0.8, 0.0], [0.8, 0.2, 0.0], [0.2, 0.8, 0.0]])
    draw(item, cross, name="Cross")
    refuse("'Grid': ribbon 1: curve: it crosses or touches itself at (0.5", curves_object="Cross", width=0.05)

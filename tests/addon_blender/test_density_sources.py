# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities from images, curvature, curves and a few painted places; the helpers that begin to paint."""

import bpy
import numpy as np
import pytest
from scenes import attribute, fingerprint, grid, sphere
from test_operators_direction_field import add_curve

from saddleback_blender.bridge.inputs.density import read_density
from saddleback_blender.core.settings import TessellateSettings

FEW = {"count": 12, "iterations": 2, "k": 30}


def add_image(name, values):
    """A gray image without encoding, the first row below."""
    rows, columns = values.shape
    image = bpy.data.images.new(name, columns, rows, float_buffer=True)
    pixels = np.repeat(values[:, :, None], 4, axis=2).astype(np.float32)
    pixels[:, :, 3] = 1.0
    image.pixels.foreach_set(pixels.ravel())
    return image


def test_an_image_is_seen_through_a_uv_map():
    item = grid(n=8)
    settings = {"density_source": "IMAGE", "density_image": "Ramp", "density_attribute": "used"}
    with pytest.raises(RuntimeError, match="there is no image 'Ramp' for the density"):
        bpy.ops.saddleback.tessellate(**FEW, **settings)
    add_image("Ramp", np.tile(np.linspace(0.1, 1.0, 64), (4, 1)))
    with pytest.raises(RuntimeError, match="has no UV map to see image 'Ramp' through"):
        bpy.ops.saddleback.tessellate(**FEW, **settings)
    layer = item.data.uv_layers.new(name="Map")
    corners = np.empty(len(item.data.loops), np.int32)
    item.data.loops.foreach_get("vertex_index", corners)
    x = np.array([vertex.co[0] for vertex in item.data.vertices])
    places = np.column_stack([0.2 + 0.5 * x[corners], np.full(len(corners), 0.5)]).astype(np.float32)
    layer.data.foreach_set("uv", places.ravel())
    assert bpy.ops.saddleback.tessellate(**FEW, **settings) == {"FINISHED"}
    at = (0.2 + 0.5 * x) * 64 - 0.5
    np.testing.assert_allclose(attribute(item, "used"), 0.1 + 0.9 * at / 63, atol=1e-3)
    assert item.saddleback.tessellate.density_image == bpy.data.images["Ramp"]
    bpy.ops.saddleback.tessellate(seed=3)  # found again from what the object keeps


def test_curves_curvature_and_painted_places():
    item = grid(n=12)
    add_curve("Line", np.array([(0, 0, 0), (0, 1, 0)]), item)
    bpy.ops.saddleback.tessellate(**FEW, density_source="DISTANCE", density_reach=0.5, density_attribute="used")
    used = attribute(item, "used").reshape(13, 13)
    np.testing.assert_allclose(used[:, 0], 1, atol=1e-4)
    np.testing.assert_allclose(used[:, 6:], 0.1, atol=1e-4)
    with pytest.raises(RuntimeError, match="has no vertex group; paint one"):
        bpy.ops.saddleback.tessellate(**FEW, density_source="SPREAD")
    group = item.vertex_groups.new(name="Few")
    with pytest.raises(RuntimeError, match="no vertex is in vertex group 'Few'"):
        bpy.ops.saddleback.tessellate(**FEW, density_source="SPREAD")
    group.add([0], 0.25, "REPLACE")
    group.add([168], 1.0, "REPLACE")
    bpy.ops.saddleback.tessellate(**FEW, density_source="SPREAD", density_name="Few", density_attribute="used")
    used = attribute(item, "used")
    np.testing.assert_allclose(used[[0, 168]], [0.25, 1], atol=1e-4)
    assert 0.4 < used[84] < 0.85
    sphere(subdivisions=2)
    assert bpy.ops.saddleback.tessellate(**FEW, density_source="CURVATURE") == {"FINISHED"}


@pytest.mark.parametrize(("paint", "mode"), [("WEIGHT", "WEIGHT_PAINT"), ("COLOR", "VERTEX_PAINT")])
def test_painting_begins_on_a_layer_of_its_own(paint, mode):
    item = grid(n=6)
    group = item.vertex_groups.new(name="g")
    group.add(list(range(49)), 0.5, "REPLACE")
    bpy.ops.saddleback.tessellate(**FEW, density_source="VERTEX_GROUP")  # leaves an attribute of that name
    assert bpy.ops.saddleback.paint_density(paint=paint) == {"FINISHED"}
    assert item.mode == mode
    kept = item.saddleback.tessellate
    assert (kept.density_source, kept.density_name) == (
        "VERTEX_GROUP" if paint == "WEIGHT" else "COLOR",
        "saddleback_density",
    )
    if paint == "WEIGHT":
        assert item.vertex_groups.active.name == "saddleback_density"
        item.vertex_groups.active.add(list(range(30)), 1.0, "REPLACE")
        painted = np.where(np.arange(49) < 30, 1.0, 0.0)
    else:
        colors = item.data.color_attributes["saddleback_density"]
        painted = np.linspace(0, 1, 49)
        colors.data.foreach_set("color", np.repeat(painted, 4).astype(np.float32))
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.ops.saddleback.tessellate() == {"FINISHED"}  # what was painted is read and stays as it was
    np.testing.assert_allclose(read_density(item, item.data, TessellateSettings(
        density_source=kept.density_source, density_name=kept.density_name)), painted, atol=1e-6)  # fmt: skip
    assert bpy.ops.saddleback.clear() == {"FINISHED"}
    assert "saddleback_density" in (item.vertex_groups if paint == "WEIGHT" else item.data.color_attributes)
    assert bpy.ops.saddleback.paint_density(paint=paint) == {"FINISHED"}  # again, on the same layer
    bpy.ops.object.mode_set(mode="OBJECT")


def test_a_layer_of_another_kind_is_not_painted_over():
    item = grid(n=4)
    item.data.attributes.new("saddleback_density", "INT", "FACE")
    before = fingerprint()
    for paint in ("WEIGHT", "COLOR"):
        with pytest.raises(RuntimeError, match="has another layer 'saddleback_density'"):
            bpy.ops.saddleback.paint_density(paint=paint)
    assert fingerprint() == before


def test_pens_choose_the_strokes_in_the_panel():
    item = grid(n=4)
    assert bpy.ops.saddleback.draw_strokes() == {"FINISHED"}
    assert item.saddleback.direction_field.strokes == "ANNOTATIONS"
    assert bpy.context.scene.tool_settings.annotation_stroke_placement_view3d == "SURFACE"
    assert bpy.ops.saddleback.draw_strokes(pen="CURVE") == {"FINISHED"}
    curve = bpy.context.active_object
    assert curve.type == "CURVE" and curve.parent == item and curve.mode == "EDIT"
    bpy.ops.object.mode_set(mode="OBJECT")
    spline = curve.data.splines.new("POLY")
    spline.points.add(1)
    for point, y in zip(spline.points, (0.1, 0.9), strict=True):
        point.co = (0.5, y, 0, 1)
    bpy.context.view_layer.objects.active = item
    assert item.saddleback.direction_field.strokes == "COLLECTION"
    assert bpy.ops.saddleback.direction_field() == {"FINISHED"}


def test_a_singularity_is_put_at_the_cursor():
    item = sphere(subdivisions=3)
    item.location, item.scale = (1, 2, 3), (2, 2, 2)
    bpy.context.view_layer.update()
    for sign in (1, -1):
        bpy.context.scene.cursor.location = (1, 2, 3 + 3 * sign)
        assert bpy.ops.saddleback.add_singularity(index=1.0) == {"FINISHED"}
    empties = [child for child in item.children if child.type == "EMPTY"]
    np.testing.assert_allclose(sorted(e.matrix_world.translation[2] for e in empties), [1, 5], atol=1e-5)
    assert bpy.ops.saddleback.direction_field() == {"FINISHED"}

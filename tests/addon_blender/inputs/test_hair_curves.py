# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves of the newer kind, which hair is of: strokes, guides of densities, sources of distances."""

import bpy
import numpy as np
import pytest
from scenes import attribute, grid, positions

from saddleback_blender.bridge.inputs.curves_in import polylines_of

LINES = {"Comb": [(0.1, 0.5, 0.0), (0.5, 0.5, 0.0), (0.9, 0.5, 0.0)]}


def hair(points, name="Comb", kind=None, closed=False, parent=None):
    """An object of one hair through points."""
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = "3D"
    spline = data.splines.new("POLY")
    spline.points.add(len(points) - 1)
    spline.use_cyclic_u = closed
    for point, place in zip(spline.points, points, strict=True):
        point.co = (*place, 1.0)
    item = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(item)
    active = bpy.context.view_layer.objects.active
    for other in bpy.context.selected_objects:
        other.select_set(False)
    bpy.context.view_layer.objects.active = item
    item.select_set(True)
    bpy.ops.object.convert(target="CURVES")
    item = bpy.context.view_layer.objects.active
    item.name = name
    if kind is not None:
        item.data.attributes["curve_type"].data[0].value = kind
        item.data.update_tag()
    item.parent = parent
    bpy.context.view_layer.objects.active = active
    bpy.context.view_layer.update()
    return item


def test_hair_is_read_where_it_is_in_the_world():
    item = hair(LINES["Comb"], kind=1)
    item.location, item.scale = (1.0, 2.0, 3.0), (2.0, 2.0, 2.0)
    bpy.context.view_layer.update()
    (line,) = polylines_of(item)
    assert np.allclose(line.points, 2.0 * np.array(LINES["Comb"]) + (1.0, 2.0, 3.0)) and not line.closed


@pytest.mark.parametrize("closed", [False, True])
def test_hair_is_smooth_between_its_points(closed):
    points = np.array([(np.cos(a), np.sin(a), 0.0) for a in np.linspace(0, 5, 9)])
    (line,) = polylines_of(hair(points, kind=0, closed=closed))
    for point in points:
        assert np.linalg.norm(line.points - point, axis=1).min() < 1e-6
    inner = line.points[8:57]  # between points that have two neighbors each
    assert np.abs(np.linalg.norm(inner, axis=1) - 1.0).max() < 5e-3  # of straight lines it would be 0.05
    assert line.closed == closed


def test_a_field_follows_combed_hair():
    item = grid(n=10)
    hair(LINES["Comb"], parent=item)
    for settings in ({"strokes": "COLLECTION"}, {"strokes": "OBJECT", "strokes_object": "Comb"}):
        assert bpy.ops.saddleback.direction_field(make_arrows=False, **settings) == {"FINISHED"}
        vectors = np.empty(3 * len(item.data.vertices), np.float32)
        item.data.attributes["saddleback_direction"].data.foreach_get("vector", vectors)
        assert np.allclose(vectors.reshape(-1, 3), (1.0, 0.0, 0.0), atol=1e-3)


def test_hair_is_where_distances_begin():
    item = grid(n=10)
    hair(LINES["Comb"], kind=1)
    bpy.ops.saddleback.distance(sources="CURVES", sources_object="Comb", quality="EXACT")
    places = positions(item.data)
    beside = (places[:, 0] >= 0.1) & (places[:, 0] <= 0.9)
    assert np.allclose(attribute(item, "saddleback_distance")[beside], np.abs(places[beside, 1] - 0.5), atol=1e-5)


def test_hair_is_where_cells_are_small():
    item = grid(n=10)
    hair(LINES["Comb"], parent=item)
    answer = bpy.ops.saddleback.tessellate(count=20, iterations=2, k=30, density_source="DISTANCE")
    density = attribute(item, "saddleback_density")
    assert answer == {"FINISHED"} and density[np.abs(positions(item.data)[:, 1] - 0.5) < 1e-3].max() > 0.9


def test_hair_without_a_second_point_is_refused():
    grid(n=4)
    item = hair([(0.0, 0.0, 0.0)])
    assert polylines_of(item) == []
    with pytest.raises(RuntimeError, match="'Comb' has no stroke of two points; draw one"):
        bpy.ops.saddleback.direction_field(strokes="OBJECT", strokes_object="Comb")

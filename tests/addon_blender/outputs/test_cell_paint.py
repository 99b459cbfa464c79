# SPDX-License-Identifier: GPL-3.0-or-later
"""Gap, bevel and height of each cell by what was painted where its center is."""

import bpy
import numpy as np
import pytest
from scenes import positions, sphere

from saddleback_blender.props.kinds import painted_names

QUICK = {"count": 40, "iterations": 5, "k": 40, "make_edges": False, "make_cells": True}
SHAPE = {"gap": 0.04, "inset": 0.03, "thickness": 0.05, "underside": True}
LENGTHS = ("gap_by", "inset_by", "thickness_by")


def painted(kind, values):
    """A sphere with (V,) values as a vertex group, a number attribute or a color attribute."""
    item = sphere(subdivisions=4)
    if kind == "GROUP":
        group = item.vertex_groups.new(name="Paint")
        for number, value in enumerate(values(positions(item.data))):
            group.add([number], float(value), "REPLACE")
        return item
    data_type, element, width = {"FLOAT": ("FLOAT", "value", 1), "COLOR": ("FLOAT_COLOR", "color", 4)}[kind]
    layer = item.data.attributes.new("Paint", data_type, "POINT")
    numbers = np.repeat(values(positions(item.data)), width).astype(np.float32)
    layer.data.foreach_set(element, numbers)
    return item


def output(item, role):
    return next(child for child in item.children if child.get("saddleback_role") == role)


def heights(item):
    """How high each cell stands, and where its center is."""
    cells, centers = output(item, "cells").data, output(item, "centers").data
    cell = np.zeros(len(cells.polygons), np.int32)
    cells.attributes["saddleback_cell"].data.foreach_get("value", cell)
    corners = np.zeros(len(cells.loops), np.int32)
    cells.loops.foreach_get("vertex_index", corners)
    radius = np.linalg.norm(positions(cells), axis=1)[corners.reshape(-1, 3)].max(axis=1)
    highest = np.zeros(cell.max() + 1)
    np.maximum.at(highest, cell, radius)
    return highest - 1.0, positions(centers)


@pytest.mark.parametrize("kind", ["GROUP", "FLOAT", "COLOR"])
def test_a_cell_is_as_high_as_the_paint_at_its_center_says(kind):
    item = painted(kind, lambda places: 0.5 + 0.5 * places[:, 2])
    bpy.ops.saddleback.tessellate(**QUICK, **SHAPE, thickness_by="Paint", make_centers=True)
    found, centers = heights(item)
    np.testing.assert_allclose(found, 0.05 * (0.5 + 0.5 * centers[:, 2]), atol=2e-3)
    assert np.ptp(found) > 0.04


def test_each_length_has_paint_of_its_own_and_none_is_as_before():
    item = painted("FLOAT", lambda places: np.where(places[:, 2] > 0.0, 1.0, 0.0))

    def made(**settings):
        bpy.ops.saddleback.tessellate(**QUICK, **SHAPE, **dict.fromkeys(LENGTHS, "") | settings)
        return positions(output(item, "cells").data)

    plain = made()
    different = [made(**{name: "Paint"}) for name in LENGTHS]
    assert all(found.shape != plain.shape or (found != plain).any() for found in different)
    np.testing.assert_array_equal(made(), plain)


def test_only_what_exists_and_is_not_negative_can_multiply():
    item = painted("FLOAT", lambda places: places[:, 2])
    before = len(bpy.data.objects)
    for name in LENGTHS:
        with pytest.raises(RuntimeError, match="has no vertex group and no attribute 'Nothing' for the cells' lengths"):
            bpy.ops.saddleback.tessellate(**QUICK, **SHAPE, **{name: "Nothing"})
        with pytest.raises(RuntimeError, match=r"attribute 'Paint' is -.* and lengths can be multiplied by 0 and more"):
            bpy.ops.saddleback.tessellate(**QUICK, **SHAPE, **{name: "Paint"})
    assert len(bpy.data.objects) == before and not item.children
    # Where no cells are made, nobody reads it.
    assert bpy.ops.saddleback.tessellate(**{**QUICK, "make_cells": False}, gap_by="Nothing") == {"FINISHED"}


def test_names_to_choose_from():
    item = painted("FLOAT", lambda places: places[:, 2])
    item.vertex_groups.new(name="Group")
    item.data.attributes.new("Number", "INT", "POINT")
    found = painted_names(item.saddleback.tessellate, bpy.context, "")
    assert found[0] == "Group" and "Paint" in found and "Number" not in found
    bpy.context.view_layer.objects.active = None
    assert painted_names(None, bpy.context, "") == []

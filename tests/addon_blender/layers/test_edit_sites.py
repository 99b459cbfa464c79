# SPDX-License-Identifier: GPL-3.0-or-later
"""Sites edited by hand: vertices that are dragged, added and removed, and cells that follow."""

import bpy
import numpy as np
import pytest
from scenes import attribute, fingerprint, grid, positions, sphere

QUICK = {"count": 30, "iterations": 5, "k": 30}


def edited(item):
    """The vertices, in Object Mode."""
    bpy.ops.saddleback.edit_sites()
    assert bpy.context.mode == "EDIT_MESH" and bpy.context.object.parent == item
    bpy.ops.object.mode_set(mode="OBJECT")
    return bpy.context.object


def again(item):
    """What Auto Update does."""
    bpy.context.view_layer.objects.active = item
    bpy.ops.saddleback.tessellate()
    return attribute(item, "saddleback_cell")


@pytest.mark.parametrize("run", ["tessellate", "relax_live"])
def test_cells_are_those_of_the_vertices(run):
    item = sphere(subdivisions=4)
    item.location, item.scale = (1.0, 2.0, 3.0), (1.0, 1.0, 2.0)
    bpy.context.view_layer.update()
    getattr(bpy.ops.saddleback, run)(**QUICK)
    before = attribute(item, "saddleback_cell")
    points = edited(item)
    assert len(points.data.vertices) == 30 and item.saddleback.layers[0].auto_update
    assert (again(item) == before).mean() > 0.99  # as they were


def test_vertices_are_dragged_added_and_removed():
    item = grid(n=40)
    bpy.ops.saddleback.tessellate(**QUICK)
    points = edited(item)
    points.data.vertices[3].co = (0.0, 0.0, 0.0)
    points.data.vertices.add(2)
    points.data.vertices[30].co, points.data.vertices[31].co = (1.0, 1.0, 0.0), (0.97, 0.97, 0.0)
    sites = positions(points.data)
    cells = again(item)
    assert set(cells) == set(range(32)) and cells[0] == 3
    distance = np.linalg.norm(positions(item.data)[:, None] - sites, axis=2)
    sure = np.diff(np.sort(distance, axis=1)[:, :2], axis=1)[:, 0] > 0.01
    assert (cells[sure] == distance.argmin(axis=1)[sure]).mean() > 0.99
    mesh = bpy.data.meshes.new("Fewer")
    mesh.from_pydata(sites[:5].tolist(), [], [])
    points.data = mesh
    assert set(again(item)) == set(range(5))
    bpy.ops.saddleback.edit_sites()  # the same ones again
    assert bpy.context.object == points


def test_without_cells_there_is_nothing_to_edit():
    sphere()
    before = fingerprint()
    with pytest.raises(RuntimeError, match="'Sphere' has no cells yet whose sites could be edited: press Tessellate"):
        bpy.ops.saddleback.edit_sites()
    assert fingerprint() == before

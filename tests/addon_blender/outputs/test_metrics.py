# SPDX-License-Identifier: GPL-3.0-or-later
"""Cells that are longer than wide, along the object's direction field."""

import bpy
import numpy as np
import pytest
from scenes import add_object, attribute, fingerprint, grid, grid_arrays, positions, sphere
from test_operators_direction_field import vectors

import saddleback as sb

QUICK = {"count": 60, "iterations": 20}


def mesh_of(data):
    data.calc_loop_triangles()
    return sb.Mesh(positions(data), [tuple(t.vertices) for t in data.loop_triangles])


def lengths_of(item, directions):
    """(n,) how many times as long as wide the cells of a plate are along directions (V, 2), by its vertices."""
    cell, places = attribute(item, "saddleback_cell"), positions(item.data)[:, :2]
    found = []
    for number in range(cell.max() + 1):
        own = cell == number
        if own.sum() < 30:
            continue
        along = directions[own].mean(axis=0)
        along /= np.linalg.norm(along)
        offset = places[own] - places[own].mean(axis=0)
        found.append(np.std(offset @ along) / np.std(offset @ [-along[1], along[0]]))
    return np.array(found)


@pytest.mark.parametrize("stretch", [1.0, 3.0])
def test_cells_are_as_many_times_as_long_as_wide(stretch):
    item = grid(n=70)
    item.saddleback.direction_field.turn = 0.5
    assert bpy.ops.saddleback.direction_field() == {"FINISHED"}
    directions = vectors(item)[:, :2]
    assert bpy.ops.saddleback.tessellate(stretch=stretch, **QUICK) == {"FINISHED"}
    found = lengths_of(item, directions)
    assert len(found) > 50
    assert abs(np.exp(np.log(found).mean()) / stretch - 1) < 0.15
    assert item.saddleback.tessellate.stretch == pytest.approx(stretch)


def test_all_outputs_are_made_of_stretched_cells():
    item = sphere(subdivisions=4)
    made = {"make_edges": True, "make_cells": True, "make_centers": True, "make_dual": True, "make_shell": True}
    assert bpy.ops.saddleback.tessellate(stretch=2.0, gap=0.02, thickness=0.03, **made, **QUICK) == {"FINISHED"}
    roles = {child.get("saddleback_role") for child in item.children}
    assert {"edges", "cells", "centers", "dual", "shell"} <= roles
    dual = next(child for child in item.children if child["saddleback_role"] == "dual").data
    assert len(dual.vertices) - len(dual.edges) + len(dual.polygons) == 2
    quads = bpy.ops.saddleback.tessellate(stretch=2.0, make_dual=True, dual_faces="QUADS", **QUICK)
    assert quads == {"FINISHED"}
    polygons = bpy.ops.saddleback.tessellate(stretch=2.0, make_cells=True, cell_faces="ONE", **QUICK)
    assert polygons == {"FINISHED"}


def test_without_stretch_the_field_does_not_matter():
    item = sphere(subdivisions=3)
    bpy.ops.saddleback.tessellate(**QUICK)
    before = attribute(item, "saddleback_cell")
    item.saddleback.direction_field.symmetry = "4"
    bpy.ops.saddleback.tessellate(stretch=1.0, **QUICK)
    assert np.array_equal(before, attribute(item, "saddleback_cell"))


def test_a_field_of_crosses_cannot_stretch():
    vertices, faces = grid_arrays(12)
    item = add_object("Plate", vertices - (0.5, 0.5, 0), faces)
    item.saddleback.direction_field.symmetry = "4"
    before = fingerprint()
    with pytest.raises(
        RuntimeError, match="its direction field has crosses, along which of two lines shall cells be long"
    ):
        bpy.ops.saddleback.tessellate(stretch=2.0, **QUICK)
    assert fingerprint() == before


def dual_of(item):
    return next(child for child in item.children if child["saddleback_role"] == "dual").data


@pytest.mark.parametrize("options", [{"stretch": 2.0}, {"follow_curvature": 0.5}])
@pytest.mark.parametrize("faces", ["TRIANGLES", "QUADS"])
def test_kept_lines_are_kept_by_any_metric(options, faces):
    """The remesh of a plate reaches all of its border, corners too."""
    vertices, polygons = grid_arrays(30)
    item = add_object("Plate", vertices, polygons)
    kept = {"hold_boundary": True, "hold_sharp": True, "make_dual": True, "dual_faces": faces}
    assert bpy.ops.saddleback.tessellate(**options, **kept, **QUICK) == {"FINISHED"}
    whole, found = mesh_of(item.data), mesh_of(dual_of(item))
    assert found.area == pytest.approx(whole.area, rel=1e-5)


def test_stretched_cells_can_be_mirrored():
    vertices, polygons = grid_arrays(30)
    item = add_object("Plate", vertices - (0.5, 0.5, 0), polygons)
    item.saddleback.direction_field.symmetry = "2"
    made = bpy.ops.saddleback.tessellate(stretch=2.0, mirror_x=True, hold_boundary=True, make_dual=True, **QUICK)
    assert made == {"FINISHED"}
    places = positions(dual_of(item))
    mirrored = places * [-1, 1, 1]
    gaps = np.linalg.norm(places[:, None] - mirrored, axis=2).min(axis=1)
    assert gaps.max() < 1e-6
    assert (abs(places[:, 0]) < 1e-6).any()


def test_cells_that_follow_curvature_are_small_where_it_bends():
    """A rod with round ends: its cells are long along it, and smaller at the ends than on the rod."""
    item = sphere(subdivisions=5)
    places = positions(item.data)
    item.data.vertices.foreach_set("co", (places * [4.0, 1.0, 1.0] / 4).astype(np.float32).ravel())
    sizes = []
    for follow in (0.0, 1.0):
        assert bpy.ops.saddleback.tessellate(follow_curvature=follow, **QUICK) == {"FINISHED"}
        cell, x = attribute(item, "saddleback_cell"), positions(item.data)[:, 0]
        tips = np.unique(cell[abs(x) > 0.85])
        sizes.append(len(tips))
    assert sizes[1] > 1.5 * sizes[0]
    assert item.saddleback.tessellate.follow_curvature == 1.0


def test_a_remesh_that_follows_curvature_is_nearer_to_the_surface():
    item = sphere(subdivisions=5)
    places = positions(item.data)
    item.data.vertices.foreach_set("co", (places * [1.0, 0.25, 0.25]).astype(np.float32).ravel())
    surface, off = mesh_of(item.data), []
    for follow in (0.0, 1.0):
        done = bpy.ops.saddleback.tessellate(follow_curvature=follow, make_dual=True, count=150, iterations=30)
        assert done == {"FINISHED"}
        dual = next(child for child in item.children if child["saddleback_role"] == "dual").data
        off.append(sb.hausdorff_distance(surface, mesh_of(dual)).distance)
    assert off[1] < 0.75 * off[0]


def test_stretch_and_curvature_together_are_refused():
    item = sphere(subdivisions=3)
    item.saddleback.direction_field.symmetry = "2"
    before = fingerprint()
    with pytest.raises(RuntimeError, match="along the field or follow curvature, not both"):
        bpy.ops.saddleback.tessellate(stretch=2.0, follow_curvature=0.5, **QUICK)
    assert fingerprint() == before

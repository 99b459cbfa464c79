# SPDX-License-Identifier: GPL-3.0-or-later
"""Cells of sites with weights, with all that other cells have: gaps, bevels, heights, iterations."""

from itertools import product

import bpy
import numpy as np
import pytest
from scenes import add_object, grid, positions, select

from saddleback_blender import jobs
from saddleback_blender.bridge.outputs.out_collection import find_output

CELLS, CENTERS = "voronoi cells", "voronoi centers"


def weighted_grid():
    """A square of side 1 and thirty disks in it, one of which hides another."""
    item = grid(n=2)
    rng = np.random.default_rng(1)
    places = np.column_stack([0.05 + 0.9 * rng.random((30, 2)), np.zeros(30)])
    weights = 0.08 * rng.random(30)
    places[1], weights[:2] = places[0] + (0.01, 0, 0), (0.09, 0.0)
    dots = add_object("Dots", places, [], active=False)
    dots.data.attributes.new("size", "FLOAT", "POINT").data.foreach_set("value", weights.astype(np.float32))
    return item, places, weights


def run(**settings):
    arguments = {"sites_source": "OBJECT", "sites_object": "Dots", "weights_name": "size"}
    assert bpy.ops.saddleback.voronoi_2d(**arguments, **settings) == {"FINISHED"}


def flat_areas(item):
    """What the faces of each cell cover, seen from above."""
    mesh = find_output(item, CELLS).data
    cells = np.empty(len(mesh.polygons), np.int32)
    mesh.attributes["saddleback_cell"].data.foreach_get("value", cells)
    return np.bincount(cells, [max(face.area * face.normal.z, 0.0) for face in mesh.polygons], minlength=30)


@pytest.mark.parametrize(
    ("gap", "inset", "thickness", "iterations"), list(product((0.0, 0.02), (0.0, 0.01), (0.0, 0.05), (0, 4)))
)
def test_each_with_each(gap, inset, thickness, iterations):
    item, places, weights = weighted_grid()
    run(gap=gap, inset=inset, thickness=thickness, iterations=iterations, make_centers=True)
    areas = flat_areas(item)
    assert areas.sum() == pytest.approx(1, rel=1e-4) if gap == 0 else 0.5 < areas.sum() < 0.95
    heights = positions(find_output(item, CELLS).data)[:, 2]
    assert np.ptp(heights) == pytest.approx(thickness, abs=1e-6)
    # The heavy site moves away from those that it hides, which stay where they are until then.
    apart = np.linalg.norm(places[:, None] - places, axis=2)
    hidden = np.flatnonzero((weights - weights[:, None] > apart).any(axis=1))
    assert len(hidden) and (f"{len(hidden)} sites without one" in jobs.state.line) == (iterations == 0)
    moved = np.linalg.norm(positions(find_output(item, CENTERS).data) - places, axis=1)
    assert (moved.max() > 1e-3) == (iterations > 0)


def test_cells_keep_the_gap_from_each_other():
    item, places, weights = weighted_grid()
    run(gap=0.02)
    mesh = find_output(item, CELLS).data
    corners = positions(mesh)[:, :2]
    cells = np.empty(len(mesh.polygons), np.int32)
    mesh.attributes["saddleback_cell"].data.foreach_get("value", cells)
    owner = np.full(len(corners), -1)
    for face, cell in zip(mesh.polygons, cells, strict=True):
        assert (owner[list(face.vertices)] == -1).all()
        owner[list(face.vertices)] = cell
    distances = np.linalg.norm(corners[:, None] - places[:, :2], axis=2) - weights
    assert (distances.argmin(axis=1) == owner).all()
    apart = np.linalg.norm(corners[:, None] - corners, axis=2)[owner[:, None] != owner]
    assert 0.0199 < apart.min() < 0.021


def test_the_panels_lengths_work_for_weights():
    item, _, _ = weighted_grid()
    run(lengths="RELATIVE", gap_share=10.0, inset_share=10.0, thickness_share=10.0)
    assert 0.5 < flat_areas(item).sum() < 0.97
    assert np.ptp(positions(find_output(item, CELLS).data)[:, 2]) > 0.005


def test_a_gap_leaves_nothing_of_narrow_cells():
    weighted_grid()
    run(gap=0.15)
    assert "cells" in jobs.state.line and "gap" in jobs.state.line


def draped_grid(space):
    """A square of side 2 raised to a saddle, with the weights of some of its vertices; a UV map of side 1."""
    item = grid(n=24, size=2.0)
    places = positions(item.data)
    places[:, 2] = 0.4 * (places[:, 0] - 1) * (places[:, 1] - 1)
    item.data.vertices.foreach_set("co", places.ravel())
    chosen = np.random.default_rng(4).permutation(len(places))[:40]
    weights = np.zeros(len(places), np.float32)
    weights[chosen] = 0.15 * np.random.default_rng(5).random(40)
    item.data.attributes.new("size", "FLOAT", "POINT").data.foreach_set("value", weights)
    if space == "UV":
        corners = np.empty(len(item.data.loops), np.int32)
        item.data.loops.foreach_get("vertex_index", corners)
        uv = (0.5 * places[corners, :2]).astype(np.float32)
        item.data.uv_layers.new(name="UVMap").data.foreach_set("uv", uv.ravel())
    select(item, chosen.tolist())
    return item, np.sort(chosen), weights


def cell_areas(item):
    mesh = find_output(item, CELLS).data
    cells = np.empty(len(mesh.polygons), np.int32)
    mesh.attributes["saddleback_cell"].data.foreach_get("value", cells)
    return np.bincount(cells, [face.area for face in mesh.polygons], minlength=40)


@pytest.mark.parametrize("space", ["UV", "DISK"])
def test_weights_count_on_surfaces_as_well(space):
    item, chosen, weights = draped_grid(space)
    whole = sum(face.area for face in item.data.polygons)
    settings = {"sites_source": "SELECTED", "weights_name": "size", "space": space}
    bpy.ops.saddleback.voronoi_2d(**settings, relax_sites=False)
    areas = cell_areas(item)
    assert areas.sum() == pytest.approx(whole, rel=2e-3)  # quads are bent
    mesh = find_output(item, CELLS).data
    assert mesh.attributes["saddleback_cell"].domain == "FACE"
    if space == "UV":  # as lengths on the surface: those of the map times the root of what it shrinks areas by
        places = positions(item.data)
        scale = 2 * np.sqrt(whole / 4)
        middles = np.array([face.center for face in mesh.polygons])[:, :2] / 2
        distances = np.linalg.norm(middles[:, None] - places[chosen, :2] / 2, axis=2) - weights[chosen] / scale
        cells = np.empty(len(mesh.polygons), np.int32)
        mesh.attributes["saddleback_cell"].data.foreach_get("value", cells)
        behind = distances[np.arange(len(cells)), cells] - distances.min(axis=1)
        assert behind.max() <= 2.1e-3 * np.sqrt(1 / 40)
    bpy.ops.saddleback.voronoi_2d(**settings, iterations=8)
    relaxed = cell_areas(item)
    assert relaxed.sum() == pytest.approx(whole, rel=2e-3) and relaxed.std() < areas.std()
    bpy.ops.saddleback.voronoi_2d(**settings, iterations=8, gap=0.02, thickness=0.05, inset=0.01)
    assert np.ptp(positions(find_output(item, CELLS).data)[:, 2]) > np.ptp(positions(item.data)[:, 2])
    bpy.ops.saddleback.voronoi_2d(**settings, iterations=8, gap=0.04, thickness=0.0, inset=0.0)
    assert 0.5 * whole < cell_areas(item).sum() < 0.97 * whole

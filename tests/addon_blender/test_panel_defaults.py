# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel begins with, and that scripts keep what they had: lengths by the cell, objects as they are seen."""

import bpy
import numpy as np
import pytest
from scenes import attribute, positions, select, sphere, tube_radius
from test_modal import press, pressed_tessellate, run_to_end

from saddleback_blender import jobs
from saddleback_blender.bridge.outputs.out_collection import find_output
from saddleback_blender.core.settings import DistanceSettings, PathSettings
from saddleback_blender.ops.distance import SADDLEBACK_OT_distance
from saddleback_blender.ops.path import SADDLEBACK_OT_path
from saddleback_blender.props import old_files
from saddleback_blender.ui import panel_parts, tessellate_panels

QUICK = {"count": 40, "iterations": 2, "k": 30}


def run(pair):
    operator, context = pair
    operator.invoke(context, None)
    assert run_to_end(operator, context) == {"FINISHED"}, operator.messages


def radius(item):
    return tube_radius(find_output(item, "edges"))


@pytest.mark.parametrize("size", [0.06, 1.0, 120.0])
def test_lengths_are_shares_of_a_cell_whatever_the_size_of_the_model(size):
    item = sphere(radius=size)
    bpy.context.view_layer.update()
    run(pressed_tessellate(**QUICK, make_cells=True))
    cell = np.sqrt(sum(polygon.area for polygon in item.data.polygons) / 40)
    assert radius(item) == pytest.approx(0.04 * cell, rel=1e-4)
    far = np.array([vertex.co.length for vertex in find_output(item, "cells").data.vertices]).max()
    assert far == pytest.approx(size + 0.08 * cell, rel=0.01)
    told = next(line for line in jobs.state.figures if line.startswith("In world units: "))
    assert f"Radius {0.04 * cell:.3g}, Gap {0.08 * cell:.3g}" in told and "Rib" not in told


def test_a_length_that_a_script_names_is_one_of_the_world():
    item = sphere()
    bpy.ops.saddleback.tessellate(**QUICK)
    assert radius(item) == pytest.approx(0.01)  # as always
    bpy.ops.saddleback.clear()
    for group in ("tessellate",):
        item.saddleback.property_unset(group)
    run(pressed_tessellate(**QUICK))
    relative = radius(item)
    assert item.saddleback.tessellate.lengths == "RELATIVE" and relative > 0.015
    bpy.ops.saddleback.tessellate()
    assert radius(item) == relative  # the same again
    bpy.ops.saddleback.tessellate(edge_radius=0.02)
    assert radius(item) == pytest.approx(0.02)
    bpy.ops.saddleback.tessellate(seed=1)  # what the call before named counted for that call only
    assert radius(item) == pytest.approx(0.01)
    bpy.ops.saddleback.tessellate(edge_radius_share=8.0)
    assert radius(item) == pytest.approx(2 * relative, rel=1e-5)
    bpy.ops.saddleback.tessellate(edge_radius=0.03, lengths="RELATIVE")
    assert radius(item) == pytest.approx(relative, rel=1e-5)


def test_lines_without_cells_are_shares_of_the_model():
    item = sphere(radius=50.0)
    run(press(SADDLEBACK_OT_path, PathSettings()))
    run(press(SADDLEBACK_OT_distance, DistanceSettings()))
    extent = np.linalg.norm(item.dimensions)
    assert tube_radius(find_output(item, "paths")) == pytest.approx(0.004 * extent, rel=1e-5)
    assert tube_radius(find_output(item, "isolines")) == pytest.approx(0.0025 * extent, rel=1e-5)


def test_an_object_with_modifiers_is_taken_as_it_is_seen_and_its_copy_is_out_of_the_way():
    item = sphere(subdivisions=2)
    item.modifiers.new("Smooth", "SUBSURF").levels = 1
    run(pressed_tessellate(**QUICK, make_edges=True))
    copy = find_output(item, "surface")
    assert len(copy.data.vertices) > len(item.data.vertices) and "saddleback_cell" in copy.data.attributes
    assert copy.hide_viewport and copy.hide_render
    shown = item.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    outermost = np.linalg.norm(positions(shown), axis=1).max()
    edges = np.linalg.norm(positions(find_output(item, "edges").data), axis=1)
    assert outermost < 0.98 and edges.max() < outermost + 1e-6  # the object's own vertices are at 1
    copy.hide_viewport = False  # the artist wants it: it stays so
    run(pressed_tessellate(**QUICK, seed=3))
    assert not find_output(item, "surface").hide_viewport


def test_colors_of_distances_stand_before_the_surface_that_modifiers_make():
    item = sphere(subdivisions=2)
    item.modifiers.new("Smooth", "SUBSURF").levels = 1
    run(press(SADDLEBACK_OT_distance, DistanceSettings(), k=30))
    copy = find_output(item, "surface")
    assert not copy.hide_viewport and copy.active_material is not None
    shown = copy.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    lift = [
        after.co.length - before.co.length for after, before in zip(shown.vertices, copy.data.vertices, strict=True)
    ]
    assert min(lift) > 2e-4 and max(lift) < 2e-3


def test_paint_makes_cells_smaller_there_and_leaves_some_elsewhere():
    item = sphere(subdivisions=5)
    top = [vertex.index for vertex in item.data.vertices if vertex.co.z > 0.8]
    item.vertex_groups.new(name="Painted").add(top, 1.0, "REPLACE")
    painted = {"count": 200, "iterations": 15, "density_source": "VERTEX_GROUP"}
    run(pressed_tessellate(**painted))
    assert item.saddleback.tessellate.density_smaller_by == 4.0
    cell = attribute(item, "saddleback_cell")
    inside, outside = len(set(cell[top])), len(set(np.delete(cell, top)))
    assert 100 < inside < 150 and 60 < outside < 110  # ten percent of the surface, sixteen times as dense
    bpy.ops.saddleback.tessellate(
        **painted, density_smaller_by=0.0
    )  # what scripts always had: all of them in the paint
    assert len(set(attribute(item, "saddleback_cell")[top])) > 190


def save_as_version_0_1(path):
    bpy.app.handlers.save_pre.remove(old_files.mark)
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
    finally:
        bpy.app.handlers.save_pre.append(old_files.mark)
    bpy.ops.wm.open_mainfile(filepath=str(path))


def test_a_file_of_version_0_1_runs_as_it_did(tmp_path):
    item = sphere()
    name = item.name
    item.saddleback.tessellate.count = 30
    item.saddleback.tessellate.edge_radius = 0.03
    item.saddleback.distance.isoline_count = 5
    select(item, [0])
    save_as_version_0_1(tmp_path / "old.blend")
    item = bpy.data.objects[name]
    settings = item.saddleback.tessellate
    assert (settings.lengths, settings.use_modifiers, settings.density_smaller_by) == ("ABSOLUTE", False, 0.0)
    assert item.saddleback.distance.sources == "SELECTED"
    bpy.context.view_layer.objects.active = item
    run(pressed_tessellate(k=30))
    assert radius(item) == pytest.approx(0.03)
    new = sphere("New")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "new.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "new.blend"))
    assert bpy.data.objects["New"].saddleback.tessellate.lengths == "RELATIVE"
    assert new is not None and bpy.data.objects[name].saddleback.tessellate.lengths == "ABSOLUTE"


def test_centres_of_version_0_1_are_centers(tmp_path):
    item = sphere()
    name, settings = item.name, item.saddleback.tessellate
    run(pressed_tessellate(**QUICK, make_centers=True))
    find_output(item, "centers")["saddleback_role"] = "centres"
    settings.property_unset("make_centers")
    settings["make_centres"] = True
    save_as_version_0_1(tmp_path / "old.blend")
    item = bpy.data.objects[name]
    assert item.saddleback.tessellate.make_centers
    bpy.context.view_layer.objects.active = item
    bpy.ops.saddleback.tessellate(count=30, k=30)
    assert len(find_output(item, "centers").data.vertices) == 30
    assert sum("Centers" in other.name for other in bpy.data.objects) == 1


def test_what_a_run_said_belongs_to_its_object_and_is_kept_in_the_file(tmp_path):
    first = sphere("First")
    run(pressed_tessellate(**QUICK))
    second = sphere("Second")
    assert second.saddleback.tessellate.told == ""
    bpy.ops.saddleback.tessellate(**{**QUICK, "count": 20})
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "told.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "told.blend"))
    first, second = bpy.data.objects["First"], bpy.data.objects["Second"]
    line, lengths = first.saddleback.tessellate.told.splitlines()
    assert line.startswith("'First': 40 cells, 2 iterations") and lengths.startswith("In world units: Radius ")
    assert first.saddleback.tessellate.figures.startswith("Triangles of the sites")
    assert second.saddleback.tessellate.told.startswith("'Second': 20 cells")
    bpy.context.view_layer.objects.active = second
    bpy.ops.saddleback.clear()
    assert second.saddleback.tessellate.told == "" == second.saddleback.tessellate.figures
    assert first.saddleback.tessellate.told


def test_the_panels_are_gone_when_the_library_is(monkeypatch):
    item = sphere()
    panel = tessellate_panels.SADDLEBACK_PT_tessellate
    assert panel.poll(bpy.context) and item is not None
    monkeypatch.setattr(panel_parts, "native_problem", lambda: "the library does not load")
    assert not panel.poll(bpy.context)


def shown(item):
    """Vertices of what is seen of an object, in the world."""
    bpy.context.view_layer.update()
    mesh = item.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    return positions(mesh) @ np.array(item.matrix_world)[:3, :3].T + np.array(item.matrix_world)[:3, 3]


def test_bare_cells_stand_a_hair_before_the_surface_and_a_script_s_lie_on_it():
    item = sphere(radius=10.0)
    bpy.context.view_layer.update()
    bpy.ops.saddleback.tessellate(**QUICK, make_cells=True)
    cells = find_output(item, "cells")
    assert "Lift" not in cells.modifiers
    item.saddleback.tessellate.thickness_share = 0.0
    item.saddleback.tessellate.gap_share = 0.0
    run(pressed_tessellate(**QUICK, make_cells=True))
    cells = find_output(item, "cells")
    rise = np.linalg.norm(shown(cells), axis=1) - np.linalg.norm(positions(cells.data), axis=1)
    assert rise.min() > 2e-3 and rise.max() < 2e-2
    cells.modifiers["Lift"].strength = 1.0  # the artist's
    run(pressed_tessellate(**QUICK, make_cells=True, seed=2))
    assert find_output(item, "cells").modifiers["Lift"].strength == 1.0
    run(pressed_tessellate(**QUICK, make_cells=True, thickness_share=5.0))
    assert "Lift" not in find_output(item, "cells").modifiers


@pytest.mark.parametrize("scale", [0.01, 1.0, 100.0])
def test_the_copy_of_a_scaled_surface_is_lifted_by_a_hair_too(scale):
    item = sphere(radius=1.0 / scale)
    item.modifiers.new("Finer", "SUBSURF").levels = 1
    item.scale = (scale, scale, scale)
    bpy.context.view_layer.update()
    bpy.ops.saddleback.apply_look(look="BANDS")
    rise = np.linalg.norm(shown(find_output(item, "surface")) - shown(item), axis=1)
    np.testing.assert_allclose(rise, 5e-4 * max(item.dimensions), rtol=0.01)


def test_the_source_can_be_hidden_and_still_be_worked_on():
    item = sphere()
    item.display_type = "WIRE"
    bpy.ops.saddleback.hide_source()
    assert item.display_type == "BOUNDS" and item.hide_render
    assert bpy.ops.saddleback.tessellate(**QUICK) == {"FINISHED"}
    bpy.ops.saddleback.hide_source()
    assert item.display_type == "WIRE" and not item.hide_render


def test_what_a_look_hides_can_be_shown_and_what_was_left_out_of_renders_stays_so():
    item = sphere()
    item.hide_render = True
    assert bpy.ops.saddleback.apply_look(look="LAMP") == {"FINISHED"}
    assert item.display_type == "BOUNDS" and item.hide_render
    bpy.ops.saddleback.hide_source()
    assert item.display_type == "TEXTURED" and item.hide_render
    bpy.ops.saddleback.hide_source()
    assert bpy.ops.saddleback.apply_look(look="PANELS") == {"FINISHED"}
    assert item.display_type == "BOUNDS"  # a person hid it

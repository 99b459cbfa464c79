# SPDX-License-Identifier: GPL-3.0-or-later
"""Auto Update: what was made follows what it was made from.

Blender without a window has no timers; these tests take the steps that one would.
"""

import os
import sys
import threading
import time

import bpy
import numpy as np
import pytest
from scenes import attribute, begin, fingerprint, grid, paint, positions, steps, switch_on

from saddleback_blender import jobs
from saddleback_blender.bridge.inputs.mesh_in import read_surface
from saddleback_blender.bridge.outputs import live_preview, out_edges
from saddleback_blender.bridge.outputs.out_collection import find_output
from saddleback_blender.core import cache, native
from saddleback_blender.core.errors import BadInputError
from saddleback_blender.core.flowing_cells import FlowingCells
from saddleback_blender.ops import live, tessellate
from saddleback_blender.props.kept_sites import kept_cells

CELL = "saddleback_cell"
REST = live.REST


def cells(item):
    return attribute(item, CELL)


def threads():
    return [thread for thread in threading.enumerate() if thread.name.startswith("saddleback") and thread.is_alive()]


def test_lines_are_joined_by_the_thread_and_not_again_where_the_window_waits(item, monkeypatch):
    def joined(*_):
        raise AssertionError("joined while the window waits")

    monkeypatch.setattr(out_edges, "edge_network", joined)
    paint(item)
    steps()
    assert find_output(item, "edges").data.vertices


def test_cells_of_one_dab_begin_with_those_of_the_last(item):
    paint(item)
    steps()
    (watched,) = live.live.watched.values()
    known = watched.cells._cells
    assert known is not None
    paint(item, (0.0, 1.0, 0.0))
    steps()
    assert watched.cells._cells is known


def test_the_first_thing_seen_moves_the_cells_about_the_dab_only(item, monkeypatch):
    places = kept_cells(item)[1]
    seen = []
    monkeypatch.setattr(FlowingCells, "show", lambda _self, cells, done: seen.append((cells.sites, done)))
    paint(item)
    begin()
    steps()
    read = read_surface(item, item.data)
    surface = native.load().Mesh(read.vertices, read.triangles)
    first, last = (np.linalg.norm(sites.positions(surface) - places, axis=1) for sites in (seen[0][0], seen[-1][0]))
    size = np.sqrt(surface.area / 80)
    assert 0 < np.count_nonzero(first > 1e-3 * size) < np.count_nonzero(last > 1e-3 * size)
    assert (first[first > 1e-3 * size] > 1e-2 * size).all()
    assert seen[0][1] == 1 < seen[-1][1] <= 15


@pytest.mark.skipif(sys.platform != "linux", reason="threads have no priority of their own")
def test_what_is_seen_already_goes_on_behind_the_window(item, monkeypatch):
    calls = []
    monkeypatch.setattr(os, "setpriority", lambda *given: calls.append((threading.get_native_id(), *given)))
    paint(item)
    steps()
    assert calls and all(
        thread == who != threading.get_native_id() and (kind, nice) == (os.PRIO_PROCESS, 10)
        for thread, kind, who, nice in calls
    )


def test_cells_follow_the_brush_where_it_was(item, monkeypatch):
    monkeypatch.setattr(live, "REST", REST)  # in which a preview is seen
    before = cells(item)
    near = paint(item)
    seen = []
    steps(lambda: bool(seen.extend(len(preview.ends) for preview in live_preview.shown)))
    after = cells(item)
    assert max(seen) > 100, "no preview was drawn"
    assert not live_preview.shown
    assert len(np.unique(after)) == 80
    assert len(np.unique(after[near])) > len(np.unique(before[near])) + 3
    far = positions(item.data)[:, 0] < -0.8  # there cells only give way a little: each keeps its number
    assert (after[far] == before[far]).mean() > 0.5
    assert jobs.state.live["Sphere"] == ""


@pytest.mark.parametrize("run", ["tessellate", "relax_live"])
def test_cells_go_on_from_where_a_run_left_them(item, run, tmp_path):
    """Also those of Relax Live, which no seed makes again, and those of a file that was opened."""
    getattr(bpy.ops.saddleback, run)(count=80, seed=5, iterations=3)
    path = str(tmp_path / "cells.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    cache.shared.clear()
    item = bpy.data.objects["Sphere"]
    before = cells(item)
    steps()
    paint(item, reach=0.15)
    steps()
    after = cells(item)
    far = positions(item.data)[:, 0] < -0.5
    assert (after != before).any() and (after[far] == before[far]).mean() > 0.9


def test_cells_follow_sites_that_are_edited_once_edit_mode_is_left(item):
    before = cells(item)
    bpy.ops.saddleback.edit_sites()
    points = bpy.context.object
    bpy.ops.mesh.select_all(action="DESELECT")
    bpy.ops.object.mode_set(mode="OBJECT")
    points.data.vertices[7].select = True
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.delete(type="VERT")
    bpy.context.view_layer.update()
    for _ in range(5):
        live.step(bpy.context)
    np.testing.assert_array_equal(cells(item), before)
    assert jobs.state.live["Sphere"] == live.WAITS["EDIT"]
    bpy.ops.object.mode_set(mode="OBJECT")
    steps()
    assert len(np.unique(cells(item))) == 79 and jobs.state.live["Sphere"] == ""


def test_a_new_count_makes_what_the_button_makes(item):
    item.saddleback.tessellate.count = 50
    steps()
    found = cells(item)
    cache.shared.clear()
    bpy.ops.saddleback.tessellate(count=50)
    np.testing.assert_array_equal(cells(item), found)
    assert found.max() == 49


def test_what_is_made_of_the_cells_follows_and_the_cells_stay(item):
    paint(item)
    steps()
    before, builds = cells(item), cache.shared.builds["cells"]
    item.saddleback.tessellate.make_cells = True
    steps()
    np.testing.assert_array_equal(cells(item), before)
    assert item.saddleback.tessellate.is_property_set("make_cells")
    assert not item.saddleback.tessellate.is_property_set("sharp_angle")  # nothing is kept that nobody chose
    assert "Sphere Cells" in bpy.data.objects and cache.shared.builds["cells"] == builds


def test_nothing_is_done_where_nothing_that_is_read_changed(item, monkeypatch):
    monkeypatch.setattr(live, "_start", lambda *_: pytest.fail("a run was begun"))
    other = grid("Other")
    other.location.x = 5.0
    steps()
    item.data.update_tag()  # touched, but the same
    steps()
    bpy.data.objects["Sphere Edges"].location.x = 1.0
    steps()


def test_what_was_made_goes_with_the_object_and_is_not_made_again(item, monkeypatch):
    def began(change):
        runs = []
        monkeypatch.setattr(live, "_start", lambda *of: (runs.append(1), start(*of)))
        change()
        steps()
        return bool(runs)

    start, edges = live._start, find_output(item, "edges").data
    before, lines = cells(item), positions(edges)
    assert not began(lambda: setattr(item, "location", (131072.0, -3.0, 1.5)))
    assert not began(lambda: setattr(item, "rotation_euler", (0.3, -0.7, 2.0)))
    assert np.array_equal(cells(item), before) and np.array_equal(positions(edges), lines)
    assert began(lambda: setattr(item, "scale", (1.0, 2.0, 1.0)))
    assert began(lambda: setattr(item.saddleback.tessellate, "make_shell", True))
    assert not began(lambda: setattr(item, "rotation_euler", (0.0, 0.0, 0.0)))
    assert began(lambda: setattr(item.saddleback.tessellate, "base_height", 0.2))  # above its lowest point
    assert began(lambda: setattr(item, "rotation_euler", (0.5, 0.0, 0.0)))


def test_an_object_that_is_dragged_is_not_even_read(item, monkeypatch):
    """A look at a dense mesh in each frame would let the window stutter."""

    def reads(change):
        seen = []
        monkeypatch.setattr(live, "_read", lambda *of: (seen.append(1), read(*of))[1])
        change()
        steps()
        return len(seen)

    read = live._read
    reads(lambda: setattr(item, "scale", (1.0, 2.0, 1.0)))
    assert not reads(lambda: setattr(item, "location", (1.0, -3.0, 1.5)))
    assert not reads(lambda: setattr(item, "rotation_euler", (0.3, -0.7, 2.0)))
    assert reads(lambda: setattr(item, "scale", (1.0, 1.0, 1.0)))
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    item.parent = parent
    steps()
    assert not reads(lambda: setattr(parent, "location", (2.0, 0.0, 0.0)))
    assert reads(lambda: setattr(parent, "scale", (2.0, 1.0, 1.0)))
    empty = bpy.data.objects.new("Child", None)  # from which distances may be measured
    bpy.context.scene.collection.objects.link(empty)
    empty.parent = item
    steps()
    assert reads(lambda: setattr(item, "location", (0.0, 0.0, 0.0)))


def test_the_last_of_quick_changes_is_what_is_made(item):
    for count in (300, 200, 30):
        item.saddleback.tessellate.count = count
        begin()
    steps()
    assert cells(item).max() == 29 and len([o for o in bpy.data.objects if o.parent == item]) == 1


def test_distances_follow_empties():
    sheet = grid(n=20)
    empty = bpy.data.objects.new("From", None)
    bpy.context.scene.collection.objects.link(empty)
    empty.parent = sheet
    bpy.ops.saddleback.distance(sources="EMPTIES")
    switch_on(sheet)
    assert attribute(sheet, "saddleback_distance")[0] == pytest.approx(0.0, abs=1e-6)
    empty.location = (1.0, 1.0, 0.0)
    steps()
    assert attribute(sheet, "saddleback_distance")[-1] == pytest.approx(0.0, abs=1e-6)
    second = bpy.data.objects.new("Also From", None)
    bpy.context.scene.collection.objects.link(second)
    second.parent = sheet
    steps()
    assert attribute(sheet, "saddleback_distance")[0] == pytest.approx(0.0, abs=1e-6)


def test_a_field_follows_its_stroke_and_shapes_follow_the_field():
    sheet = grid(n=12)
    curve = bpy.data.curves.new("Stroke", "CURVE")
    curve.dimensions = "3D"
    points = curve.splines.new("POLY").points
    points.add(1)
    points[0].co, points[1].co = (0.1, 0.5, 0, 1), (0.9, 0.5, 0, 1)
    stroke = bpy.data.objects.new("Stroke", curve)
    bpy.context.scene.collection.objects.link(stroke)
    bpy.ops.saddleback.direction_field(symmetry="2", strokes="OBJECT", strokes_object="Stroke")
    bpy.ops.saddleback.distribute(count=6, shapes="SCALES", field_source="PANEL")
    switch_on(sheet)
    made = positions(bpy.data.objects["Grid Shapes"].data)
    values = np.empty(3 * len(sheet.data.vertices), np.float32)
    points[1].co = (0.1, 0.9, 0, 1)
    curve.update_tag()
    steps()
    sheet.data.attributes["saddleback_direction"].data.foreach_get("vector", values)
    turned = np.abs(values.reshape(-1, 3)).mean(axis=0)
    assert turned[1] > turned[0]
    again = positions(bpy.data.objects["Grid Shapes"].data)
    assert again.shape != made.shape or not np.allclose(again, made)


def test_cells_follow_the_mesh(item):
    item.data.vertices[0].co *= 1.5
    item.data.update()
    steps()
    edges = positions(bpy.data.objects["Sphere Edges"].data)
    assert np.linalg.norm(edges, axis=1).max() > 1.01
    assert cells(item).max() == 79


def test_edit_mode_is_waited_for(item):
    before = fingerprint()
    paint(item)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.context.view_layer.update()
    for _ in range(3):
        assert live.step(bpy.context) == live.WAIT
    assert jobs.state.live["Sphere"] == "waits until Edit Mode is left"
    bpy.ops.object.mode_set(mode="OBJECT")
    assert fingerprint() == before
    steps()
    assert fingerprint() != before and jobs.state.live["Sphere"] == ""


def test_an_object_deleted_meanwhile_leaves_a_sentence(item):
    paint(item)
    begin()
    task = live.live.operator.task
    bpy.data.objects.remove(item)
    before = fingerprint()
    steps()
    assert fingerprint() == before and not live_preview.shown
    assert "'Sphere' is gone" in jobs.state.live_ended
    task.join(1.0)
    assert task.done


def test_a_renamed_object_goes_on(item):
    paint(item)
    begin()
    item.name = "Ball"
    before = cells(item)
    steps()
    assert not np.array_equal(cells(item), before)
    assert jobs.state.live == {"Ball": ""} and not jobs.state.live_ended
    item.name = "Globe"  # while nothing goes on
    item.saddleback.tessellate.count = 20
    steps()
    assert cells(item).max() == 19


def test_undo_is_taken_as_it_is(item, monkeypatch):
    paint(item)
    begin()
    before = fingerprint()
    live.accept()  # what Blender calls after Undo and Redo
    assert live.live.operator is None and not live_preview.shown
    monkeypatch.setattr(live, "_start", lambda *_: pytest.fail("Undo was undone"))
    steps()
    assert fingerprint() == before
    monkeypatch.undo()
    paint(item, (0.0, 1.0, 0.0))
    steps()
    assert fingerprint() != before or jobs.state.live["Sphere"] == ""


def test_another_file_ends_it_and_leaves_no_thread(item):
    paint(item)
    begin()
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    assert live.live.operator is None and not live.live.watched and not jobs.state.live
    deadline = time.monotonic() + 2.0
    while threads():
        assert time.monotonic() < deadline, threads()
        time.sleep(0.01)
    steps()


def test_a_file_that_is_opened_is_taken_as_it_is(item, tmp_path, monkeypatch):
    path = str(tmp_path / "live.blend")
    paint(item)
    begin()
    bpy.ops.wm.save_as_mainfile(filepath=path)
    monkeypatch.setattr(live, "_start", lambda *_: pytest.fail("opening a file began a run"))
    bpy.ops.wm.open_mainfile(filepath=path)
    steps()
    ball = bpy.data.objects["Sphere"]
    assert ball.saddleback.layers[0].auto_update
    assert not [block for block in (*bpy.data.objects, *bpy.data.meshes) if "Live" in block.name]
    monkeypatch.undo()
    ball.saddleback.tessellate.count = 20
    steps()
    assert cells(ball).max() == 19


def test_what_cannot_be_read_is_told_and_changes_nothing(item):
    before, told = cells(item), fingerprint()
    item.saddleback.tessellate.density_name = "gone"
    steps()
    assert "no vertex group 'gone'" in jobs.state.live["Sphere"]
    item.saddleback.tessellate.density_name = "paint"
    steps()
    assert jobs.state.live["Sphere"] == ""
    np.testing.assert_array_equal(cells(item), before)
    assert fingerprint() == told


def test_a_hidden_object_goes_on_once_it_is_shown(item):
    before = cells(item)
    item.hide_set(True)
    paint(item)
    steps()
    assert "hidden" in jobs.state.live["Sphere"] and np.array_equal(cells(item), before)
    item.hide_set(False)
    steps()
    assert jobs.state.live["Sphere"] == "" and not np.array_equal(cells(item), before)


def test_it_goes_on_in_an_open_file_whose_addon_is_enabled_again(item):
    bpy.ops.preferences.addon_disable(module="saddleback_blender")
    assert not bpy.app.timers.is_registered(live.tick)
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    assert bpy.app.timers.is_registered(live.tick)  # who looks around
    steps()
    assert [watched.name for watched in live.live.watched.values()] == ["Sphere"]


def test_a_write_that_fails_changes_nothing(item, monkeypatch):
    before = fingerprint()

    def fail(*_args, **_options):
        raise BadInputError("'Sphere': no")

    monkeypatch.setattr(tessellate, "write_edges", fail)
    paint(item)
    steps()
    assert jobs.state.live["Sphere"] == "'Sphere': no" and fingerprint() == before
    monkeypatch.undo()
    item.saddleback.tessellate.seed = 3
    steps()
    assert jobs.state.live["Sphere"] == ""


def test_another_layer_ends_the_run(item):
    paint(item)
    begin()
    bpy.ops.saddleback.layer_add()
    before = fingerprint()
    steps()
    assert live.live.operator is None and fingerprint() == before


def test_a_layer_that_is_frozen_meanwhile_gets_nothing(item):
    paint(item)
    begin()
    bpy.ops.saddleback.layer_freeze()
    before = fingerprint()
    steps()
    assert live.live.operator is None and fingerprint() == before


def test_a_script_s_run_is_taken_as_it_is(item, monkeypatch):
    paint(item)
    begin()
    bpy.ops.saddleback.tessellate(count=25)
    monkeypatch.setattr(live, "_start", lambda *_: pytest.fail("the script's result was made anew"))
    steps()
    assert cells(item).max() == 24


def test_switched_off_it_stops(item):
    paint(item)
    begin()
    item.saddleback.layers[0].auto_update = False
    before = fingerprint()
    steps()
    assert live.live.operator is None and not live.live.watched
    paint(item, (0.0, 1.0, 0.0))
    steps()
    assert fingerprint() == before


def test_without_the_addon_nothing_is_left(item):
    paint(item)
    begin()
    bpy.ops.preferences.addon_disable(module="saddleback_blender")
    try:
        assert not [handler for handler in bpy.app.handlers.depsgraph_update_post if "saddleback" in handler.__module__]
        assert not threads() and not live_preview.shown
    finally:
        bpy.ops.preferences.addon_enable(module="saddleback_blender")

# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel's way: a thread, a timer, ESC.

Blender without a window never calls `modal`; these tests do what its event loop does.
"""

import random
import threading
import time
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from scenes import attribute, fingerprint, grid, select, sphere

import saddleback as sb
from saddleback_blender import jobs
from saddleback_blender.bridge.inputs.mesh_in import read_surface
from saddleback_blender.bridge.outputs import live_preview
from saddleback_blender.core import cache
from saddleback_blender.core.settings import DistanceSettings, DistributeSettings, TessellateSettings
from saddleback_blender.ops.distance import SADDLEBACK_OT_distance
from saddleback_blender.ops.distribute import SADDLEBACK_OT_distribute
from saddleback_blender.ops.tessellate import SADDLEBACK_OT_relax_live, SADDLEBACK_OT_tessellate

ESC = SimpleNamespace(type="ESC", value="PRESS", ctrl=False, oskey=False)
TIMER = SimpleNamespace(type="TIMER", value="NOTHING", ctrl=False, oskey=False)


class Context:
    """The real context, with a window manager that counts timers and a status bar that remembers."""

    def __init__(self):
        self.timers = 0
        self.status = []
        self.window = None
        self.workspace = SimpleNamespace(status_text_set=self.status.append)
        self.window_manager = SimpleNamespace(
            windows=[],
            event_timer_add=self._add,
            event_timer_remove=self._remove,
            modal_handler_add=lambda operator: True,
        )

    def _add(self, _step, window):
        self.timers += 1
        return object()

    def _remove(self, _timer):
        self.timers -= 1

    def __getattr__(self, name):
        return getattr(bpy.context, name)


def press(kind, defaults, **options):
    """An instance of the operator as Blender would make it for a click, and its context."""
    bases = tuple(base for base in kind.__mro__ if base.__module__.startswith("saddleback_blender"))
    plain = type("Pressed", (), {})
    for base in reversed(bases):
        for name, value in vars(base).items():
            if not name.startswith("__") and name not in kind.__annotations__:
                setattr(plain, name, value)
    operator = plain()
    vars(operator).update({**vars(defaults), **options})
    operator.properties = SimpleNamespace(is_property_set=lambda name: name in options)
    operator.messages = []
    operator.report = lambda kinds, text: operator.messages.append((*kinds, text))
    return operator, Context()


def pressed_tessellate(**options):
    return press(SADDLEBACK_OT_tessellate, TessellateSettings(), **options)


def pressed_live(**options):
    return press(SADDLEBACK_OT_relax_live, TessellateSettings(), **options)


def wait_for_lines(operator, context, seconds=60.0):
    """Sends timer events until lines are seen; returns what shows them."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        assert operator.modal(context, TIMER) == {"PASS_THROUGH"}
        if live_preview.shown and len(live_preview.shown[0].ends):
            return live_preview.shown[0]
        time.sleep(0.01)
    raise AssertionError("nothing was shown")


def run_to_end(operator, context, seconds=60.0):
    """Sends timer events until the operator is done."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        answer = operator.modal(context, TIMER)
        if answer & {"FINISHED", "CANCELLED"}:
            return answer
        time.sleep(0.01)
    raise AssertionError("the run did not end")


@pytest.fixture
def item():
    return grid(n=50)


def test_a_run_ends_with_the_same_result_as_a_script(item):
    operator, context = pressed_tessellate(count=30, iterations=5, k=30)
    assert operator.invoke(context, None) == {"RUNNING_MODAL"}
    manager = bpy.context.window_manager
    assert manager.saddleback_running and context.timers == 1
    assert "saddleback_cell" not in item.data.attributes  # nothing before success
    assert run_to_end(operator, context) == {"FINISHED"}
    assert not manager.saddleback_running and context.timers == 0 and context.status[-1] is None
    assert operator.messages[-1][0] == "INFO"
    found = attribute(item, "saddleback_cell")
    assert (item.saddleback.tessellate.count, item.saddleback.tessellate.iterations) == (30, 5)
    cache.shared.clear()
    bpy.ops.saddleback.tessellate(count=30, iterations=5, k=30)
    np.testing.assert_array_equal(attribute(item, "saddleback_cell"), found)


def test_the_panel_measures_from_the_cursor_and_shows_it(item):
    """The first press on a mesh just added, all of which is selected."""
    select(item, range(len(item.data.vertices)))
    settings = item.saddleback.distance
    assert (settings.sources, settings.make_isolines, settings.make_preview) == ("CURSOR_PARTS", True, True)
    operator, context = press(SADDLEBACK_OT_distance, DistanceSettings(), k=10)
    operator.invoke(context, None)
    assert run_to_end(operator, context) == {"FINISHED"}
    assert attribute(item, "saddleback_distance")[-1] == pytest.approx(np.sqrt(2), rel=1e-3)
    assert item.active_material is not None and "Grid Isolines" in bpy.data.objects
    select(item, [len(item.data.vertices) - 1])
    bpy.ops.saddleback.distance()  # a call that names nothing repeats it
    assert attribute(item, "saddleback_distance")[0] == 0.0
    bpy.ops.saddleback.distance(sources="SELECTED")
    assert attribute(item, "saddleback_distance")[0] > 1.0


def test_progress_rises_and_is_told(item):
    operator, context = pressed_tessellate(count=60, iterations=40, k=40)
    operator.invoke(context, None)
    seen, texts = [], set()
    manager = bpy.context.window_manager
    while jobs.state.task is not None and not jobs.state.task.done:
        seen.append(manager.saddleback_fraction)
        texts.add(manager.saddleback_text)
        operator.modal(context, TIMER) if not jobs.state.task.done else None
        time.sleep(0.002)
    run_to_end(operator, context) if operator._task is not None else None
    assert seen == sorted(seen) and seen[0] >= 0 and seen[-1] <= 1
    assert len(set(seen)) > 5, "progress moved in fewer than five steps"
    assert any("building the distance graph" in text for text in texts)
    assert all(text.startswith("Grid") for text in texts)


def test_what_the_panel_reads_changes_only_when_the_operator_looks(item):
    """Blender asks twice for a text, and writes the second into what the first has room for."""
    operator, context = pressed_tessellate(count=60, iterations=40, k=40)
    operator.invoke(context, None)
    first, task = bpy.context.window_manager.saddleback_text, operator._task
    assert first.startswith("Grid")
    task.join()
    task.progress._text = "a longer text than any before"
    assert bpy.context.window_manager.saddleback_text == first
    run_to_end(operator, context)
    assert bpy.context.window_manager.saddleback_text == ""


def test_escape_at_fifty_random_moments():
    item = grid(n=35)
    assert item.saddleback.tessellate.count  # the settings exist from the panel's first look on
    assert item.saddleback.distance.quality
    operator, context = pressed_tessellate(count=40, iterations=12, k=30)
    start = time.perf_counter()
    operator.invoke(context, None)
    operator._task.join()
    whole = time.perf_counter() - start
    operator.cancel(context)
    before = fingerprint()
    rng = random.Random(5)
    waits = []
    for moment in range(50):
        cache.shared.clear()
        operator, context = pressed_tessellate(count=40, iterations=12, k=30)
        assert operator.invoke(context, None) == {"RUNNING_MODAL"}
        task = operator._task
        time.sleep(rng.random() * whole * 0.9)
        asked = time.perf_counter()
        was_done = task.done
        assert operator.modal(context, ESC) == {"CANCELLED"}, moment
        answered = time.perf_counter() - asked
        task.join()
        waits.append(time.perf_counter() - asked)
        assert answered < 0.1
        assert was_done or task.error is not None or task.result is not None
        assert context.timers == 0 and context.status[-1] is None and not bpy.context.window_manager.saddleback_running
        assert operator.messages == [("INFO", "Stopped; nothing was changed")]
        assert fingerprint() == before
    assert max(waits) < 0.1, f"the thread went on for {max(waits):.3f} s"


def test_escape_while_shapes_are_laid_bent_and_cut():
    sphere(subdivisions=5)
    outputs = {"make_instances": True, "make_outlines": True, "make_cut": True, "write_attributes": True}
    options = {"shapes": "MOSAIC", "count": 150, **outputs}
    operator, context = press(SADDLEBACK_OT_distribute, DistributeSettings(), **options)
    start = time.perf_counter()
    operator.invoke(context, None)
    operator._task.join()
    whole = time.perf_counter() - start
    operator.cancel(context)
    before = fingerprint()
    waits = []
    for moment in range(9):
        cache.shared.clear()
        operator, context = press(SADDLEBACK_OT_distribute, DistributeSettings(), **options)
        operator.invoke(context, None)
        task = operator._task
        time.sleep(whole * (moment + 0.5) / 9)
        asked = time.perf_counter()
        assert operator.modal(context, ESC) == {"CANCELLED"}
        assert time.perf_counter() - asked < 0.1
        task.join()
        waits.append(time.perf_counter() - asked)
        assert operator.messages == [("INFO", "Stopped; nothing was changed")]
        assert fingerprint() == before
    assert sorted(waits)[-2] < 0.1, waits  # a busy machine may hold one of them up


def test_the_file_is_the_same_to_the_byte_after_escape(tmp_path):
    item = grid(n=60)

    def saved(name):
        read_surface(item, item.data)  # looking alone moves Blender's arrays to other addresses, which the file holds
        path = tmp_path / name
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, compress=False)
        return path.read_bytes()

    # What differs between two savings of the same file is an address of 8 bytes, or the time: that does not count.
    plain = np.array([np.frombuffer(saved("file.blend"), np.uint8) for _ in range(8)])
    differs = (plain != plain[0]).any(axis=0)
    steady = np.convolve(differs, np.ones(15), mode="same") < 0.5
    assert steady.mean() > 0.99
    operator, context = pressed_tessellate(count=60, iterations=40)
    operator.invoke(context, None)
    time.sleep(0.05)
    operator.modal(context, ESC)
    after = np.frombuffer(saved("file.blend"), np.uint8)
    assert len(after) == len(steady) and (after[steady] == plain[0][steady]).all()


def test_a_timer_event_goes_on_to_others_but_undo_waits(item):
    operator, context = pressed_tessellate(count=60, iterations=40)
    operator.invoke(context, None)
    undo = SimpleNamespace(type="Z", value="PRESS", ctrl=True, oskey=False)
    turn = SimpleNamespace(type="MIDDLEMOUSE", value="PRESS", ctrl=False, oskey=False)
    assert operator.modal(context, undo) == {"RUNNING_MODAL"}
    assert operator.modal(context, turn) == {"PASS_THROUGH"}
    operator.cancel(context)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda item: bpy.data.objects.remove(item), "was deleted or renamed"),
        (lambda item: setattr(item, "name", "Else"), "was deleted or renamed"),
        (lambda item: setattr(item.data.vertices[0].co, "z", 0.5), "was changed during the run"),
        (lambda item: item.data.clear_geometry(), "was changed during the run"),
        (lambda item: item.data.flip_normals(), "was changed during the run"),
        (lambda item: setattr(item, "scale", (2, 1, 1)), "was changed during the run"),
        (lambda item: bpy.ops.object.mode_set(mode="EDIT"), "went into Edit Mode"),
        (lambda item: bpy.context.scene.collection.objects.unlink(item), "left the view layer"),
    ],
)
def test_an_object_that_changed_during_the_run_gets_nothing(item, change, words):
    operator, context = pressed_tessellate(count=20, iterations=2)
    operator.invoke(context, None)
    change(item)
    bpy.context.view_layer.update()
    before = fingerprint()
    assert run_to_end(operator, context) == {"CANCELLED"}
    ((kind, text),) = operator.messages
    assert kind == "ERROR" and words in text and "'Grid'" in text
    assert fingerprint() == before


def test_errors_of_the_thread_are_told(item):
    operator, context = press(SADDLEBACK_OT_distance, DistanceSettings(), k=10)
    select(item, [0])
    operator.invoke(context, None)
    assert run_to_end(operator, context) == {"FINISHED"}
    select(item, [300])
    mesh = item.data
    mesh.polygons[0].vertices = [int(v) for v in mesh.polygons[1].vertices]  # the same face twice
    operator, context = press(SADDLEBACK_OT_distance, DistanceSettings(), k=10)
    operator.invoke(context, None)
    assert run_to_end(operator, context) == {"CANCELLED"}
    ((kind, text),) = operator.messages
    assert kind == "ERROR" and text.startswith("'Grid': ") and "press Repair" in text
    assert bpy.context.window_manager.saddleback_needs_repair == "Grid"


def test_disabling_the_addon_stops_the_run(item):
    operator, context = pressed_tessellate(count=60, iterations=40)
    operator.invoke(context, None)
    task = operator._task
    jobs.stop_all()
    assert task.done and jobs.state.task is None
    assert not [thread for thread in threading.enumerate() if thread.name == "saddleback" and thread.is_alive()]
    operator.cancel(context)


def test_a_second_run_uses_what_a_stopped_one_finished():
    sphere()
    operator, context = pressed_tessellate(count=20, iterations=2)
    operator.invoke(context, None)
    operator._task.join()
    operator.modal(context, ESC)
    assert cache.shared.builds["graph"] == 1
    bpy.ops.saddleback.tessellate(count=20, iterations=2)
    assert cache.shared.builds == {"mesh": 1, "graph": 1, "cells": 1, "dual": 1, "anchors": 1}


ENTER = SimpleNamespace(type="RET", value="PRESS", ctrl=False, oskey=False)


def test_a_live_run_shows_moving_cells_and_escape_leaves_nothing(item):
    before = fingerprint()
    operator, context = pressed_live(count=60, iterations=5000, method="LLOYD", k=30)
    assert operator.invoke(context, None) == {"RUNNING_MODAL"}
    shown = wait_for_lines(operator, context)

    first = shown.ends
    deadline = time.monotonic() + 30
    while np.array_equal(shown.ends, first):
        assert time.monotonic() < deadline, "nothing moved"
        operator.modal(context, TIMER)
        time.sleep(0.005)
    assert abs(shown.ends[:, 2]).max() < 1e-6  # on the grid
    assert fingerprint() == before  # what is drawn is nothing in the file
    task = operator._task
    assert operator.modal(context, ESC) == {"CANCELLED"}
    task.join()
    assert operator.messages == [("INFO", "Stopped; nothing was changed")]
    assert not live_preview.shown and context.timers == 0
    assert fingerprint() == before


def test_enter_keeps_the_cells_as_they_are(item, monkeypatch):
    # However late ENTER comes on a busy machine: the run must not have ended by itself, as it does within a second.
    relax = sb.centroidal_voronoi
    monkeypatch.setattr(
        sb, "centroidal_voronoi", lambda *a, **k: relax(*a, **k | {"tolerance": 0.0, "least_move": 0.0})
    )
    operator, context = pressed_live(count=60, iterations=100000, method="LLOYD", k=30)
    operator.invoke(context, None)
    wait_for_lines(operator, context)
    assert operator.modal(context, ENTER) == {"RUNNING_MODAL"}
    assert run_to_end(operator, context) == {"FINISHED"}
    line = operator.messages[-1][1]  # quick fingers stop it before the first iteration
    assert "60 cells" in line and ("until it was stopped" in line or "stopped before the first iteration" in line)
    assert set(attribute(item, "saddleback_cell")) == set(range(60))
    assert not live_preview.shown


def test_cells_of_a_live_run_follow_the_brush_until_enter(item):
    """In a paint mode it goes on with whatever is painted, and clicks are the brush's."""
    group = item.vertex_groups.new(name="paint")
    group.add([0], 1.0, "REPLACE")
    bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
    settings = {"density_source": "VERTEX_GROUP", "density_name": "paint", "density_smaller_by": 4.0}
    operator, context = pressed_live(count=60, iterations=20, k=30, **settings)
    operator.invoke(context, None)
    shown = wait_for_lines(operator, context)

    def near(places):
        return np.linalg.norm(places[:, :2] - 0.8, axis=1) < 0.15

    def steps(until, seconds=60.0):
        deadline = time.monotonic() + seconds
        while not until():
            assert time.monotonic() < deadline and operator.modal(context, TIMER) == {"PASS_THROUGH"}
            time.sleep(0.01)

    steps(lambda: operator._density and not operator._task.progress._can_settle)  # even, and it waits
    before = int(near(shown.ends).sum())
    places = np.array([vertex.co for vertex in item.data.vertices])
    for _ in range(2):  # a dab, and another one that is the same
        group.add(np.flatnonzero(near(places)).tolist(), 1.0, "REPLACE")
        item.data.update_tag()
        bpy.context.view_layer.update()
    steps(lambda: near(shown.ends).sum() > 1.2 * before)
    steps(lambda: not operator._task.progress._can_settle)
    click = SimpleNamespace(type="LEFTMOUSE", value="PRESS", ctrl=False, oskey=False, mouse_x=0, mouse_y=0)
    assert operator.modal(context, click) == {"PASS_THROUGH"} and operator._task is not None
    assert "saddleback_cell" not in item.data.attributes
    operator.modal(context, ENTER)
    assert run_to_end(operator, context) == {"FINISHED"}
    cells = attribute(item, "saddleback_cell")
    assert set(cells) == set(range(60))
    assert len(set(cells[near(places)])) > 0.15 * 60  # 7 % of the area
    assert attribute(item, "saddleback_density")[near(places)].min() == attribute(item, "saddleback_density").max()
    assert not live_preview.shown and operator._note not in bpy.app.handlers.depsgraph_update_post


def test_escape_ends_a_live_run_that_waits_for_the_brush(item):
    item.vertex_groups.new(name="paint").add([0], 1.0, "REPLACE")
    bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
    before = fingerprint()
    operator, context = pressed_live(count=20, iterations=2, k=30, density_source="VERTEX_GROUP", density_name="paint",
                                     density_smaller_by=4.0)  # fmt: skip
    operator.invoke(context, None)
    wait_for_lines(operator, context)
    task = operator._task
    assert operator.modal(context, ESC) == {"CANCELLED"}
    task.join()
    assert fingerprint() == before and not live_preview.shown
    assert operator._note not in bpy.app.handlers.depsgraph_update_post


def test_a_live_run_that_ends_by_itself_is_the_script_s(item):
    operator, context = pressed_live(count=30, iterations=5, k=30)
    operator.invoke(context, None)
    assert run_to_end(operator, context) == {"FINISHED"}
    found = attribute(item, "saddleback_cell")
    cache.shared.clear()
    bpy.ops.saddleback.relax_live(count=30, iterations=5, k=30)
    np.testing.assert_array_equal(attribute(item, "saddleback_cell"), found)

# SPDX-License-Identifier: GPL-3.0-or-later
"""What follows an object stands while that is only painted, and follows again as soon as it may move."""

import bpy
import numpy as np
import pytest
from scenes import paint, positions, sphere, steps

from saddleback_blender import compat
from saddleback_blender.bridge.outputs.out_collection import find_output
from saddleback_blender.follow_nodes import HOST
from saddleback_blender.nodes import FOLLOW, modifier_of
from saddleback_blender.ops import live


@pytest.fixture(autouse=True)
def window(monkeypatch, little_rest):
    """As where somebody looks."""
    monkeypatch.setattr(live, "HAS_WINDOW", True)


@pytest.fixture
def painted(item):
    """A ball whose cells a brush has changed once."""
    paint(item)
    steps()
    return item


def edges_of(item):
    return find_output(item, "edges")


def host_of(output):
    return compat.modifier_input(modifier_of(output, FOLLOW), HOST)


def evaluated_positions(output):
    """(V, 3) of what is drawn."""
    shown = output.evaluated_get(bpy.context.evaluated_depsgraph_get())
    try:
        return positions(shown.to_mesh()).astype(np.float64)
    finally:
        shown.to_mesh_clear()


def changed_by(act):
    """Names of what Blender evaluates anew, with its geometry."""
    names = []

    def note(_scene, depsgraph):
        names.extend(update.id.name for update in depsgraph.updates if update.is_updated_geometry)

    bpy.context.view_layer.update()
    bpy.app.handlers.depsgraph_update_post.append(note)
    try:
        act()
        bpy.context.view_layer.update()
    finally:
        bpy.app.handlers.depsgraph_update_post.remove(note)
    return names


def move(item, by=0.5):
    """Moves all vertices, as a script does, which a second update shows."""
    compat.write_positions(item.data, positions(item.data) + np.float32([0, 0, by]))
    item.data.update()
    bpy.context.view_layer.update()
    bpy.context.view_layer.update()


def test_a_dab_evaluates_the_painted_mesh_and_nothing_that_was_made_of_it(painted):
    changed = changed_by(lambda: paint(painted, (0.0, 1.0, 0.0)))
    assert painted.name in changed and edges_of(painted).name not in changed


def test_what_stands_is_where_it_would_be(painted):
    edges = edges_of(painted)
    stood = evaluated_positions(edges)
    live.follow()
    bpy.context.view_layer.update()
    assert host_of(edges) == painted
    assert np.abs(evaluated_positions(edges) - stood).max() < 1e-5


def test_what_stands_follows_again_when_vertices_move(painted):
    edges = edges_of(painted)
    before = evaluated_positions(edges)
    move(painted)
    assert np.abs(evaluated_positions(edges) - before - [0, 0, 0.5]).max() < 1e-4


@pytest.mark.parametrize("way", ["EDIT", "SCULPT", "modifier", "shape key"])
def test_what_stands_follows_again_where_the_surface_may_move(painted, way):
    if way == "modifier":
        painted.modifiers.new("", "CAST")
    elif way == "shape key":
        painted.shape_key_add(name="Basis")
    else:
        bpy.context.view_layer.objects.active = painted
        bpy.ops.object.mode_set(mode=way)
    painted.update_tag()
    bpy.context.view_layer.update()
    assert host_of(edges_of(painted)) == painted


def test_what_stands_follows_scripts_that_move_vertices_from_frame_to_frame(painted):
    edges, before, rest = edges_of(painted), evaluated_positions(edges_of(painted)), positions(painted.data)

    def lift(scene, _depsgraph):
        compat.write_positions(painted.data, rest + np.float32([0, 0, 0.1 * scene.frame_current]))
        painted.data.update()

    bpy.app.handlers.frame_change_pre.append(lift)
    try:
        for frame in (2, 3):  # a frame later at first
            bpy.context.scene.frame_set(frame)
        assert np.abs(evaluated_positions(edges) - before - [0, 0, 0.3]).max() < 1e-4
    finally:
        bpy.app.handlers.frame_change_pre.remove(lift)


def test_a_file_that_is_saved_follows_without_the_addon(painted, tmp_path):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"), copy=True)
    with bpy.data.libraries.load(str(tmp_path / "a.blend")) as (_, wanted):
        wanted.objects = [edges_of(painted).name]
    (loaded,) = wanted.objects
    assert host_of(loaded).name.startswith("Sphere") and "saddleback_stands" not in loaded
    steps()
    assert host_of(edges_of(painted)) is None  # here it stands again


def test_a_duplicate_s_outputs_follow_the_duplicate(painted):
    bpy.ops.object.select_all(action="DESELECT")
    for each in (painted, edges_of(painted)):
        each.select_set(True)
    bpy.ops.object.duplicate()
    twin = next(each for each in bpy.context.selected_objects if each.parent is None)
    edges = next(each for each in bpy.context.selected_objects if each.parent is not None)
    steps()
    before, own = evaluated_positions(edges), evaluated_positions(edges_of(painted))
    move(twin)
    assert np.abs(evaluated_positions(edges) - before - [0, 0, 0.5]).max() < 1e-4
    assert np.array_equal(evaluated_positions(edges_of(painted)), own)


@pytest.mark.parametrize("end", ["off", "freeze", "disable"])
def test_all_follows_where_auto_update_ends(painted, end):
    edges = edges_of(painted)
    assert host_of(edges) is None
    if end == "off":
        painted.saddleback.layers[0].auto_update = False
        steps()
    elif end == "freeze":
        bpy.ops.saddleback.layer_freeze()
    else:
        bpy.ops.preferences.addon_disable(module="saddleback_blender")
        bpy.ops.preferences.addon_enable(module="saddleback_blender")
    assert host_of(edges) == painted


def test_one_object_s_run_lets_no_other_follow_again(painted):
    other = sphere(subdivisions=3)
    bpy.ops.saddleback.tessellate(count=20)
    other.saddleback.layers[0].auto_update = True
    other.update_tag()
    steps()
    other.saddleback.tessellate.count = 25
    other.update_tag()
    steps()
    assert host_of(edges_of(other)) is None and host_of(edges_of(painted)) is None


def test_what_was_made_for_other_places_does_not_stand(painted):
    live.live.forget()
    move(painted)
    edges = edges_of(painted)
    live.mark(bpy.context.scene, bpy.context.evaluated_depsgraph_get())
    live.accept()
    steps()
    assert host_of(edges) == painted


def test_a_run_begins_before_the_window_is_drawn(painted):
    paint(painted, (0.0, 1.0, 0.0))
    bpy.context.view_layer.update()
    assert live.live.operator is not None
    steps()

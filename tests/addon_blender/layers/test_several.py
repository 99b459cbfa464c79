# SPDX-License-Identifier: GPL-3.0-or-later
"""All selected objects in one go."""

import bpy
import pytest
from scenes import add_object, fingerprint, sphere
from test_modal import press, run_to_end

from saddleback_blender import jobs
from saddleback_blender.bridge.outputs.out_collection import outputs_of
from saddleback_blender.core.settings import TessellateSettings
from saddleback_blender.ops.tessellate import SADDLEBACK_OT_tessellate

QUICK = {"iterations": 2, "k": 30}


def balls(count=3):
    """Some balls, all selected, the last one active."""
    items = []
    for number in range(count):
        items.append(sphere(f"Ball {number}", 2 + number % 2))
        items[-1].location.x = 3 * number
    for item in items:
        item.select_set(True)
    bpy.context.view_layer.update()
    return items


def test_all_selected_objects_get_what_the_active_one_does():
    items = balls()
    items[0].saddleback.tessellate.count = 5  # of its own, which is not what is asked for
    bpy.context.scene.cursor.location = (1, 2, 3)
    bpy.ops.saddleback.tessellate(count=20, all_selected=True, **QUICK)
    for item in items:
        (edges,) = outputs_of(item)
        assert edges.parent == item and item.saddleback.tessellate.count == 20
        assert item.saddleback.tessellate.told.startswith(f"'{item.name}': 20 cells")
    assert bpy.context.view_layer.objects.active == items[-1]
    bpy.ops.saddleback.tessellate(all_selected=True)  # outputs are not among them
    assert len(bpy.data.objects) == 6


def test_an_object_is_not_taken_for_a_selected_one_of_another_file_with_its_name(tmp_path, capfd):
    balls(1)
    path = str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    (own,) = balls(1)
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.objects = ["Ball 0"]
    bpy.context.scene.collection.objects.link(wanted.objects[0])
    other = sphere("Other")
    own.select_set(False)
    wanted.objects[0].select_set(True)
    assert bpy.ops.saddleback.tessellate(count=20, all_selected=True, **QUICK) == {"FINISHED"}
    assert outputs_of(other) and not outputs_of(own)
    assert "'Ball 0' is linked from" in capfd.readouterr().out


def test_only_the_active_object_gets_it_without_being_asked():
    items = balls()
    bpy.ops.saddleback.tessellate(count=20, **QUICK)
    assert [len(outputs_of(item)) for item in items] == [0, 0, 1]


def test_what_one_of_them_refuses_is_told_and_the_others_are_done():
    items = balls()
    fan = add_object("Fan", [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)], [(0, 1, 2), (0, 1, 3), (0, 1, 4)])
    bpy.context.view_layer.objects.active = items[0]
    assert bpy.ops.saddleback.tessellate(count=20, all_selected=True, **QUICK) == {"FINISHED"}
    assert all(outputs_of(item) for item in items) and not outputs_of(fan)
    bpy.context.view_layer.objects.active = fan
    before = fingerprint()
    with pytest.raises(RuntimeError, match="'Fan'"):
        bpy.ops.saddleback.tessellate(count=20, all_selected=True, **QUICK)
    assert fingerprint() == before


def test_the_panel_runs_one_after_another_and_esc_keeps_what_was_done():
    items = balls()
    operator, context = press(SADDLEBACK_OT_tessellate, TessellateSettings(), count=20, all_selected=True, **QUICK)
    assert operator.invoke(context, None) == {"RUNNING_MODAL"}
    assert run_to_end(operator, context) == {"FINISHED"}
    assert [len(outputs_of(item)) for item in items] == [1, 1, 1] and jobs.state.task is None

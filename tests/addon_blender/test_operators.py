# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators as a script uses them: values, one step of undo, settings kept, outputs replaced and cleared."""

import bpy
import numpy as np
import pytest
from scenes import add_object, attribute, grid, grid_arrays, select, sphere

from saddleback_blender import jobs
from saddleback_blender.bridge.outputs.out_collection import find_output
from saddleback_blender.core import cache

QUICK = {"count": 12, "iterations": 3, "k": 20}


def cells(item, name="saddleback_cell"):
    return attribute(item, name)


def test_distance_from_a_selected_vertex_is_geodesic():
    item = grid(n=20)
    select(item, [0])
    assert bpy.ops.saddleback.distance() == {"FINISHED"}
    values = attribute(item, "saddleback_distance")
    expected = np.array([np.hypot(*vertex.co[:2]) for vertex in item.data.vertices])
    assert values[0] == 0
    np.testing.assert_allclose(values, expected, rtol=0.02)


def test_distance_is_measured_in_the_world():
    item = grid(n=10)
    item.scale = (4, 1, 1)
    bpy.context.view_layer.update()
    select(item, [0])
    bpy.ops.saddleback.distance()
    assert attribute(item, "saddleback_distance")[10] == pytest.approx(4.0, rel=1e-5)  # the corner along x


def test_distance_from_a_vertex_group_and_a_limit():
    item = grid(n=10)
    group = item.vertex_groups.new(name="Source")
    group.add([0], 1.0, "REPLACE")
    group.add([120], 0.25, "REPLACE")  # too little to count
    bpy.ops.saddleback.distance(sources="VERTEX_GROUP", sources_group="Source", limit=0.5)
    values = attribute(item, "saddleback_distance")
    reached = np.isfinite(values)
    assert values[0] == 0 and reached[5] and not reached[10] and not reached[120]
    assert values[reached].max() <= 0.5


def test_distance_from_empties_of_a_collection_and_of_the_object():
    item = grid(n=10)
    empties = bpy.data.collections.new("Places")
    bpy.context.scene.collection.children.link(empties)
    first, second = bpy.data.objects.new("First", None), bpy.data.objects.new("Second", None)
    first.location, second.location = (0, 0, 0.3), (1, 1, -0.2)
    empties.objects.link(first)
    bpy.context.scene.collection.objects.link(second)
    second.parent = item
    bpy.context.view_layer.update()
    bpy.ops.saddleback.distance(sources="EMPTIES", sources_collection="Places")
    assert attribute(item, "saddleback_distance")[0] == pytest.approx(0, abs=1e-6)
    bpy.ops.saddleback.distance(sources="EMPTIES", sources_collection="")
    values = attribute(item, "saddleback_distance")
    assert values[120] == pytest.approx(0, abs=1e-6) and values[0] > 1.3


def test_tessellate_gives_every_vertex_one_of_the_cells():
    item = sphere()
    assert bpy.ops.saddleback.tessellate(**QUICK) == {"FINISHED"}
    found = cells(item)
    np.testing.assert_array_equal(np.unique(found), np.arange(12))
    distances = attribute(item, "saddleback_distance")
    assert np.isfinite(distances).all() and (distances >= 0).all()
    assert "saddleback_density" not in item.data.attributes


def test_more_cells_than_vertices():
    item = add_object("Tile", *grid_arrays(1))
    assert bpy.ops.saddleback.tessellate(count=5, iterations=5) == {"FINISHED"}
    cells = attribute(item, "saddleback_cell")
    assert len(cells) == 4 and len(np.unique(cells)) == 4
    assert ((cells >= 0) & (cells < 5)).all()


def test_a_script_gets_the_same_cells_twice_and_others_from_another_seed():
    item = sphere()
    bpy.ops.saddleback.tessellate(**QUICK)
    first = cells(item)
    cache.shared.clear()
    bpy.ops.saddleback.tessellate(**QUICK)
    np.testing.assert_array_equal(cells(item), first)
    bpy.ops.saddleback.tessellate(**QUICK, seed=7)
    assert (cells(item) != first).any()


def test_selected_vertices_are_the_sites_and_stay():
    item = grid(n=10)
    select(item, [0, 10, 60, 110, 120])
    bpy.ops.saddleback.tessellate(sites_source="SELECTED", iterations=5)
    np.testing.assert_array_equal(cells(item)[[0, 10, 60, 110, 120]], np.arange(5))
    np.testing.assert_array_equal(attribute(item, "saddleback_distance")[[0, 10, 60, 110, 120]], 0)


def test_selected_sites_may_be_relaxed():
    item = grid(n=10)
    select(item, [0, 1, 2, 3])
    bpy.ops.saddleback.tessellate(sites_source="SELECTED", iterations=10, relax_sites=True)
    counts = np.bincount(cells(item))
    assert len(counts) == 4 and counts.min() > 10  # crowded in a corner before


def test_vertices_of_another_object_are_sites():
    item = grid(n=10)
    add_object("Dots", [(0.1, 0.1, 0.4), (0.9, 0.9, -0.4)], [], active=False)
    bpy.ops.saddleback.tessellate(sites_source="OBJECT", sites_object="Dots")
    found = cells(item)
    assert set(found) == {0, 1} and found[0] == 0 and found[120] == 1
    assert item.saddleback.tessellate.sites_object == bpy.data.objects["Dots"]


def test_density_is_written_and_draws_cells():
    item = grid(n=30)
    group = item.vertex_groups.new(name="Paint")
    for vertex in item.data.vertices:
        group.add([vertex.index], 0.1 + 0.9 * vertex.co.x, "REPLACE")
    bpy.ops.saddleback.tessellate(count=60, iterations=20, density_source="VERTEX_GROUP", density_name="Paint")
    density = attribute(item, "saddleback_density")
    x = np.array([vertex.co.x for vertex in item.data.vertices])
    np.testing.assert_allclose(density, 0.1 + 0.9 * x, atol=1e-6)
    found = cells(item)
    left, right = len(np.unique(found[x < 0.4])), len(np.unique(found[x > 0.6]))
    assert right > 1.5 * left


def test_loose_vertices_belong_to_no_cell():
    vertices, faces = grid_arrays(8)
    item = add_object("Loose", np.concatenate([[[5, 5, 5]], vertices]), faces + 1)
    bpy.ops.saddleback.tessellate(**QUICK)
    assert cells(item)[0] == -1 and np.isinf(attribute(item, "saddleback_distance")[0])
    assert (cells(item)[1:] >= 0).all()


def test_settings_come_from_the_object_and_are_kept_on_it():
    item = sphere()
    item.saddleback.tessellate.count = 9
    item.saddleback.tessellate.k = 15
    bpy.ops.saddleback.tessellate(iterations=2)
    assert cells(item).max() == 8
    kept = item.saddleback.tessellate
    assert (kept.count, kept.k, kept.iterations) == (9, 15, 2)
    bpy.ops.saddleback.tessellate()  # not the defaults, nor the last call's values, but the object's
    assert cells(item).max() == 8 and kept.iterations == 2
    other = grid("Other", n=15)
    bpy.ops.saddleback.tessellate(iterations=1)
    assert other.saddleback.tessellate.count == 200


def test_settings_survive_saving_and_recompute_the_same(tmp_path):
    item = sphere()
    add_object("Dots", [(1, 0, 0), (-1, 0, 0)], [], active=False)
    bpy.ops.saddleback.tessellate(**QUICK, seed=3, cell_attribute="my_cell")
    item.saddleback.tessellate.sites_object = bpy.data.objects["Dots"]
    first = cells(item, "my_cell")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "kept.blend"))
    cache.shared.clear()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "kept.blend"))
    item = bpy.data.objects["Sphere"]
    assert item.saddleback.tessellate.sites_object == bpy.data.objects["Dots"]
    np.testing.assert_array_equal(cells(item, "my_cell"), first)
    item.data.attributes.remove(item.data.attributes["my_cell"])
    bpy.ops.saddleback.tessellate()
    np.testing.assert_array_equal(cells(item, "my_cell"), first)


def test_undo_and_redo_are_one_step():
    sphere()
    bpy.ops.ed.undo_push(message="start")
    bpy.ops.saddleback.tessellate("EXEC_DEFAULT", True, **QUICK)
    first = cells(bpy.data.objects["Sphere"])
    bpy.ops.ed.undo()
    item = bpy.data.objects["Sphere"]
    assert "saddleback_cell" not in item.data.attributes and item.saddleback.tessellate.count == 200
    assert len(bpy.data.objects) == 1
    bpy.ops.ed.redo()
    np.testing.assert_array_equal(cells(bpy.data.objects["Sphere"]), first)


def test_modifiers_make_a_new_object_with_the_result():
    item = grid(n=6)
    item.modifiers.new("Subdivision", "SUBSURF").levels = 1
    before = len(bpy.data.objects)
    bpy.ops.saddleback.tessellate(**QUICK, use_modifiers=True, make_edges=False)
    made = [other for other in bpy.data.objects if other != item]
    assert len(made) == before and "saddleback_cell" not in item.data.attributes
    found = cells(made[0])
    assert len(found) == 13 * 13 and set(found) == set(range(12))
    np.testing.assert_allclose(made[0].matrix_world, item.matrix_world)
    bpy.ops.saddleback.tessellate(**QUICK, use_modifiers=True, make_edges=False)
    assert len(bpy.data.objects) == before + 1  # replaced, not piled up


def test_modifiers_that_keep_the_vertices_write_to_the_mesh_itself():
    item = grid(n=20)
    item.modifiers.new("Cast", "CAST").factor = 0.5
    bpy.ops.saddleback.tessellate(**QUICK, use_modifiers=True, make_edges=False)
    assert len(bpy.data.objects) == 1 and len(np.unique(cells(item))) > 6


def test_clear_removes_what_was_made_and_nothing_else():
    item = sphere()
    other = sphere("Other")
    bpy.context.view_layer.objects.active = item
    item.data.attributes.new("mine", "FLOAT", "POINT")
    objects, attributes = set(bpy.data.objects.keys()), set(item.data.attributes.keys())
    bpy.ops.saddleback.tessellate(**QUICK, make_cells=True, make_centers=True)
    select(item, [0])
    bpy.ops.saddleback.distance(distance_attribute="saddleback_far")
    assert set(bpy.data.objects.keys()) > objects
    assert bpy.ops.saddleback.clear() == {"FINISHED"}
    assert set(bpy.data.objects.keys()) == objects and set(item.data.attributes.keys()) == attributes
    assert other.name in bpy.data.objects
    assert bpy.ops.saddleback.clear() == {"CANCELLED"}  # nothing left


def test_outputs_are_replaced_and_follow_the_switches():
    sphere()
    bpy.ops.saddleback.tessellate(**QUICK, make_centers=True)
    names = set(bpy.data.objects.keys())
    assert len(names) == 3
    bpy.ops.saddleback.tessellate(**QUICK, seed=1, make_centers=True)
    assert set(bpy.data.objects.keys()) == names
    bpy.ops.saddleback.tessellate(**QUICK, make_edges=False, make_centers=False)
    assert set(bpy.data.objects.keys()) == {"Sphere"}


def test_a_shared_mesh_is_told_and_done():
    item = sphere()
    twin = bpy.data.objects.new("Twin", item.data)
    bpy.context.scene.collection.objects.link(twin)
    assert bpy.ops.saddleback.tessellate(**QUICK) == {"FINISHED"}
    np.testing.assert_array_equal(cells(twin), cells(item))


@pytest.mark.parametrize("mode", ["SCULPT", "WEIGHT_PAINT", "VERTEX_PAINT"])
def test_painting_modes_need_not_be_left(mode):
    item = sphere()
    bpy.ops.object.mode_set(mode=mode)
    assert bpy.ops.saddleback.tessellate(**QUICK) == {"FINISHED"}
    assert item.mode == mode
    bpy.ops.object.mode_set(mode="OBJECT")
    assert set(cells(item)) == set(range(12))


def built():
    """What was computed, but for where outputs stand: that is asked for each of them."""
    return {kind: count for kind, count in cache.shared.builds.items() if kind != "anchors"}


def test_only_what_changed_is_computed():
    sphere()
    assert cache.shared.builds == {}
    bpy.ops.saddleback.tessellate(**QUICK)
    assert built() == {"mesh": 1, "graph": 1, "cells": 1, "dual": 1}
    bpy.ops.saddleback.tessellate(**QUICK, edge_radius=0.1)
    assert cache.shared.builds["anchors"] == 1
    bpy.ops.saddleback.tessellate(**QUICK, edge_radius=0.1, make_centers=True)  # outputs only
    assert built() == {"mesh": 1, "graph": 1, "cells": 1, "dual": 1}
    bpy.ops.saddleback.tessellate(**QUICK, make_cells=True)
    bpy.ops.saddleback.tessellate(**QUICK, make_cells=True, gap=0.01)
    for thickness in (0.1, 0.2):
        bpy.ops.saddleback.tessellate(**QUICK, make_cells=True, gap=0.01, inset=0.01, thickness=thickness)
    pieces = {"split": 1, "cell pieces": 3, "cell mesh": 4}
    assert built() == {"mesh": 1, "graph": 1, "cells": 1, "dual": 1, **pieces}
    bpy.ops.saddleback.tessellate(**{**QUICK, "count": 20}, make_cells=False)
    assert built() == {"mesh": 1, "graph": 1, "cells": 2, "dual": 2, **pieces}
    bpy.ops.saddleback.tessellate(**{**QUICK, "k": 25})
    assert built() == {"mesh": 1, "graph": 2, "cells": 3, "dual": 3, **pieces}
    select(bpy.context.active_object, [0])
    bpy.ops.saddleback.distance(k=25)
    assert built()["graph"] == 2 and built()["mesh"] == 1
    bpy.context.active_object.scale = (1, 1, 2)
    bpy.context.view_layer.update()
    bpy.ops.saddleback.tessellate(**QUICK)
    assert built()["mesh"] == 2 and built()["graph"] == 3


def test_adjusting_the_last_operation_keeps_the_graph():
    sphere()
    bpy.ops.ed.undo_push(message="start")
    bpy.ops.saddleback.tessellate("EXEC_DEFAULT", True, **QUICK)
    bpy.ops.ed.undo()
    bpy.ops.saddleback.tessellate("EXEC_DEFAULT", True, **{**QUICK, "count": 15})
    assert cells(bpy.data.objects["Sphere"]).max() == 14
    assert cache.shared.builds["graph"] == 1


def test_the_panel_state_stores_nothing_in_the_file():
    manager = bpy.context.window_manager
    assert not manager.saddleback_running and manager.saddleback_fraction == 0 and manager.saddleback_text == ""
    jobs.state.needs_repair = "Sphere"
    assert manager.saddleback_needs_repair == "Sphere"
    assert not [key for key in list(manager.keys()) if key.startswith("saddleback")]


def test_distance_to_the_edge_and_local_uv_are_written_where_wanted():
    item = sphere()
    bpy.ops.saddleback.tessellate(**QUICK)
    assert "saddleback_edge_distance" not in item.data.attributes
    bpy.ops.saddleback.tessellate(**QUICK, write_edge_distance=True, make_cells=True, local_uv=True)
    to_edge, to_site = attribute(item, "saddleback_edge_distance"), attribute(item, "saddleback_distance")
    assert to_edge.min() >= 0 and to_edge.max() > 0.2
    near, far = to_site < 0.2, to_edge < 0.05
    assert to_edge[near].mean() > 2 * to_edge[~near].mean() and to_site[far].mean() > to_site[~far].mean()
    mesh = next(child for child in item.children if child["saddleback_role"] == "cells").data
    places = np.empty(2 * len(mesh.loops), np.float32)
    mesh.uv_layers["saddleback_local"].data.foreach_get("uv", places)
    away = np.linalg.norm(places.reshape(-1, 2) - 0.5, axis=1)
    assert away.max() == pytest.approx(0.5, abs=1e-5) and away.min() < 0.1
    with pytest.raises(RuntimeError, match="two attributes are to be called 'saddleback_cell'"):
        bpy.ops.saddleback.tessellate(**QUICK, write_edge_distance=True, edge_distance_attribute="saddleback_cell")


def test_cells_are_tessellated_again():
    """An output's own attribute of the default name was another kind that refused the run: cells of cells."""
    source = sphere()
    bpy.ops.saddleback.tessellate(count=20, make_cells=True)
    cells = find_output(source, "cells")
    bpy.context.view_layer.objects.active = cells
    source.select_set(False)
    cells.select_set(True)
    assert bpy.ops.saddleback.tessellate(count=60, make_cells=True) == {"FINISHED"}
    assert len(np.unique(attribute(cells, "saddleback_cell"))) == 60
    assert find_output(cells, "cells") is not None

# SPDX-License-Identifier: GPL-3.0-or-later
"""Outputs are replaced and never piled up, belong to their source, keep what the artist did, and go away whole."""

import bpy
import numpy as np
import pytest
from mathutils import Matrix
from output_scenes import in_world, read_attribute, result_of, sphere_source, world_positions
from scenes import add_object, fingerprint

from saddleback_blender import nodes
from saddleback_blender.bridge.outputs.out_attributes import write_vertex_attributes
from saddleback_blender.bridge.outputs.out_cells import write_cells
from saddleback_blender.bridge.outputs.out_centers import write_centers
from saddleback_blender.bridge.outputs.out_collection import clear_outputs, find_output, outputs_of, remove_output
from saddleback_blender.bridge.outputs.out_edges import write_edges
from saddleback_blender.core.settings import TessellateSettings

SETTINGS = TessellateSettings(instance_object="Seed", gap=0.02)
BLOCKS = ("objects", "meshes", "curves", "collections", "node_groups", "materials")


def seed_object():
    if "Seed" not in bpy.data.objects:
        add_object("Seed", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], active=False)


def write_all(source, count=25, settings=SETTINGS):
    seed_object()
    bpy.context.view_layer.update()
    result = result_of(source, count)
    write_vertex_attributes(source, {"saddleback_cell": result.vertex_cell})
    made = [
        write_edges(bpy.context, source, result, settings),
        write_cells(bpy.context, source, result, settings),
        write_centers(bpy.context, source, result, settings),
    ]
    bpy.context.view_layer.update()
    return made


def counts():
    return {kind: len(getattr(bpy.data, kind)) for kind in BLOCKS}


def duplicate(item):
    copy = item.copy()
    copy.data = item.data.copy()
    item.users_collection[0].objects.link(copy)
    bpy.context.view_layer.update()
    return copy


def test_a_second_run_replaces_and_piles_nothing_up():
    source = sphere_source()
    first = [item.name for item in write_all(source)]
    before = counts()
    second = write_all(source, count=12)
    assert [item.name for item in second] == first == ["Ball Edges", "Ball Cells", "Ball Centers"]
    assert counts() == before
    assert len(find_output(source, "centers").data.vertices) == 12
    assert sorted(mesh.name for mesh in bpy.data.meshes) == ["Ball", *sorted(first), "Seed"]


def test_outputs_go_into_one_collection_beside_the_source():
    scene = bpy.context.scene.collection
    home = bpy.data.collections.new("Home")
    scene.children.link(home)
    source = sphere_source()
    scene.objects.unlink(source)
    home.objects.link(source)
    made = write_all(source)
    assert [child.name for child in home.children] == ["Saddleback"]
    assert set(home.children[0].objects) == set(made)
    other = sphere_source("Other")
    scene.objects.unlink(other)
    home.objects.link(other)
    write_all(other)
    assert len(home.children) == 1 and len(home.children[0].objects) == 6


def test_a_collection_of_that_name_made_by_the_artist_is_not_touched():
    theirs = bpy.data.collections.new("Saddleback")
    bpy.context.scene.collection.children.link(theirs)
    source = sphere_source()
    write_all(source)
    assert len(theirs.objects) == 0
    clear_outputs(bpy.context, source)
    assert [collection.name for collection in bpy.data.collections] == ["Saddleback"]


def test_two_sources_do_not_fight():
    one, two = sphere_source("One"), sphere_source("Two")
    first, second = write_all(one), write_all(two)
    assert not set(first) & set(second)
    write_all(one, count=8)
    assert [len(find_output(s, "centers").data.vertices) for s in (one, two)] == [8, 25]
    clear_outputs(bpy.context, one)
    assert set(outputs_of(two)) == set(second)


def test_a_duplicate_of_a_source_gets_outputs_of_its_own():
    source = sphere_source()
    made = write_all(source)
    copy = duplicate(source)
    assert outputs_of(copy) == []
    others = write_all(copy, count=9)
    assert not set(made) & set(others)
    assert set(write_all(source)) == set(made)
    assert set(write_all(copy)) == set(others)
    clear_outputs(bpy.context, copy)
    assert set(outputs_of(source)) == set(made)


def test_clearing_a_fresh_duplicate_leaves_the_outputs_of_the_original():
    source = sphere_source()
    made = write_all(source)
    copy = duplicate(source)
    assert clear_outputs(bpy.context, copy) == 1  # the attribute that came along with the mesh
    assert set(outputs_of(source)) == set(made)
    assert "saddleback_cell" in source.data.attributes


def test_a_duplicate_of_an_output_belongs_to_the_artist():
    source = sphere_source()
    made = write_all(source)
    kept = duplicate(made[1])
    polygons = len(kept.data.polygons)
    assert set(write_all(source, count=7)) == set(made)
    assert len(kept.data.polygons) == polygons
    clear_outputs(bpy.context, source)
    assert kept.name in bpy.data.objects and len(kept.data.polygons) == polygons


def test_a_duplicate_of_an_output_stays_the_artist_s_when_the_original_is_deleted():
    """It was taken for the output: runs changed it, and Clear took it away."""
    source = sphere_source()
    made = write_all(source)
    kept = duplicate(made[1])
    name, polygons = kept.name, len(kept.data.polygons)
    bpy.data.objects.remove(made[1])
    assert find_output(source, "cells") is None
    assert write_all(source, count=7)[1].name == "Ball Cells" and len(kept.data.polygons) == polygons
    clear_outputs(bpy.context, source)
    assert bpy.data.objects[name] == kept and len(kept.data.polygons) == polygons


def test_an_output_with_a_number_is_none_s_duplicate_where_its_name_is_taken():
    """As where an object and what was made of it are appended to a file that has such a name."""
    source = sphere_source()
    made = write_all(source)
    made[1].name = "Ball Cells.001"
    add_object("Ball Cells", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], active=False)
    assert write_all(source, count=7)[1] == made[1]


def test_renaming_everything_and_reopening_changes_nothing(tmp_path):
    source = sphere_source()
    for item in write_all(source):
        item.name = f"My {item['saddleback_role']}"
    source.name = "My Ball"
    bpy.data.collections["Saddleback"].name = "My Outputs"
    names = sorted(item.name for item in bpy.data.objects)
    path = str(tmp_path / "kept.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    before = counts()
    source = bpy.data.objects["My Ball"]
    assert {item.name for item in outputs_of(source)} == {"My edges", "My cells", "My centers"}
    write_all(source, count=11)
    assert sorted(item.name for item in bpy.data.objects) == names
    assert counts() == before
    assert clear_outputs(bpy.context, source) == 4
    assert sorted(item.name for item in bpy.data.objects) == ["My Ball", "Seed"]


def test_what_the_artist_added_survives_a_run():
    source = sphere_source()
    edges, cells, centers = write_all(source)
    gold = bpy.data.materials.new("Gold")
    cells.data.materials[0] = gold
    cells.data.materials.append(bpy.data.materials.new("Second"))
    cells.modifiers.new("Bevel", "BEVEL").width = 0.125
    cells["price"] = 12
    cells.hide_render = True
    edges.modifiers.new("Smooth", "SMOOTH")
    shelf = bpy.data.collections.new("Shelf")
    bpy.context.scene.collection.children.link(shelf)
    shelf.objects.link(centers)
    bpy.data.collections["Saddleback"].objects.unlink(centers)
    write_all(source, count=9)
    assert [material.name for material in cells.data.materials] == ["Gold", "Second"]
    assert cells.modifiers["Bevel"].width == 0.125
    assert cells["price"] == 12 and cells.hide_render
    assert [modifier.name for modifier in edges.modifiers] == ["Saddleback Tubes", "Smooth"]
    assert list(shelf.objects) == [centers] and centers.users_collection == (shelf,)


def test_an_output_follows_its_source_and_keeps_the_artists_move():
    source = sphere_source()
    _, cells, _ = write_all(source)
    assert cells.parent == source
    source.location.x = 5.0
    bpy.context.view_layer.update()
    assert world_positions(cells)[:, 0].min() > 3.9
    cells.matrix_world = Matrix.Translation((0, 0, 3)) @ cells.matrix_world
    bpy.context.view_layer.update()
    write_all(source)
    places = world_positions(cells)
    assert 0.5 * (places.min(axis=0) + places.max(axis=0)) == pytest.approx([5.0, 0.0, 3.0], abs=0.05)
    write_all(source)
    places = world_positions(cells)
    assert 0.5 * (places.min(axis=0) + places.max(axis=0)) == pytest.approx([5.0, 0.0, 3.0], abs=0.05)


def test_runs_after_moves_and_scales_of_the_source_fit_exactly():
    source = sphere_source()
    for place in (Matrix.Translation((1, 2, 3)), Matrix.Diagonal((3, 1, 0.5, 1)), Matrix.Rotation(1.0, 4, (1, 1, 0))):
        source.matrix_world = place @ source.matrix_world
        bpy.context.view_layer.update()
        _, _, centers = write_all(source)
        wanted = in_world(source, result_of(source).sites_position)
        np.testing.assert_allclose(world_positions(centers), wanted, atol=2e-5)
        assert centers.matrix_world.to_scale()[:] == pytest.approx((1, 1, 1), abs=1e-5)


def test_deleting_the_source_leaves_the_outputs_where_they_are():
    source = sphere_source(place=Matrix.Translation((4, 0, 0)))
    _, cells, _ = write_all(source)
    before = world_positions(cells)
    bpy.data.objects.remove(source)
    bpy.context.view_layer.update()
    np.testing.assert_allclose(world_positions(cells), before, atol=1e-5)


def test_a_change_of_kind_makes_another_object_in_the_place_of_the_first():
    source = sphere_source()
    write_all(source)
    curve = write_edges(bpy.context, source, result_of(source), TessellateSettings(edge_kind="CURVE"))
    assert curve.type == "CURVE" and curve.name == "Ball Edges"
    assert len(outputs_of(source)) == 3
    assert not any(group.get(nodes.MARK) == nodes.TUBES for group in bpy.data.node_groups)
    mesh = write_edges(bpy.context, source, result_of(source), TessellateSettings())
    assert mesh.type == "MESH" and len(bpy.data.curves) == 0


def test_clear_leaves_the_file_as_it_was_before_the_run():
    source = sphere_source()
    seed_object()
    source.data.attributes.new("theirs", "FLOAT", "POINT")
    source["note"] = 1
    bpy.data.collections.new("Empty One")
    bpy.context.view_layer.update()
    fingerprint()  # reading the settings of an object for the first time makes Blender store them
    before = fingerprint()
    write_all(source)
    write_edges(bpy.context, source, result_of(source), TessellateSettings(edge_kind="CURVE"))
    assert fingerprint() != before
    assert clear_outputs(bpy.context, source) == 4
    assert fingerprint() == before
    assert clear_outputs(bpy.context, source) == 0


def test_clear_leaves_what_the_artist_put_into_our_collection_and_took_from_us():
    source = sphere_source()
    edges, cells, _ = write_all(source)
    bpy.data.collections["Saddleback"].objects.link(bpy.data.objects["Seed"])
    borrowed = bpy.data.objects.new("Borrowed", cells.data)
    bpy.context.scene.collection.objects.link(borrowed)
    bpy.data.objects["Seed"].data.materials.append(edges.data.materials[0])
    clear_outputs(bpy.context, source)
    assert bpy.data.collections["Saddleback"].objects.keys() == ["Seed"]
    assert len(borrowed.data.polygons) > 0
    assert bpy.data.objects["Seed"].data.materials[0].name == "Saddleback Edges"


def test_one_output_can_be_taken_away_alone():
    source = sphere_source()
    write_all(source)
    assert remove_output(source, "cells")
    assert not remove_output(source, "cells")
    assert sorted(item["saddleback_role"] for item in outputs_of(source)) == ["centers", "edges"]


def test_an_output_that_the_artist_deleted_is_made_again():
    source = sphere_source()
    _, cells, _ = write_all(source)
    bpy.data.objects.remove(cells)
    assert len(write_all(source)) == len(outputs_of(source)) == 3


def test_an_output_may_be_a_source_itself():
    source = sphere_source()
    _, cells, _ = write_all(source)
    edges = write_edges(bpy.context, cells, result_of(source), TessellateSettings())
    assert outputs_of(cells) == [edges]
    assert len(outputs_of(source)) == 3
    assert edges.users_collection == cells.users_collection
    assert set(write_all(source)) == set(outputs_of(source))
    assert outputs_of(cells) == [edges]


def test_attributes_are_written_through_replacements():
    source = sphere_source()
    write_all(source)
    write_all(source, count=5)
    assert read_attribute(source.data, "saddleback_cell").max() == 4

# SPDX-License-Identifier: GPL-3.0-or-later
"""The lamp shell: one closed solid, thick and wide as asked, that does not pass through itself."""

import os

import bpy
import numpy as np
import pytest
from output_scenes import HARD_PLACE, sphere_source, triangles_of, world_positions
from scenes import add_object, grid

from saddleback_blender import jobs
from saddleback_blender.core import cache
from saddleback_blender.core.solids.crossings import find_crossings

QUICK = {"count": 24, "iterations": 6, "k": 20, "make_edges": False, "make_shell": True}


def shell_of(source, **settings):
    bpy.ops.saddleback.tessellate(**{**QUICK, **settings})
    bpy.context.view_layer.update()
    return next(child for child in source.children if child.get("saddleback_role") == "shell")


def volume(places, triangles):
    a, b, c = (places[triangles[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def assert_solid(item):
    """Every edge once in either direction, no face through another, more inside than nothing."""
    places, triangles = world_positions(item), triangles_of(item.data)
    edges = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    ways, uses = np.unique(edges, axis=0, return_counts=True)
    assert (uses == 1).all()
    assert {tuple(way) for way in ways[:, ::-1].tolist()} == {tuple(way) for way in ways.tolist()}
    assert not len(find_crossings(places, triangles))
    assert not item.data.validate()
    assert volume(places, triangles) > 0
    return places, triangles


@pytest.mark.parametrize("place", [None, HARD_PLACE])
def test_a_ball_becomes_one_solid(place):
    source = sphere_source(levels=4, place=place)
    item = shell_of(source, rib_width=0.2, rib_thickness=0.06)
    places, _ = assert_solid(item)
    if place is None:
        radius = np.linalg.norm(places, axis=1)
        np.testing.assert_allclose([radius.min(), radius.max()], [0.97, 1.03], atol=0.004)


def test_its_volume_is_length_times_width_times_thickness():
    source = sphere_source(levels=3)
    bpy.ops.saddleback.tessellate(**{**QUICK, "make_edges": True}, rib_width=0.1, rib_thickness=0.02)
    bpy.context.view_layer.update()
    shell, edges = (next(c for c in source.children if c["saddleback_role"] == role) for role in ("shell", "edges"))
    line = world_positions(edges)
    ends = np.array([edge.vertices[:] for edge in edges.data.edges])
    length = np.linalg.norm(line[ends[:, 1]] - line[ends[:, 0]], axis=1).sum()
    # Where three ribs meet they share a little: 44 corners, each less than a width long.
    whole = length * 0.1 * 0.02
    assert whole * (1 - 44 * 0.1 / length) < volume(world_positions(shell), triangles_of(shell.data)) < whole * 1.01


def test_a_border_has_a_rib():
    item = shell_of(grid(n=16), count=6, rib_width=0.04, rib_thickness=0.02)
    places, _ = assert_solid(item)
    np.testing.assert_allclose(places.min(axis=0), [0, 0, -0.01], atol=1e-6)
    np.testing.assert_allclose(places.max(axis=0), [1, 1, 0.01], atol=1e-6)


def test_a_block_of_few_faces_is_refined_and_its_corners_do_not_cross():
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    source = add_object("Block", corners, faces)
    item = shell_of(source, count=8, k=8, rib_width=0.1, rib_thickness=0.12)
    assert_solid(item)


def test_walls_thinner_than_the_shell_make_it_thinner():
    source = sphere_source(levels=3)
    source.scale = (1, 1, 0.02)  # a disk whose faces are nearer than the thickness
    bpy.context.view_layer.update()
    assert_solid(shell_of(source, rib_width=0.2, rib_thickness=0.08))


def test_an_extruded_text_whose_walls_are_not_joined_becomes_one_solid():
    bpy.ops.object.text_add()
    text = bpy.context.active_object
    text.data.body, text.data.extrude = "A", 0.1
    bpy.ops.object.convert(target="MESH")
    item = shell_of(bpy.context.active_object, count=12, k=0)
    assert_solid(item)


def test_a_second_run_replaces_it_and_only_lengths_are_computed_anew():
    source = sphere_source(levels=3)
    first = shell_of(source, rib_width=0.15)
    name, count = first.name, len(first.data.polygons)
    again = shell_of(source, rib_width=0.2)
    assert again.name == name and len(again.data.polygons) != count
    shell_of(source, rib_width=0.15)
    assert cache.shared.builds["cells"] == 1 and cache.shared.builds["shell"] == 2
    bpy.ops.saddleback.tessellate(**{**QUICK, "make_shell": False})
    assert not source.children


def test_pieces_are_told_and_a_surface_without_lines_is_refused(capfd):
    ball = sphere_source(levels=3)
    other = sphere_source("Other", levels=3)
    other.location.x = 5
    for item in (ball, other):
        item.select_set(True)
    bpy.context.view_layer.objects.active = ball
    bpy.ops.object.join()
    shell_of(ball, rib_width=0.2)
    assert "in 2 pieces" in capfd.readouterr().out
    lone = sphere_source("Lone", levels=3)
    bpy.context.view_layer.objects.active = lone
    with pytest.raises(RuntimeError, match="'Lone': there are no lines between cells"):
        shell_of(lone, count=1)
    with pytest.raises(RuntimeError, match="'Lone': ribs of width 1e-05 are too narrow"):
        shell_of(lone, rib_width=1e-5)


def test_crossings_are_found_and_neighbors_are_none():
    places = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (0.2, 0.2, -1), (0.3, 0.2, 1), (0.2, 0.3, 1)], float)
    triangles = np.array([(0, 1, 2), (1, 3, 2), (4, 5, 6)], np.int32)
    assert {tuple(sorted(pair)) for pair in find_crossings(places, triangles).tolist()} == {(0, 2)}


def test_walls_and_volume_are_told_and_painted_and_the_shell_is_saved_for_a_printer(tmp_path):
    source = sphere_source(levels=3)
    source.scale = (1, 1, 0.02)
    bpy.context.view_layer.update()
    item = shell_of(source, rib_width=0.2, rib_thickness=0.08)
    wall = np.empty(len(item.data.vertices), np.float32)
    item.data.attributes["saddleback_wall"].data.foreach_get("value", wall)
    assert wall.max() == pytest.approx(0.08, rel=1e-5) and 0 < wall.min() < 0.07
    color = np.empty(4 * len(wall), np.float32)
    item.data.color_attributes["saddleback_color"].data.foreach_get("color_srgb", color)
    is_red = color.reshape(-1, 4)[:, 1] < 0.5
    assert (wall[~is_red] > 0.0799).all() and 0 < is_red.mean() < 1
    text = jobs.state.line
    assert "walls 8 cm thick" in text and "at the least" in text and "volume" in text
    bpy.context.scene.unit_settings.scale_length = 0.001  # a unit is a millimeter
    path = tmp_path / "lamp.stl"
    assert bpy.ops.saddleback.export_stl(filepath=str(path)) == {"FINISHED"}
    places, triangles = world_positions(item), triangles_of(item.data)
    facets = np.frombuffer(path.read_bytes()[84:], [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("end", "<u2")])
    np.testing.assert_allclose(facets["corners"], places[triangles], atol=1e-6)
    assert list(tmp_path.iterdir()) == [path]
    item.scale.x *= -1  # as Mirror leaves it
    bpy.context.view_layer.update()
    link = path
    if os.name == "posix":  # elsewhere only some may make links
        link = tmp_path / "link.stl"
        link.symlink_to(path)
    assert bpy.ops.saddleback.export_stl(filepath=str(link)) == {"FINISHED"}
    assert path.is_file() and not path.is_symlink() and link.is_symlink() == (link != path)
    mirrored = np.frombuffer(path.read_bytes()[84:], facets.dtype)["corners"].astype(float)
    assert volume(mirrored.reshape(-1, 3), np.arange(3 * len(mirrored)).reshape(-1, 3)) > 0
    item.modifiers.new("Array", "ARRAY").count = 2
    item.hide_viewport = True  # whose modifiers Blender does not evaluate
    assert bpy.ops.saddleback.export_stl(filepath=str(path)) == {"FINISHED"}
    assert path.stat().st_size == 84 + 2 * 50 * len(triangles)
    with pytest.raises(RuntimeError, match="cannot be saved"):
        bpy.ops.saddleback.export_stl(filepath=str(tmp_path / "none" / "lamp.stl"))
    bpy.ops.saddleback.tessellate(**{**QUICK, "make_shell": False})
    assert not bpy.ops.saddleback.export_stl.poll()

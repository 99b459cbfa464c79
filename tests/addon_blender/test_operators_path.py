# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.path` as scripts call it: curve objects, their points in order, their place."""

import bmesh
import bpy
import numpy as np
import pytest
from scenes import add_object, fingerprint, grid, grid_arrays, positions, select, sphere, tube_radius

from saddleback_blender import jobs
from saddleback_blender.bridge.outputs.out_collection import find_output, outputs_of


def splines(item):
    """World places (n, 3) of each spline, and whether it is closed."""
    matrix = np.array(item.matrix_world)
    found = []
    for spline in item.data.splines:
        values = np.empty(4 * len(spline.points), np.float32)
        spline.points.foreach_get("co", values)
        found.append((values.reshape(-1, 4)[:, :3] @ matrix[:3, :3].T + matrix[:3, 3], spline.use_cyclic_u))
    return found


def length(points):
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def select_in_order(item, vertices):
    """As clicks with Shift would."""
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    loaded = bmesh.from_edit_mesh(item.data)
    loaded.verts.ensure_lookup_table()
    for vertex in vertices:
        loaded.verts[vertex].select = True
        loaded.select_history.add(loaded.verts[vertex])
    bmesh.update_edit_mesh(item.data)
    bpy.ops.object.mode_set(mode="OBJECT")


def add_empty(name, place, parent=None):
    empty = bpy.data.objects.new(name, None)
    empty.location = place
    bpy.context.scene.collection.objects.link(empty)
    empty.parent = parent
    bpy.context.view_layer.update()
    return empty


def test_a_path_between_two_vertices():
    item = grid(n=10)
    select(item, [0, 120])
    assert bpy.ops.saddleback.path(path_radius=0.02) == {"FINISHED"}
    (output,) = outputs_of(item)
    assert output.type == "CURVE" and output.name == "Grid Paths" and tube_radius(output) == pytest.approx(0.02)
    assert output.users_collection[0].name == "Saddleback"
    ((points, closed),) = splines(output)
    assert not closed and length(points) == pytest.approx(np.sqrt(2), rel=1e-5)
    assert output["saddleback_length"] == pytest.approx(np.sqrt(2), rel=1e-9)
    assert jobs.state.line.startswith("'Grid': path of length 1.414")


def test_lengths_and_radius_are_those_of_the_world():
    item = grid(n=10)
    item.scale = (4, 1, 1)
    item.location = (5, 0, 2)
    item.rotation_euler = (0.3, 0.4, 0.5)
    bpy.context.view_layer.update()
    select(item, [0, 10])
    bpy.ops.saddleback.path(lift=0.5)
    output = find_output(item, "paths")
    ((points, _),) = splines(output)
    assert length(points) == pytest.approx(4.0, rel=1e-5)
    ends = [np.array(item.matrix_world @ item.data.vertices[v].co) for v in (0, 10)]
    normal = np.array(item.matrix_world.to_3x3().inverted().transposed().col[2])
    lifted = [end + 0.5 * normal / np.linalg.norm(normal) for end in ends]
    np.testing.assert_allclose([points[0], points[-1]], lifted, atol=1e-5)
    np.testing.assert_allclose(output.matrix_world.to_scale(), (1, 1, 1), atol=1e-6)


def test_selected_vertices_are_joined_in_the_order_of_selection():
    item = grid(n=10)
    order = [60, 0, 120, 10]
    select_in_order(item, order)
    bpy.ops.saddleback.path(k=30)
    ((points, _),) = splines(find_output(item, "paths"))
    places = np.array([item.data.vertices[v].co for v in order])
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1).sum()
    np.testing.assert_allclose([points[0], points[-1]], places[[0, -1]], atol=1e-6)
    assert length(points) == pytest.approx(steps, rel=1e-5)
    select(item, [*order, 70])  # a selection whose order Blender does not know: by number
    bpy.ops.saddleback.path(k=30, connect="LOOP")
    ((points, closed),) = splines(find_output(item, "paths"))
    assert closed and tuple(points[0]) == tuple(item.data.vertices[0].co)


def test_all_pairs_of_a_vertex_group():
    item = grid(n=8)
    group = item.vertex_groups.new(name="Stops")
    group.add([0, 8, 72, 80], 1.0, "REPLACE")
    group.add([40], 0.2, "REPLACE")
    bpy.ops.saddleback.path(points="VERTEX_GROUP", points_group="Stops", connect="PAIRS", k=30)
    output = find_output(item, "paths")
    lengths = sorted(length(points) for points, _ in splines(output))
    np.testing.assert_allclose(lengths, [1, 1, 1, 1, np.sqrt(2), np.sqrt(2)], rtol=1e-5)
    assert output["saddleback_length"] == pytest.approx(4 + 2 * np.sqrt(2))
    assert "6 paths of lengths 1 to 1.414, 6.828 in all" in jobs.state.line


def test_empties_by_name_and_the_cursor_first():
    item = grid(n=10)
    add_empty("B", (0.9, 0.1, 1), item)
    add_empty("A", (0.1, 0.1, -1), item)
    bpy.context.scene.cursor.location = (0.1, 0.9, 0.3)
    bpy.ops.saddleback.path(points="EMPTIES", k=30)
    ((points, _),) = splines(find_output(item, "paths"))
    np.testing.assert_allclose([points[0], points[-1]], [[0.1, 0.1, 0], [0.9, 0.1, 0]], atol=1e-6)
    bpy.ops.saddleback.path(points="EMPTIES", from_cursor=True, k=30)
    ((points, _),) = splines(find_output(item, "paths"))
    np.testing.assert_allclose([points[0], points[-1]], [[0.1, 0.9, 0], [0.9, 0.1, 0]], atol=1e-6)
    assert length(points) == pytest.approx(1.6, rel=1e-4)
    select(item, [0])  # the cursor and one vertex are two points
    bpy.ops.saddleback.path(points="SELECTED", from_cursor=True, k=30)
    ((points, _),) = splines(find_output(item, "paths"))
    assert length(points) == pytest.approx(np.hypot(0.1, 0.9), rel=1e-4)


def test_it_is_replaced_kept_and_cleared():
    item = grid(n=8)
    select(item, [0, 80])
    bpy.ops.saddleback.path(k=20)
    output = find_output(item, "paths")
    output.name = "My Way"
    curves = len(bpy.data.curves)
    bpy.ops.saddleback.path(k=20, connect="PAIRS")
    assert find_output(item, "paths").name == "My Way" and len(bpy.data.curves) == curves
    assert item.saddleback.path.k == 20 and item.saddleback.path.connect == "PAIRS"
    assert bpy.ops.saddleback.clear() == {"FINISHED"}
    assert not bpy.data.curves and "Saddleback" not in bpy.data.collections


def test_undo_takes_it_back():
    item = grid(n=8)
    select(item, [0, 80])
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.saddleback.path("EXEC_DEFAULT", True, k=20)
    assert len(bpy.data.curves) == 1
    bpy.ops.ed.undo()
    assert not bpy.data.curves and "Grid Paths" not in bpy.data.objects
    bpy.ops.ed.redo()
    assert len(bpy.data.curves) == 1 and "Grid Paths" in bpy.data.objects


def test_with_modifiers_it_runs_on_what_they_make():
    item = sphere(subdivisions=2)
    modifier = item.modifiers.new("Cast", "CAST")
    modifier.factor, modifier.radius = 1.0, 3.0
    select(item, [0, 1])
    bpy.ops.saddleback.path(use_modifiers=True, k=20)
    ((points, _),) = splines(find_output(item, "paths"))
    assert np.linalg.norm(points, axis=1).max() == pytest.approx(3.0, rel=0.05)


def test_exact_paths_are_the_shortest():
    item = sphere(subdivisions=4)
    select(item, [0, 200])
    lengths = {}
    for quality in ("FAST", "EXACT"):
        bpy.ops.saddleback.path(quality=quality, shorten=False)
        lengths[quality] = find_output(item, "paths")["saddleback_length"]
    assert item.saddleback.path.quality == "EXACT"
    assert lengths["EXACT"] <= lengths["FAST"] <= 1.02 * lengths["EXACT"]
    places = positions(item.data)
    assert lengths["EXACT"] == pytest.approx(np.arccos(places[0] @ places[200]), rel=0.01)


def refuse(*sentences, **options):
    for item in bpy.data.objects:
        assert item.saddleback.path.connect and item.saddleback.distance.quality and item.saddleback.tessellate.count
        assert item.saddleback.repair.weld_distance == 0
    before = fingerprint()
    with pytest.raises(RuntimeError) as caught:
        bpy.ops.saddleback.path(**options)
    for sentence in sentences:
        assert sentence in str(caught.value)
    assert fingerprint() == before


def test_what_cannot_be_done_is_refused_and_nothing_changes():
    vertices, faces = grid_arrays(4)
    item = add_object("Two", np.concatenate([vertices, vertices + [0, 0, 2], [[9, 9, 9]]]), [*faces, *(faces + 25)])
    select(item, [])
    refuse("'Two' has no selected vertex")
    select(item, [3])
    refuse("'Two': a path needs two points", "only one")
    select(item, [3, 30])
    refuse("'Two': points 1 and 2 lie on parts of the surface that do not hang together")
    select(item, [3, 50])
    refuse("'Two': the point at vertex 50 belongs to no face")
    refuse("'Two' has no vertex group; paint one or choose other points", points="VERTEX_GROUP")
    item.vertex_groups.new(name="Bare")
    refuse("no vertex has a weight above 0.5 in vertex group 'Bare'", points="VERTEX_GROUP")
    refuse("no empty is parented to 'Two'", points="EMPTIES")
    refuse("no collection 'Gone'", points="EMPTIES", points_collection="Gone")


def test_a_selection_by_mistake_is_refused_at_once():
    item = grid(n=30)
    everything = "'Grid': all its 961 vertices are selected"
    select(item, range(961))
    refuse(everything, "choose the 3D Cursor")
    refuse(everything, from_cursor=True)
    select(item, range(600))
    refuse("'Grid': a path through 600 points is more than the 500 that are allowed")
    item.vertex_groups.new(name="All").add(range(961), 1.0, "REPLACE")
    refuse("all its 961 vertices are in the group", points="VERTEX_GROUP")


def test_chains_may_be_smooth_and_rings_tight():
    item = grid(n=10)
    select(item, [24, 30, 90])
    refuse("'Grid': nothing holds the closed chain", connect="LOOP", tighten=True)
    bpy.ops.saddleback.path(connect="LOOP", smooth=True)
    ((points, closed),) = splines(find_output(item, "paths"))
    assert closed and length(points) > 2.1 and tuple(points[0]) != tuple(points[-1]) and item.saddleback.path.smooth
    tube = add_object("Tube", *tube_arrays())
    select(tube, [4, 5, 6, 7])
    bpy.ops.saddleback.path(connect="LOOP", tighten=True, smooth=False)
    assert find_output(tube, "paths")["saddleback_length"] == pytest.approx(8.0, rel=1e-5)


def tube_arrays():
    """A square tube of side 2 and height 3, open above and below."""
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    vertices = [(x, y, z) for z in range(4) for x, y in corners]
    faces = [np.array([i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i]) + 4 * z for z in range(3) for i in range(4)]
    return vertices, faces


def test_from_the_cursor_to_the_farthest_point():
    item = grid(n=10)
    bpy.context.scene.cursor.location = (0.9, 1.2, 0.3)
    for quality in ("NORMAL", "EXACT"):
        assert bpy.ops.saddleback.path(points="CURSOR", quality=quality) == {"FINISHED"}
        ((points, closed),) = splines(find_output(item, "paths"))
        assert not closed
        np.testing.assert_allclose(points[[0, -1]], [[0.9, 1.0, 0.0], [0.0, 0.0, 0.0]], atol=1e-6)
        assert length(points) == pytest.approx(np.hypot(0.9, 1.0), rel=1e-3)


def test_the_panel_begins_at_the_cursor_and_scripts_with_what_is_selected():
    item = grid(n=10)
    assert item.saddleback.path.points == "CURSOR"
    select(item, [0, 10])
    bpy.ops.saddleback.path()
    ((points, _),) = splines(find_output(item, "paths"))
    np.testing.assert_allclose(points[[0, -1]], [[0, 0, 0], [1, 0, 0]], atol=1e-6)
    assert item.saddleback.path.points == "SELECTED"  # the panel shows what was run, and repeats it

# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.voronoi_2d` as scripts call it: cells and edges of flat meshes and of surfaces, images, the sweep."""

import time

import bpy
import numpy as np
import pytest
from scenes import add_object, fingerprint, grid, grid_arrays, positions, select, sphere

from saddleback_blender import jobs, nodes
from saddleback_blender.bridge.outputs.out_collection import find_output, outputs_of

CELLS, EDGES, CENTERS = "voronoi cells", "voronoi edges", "voronoi centers"


def faces(item):
    """Cell and area of each face, in the world."""
    mesh = item.data
    cells = np.empty(len(mesh.polygons), np.int32)
    mesh.attributes["saddleback_cell"].data.foreach_get("value", cells)
    scale = abs(item.matrix_world.to_3x3().determinant()) ** (2 / 3)
    return cells, np.array([polygon.area for polygon in mesh.polygons]) * scale


def world(item):
    matrix = np.array(item.matrix_world)
    return positions(item.data) @ matrix[:3, :3].T + matrix[:3, 3]


def frame_with_hole():
    """A square of side 3 without its middle."""
    vertices, quads = grid_arrays(3, 3.0)
    return add_object("Frame", vertices, np.delete(quads, 4, axis=0))


def unwrapped_cylinder(around=32, along=8):
    """Closed around, with a UV map that is cut open there."""
    angle = 2 * np.pi * np.arange(around) / around
    rings = [np.column_stack([np.cos(angle), np.sin(angle), np.full(around, 2 * j / along)]) for j in range(along + 1)]
    quads = [
        (j * around + i, j * around + (i + 1) % around, (j + 1) * around + (i + 1) % around, (j + 1) * around + i)
        for j in range(along)
        for i in range(around)
    ]
    item = add_object("Cylinder", np.concatenate(rings), quads)
    layer = item.data.uv_layers.new(name="Cut")
    places = [
        ((i + di) / around, (j + dj) / along)
        for j in range(along)
        for i in range(around)
        for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1))
    ]
    layer.data.foreach_set("uv", np.array(places, np.float32).ravel())
    return item


def image(name, pixels):
    """Gray values (rows, columns), the first row below."""
    made = bpy.data.images.new(name, pixels.shape[1], pixels.shape[0], float_buffer=True)
    rgba = np.repeat(pixels[:, :, None], 4, axis=2).astype(np.float32)
    rgba[:, :, 3] = 1
    made.pixels.foreach_set(rgba.ravel())
    return made


def test_cells_of_a_flat_mesh():
    item = grid(n=4, size=2.0)
    assert bpy.ops.saddleback.voronoi_2d(count=50, seed=3) == {"FINISHED"}
    cells, areas = faces(find_output(item, CELLS))
    assert sorted(cells) == list(range(50)) and areas.sum() == pytest.approx(4.0, rel=1e-5)
    edges = find_output(item, EDGES)
    assert [modifier.node_group.get(nodes.MARK) for modifier in edges.modifiers] == [nodes.FOLLOW, nodes.TUBES]
    both = [np.empty(len(edges.data.edges), np.int32) for _ in range(2)]
    for values, name in zip(both, ("saddleback_cell_a", "saddleback_cell_b"), strict=True):
        edges.data.attributes[name].data.foreach_get("value", values)
    assert (both[0] >= 0).all() and (both[1] == -1).any() and (both[1] < 50).all()
    # Euler: a disk cut into cells.
    mesh = find_output(item, CELLS).data
    assert len(mesh.vertices) - len(mesh.edges) + len(mesh.polygons) == 1
    assert len(edges.data.edges) == len(mesh.edges)
    assert jobs.state.line.startswith("'Grid': 50 cells")


def test_world_units_whatever_the_transform():
    item = grid(n=3)
    item.scale, item.rotation_euler, item.location = (4, -2, 1), (0.3, 0.7, 0.2), (1, 2, 3)
    bpy.context.view_layer.update()
    bpy.ops.saddleback.voronoi_2d(count=20)
    output = find_output(item, CELLS)
    assert faces(output)[1].sum() == pytest.approx(8.0, rel=1e-4)
    own = np.array(item.matrix_world.inverted())
    back = world(output) @ own[:3, :3].T + own[:3, 3]
    assert np.abs(back[:, 2]).max() < 1e-5 and back[:, :2].min() > -1e-5 and back[:, :2].max() < 1 + 1e-5


def test_cells_around_a_hole():
    item = frame_with_hole()
    bpy.ops.saddleback.voronoi_2d(count=40)
    assert faces(find_output(item, CELLS))[1].sum() == pytest.approx(8.0, rel=1e-5)
    for count in (1, 2):  # a cell all around the hole
        bpy.ops.saddleback.voronoi_2d(count=count)
        cells, areas = faces(find_output(item, CELLS))
        assert areas.sum() == pytest.approx(8.0, rel=1e-5) and set(cells) == set(range(count))


def test_gap_and_thickness():
    item = grid(n=2)
    bpy.ops.saddleback.voronoi_2d(count=12, gap=0.02, thickness=0.1, inset=0.01)
    output = find_output(item, CELLS)
    heights = world(output)[:, 2]
    assert heights.max() == pytest.approx(0.1, abs=1e-6) and set(faces(output)[0]) == set(range(12))
    assert faces(output)[1].sum() > 1
    bpy.ops.saddleback.voronoi_2d(count=12, gap=0.02, thickness=0.0)
    assert 0.5 < faces(find_output(item, CELLS))[1].sum() < 0.97


def test_sites_from_vertices():
    item = grid(n=4)
    select(item, [0, 4, 20, 24])
    bpy.ops.saddleback.voronoi_2d(sites_source="SELECTED")
    np.testing.assert_allclose(faces(find_output(item, CELLS))[1], 0.25, rtol=1e-5)
    other = add_object("Dots", [(0.25, 0.5, 7), (0.75, 0.5, -3)], [], active=False)
    bpy.ops.saddleback.voronoi_2d(sites_source="OBJECT", sites_object="Dots")
    np.testing.assert_allclose(faces(find_output(item, CELLS))[1], 0.5, rtol=1e-5)
    assert item.saddleback.voronoi_2d.sites_object == other


def test_heavier_sites_have_larger_cells():
    item = grid(n=2)
    places = [(0.25, 0.25, 0), (0.75, 0.25, 0), (0.25, 0.75, 0), (0.75, 0.75, 0), (0.5, 0.5, 0)]
    dots = add_object("Dots", places, [], active=False)
    bpy.ops.saddleback.voronoi_2d(sites_source="OBJECT", sites_object="Dots")
    plain = np.bincount(*faces(find_output(item, CELLS)))
    values = np.array([0, 0, 0, 0, 0.1], np.float32)
    dots.data.attributes.new("size", "FLOAT", "POINT").data.foreach_set("value", values)
    bpy.ops.saddleback.voronoi_2d(sites_source="OBJECT", sites_object="Dots", weights_name="size")
    cells, areas = faces(find_output(item, CELLS))
    heavy = np.bincount(cells, areas)
    assert heavy.sum() == pytest.approx(1, rel=1e-5) and heavy[4] > 1.5 * plain[4]
    mesh = find_output(item, CELLS).data  # neighbors share the points of their curved edges
    assert len(mesh.vertices) - len(mesh.edges) + len(mesh.polygons) == 1
    values[4] = 0.5  # its disk holds the others
    dots.data.attributes["size"].data.foreach_set("value", values)
    dots.data.update()
    bpy.ops.saddleback.voronoi_2d()
    assert set(faces(find_output(item, CELLS))[0]) == {4} and "1 cell, 4 sites without one" in jobs.state.line


def test_weights_around_a_hole():
    item = frame_with_hole()
    dots = add_object("Dots", [(0.5, 1.5, 0), (0.4, 1.5, 0)], [], active=False)
    dots.data.attributes.new("size", "FLOAT", "POINT").data.foreach_set("value", np.array([0.5, 0], np.float32))
    arguments = {"sites_source": "OBJECT", "sites_object": "Dots", "weights_name": "size"}
    bpy.ops.saddleback.voronoi_2d(**arguments)
    cells, areas = faces(find_output(item, CELLS))
    domain = sum(face.area for face in item.data.polygons)
    assert set(cells) == {0} and areas.sum() == pytest.approx(domain, rel=1e-5)
    assert find_output(item, EDGES) is not None


def test_an_image_draws_sites():
    item = grid(n=2)
    tones = np.ones((8, 8))
    tones[:, 4:] = 0.25  # dark to the right
    tones[:4, :4] = 1.0
    image("Tones", tones)
    bpy.ops.saddleback.voronoi_2d(sites_source="IMAGE", image_name="Tones", count=300, iterations=5, make_centers=True)
    sites = world(find_output(item, CENTERS))
    assert len(sites) == 300 and (sites[:, 0] > 0.49).all()
    bpy.ops.saddleback.voronoi_2d(
        sites_source="IMAGE", image_name="Tones", count=200, image_invert=True, make_centers=True
    )
    sites = world(find_output(item, CENTERS))
    assert np.count_nonzero(sites[:, 0] < 0.5) / 200 == pytest.approx(0.8, abs=0.1)


def test_relaxed_cells_are_even():
    item = grid(n=2)
    spread = []
    for iterations in (0, 30):
        bpy.ops.saddleback.voronoi_2d(count=60, iterations=iterations)
        spread.append(faces(find_output(item, CELLS))[1].std())
    assert spread[1] < 0.5 * spread[0]


@pytest.mark.parametrize("mirrored", [False, True])
def test_on_a_surface_through_its_uv_map(mirrored):
    item = unwrapped_cylinder()
    if mirrored:
        item.scale = (-1, 1, 1)
        bpy.context.view_layer.update()
    area = sum(polygon.area for polygon in item.data.polygons)
    bpy.ops.saddleback.voronoi_2d(space="UV", count=40, iterations=3)
    cells, areas = faces(find_output(item, CELLS))
    assert areas.sum() == pytest.approx(area, rel=1e-5) and set(cells) == set(range(40))
    points = world(find_output(item, EDGES))
    radii = np.linalg.norm(points[:, :2], axis=1)
    assert radii.max() < 1 + 1e-5 and radii.min() > np.cos(np.pi / 32) - 1e-5
    bpy.ops.saddleback.voronoi_2d(space="UV", count=40, thickness=0.1, gap=0.02)
    raised = np.linalg.norm(world(find_output(item, CELLS))[:, :2], axis=1)
    assert raised.max() == pytest.approx(1.1, abs=0.02)


def test_an_image_on_the_uv_square():
    item = unwrapped_cylinder()
    tones = np.ones((4, 8))
    tones[:, :2] = 0.0  # a quarter of the way around is dark
    image("Stripe", tones)
    bpy.ops.saddleback.voronoi_2d(
        space="UV", sites_source="IMAGE", image_name="Stripe", count=50, iterations=4, make_centers=True
    )
    sites = world(find_output(item, CENTERS))
    assert (sites[:, 0] > -0.05).all() and (sites[:, 1] > -0.05).all()


def test_on_a_disk_without_uv():
    item = sphere(subdivisions=4)
    mesh = item.data
    lower = [v.index for v in mesh.vertices if v.co.z < -0.05]
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    bpy.ops.object.mode_set(mode="OBJECT")
    select(item, lower)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.delete(type="VERT")
    bpy.ops.object.mode_set(mode="OBJECT")
    while mesh.uv_layers:
        mesh.uv_layers.remove(mesh.uv_layers[0])
    area = sum(polygon.area for polygon in mesh.polygons)
    bpy.ops.saddleback.voronoi_2d(space="DISK", count=60, iterations=40)
    cells, areas = faces(find_output(item, CELLS))
    assert areas.sum() == pytest.approx(area, rel=1e-5)
    of_cells = np.bincount(cells, areas)
    assert of_cells.std() / of_cells.mean() < 0.35  # even on the surface, though the disk shrinks its rim


def test_running_again_replaces_and_clear_removes_everything():
    item = grid(n=2)
    before = fingerprint()
    for _ in range(2):
        bpy.ops.saddleback.voronoi_2d(count=30, make_centers=True, animate=True)
        assert len(outputs_of(item)) == 6
    bpy.ops.saddleback.tessellate(count=5, iterations=0)
    assert len(outputs_of(item)) == 7  # tessellate's edges have a name of their own
    bpy.ops.saddleback.voronoi_2d(count=30, make_edges=False, make_centers=False, animate=False)
    assert {output["saddleback_role"] for output in outputs_of(item)} == {"edges", CELLS}
    bpy.ops.saddleback.clear()
    assert not bpy.data.actions and len(bpy.data.objects) == 1 and not bpy.data.node_groups
    assert [kind for kind in before if kind[0] == "collections"] == [k for k in fingerprint() if k[0] == "collections"]


def test_settings_are_kept_and_used_again():
    item = grid(n=2)
    image("Tones", np.zeros((2, 2)))
    bpy.ops.saddleback.voronoi_2d(sites_source="IMAGE", image_name="Tones", count=33, seed=5)
    kept = item.saddleback.voronoi_2d
    assert (kept.count, kept.seed, kept.image_name.name) == (33, 5, "Tones")
    bpy.data.images["Tones"].name = "Renamed"
    bpy.ops.saddleback.voronoi_2d()
    assert len(set(faces(find_output(item, CELLS))[0])) == 33


def test_undo_takes_everything_back():
    grid(n=2)
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.saddleback.voronoi_2d("EXEC_DEFAULT", True, count=20)
    assert len(bpy.data.objects) == 3
    bpy.ops.ed.undo()
    assert [item.name for item in bpy.data.objects] == ["Grid"]
    bpy.ops.ed.redo()
    assert len(bpy.data.objects) == 3


# --- the sweep --------------------------------------------------------------------------------------------------------


def shown(item, frame):
    """World places and number of edges of what the sweep's own modifier leaves of an object in a frame."""
    for modifier in item.modifiers:
        modifier.show_viewport = modifier.node_group.get(nodes.MARK) == nodes.SWEEP
    bpy.context.scene.frame_set(frame)
    evaluated = item.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    matrix = np.array(evaluated.matrix_world)
    found = positions(mesh) @ matrix[:3, :3].T + matrix[:3, 3], len(mesh.edges)
    evaluated.to_mesh_clear()
    return found


def test_the_sweep_plays_back():
    item = grid(n=2, size=2.0)
    bpy.ops.saddleback.voronoi_2d(count=60, animate=True, frame_start=10, frame_end=69)
    circle, beach, edges = (find_output(item, role) for role in ("sweep circle", "beach curve", "growing edges"))
    center = np.array([1.0, 1.0, 0.0])
    counts, radii = [], []
    for frame in (10, 25, 40, 55, 69, 90):
        places, count = shown(edges, frame)
        counts.append(count)
        bpy.context.scene.frame_set(frame)
        radii.append(circle.matrix_world.to_scale()[0])
        assert (np.linalg.norm(places - center, axis=1) <= radii[-1] + 1e-5).all()
        ring = shown(beach, frame)[0][:-256]  # the circle itself comes last
        if frame < 69:
            assert len(ring) in (0, 512)
            assert (np.linalg.norm(ring - center, axis=1) <= radii[-1] * (1 + 1 / 60) + 1e-5).all()
    assert counts == sorted(counts) and counts[0] < counts[2] < counts[4] == counts[5] == len(edges.data.edges)
    assert np.diff(radii[:4]).std() < 1e-6  # keyframes are joined by straight lines
    whole = find_output(item, EDGES)
    inner = np.empty(len(whole.data.edges), np.int32)
    whole.data.attributes["saddleback_cell_b"].data.foreach_get("value", inner)
    lengths = [
        sum((mesh.vertices[a].co - mesh.vertices[b].co).length for a, b in (edge.vertices for edge in chosen))
        for mesh, chosen in (
            (whole.data, [edge for edge, cell in zip(whole.data.edges, inner, strict=True) if cell >= 0]),
            (edges.data, edges.data.edges),
        )
    ]
    assert lengths[0] == pytest.approx(lengths[1], rel=1e-4)


@pytest.mark.parametrize("circles", ["CURSOR", "EMPTIES", "COUNT"])
def test_circles_of_ones_own(circles):
    item = grid(n=2, size=2.0)
    places = [(0.5, 0.5, 0.0), (1.5, 0.4, 1.0), (1.0, 1.6, 0.0)]
    for place in places:
        empty = bpy.data.objects.new("Here", None)
        bpy.context.collection.objects.link(empty)
        empty.location = place
        empty.parent = item
    bpy.context.scene.cursor.location = places[0]
    bpy.context.view_layer.update()
    bpy.ops.saddleback.voronoi_2d(count=60, animate=True, circles=circles, circle_count=3, frame_end=40)
    circle, beach, edges = (find_output(item, role) for role in ("sweep circle", "beach curve", "growing edges"))
    if circles != "COUNT":
        assert np.allclose(circle.matrix_world.translation, places[0], atol=1e-6)
    counts = [shown(edges, frame)[1] for frame in (1, 10, 20, 30, 40, 60)]
    assert counts == sorted(counts) and counts[-1] == len(edges.data.edges) > counts[1] > 0
    rings = shown(beach, 20)[0]
    assert len(rings) == (512 + 256 if circles == "CURSOR" else 2 * 3 * 512)
    if circles == "EMPTIES":
        flat = np.array(places) * (1, 1, 0)
        around = np.linalg.norm(rings[3 * 512 :].reshape(3, 512, 3) - flat[:, None], axis=2)
        assert np.ptp(around, axis=1).max() < 1e-5 and around.min() > 0.05


def test_a_frame_of_500_sites_takes_little_time():
    item = grid(n=2)
    bpy.ops.saddleback.voronoi_2d(count=500, animate=True)
    assert find_output(item, "growing edges") is not None
    scene = bpy.context.scene
    scene.frame_set(2)
    times = []
    for frame in range(20, 120, 10):
        started = time.process_time()
        scene.frame_set(frame)
        times.append(time.process_time() - started)
    assert np.median(times) < 0.5  # ten times the promise, for a machine that does other things


# --- what is refused --------------------------------------------------------------------------------------------------


def refused(text, **settings):
    before = fingerprint()
    with pytest.raises(RuntimeError, match=text):
        bpy.ops.saddleback.voronoi_2d(**settings)
    assert fingerprint() == before


def test_meshes_that_are_not_flat():
    item = grid(n=4)
    item.data.vertices[12].co.z = 0.2
    refused(r"'Grid' is not flat: vertex 12 is 0\.1\d+ off its plane", count=5)
    sphere()
    refused("'Sphere' is not flat", count=5)


def test_two_parts():
    vertices, quads = grid_arrays(1)
    add_object("Pair", np.concatenate([vertices, vertices + 3]), np.concatenate([quads, quads + 4]))
    refused("'Pair' is in 2 parts", count=5)


def test_maps_that_cannot_be_used():
    item = grid(n=2)
    refused("'Grid' has no UV map; unwrap it", space="UV")
    layer = item.data.uv_layers.new(name="Map")
    refused("'Grid' has no UV map 'Other'", space="UV", uv_name="Other")
    layer.data.foreach_set("uv", np.tile([0, 0, 1, 0, 1, 1, 0, 1], 4).astype(np.float32))
    refused("'Grid': faces 0 and 1 overlap in the map", space="UV")
    vertices = positions(item.data)[[loop.vertex_index for loop in item.data.loops]]
    places = vertices[:, :2] * (1, -1) + (0, 1)
    layer.data.foreach_set("uv", places.astype(np.float32).ravel())
    refused("'Grid': face 0 is flipped in the map", space="UV")


def test_patches_that_are_no_disks():
    sphere(subdivisions=2)
    refused("'Sphere': wanted a disk .1 part, 1 border, 0 handles., got 1 part, 0 borders", space="DISK")


def test_sites_and_weights():
    select(grid(n=2), [])
    refused("no selected vertex", sites_source="SELECTED")
    refused("there is no object 'Gone'", sites_source="OBJECT", sites_object="Gone")
    refused("there is no image 'Gone'", sites_source="IMAGE", image_name="Gone")
    refused("only vertices have weights", weights_name="size")
    image("White", np.ones((4, 4)))
    refused("the image is white", sites_source="IMAGE", image_name="White")
    select(bpy.context.object, [0, 1, 2])
    refused("no attribute 'size'", sites_source="SELECTED", weights_name="size")


def test_frames_and_spaces_of_the_sweep():
    grid(n=2)
    refused("the sweep ends in frame 5", animate=True, frame_start=9, frame_end=5)
    refused("shown on flat meshes only", animate=True, space="DISK")
    refused("no empty is parented to 'Grid'; add one at each place to grow a circle", animate=True, circles="EMPTIES")
    refused("no collection 'Gone'", animate=True, circles="EMPTIES", circles_collection="Gone")


def dots_of(item):
    """Middles (n, 3) and radii (n,) of the dots that are seen."""
    found = [
        (np.array(dot.matrix_world.translation), dot.matrix_world.to_scale().x)
        for dot in bpy.context.evaluated_depsgraph_get().object_instances
        if dot.is_instance and dot.parent.original == item
    ]
    return np.array([middle for middle, _ in found]), np.array([size for _, size in found])


@pytest.mark.parametrize(
    ("kind", "alike", "right"), [("EQUAL", True, True), ("TONE", False, True), ("CELL", False, False)]
)
def test_dots_cover_what_the_image_says(kind, alike, right):
    item = grid()
    half = image("Half", np.repeat([[0.2] * 32 + [0.8] * 32], 64, axis=0))
    settings = {"make_edges": False, "make_cells": False, "make_centers": True, "instance_dots": True}
    bpy.ops.saddleback.voronoi_2d(
        sites_source="IMAGE", image_name=half.name, count=2000, iterations=15, instance_size=kind, **settings
    )
    centers = find_output(item, "voronoi centers")
    middles, sizes = dots_of(centers)
    assert len(middles) == 2000 and np.all(middles[:, 2] > 1e-4) and np.all(middles[:, 2] < 2e-3)
    assert (np.ptp(sizes) < 1e-6) == alike
    low, high = positions(item.data).min(axis=0), positions(item.data).max(axis=0)
    dark = middles[:, 0] < 0.5 * (low + high)[0]
    area = 0.5 * np.prod((high - low)[:2])
    ink = np.array([np.pi * (sizes[side] ** 2).sum() / area for side in (dark, ~dark)])
    assert (np.abs(ink - [0.8, 0.2]).max() < 0.05) == right
    bpy.ops.saddleback.voronoi_2d(count=20, make_centers=True)
    assert nodes.modifier_of(find_output(item, "voronoi centers"), nodes.DOTS) is None


def test_an_object_takes_the_place_of_dots():
    item = grid()
    other = add_object("Other", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], active=False)
    bpy.ops.saddleback.voronoi_2d(count=20, make_centers=True, instance_dots=True)
    bpy.ops.saddleback.voronoi_2d(count=20, make_centers=True, instance_dots=True, instance_object=other.name)
    centers = find_output(item, "voronoi centers")
    assert nodes.modifier_of(centers, nodes.DOTS) is None and len(dots_of(centers)[0]) == 20
    assert np.abs(positions(centers.data)[:, 2]).max() < 1e-6


@pytest.mark.parametrize("iterations", [0, 10])
def test_equal_cells_have_one_area(iterations):
    item = frame_with_hole()
    bpy.ops.saddleback.voronoi_2d(count=60, iterations=iterations, equal_cells=True, make_edges=True)
    cells, areas = faces(find_output(item, CELLS))
    each = np.bincount(cells, areas, minlength=60)
    assert np.abs(each - 8 / 60).max() < 1e-4
    bpy.ops.saddleback.voronoi_2d(count=60, iterations=iterations)
    assert np.bincount(*faces(find_output(item, CELLS))).std() > 0.01


def test_equal_cells_are_equal_on_the_surface_through_a_map():
    item = unwrapped_cylinder()
    layer = item.data.uv_layers["Cut"]
    for loop in layer.data:  # one half of the map holds a quarter of the surface
        loop.uv[1] = loop.uv[1] ** 2
    bpy.ops.saddleback.voronoi_2d(space="UV", count=40, iterations=5, equal_cells=True)
    cells, areas = faces(find_output(item, CELLS))
    each = np.bincount(cells, areas, minlength=40)
    assert np.abs(each / each.mean() - 1).max() < 0.05  # of the map's stretch by 512 rectangles each way
    bpy.ops.saddleback.voronoi_2d(space="UV", count=40, iterations=0)
    cells, areas = faces(find_output(item, CELLS))
    assert np.ptp(np.bincount(cells, areas, minlength=40)) > 0.3 * each.mean()


def test_equal_cells_of_an_image_have_one_share_of_its_tone():
    item = grid()
    half = image("Half", np.repeat([[0.2] * 32 + [0.8] * 32], 64, axis=0))
    bpy.ops.saddleback.voronoi_2d(
        sites_source="IMAGE", image_name=half.name, count=100, iterations=10, equal_cells=True, make_centers=True
    )
    cells, areas = faces(find_output(item, CELLS))
    sites = positions(find_output(item, CENTERS).data)
    middle = 0.5 * (sites[:, 0].min() + sites[:, 0].max())
    each = np.bincount(cells, areas, minlength=100)
    dark, light = each[sites[:, 0] < middle - 0.1], each[sites[:, 0] > middle + 0.1]
    assert light.mean() / dark.mean() == pytest.approx(4, rel=0.1)  # of 0.8 and 0.2 of ink


def test_equal_cells_say_what_they_do_not_go_with():
    item = grid()
    for settings, sentence in (
        ({"animate": True}, "the sweep shows cells of any size; switch Animate off, or Equal Cells"),
        ({"sites_source": "SELECTED", "weights_name": "heavy"}, "cells are as large as the weights say"),
    ):
        item.data.attributes.get("heavy") or item.data.attributes.new("heavy", "FLOAT", "POINT")
        select(item, [0, 3, 7])
        with pytest.raises(RuntimeError, match=sentence):
            bpy.ops.saddleback.voronoi_2d(equal_cells=True, **settings)


def turned_rectangle():
    vertices, quads = grid_arrays(4, 2.0)
    item = add_object("Tile", np.asarray(vertices) * [1.0, 0.5, 1.0], quads)
    item.rotation_euler = (0.3, 0.8, 0.5)
    item.location = (1.0, -2.0, 3.0)
    bpy.context.view_layer.update()
    return item


@pytest.mark.parametrize("iterations", [0, 25])
def test_seamless_cells_fit_the_opposite_side(iterations):
    item = turned_rectangle()
    bpy.ops.saddleback.voronoi_2d(count=30, iterations=iterations, seamless=True, make_centers=True)
    cells = find_output(item, CELLS)
    numbers, areas = faces(cells)
    assert areas.sum() == pytest.approx(2.0, rel=1e-5)
    assert set(numbers) == set(range(30))
    places = positions(cells.data)
    low, high = places.min(axis=0), places.max(axis=0)
    for axis in (0, 1):
        across = 1 - axis
        sides = [
            sorted(
                (min(places[a, across], places[b, across]), max(places[a, across], places[b, across]), cell)
                for polygon, cell in zip(cells.data.polygons, numbers, strict=True)
                for a, b in polygon.edge_keys
                if abs(places[a, axis] - end[axis]) < 1e-5 and abs(places[b, axis] - end[axis]) < 1e-5
            )
            for end in (low, high)
        ]
        assert len(sides[0]) == len(sides[1]) > 2
        assert [cell for *_, cell in sides[0]] == [cell for *_, cell in sides[1]]
        assert np.abs(np.array(sides[0])[:, :2] - np.array(sides[1])[:, :2]).max() < 1e-5
    if iterations:
        each = np.bincount(numbers, areas, minlength=30)
        assert each.std() < 0.2 * each.mean()


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("underside", [False, True])
def test_seamless_cells_have_gaps_and_rims_across_the_sides(seed, underside):
    item = turned_rectangle()
    bpy.ops.saddleback.voronoi_2d(
        count=30, seed=seed, iterations=10, seamless=True, gap=0.03, inset=0.04, thickness=0.05, underside=underside
    )
    cells = find_output(item, CELLS)
    attribute = np.empty(len(cells.data.polygons), np.int32)
    cells.data.attributes["saddleback_cell"].data.foreach_get("value", attribute)
    assert set(attribute) == set(range(30)) and "left out" not in jobs.state.line
    places = positions(cells.data)
    for axis, end in ((0, 2.0), (1, 1.0)):
        ends = [places[np.abs(places[:, axis] - at) < 1e-6] for at in (0.0, end)]
        assert min(map(len, ends)) > 8 and (places[:, axis] > -1e-6).all() and (places[:, axis] < end + 1e-6).all()
        apart = np.linalg.norm((ends[0][:, None] - ends[1][None])[..., [1 - axis, 2]], axis=2)
        assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) < 1e-5
    uses = {}
    for polygon in cells.data.polygons:
        for key in polygon.edge_keys:
            uses[key] = uses.get(key, 0) + 1
    assert max(uses.values()) == 2
    single = [key for key, times in uses.items() if times == 1]
    assert not single if underside else np.abs(places[np.array(single).ravel(), 2]).max() < 1e-6


def test_seamless_says_what_it_needs():
    half = image("Half", np.repeat([[0.2] * 32 + [0.8] * 32], 64, axis=0))
    for make, settings, sentence in (
        (frame_with_hole, {}, "is no rectangle, so that its sides do not fit each other; switch Seamless off"),
        (turned_rectangle, {"equal_cells": True}, "Seamless: equal cells are not; switch one of both off"),
        (turned_rectangle, {"animate": True}, "Seamless: the sweep is not; switch Animate off"),
        (
            turned_rectangle,
            {"sites_source": "IMAGE", "image_name": half.name},
            "Seamless: an image is not; choose other Sites",
        ),
        (unwrapped_cylinder, {"space": "UV"}, "Seamless: only flat rectangles are; choose Outline"),
    ):
        make()
        with pytest.raises(RuntimeError, match=sentence):
            bpy.ops.saddleback.voronoi_2d(seamless=True, count=20, **settings)

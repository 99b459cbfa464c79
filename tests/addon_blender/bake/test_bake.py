# SPDX-License-Identifier: GPL-3.0-or-later
"""Cells as images: what pixels say, depths, tiles, files, and what is refused."""

import os
import re
import tempfile

import bpy
import numpy as np
import pytest
from mathutils import Quaternion
from scenes import add_object, fingerprint, grid_arrays, sphere

from saddleback_blender.bridge.inputs.images_in import read_tiles
from saddleback_blender.core.images.exr import exr_bytes
from saddleback_blender.core.images.png import png_bytes

QUICK = {"iterations": 3, "k": 30}
ALL = {"bake_local_uv": True, "bake_direction": True}


def plate(name="Plate", n=6):
    """The unit square with its own places as a UV map."""
    item = add_object(name, *grid_arrays(n))
    layer = item.data.uv_layers.new(name="Flat")
    corners = np.empty(len(item.data.loops), np.int32)
    item.data.loops.foreach_get("vertex_index", corners)
    places = np.array([vertex.co[:2] for vertex in item.data.vertices], np.float32)
    layer.data.foreach_set("uv", places[corners].ravel())
    return item


def pixels(image):
    """(rows, columns, 4), the first row below."""
    values = np.empty(image.size[0] * image.size[1] * image.channels, np.float32)
    image.pixels.foreach_get(values)
    return values.reshape(image.size[1], image.size[0], -1)


def centers(item):
    made = bpy.data.objects[f"{item.name} Centers"]
    return np.array([made.matrix_world @ vertex.co for vertex in made.data.vertices])


def move_uv(item, faces, offset):
    """Moves the UV places of these faces."""
    data = item.data.uv_layers.active.data
    for face in faces:
        for corner in item.data.polygons[face].loop_indices:
            data[corner].uv = data[corner].uv[0] + offset[0], data[corner].uv[1] + offset[1]


def images():
    return {image.name: pixels(image)[:, :, :3] for image in bpy.data.images if "saddleback_baked" in image}


def test_pixels_say_what_the_diagram_of_the_plane_says():
    item = plate()
    bpy.ops.saddleback.tessellate(count=9, make_centers=True, **QUICK)
    sites = centers(item)[:, :2]
    bpy.ops.saddleback.bake(resolution=96, bits="32", bake_local_uv=True, cell_as="NUMBER")
    found = images()
    assert set(found) == {f"Plate {label}" for label in ("Cell", "Edge Distance", "Height", "Local UV")}
    ticks = (np.arange(96) + 0.5) / 96
    places = np.stack(np.meshgrid(ticks, ticks), axis=2).reshape(-1, 2)
    to_sites = np.linalg.norm(places[:, None] - sites, axis=2)
    own, each = to_sites.argmin(axis=1), np.arange(len(places))
    between = np.linalg.norm(sites[own][:, None] - sites, axis=2)
    between[each, own] = 1.0
    room = (to_sites**2 - to_sites[each, own][:, None] ** 2) / (2 * between)
    room[each, own] = np.inf
    edge = room.min(axis=1)
    foot = places + edge[:, None] * (sites[room.argmin(axis=1)] - sites[own]) / between[each, room.argmin(axis=1), None]
    inside = ((foot > 0) & (foot < 1)).all(axis=1) & (edge > 1e-5)
    assert inside.mean() > 0.8
    assert (found["Plate Cell"].reshape(-1, 3)[inside, 0] == own[inside]).all()
    assert np.allclose(found["Plate Edge Distance"].reshape(-1, 3)[inside, 0], edge[inside], atol=2e-6)
    # The plate lies level: places in cells are along X and Y.
    local = found["Plate Local UV"].reshape(-1, 3)[inside]
    assert np.allclose(local, np.column_stack([places - sites[own], np.zeros(len(own))])[inside], atol=2e-6)


@pytest.mark.parametrize("bits", ["8", "16", "32"])
def test_values_are_as_exact_as_the_depth(bits):
    item = plate()
    bpy.ops.saddleback.tessellate(count=5, **QUICK)
    bpy.ops.saddleback.direction_field(make_arrows=False)
    bpy.ops.saddleback.bake(resolution=64, bits="32", image_prefix="Exact", **ALL)
    bpy.ops.saddleback.bake(resolution=64, bits=bits, **ALL)
    found, step = images(), {"8": 1 / 255, "16": 1 / 65535, "32": 1e-6}[bits]
    for label in ("Cell", "Edge Distance", "Height", "Local UV", "Direction"):
        values, exact = found[f"Plate {label}"], found[f"Exact {label}"]
        image = bpy.data.images[f"Plate {label}"]
        if bits != "32" and label in ("Local UV", "Direction"):
            exact = 0.5 + exact / (2 * image.get("saddleback_reach", 1.0))
        elif bits != "32" and label == "Edge Distance":
            exact = exact / image["saddleback_reach"]
        assert np.abs(values - exact).max() <= 0.51 * step + 1e-6, label
        assert image.is_float == (bits != "8") and image.colorspace_settings.is_data
    assert len(np.unique(found["Plate Edge Distance"])) > {"8": 100, "16": 1000, "32": 1000}[bits]
    assert item.saddleback.bake.told == f"'Plate': 5 cells in 5 images, 64 x 64, {bits} bits"


def test_heights_rise_as_the_looks_do():
    plate()
    bpy.ops.saddleback.tessellate(count=6, make_cells=True, gap=0.02, inset=0.05, thickness=0.1, **QUICK)
    heights = {}
    for profile in ("PANELS", "PEBBLES", "CELLS"):
        bpy.ops.saddleback.bake(resolution=128, bits="32", profile=profile, image_prefix=profile)
        heights[profile] = images()[f"{profile} Height"][:, :, 0]
    edge = images()["CELLS Edge Distance"][:, :, 0]
    assert np.allclose(heights["CELLS"], np.clip((edge - 0.01) / 0.05, 0, 1), atol=1e-5)
    size = np.sqrt(1 / 6)
    assert np.allclose(heights["PANELS"], np.clip((edge - 0.025 * size) / (0.04 * size), 0, 1), atol=1e-4)
    # A pebble goes on rising where a plate is flat, and is round there.
    flat = heights["PANELS"] == 1
    assert heights["PEBBLES"][flat].min() < 0.8 and heights["PEBBLES"].max() > 0.99
    assert bpy.data.images["CELLS Height"]["saddleback_reach"] == pytest.approx(0.1)


def test_heights_as_cells_are_those_that_were_painted():
    item = plate()
    group = item.vertex_groups.new(name="Tall")
    for vertex in item.data.vertices:
        group.add([vertex.index], vertex.co.x, "REPLACE")
    lengths = {"gap": 0.02, "inset": 0.05, "thickness": 0.1, "gap_by": "Tall", "thickness_by": "Tall"}
    bpy.ops.saddleback.tessellate(count=6, make_cells=True, make_centers=True, **lengths, **QUICK)
    bpy.ops.saddleback.bake(resolution=128, bits="32", profile="CELLS", cell_as="NUMBER", image_prefix="CELLS")
    height, edge, cell = (images()[f"CELLS {name}"][:, :, 0] for name in ("Height", "Edge Distance", "Cell"))
    by = centers(item)[:, 0]
    own = by[cell.astype(int)]
    assert np.allclose(height, np.clip((edge - 0.01 * own) / 0.05, 0, 1) * own / by.max(), atol=1e-5)
    assert bpy.data.images["CELLS Height"]["saddleback_reach"] == pytest.approx(0.1 * by.max())


def test_directions_are_those_of_the_field():
    item = plate()
    item.rotation_euler = (0.0, 0.0, 0.5)
    item.data.attributes.new("flow", "FLOAT_VECTOR", "POINT").data.foreach_set(
        "vector", np.tile(np.array([3.0, 4.0, 0.0], np.float32), len(item.data.vertices))
    )
    bpy.ops.saddleback.tessellate(count=3, **QUICK)
    maps = {"bake_cell": False, "bake_edge_distance": False, "bake_height": False, "bake_direction": True}
    for space, expected in (("TANGENT", (0.6, 0.8, 0.0)), ("WORLD", None)):
        bpy.ops.saddleback.bake(resolution=32, bits="32", direction_attribute="flow", direction_space=space, **maps)
        found = images()["Plate Direction"]
        if expected is None:
            expected = np.array(item.matrix_world)[:3, :3] @ (0.6, 0.8, 0.0)
        assert np.allclose(found, expected, atol=1e-6)


def test_places_in_cells_are_level_with_the_world():
    """On a plate that stands upright, where its Y is the world's Z, and on one that is turned in its plane as well."""
    item = plate()
    maps = {"bake_cell": False, "bake_edge_distance": False, "bake_height": False, "bake_local_uv": True}
    for angle in (0.0, 0.7):
        item.rotation_mode = "QUATERNION"
        item.rotation_quaternion = Quaternion((1, 0, 0), 0.5 * np.pi) @ Quaternion((0, 0, 1), angle)
        bpy.ops.saddleback.tessellate(count=1, iterations=0, k=30)
        bpy.ops.saddleback.bake(resolution=64, bits="32", **maps)
        (local,) = (values for name, values in images().items() if "Place" in name or "Local" in name)
        along_u, along_v = local[32, 40] - local[32, 24], local[40, 32] - local[24, 32]
        for step, expected in ((along_u, (np.cos(angle), np.sin(angle))), (along_v, (-np.sin(angle), np.cos(angle)))):
            np.testing.assert_allclose(step[:2] / np.linalg.norm(step[:2]), expected, atol=1e-4)


def test_all_tiles_in_which_faces_lie_are_baked():
    item = plate()
    right = [polygon.index for polygon in item.data.polygons if polygon.center.x > 0.5]
    move_uv(item, right, (1.0, 1.0))
    bpy.ops.saddleback.tessellate(count=6, **QUICK)
    bpy.ops.saddleback.bake(resolution=64, use_tiles=True, margin=0)
    image = bpy.data.images["Plate Edge Distance"]
    assert image.source == "TILED" and [tile.number for tile in image.tiles] == [1001, 1012]
    tiles = {number: colors[:, :, 0] for number, (colors, _) in read_tiles(item, image).items()}
    assert not tiles[1001][:, 32:].any() and not tiles[1012][:, :32].any()
    move_uv(item, right, (-1.0, -1.0))
    bpy.ops.saddleback.bake(resolution=64, margin=0, image_prefix="Whole")
    whole = images()["Whole Edge Distance"][:, :, 0]
    assert np.allclose(tiles[1001][:, :32], whole[:, :32], atol=2e-5)
    assert np.allclose(tiles[1012][:, 32:], whole[:, 32:], atol=2e-5)


def test_a_baked_image_is_a_density():
    item = plate()
    move_uv(item, [p.index for p in item.data.polygons if p.center.x > 0.5], (1.0, 0.0))
    bpy.ops.saddleback.tessellate(count=6, **QUICK)
    bpy.ops.saddleback.bake(resolution=64, use_tiles=True)
    answer = bpy.ops.saddleback.tessellate(
        count=30, density_source="IMAGE", density_image="Plate Height", density_smaller_by=2.0, **QUICK
    )
    assert answer == {"FINISHED"}


@pytest.mark.parametrize("bits", ["16", "32"])
def test_files_lie_in_the_folder(tmp_path, bits):
    item = plate("Jörg's Plate")
    bpy.ops.saddleback.tessellate(count=4, **QUICK)
    bpy.ops.saddleback.bake(resolution=32, bits=bits, folder=str(tmp_path), bake_cell=False)
    suffix = {"16": ".png", "32": ".exr"}[bits]
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [suffix, suffix]
    image = bpy.data.images["Jörg's Plate Edge Distance"]
    assert image.packed_file is None and bpy.path.abspath(image.filepath).startswith(str(tmp_path))
    before = pixels(image).copy()
    assert before[:, :, 0].max() > 0
    bpy.ops.saddleback.tessellate(count=9, **QUICK)
    bpy.ops.saddleback.bake(resolution=32, bits=bits, folder=str(tmp_path), bake_cell=False)
    assert len(list(tmp_path.iterdir())) == 2
    assert not np.array_equal(pixels(bpy.data.images["Jörg's Plate Edge Distance"]), before)
    move_uv(item, [0], (1.0, 0.0))
    bpy.ops.saddleback.bake(resolution=32, bits=bits, folder=str(tmp_path), bake_cell=False, use_tiles=True)
    names = {path.name for path in tmp_path.iterdir()}
    assert {name.split(".")[-2] for name in names if name.count(".") == 2} == {"1001", "1002"}


@pytest.mark.skipif(os.name != "posix", reason="links")
def test_a_link_in_the_place_of_a_file_stays_one(tmp_path):
    plate()
    bpy.ops.saddleback.tessellate(count=4, **QUICK)
    there, elsewhere = tmp_path / "there", tmp_path / "elsewhere"
    there.mkdir()
    elsewhere.mkdir()
    how = {"resolution": 16, "folder": str(there), "bake_cell": False, "bake_height": False}
    bpy.ops.saddleback.bake(**how)
    (link,) = there.iterdir()
    kept = link.rename(elsewhere / link.name)
    before = kept.read_bytes()
    link.symlink_to(kept)
    bpy.ops.saddleback.tessellate(count=9, **QUICK)
    bpy.ops.saddleback.bake(**how)
    assert link.is_symlink() and list(there.iterdir()) == [link] and list(elsewhere.iterdir()) == [kept]
    assert kept.read_bytes() != before


def test_names_of_other_letters_have_room_for_what_the_image_shows():
    """Of 63 bytes, where such a letter takes three."""
    plate(21 * "\u677f")
    bpy.ops.saddleback.tessellate(count=4, **QUICK)
    for _ in range(2):
        bpy.ops.saddleback.bake(resolution=16)
        assert sorted(images()) == [f"{13 * chr(0x677F)} {label}" for label in ("Cell", "Edge Distance", "Height")]


def test_what_shows_an_image_shows_the_next_one():
    plate()
    bpy.ops.saddleback.tessellate(count=4, **QUICK)
    bpy.ops.saddleback.bake(resolution=32)
    material = bpy.data.materials.new("Skin")
    material.use_nodes = True
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images["Plate Height"]
    count = len(bpy.data.images)
    bpy.ops.saddleback.bake(resolution=64)
    assert node.image == bpy.data.images["Plate Height"] and node.image.size[0] == 64
    assert len(bpy.data.images) == count


def test_images_are_kept_in_the_file(tmp_path):
    plate()
    bpy.ops.saddleback.tessellate(count=4, **QUICK)
    bpy.ops.saddleback.bake(resolution=32, **ALL | {"bake_direction": False})
    before = images()
    path = str(tmp_path / "baked.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    after = images()
    assert set(after) == set(before)
    for name in before:
        assert np.array_equal(before[name], after[name])
    # Tomorrow's bake, with nothing in memory, is the same.
    from saddleback_blender.core import cache

    cache.shared.clear()
    assert bpy.ops.saddleback.bake() == {"FINISHED"}
    assert all(np.array_equal(before[name], value) for name, value in images().items())


def test_only_the_region_is_baked():
    item = plate()
    item.data.materials.append(bpy.data.materials.new("Skin"))
    item.data.materials.append(bpy.data.materials.new("Belly"))
    left = np.array([polygon.center.x < 0.5 for polygon in item.data.polygons])
    item.data.polygons.foreach_set("material_index", left.astype(np.int32))
    bpy.ops.saddleback.tessellate(count=4, region="MATERIAL", region_name="Belly", **QUICK)
    bpy.ops.saddleback.bake(resolution=64, margin=0)
    colors = images()["Plate Cell"]
    assert colors[:, :32].any(axis=2).all() and not colors[:, 32:].any()


def test_modifiers_and_mirrored_objects():
    item = plate(n=3)
    item.scale = (-1.0, 2.0, 1.0)
    item.modifiers.new("Finer", "SUBSURF").subdivision_type = "SIMPLE"
    bpy.context.view_layer.update()
    bpy.ops.saddleback.tessellate(count=5, use_modifiers=True, make_centers=True, **QUICK)
    sites = centers(item)[:, :2]
    bpy.ops.saddleback.bake(resolution=50, bits="32", cell_as="NUMBER")
    ticks = (np.arange(50) + 0.5) / 50
    places = np.stack(np.meshgrid(ticks, ticks), axis=2).reshape(-1, 2) * (-1.0, 2.0)
    distance = np.linalg.norm(places[:, None] - sites, axis=2)
    sure = np.diff(np.sort(distance, axis=1)[:, :2], axis=1)[:, 0] > 1e-4
    assert (images()["Plate Cell"].reshape(-1, 3)[sure, 0] == distance.argmin(axis=1)[sure]).all()


def test_cells_on_the_mesh_and_on_what_modifiers_make():
    item = plate(n=3)
    bpy.ops.saddleback.tessellate(count=5, **QUICK)
    item.modifiers.new("Finer", "SUBSURF").subdivision_type = "SIMPLE"
    bpy.ops.saddleback.tessellate(count=7, use_modifiers=True, **QUICK)
    assert bpy.ops.saddleback.bake(resolution=32) == {"FINISHED"}
    assert item.saddleback.bake.told.startswith("'Plate': 7 cells")


def refused(text, **settings):
    before, files = fingerprint(), sorted(image.name for image in bpy.data.images)
    with pytest.raises(RuntimeError, match=text):
        bpy.ops.saddleback.bake(**({"resolution": 64} | settings))
    assert fingerprint() == before and sorted(image.name for image in bpy.data.images) == files


def tessellated(n=6):
    item = plate(n=n)
    bpy.ops.saddleback.tessellate(count=5, **QUICK)
    return item


@pytest.mark.parametrize(
    ("settings", "text"),
    [
        ({"resolution": 0}, "'Plate': images of 0 pixels cannot be baked; choose 1 to 16,384"),
        ({"resolution": 20000}, "images of 20,000 pixels cannot be baked"),
        ({"uv_name": "Other"}, "'Plate' has no UV map 'Other'; unwrap it"),
        ({"bake_cell": False, "bake_edge_distance": False, "bake_height": False}, "no map is chosen"),
        ({"folder": "/nowhere/at all"}, "is no folder that can be written to"),
        ({"bake_direction": True}, "'Plate' has no attribute 'saddleback_direction' for directions"),
    ],
)
def test_settings_that_cannot_be(settings, text):
    tessellated()
    refused(text, **settings)


def test_without_cells_or_a_uv_map():
    item = plate()
    refused("'Plate' has no cells yet to bake: press Tessellate first")
    bpy.ops.saddleback.tessellate(count=5, **QUICK)
    item.data.uv_layers.remove(item.data.uv_layers[0])
    refused("'Plate' has no UV map; unwrap it")


def baked_cells(size=60):
    """The number of the cell in each pixel, and places in the unit square."""
    bpy.ops.saddleback.bake(resolution=size, bits="32", cell_as="NUMBER", margin=0)
    ticks = (np.arange(size) + 0.5) / size
    places = np.stack(np.meshgrid(ticks, ticks), axis=2).reshape(-1, 2)
    return images()["Plate Cell"][:, :, 0].ravel(), places


def assert_nearest(cells, places, sites):
    """Each place has the cell of the site next to it, unless two are about as near."""
    distance = np.linalg.norm(places[:, None] - sites, axis=2)
    sure = np.diff(np.sort(distance, axis=1)[:, :2], axis=1)[:, 0] > 1e-4
    assert sure.mean() > 0.95
    assert (cells[sure] == distance.argmin(axis=1)[sure]).all()


def test_cells_are_those_that_are_seen_whatever_the_settings_are_by_now():
    item = plate()
    bpy.ops.saddleback.tessellate(count=5, make_centers=True, **QUICK)
    sites = centers(item)[:, :2]
    item.saddleback.tessellate.count = 9
    item.saddleback.tessellate.seed = 3
    cells, places = baked_cells()
    assert_nearest(cells, places, sites)


def test_cells_of_another_mesh_are_refused():
    item = tessellated()
    item.data.vertices[10].co.x += 0.02  # a small change of the shape is none of the cells
    bpy.ops.saddleback.bake(resolution=16)
    for vertex in item.data.vertices:
        vertex.co.x *= 5.0
    refused("its cells are not those that are seen, since its mesh or its settings were changed")


def test_cells_that_were_relaxed_live():
    item = plate()
    bpy.ops.saddleback.relax_live(count=9, make_centers=True, **QUICK)
    cells, places = baked_cells()
    assert_nearest(cells, places, centers(item)[:, :2])


def test_mirrored_cells():
    item = plate()
    for vertex in item.data.vertices:
        vertex.co.x -= 0.5
    bpy.ops.saddleback.tessellate(count=16, make_centers=True, mirror_x=True, **QUICK)
    sites = centers(item)[:, :2] + (0.5, 0.0)
    cells, places = baked_cells()
    assert len(np.unique(cells)) == len(sites) and (sites[:, 0] < 0.45).any() and (sites[:, 0] > 0.55).any()
    assert_nearest(cells, places, sites)


def test_mirrored_cells_of_a_file_in_which_their_places_are_not_kept():
    item = plate()
    for vertex in item.data.vertices:
        vertex.co.x -= 0.5
    bpy.ops.saddleback.tessellate(count=16, mirror_x=True, **QUICK)
    item.saddleback.tessellate.property_unset("sites")
    refused("it is not known where its mirrored cells are: press Tessellate first")


def test_kept_places_belong_to_their_layer_and_go_with_the_results():
    item = tessellated()
    first = item.saddleback.tessellate.sites
    bpy.ops.saddleback.layer_add()
    assert not item.saddleback.tessellate.sites
    bpy.ops.saddleback.tessellate(count=7, **QUICK)
    assert item.saddleback.tessellate.sites not in ("", first)
    item.saddleback.layer_index = 0
    assert item.saddleback.tessellate.sites == first
    bpy.ops.saddleback.clear()
    assert not item.saddleback.tessellate.sites


def test_an_image_of_somebody_else():
    tessellated()
    bpy.data.images.new("Plate Height", 4, 4)
    refused("there is an image 'Plate Height' already, which Saddleback did not make")
    assert bpy.data.images["Plate Height"].size[0] == 4


def test_faces_that_overlap():
    item = tessellated()
    move_uv(item, [0, 1], (0.5, 0.5))
    refused(r"'Plate': 4 faces \(0, 1, 21, ...\) overlap others in its UV map; unwrap them side by side")


def test_faces_without_area_and_outside():
    item = tessellated()
    data = item.data.uv_layers.active.data
    for corner in item.data.polygons[7].loop_indices:
        data[corner].uv = (0.3, 0.3)
    move_uv(item, [0], (3.0, 0.0))
    assert bpy.ops.saddleback.bake(resolution=64) == {"FINISHED"}
    for polygon in item.data.polygons:
        for corner in polygon.loop_indices:
            data[corner].uv = (0.3, 0.3)
    refused("no face has an area within the image in its UV map; unwrap the mesh")


def test_numbers_that_have_no_room():
    item = sphere("Ball", 4)
    item.data.uv_layers.new(name="Flat")
    bpy.ops.saddleback.tessellate(count=300, **QUICK)
    refused("has 300 cells, and 8 bits can number 256", bits="8", cell_as="NUMBER")


def test_a_failing_write_leaves_the_file_as_it_was(monkeypatch, tmp_path):
    from saddleback_blender.bridge.outputs import out_images

    tessellated()
    bpy.ops.saddleback.bake(resolution=32, folder=str(tmp_path))
    kept = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def fail(source, target):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(out_images.shutil, "copyfile", fail)
    refused("cannot be saved: No space left on device", resolution=64, folder=str(tmp_path))
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == kept
    assert images()["Plate Height"].shape[0] == 32


def test_a_folder_for_temporary_files_that_takes_none(monkeypatch, tmp_path):
    tessellated()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "none"))
    refused("temporary files on their way: .*; make room")
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    resource = pytest.importorskip("resource", reason="POSIX alone limits the size of files")
    most = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (50, most[1]))
    try:
        refused("temporary files on their way: File too large; make room")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, most)
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_cannot_be_replaced_leaves_all_as_they_were(tmp_path):
    tessellated()
    bpy.ops.saddleback.bake(resolution=32, folder=str(tmp_path))
    in_the_way = max(tmp_path.iterdir())
    in_the_way.unlink()
    in_the_way.mkdir()
    kept = {path.name: path.read_bytes() for path in tmp_path.iterdir() if path != in_the_way}
    assert kept
    refused(f"'{re.escape(str(in_the_way))}' cannot be saved", resolution=64, folder=str(tmp_path))
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir() if path != in_the_way} == kept
    in_the_way.rmdir()
    assert bpy.ops.saddleback.bake(resolution=64, folder=str(tmp_path)) == {"FINISHED"}
    assert {path.name for path in tmp_path.iterdir()} == {in_the_way.name, *kept}


@pytest.mark.parametrize("channels", [1, 3])
@pytest.mark.parametrize("shape", [(1, 1), (3, 5), (70, 33)])
@pytest.mark.parametrize("kind", [np.uint8, np.uint16, np.float32])
def test_blender_reads_what_is_written(tmp_path, channels, shape, kind):
    rng = np.random.default_rng(1)
    values = rng.random((*shape, channels)).astype(np.float32)
    if kind != np.float32:
        values = np.rint(values * np.iinfo(kind).max).astype(kind)
    write = exr_bytes if kind == np.float32 else png_bytes
    path = tmp_path / ("image.exr" if kind == np.float32 else "image.png")
    path.write_bytes(b"".join(write(lambda rows: values[rows], shape[0], lambda: None)))
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.is_data = True
    assert tuple(image.size) == shape[::-1]
    wanted = values / (1.0 if kind == np.float32 else np.iinfo(kind).max)
    assert np.allclose(pixels(image)[:, :, :channels], wanted, atol=1e-6)
    assert image.is_float == (kind != np.uint8)


def test_floats_are_kept_to_the_bit_and_those_that_hardly_pack_are_not_packed(tmp_path):
    """Blocks of 16 rows: numbers of cells, places with a channel of zeros, and noise, which deflate would make a
    hundredth shorter in a third of a second for each million.
    """
    values = np.zeros((48, 256, 3), np.float32)
    values[:16] = np.arange(256)[None, :, None] // 20
    rng = np.random.default_rng(1)
    values[16:32, :, :2], values[32:] = rng.random((16, 256, 2)), 1.0 + rng.random((16, 256, 3))
    path = tmp_path / "image.exr"
    path.write_bytes(b"".join(exr_bytes(lambda rows: values[rows], 48, lambda: None)))
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.is_data = True
    assert (pixels(image)[:, :, :3] == values).all()
    data, plain = path.read_bytes(), values[:16].nbytes
    sizes = [
        int.from_bytes(data[place + 4 : place + 8], "little")
        for place in np.frombuffer(data[data.index(b"screenWindowWidth") + 33 :][:24], "<u8").astype(int)
    ]
    assert sizes[0] == plain and sizes[1] < 0.75 * plain and sizes[2] < 0.05 * plain

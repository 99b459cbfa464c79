# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes made from images show them: bent copies, instances, the cut mesh and attributes know where in the picture."""

import bpy
import numpy as np
import pytest
from scenes import sphere

from saddleback_blender.bridge.outputs.out_collection import find_output, outputs_of

ROWS, COLUMNS = 48, 80
FEW = {"count": 30, "packing": 0.0, "shapes": "IMAGE", "shapes_image": "Flag"}


def flag(kind="transparent"):
    """An image whose colors say where in it they are, and its mask: a shape without any symmetry."""
    mask = np.zeros((ROWS, COLUMNS), bool)
    mask[6:42, 10:30] = mask[6:18, 10:70] = True
    v, u = np.meshgrid((np.arange(ROWS) + 0.5) / ROWS, (np.arange(COLUMNS) + 0.5) / COLUMNS, indexing="ij")
    pixels = np.dstack([u, v, np.zeros_like(u), np.ones_like(u)]).astype(np.float32)
    if kind == "transparent":
        pixels[..., 3] = mask
    elif kind == "dark":
        pixels[..., :3] = np.where(mask, 0.0, 1.0)[..., None]
    image = bpy.data.images.new("Flag", COLUMNS, ROWS, alpha=True, float_buffer=True)
    image.pixels.foreach_set(pixels.ravel())
    return image, mask


def read(domain, name, width=1, dtype=np.float32):
    values = np.empty(width * len(domain), dtype)
    domain.foreach_get(name, values)
    return values.reshape(-1, width) if width > 1 else values


def owners(mesh):
    """(polygons,) the copy of each, -1 for none."""
    return read(mesh.attributes["saddleback_shape"].data, "value", dtype=np.int32).astype(np.int64)


def triangles(mesh, layer):
    """Corner places (t, 3, 2) in the picture and (t, 3, 3) in space of the mesh's triangles, and their polygons."""
    mesh.calc_loop_triangles()
    loops = read(mesh.loop_triangles, "loops", 3, np.int32)
    corner = read(mesh.loops, "vertex_index", dtype=np.int32)
    places = read(mesh.vertices, "co", 3)
    return (
        read(mesh.uv_layers[layer].data, "uv", 2)[loops], places[corner[loops]],
        read(mesh.loop_triangles, "polygon_index", dtype=np.int32),
    )  # fmt: skip


def signed(uv):
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    return 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def lets_through(material):
    """Tells whether the image's alpha is the material's; else it is how much of the color is the image's."""
    (shader,) = (node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    (color,) = shader.inputs["Base Color"].links
    if shader.inputs["Alpha"].is_linked:
        assert color.from_node == shader.inputs["Alpha"].links[0].from_node
        return True
    alpha, plain, image = color.from_node.inputs[:3]
    assert alpha.links[0].from_socket.name == "Alpha" and image.links[0].from_socket.name == "Color"
    assert alpha.links[0].from_node == image.links[0].from_node and plain.default_value[0] > 0.1
    return False


def seen_from_outside(places):
    """(t,) above 0 where the corners of triangles (t, 3, 3) run round counter-clockwise, seen from out of a sphere."""
    normals = np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0])
    return np.einsum("ti,ti->t", normals, places.mean(axis=1)) / np.linalg.norm(normals, axis=1)


def assert_shows(mask, uv, owner, count, mirrored=()):
    """Triangles (t, 3, 2) of each of `count` copies cover the mask once, and nothing else."""
    middle = uv.mean(axis=1) * (COLUMNS, ROWS)
    assert (middle > 0).all() and (middle < (COLUMNS, ROWS)).all()
    near = np.zeros_like(mask)  # outlines are smooth: they may be off by a pixel
    for row, column in np.ndindex(3, 3):
        near |= np.roll(mask, (row - 1, column - 1), (0, 1))
    columns, rows = middle.astype(int).T
    assert near[rows, columns].all()
    area = np.bincount(owner, signed(uv), count) * COLUMNS * ROWS
    sign = np.where(np.isin(np.arange(count), mirrored), -1, 1)
    np.testing.assert_allclose(area * sign, mask.sum(), rtol=0.04)


def test_bent_copies_and_their_sides():
    image, mask = flag()
    item = sphere("Host", subdivisions=5)
    assert bpy.ops.saddleback.distribute(**FEW) == {"FINISHED"}
    (output,) = outputs_of(item)
    mesh = output.data
    top, side = mesh.materials
    assert [material.name for material in (top, side)] == ["Flag", "Flag Opaque"]
    uv, places, polygon = triangles(mesh, "UVMap")
    slot = read(mesh.polygons, "material_index", dtype=np.int32)[polygon]
    copy = owners(mesh)[polygon]
    assert_shows(mask, uv[slot == 0], copy[slot == 0], 30)
    outwards = seen_from_outside(places)
    assert (outwards[slot == 0] > 0.8).all() and (np.abs(outwards[slot == 1]) < 0.5).all() and (slot == 1).any()
    for material, is_transparent in ((top, True), (side, False)):
        nodes = {node.type: node for node in material.node_tree.nodes}
        assert nodes["TEX_IMAGE"].image == image and nodes["UVMAP"].uv_map == "UVMap"
        assert nodes["BSDF_PRINCIPLED"].inputs["Base Color"].is_linked
        assert lets_through(material) == is_transparent
        assert material.diffuse_color[0] == pytest.approx(0.5 * mask.nonzero()[1].mean() / COLUMNS * 2, abs=0.02)
    # What the artist makes of the materials stays, and no more of them come.
    side.diffuse_color = (0, 0, 1, 1)
    materials = set(bpy.data.materials)
    assert bpy.ops.saddleback.distribute(seed=7, **FEW) == {"FINISHED"}
    assert set(bpy.data.materials) == materials and tuple(side.diffuse_color) == (0, 0, 1, 1)


def test_a_picture_that_takes_anothers_name_gets_a_material_of_its_own():
    first, _ = flag()
    item = sphere("Host", subdivisions=4)
    bpy.ops.saddleback.distribute(**FEW)
    first.name = "Old"
    second, _ = flag()
    bpy.ops.saddleback.distribute(**FEW)
    shown = outputs_of(item)[0].data.materials[0].node_tree.nodes
    assert [node.image for node in shown if node.type == "TEX_IMAGE"] == [second]


@pytest.mark.parametrize("kind", ["dark", "photograph"])
def test_pictures_without_transparency(kind):
    _, mask = flag(kind)
    item = sphere("Host", subdivisions=5)
    assert bpy.ops.saddleback.distribute(**FEW) == {"FINISHED"}
    mesh = outputs_of(item)[0].data
    assert len(set(mesh.materials)) == 1
    uv, _, polygon = triangles(mesh, "UVMap")
    is_top = read(mesh.polygons, "material_index", dtype=np.int32)[polygon] == 0
    copy = owners(mesh)[polygon]
    seen = mask if kind == "dark" else np.ones_like(mask)
    assert_shows(seen, np.clip(uv[is_top], 1e-9, 1 - 1e-9), copy[is_top], 30)


def sticker(image):
    """A collection in which an empty shows the image."""
    empty = bpy.data.objects.new("Sticker", None)
    empty.empty_display_type, empty.data = "IMAGE", image
    shapes = bpy.data.collections.new("Shapes")
    bpy.context.scene.collection.children.link(shapes)
    shapes.objects.link(empty)
    return FEW | {"shapes": "COLLECTION", "shapes_collection": "Shapes", "size": 0.15}


def test_mirrored_copies_show_the_picture_mirrored():
    image, mask = flag()
    few = sticker(image)
    item = sphere("Host", subdivisions=5)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.symmetrize(direction="POSITIVE_X")
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.ops.saddleback.distribute(mirror_x=True, **few) == {"FINISHED"}
    mesh = find_output(item, "shapes").data
    uv, places, polygon = triangles(mesh, "UVMap")
    is_top = read(mesh.polygons, "material_index", dtype=np.int32)[polygon] == 0
    uv, places, copy = uv[is_top], places[is_top], owners(mesh)[polygon][is_top]
    count = copy.max() + 1
    turned = np.flatnonzero(np.bincount(copy, signed(uv), count) < 0)
    is_left = np.bincount(copy, places.mean(axis=1)[:, 0], count) < 0
    assert 2 * len(turned) == count >= 20 and len(set(is_left[turned])) == 1
    assert_shows(mask, uv, copy, count, turned)


@pytest.mark.parametrize("scale", [(1, 1, 1), (1, 1, -1)])
def test_instances_cut_mesh_and_attributes(scale):
    image, mask = flag()
    few = sticker(image)
    item = sphere("Host", subdivisions=5)
    item.scale = scale
    assert bpy.ops.saddleback.distribute(
        make_instances=True, make_cut=True, make_bent=False, write_attributes=True, **few
    ) == {"FINISHED"}  # fmt: skip
    template = next(
        other for other in bpy.data.objects if str(other.get("saddleback_role", "")).startswith("shape tem")
    )
    uv, _, _ = triangles(template.data, "UVMap")
    assert_shows(mask, uv, np.zeros(len(uv), int), 1)
    assert template.data.materials[0].name == "Flag"

    cut = find_output(item, "shape cut").data
    uv, places, polygon = triangles(cut, "saddleback_shape_uv")
    copy = owners(cut)[polygon]
    inside = copy >= 0
    is_turned = seen_from_outside(places[inside] @ np.array(find_output(item, "shape cut").matrix_world)[:3, :3].T) < 0
    assert_shows(mask, np.where(is_turned[:, None, None], uv[inside][:, ::-1], uv[inside]), copy[inside], 30)
    slot = read(cut.polygons, "material_index", dtype=np.int32)[polygon]
    (own,) = {cut.materials[number] for number in np.unique(slot[inside])}
    (places,) = (node for node in own.node_tree.nodes if node.type == "UVMAP")
    assert places.uv_map == "saddleback_shape_uv" and not lets_through(own)

    inside = read(item.data.attributes["saddleback_outline_distance"].data, "value") < 0
    places = read(item.data.attributes["saddleback_shape_uv"].data, "vector", 2)
    columns, rows = (places[inside] * (COLUMNS, ROWS)).astype(int).T
    assert inside.sum() > 100 and mask[rows, columns].mean() > 0.97

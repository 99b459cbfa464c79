# SPDX-License-Identifier: GPL-3.0-or-later
"""Flow maps, painted or in images, and vectors: which way shapes point, and what the field follows."""

import bpy
import numpy as np
import pytest
from scenes import add_object, fingerprint, grid_arrays, sphere

from saddleback_blender.bridge.inputs.directions_in import read_directions, read_image_flow, read_painted_flow

AHEAD = (0.6, 0.8)  # to the right and upwards
WRITTEN = "saddleback_direction"
FEW = {"count": 10, "packing": 0.0}


def plate(mirrored=False):
    """The unit square with its own places as a UV map."""
    item = add_object("Plate", *grid_arrays(4))
    corners = np.array([loop.vertex_index for loop in item.data.loops])
    places = np.array([vertex.co[:2] for vertex in item.data.vertices], np.float32)
    item.data.uv_layers.new(name="Flat").data.foreach_set("uv", places[corners].ravel())
    item.rotation_euler = (0.0, 0.0, 0.3)
    item.scale = (-2.0 if mirrored else 1.0, 1.0, 1.0)
    bpy.context.view_layer.update()
    return item


def paint(item, kind, domain, flow=AHEAD):
    layer = item.data.color_attributes.new("Flow", kind, domain)
    color = np.array([0.5 + 0.5 * flow[0], 0.5 + 0.5 * flow[1], 0.5, 1.0], np.float32)
    element = "color_srgb" if kind == "BYTE_COLOR" else "color"
    layer.data.foreach_set(element, np.tile(color, len(layer.data)))


def image_of(flow=AHEAD):
    image = bpy.data.images.new("Flow", 4, 4, float_buffer=True)
    image.pixels.foreach_set(np.tile(np.array([0.5 + 0.5 * flow[0], 0.5 + 0.5 * flow[1], 0.5, 1.0], np.float32), 16))
    return image


def on_plate(item, right=AHEAD[0], up=AHEAD[1]):
    """The flow by the axes of the plate: its X, and at right angles to that."""
    _, rotation, _ = item.matrix_world.decompose()
    x, y = (np.array(rotation.inverted() @ axis.normalized()) for axis in item.matrix_world.to_3x3().col[:2])
    return right * x + up * y


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("kind", ["BYTE_COLOR", "FLOAT_COLOR"])
@pytest.mark.parametrize("domain", ["POINT", "CORNER"])
def test_colors_point_by_the_uv_map(kind, domain, mirrored):
    item = plate(mirrored)
    paint(item, kind, domain)
    found = read_painted_flow(item, item.data, "Flow")
    assert found.vectors.shape == (16, 3) and found.symmetry == 1
    assert np.allclose(found.vectors, on_plate(item), atol=5e-3)
    assert bpy.ops.saddleback.distribute(field_source="COLOR", direction_color="Flow", **FEW) == {"FINISHED"}
    assert item.saddleback.distribute.direction_color == "Flow"


def test_an_image_points_by_the_uv_map():
    item = plate()
    image_of()
    assert np.allclose(read_image_flow(item, item.data, "Flow").vectors, on_plate(item), atol=1e-6)
    assert bpy.ops.saddleback.distribute(field_source="IMAGE", direction_image="Flow", **FEW) == {"FINISHED"}
    assert item.saddleback.distribute.direction_image == bpy.data.images["Flow"]


@pytest.mark.parametrize("bits", ["8", "16"])
def test_a_baked_field_is_read_as_it_was(bits):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12)
    item = bpy.context.active_object
    item.name = "Ball"
    bpy.ops.saddleback.direction_field(make_arrows=False)
    bpy.ops.saddleback.tessellate(count=4, iterations=1, k=30)
    maps = {"bake_cell": False, "bake_edge_distance": False, "bake_height": False, "bake_direction": True}
    bpy.ops.saddleback.bake(resolution=512, bits=bits, **maps)
    given = read_directions(item, item.data, "saddleback_direction").vectors
    wanted = np.array([given[list(polygon.vertices)].mean(axis=0) for polygon in item.data.polygons])
    found = read_image_flow(item, item.data, "Ball Direction").vectors
    middle = np.array([0.2 < abs(polygon.center.z) < 0.8 for polygon in item.data.polygons])
    cosine = np.einsum("ij,ij->i", wanted, found) / np.linalg.norm(wanted, axis=1) / np.linalg.norm(found, axis=1)
    assert np.quantile(cosine[middle], 0.05) > 0.95 and np.median(cosine[middle]) > 0.99


def refused(text, **settings):
    before = fingerprint()
    with pytest.raises(RuntimeError, match=text):
        bpy.ops.saddleback.distribute(**FEW, **settings)
    assert fingerprint() == before


def test_what_is_not_there_is_refused():
    item = plate()
    refused("'Plate' has no color attribute for directions; paint one or choose another field", field_source="COLOR")
    refused("no image is chosen for directions", field_source="IMAGE")
    paint(item, "FLOAT_COLOR", "POINT", (0.0, 0.0))
    refused("color attribute 'Flow' has no direction along the surface on 32 of 32 faces", field_source="COLOR")
    image_of()
    item.data.uv_layers.remove(item.data.uv_layers[0])
    refused("'Plate' has no UV map to tell directions by", field_source="COLOR", direction_color="Flow")
    refused("'Plate' has no UV map to tell directions by", field_source="IMAGE", direction_image="Flow")


def add_vectors(item, name, domain, values):
    layer = item.data.attributes.new(name, "FLOAT_VECTOR", domain)
    layer.data.foreach_set("vector", np.ascontiguousarray(values, np.float32).ravel())


def written(item, name=WRITTEN):
    layer = item.data.attributes[name]
    values = np.empty(3 * len(layer.data), np.float32)
    layer.data.foreach_get("vector", values)
    return values.reshape(-1, 3)


@pytest.mark.parametrize("domain", ["POINT", "FACE"])
@pytest.mark.parametrize("singularities", ["AUTO", "EMPTIES"])
def test_a_field_follows_the_half_that_is_said(domain, singularities):
    item = sphere(subdivisions=4)
    if singularities == "EMPTIES":
        for name, place in (("North", (0, 0, 1)), ("South", (0, 0, -1))):
            empty = bpy.data.objects.new(name, None)
            bpy.context.scene.collection.objects.link(empty)
            empty.parent, empty.location = item, place
        bpy.context.view_layer.update()
    places = (
        np.array([vertex.co for vertex in item.data.vertices])
        if domain == "POINT"
        else np.array([polygon.center for polygon in item.data.polygons])
    )
    east = np.cross((0.0, 0.0, 1.0), places)
    said = (places[:, 0] > 0.3) & (abs(places[:, 2]) < 0.7)
    add_vectors(item, "wanted", domain, np.where(said[:, None], east, 0.0))
    call = {"painted": "ATTRIBUTE", "painted_attribute": "wanted", "domain": domain, "singularities": singularities}
    assert bpy.ops.saddleback.direction_field(**call) == {"FINISHED"}
    north = np.cross(places, east)  # vectors at vertices lie in a face's plane: what leans outward does not count
    found = written(item)
    off = np.arctan2((found * north).sum(axis=1), (found * east).sum(axis=1))
    assert abs(np.degrees(off[said])).mean() < 1
    before = written(item)
    bpy.ops.saddleback.direction_field(**call, painted_weight=1e-3)
    assert abs(written(item) - before).max() > 1e-3


@pytest.mark.parametrize("kind", ["COLOR", "IMAGE"])
def test_flow_maps_comb_the_surface(kind):
    item = plate()
    if kind == "COLOR":
        paint(item, "FLOAT_COLOR", "POINT")
    else:
        image_of()
    name = "painted_color" if kind == "COLOR" else "painted_image"
    assert bpy.ops.saddleback.direction_field(painted=kind, **{name: "Flow"}) == {"FINISHED"}
    assert np.allclose(written(item), on_plate(item), atol=5e-3)
    bpy.ops.saddleback.distribute(count=10, packing=0.0)  # by the same field, which the panel says
    assert item.saddleback.direction_field.painted == kind


def test_what_the_field_cannot_follow_is_told():
    item = sphere(subdivisions=2)
    add_vectors(item, "none", "POINT", np.zeros((len(item.data.vertices), 3)))
    add_vectors(item, "outward", "POINT", [vertex.co for vertex in item.data.vertices])
    before = fingerprint()
    for call, text in (
        ({"painted": "ATTRIBUTE"}, "needs the name of an attribute for directions"),
        ({"painted": "ATTRIBUTE", "painted_attribute": "none"}, "has no direction along the surface anywhere"),
        ({"painted": "ATTRIBUTE", "painted_attribute": WRITTEN}, "would be written over attribute"),
        ({"painted": "COLOR"}, "has no color attribute"),
        ({"painted": "IMAGE"}, "no image is chosen for directions"),
    ):
        with pytest.raises(RuntimeError, match=text):
            bpy.ops.saddleback.direction_field(**call)
        assert fingerprint() == before

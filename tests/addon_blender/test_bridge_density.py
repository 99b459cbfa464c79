# SPDX-License-Identifier: GPL-3.0-or-later
"""What was painted is read from every source as one number a vertex."""

import bpy
import numpy as np
import pytest
from scenes import grid

from saddleback_blender.bridge.inputs.density import read_density
from saddleback_blender.core.errors import BadInputError
from saddleback_blender.core.settings import TessellateSettings


@pytest.fixture
def item():
    return grid(n=4)


def density(item, **settings):
    return read_density(item, item.data, TessellateSettings(**settings))


def paint_group(item, weights, name="Paint"):
    group = item.vertex_groups.new(name=name)
    for vertex, weight in enumerate(weights):
        if weight > 0:
            group.add([vertex], float(weight), "REPLACE")
    return group


def ramp(item):
    return np.array([vertex.co.x for vertex in item.data.vertices])


def test_uniform_is_none(item):
    assert density(item, density_source="UNIFORM") is None


def test_vertex_group_by_name_and_active(item):
    paint_group(item, 1 - ramp(item), "Other")
    paint_group(item, ramp(item))
    item.vertex_groups.active = item.vertex_groups["Other"]
    named = density(item, density_source="VERTEX_GROUP", density_name="Paint")
    active = density(item, density_source="VERTEX_GROUP")
    np.testing.assert_allclose(named, ramp(item), atol=1e-6)
    np.testing.assert_allclose(active, 1 - ramp(item), atol=1e-6)


def test_invert_and_contrast(item):
    paint_group(item, ramp(item))
    options = {"density_source": "VERTEX_GROUP", "density_name": "Paint"}
    np.testing.assert_allclose(density(item, **options, density_invert=True), 1 - ramp(item), atol=1e-6)
    np.testing.assert_allclose(density(item, **options, density_contrast=2.0), ramp(item) ** 2, atol=1e-6)
    np.testing.assert_allclose(density(item, **options, density_contrast=0.0), 1.0)


@pytest.mark.parametrize("kind", ["FLOAT", "INT", "INT8", "BOOLEAN"])
def test_number_attributes_of_vertices(item, kind):
    values = np.arange(len(item.data.vertices)) % 2
    attribute = item.data.attributes.new("Wanted", kind, "POINT")
    for element, value in zip(attribute.data, values, strict=True):
        element.value = value
    np.testing.assert_array_equal(density(item, density_source="ATTRIBUTE", density_name="Wanted"), values)


@pytest.mark.parametrize("domain", ["EDGE", "FACE", "CORNER"])
def test_other_domains_are_averaged(item, domain):
    attribute = item.data.attributes.new("Wanted", "FLOAT", domain)
    rng = np.random.default_rng(1)
    values = rng.random(len(attribute.data)).astype(np.float32)
    attribute.data.foreach_set("value", values)
    mesh = item.data
    around = [[] for _ in mesh.vertices]  # the plain definition: the mean of the elements at each vertex
    if domain == "EDGE":
        for edge in mesh.edges:
            for vertex in edge.vertices:
                around[vertex].append(values[edge.index])
    for polygon in mesh.polygons:
        for corner in polygon.loop_indices:
            if domain == "FACE":
                around[mesh.loops[corner].vertex_index].append(values[polygon.index])
            elif domain == "CORNER":
                around[mesh.loops[corner].vertex_index].append(values[corner])
    expected = [np.mean(found) for found in around]
    np.testing.assert_allclose(density(item, density_source="ATTRIBUTE", density_name="Wanted"), expected, rtol=1e-6)


@pytest.mark.parametrize("domain", ["POINT", "CORNER"])
def test_colors_are_read_linear_by_channel(item, domain):
    attribute = item.data.color_attributes.new("Paint", "FLOAT_COLOR", domain)
    for element in attribute.data:
        element.color = (0.1, 0.4, 0.8, 0.5)
    item.data.color_attributes.active_color = attribute
    expected = {"R": 0.1, "G": 0.4, "B": 0.8, "A": 0.5, "LUMINANCE": 0.2126 * 0.1 + 0.7152 * 0.4 + 0.0722 * 0.8}
    for channel, value in expected.items():
        found = density(item, density_source="COLOR", density_channel=channel)
        np.testing.assert_allclose(found, value, rtol=1e-5)


def test_byte_colors_are_linear_too(item):
    attribute = item.data.color_attributes.new("Paint", "BYTE_COLOR", "POINT")
    for element in attribute.data:
        element.color_srgb = (0.5, 0.5, 0.5, 1.0)  # what the artist picks
    found = density(item, density_source="COLOR", density_name="Paint")
    np.testing.assert_allclose(found, 0.2140, atol=3e-3)  # sRGB 0.5 in linear light


def paint_mask(item, values):
    """A sculpt mask, in the way of the Blender at hand."""
    if hasattr(item.data, "vertex_paint_masks"):
        import bmesh

        mesh = bmesh.new()
        mesh.from_mesh(item.data)
        layer = mesh.verts.layers.paint_mask.verify()
        for vertex, value in zip(mesh.verts, values, strict=True):
            vertex[layer] = value
        mesh.to_mesh(item.data)
        mesh.free()
    else:
        item.data.attributes.new(".sculpt_mask", "FLOAT", "POINT").data.foreach_set("value", values)


def test_sculpt_mask(item):
    paint_mask(item, ramp(item).astype(np.float32))
    np.testing.assert_allclose(density(item, density_source="MASK"), ramp(item), atol=1e-6)


def test_weights_of_the_evaluated_mesh(item):
    paint_group(item, ramp(item))
    item.modifiers.new("Subdivision", "SUBSURF").levels = 1
    from saddleback_blender.bridge.inputs.mesh_in import mesh_of

    with mesh_of(bpy.context, item, True) as mesh:
        found = read_density(item, mesh, TessellateSettings(density_source="VERTEX_GROUP", density_name="Paint"))
        x = np.array([vertex.co.x for vertex in mesh.vertices])
    inner = (x > 0.2) & (x < 0.8)  # at the rim the subdivision moves the vertices, not the weights
    np.testing.assert_allclose(found[inner], x[inner], atol=0.03)


@pytest.mark.parametrize(
    ("settings", "sentence"),
    [
        ({"density_source": "VERTEX_GROUP"}, "'Grid' has no vertex group;"),
        ({"density_source": "VERTEX_GROUP", "density_name": "Gone"}, "'Grid' has no vertex group 'Gone';"),
        ({"density_source": "ATTRIBUTE"}, "'Grid' needs the name of an attribute"),
        ({"density_source": "ATTRIBUTE", "density_name": "Gone"}, "'Grid' has no attribute 'Gone' for the density;"),
        ({"density_source": "COLOR"}, "'Grid' has no color attribute;"),
        ({"density_source": "COLOR", "density_name": "Gone"}, "'Grid' has no color attribute 'Gone';"),
        ({"density_source": "MASK"}, "'Grid' has no sculpt mask;"),
    ],
)
def test_missing_paint_is_named(item, settings, sentence):
    with pytest.raises(BadInputError) as caught:
        density(item, **settings)
    assert str(caught.value).startswith(sentence)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (0.0, "zero everywhere"),
        (-1.0, "-1 at vertex 0"),
        (float("nan"), "nan at vertex 0"),
        (float("inf"), "inf at vertex 0"),
    ],
)
def test_useless_paint_is_refused(item, values, words):
    attribute = item.data.attributes.new("Wanted", "FLOAT", "POINT")
    attribute.data.foreach_set("value", np.full(len(attribute.data), values, np.float32))
    with pytest.raises(BadInputError, match=f"'Grid': attribute 'Wanted' .*{words}"):
        density(item, density_source="ATTRIBUTE", density_name="Wanted")


def test_a_vector_attribute_is_no_number(item):
    item.data.attributes.new("Wanted", "FLOAT_VECTOR", "POINT")
    with pytest.raises(BadInputError, match="holds float vectors, not numbers"):
        density(item, density_source="ATTRIBUTE", density_name="Wanted")

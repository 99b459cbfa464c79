# SPDX-License-Identifier: GPL-3.0-or-later
"""Collection instances as shapes: what an empty shows is laid on the surface as one."""

import bpy
import numpy as np
import pytest
from scenes import add_object, fingerprint, positions, sphere

from saddleback_blender.bridge.inputs.shapes_in import read_templates
from saddleback_blender.core.settings import DistributeSettings

FEW = {"count": 12, "packing": 0.0, "field_source": "NONE", "shapes": "COLLECTION", "shapes_collection": "Shapes"}
BOX = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0.0, 0.4)]
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def kit():
    """Two boxes side by side, each of its own material, in a collection that an empty in "Shapes" shows."""
    parts, shapes = bpy.data.collections.new("Parts"), bpy.data.collections.new("Shapes")
    bpy.context.scene.collection.children.link(shapes)
    for number, name in enumerate(("Left", "Right")):
        item = add_object(name, BOX, SIDES, active=False)
        item.location.x = (-0.5, 0.5)[number]
        item.data.materials.append(bpy.data.materials.new(f"{name} Paint"))
        bpy.context.scene.collection.objects.unlink(item)
        parts.objects.link(item)
    empty = bpy.data.objects.new("Kit", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", parts
    empty.scale, empty.location = (2.0, 3.0, 1.0), (5.0, 5.0, 5.0)
    shapes.objects.link(empty)
    bpy.context.view_layer.update()
    return empty


@pytest.mark.parametrize("hidden", [False, True])
def test_a_collection_instance_is_one_shape(hidden):
    empty = kit()
    if hidden:
        empty.hide_viewport = True
    ball = sphere("Ball", 4)
    (template,) = read_templates(bpy.context, ball, DistributeSettings(shapes="COLLECTION", shapes_collection="Shapes"))
    outline = np.concatenate([loop for part in template.parts for loop in part])
    assert np.ptp(outline[:, 0]) / np.ptp(outline[:, 1]) == pytest.approx(4.0 / 3.0, rel=1e-2)
    assert len(template.solid.offsets) == 13 and template.materials == ("Left Paint", "Right Paint")
    assert len(bpy.data.objects) == 4


def test_what_has_no_faces_in_it_is_left_out():
    empty = kit()
    empty.instance_collection.objects.link(bpy.data.objects.new("Line", bpy.data.curves.new("Line", "CURVE")))
    bpy.context.view_layer.update()
    ball = sphere("Ball", 4)
    (template,) = read_templates(bpy.context, ball, DistributeSettings(shapes="COLLECTION", shapes_collection="Shapes"))
    assert len(template.solid.offsets) == 13


def test_its_copies_have_its_materials():
    kit()
    ball = sphere("Ball", 4)
    bpy.ops.saddleback.distribute(make_instances=True, make_bent=True, **FEW)
    bent = bpy.data.objects["Ball Shapes"]
    names = [material.name for material in bent.data.materials]
    assert names == ["Left Paint", "Right Paint"]
    used = np.empty(len(bent.data.polygons), np.int32)
    bent.data.polygons.foreach_get("material_index", used)
    assert 0.4 < used.mean() < 0.6
    assert np.linalg.norm(positions(bent.data), axis=1).min() > 0.9
    template = next(item for item in bpy.data.objects if "template" in str(item.get("saddleback_role", "")))
    assert [material.name for material in template.data.materials] == names
    assert len(bpy.data.objects) > 4 and ball.saddleback.distribute.told


def test_an_instance_without_faces_is_refused():
    empty = kit()
    for item in list(empty.instance_collection.objects):
        bpy.data.objects.remove(item)
    sphere("Ball", 3)
    before = fingerprint()
    with pytest.raises(RuntimeError, match="'Ball': shape 'Kit' shows no faces; put a mesh into 'Parts'"):
        bpy.ops.saddleback.distribute(**FEW)
    assert fingerprint() == before

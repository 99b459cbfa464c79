# SPDX-License-Identifier: GPL-3.0-or-later
"""What is made of an object is the same to the bit wherever it stands and however it is turned."""

import bpy
import numpy as np
import pytest
from mathutils import Matrix, Vector
from mathutils.kdtree import KDTree
from scenes import add_object, positions

from saddleback_blender.bridge.outputs.out_collection import outputs_of
from tests import meshes

SCALE = (1.3, -0.7, 2.1)
PLACES = {
    "turned": Matrix.Translation((3.0, -2.0, 1.0)) @ Matrix.Rotation(0.7, 4, (1, 2, 3)),
    "far": Matrix.Translation((131072.5, -262144.0, 32768.25)) @ Matrix.Rotation(2.5, 4, (3, -1, 1)),
}


def source():
    vertices, triangles = meshes.icosphere(4)
    item = add_object("Thing", vertices * (1 + 0.2 * np.sin(5 * vertices[:, :1])), triangles)
    item.scale = SCALE
    group = item.vertex_groups.new(name="Some")
    for vertex in item.data.vertices:
        group.add([vertex.index], 0.2 + 0.4 * (1 + vertex.co.z), "REPLACE")
    for z in (1.1, -0.9):
        empty = bpy.data.objects.new("Pole", None)
        bpy.context.scene.collection.objects.link(empty)
        empty.parent, empty.location = item, (0.0, 0.3, z)
    curve = bpy.data.curves.new("Stroke", "CURVE")
    curve.dimensions = "3D"
    points = curve.splines.new("POLY").points
    points.add(30)
    middles = [face.center.copy() for face in item.data.polygons]
    for number, point in enumerate(points):  # through the middles of triangles, where nothing is a near thing
        along = Matrix.Rotation(0.05 * number, 3, "Z") @ Vector((1.0, 0.0, 0.0))
        point.co = (*min(middles, key=lambda middle, along=along: (middle - along).length), 1)
    stroke = bpy.data.objects.new("Stroke", curve)
    bpy.context.scene.collection.objects.link(stroke)
    stroke.parent = item
    bpy.context.view_layer.update()
    return item


def put(item, place):
    location, rotation, _ = place.decompose()
    item.rotation_mode = "QUATERNION"
    item.location, item.rotation_quaternion = location, rotation
    bpy.context.view_layer.update()


def corners_of(output):
    """(n, 3) places of the output's points, and directions, in its space."""
    if isinstance(output.data, bpy.types.Curve):
        return np.array([point.co[:3] for spline in output.data.splines for point in spline.points])
    field = output.data.attributes.get("saddleback_direction")
    vectors = np.array([entry.vector for entry in field.data] if field else []).reshape(-1, 3)
    return np.concatenate([positions(output.data), vectors])


def made(item):
    """Shapes and attributes of the object's outputs, and its own attributes."""
    found = {}
    for output in [item, *outputs_of(item)]:
        data = output.data
        if isinstance(data, bpy.types.Curve):
            found[output.name] = [tuple(point.co) for spline in data.splines for point in spline.points]
            continue
        found[output.name] = positions(data).tobytes(), [tuple(polygon.vertices) for polygon in data.polygons]
        for attribute in data.attributes:
            if attribute.name.startswith("saddleback"):
                found[output.name, attribute.name] = [
                    tuple(getattr(entry, "vector", ())) or getattr(entry, "value", None) for entry in attribute.data
                ]
    return found


ALL = {"make_edges": True, "make_cells": True, "make_centers": True, "make_dual": True, "gap": 0.02, "thickness": 0.05}
RUNS = {
    "cells": lambda: bpy.ops.saddleback.tessellate(count=40, iterations=5, **ALL),
    "shell": lambda: bpy.ops.saddleback.tessellate(count=30, iterations=5, make_shell=True, make_edges=False),
    "density": lambda: bpy.ops.saddleback.tessellate(
        count=30, density_source="VERTEX_GROUP", density_name="Some", edge_kind="CURVE"
    ),
    "shapes": lambda: bpy.ops.saddleback.distribute(count=30, shapes="SCALES", make_bent=True, overlap=0.2),
    "instances": lambda: bpy.ops.saddleback.distribute(count=30, make_instances=True, make_outlines=True),
    "field": lambda: bpy.ops.saddleback.direction_field(make_arrows=True, make_streamlines=True),
    "distance": lambda: bpy.ops.saddleback.distance(sources="VERTEX_GROUP", sources_group="Some", make_isolines=True),
}


# What stands in the world beside the object: Blender's single precision tells where.
BESIDE = {
    "strokes": lambda: bpy.ops.saddleback.direction_field(strokes="COLLECTION", singularities="EMPTIES"),
    "paths": lambda: bpy.ops.saddleback.path(points="EMPTIES", connect="PAIRS"),
    "curves": lambda: bpy.ops.saddleback.distance(sources="CURVES", make_isolines=True),
    "ribbon": lambda: bpy.ops.saddleback.ribbon(width=0.1),
}


@pytest.mark.parametrize("run", RUNS)
def test_it_is_the_same_to_the_bit(run):
    item = source()
    RUNS[run]()
    here = made(item)
    for name, place in PLACES.items():
        put(item, place)
        RUNS[run]()
        there = made(item)
        assert here.keys() == there.keys() and len(here) > 1
        assert [what for what, values in here.items() if values != there[what]] == [], name


@pytest.mark.parametrize("run", BESIDE)
def test_what_is_beside_the_object_goes_with_it(run):
    item = source()
    BESIDE[run]()
    here = [(output.name, corners_of(output)) for output in [item, *outputs_of(item)]]
    put(item, PLACES["turned"])
    BESIDE[run]()
    assert len(here) > 1
    for name, places in here:
        found = corners_of(bpy.data.objects[name])
        assert max(farthest(found, places), farthest(places, found)) < 0.02, name


def farthest(places, others):
    """The largest distance of a place from the nearest of others."""
    tree = KDTree(len(others))
    for number, other in enumerate(others):
        tree.insert(other, number)
    tree.balance()
    return max(tree.find(place)[2] for place in places)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group that puts shapes on points."""

from __future__ import annotations

import bpy

from .nodes import (
    CLASS_ATTRIBUTE,
    ROTATION_ATTRIBUTE,
    SCALE_ATTRIBUTE,
    SHAPES,
    lay_out,
    new_group,
    put_group,
)
from .wiring import Wiring


def set_shapes(item: bpy.types.Object, shapes: list[bpy.types.Object]) -> bpy.types.Modifier:
    """Puts on each point the object of its class, turned and scaled by the point's attributes.

    The objects stand on the nodes of a group of the output's own; one that is there already gets them anew.
    """
    return put_group(item, SHAPES, "Saddleback Shapes", _new_shapes_group(shapes), {})


def _new_shapes_group(shapes: list[bpy.types.Object]) -> bpy.types.NodeTree:
    """One Instance on Points for each class, since the order of a collection's children is not ours to tell."""
    group, source, sink = new_group("Saddleback Shapes", SHAPES)
    nodes, link = group.nodes, group.links.new
    points, joined = nodes.new("GeometryNodeMeshToPoints"), nodes.new("GeometryNodeJoinGeometry")
    wiring = Wiring(group)
    rotation = wiring.attribute(ROTATION_ATTRIBUTE, "FLOAT_VECTOR")
    scale = wiring.attribute(SCALE_ATTRIBUTE, "FLOAT_VECTOR")
    kind = wiring.attribute(CLASS_ATTRIBUTE, "INT")
    lay_out((source, rotation.node, scale.node, kind.node), points)
    link(source.outputs["Geometry"], points.inputs["Mesh"])
    for number, shape in enumerate(shapes):
        is_of_it, info = wiring.compared(kind, "EQUAL", number), nodes.new("GeometryNodeObjectInfo")
        info.inputs["Object"].default_value = shape
        info.inputs["As Instance"].default_value = True
        placed = nodes.new("GeometryNodeInstanceOnPoints")
        link(points.outputs["Points"], placed.inputs["Points"])
        link(is_of_it, placed.inputs["Selection"])
        link(info.outputs["Geometry"], placed.inputs["Instance"])
        link(rotation, placed.inputs["Rotation"])
        link(scale, placed.inputs["Scale"])
        link(placed.outputs["Instances"], joined.inputs["Geometry"])
        for column, node in enumerate((is_of_it.node, info, placed), 2):
            node.location = (220 * column, -300 * number)
    link(joined.outputs["Geometry"], sink.inputs["Geometry"])
    joined.location, sink.location = (1100, 0), (1320, 0)
    return group

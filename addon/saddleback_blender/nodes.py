# SPDX-License-Identifier: GPL-3.0-or-later
"""Node groups and materials of the output objects; ours carry a mark, so that the artist may rename them."""

from __future__ import annotations

from functools import partial
from typing import Any

import bpy

from . import compat, rollback

MARK = "saddleback_made"  # custom property: which of the things below a data-block is

TUBES, CURVE_TUBES = "tubes", "curve tubes"
INSTANCES, DOTS, SWEEP, SHAPES, FOLLOW = "instances", "dots", "sweep", "shapes", "follow"
CELLS, EDGES, PATHS = "cells", "edges", "paths"
ARROWS, SOURCES, SADDLES = "arrows", "field sources", "field saddles"

SIZE_ATTRIBUTE = "saddleback_size"
ROTATION_ATTRIBUTE, NORMAL_ATTRIBUTE = "saddleback_rotation", "saddleback_normal"
SCALE_ATTRIBUTE, CLASS_ATTRIBUTE = "saddleback_scale", "saddleback_class"
COLOR_ATTRIBUTE = "saddleback_color"
# Radii of a sweep circle from which on, and until which, a vertex is shown.
FROM_ATTRIBUTE, UNTIL_ATTRIBUTE = "saddleback_from", "saddleback_until"


def is_ours(block: bpy.types.ID) -> bool:
    """Tells whether we made a node group or material."""
    return MARK in block


def remove_unused() -> None:
    """Removes the node groups and materials of ours that nothing uses any more."""
    for blocks in (bpy.data.node_groups, bpy.data.materials):
        for block in list(blocks):
            if is_ours(block) and block.users == 0 and block.library is None:
                blocks.remove(block)


def modifier_of(item: bpy.types.Object, kind: str) -> bpy.types.Modifier | None:
    """The object's Geometry Nodes modifier with our group of this kind, None where there is none."""
    for modifier in item.modifiers:
        if modifier.type == "NODES" and modifier.node_group is not None and modifier.node_group.get(MARK) == kind:
            return modifier
    return None


def set_tubes(item: bpy.types.Object, radius: float, material: bpy.types.Material | None) -> bpy.types.Modifier:
    """Makes the object's edges or curves into tubes of a radius (object units), which stays live in the modifier."""
    kind = CURVE_TUBES if item.type == "CURVE" else TUBES
    modifier = modifier_of(item, kind)
    if modifier is None:
        modifier = add_first(item, "Saddleback Tubes", _shared_group(kind))
        compat.set_modifier_input(modifier, "Resolution", 8)
        compat.set_modifier_input(modifier, "Material", material)
    set_input(modifier, "Radius", radius)
    return modifier


def remove_tubes(item: bpy.types.Object) -> None:
    """Leaves a curve object a line."""
    _remove(item, CURVE_TUBES)


def _remove(item: bpy.types.Object, kind: str) -> None:
    modifier = modifier_of(item, kind)
    if modifier is not None:
        rollback.when_written(partial(remove_modifier, item, modifier))


def set_instances(item: bpy.types.Object, instance: bpy.types.Object | None, scale: float) -> bpy.types.Modifier | None:
    """Puts an object on each point, sized and turned by the point's attributes; None takes the instances away."""
    if instance is None:
        _remove(item, INSTANCES)
        return None
    modifier = modifier_of(item, INSTANCES)
    if modifier is None:
        # Each output has a group of its own: the object stands on the node, which works alike in all versions.
        modifier = add_first(item, "Saddleback Instances", _new_instances_group())
    info = next((node for node in modifier.node_group.nodes if node.type == "OBJECT_INFO"), None)
    if info is not None:  # an artist may edit the group
        rollback.remember(info.inputs["Object"], "default_value")
        info.inputs["Object"].default_value = instance
    set_input(modifier, "Scale", scale)
    return modifier


def set_dots(item: bpy.types.Object, scale: float, material: bpy.types.Material | None) -> bpy.types.Modifier:
    """Puts a flat round dot on each point, sized and turned by the point's attributes."""
    modifier = modifier_of(item, DOTS)
    if modifier is None:
        modifier = add_first(item, "Saddleback Dots", _shared_group(DOTS))
        compat.set_modifier_input(modifier, "Resolution", 16)
        compat.set_modifier_input(modifier, "Material", material)
    set_input(modifier, "Scale", scale)
    return modifier


def remove_dots(item: bpy.types.Object) -> None:
    """Takes the dots away."""
    _remove(item, DOTS)


def put_group(
    item: bpy.types.Object, kind: str, name: str, group: bpy.types.NodeTree, inputs: dict[str, Any]
) -> bpy.types.Modifier:
    """Gives the object's modifier of this kind another group, or adds one before the artist's own; sets its inputs.

    Objects are inputs and not on nodes, since Blender leads a duplicate's inputs to what is duplicated with it.
    """
    modifier = modifier_of(item, kind)
    if modifier is None:
        modifier = add_first(item, name, group)
    else:
        old = modifier.node_group
        rollback.undo_with(partial(_put_back, modifier, old, compat.modifier_inputs(modifier)))
        modifier.node_group = group
        rollback.when_written(partial(_remove_if_unused, old.name))
    for label, value in inputs.items():
        compat.set_modifier_input(modifier, label, value)
    return modifier


def _put_back(modifier: bpy.types.Modifier, group: bpy.types.NodeTree, inputs: dict[str, Any]) -> None:
    modifier.node_group = group
    for label, value in inputs.items():
        compat.set_modifier_input(modifier, label, value)


def _remove_if_unused(name: str) -> None:
    group = bpy.data.node_groups.get(name)  # gone where outputs shared it
    if group is not None and group.users == 0 and is_ours(group):
        bpy.data.node_groups.remove(group)


def set_input(modifier: bpy.types.Modifier, name: str, value: Any) -> None:
    """Sets an input of a modifier by its name."""
    rollback.undo_with(partial(compat.set_modifier_input, modifier, name, compat.modifier_input(modifier, name)))
    compat.set_modifier_input(modifier, name, value)


def remove_modifier(item: bpy.types.Object, modifier: bpy.types.Modifier) -> None:
    """Removes a modifier, and its group unless something else uses it."""
    name = modifier.node_group.name
    compat.remove_modifier(item, modifier)
    _remove_if_unused(name)


def set_sweep(item: bpy.types.Object, circle: bpy.types.Object, draws_circle: bool) -> bpy.types.Modifier:
    """Shows of the object's vertices those whose time has come, by the scale of a circle of radius 1.

    With `draws_circle` the circle itself is shown, too, about the object's origin.
    """
    return put_group(item, SWEEP, "Saddleback Sweep", _new_sweep_group(draws_circle), {"Circle": circle})


def add_first(item: bpy.types.Object, name: str, group: bpy.types.NodeTree) -> bpy.types.Modifier:
    """Adds our modifier before those of the artist, which expect its result."""
    modifier = item.modifiers.new(name, "NODES")
    rollback.undo_with(partial(compat.remove_modifier, item, modifier))
    modifier.node_group = group
    following = modifier_of(item, FOLLOW)  # which moves what the others make something of
    for first in (modifier, following):
        if first is not None and item.modifiers[0] != first:
            compat.move_modifier_first(item, first)
    return modifier


def _shared_group(kind: str) -> bpy.types.NodeTree:
    for group in bpy.data.node_groups:
        if group.get(MARK) == kind and group.library is None:
            return group
    makers = {TUBES: _new_tubes_group, CURVE_TUBES: _new_curve_tubes_group, DOTS: new_dots_group}
    return makers[kind]()


def new_group(name: str, kind: str) -> tuple[bpy.types.NodeTree, Any, Any]:
    """An empty geometry group with its input and output node."""
    group = bpy.data.node_groups.new(name, "GeometryNodeTree")
    group[MARK] = kind
    if hasattr(group, "is_modifier"):
        group.is_modifier = True
    compat.new_group_socket(group, "Geometry", "OUTPUT", "NodeSocketGeometry")
    compat.new_group_socket(group, "Geometry", "INPUT", "NodeSocketGeometry")
    source, sink = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    return group, source, sink


def lay_out(*columns: Any) -> None:
    """Lays nodes out from left to right so that the artist can read the group."""
    for x, column in enumerate(columns):
        for y, node in enumerate(column if isinstance(column, tuple) else (column,)):
            node.location = (220 * x, -220 * y)


def _add_tube_inputs(group: bpy.types.NodeTree) -> None:
    radius = compat.new_group_socket(group, "Radius", "INPUT", "NodeSocketFloat")
    radius.default_value, radius.min_value = 0.01, 0.0
    resolution = compat.new_group_socket(group, "Resolution", "INPUT", "NodeSocketInt")
    resolution.default_value, resolution.min_value, resolution.max_value = 8, 3, 64
    compat.new_group_socket(group, "Material", "INPUT", "NodeSocketMaterial")


def _new_curve_tubes_group() -> bpy.types.NodeTree:
    """Curves to tubes, closed at their ends; a mesh, as an artist's bevel makes one of the curve, stays."""
    group, source, sink = new_group("Saddleback Curve Tubes", CURVE_TUBES)
    _add_tube_inputs(group)
    nodes, link = group.nodes, group.links.new
    circle, sweep = nodes.new("GeometryNodeCurvePrimitiveCircle"), nodes.new("GeometryNodeCurveToMesh")
    sweep.inputs["Fill Caps"].default_value = True
    parts, joined = nodes.new("GeometryNodeSeparateComponents"), nodes.new("GeometryNodeJoinGeometry")
    smooth, painted = nodes.new("GeometryNodeSetShadeSmooth"), nodes.new("GeometryNodeSetMaterial")
    link(source.outputs["Resolution"], circle.inputs["Resolution"])
    link(source.outputs["Radius"], circle.inputs["Radius"])
    link(source.outputs["Geometry"], parts.inputs["Geometry"])
    link(parts.outputs["Curve"], sweep.inputs["Curve"])
    link(circle.outputs["Curve"], sweep.inputs["Profile Curve"])
    link(sweep.outputs["Mesh"], smooth.inputs["Geometry"])
    link(smooth.outputs["Geometry"], painted.inputs["Geometry"])
    link(source.outputs["Material"], painted.inputs["Material"])
    link(painted.outputs["Geometry"], joined.inputs["Geometry"])
    link(parts.outputs["Mesh"], joined.inputs["Geometry"])
    link(joined.outputs["Geometry"], sink.inputs["Geometry"])
    lay_out(source, (circle, parts), sweep, smooth, painted, joined, sink)
    return group


def _new_tubes_group() -> bpy.types.NodeTree:
    """Edges to tubes, with a ball at every vertex where a tube ends or several meet, so that joints are closed."""
    group, source, sink = new_group("Saddleback Tubes", TUBES)
    _add_tube_inputs(group)
    nodes, link = group.nodes, group.links.new

    to_curve = nodes.new("GeometryNodeMeshToCurve")
    circle = nodes.new("GeometryNodeCurvePrimitiveCircle")
    sweep = nodes.new("GeometryNodeCurveToMesh")
    neighbors = nodes.new("GeometryNodeInputMeshVertexNeighbors")
    is_joint = nodes.new("FunctionNodeCompare")
    is_joint.data_type, is_joint.operation = "INT", "NOT_EQUAL"
    compared = {socket.name: socket for socket in is_joint.inputs if socket.enabled}  # those of whole numbers
    compared["B"].default_value = 2
    joints = nodes.new("GeometryNodeMeshToPoints")
    ball = nodes.new("GeometryNodeMeshUVSphere")
    half = nodes.new("ShaderNodeMath")
    half.operation = "MULTIPLY"
    half.inputs[1].default_value = 0.75
    balls = nodes.new("GeometryNodeInstanceOnPoints")
    real = nodes.new("GeometryNodeRealizeInstances")
    joined = nodes.new("GeometryNodeJoinGeometry")
    smooth = nodes.new("GeometryNodeSetShadeSmooth")
    painted = nodes.new("GeometryNodeSetMaterial")

    link(source.outputs["Geometry"], to_curve.inputs["Mesh"])
    link(source.outputs["Resolution"], circle.inputs["Resolution"])
    link(source.outputs["Radius"], circle.inputs["Radius"])
    link(to_curve.outputs["Curve"], sweep.inputs["Curve"])
    link(circle.outputs["Curve"], sweep.inputs["Profile Curve"])
    link(neighbors.outputs["Vertex Count"], compared["A"])
    link(source.outputs["Geometry"], joints.inputs["Mesh"])
    link(is_joint.outputs["Result"], joints.inputs["Selection"])
    link(source.outputs["Resolution"], ball.inputs["Segments"])
    link(source.outputs["Resolution"], half.inputs[0])
    link(half.outputs["Value"], ball.inputs["Rings"])
    link(source.outputs["Radius"], ball.inputs["Radius"])
    link(joints.outputs["Points"], balls.inputs["Points"])
    link(ball.outputs["Mesh"], balls.inputs["Instance"])
    link(balls.outputs["Instances"], real.inputs["Geometry"])
    link(real.outputs["Geometry"], joined.inputs["Geometry"])
    link(sweep.outputs["Mesh"], joined.inputs["Geometry"])
    link(joined.outputs["Geometry"], smooth.inputs["Geometry"])
    link(smooth.outputs["Geometry"], painted.inputs["Geometry"])
    link(source.outputs["Material"], painted.inputs["Material"])
    link(painted.outputs["Geometry"], sink.inputs["Geometry"])
    lay_out(
        source, (to_curve, circle, neighbors, half), (sweep, is_joint, ball), joints, balls, real, joined, smooth,
        painted, sink,
    )  # fmt: skip
    return group


def _new_instances_group() -> bpy.types.NodeTree:
    group, source, sink = new_group("Saddleback Instances", INSTANCES)
    info = group.nodes.new("GeometryNodeObjectInfo")
    info.inputs["As Instance"].default_value = True
    place_instances(group, source, sink, info, info.outputs["Geometry"])
    return group


def new_dots_group(scale: float = 1.0) -> bpy.types.NodeTree:
    """A flat round dot on each point; `scale`: of dots that fill their cells, until the artist says otherwise."""
    group, source, sink = new_group("Saddleback Dots", DOTS)
    resolution = compat.new_group_socket(group, "Resolution", "INPUT", "NodeSocketInt")
    resolution.default_value, resolution.min_value, resolution.max_value = 16, 3, 128
    compat.new_group_socket(group, "Material", "INPUT", "NodeSocketMaterial")
    nodes, link = group.nodes, group.links.new
    circle, painted = nodes.new("GeometryNodeMeshCircle"), nodes.new("GeometryNodeSetMaterial")
    circle.fill_type = "NGON"
    circle.inputs["Radius"].default_value = 1.0
    link(source.outputs["Resolution"], circle.inputs["Vertices"])
    link(circle.outputs["Mesh"], painted.inputs["Geometry"])
    link(source.outputs["Material"], painted.inputs["Material"])
    place_instances(group, source, sink, (circle, painted), painted.outputs["Geometry"], scale)
    return group


def place_instances(
    group: bpy.types.NodeTree, source: Any, sink: Any, column: Any, instance: Any, factor: float = 1.0
) -> None:
    """Adds what puts an instance on each point, sized and turned by the point's attributes."""
    scale = compat.new_group_socket(group, "Scale", "INPUT", "NodeSocketFloat")
    scale.default_value, scale.min_value = factor, 0.0
    nodes, link = group.nodes, group.links.new

    rotation, size = nodes.new("GeometryNodeInputNamedAttribute"), nodes.new("GeometryNodeInputNamedAttribute")
    rotation.data_type, size.data_type = "FLOAT_VECTOR", "FLOAT"
    rotation.inputs["Name"].default_value, size.inputs["Name"].default_value = ROTATION_ATTRIBUTE, SIZE_ATTRIBUTE
    scaled = nodes.new("ShaderNodeMath")
    scaled.operation = "MULTIPLY"
    points = nodes.new("GeometryNodeMeshToPoints")
    placed = nodes.new("GeometryNodeInstanceOnPoints")

    link(source.outputs["Geometry"], points.inputs["Mesh"])
    link(points.outputs["Points"], placed.inputs["Points"])
    link(instance, placed.inputs["Instance"])
    link(attribute_output(rotation), placed.inputs["Rotation"])
    link(attribute_output(size), scaled.inputs[0])
    link(source.outputs["Scale"], scaled.inputs[1])
    link(scaled.outputs["Value"], placed.inputs["Scale"])
    link(placed.outputs["Instances"], sink.inputs["Geometry"])
    columns = column if isinstance(column, tuple) else (column,)
    lay_out((source, rotation, size), *columns, (points, scaled), placed, sink)


def _new_sweep_group(draws_circle: bool) -> bpy.types.NodeTree:
    """Keyframes of the circle's scale drive everything: an artist may move them."""
    group, source, sink = new_group("Saddleback Sweep", SWEEP)
    compat.new_group_socket(group, "Circle", "INPUT", "NodeSocketObject")
    nodes, link = group.nodes, group.links.new

    info = nodes.new("GeometryNodeObjectInfo")
    link(source.outputs["Circle"], info.inputs["Object"])
    radius = nodes.new("ShaderNodeSeparateXYZ")
    begin, end = nodes.new("GeometryNodeInputNamedAttribute"), nodes.new("GeometryNodeInputNamedAttribute")
    is_before, is_after = nodes.new("FunctionNodeCompare"), nodes.new("FunctionNodeCompare")
    for node, attribute, compare, operation in (
        (begin, FROM_ATTRIBUTE, is_before, "GREATER_THAN"),
        (end, UNTIL_ATTRIBUTE, is_after, "LESS_EQUAL"),
    ):
        node.data_type = "FLOAT"
        node.inputs["Name"].default_value = attribute
        compare.data_type, compare.operation = "FLOAT", operation
        compared = {socket.name: socket for socket in compare.inputs if socket.enabled}
        link(attribute_output(node), compared["A"])
        link(radius.outputs["X"], compared["B"])
    either = nodes.new("FunctionNodeBooleanMath")
    either.operation = "OR"
    hidden = nodes.new("GeometryNodeDeleteGeometry")
    link(info.outputs["Scale"], radius.inputs[0])
    link(is_before.outputs["Result"], either.inputs[0])
    link(is_after.outputs["Result"], either.inputs[1])
    link(source.outputs["Geometry"], hidden.inputs["Geometry"])
    link(either.outputs["Boolean"], hidden.inputs["Selection"])
    shown = hidden.outputs["Geometry"]
    if draws_circle:
        drawn, edges = nodes.new("GeometryNodeCurvePrimitiveCircle"), nodes.new("GeometryNodeCurveToMesh")
        drawn.inputs["Resolution"].default_value = 256
        joined = nodes.new("GeometryNodeJoinGeometry")
        link(radius.outputs["X"], drawn.inputs["Radius"])
        link(drawn.outputs["Curve"], edges.inputs["Curve"])
        link(edges.outputs["Mesh"], joined.inputs["Geometry"])
        link(shown, joined.inputs["Geometry"])
        shown = joined.outputs["Geometry"]
        drawn.location, edges.location, joined.location = (660, -440), (880, -440), (1100, 0)
    link(shown, sink.inputs["Geometry"])
    lay_out((source, info), (begin, end, radius), (is_before, is_after), either, hidden)
    sink.location = (1320, 0)
    return group


def attribute_output(node: Any) -> Any:
    """The output in use of a Named Attribute node, which has one for each type in older versions."""
    return next(socket for socket in node.outputs if socket.name == "Attribute" and socket.enabled)


def cells_material() -> bpy.types.Material:
    """A plain material that shows the color of each cell."""
    return find_material(CELLS) or _new_painted("Saddleback Cells", CELLS, 0.55)


def shapes_material() -> bpy.types.Material:
    """A plain material that shows the color of each shape."""
    return find_material(SHAPES) or _new_painted("Saddleback Shapes", SHAPES, 0.4)


def edges_material() -> bpy.types.Material:
    """A dark plain material for the lines between cells."""
    return find_material(EDGES) or new_colored("Saddleback Edges", EDGES, (0.03, 0.03, 0.035, 1.0), 0.4)


def dots_material() -> bpy.types.Material:
    """Ink."""
    return find_material(DOTS) or new_colored("Saddleback Dots", DOTS, (0.008, 0.009, 0.012, 1.0), 0.8)


def paths_material() -> bpy.types.Material:
    """A bright plain material for shortest paths, which stands out on every color of the distance preview."""
    return find_material(PATHS) or new_colored("Saddleback Paths", PATHS, (0.0, 0.36, 0.55, 1.0), 0.4)


def field_materials() -> list[bpy.types.Material]:
    """Returns the materials of a field's arrows, of its singularities with a positive index, of those with a negative
    one.
    """
    looks = (
        ("Saddleback Arrows", ARROWS, (0.012, 0.02, 0.05, 1.0)),
        ("Saddleback Sources", SOURCES, (0.85, 0.13, 0.06, 1.0)),
        ("Saddleback Saddles", SADDLES, (0.04, 0.2, 0.8, 1.0)),
    )
    return [find_material(kind) or new_colored(name, kind, color, 0.45) for name, kind, color in looks]


def _new_painted(name: str, kind: str, roughness: float) -> bpy.types.Material:
    """Returns the layer of the color attribute."""
    material, shader = new_material(name, kind)
    show_attribute(material, shader)
    shader.inputs["Roughness"].default_value = roughness
    return material


def show_attribute(material: bpy.types.Material, shader: Any) -> None:
    """Lets a material show the color attribute."""
    color = material.node_tree.nodes.new("ShaderNodeVertexColor")
    color.layer_name = COLOR_ATTRIBUTE
    color.location = (-220, 300)
    material.node_tree.links.new(color.outputs["Color"], shader.inputs["Base Color"])


def new_colored(name: str, kind: str, color: tuple[float, ...], roughness: float) -> bpy.types.Material:
    """A material of one color."""
    material, shader = new_material(name, kind)
    shader.inputs["Base Color"].default_value = color
    shader.inputs["Roughness"].default_value = roughness
    material.diffuse_color = color
    return material


def find_material(kind: str) -> bpy.types.Material | None:
    """The material of this kind in the file, None where there is none."""
    return next((m for m in bpy.data.materials if m.get(MARK) == kind and m.library is None), None)


def new_material(name: str, kind: str) -> tuple[bpy.types.Material, Any]:
    """A material of ours and its surface shader."""
    material = bpy.data.materials.new(name)
    material[MARK] = kind
    material.use_nodes = True
    return material, next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")

"""Node groups that put shapes on points, and take points along with a mesh that is deformed.

Each point knows the triangle of the mesh that it stands on: its three vertices, where in it the point is, and how it is
shifted (and its shape turned) as seen from it. The group looks up where those vertices are now, after all modifiers. A
mesh that has another number of vertices by then, say of another subdivision level in the render than in the viewport,
is asked by places instead: where is now what was there at rest? Blender keeps the places at rest as an attribute
of the mesh. Where it does not, the points stay where they were put. Points of meshes carry what they know as
attributes; curve objects cannot, so that for them a hidden mesh keeps it, in order.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from . import compat, rollback
from .nodes import (
    CLASS_ATTRIBUTE,
    FOLLOW,
    ROTATION_ATTRIBUTE,
    SCALE_ATTRIBUTE,
    SHAPES,
    attribute_output,
    lay_out,
    modifier_of,
    new_group,
    put_group,
    remove_modifier,
)

# Of the points: the vertices of the triangle, the weights of each, and vectors by the triangle's axes.
CORNER_ATTRIBUTES = ("saddleback_corner_a", "saddleback_corner_b", "saddleback_corner_c")
WEIGHTS_ATTRIBUTE, SHIFT_ATTRIBUTE = "saddleback_barycentric", "saddleback_shift"
X_ATTRIBUTE, Z_ATTRIBUTE = "saddleback_axis_x", "saddleback_axis_z"
# Of the points: where they stand on the mesh at rest, and steps from there along the triangle's first two axes.
REST_ATTRIBUTES = ("saddleback_rest", "saddleback_rest_x", "saddleback_rest_y")
REST_POSITION = "rest_position"  # Blender's own, of the mesh
NOW_POSITION = "saddleback_now"  # of the mesh, within the groups: where its vertices are, as seen from the points
# Inputs of the groups.
HOST, KEEPER = "Surface", "Anchors"


@dataclass(frozen=True)
class Host:
    """The mesh that shapes follow, and its place as seen from the object with the points."""

    item: bpy.types.Object
    axes: tuple[tuple[float, ...], ...]  # three: where its unit vectors lead
    origin: tuple[float, ...]
    vertex_count: int
    has_rest: bool  # the points have REST_ATTRIBUTES

    @classmethod
    def of(cls, item: bpy.types.Object, place: Matrix, vertex_count: int, has_rest: bool) -> Host:
        """Returns it as seen from an object whose world matrix is `place`."""
        columns = np.array(place.inverted() @ item.matrix_world).T[:, :3].tolist()
        return cls(item, tuple(map(tuple, columns[:3])), tuple(columns[3]), vertex_count, has_rest)


def set_shapes(item: bpy.types.Object, shapes: list[bpy.types.Object], host: Host | None) -> bpy.types.Modifier:
    """Puts on each point the object of its class, turned and scaled by the point's attributes.

    The objects stand on the nodes of a group of the output's own; one that is there already gets them anew.
    """
    group = _new_shapes_group(shapes, host)
    return put_group(item, SHAPES, "Saddleback Shapes", group, {} if host is None else {HOST: host.item})


def _new_shapes_group(shapes: list[bpy.types.Object], host: Host | None) -> bpy.types.NodeTree:
    """One Instance on Points for each class, since the order of a collection's children is not ours to tell."""
    group, source, sink = new_group("Saddleback Shapes", SHAPES)
    if host is not None:
        compat.new_group_socket(group, HOST, "INPUT", "NodeSocketObject")
    nodes, link = group.nodes, group.links.new
    points, joined = nodes.new("GeometryNodeMeshToPoints"), nodes.new("GeometryNodeJoinGeometry")
    wiring = _Wiring(group)
    rotation = wiring.attribute(ROTATION_ATTRIBUTE, "FLOAT_VECTOR")
    scale = wiring.attribute(SCALE_ATTRIBUTE, "FLOAT_VECTOR")
    kind = wiring.attribute(CLASS_ATTRIBUTE, "INT")
    lay_out((source, rotation.node, scale.node, kind.node), points)
    if host is not None:
        now = _triangle_now(wiring, source, host, wiring.attribute)
        link(_place_of(wiring, now, wiring.attribute), points.inputs["Position"])
        rotation = _turn_of(wiring, now, rotation)
    link(source.outputs["Geometry"], points.inputs["Mesh"])
    for number, shape in enumerate(shapes):
        is_of_it, info = wiring.is_equal(kind, number), nodes.new("GeometryNodeObjectInfo")
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


@dataclass(frozen=True)
class Tubes:
    """Holds what a curve object needs to follow: its own bevel would come before the points are moved."""

    keeper: bpy.types.Object  # whose mesh has a vertex with the attributes for each point of the curve
    radius: float
    material: bpy.types.Material


def set_following(item: bpy.types.Object, host: Host, tubes: Tubes | None = None) -> bpy.types.Modifier:
    """Takes the points of a mesh, or of a curve object that becomes tubes, along with the host."""
    group, source, sink = new_group("Saddleback Follow", FOLLOW)
    inputs = {HOST: host.item} if tubes is None else {HOST: host.item, KEEPER: tubes.keeper}
    for name in inputs:
        compat.new_group_socket(group, name, "INPUT", "NodeSocketObject")
    wiring = _Wiring(group)
    read = wiring.attribute if tubes is None else wiring.kept_by(source.outputs[KEEPER])
    now = _triangle_now(wiring, source, host, read)
    moved = group.nodes.new("GeometryNodeSetPosition")
    group.links.new(source.outputs["Geometry"], moved.inputs["Geometry"])
    group.links.new(_place_of(wiring, now, read), moved.inputs["Position"])
    shown = moved.outputs["Geometry"] if tubes is None else _tubes(wiring, moved.outputs["Geometry"], tubes)
    group.links.new(shown, sink.inputs["Geometry"])
    lay_out((source,), moved, sink)
    return put_group(item, FOLLOW, "Saddleback Follow", group, inputs)


def stop_following(item: bpy.types.Object) -> None:
    """Leaves the points where they are."""
    modifier = modifier_of(item, FOLLOW)
    if modifier is not None:
        rollback.when_written(partial(remove_modifier, item, modifier))


def _tubes(wiring: _Wiring, curve: Any, tubes: Tubes) -> Any:
    if tubes.radius <= 0:
        return curve
    circle, sweep = wiring.node("GeometryNodeCurvePrimitiveCircle"), wiring.node("GeometryNodeCurveToMesh")
    smooth, painted = wiring.node("GeometryNodeSetShadeSmooth"), wiring.node("GeometryNodeSetMaterial")
    circle.inputs["Resolution"].default_value, circle.inputs["Radius"].default_value = 8, tubes.radius
    painted.inputs["Material"].default_value = tubes.material
    wiring.link(curve, sweep.inputs["Curve"])
    wiring.link(circle.outputs["Curve"], sweep.inputs["Profile Curve"])
    wiring.link(sweep.outputs["Mesh"], smooth.inputs["Geometry"])
    wiring.link(smooth.outputs["Geometry"], painted.inputs["Geometry"])
    return painted.outputs["Geometry"]


@dataclass(frozen=True)
class _TriangleNow:
    """Sockets about the triangle that a point stands on."""

    is_known: Any  # where the point is on the mesh by now
    own: Any  # where the point was put
    foot: Any  # where on the triangle it stands by now
    axes: tuple[Any, Any, Any]  # of the triangle


def _triangle_now(wiring: _Wiring, source: Any, host: Host, read: Callable[[str, str], Any]) -> _TriangleNow:
    info = wiring.node("GeometryNodeObjectInfo")
    wiring.link(source.outputs[HOST], info.inputs["Object"])
    mesh = info.outputs["Geometry"]
    size = wiring.node("GeometryNodeAttributeDomainSize")
    wiring.link(mesh, size.inputs["Geometry"])
    is_same = wiring.is_equal(size.outputs["Point Count"], host.vertex_count)

    # All of the mesh as seen from the points, of which three vertices are looked up.
    own = wiring.node("GeometryNodeInputPosition").outputs["Position"]
    seen = wiring.vector("ADD", wiring.combined(own, host.axes), host.origin)
    corners = [wiring.sampled(mesh, "FLOAT_VECTOR", seen, read(name, "INT")) for name in CORNER_ATTRIBUTES]
    foot = wiring.combined(read(WEIGHTS_ATTRIBUTE, "FLOAT_VECTOR"), corners)
    first, second = (wiring.vector("SUBTRACT", corner, corners[0]) for corner in corners[1:])
    is_known = is_same
    if host.has_rest:
        rest = _RestMesh(wiring, mesh, seen)
        place, *steps = (read(name, "FLOAT_VECTOR") for name in REST_ATTRIBUTES)
        foot = wiring.chosen(is_same, rest.now(place), foot)
        first, second = (
            wiring.chosen(is_same, rest.way(place, step), side)
            for step, side in zip(steps, (first, second), strict=True)
        )
        is_known = wiring.either(is_same, rest.is_there)
    x = wiring.vector("NORMALIZE", first)
    z = wiring.vector("NORMALIZE", wiring.vector("CROSS_PRODUCT", first, second))
    return _TriangleNow(is_known, own, foot, (x, wiring.vector("CROSS_PRODUCT", z, x), z))


class _RestMesh:
    """The mesh with its vertices where they are at rest, and for each of those places where it is now."""

    def __init__(self, wiring: _Wiring, mesh: Any, seen: Any) -> None:
        self._wiring = wiring
        places = wiring.attribute(REST_POSITION, "FLOAT_VECTOR")
        extent = wiring.node("GeometryNodeAttributeStatistic")
        extent.data_type = "FLOAT_VECTOR"
        wiring.link(mesh, extent.inputs["Geometry"])
        wiring.link(places, wiring.enabled(extent.inputs, "Attribute"))
        self.is_there = wiring.is_long(wiring.enabled(extent.outputs, "Range"))  # what is not there reads as zeros
        kept, laid = wiring.node("GeometryNodeStoreNamedAttribute"), wiring.node("GeometryNodeSetPosition")
        kept.data_type, kept.domain = "FLOAT_VECTOR", "POINT"
        kept.inputs["Name"].default_value = NOW_POSITION
        wiring.link(mesh, kept.inputs["Geometry"])
        wiring.link(seen, wiring.enabled(kept.inputs, "Value"))
        wiring.link(kept.outputs["Geometry"], laid.inputs["Geometry"])
        wiring.link(places, laid.inputs["Position"])
        self._mesh = laid.outputs["Geometry"]
        self._now = wiring.attribute(NOW_POSITION, "FLOAT_VECTOR")

    def now(self, place: Any) -> Any:
        """Returns where the place of the surface is now that is next to one at rest."""
        made = self._wiring.node("GeometryNodeSampleNearestSurface")
        made.data_type = "FLOAT_VECTOR"
        self._wiring.link(self._mesh, made.inputs["Mesh"])
        self._wiring.link(self._now, self._wiring.enabled(made.inputs, "Value"))
        self._wiring.link(place, made.inputs["Sample Position"])
        return self._wiring.enabled(made.outputs, "Value")

    def way(self, place: Any, step: Any) -> Any:
        """Returns the way from where a step back from the place leads, to where one ahead does."""
        back, ahead = (self._wiring.vector(operation, place, step) for operation in ("SUBTRACT", "ADD"))
        return self._wiring.vector("SUBTRACT", self.now(ahead), self.now(back))


def _place_of(wiring: _Wiring, now: _TriangleNow, read: Callable[[str, str], Any]) -> Any:
    """Returns where a point is now; where it was put where the mesh has become another one."""
    shift = wiring.combined(read(SHIFT_ATTRIBUTE, "FLOAT_VECTOR"), now.axes)
    return wiring.chosen(now.is_known, now.own, wiring.vector("ADD", now.foot, shift))


def _turn_of(wiring: _Wiring, now: _TriangleNow, rotation: Any) -> Any:
    """Returns how a shape is turned now."""
    along, away = (
        wiring.combined(wiring.attribute(name, "FLOAT_VECTOR"), now.axes) for name in (X_ATTRIBUTE, Z_ATTRIBUTE)
    )
    upright = wiring.aligned("Z", "AUTO", away, None)
    return wiring.chosen(now.is_known, rotation, wiring.aligned("X", "Z", along, upright))


class _Wiring:
    """Makes nodes of a group and links them: each answers with the socket that gives what it makes."""

    def __init__(self, group: bpy.types.NodeTree) -> None:
        self.link = group.links.new
        self._nodes = group.nodes

    def node(self, kind: str) -> Any:
        """A new node, in rows from the left below the others."""
        made = self._nodes.new(kind)
        number = len(self._nodes)
        made.location = (220 * (number % 8), -900 - 220 * (number // 8))
        return made

    @staticmethod
    def enabled(sockets: Any, name: str) -> Any:
        """The socket in use: nodes for several types have one of the name for each, in older versions."""
        return next(socket for socket in sockets if socket.name == name and socket.enabled)

    def attribute(self, name: str, data_type: str) -> Any:
        """A named attribute of the points."""
        made = self.node("GeometryNodeInputNamedAttribute")
        made.data_type = data_type
        made.inputs["Name"].default_value = name
        return attribute_output(made)

    def sampled(self, geometry: Any, data_type: str, value: Any, index: Any) -> Any:
        """A value of the vertex of a mesh that has this index."""
        made = self.node("GeometryNodeSampleIndex")
        made.data_type, made.domain = data_type, "POINT"
        self.link(geometry, made.inputs["Geometry"])
        self.link(value, self.enabled(made.inputs, "Value"))
        self.link(index, made.inputs["Index"])
        return self.enabled(made.outputs, "Value")

    def kept_by(self, keeper: Any) -> Callable[[str, str], Any]:
        """Returns what reads attributes of another object's mesh, of the vertex with the same index."""
        info = self.node("GeometryNodeObjectInfo")
        self.link(keeper, info.inputs["Object"])
        index = self.node("GeometryNodeInputIndex").outputs["Index"]
        return lambda name, data_type: self.sampled(
            info.outputs["Geometry"], data_type, self.attribute(name, data_type), index
        )

    def is_equal(self, number: Any, to: int) -> Any:
        """Tells whether a whole number is the one given."""
        made = self.node("FunctionNodeCompare")
        made.data_type, made.operation = "INT", "EQUAL"
        self.link(number, self.enabled(made.inputs, "A"))
        self.enabled(made.inputs, "B").default_value = to
        return made.outputs["Result"]

    def is_long(self, vector: Any) -> Any:
        """Tells whether a vector is longer than zero."""
        length, made = self.node("ShaderNodeVectorMath"), self.node("FunctionNodeCompare")
        length.operation = "LENGTH"
        self.link(vector, length.inputs[0])
        made.data_type, made.operation = "FLOAT", "GREATER_THAN"
        self.link(length.outputs["Value"], self.enabled(made.inputs, "A"))
        self.enabled(made.inputs, "B").default_value = 0.0
        return made.outputs["Result"]

    def either(self, one: Any, other: Any) -> Any:
        """Tells whether one of two is true."""
        made = self.node("FunctionNodeBooleanMath")
        made.operation = "OR"
        self.link(one, made.inputs[0])
        self.link(other, made.inputs[1])
        return made.outputs["Boolean"]

    def vector(self, operation: str, *operands: Any) -> Any:
        """Vector mathematics with sockets or constants."""
        made = self.node("ShaderNodeVectorMath")
        made.operation = operation
        for socket, operand in zip(made.inputs, operands, strict=False):
            self._give(socket, operand)
        return made.outputs["Vector"]

    def combined(self, factors: Any, vectors: Any) -> Any:
        """The sum of three vectors, each times a component of `factors`."""
        parts = self.node("ShaderNodeSeparateXYZ")
        self.link(factors, parts.inputs[0])
        scaled = []
        for factor, vector in zip(parts.outputs, vectors, strict=True):
            made = self.node("ShaderNodeVectorMath")
            made.operation = "SCALE"
            self._give(made.inputs[0], vector)
            self.link(factor, made.inputs["Scale"])
            scaled.append(made.outputs["Vector"])
        return self.vector("ADD", self.vector("ADD", scaled[0], scaled[1]), scaled[2])

    def aligned(self, axis: str, pivot: str, vector: Any, rotation: Any) -> Any:
        """Euler angles of a turn that takes an axis to a vector, about the pivot."""
        made = self.node("FunctionNodeAlignEulerToVector")  # which newer versions keep for older files
        made.axis, made.pivot_axis = axis, pivot
        self.link(vector, made.inputs["Vector"])
        if rotation is not None:
            self.link(rotation, made.inputs["Rotation"])
        return made.outputs["Rotation"]

    def chosen(self, condition: Any, if_not: Any, if_so: Any) -> Any:
        """One of two vectors, by the condition."""
        made = self.node("GeometryNodeSwitch")
        made.input_type = "VECTOR"
        self.link(condition, self.enabled(made.inputs, "Switch"))
        self.link(if_not, self.enabled(made.inputs, "False"))
        self.link(if_so, self.enabled(made.inputs, "True"))
        return self.enabled(made.outputs, "Output")

    def _give(self, socket: Any, value: Any) -> None:
        if isinstance(value, bpy.types.NodeSocket):
            self.link(value, socket)
        else:
            socket.default_value = value

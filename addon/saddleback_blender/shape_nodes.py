"""The node group that puts shapes on points and, where wanted, takes the points along with a mesh that is deformed.

Each point knows the triangle of the mesh that it stands on: its three vertices, where in it the point is, and how the
shape is shifted and turned as seen from it. The group looks up where those vertices are now, after all modifiers. A
mesh that has another number of vertices by then is another mesh: there the shapes stay where they were put.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from .nodes import (
    CLASS_ATTRIBUTE,
    ROTATION_ATTRIBUTE,
    SCALE_ATTRIBUTE,
    SHAPES,
    add_first,
    attribute_output,
    lay_out,
    modifier_of,
    new_group,
)

# Of the points: the vertices of the triangle, the weights of each, and vectors by the triangle's axes.
CORNER_ATTRIBUTES = ("saddleback_corner_a", "saddleback_corner_b", "saddleback_corner_c")
WEIGHTS_ATTRIBUTE, SHIFT_ATTRIBUTE = "saddleback_barycentric", "saddleback_shift"
X_ATTRIBUTE, Z_ATTRIBUTE = "saddleback_axis_x", "saddleback_axis_z"


@dataclass(frozen=True)
class Host:
    """The mesh that shapes follow, and its place as seen from the object with the points."""

    item: bpy.types.Object
    axes: tuple[tuple[float, ...], ...]  # three: where its unit vectors lead
    origin: tuple[float, ...]
    vertex_count: int

    @classmethod
    def of(cls, item: bpy.types.Object, place: Matrix, vertex_count: int) -> Host:
        """As seen from an object whose world matrix is `place`."""
        columns = np.array(place.inverted() @ item.matrix_world).T[:, :3].tolist()
        return cls(item, tuple(map(tuple, columns[:3])), tuple(columns[3]), vertex_count)


def set_shapes(item: bpy.types.Object, shapes: list[bpy.types.Object], host: Host | None) -> bpy.types.Modifier:
    """Puts on each point the object of its class, turned and scaled by the point's attributes.

    The objects stand on the nodes of a group of the output's own; one that is there already gets them anew.
    """
    modifier = modifier_of(item, SHAPES)
    group = _new_shapes_group(shapes, host)
    if modifier is None:
        return add_first(item, "Saddleback Shapes", group)
    old, modifier.node_group = modifier.node_group, group
    if old.users == 0:
        bpy.data.node_groups.remove(old)
    return modifier


def _new_shapes_group(shapes: list[bpy.types.Object], host: Host | None) -> bpy.types.NodeTree:
    """One Instance on Points for each class, since the order of a collection's children is not ours to tell."""
    group, source, sink = new_group("Saddleback Shapes", SHAPES)
    nodes, link = group.nodes, group.links.new
    points, joined = nodes.new("GeometryNodeMeshToPoints"), nodes.new("GeometryNodeJoinGeometry")
    wiring = _Wiring(group)
    rotation = wiring.attribute(ROTATION_ATTRIBUTE, "FLOAT_VECTOR")
    scale = wiring.attribute(SCALE_ATTRIBUTE, "FLOAT_VECTOR")
    kind = wiring.attribute(CLASS_ATTRIBUTE, "INT")
    lay_out((source, rotation.node, scale.node, kind.node), points)
    if host is not None:
        position, rotation = _followed(wiring, host, rotation)
        link(position, points.inputs["Position"])
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


def _followed(wiring: _Wiring, host: Host, rotation: Any) -> tuple[Any, Any]:
    """Where the points are now and how they are turned; as they were where the mesh has become another one."""
    info = wiring.node("GeometryNodeObjectInfo")
    info.inputs["Object"].default_value = host.item
    mesh = info.outputs["Geometry"]
    size = wiring.node("GeometryNodeAttributeDomainSize")
    wiring.link(mesh, size.inputs["Geometry"])
    is_same = wiring.is_equal(size.outputs["Point Count"], host.vertex_count)

    # All of the mesh as seen from the points, of which three vertices are looked up.
    own = wiring.node("GeometryNodeInputPosition").outputs["Position"]
    seen = wiring.vector("ADD", wiring.combined(own, host.axes), host.origin)
    corners = []
    for name in CORNER_ATTRIBUTES:
        sample = wiring.node("GeometryNodeSampleIndex")
        sample.data_type, sample.domain = "FLOAT_VECTOR", "POINT"
        wiring.link(mesh, sample.inputs["Geometry"])
        wiring.link(seen, wiring.enabled(sample.inputs, "Value"))
        wiring.link(wiring.attribute(name, "INT"), sample.inputs["Index"])
        corners.append(wiring.enabled(sample.outputs, "Value"))
    foot = wiring.combined(wiring.attribute(WEIGHTS_ATTRIBUTE, "FLOAT_VECTOR"), corners)

    first, second = (wiring.vector("SUBTRACT", corner, corners[0]) for corner in corners[1:])
    x = wiring.vector("NORMALIZE", first)
    z = wiring.vector("NORMALIZE", wiring.vector("CROSS_PRODUCT", first, second))
    axes = (x, wiring.vector("CROSS_PRODUCT", z, x), z)
    shift, along, away = (
        wiring.combined(wiring.attribute(name, "FLOAT_VECTOR"), axes)
        for name in (SHIFT_ATTRIBUTE, X_ATTRIBUTE, Z_ATTRIBUTE)
    )
    upright = wiring.aligned("Z", "AUTO", away, None)
    turned = wiring.aligned("X", "Z", along, upright)
    position = wiring.chosen(is_same, own, wiring.vector("ADD", foot, shift))
    return position, wiring.chosen(is_same, rotation, turned)


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

    def is_equal(self, number: Any, to: int) -> Any:
        """Whether a whole number is the one given."""
        made = self.node("FunctionNodeCompare")
        made.data_type, made.operation = "INT", "EQUAL"
        self.link(number, self.enabled(made.inputs, "A"))
        self.enabled(made.inputs, "B").default_value = to
        return made.outputs["Result"]

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

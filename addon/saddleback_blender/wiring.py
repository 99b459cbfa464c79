# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the nodes of a group and links them: each call answers with the socket that gives what the node makes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy

from .nodes import attribute_output


class Wiring:
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

    def normal(self) -> Any:
        """The normals of the points of a mesh, whatever an artist made of them."""
        outputs = self.node("GeometryNodeInputNormal").outputs
        return outputs.get("True Normal", outputs["Normal"])

    def kept_by(self, mesh: Any) -> Callable[[str, str], Any]:
        """Returns what reads attributes of another mesh, of the vertex with the same index."""
        index = self.node("GeometryNodeInputIndex").outputs["Index"]
        return lambda name, data_type: self.sampled(mesh, data_type, self.attribute(name, data_type), index)

    def stored(self, geometry: Any, name: str, vector: Any) -> Any:
        """The geometry with a vector as a named attribute of its points."""
        made = self.node("GeometryNodeStoreNamedAttribute")
        made.data_type, made.domain = "FLOAT_VECTOR", "POINT"
        made.inputs["Name"].default_value = name
        self.link(geometry, made.inputs["Geometry"])
        self.link(vector, self.enabled(made.inputs, "Value"))
        return made.outputs["Geometry"]

    def count(self, geometry: Any, component: str) -> Any:
        """The number of the points of a MESH or CURVE."""
        made = self.node("GeometryNodeAttributeDomainSize")
        made.component = component
        self.link(geometry, made.inputs["Geometry"])
        return self.enabled(made.outputs, "Point Count")

    def mean(self, mesh: Any, vector: Any) -> Any:
        """The mean of a vector over the vertices of a mesh."""
        made = self.node("GeometryNodeAttributeStatistic")
        made.data_type = "FLOAT_VECTOR"
        self.link(mesh, made.inputs["Geometry"])
        self.link(vector, self.enabled(made.inputs, "Attribute"))
        return self.enabled(made.outputs, "Mean")

    def compared(self, number: Any, operation: str, to: Any) -> Any:
        """Compares a whole number with another one."""
        made = self.node("FunctionNodeCompare")
        made.data_type, made.operation = "INT", operation
        self.link(number, self.enabled(made.inputs, "A"))
        self._give(self.enabled(made.inputs, "B"), to)
        return made.outputs["Result"]

    def is_greater(self, number: Any, than: float) -> Any:
        """Compares a number with another one."""
        made = self.node("FunctionNodeCompare")
        made.data_type, made.operation = "FLOAT", "GREATER_THAN"
        self.link(number, self.enabled(made.inputs, "A"))
        self.enabled(made.inputs, "B").default_value = than
        return made.outputs["Result"]

    def boolean(self, operation: str, *operands: Any) -> Any:
        """Logic with one or two sockets."""
        return self._operation("FunctionNodeBooleanMath", operation, operands, "Boolean")

    def math(self, operation: str, *operands: Any) -> Any:
        """Mathematics with sockets or constants."""
        return self._operation("ShaderNodeMath", operation, operands, "Value")

    def vector(self, operation: str, *operands: Any) -> Any:
        """Vector mathematics with sockets or constants."""
        return self._operation("ShaderNodeVectorMath", operation, operands, "Vector")

    def distance(self, one: Any, other: Any) -> Any:
        """How far two places are from each other."""
        return self._operation("ShaderNodeVectorMath", "DISTANCE", (one, other), "Value")

    def _operation(self, kind: str, operation: str, operands: tuple[Any, ...], output: str) -> Any:
        made = self.node(kind)
        made.operation = operation
        for socket, operand in zip(made.inputs, operands, strict=False):
            self._give(socket, operand)
        return made.outputs[output]

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

# SPDX-License-Identifier: GPL-3.0-or-later
"""The node groups of the asset library: modifiers for what Tessellate makes, and groups for materials."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import bpy

from .. import compat, nodes
from ..bridge.outputs import preview
from ..wiring import Wiring

CELL_ATTRIBUTE, EDGE_DISTANCE_ATTRIBUTE = "saddleback_cell", "saddleback_edge_distance"
DISTANCE_ATTRIBUTE = "saddleback_distance"


@dataclass(frozen=True)
class Asset:
    """One node group: what makes it, what the asset browser says of it."""

    name: str
    description: str
    make: Callable[[str], bpy.types.NodeTree]


def _add_input(group: bpy.types.NodeTree, name: str, value: float, most: float, kind: str = "Float") -> None:
    socket = compat.new_group_socket(group, name, "INPUT", f"NodeSocket{kind}")
    socket.default_value, socket.min_value, socket.max_value = value, 0, most


def _new_modifier(name: str) -> tuple[bpy.types.NodeTree, Any, Any]:
    return nodes.new_group(name, f"asset {name}")


def _raised_cells(name: str, gap: float, bevel: float, height: float, roundness: float) -> bpy.types.NodeTree:
    """Lifts a surface along its normals by its distance from the edges of cells.

    Lengths are shares of the largest such distance, so that they suit a model of any size.
    """
    group, source, sink = _new_modifier(name)
    for label, value, most in (
        ("Gap", gap, 1.0), ("Bevel", bevel, 1.0), ("Height", height, 2.0), ("Roundness", roundness, 1.0),
    ):  # fmt: skip
        _add_input(group, label, value, most)
    _add_input(group, "Subdivide", 0, 6, "Int")
    wiring = Wiring(group)
    fine = wiring.node("GeometryNodeSubdivideMesh")
    wiring.link(source.outputs["Geometry"], fine.inputs["Mesh"])
    wiring.link(source.outputs["Subdivide"], fine.inputs["Level"])
    distance = wiring.attribute(EDGE_DISTANCE_ATTRIBUTE, "FLOAT")
    statistic = wiring.node("GeometryNodeAttributeStatistic")
    wiring.link(fine.outputs["Mesh"], statistic.inputs["Geometry"])
    wiring.link(distance, wiring.enabled(statistic.inputs, "Attribute"))
    share = wiring.math("DIVIDE", distance, wiring.enabled(statistic.outputs, "Max"))
    beyond_gap = wiring.math("SUBTRACT", share, wiring.math("MULTIPLY", source.outputs["Gap"], 0.5))
    bevel_width = wiring.math("MAXIMUM", source.outputs["Bevel"], 1e-6)
    along = wiring.math("MAXIMUM", wiring.math("MINIMUM", wiring.math("DIVIDE", beyond_gap, bevel_width), 1.0), 0.0)
    to_top = wiring.math("SUBTRACT", 1.0, along)
    arc = wiring.math("SQRT", wiring.math("SUBTRACT", 1.0, wiring.math("MULTIPLY", to_top, to_top)))
    rounder = wiring.math("MULTIPLY", source.outputs["Roundness"], wiring.math("SUBTRACT", arc, along))
    lift = wiring.math("MULTIPLY", wiring.math("ADD", along, rounder), source.outputs["Height"])
    length = wiring.math("MULTIPLY", lift, wiring.enabled(statistic.outputs, "Max"))
    offset = wiring.node("ShaderNodeVectorMath")
    offset.operation = "SCALE"
    wiring.link(wiring.normal(), offset.inputs[0])
    wiring.link(length, offset.inputs["Scale"])
    moved = wiring.node("GeometryNodeSetPosition")
    wiring.link(fine.outputs["Mesh"], moved.inputs["Geometry"])
    wiring.link(offset.outputs["Vector"], moved.inputs["Offset"])
    wiring.link(moved.outputs["Geometry"], sink.inputs["Geometry"])
    return group


def _tubes(name: str) -> bpy.types.NodeTree:
    """Edges of cells to tubes, as thick as they are long: thin about small cells; a ball closes each end.

    What has faces stays as it is: where edges are tubes already, each edge of these would become one.
    """
    group, source, sink = _new_modifier(name)
    _add_input(group, "Thickness", 0.12, 1.0)
    _add_input(group, "Resolution", 8, 64, "Int")
    compat.new_group_socket(group, "Material", "INPUT", "NodeSocketMaterial")
    wiring = Wiring(group)
    made = {
        name: wiring.node(f"GeometryNode{kind}")
        for name, kind in (
            ("parts", "SeparateComponents"), ("curves", "MeshToCurve"), ("all", "JoinGeometry"),
            ("length", "SplineLength"), ("circle", "CurvePrimitiveCircle"), ("ball", "MeshUVSphere"),
            ("ends", "CurveEndpointSelection"), ("balls", "InstanceOnPoints"), ("real", "RealizeInstances"),
            ("joined", "JoinGeometry"), ("smooth", "SetShadeSmooth"), ("painted", "SetMaterial"),
            ("captured", "StoreNamedAttribute"), ("size", "AttributeDomainSize"), ("bare", "DeleteGeometry"),
        )
    }  # fmt: skip
    link = wiring.link
    link(source.outputs["Geometry"], made["parts"].inputs["Geometry"])
    link(made["parts"].outputs["Mesh"], made["curves"].inputs["Mesh"])
    link(made["parts"].outputs["Mesh"], made["size"].inputs["Geometry"])
    is_wire = wiring.compared(wiring.enabled(made["size"].outputs, "Face Count"), "EQUAL", 0)
    link(is_wire, made["curves"].inputs["Selection"])
    link(made["parts"].outputs["Mesh"], made["bare"].inputs["Geometry"])
    link(is_wire, made["bare"].inputs["Selection"])
    link(made["parts"].outputs["Curve"], made["all"].inputs["Geometry"])
    link(made["curves"].outputs["Curve"], made["all"].inputs["Geometry"])
    radius = wiring.math(
        "MULTIPLY", made["length"].outputs["Length"], wiring.math("MULTIPLY", source.outputs["Thickness"], 0.5)
    )
    link(source.outputs["Resolution"], made["circle"].inputs["Resolution"])
    made["circle"].inputs["Radius"].default_value = 1.0
    swept = compat.add_swept_curve(wiring, made["all"].outputs["Geometry"], made["circle"].outputs["Curve"], radius)
    link(source.outputs["Resolution"], made["ball"].inputs["Segments"])
    link(wiring.math("MULTIPLY", source.outputs["Resolution"], 0.75), made["ball"].inputs["Rings"])
    made["captured"].data_type, made["captured"].domain = "FLOAT", "POINT"
    made["captured"].inputs["Name"].default_value = "saddleback_tube_radius"
    link(made["all"].outputs["Geometry"], made["captured"].inputs["Geometry"])
    link(radius, wiring.enabled(made["captured"].inputs, "Value"))
    link(made["captured"].outputs["Geometry"], made["balls"].inputs["Points"])
    link(made["ends"].outputs["Selection"], made["balls"].inputs["Selection"])
    made["ball"].inputs["Radius"].default_value = 1.0
    link(made["ball"].outputs["Mesh"], made["balls"].inputs["Instance"])
    link(wiring.attribute("saddleback_tube_radius", "FLOAT"), made["balls"].inputs["Scale"])
    link(made["balls"].outputs["Instances"], made["real"].inputs["Geometry"])
    link(swept, made["joined"].inputs["Geometry"])
    link(made["real"].outputs["Geometry"], made["joined"].inputs["Geometry"])
    link(made["joined"].outputs["Geometry"], made["smooth"].inputs["Geometry"])
    link(made["smooth"].outputs["Geometry"], made["painted"].inputs["Geometry"])
    link(source.outputs["Material"], made["painted"].inputs["Material"])
    both = wiring.node("GeometryNodeJoinGeometry")
    link(made["painted"].outputs["Geometry"], both.inputs["Geometry"])
    link(made["bare"].outputs["Geometry"], both.inputs["Geometry"])
    link(both.outputs["Geometry"], sink.inputs["Geometry"])
    return group


def _dots(name: str) -> bpy.types.NodeTree:
    group = nodes.new_dots_group(0.5)
    group.name, group[nodes.MARK] = name, f"asset {name}"
    return group


def _scales(name: str) -> bpy.types.NodeTree:
    """A flat drop on each center, its tip raised, so that it lies over the next one's root."""
    group, source, sink = _new_modifier(name)
    _add_input(group, "Tilt", 0.25, 1.5)
    _add_input(group, "Length", 1.6, 4.0)
    _add_input(group, "Thickness", 0.12, 1.0)
    compat.new_group_socket(group, "Material", "INPUT", "NodeSocketMaterial")
    wiring = Wiring(group)
    ball, bent, smooth, painted = (
        wiring.node(f"GeometryNode{kind}") for kind in ("MeshUVSphere", "Transform", "SetShadeSmooth", "SetMaterial")
    )
    ball.inputs["Segments"].default_value, ball.inputs["Rings"].default_value = 24, 12
    ball.inputs["Radius"].default_value = 1.0
    wiring.link(ball.outputs["Mesh"], bent.inputs["Geometry"])
    size, turn = wiring.node("ShaderNodeCombineXYZ"), wiring.node("ShaderNodeCombineXYZ")
    size.inputs["Y"].default_value = 1.0
    wiring.link(source.outputs["Length"], size.inputs["X"])
    wiring.link(source.outputs["Thickness"], size.inputs["Z"])
    wiring.link(wiring.math("MULTIPLY", source.outputs["Tilt"], -1.0), turn.inputs["Y"])
    wiring.link(size.outputs["Vector"], bent.inputs["Scale"])
    wiring.link(turn.outputs["Vector"], bent.inputs["Rotation"])
    wiring.link(bent.outputs["Geometry"], smooth.inputs["Geometry"])
    wiring.link(smooth.outputs["Geometry"], painted.inputs["Geometry"])
    wiring.link(source.outputs["Material"], painted.inputs["Material"])
    nodes.place_instances(group, source, sink, (), painted.outputs["Geometry"])
    return group


def _new_shader_group(name: str, colors: dict[str, tuple[float, float, float]]) -> tuple[bpy.types.NodeTree, Any, Any]:
    group = bpy.data.node_groups.new(name, "ShaderNodeTree")
    group[nodes.MARK] = f"asset {name}"
    compat.new_group_socket(group, "Color", "OUTPUT", "NodeSocketColor")
    for label, color in colors.items():
        compat.new_group_socket(group, label, "INPUT", "NodeSocketColor").default_value = (*color, 1.0)
    return group, group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")


def _cell_color(name: str) -> bpy.types.NodeTree:
    """Each cell a color of its own about the one given, and joints by the distance from its edge."""
    group, source, sink = _new_shader_group(name, {"Color": (0.35, 0.2, 0.1), "Joint Color": (0.02, 0.02, 0.02)})
    _add_input(group, "Variation", 0.25, 1.0)
    _add_input(group, "Joint Width", 0.0, 1000.0)
    wiring = Wiring(group)
    cell, distance, noise = (
        wiring.node(kind) for kind in ("ShaderNodeAttribute", "ShaderNodeAttribute", "ShaderNodeTexWhiteNoise")
    )
    cell.attribute_name, distance.attribute_name = CELL_ATTRIBUTE, EDGE_DISTANCE_ATTRIBUTE
    noise.noise_dimensions = "1D"
    wiring.link(wiring.math("ROUND", cell.outputs["Fac"], 0.0), noise.inputs["W"])
    parts, shifted = wiring.node("ShaderNodeSeparateColor"), wiring.node("ShaderNodeHueSaturation")
    wiring.link(noise.outputs["Color"], parts.inputs[0])

    def varied(chance: Any, middle: float) -> Any:
        """Returns middle +- half of Variation."""
        away = wiring.math("MULTIPLY", wiring.math("SUBTRACT", chance, 0.5), source.outputs["Variation"])
        return wiring.math("ADD", away, middle)

    wiring.link(varied(parts.outputs[0], 0.5), shifted.inputs["Hue"])
    wiring.link(wiring.math("MULTIPLY", varied(parts.outputs[1], 0.5), 2.0), shifted.inputs["Value"])
    wiring.link(source.outputs["Color"], shifted.inputs["Color"])
    mixed = wiring.node("ShaderNodeMix")
    mixed.data_type = "RGBA"
    is_joint = wiring.math(
        "LESS_THAN", distance.outputs["Fac"], wiring.math("MULTIPLY", source.outputs["Joint Width"], 0.5)
    )
    wiring.link(is_joint, wiring.enabled(mixed.inputs, "Factor"))
    wiring.link(shifted.outputs["Color"], wiring.enabled(mixed.inputs, "A"))
    wiring.link(source.outputs["Joint Color"], wiring.enabled(mixed.inputs, "B"))
    wiring.link(wiring.enabled(mixed.outputs, "Result"), sink.inputs["Color"])
    return group


def _distance_ramp(name: str) -> bpy.types.NodeTree:
    """What the preview of a distance shows, with its numbers as inputs."""
    group, source, sink = _new_shader_group(name, {})
    for label, value in ((preview.FARTHEST, 1.0), (preview.SPACING, 0.1), (preview.DARKNESS, preview.LINE_DARKNESS)):
        _add_input(group, label, value, 1e9)
    color = preview.add_ramp(group)
    group.nodes[preview.ATTRIBUTE].attribute_name = DISTANCE_ATTRIBUTE
    for label in (preview.FARTHEST, preview.SPACING, preview.DARKNESS):
        group.links.new(source.outputs[label], group.nodes[label].inputs[1])
    group.links.new(color, sink.inputs["Color"])
    return group


ASSETS = (
    Asset(
        "Cell Panels", "Plates with joints, by the distance to the edges of cells",
        lambda name: _raised_cells(name, 0.15, 0.12, 0.2, 0.2),
    ),
    Asset(
        "Cell Pebbles", "Domes, by the distance to the edges of cells",
        lambda name: _raised_cells(name, 0.1, 0.9, 0.6, 1.0),
    ),
    Asset("Cell Color", "Each cell a color of its own, and joints between them", _cell_color),
    Asset("Tubes by Cell Size", "Tubes along the edges of cells, thin about small cells", _tubes),
    Asset("Stipple Dots", "A flat dot on each center of a cell", _dots),
    Asset("Distance Ramp", "Colors and lines by the distance along the surface", _distance_ramp),
    Asset("Overlapping Scales", "A raised scale on each center of a cell", _scales),
)  # fmt: skip

# SPDX-License-Identifier: GPL-3.0-or-later
"""Node groups that take points along with a mesh that is deformed.

Each point knows the triangle of the mesh that it stands on: its three vertices, where in it the point is, and how it is
shifted (and turned) as seen from there: along the triangle's first side, along the mesh's smooth normal, and across
both. The group looks up where those vertices are now, after all modifiers. A mesh that has another number of vertices
by then, say of another subdivision level in the render than in the viewport, is asked by places instead: where is now
what was there at rest? Blender keeps the places at rest as an attribute of the mesh. Where it does not, the points stay
where they were put. A mesh that repeats faces by then, as a mirror makes it, has several answers: there the vertices
are looked up after all, where they are the same at rest. Points of meshes carry what they know as attributes; curve
objects cannot, so that for them a hidden mesh keeps it, in order.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from . import compat, rollback
from .nodes import (
    FOLLOW,
    NORMAL_ATTRIBUTE,
    ROTATION_ATTRIBUTE,
    lay_out,
    modifier_of,
    new_group,
    put_group,
    remove_modifier,
)
from .wiring import Wiring

# Of the points: the vertices of the triangle, the weights of each, and vectors as seen from there.
CORNER_ATTRIBUTES = ("saddleback_corner_a", "saddleback_corner_b", "saddleback_corner_c")
WEIGHTS_ATTRIBUTE, SHIFT_ATTRIBUTE = "saddleback_barycentric", "saddleback_shift"
X_ATTRIBUTE, Z_ATTRIBUTE = "saddleback_axis_x", "saddleback_axis_z"
# Of the points: where they stand on the mesh at rest, and a step from there along the triangle's first side.
REST_ATTRIBUTES = ("saddleback_rest", "saddleback_rest_x")
REST_POSITION = "rest_position"  # Blender's own, of the mesh
# Of the mesh, within the groups: where its vertices are now, and their normals, as seen from the points.
NOW_POSITION, NOW_NORMAL = "saddleback_now", "saddleback_normal_now"
# Inputs of the groups.
HOST, KEEPER = "Surface", "Anchors"
KEY = "saddleback_key"  # on the groups: all that they were made from

# How points find their place on a mesh of another number of vertices: by where they stand at rest; by the numbers of
# its vertices, of which the first are those that were read; not at all.
BY_PLACE, BY_NUMBER, NOT_AT_ALL = "place", "number", "nothing"
# Of the area at rest: what is more than that repeats faces; a face that is less has no inside to be found on.
REPEATED, NO_AREA = 1.5, 1e-12
SAME_REST = 1e-4  # of the root of the area at rest: places that are nearer to each other are the same
# Of the spread of the places at rest: by how much sums of the same numbers differ in another order, and what is more.
SAME_SUM, OTHER_SUM = 1e-5, 1e-4

Read = Callable[[str, str], Any]  # of an attribute's name and type: the socket that gives it


@dataclass(frozen=True)
class Host:
    """The mesh that points follow, as seen from the object with the points, whose origin is the same."""

    item: bpy.types.Object
    axes: tuple[tuple[float, ...], ...]  # three: where its unit vectors lead
    vertex_count: int
    otherwise: str  # BY_PLACE, BY_NUMBER, NOT_AT_ALL
    area: float  # of its faces at rest, as the item's own space has it
    sums: tuple[tuple[float, ...], ...] = ()  # of its places at rest, see `sums_of`

    @property
    def normal_axes(self) -> tuple[tuple[float, ...], ...]:
        """What its unit normals become."""
        return tuple(map(tuple, np.linalg.inv(np.array(self.axes)).T.tolist()))

    @classmethod
    def of(
        cls,
        item: bpy.types.Object,
        place: Matrix,
        vertex_count: int,
        otherwise: str,
        area: float,
        rest: NDArray[np.float64] | None = None,
    ) -> Host:
        """Returns it as seen from an object whose world matrix is `place`; `rest` (V, 3): where its vertices are so."""
        own, world = (np.array(matrix, np.float64)[:3, :3] for matrix in (place, item.matrix_world))
        seen = np.linalg.inv(own) @ world
        # Rounding goes, so that runs of objects of the same scale share a group.
        axes = np.round(seen, 6 - math.ceil(math.log10(np.abs(seen).max())))
        sums = () if rest is None or otherwise != BY_PLACE else sums_of(rest)
        return cls(item, tuple(map(tuple, axes.T.tolist())), vertex_count, otherwise, float(f"{area:.3g}"), sums)


def sums_of(places: NDArray[np.float64]) -> tuple[tuple[float, ...], ...]:
    """The mean of places (V, 3), that of their squares about it, and that of themselves times their shares of all.

    Vertices that were only sorted, as by *Sort Elements*, have the first two in common, and not the third; of those
    that were moved the first two are others, too.
    """
    middle = places.mean(axis=0)
    off = places - middle
    shares = (np.arange(len(places)) / len(places))[:, None]
    return tuple(tuple(sums.tolist()) for sums in (middle, (off**2).mean(axis=0), (shares * off).mean(axis=0)))


@dataclass(frozen=True)
class Known:
    """Tells what points know beside the place where they stand."""

    is_shifted: bool = True  # SHIFT_ATTRIBUTE: they are not on the surface
    is_turned: bool = False  # X_ATTRIBUTE, Z_ATTRIBUTE: what is put on them turns
    keeper: bpy.types.Object | None = None  # whose mesh has a vertex with the attributes for each point


def set_following(item: bpy.types.Object, host: Host, known: Known) -> bpy.types.Modifier:
    """Takes the points of a mesh, or of a curve object, along with the host."""
    key = repr((host.axes, host.vertex_count, host.otherwise, host.area, host.sums))
    key += repr((known.is_shifted, known.is_turned, known.keeper is not None))
    group = next((group for group in bpy.data.node_groups if group.get(KEY) == key and group.library is None), None)
    if group is None:
        group = _new_follow_group(host, known)
        group[KEY] = key
    inputs = {HOST: host.item} if known.keeper is None else {HOST: host.item, KEEPER: known.keeper}
    return put_group(item, FOLLOW, "Saddleback Follow", group, inputs)


def follows(item: bpy.types.Object, host: bpy.types.Object) -> bool:
    """Tells whether an object's points are taken along with the host."""
    modifier = modifier_of(item, FOLLOW)
    return modifier is not None and compat.modifier_input(modifier, HOST) == host


def stop_following(item: bpy.types.Object) -> None:
    """Leaves the points where they are."""
    modifier = modifier_of(item, FOLLOW)
    if modifier is not None:
        rollback.when_written(partial(remove_modifier, item, modifier))


def _new_follow_group(host: Host, known: Known) -> bpy.types.NodeTree:
    group, source, sink = new_group("Saddleback Follow", FOLLOW)
    for name in (HOST,) if known.keeper is None else (HOST, KEEPER):
        compat.new_group_socket(group, name, "INPUT", "NodeSocketObject")
    wiring = Wiring(group)
    read: Read = wiring.attribute
    is_whole = None
    if known.keeper is not None:
        info = wiring.node("GeometryNodeObjectInfo")
        wiring.link(source.outputs[KEEPER], info.inputs["Object"])
        kept = info.outputs["Geometry"]
        read = wiring.kept_by(kept)
        # An artist's bevel makes a mesh of the curve, of whose vertices nothing is known.
        is_whole = wiring.compared(
            wiring.count(source.outputs["Geometry"], "CURVE"), "EQUAL", wiring.count(kept, "MESH")
        )
    now = _triangle_now(wiring, source, host, known, read, is_whole)
    shown = source.outputs["Geometry"]
    if known.is_turned:
        for name, value in (
            (ROTATION_ATTRIBUTE, _turn_of(wiring, now, wiring.attribute(ROTATION_ATTRIBUTE, "FLOAT_VECTOR"))),
            (NORMAL_ATTRIBUTE, _normal_of(wiring, now, wiring.attribute(NORMAL_ATTRIBUTE, "FLOAT_VECTOR"))),
        ):
            shown = wiring.stored(shown, name, value)
    moved = group.nodes.new("GeometryNodeSetPosition")
    wiring.link(shown, moved.inputs["Geometry"])
    wiring.link(_place_of(wiring, now, read if known.is_shifted else None), moved.inputs["Position"])
    wiring.link(moved.outputs["Geometry"], sink.inputs["Geometry"])
    lay_out((source,), moved, sink)
    return group


@dataclass(frozen=True)
class _TriangleNow:
    """Sockets about the triangle that a point stands on."""

    is_known: Any  # where the point is on the mesh by now
    own: Any  # where the point was put
    foot: Any  # where on the triangle it stands by now
    axes: tuple[Any, Any, Any] | None  # there, for points that are shifted or turned


def _triangle_now(wiring: Wiring, source: Any, host: Host, known: Known, read: Read, is_whole: Any) -> _TriangleNow:
    info = wiring.node("GeometryNodeObjectInfo")
    wiring.link(source.outputs[HOST], info.inputs["Object"])
    mesh = info.outputs["Geometry"]
    count = wiring.count(mesh, "MESH")
    is_same = is_known = wiring.compared(count, "EQUAL", host.vertex_count)

    # All of the mesh as seen from the points, of which three vertices are looked up.
    own = wiring.node("GeometryNodeInputPosition").outputs["Position"]
    seen = wiring.combined(own, host.axes)
    corners = [wiring.sampled(mesh, "FLOAT_VECTOR", seen, read(name, "INT")) for name in CORNER_ATTRIBUTES]
    foot = wiring.combined(read(WEIGHTS_ATTRIBUTE, "FLOAT_VECTOR"), corners)
    has_axes = known.is_shifted or known.is_turned
    if has_axes:
        side = wiring.vector("SUBTRACT", corners[1], corners[0])
        upward = wiring.combined(wiring.normal(), host.normal_axes)
        normals = [wiring.sampled(mesh, "FLOAT_VECTOR", upward, read(name, "INT")) for name in CORNER_ATTRIBUTES]
        normal = wiring.combined(read(WEIGHTS_ATTRIBUTE, "FLOAT_VECTOR"), normals)
    if host.sums:
        is_same = wiring.boolean("NIMPLY", is_same, _is_sorted(wiring, mesh, host))
    if host.otherwise == BY_PLACE:
        values = {NOW_POSITION: seen, NOW_NORMAL: upward} if has_axes else {NOW_POSITION: seen}
        rest = _RestMesh(wiring, mesh, values, host.area)
        place = read(REST_ATTRIBUTES[0], "FLOAT_VECTOR")
        by_number = wiring.boolean("OR", is_same, rest.is_repeated)
        foot = wiring.chosen(by_number, rest.now(NOW_POSITION, place), foot)
        if has_axes:
            step = read(REST_ATTRIBUTES[1], "FLOAT_VECTOR")
            back, ahead = (rest.now(NOW_POSITION, wiring.vector(sign, place, step)) for sign in ("SUBTRACT", "ADD"))
            side = wiring.chosen(by_number, wiring.vector("SUBTRACT", ahead, back), side)
            normal = wiring.chosen(by_number, rest.now(NOW_NORMAL, place), normal)
        resting = wiring.attribute(REST_POSITION, "FLOAT_VECTOR")
        corners = [wiring.sampled(mesh, "FLOAT_VECTOR", resting, read(name, "INT")) for name in CORNER_ATTRIBUTES]
        stands = wiring.combined(read(WEIGHTS_ATTRIBUTE, "FLOAT_VECTOR"), corners)
        is_elsewhere = wiring.is_greater(wiring.distance(stands, place), SAME_REST * math.sqrt(host.area))
        is_lost = wiring.boolean("AND", rest.is_repeated, is_elsewhere)
        is_known = wiring.boolean("OR", is_same, wiring.boolean("NIMPLY", rest.is_there, is_lost))
    elif host.otherwise == BY_NUMBER:
        is_known = wiring.compared(count, "GREATER_EQUAL", host.vertex_count)
    if is_whole is not None:
        is_known = wiring.boolean("AND", is_known, is_whole)
    if not has_axes:
        return _TriangleNow(is_known, own, foot, None)
    z = wiring.vector("NORMALIZE", normal)
    y = wiring.vector("NORMALIZE", wiring.vector("CROSS_PRODUCT", z, side))
    return _TriangleNow(is_known, own, foot, (wiring.vector("CROSS_PRODUCT", y, z), y, z))


def _is_sorted(wiring: Wiring, mesh: Any, host: Host) -> Any:
    """Tells whether the vertices of the mesh have other numbers than those that were read, and are the same."""
    middle, squares, ordered = host.sums
    off = wiring.vector("SUBTRACT", wiring.attribute(REST_POSITION, "FLOAT_VECTOR"), middle)
    share = wiring.math("DIVIDE", wiring.node("GeometryNodeInputIndex").outputs["Index"], float(host.vertex_count))
    wide = math.sqrt(sum(squares))
    is_other = [
        wiring.is_greater(wiring.distance(wiring.mean(mesh, value), wanted), least)
        for value, wanted, least in (
            (off, (0.0, 0.0, 0.0), SAME_SUM * wide),
            (wiring.vector("MULTIPLY", off, off), squares, SAME_SUM * wide**2),
            (wiring.vector("MULTIPLY", off, share), ordered, OTHER_SUM * wide),
        )
    ]
    return wiring.boolean("NIMPLY", is_other[2], wiring.boolean("OR", *is_other[:2]))


class _RestMesh:
    """The mesh with its vertices where they are at rest, and for each of those places what is there now."""

    def __init__(self, wiring: Wiring, mesh: Any, values: dict[str, Any], area: float) -> None:
        self._wiring = wiring
        laid, cut, sizes = map(
            wiring.node,
            ("GeometryNodeSetPosition", "GeometryNodeDeleteGeometry", "GeometryNodeAttributeStatistic"),
        )
        for name, value in values.items():
            mesh = wiring.stored(mesh, name, value)
        wiring.link(mesh, laid.inputs["Geometry"])
        wiring.link(wiring.attribute(REST_POSITION, "FLOAT_VECTOR"), laid.inputs["Position"])
        # What a modifier spans between copies of one vertex, or where no place at rest is kept, has no area there.
        cut.domain = sizes.domain = "FACE"
        size = wiring.node("GeometryNodeInputMeshFaceArea").outputs["Area"]
        has_none = wiring.boolean("NOT", wiring.is_greater(size, NO_AREA * area))
        wiring.link(laid.outputs["Geometry"], cut.inputs["Geometry"])
        wiring.link(has_none, cut.inputs["Selection"])
        self._mesh = cut.outputs["Geometry"]
        wiring.link(self._mesh, sizes.inputs["Geometry"])
        wiring.link(size, wiring.enabled(sizes.inputs, "Attribute"))
        total = wiring.enabled(sizes.outputs, "Sum")
        self.is_there, self.is_repeated = (wiring.is_greater(total, share * area) for share in (0.0, REPEATED))

    def now(self, name: str, place: Any) -> Any:
        """Returns one of the values at the place of the surface that is next to one at rest."""
        made = self._wiring.node("GeometryNodeSampleNearestSurface")
        made.data_type = "FLOAT_VECTOR"
        self._wiring.link(self._mesh, made.inputs["Mesh"])
        value = self._wiring.attribute(name, "FLOAT_VECTOR")
        self._wiring.link(value, self._wiring.enabled(made.inputs, "Value"))
        self._wiring.link(place, made.inputs["Sample Position"])
        return self._wiring.enabled(made.outputs, "Value")


def _place_of(wiring: Wiring, now: _TriangleNow, read: Read | None) -> Any:
    """Returns where a point is now; where it was put where the mesh has become another one."""
    place = now.foot
    if read is not None:
        shift = wiring.combined(read(SHIFT_ATTRIBUTE, "FLOAT_VECTOR"), now.axes)
        place = wiring.vector("ADD", place, shift)
    return wiring.chosen(now.is_known, now.own, place)


def _turn_of(wiring: Wiring, now: _TriangleNow, rotation: Any) -> Any:
    """Returns how what is put on a point is turned now."""
    along, away = (
        wiring.combined(wiring.attribute(name, "FLOAT_VECTOR"), now.axes) for name in (X_ATTRIBUTE, Z_ATTRIBUTE)
    )
    upright = wiring.aligned("Z", "AUTO", away, None)
    return wiring.chosen(now.is_known, rotation, wiring.aligned("X", "Z", along, upright))


def _normal_of(wiring: Wiring, now: _TriangleNow, normal: Any) -> Any:
    away = wiring.combined(wiring.attribute(Z_ATTRIBUTE, "FLOAT_VECTOR"), now.axes)
    return wiring.chosen(now.is_known, normal, away)

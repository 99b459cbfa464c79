# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads at points of a surface what an artist put on the mesh: groups, UV maps, attributes, shading, materials."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ... import compat
from ...core.results import Indices, Reals
from ...core.surfaces.carried import Anchors
from ...follow_nodes import REST_POSITION
from ...rollback import ELEMENTS
from ..outputs.out_attributes import KINDS, recorded
from .groups_in import group_numbers
from .mesh_in import read_triangles

# What Blender itself keeps as attributes, and what has a place of its own below.
NOT_CARRIED = ("position", "material_index", "sharp_face", "sharp_edge", "custom_normal", REST_POSITION)


@dataclass(frozen=True)
class Carried:
    """Holds at n points: number attributes, UV places, weights by group name as (points, weights); and of their
    polygons.
    """

    attributes: dict[str, NDArray[Any]]
    uv_maps: dict[str, NDArray[np.float32]]  # (n, 2)
    groups: dict[str, tuple[NDArray[np.int32], NDArray[np.float64]]]
    smooth: NDArray[np.bool_]  # (n,)
    material: NDArray[np.int32]  # (n,)


def read_carried(
    source: bpy.types.Object, mesh: bpy.types.Mesh, faces: Indices, barycentric: Reals, has_corners: bool = False
) -> Carried:
    """Reads what `mesh`, the source's own or evaluated one, has at points of the surface that was read from it.

    `faces` (n,), `barycentric` (n, 3). With `has_corners` the points are corners of polygons, which have no attributes
    and groups of their own: both are left out.
    """
    anchors = _anchors(source, mesh, faces, barycentric)
    return Carried(
        attributes={} if has_corners else _attributes(source, mesh, anchors),
        uv_maps={layer.name: anchors.values(_uv(layer), "CORNER") for layer in mesh.uv_layers},
        groups={} if has_corners else _groups(source, mesh, anchors),
        smooth=_smooth(mesh)[anchors.polygons],
        material=compat.read_numbers(mesh.polygons, "material_index")[anchors.polygons],
    )


def _anchors(source: bpy.types.Object, mesh: bpy.types.Mesh, faces: Indices, barycentric: Reals) -> Anchors:
    mesh.calc_loop_triangles()
    loops = compat.read_numbers(mesh.loop_triangles, "loops", 3)
    polygons = compat.read_numbers(mesh.loop_triangles, "polygon_index")
    # The surface of a mirrored object has its triangles the other way round.
    order = [2, 1, 0] if source.matrix_world.determinant() < 0 else [0, 1, 2]
    return Anchors(
        vertices=read_triangles(mesh)[faces][:, order],
        corners=loops.reshape(-1, 3)[faces][:, order],
        polygons=polygons[faces],
        weights=barycentric,
    )


def _attributes(source: bpy.types.Object, mesh: bpy.types.Mesh, anchors: Anchors) -> dict[str, NDArray[Any]]:
    """All numbers but our own results. Edges have no value at a point of the surface."""
    skipped = {*NOT_CARRIED, *recorded(source.data), *mesh.uv_layers.keys(), *group_numbers(source, mesh)}
    found = {}
    for attribute in mesh.attributes:
        name, kind = attribute.name, attribute.data_type
        if kind not in ELEMENTS or attribute.domain == "EDGE" or name in skipped or name.startswith("."):
            continue
        element, width, dtype = ELEMENTS[kind]
        values: NDArray[Any] = np.empty(len(attribute.data) * width, dtype)
        attribute.data.foreach_get(element, compat.as_copied(values))
        values = values if width == 1 else values.reshape(-1, width)
        values = anchors.values(values, attribute.domain)
        if (values.dtype.kind, values.shape[1:]) in KINDS:
            found[name] = values
    return found


def _uv(layer: Any) -> NDArray[np.float32]:
    values = np.empty(2 * len(layer.data), np.float32)
    layer.data.foreach_get("uv", values)
    return values.reshape(-1, 2)


def _groups(
    source: bpy.types.Object, mesh: bpy.types.Mesh, anchors: Anchors
) -> dict[str, tuple[NDArray[np.int32], NDArray[np.float64]]]:
    """Weights are read of the few vertices beside the points only: Blender hands them out one by one."""
    names = {index: name for name, index in group_numbers(source, mesh).items() if name in source.vertex_groups}
    if not names:
        return {}
    sums: dict[int, dict[int, float]] = {index: defaultdict(float) for index in names}
    for point, (around, weights) in enumerate(zip(anchors.vertices, anchors.weights, strict=True)):
        for vertex, weight in zip(around.tolist(), weights.tolist(), strict=True):
            for element in mesh.vertices[vertex].groups:
                if element.group in sums and weight > 0.0:
                    sums[element.group][point] += weight * element.weight
    return {
        names[index]: (np.fromiter(found, np.int32, len(found)), np.fromiter(found.values(), float, len(found)))
        for index, found in sums.items()
    }


def _smooth(mesh: bpy.types.Mesh) -> NDArray[np.bool_]:
    values = np.empty(len(mesh.polygons), np.bool_)
    mesh.polygons.foreach_get("use_smooth", values)
    return values

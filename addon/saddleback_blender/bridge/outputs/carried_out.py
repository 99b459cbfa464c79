# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes what was read at points of a mesh, onto the objects that have them as vertices."""

from __future__ import annotations

from dataclasses import replace

import bpy
import numpy as np
from numpy.typing import NDArray

from ... import compat
from ..inputs.carried_in import Carried
from .out_attributes import set_attribute


def write_groups(item: bpy.types.Object, carried: Carried) -> None:
    """Makes or fills the vertex groups of an object whose vertices are the points."""
    for name, (vertices, weights) in carried.groups.items():
        group = item.vertex_groups.get(name) or item.vertex_groups.new(name=name)
        for vertex, weight in zip(vertices.tolist(), weights.tolist(), strict=True):
            group.add([vertex], weight, "REPLACE")


def write_layers(mesh: bpy.types.Mesh, at_vertices: Carried, at_corners: Carried, counts: NDArray[np.integer]) -> None:
    """Writes attributes of the vertices, UV maps of the corners, and shading and material of polygons with so many
    corners (p,), each as at its first corner.
    """
    for name, values in at_vertices.attributes.items():
        set_attribute(mesh, name, "POINT", values)
    for name, places in at_corners.uv_maps.items():
        layer = mesh.uv_layers.new(name=name)
        if layer is not None:  # Blender holds eight maps at most
            layer.data.foreach_set("uv", np.ascontiguousarray(places).ravel())
    first = np.cumsum(counts) - counts
    mesh.polygons.foreach_set("use_smooth", at_corners.smooth[first])
    compat.write_numbers(mesh.polygons, "material_index", at_corners.material[first])


def in_written_order(at_corners: Carried, counts: NDArray[np.integer], is_reversed: bool) -> Carried:
    """What was read at corners of polygons, as they are written: the other way round on a mirrored object."""
    if not is_reversed:
        return at_corners
    ends = np.repeat(2 * np.cumsum(counts) - counts - 1, counts)
    back = ends - np.arange(len(ends))
    return replace(
        at_corners,
        uv_maps={name: places[back] for name, places in at_corners.uv_maps.items()},
        smooth=at_corners.smooth[back],
        material=at_corners.material[back],
    )

# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps where a mesh's vertices are at rest, before shape keys, armatures and other modifiers: Blender tells when
asked.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ... import compat, rollback
from ...core.results import Indices, Reals
from ...core.surfaces.local_frames import rest_anchors
from ...follow_nodes import BY_NUMBER, BY_PLACE, NOT_AT_ALL, REST_ATTRIBUTES, REST_POSITION
from ..inputs.mesh_in import mesh_of, read_triangles
from .out_attributes import set_attribute

KEPT = "saddleback_rest"  # on a source: Blender keeps its places at rest because we asked
SAME_PLACE = 1e-6  # of the mesh's extent


@dataclass(frozen=True)
class Rest:
    """Tells where the vertices (V, 3) of the mesh that was read are at rest, in the object's space, and what that is
    good for.
    """

    places: Reals | None  # None where they are not known
    otherwise: str  # how to find a point on a mesh of another number of vertices
    area: float = 0.0  # of the mesh's faces there


def read_rest(context: bpy.types.Context, source: bpy.types.Object, use_modifiers: bool, vertex_count: int) -> Rest:
    """Reads it; from now on Blender keeps the places.

    A place at rest leads back to one point of the surface, unless modifiers repeat faces, as a mirror does.
    """
    if not source.add_rest_position_attribute:
        rollback.remember(source, "add_rest_position_attribute")
        rollback.remember_keys(source, KEPT)
        source.add_rest_position_attribute = True
        source[KEPT] = True
    own = compat.read_positions(source.data)
    if not any(modifier.show_viewport for modifier in source.modifiers):
        return Rest(own.astype(np.float64), BY_PLACE, _area(source.data, own))
    with mesh_of(context, source, True, has_layers=False) as mesh:
        now = _rest_of(mesh)
        if now is None:
            return Rest(None, NOT_AT_ALL)
        starts_with_own = len(now) >= len(own) and np.array_equal(now[: len(own)], own)
        area = _area(mesh if use_modifiers else source.data, now if use_modifiers else own)
        is_unique = len(now) == len(own) or _repeated(mesh, now) <= _repeated(source.data, own)
    read = now if use_modifiers else own
    if len(read) != vertex_count:
        return Rest(None, NOT_AT_ALL)
    by_number = BY_NUMBER if starts_with_own and not use_modifiers else NOT_AT_ALL
    return Rest(read.astype(np.float64), BY_PLACE if is_unique else by_number, area)


def _area(mesh: bpy.types.Mesh, places: NDArray[np.float32]) -> float:
    """The area of the mesh's faces where its vertices are at `places`."""
    corners = places[read_triangles(mesh)].astype(np.float64)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(np.linalg.norm(across, axis=1).sum() / 2.0)


def _rest_of(mesh: bpy.types.Mesh) -> NDArray[np.float32] | None:
    attribute = mesh.attributes.get(REST_POSITION)
    if attribute is None or attribute.domain != "POINT" or attribute.data_type != "FLOAT_VECTOR":
        return None
    flat = np.empty(3 * len(mesh.vertices), np.float32)
    attribute.data.foreach_get("vector", flat)
    return flat.reshape(-1, 3)


def _repeated(mesh: bpy.types.Mesh, places: NDArray[np.float32]) -> float:
    """The share of faces that lie on others where vertices are at `places`: those of a mirror, or of an array."""
    if not len(mesh.polygons):
        return 0.0
    first = compat.read_numbers(mesh.polygons, "loop_start")
    order = np.argsort(first)  # ascending but for meshes of other programs
    corners = places[compat.read_corner_vertices(mesh)].astype(np.float64)
    sums = np.add.reduceat(corners - places.min(axis=0), first[order])
    centers = sums / compat.read_numbers(mesh.polygons, "loop_total")[order][:, None]
    cell = SAME_PLACE * np.ptp(places, axis=0).max() + np.finfo(np.float32).tiny
    numbers = np.round(centers / cell).astype(np.int64) @ np.array([1, 1 << 20, 1 << 40])
    return 1.0 - len(np.unique(numbers)) / len(numbers)


def forget_rest(source: bpy.types.Object) -> None:
    """Blender need not keep them any more, unless the artist wants it."""
    if KEPT in source:
        rollback.remember(source, "add_rest_position_attribute")
        rollback.remember_keys(source, KEPT)
        source.add_rest_position_attribute = False
        del source[KEPT]


def write_rest(mesh: bpy.types.Mesh, rest: Reals, corners: Indices, barycentric: Reals, has_steps: bool) -> None:
    """Writes on a mesh's vertices where they stand on the mesh at rest, and steps from there where they are needed."""
    anchors = rest_anchors(rest, corners, barycentric, has_steps)
    for name, values in zip(REST_ATTRIBUTES, anchors, strict=False):
        set_attribute(mesh, name, "POINT", values)

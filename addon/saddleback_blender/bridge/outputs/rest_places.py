"""Keeps where a mesh's vertices are at rest, before shape keys, armatures and other modifiers: Blender tells when
asked.
"""

from __future__ import annotations

import bpy
import numpy as np

from ... import compat, rollback
from ...core.results import Indices, Reals
from ...core.surfaces.local_frames import rest_anchors
from ...shape_nodes import REST_ATTRIBUTES, REST_POSITION
from ..inputs.mesh_in import mesh_of
from .out_attributes import set_attribute

KEPT = "saddleback_rest"  # on a source: Blender keeps its places at rest because we asked


def read_rest(
    context: bpy.types.Context, source: bpy.types.Object, use_modifiers: bool, vertex_count: int
) -> Reals | None:
    """(V, 3) of the mesh that was read, in the object's space; from now on Blender keeps them.

    None where a place at rest does not lead back to one vertex, as those of a mirror's two halves.
    """
    if not source.add_rest_position_attribute:
        rollback.remember(source, "add_rest_position_attribute")
        rollback.remember_keys(source, KEPT)
        source.add_rest_position_attribute = True
        source[KEPT] = True
    with mesh_of(context, source, use_modifiers) as mesh:
        if len(mesh.vertices) != vertex_count:
            return None
        if not use_modifiers:
            return compat.read_positions(mesh).astype(np.float64)
        attribute = mesh.attributes.get(REST_POSITION)
        if attribute is None:
            return None
        flat = np.empty(3 * vertex_count, np.float32)
        attribute.data.foreach_get("vector", flat)
        places = flat.reshape(-1, 3)
        if vertex_count != len(source.data.vertices) and len(np.unique(places.view("V12"))) != vertex_count:
            return None
        return places.astype(np.float64)


def forget_rest(source: bpy.types.Object) -> None:
    """Blender need not keep them any more, unless the artist wants it."""
    if KEPT in source:
        rollback.remember(source, "add_rest_position_attribute")
        rollback.remember_keys(source, KEPT)
        source.add_rest_position_attribute = False
        del source[KEPT]


def write_rest(mesh: bpy.types.Mesh, rest: Reals | None, corners: Indices, barycentric: Reals) -> None:
    """Writes on a mesh's vertices where they stand on the mesh at rest."""
    if rest is not None:
        for name, values in zip(REST_ATTRIBUTES, rest_anchors(rest, corners, barycentric), strict=True):
            set_attribute(mesh, name, "POINT", values)

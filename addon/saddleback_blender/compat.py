"""Differences between Blender 3.4 and 5.x, each behind one function: the only file that tests features or versions."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray


def read_positions(mesh: bpy.types.Mesh) -> NDArray[np.float32]:
    """(V, 3) object-space positions. The attribute (3.5 on) is one memory copy, `co` a loop over elements."""
    positions = np.empty(3 * len(mesh.vertices), np.float32)
    attribute = mesh.attributes.get("position")
    if attribute is not None:
        attribute.data.foreach_get("vector", positions)
    else:
        mesh.vertices.foreach_get("co", positions)
    return positions.reshape(-1, 3)


def write_positions(mesh: bpy.types.Mesh, positions: NDArray[np.float32]) -> None:
    """Sets the (V, 3) object-space positions."""
    mesh.vertices.foreach_set("co", np.ascontiguousarray(positions, np.float32).ravel())


def read_corner_vertices(mesh: bpy.types.Mesh) -> NDArray[np.int32]:
    """(L,) vertex of each face corner."""
    vertices = np.empty(len(mesh.loops), np.int32)
    attribute = mesh.attributes.get(".corner_vert")
    if attribute is not None:
        attribute.data.foreach_get("value", vertices)
    else:
        mesh.loops.foreach_get("vertex_index", vertices)
    return vertices


def read_edge_vertices(mesh: bpy.types.Mesh) -> NDArray[np.int32]:
    """(E, 2) vertices of each edge."""
    vertices = np.empty(2 * len(mesh.edges), np.int32)
    attribute = mesh.attributes.get(".edge_verts")
    if attribute is not None:
        attribute.data.foreach_get("value", vertices)
    else:
        mesh.edges.foreach_get("vertices", vertices)
    return vertices.reshape(-1, 2)


def read_selected_vertices(mesh: bpy.types.Mesh) -> NDArray[np.bool_]:
    """(V,) selected in Edit Mode, as last left."""
    selected = np.zeros(len(mesh.vertices), bool)
    mesh.vertices.foreach_get("select", selected)
    return selected


def read_sculpt_mask(mesh: bpy.types.Mesh) -> NDArray[np.float32] | None:
    """(V,) sculpt mask, 0 to 1; None where the mesh has none. An attribute from 4.1 on, a layer of its own before."""
    values = np.zeros(len(mesh.vertices), np.float32)
    if hasattr(mesh, "vertex_paint_masks"):
        if not mesh.vertex_paint_masks:
            return None
        mesh.vertex_paint_masks[0].data.foreach_get("value", values)
        return values
    attribute = mesh.attributes.get(".sculpt_mask")
    if attribute is None:
        return None
    attribute.data.foreach_get("value", values)
    return values


def active_color_name(mesh: bpy.types.Mesh) -> str:
    """Name of the colour attribute that is painted on, "" where there is none."""
    active = mesh.color_attributes.active_color
    return active.name if active is not None else ""


def identity(data: bpy.types.ID) -> int:
    """A number of its own for each data-block of a session, where Blender has one; else 0."""
    return int(getattr(data, "session_uid", 0))


def draw_progress(layout: bpy.types.UILayout, owner: Any, factor_property: str, text: str) -> None:
    """A progress bar: `layout.progress` from 4.0 on, a slider of `owner`'s property before."""
    if hasattr(layout, "progress"):
        layout.progress(factor=getattr(owner, factor_property), text=text)
    else:
        layout.prop(owner, factor_property, text=text, slider=True)

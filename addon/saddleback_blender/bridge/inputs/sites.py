# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads where cells are centered, and distances and paths begin: vertices chosen or painted, objects, curves, the
cursor. Places are as the surface has them.
"""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ... import compat
from ...blocks import find
from ...core.errors import BadInputError
from ...core.requests import Points, Polyline
from ...core.results import Reals
from ...core.settings import DistanceSettings, PathSettings, TessellateSettings
from .curves_in import read_curves
from .density import read_vertex_group
from .evaluated import places_of
from .mesh_in import modified, scaled, seen_by, to_world


def read_sites(
    context: bpy.types.Context, source: bpy.types.Object, mesh: bpy.types.Mesh, settings: TessellateSettings
) -> Points | None:
    """The chosen sites; None where a count is to be placed."""
    if settings.sites_source == "SELECTED":
        return selected_vertices(source, mesh)
    if settings.sites_source == "OBJECT":
        return object_points(context, source, settings.sites_object)
    return None


def read_sources(
    context: bpy.types.Context, source: bpy.types.Object, mesh: bpy.types.Mesh, settings: DistanceSettings
) -> Points | tuple[Polyline, ...]:
    """Returns where distances are measured from."""
    if settings.sources == "VERTEX_GROUP":
        vertices = group_vertices(source, mesh, settings.sources_group, "choose another source")
        return _some(source, mesh, vertices, "in the group, so all distances are 0; measure from fewer")
    if settings.sources == "EMPTIES":
        return empty_points(context, source, settings.sources_collection)
    if settings.sources == "CURVES":
        return read_curves(source, settings.sources_object, settings.sources_collection)
    if settings.sources in ("CURSOR", "CURSOR_PARTS"):
        return cursor_point(context, source)
    vertices = selected_vertices(source, mesh)
    return _some(
        source, mesh, vertices, "selected, so all distances are 0; select fewer in Edit Mode, or choose the 3D Cursor"
    )


def read_path_points(
    context: bpy.types.Context, source: bpy.types.Object, mesh: bpy.types.Mesh, settings: PathSettings
) -> Points:
    """Returns what paths run through, in order."""
    points: Points
    if settings.points == "CURSOR":
        return cursor_point(context, source)
    if settings.points == "VERTEX_GROUP":
        points = group_vertices(source, mesh, settings.points_group, "choose other points")
        points = _some(source, mesh, points, "in the group, and a path leads from point to point; choose fewer")
    elif settings.points == "EMPTIES":
        points = empty_points(context, source, settings.points_collection)
    else:
        points = selected_vertices(source, mesh)
        points = _some(
            source, mesh, points,
            "selected, and a path leads from point to point; select fewer in Edit Mode, or choose the 3D Cursor",
        )  # fmt: skip
        if len(points) > 2 and settings.connect != "PAIRS" and not settings.use_modifiers:
            points = compat.in_order_of_selection(mesh, points)
    if not settings.from_cursor:
        return points
    if points.ndim == 1:
        points = scaled(source, compat.read_positions(mesh)[points])
    return np.concatenate([cursor_point(context, source), points])


def _some(source: bpy.types.Object, mesh: bpy.types.Mesh, vertices: NDArray[np.int32], what: str) -> NDArray[np.int32]:
    """The vertices, which must not be all there are: those of a mesh just added or imported are all selected."""
    if len(vertices) == len(mesh.vertices):
        raise BadInputError(f"'{source.name}': all its {len(vertices):,} vertices are {what}")
    return vertices


def group_vertices(source: bpy.types.Object, mesh: bpy.types.Mesh, name: str, otherwise: str) -> NDArray[np.int32]:
    """(n,) vertices whose weight in a group is above one half."""
    weights, label = read_vertex_group(source, mesh, name, otherwise)
    vertices = np.nonzero(weights > 0.5)[0].astype(np.int32)
    if not len(vertices):
        raise BadInputError(f"'{source.name}': no vertex has a weight above 0.5 in {label}; paint it, or {otherwise}")
    return vertices


def cursor_point(context: bpy.types.Context, source: bpy.types.Object) -> Reals:
    """(1, 3) place of the 3D cursor."""
    return seen_by(source, np.array([context.scene.cursor.location[:]], np.float64))


def selected_vertices(source: bpy.types.Object, mesh: bpy.types.Mesh) -> NDArray[np.int32]:
    """(n,) vertices selected in Edit Mode."""
    vertices = np.nonzero(compat.read_selected_vertices(mesh))[0].astype(np.int32)
    if not len(vertices):
        raise BadInputError(f"'{source.name}' has no selected vertex; select some in Edit Mode, then leave it")
    return vertices


def object_points(context: bpy.types.Context, source: bpy.types.Object, name: str) -> Reals:
    """(n, 3) places of another mesh object's vertices, as its modifiers leave them."""
    other = find(bpy.data.objects, name)
    if other is None:
        missing = f"there is no object '{name}'" if name else "no object is chosen"
        raise BadInputError(f"'{source.name}': {missing} to take sites from; choose one")
    if other == source:
        raise BadInputError(f"'{source.name}' cannot take its sites from itself; choose another object, or Selected")
    if other.type != "MESH":
        raise BadInputError(f"'{name}' is no mesh object, so '{source.name}' cannot take sites from it; choose a mesh")
    with modified(context, other, has_layers=False) as (shown, mesh):
        points = seen_by(source, to_world(shown, compat.read_positions(mesh)))
    if not len(points):
        raise BadInputError(
            f"'{name}' has no vertices, so '{source.name}' cannot take sites from it; choose another object"
        )
    return points


def empty_points(
    context: bpy.types.Context, source: bpy.types.Object, collection: str, purpose: str = "to measure from"
) -> Reals:
    """(n, 3) places of the empties in a collection or, without one, of those parented to the object."""
    if collection:
        group = find(bpy.data.collections, collection)
        if group is None:
            raise BadInputError(
                f"'{source.name}': there is no collection '{collection}' to take empties from; choose one"
            )
        candidates, where = list(group.all_objects), f"in collection '{collection}'"
    else:
        candidates, where = list(source.children), f"parented to '{source.name}'"
    # By name, so that the sources' order does not depend on the order of linking.
    empties = sorted((item for item in candidates if item.type == "EMPTY"), key=lambda item: item.name_full)
    if not empties:
        raise BadInputError(f"'{source.name}': no empty is {where}; add one at each place {purpose}")
    return seen_by(source, places_of(context, empties))

# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads what a plane diagram is made from: UV maps, images, sites with weights."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ... import compat
from ...blocks import find
from ...core.errors import BadInputError
from ...core.fields import darkness
from ...core.requests import Points
from ...core.results import Reals
from ...core.settings import Voronoi2dSettings
from .density import NUMBER_TYPES
from .images_in import read_pixels
from .mesh_in import mesh_of
from .sites import cursor_point, empty_points, object_points, selected_vertices


def read_uv(
    source: bpy.types.Object, mesh: bpy.types.Mesh, name: str, otherwise: str = " or choose Disk as its space"
) -> Reals:
    """(3 F, 2) UV places of the corners of the triangles that `read_surface` gives."""
    layer = mesh.uv_layers.get(name) if name else mesh.uv_layers.active
    if layer is None:
        missing = f"no UV map '{name}'" if name else "no UV map"
        raise BadInputError(f"'{source.name}' has {missing}; unwrap it (UV > Unwrap){otherwise}")
    places = np.empty(2 * len(mesh.loops), np.float32)
    layer.data.foreach_get("uv", places)
    corners = read_triangle_corners(mesh)
    if source.matrix_world.determinant() < 0:
        corners = corners[:, ::-1]
    return places.reshape(-1, 2)[corners.ravel()].astype(np.float64)


def read_triangle_corners(mesh: bpy.types.Mesh) -> NDArray[np.int32]:
    """(F, 3) face corners of the mesh's triangles, in the order of `read_triangles`."""
    mesh.calc_loop_triangles()
    return compat.read_numbers(mesh.loop_triangles, "loops", 3).reshape(-1, 3)


def read_voronoi_sites(
    context: bpy.types.Context, source: bpy.types.Object, mesh: bpy.types.Mesh, settings: Voronoi2dSettings
) -> tuple[Points | None, Reals | None]:
    """The chosen sites and their weights; None where they are to be placed, or weigh the same."""
    if settings.sites_source == "SELECTED":
        vertices = selected_vertices(source, mesh)
        weights = _weights(source, mesh, settings.weights_name)
        return vertices, None if weights is None else weights[vertices]
    if settings.sites_source == "OBJECT":
        points = object_points(context, source, settings.sites_object)
        other = find(bpy.data.objects, settings.sites_object)
        with mesh_of(context, other, True) as sites_mesh:
            return points, _weights(other, sites_mesh, settings.weights_name)
    if settings.weights_name:
        raise BadInputError(
            f"'{source.name}': only vertices have weights; leave their name empty, or choose Selected or "
            "Object for the sites"
        )
    return None, None


def _weights(item: bpy.types.Object, mesh: bpy.types.Mesh, name: str) -> Reals | None:
    """(V,) numbers of a vertex attribute."""
    if not name:
        return None
    attribute = mesh.attributes.get(name)
    if attribute is None:
        raise BadInputError(f"'{item.name}' has no attribute '{name}' for the weights; check its name")
    if attribute.domain != "POINT" or attribute.data_type not in NUMBER_TYPES:
        raise BadInputError(
            f"'{item.name}': attribute '{name}' is no number of vertices; choose another for the weights"
        )
    prop, dtype = NUMBER_TYPES[attribute.data_type]
    values: NDArray[np.generic] = np.zeros(len(attribute.data), dtype)
    attribute.data.foreach_get(prop, compat.as_copied(values))
    return values.astype(np.float64)


def read_circles(context: bpy.types.Context, source: bpy.types.Object, settings: Voronoi2dSettings) -> Reals | None:
    """(m, 3) places that a sweep's circles grow from; None where they are to be placed."""
    if not settings.animate or settings.circles not in ("CURSOR", "EMPTIES"):
        return None
    if settings.circles == "CURSOR":
        return cursor_point(context, source)
    return empty_points(context, source, settings.circles_collection, "to grow a circle from")


def read_darkness(source: bpy.types.Object, settings: Voronoi2dSettings) -> Reals | None:
    """(rows, columns) how dark the chosen image is, the first row below; None where sites do not come from one."""
    if settings.sites_source != "IMAGE":
        return None
    name = settings.image_name
    image = find(bpy.data.images, name)
    if image is None:
        missing = f"there is no image '{name}'" if name else "there is no image chosen"
        raise BadInputError(f"'{source.name}': {missing} to place sites by; choose one")
    pixels, is_encoded = read_pixels(source, image)
    return darkness.darkness(pixels, is_encoded, settings.image_invert)

# SPDX-License-Identifier: GPL-3.0-or-later
"""What each class of shapes has of its own, from its object's properties; the shapes that lie there already."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

from ... import compat, nodes
from ...core.errors import BadInputError
from ...core.fields import density as density_maths
from ...core.fields.density import DensityError
from ...core.requests import ClassOrder, GivenDirections, KeptShapes
from ...core.results import Reals
from ...core.settings import DistributeSettings
from ...core.shapes.shape_templates import ShapeTemplate, sized
from ...core.surfaces.quaternions import axes_of
from ..outputs.out_collection import find_output
from ..outputs.out_shapes import INSTANCES_ROLE
from .density import read_attribute, read_vertex_group
from .directions_in import read_directions
from .mesh_in import level_place
from .shapes_in import items_of

DENSITY, DIRECTION, SIZE = "density", "direction", "size"  # custom properties of a shape's object


def read_classes(
    source: bpy.types.Object, mesh: bpy.types.Mesh, settings: DistributeSettings
) -> tuple[ClassOrder, ...]:
    """One order for each object of the collection, in the order of the templates; none where no object has its own.

    `density` and `size` name a vertex group or a number attribute of the source, `direction` a vector attribute, or is
    an angle in degrees from the field. Raises BadInputError naming the object and what is missing.
    """
    if settings.shapes != "COLLECTION":
        return ()
    orders = tuple(
        ClassOrder(
            density=_painted(source, mesh, item, DENSITY),
            direction=_direction(source, mesh, item),
            size=_painted(source, mesh, item, SIZE),
        )
        for item in items_of(source, settings.shapes_collection)
    )
    own = (value for order in orders for value in (order.density, order.direction, order.size))
    return () if all(value is None for value in own) else orders


def _painted(
    source: bpy.types.Object, mesh: bpy.types.Mesh, item: bpy.types.Object, name: str
) -> NDArray[np.float64] | None:
    """(V,) values of the vertex group or attribute that the item's property names; None where it has none."""
    if name not in item:
        return None
    painted = item[name]
    if not isinstance(painted, str) or not painted:
        raise BadInputError(
            f"'{source.name}': the {name} of shape '{item.name}' is {painted!r}; write the name of a vertex group or a "
            f"number attribute of '{source.name}'"
        )
    if source.vertex_groups.get(painted) is not None:
        values, label = read_vertex_group(source, mesh, painted)
    else:
        values, label = read_attribute(source, mesh, painted)
    try:
        return density_maths.shape(values, False, 1.0, None, 0.0)
    except DensityError as error:
        raise BadInputError(f"'{source.name}': {label} {error}") from error


def _direction(
    source: bpy.types.Object, mesh: bpy.types.Mesh, item: bpy.types.Object
) -> GivenDirections | float | None:
    direction = item.get(DIRECTION)
    if direction is None:
        return None
    if isinstance(direction, str):
        return read_directions(source, mesh, direction)
    try:
        angle = float(direction)
    except (TypeError, ValueError):
        angle = np.nan
    if not np.isfinite(angle):
        raise BadInputError(
            f"'{source.name}': the direction of shape '{item.name}' is {direction!r}; write an angle in degrees from "
            "the field, or the name of a vector attribute"
        )
    return angle


def read_kept(
    source: bpy.types.Object, templates: Sequence[ShapeTemplate], settings: DistributeSettings
) -> KeptShapes | None:
    """The points of the source's output Instances, as they lie; None where there is none to keep.

    Raises BadInputError where the settings leave no shapes that could be kept.
    """
    if not settings.keep:
        return None
    for is_on, label in ((settings.mirror_x, "X Mirror"), (settings.overlap > 0.0, "Overlap")):
        if is_on:
            raise BadInputError(f"'{source.name}': Keep does not go with {label}; switch one of them off")
    if not settings.make_instances:
        raise BadInputError(f"'{source.name}': Keep keeps the points of the output Instances; switch that on")
    item = find_output(source, INSTANCES_ROLE)
    if item is None or not len(item.data.vertices):
        return None
    mesh = item.data
    shape = _column(mesh, nodes.CLASS_ATTRIBUTE, 1).astype(np.int32).ravel()
    known = shape < len(templates)
    if not known.all():
        raise BadInputError(
            f"'{source.name}': some of the shapes to keep are of a class that is no longer there; delete them, or "
            "switch Keep off"
        )
    matrix = np.linalg.solve(*(np.array(place, np.float64) for place in (level_place(source), item.matrix_world)))
    points = compat.read_positions(mesh).astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    x, z = (_units(axes @ matrix[:3, :3].T) for axes in axes_of(_column(mesh, nodes.ROTATION_ATTRIBUTE, 3)))
    y = np.cross(z, x)
    own = [sized(template) for template in templates]
    units = np.array([np.array(template.own_scale) * template.scale for template in own])[shape]
    scales = _column(mesh, nodes.SCALE_ATTRIBUTE, 3) / units
    size, mirrored = np.abs(scales[:, 0]), scales[:, 1] < 0
    shifts = np.array([template.shift for template in own])[shape] * np.array([t.scale for t in own])[shape][:, None]
    local = scales * shifts
    feet = points - x * local[:, :1] - y * local[:, 1:2] - z * local[:, 2:]
    return KeptShapes(shape, feet, x, z, size, mirrored)


def _column(mesh: bpy.types.Mesh, name: str, width: int) -> Reals:
    attribute = mesh.attributes[name]
    element = "vector" if width == 3 else "value"
    kind = np.int32 if attribute.data_type == "INT" else np.float32
    values = np.empty(width * len(attribute.data), kind)
    attribute.data.foreach_get(element, compat.as_copied(values))
    found: Reals = values.reshape(-1, width).astype(np.float64)
    return found


def _units(vectors: Reals) -> Reals:
    units: Reals = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    return units

# SPDX-License-Identifier: GPL-3.0-or-later
"""What classes of shapes have of their own, and shapes that lie there already, as the library takes them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from .. import native
from ..errors import BadInputError
from ..fields.given_fields import given_field
from ..requests import ClassOrder, GivenDirections, KeptShapes, Surface
from ..results import Reals

LEAST_SIZE = 0.05  # of a class's size, where it is painted to be small
KEPT_SCALE = 1.0 - 1e-5  # Blender's numbers have seven digits: copies that hardly miss each other would seem to meet


def class_densities(
    classes: Sequence[ClassOrder], surface: Surface, density: Reals | None, mesh: Any
) -> Reals | list[Reals] | None:
    """The density of all, or of each class where one has its own."""
    if all(order.density is None for order in classes):
        return density
    usual = np.ones(len(mesh.vertices)) if density is None else density
    return [usual if order.density is None else surface.gather(order.density) for order in classes]


def class_fields(classes: Sequence[ClassOrder], surface: Surface, field: Any, mesh: Any) -> Any:
    """The field of all, or of each class where one has its own direction. None: the smoothest lines."""
    if all(order.direction is None for order in classes):
        return field
    sb = native.load()
    usual = sb.direction_field(mesh, 2) if field is None else field
    return [_field_of(order, surface, usual, mesh) for order in classes]


def _field_of(order: ClassOrder, surface: Surface, usual: Any, mesh: Any) -> Any:
    if order.direction is None:
        return usual
    if isinstance(order.direction, GivenDirections):
        return given_field(surface, order.direction, mesh)
    return usual.turned(math.radians(order.direction))


def class_sizes(
    classes: Sequence[ClassOrder], surface: Surface, size: float | Reals
) -> float | Reals | list[float | Reals]:
    """The size of all, or of each class where one is painted."""
    if all(order.size is None for order in classes):
        return size
    return [
        size if order.size is None else size * np.maximum(surface.gather(order.size), LEAST_SIZE) for order in classes
    ]


def kept_placements(kept: KeptShapes, mesh: Any, name: str) -> Any:
    """Placements of shapes as they lie. Raises BadInputError where one lies off the surface."""
    sb = native.load()
    center = sb.project(mesh, kept.points)
    away = np.linalg.norm(center.positions(mesh) - kept.points, axis=1)
    far = np.flatnonzero(away > kept.scales)
    if len(far):
        raise BadInputError(
            f"'{name}': shape {far[0]} of those to keep is not on the surface; move it back, or delete it"
        )
    corners = mesh.vertices[mesh.triangles[center.faces]]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    normals = np.cross(first, second)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    # Frames stand on smooth normals: what was turned into them from the face is turned back.
    steep = (kept.ahead * normals).sum(axis=1) / (kept.up * normals).sum(axis=1)
    ahead = kept.ahead - steep[:, None] * kept.up
    angle = np.arctan2((np.cross(normals, first) * ahead).sum(axis=1), (first * ahead).sum(axis=1))
    return sb.Placements(kept.shape, center, angle, KEPT_SCALE * kept.scales, kept.mirrored)

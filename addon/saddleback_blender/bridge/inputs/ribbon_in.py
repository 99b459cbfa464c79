# SPDX-License-Identifier: GPL-3.0-or-later
"""What ribbons show: an image, or the faces of an object."""

from __future__ import annotations

import bpy
import numpy as np

from ...blocks import find, name_of
from ...core.errors import BadInputError
from ...core.fields.image_colors import to_linear
from ...core.settings import RibbonSettings
from ...core.shapes.shape_templates import Picture, Solid
from .images_in import read_pixels
from .shapes_in import FACES, read_solid

FLAT = 1e-9  # of an object's extent: what is narrower is a line


def read_picture(source: bpy.types.Object, settings: RibbonSettings) -> Picture | None:
    """The image that ribbons show, where they show one. Raises BadInputError where there is none."""
    if settings.show != "IMAGE":
        return None
    image = find(bpy.data.images, settings.image_name)
    if image is None:
        missing = f"there is no image '{settings.image_name}'" if settings.image_name else "no image is chosen"
        raise BadInputError(f"'{source.name}': {missing} to lay along the curves; choose one")
    pixels, is_encoded = read_pixels(source, image)
    is_seen = pixels[:, :, 3] >= 0.5
    colors = pixels[is_seen if is_seen.any() else ~is_seen][:, :3].astype(np.float64)
    color = (to_linear(colors) if is_encoded else colors).mean(axis=0)
    rows, columns = pixels.shape[:2]
    return Picture(name_of(bpy.data.images, image), columns, rows, not is_seen.all(), tuple(color.tolist()))


def read_laid(context: bpy.types.Context, source: bpy.types.Object, settings: RibbonSettings) -> Solid | None:
    """The faces that are laid along the curves, where an object is. Raises BadInputError where it has none."""
    if settings.show != "OBJECT":
        return None
    name = settings.ribbon_object
    item = find(bpy.data.objects, name)
    if item is None:
        missing = f"there is no object '{name}'" if name else "no object is chosen"
        raise BadInputError(f"'{source.name}': {missing} to lay along the curves; choose a mesh or a text")
    if item.type not in FACES:
        raise BadInputError(f"'{source.name}': '{name}' has no faces to lay along the curves; choose a mesh or a text")
    solid = read_solid(context, source, item, "object")
    size = np.ptp(solid.vertices, axis=0)
    if min(size[:2]) <= FLAT * max(size):
        raise BadInputError(f"'{source.name}': '{name}' is a line seen from above; lay it in its own X and Y")
    return solid

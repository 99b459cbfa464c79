"""Images -> arrays."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ..core.errors import BadInputError


def read_pixels(source: bpy.types.Object, image: bpy.types.Image) -> tuple[NDArray[np.float32], bool]:
    """(rows, columns, 4), the first row below, and whether the colours are sRGB instead of linear."""
    width, height = image.size
    if not (width and height):
        raise BadInputError(f"'{source.name}': image '{image.name}' has no pixels; check that its file is there")
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    is_encoded = not image.is_float and image.colorspace_settings.name == "sRGB"
    return _rgba(pixels.reshape(height, width, -1)), is_encoded


def _rgba(pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    """Four channels from one (grey), three or four."""
    channels = pixels.shape[2]
    if channels == 4:
        return pixels
    colors = pixels if channels == 3 else np.repeat(pixels[:, :, :1], 3, axis=2)
    return np.concatenate([colors, np.ones((*pixels.shape[:2], 1), np.float32)], axis=2)

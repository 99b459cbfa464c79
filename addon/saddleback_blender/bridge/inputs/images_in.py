# SPDX-License-Identifier: GPL-3.0-or-later
"""Images -> arrays."""

from __future__ import annotations

import os

import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.errors import BadInputError

# Sources of images that are more than one picture.
MANY = {"TILED": "in UDIM tiles", "SEQUENCE": "a sequence", "MOVIE": "a movie"}


def read_pixels(source: bpy.types.Object, image: bpy.types.Image) -> tuple[NDArray[np.float32], bool]:
    """(rows, columns, 4), the first row below, and whether the colors are sRGB instead of linear.

    Raises BadInputError for an image of several pictures.
    """
    if image.source in MANY:
        raise BadInputError(
            f"'{source.name}': image '{image.name}' is {MANY[image.source]}; choose one of a single picture"
        )
    return _pixels(source, image)


def read_tiles(source: bpy.types.Object, image: bpy.types.Image) -> dict[int, tuple[NDArray[np.float32], bool]]:
    """The pictures of an image by UDIM tile, each as `read_pixels` gives it; of an image without tiles {0: it}.

    Blender shows scripts the first tile only: each is loaded for a moment as an image of its own.
    """
    if image.source != "TILED":
        return {0: read_pixels(source, image)}
    return {tile.number: _tile(source, image, tile.number) for tile in image.tiles}


def _tile(source: bpy.types.Object, image: bpy.types.Image, number: int) -> tuple[NDArray[np.float32], bool]:
    loaded = _load_tile(image, number)
    if loaded is None or not loaded.size[0]:
        raise BadInputError(f"'{source.name}': tile {number} of image '{image.name}' has no file; save the image first")
    try:
        loaded.colorspace_settings.name = image.colorspace_settings.name
        return _pixels(source, loaded)
    finally:
        bpy.data.images.remove(loaded)


def _load_tile(image: bpy.types.Image, number: int) -> bpy.types.Image | None:
    """A new image of the tile alone, from its packed bytes or from its file."""
    name = image.filepath_raw
    for token, text in (("<UDIM>", str(number)), ("<UVTILE>", _uv_tile(number))):
        name = name.replace(token, text)
    packed = [
        part.packed_file.data for part in image.packed_files if os.path.basename(part.filepath) == _base_name(name)
    ]
    if packed:
        loaded = bpy.data.images.new("Saddleback Tile", 1, 1)
        loaded.pack(data=packed[0], data_len=len(packed[0]))
        loaded.source = "FILE"
        return loaded
    path = bpy.path.abspath(name, library=image.library)
    return bpy.data.images.load(path) if os.path.isfile(path) else None


def _uv_tile(number: int) -> str:
    return f"u{(number - 1001) % 10 + 1}_v{(number - 1001) // 10 + 1}"


def _base_name(path: str) -> str:
    return os.path.basename(path.replace("//", "", 1) if path.startswith("//") else path)


def _pixels(source: bpy.types.Object, image: bpy.types.Image) -> tuple[NDArray[np.float32], bool]:
    width, height = image.size
    if not (width and height):
        raise BadInputError(f"'{source.name}': image '{image.name}' has no pixels; check that its file is there")
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    is_encoded = not image.is_float and image.colorspace_settings.name == "sRGB"
    return _rgba(pixels.reshape(height, width, -1)), is_encoded


def _rgba(pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    """Four channels from one (gray), three or four."""
    channels = pixels.shape[2]
    if channels == 4:
        return pixels
    colors = pixels if channels == 3 else np.repeat(pixels[:, :, :1], 3, axis=2)
    return np.concatenate([colors, np.ones((*pixels.shape[:2], 1), np.float32)], axis=2)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Images as densities: how dark they are, and places drawn by that."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..results import Reals
from .image_colors import to_linear

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # Rec. 709, of linear light
MOST_PIXELS = 1024  # more each way than dots can show
MOST_TRIES = 200


def darkness(pixels: NDArray[np.float32], is_encoded: bool, invert: bool) -> Reals:
    """(rows, columns, 4) -> (rows, columns) the share of light that is missing; transparent counts as white, and so do
    the pixels of a render that are no numbers.

    `is_encoded`: the colors are sRGB as in 8-bit images, not linear. The first row stays the first.
    """
    colors = np.clip(pixels.astype(np.float64), 0.0, 1.0)
    colors[np.isnan(colors).any(axis=2)] = 0.0
    colors = shrunk(colors)
    if is_encoded:
        colors[:, :, :3] = to_linear(colors[:, :, :3])
    light = colors[:, :, :3] @ LUMINANCE
    dark: Reals = np.clip(light if invert else 1.0 - light, 0.0, 1.0) * colors[:, :, 3]
    return dark


def darkness_at(dark: Reals, low: Reals, high: Reals, places: Reals) -> Reals:
    """How dark (n,) an image (rows, columns) over the box from low (2,) to high (2,) is at places (n, 2)."""
    size = np.array(dark.shape[::-1])
    pixel = np.clip((places - low) / (high - low) * size, 0, size - 1).astype(np.int64)
    found: Reals = dark[pixel[:, 1], pixel[:, 0]]
    return found


def shrunk(pixels: Reals) -> Reals:
    """Means over blocks, so that neither side is longer than MOST_PIXELS; what does not fill a block is left out."""
    rows, columns = pixels.shape[:2]
    block = -(-max(rows, columns) // MOST_PIXELS)
    if block == 1:
        return pixels
    rows, columns = max(1, rows // block), max(1, columns // block)
    cut = pixels[: rows * block, : columns * block]
    means: Reals = cut.reshape(rows, -1, columns, cut.shape[1] // columns, cut.shape[2]).mean(axis=(1, 3))
    return means


def places_by_density(
    density: Reals, low: Reals, high: Reals, count: int, seed: int, inside: Callable[[Reals], NDArray[np.bool_]]
) -> Reals:
    """(count, 2) places within a box (2,), (2,) whose number per area follows the density; fewer where few are inside.

    `inside` says which of (m, 2) places may stay.
    """
    rng = np.random.default_rng(seed)
    rows, columns = density.shape
    sums = np.cumsum(density.ravel())
    found: list[Reals] = []
    missing = count
    for _ in range(MOST_TRIES):
        draws = max(64, 2 * missing)
        pixel = np.minimum(np.searchsorted(sums, rng.random(draws) * sums[-1], side="right"), density.size - 1)
        share = np.stack([pixel % columns, pixel // columns], axis=1) + rng.random((draws, 2))
        places = low + share / (columns, rows) * (high - low)
        places = places[inside(places)][:missing]
        found.append(places)
        missing -= len(places)
        if missing == 0:
            break
    return np.concatenate(found)

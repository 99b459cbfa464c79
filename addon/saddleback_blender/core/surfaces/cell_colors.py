# SPDX-License-Identifier: GPL-3.0-or-later
"""A pleasant color for every cell, the same every time, unlike those of its neighbors.

Colors are drawn in Oklab, where equal steps look equal [ottosson2020]: a middling lightness and chroma, any hue.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..results import Indices, Reals

Draw = Callable[[NDArray[np.uint64], NDArray[np.uint64]], Reals]  # of cells, in their turns

LIGHTNESS = (0.60, 0.84)
CHROMA = (0.07, 0.13)
# Neighbors nearer than this in Oklab draw again; about a third of the hue circle's diameter.
ALIKE = 0.09
SAME = 1e-6  # of a palette's colors, which only have to be others
MAX_DRAWS = 24


def cell_colors(count: int, neighbors: Indices) -> Reals:
    """Linear RGB (count, 3) in [0, 1] for cells whose neighboring pairs are (e, 2). O(count + e)."""
    lab = _unlike(count, neighbors, _draw, ALIKE)
    return np.clip(oklab_to_linear_rgb(lab), 0.0, 1.0)


def palette_colors(count: int, neighbors: Indices, palette: Reals, contrast: float) -> Reals:
    """Linear RGB (count, 3) in [0, 1]: one of the palette's (m, 3) for each cell, another than its neighbors' where
    that can be, by chance lighter or darker by up to `contrast`. O(count + e).
    """

    def draw(cell: NDArray[np.uint64], turn: NDArray[np.uint64]) -> Reals:
        chosen: Reals = palette[(len(palette) * _random(cell, turn, [4])[:, 0]).astype(np.int64)]
        return chosen

    drawn = _unlike(count, neighbors, draw, SAME)
    random = _random(np.arange(count, dtype=np.uint64), np.zeros(count, np.uint64), [5])
    return np.clip(drawn * (1.0 + contrast * (2.0 * random - 1.0)), 0.0, 1.0)


def _unlike(count: int, neighbors: Indices, draw: Draw, alike: float) -> Reals:
    """Draws (count, c) values; of neighbors (e, 2) nearer than `alike` one draws again, so often as is sensible."""
    turn = np.zeros(count, dtype=np.uint64)
    values = draw(np.arange(count, dtype=np.uint64), turn)
    pairs = np.sort(neighbors[(neighbors >= 0).all(axis=1)], axis=1)
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    for _ in range(MAX_DRAWS):
        is_alike = np.linalg.norm(values[pairs[:, 0]] - values[pairs[:, 1]], axis=1) < alike
        again = np.unique(pairs[is_alike, 1])
        if again.size == 0:
            break
        turn[again] += np.uint64(1)
        values[again] = draw(again.astype(np.uint64), turn[again])
    return values


def _draw(cell: NDArray[np.uint64], draw: NDArray[np.uint64]) -> Reals:
    """Oklab (n, 3) from the cell's number and how often it has drawn."""
    low, high = (np.array(bounds) for bounds in zip(LIGHTNESS, CHROMA, strict=True))
    lightness, chroma = (low + (high - low) * _random(cell, draw, [1, 2])).T
    hue = 2.0 * np.pi * _random(cell, draw, [3])[:, 0]
    return np.column_stack([lightness, chroma * np.cos(hue), chroma * np.sin(hue)])


def _random(cell: NDArray[np.uint64], draw: NDArray[np.uint64], streams: list[int]) -> Reals:
    """Numbers (n, s) in [0, 1) that depend on nothing else (splitmix64)."""
    with np.errstate(over="ignore"):
        x = (cell * np.uint64(64) + draw)[:, None] * np.uint64(8) + np.array(streams, dtype=np.uint64)
        x = (x + np.uint64(1)) * np.uint64(0x9E3779B97F4A7C15)
        x = (x ^ (x >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        x = (x ^ (x >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        x ^= x >> np.uint64(31)
    return (x >> np.uint64(11)).astype(np.float64) * 2.0**-53


def linear_to_srgb(rgb: Reals) -> Reals:
    """Linear (n, 3) in [0, 1] to sRGB (IEC 61966-2-1)."""
    srgb: Reals = np.where(rgb < 0.0031308, 12.92 * rgb, 1.055 * np.maximum(rgb, 0.0031308) ** (1 / 2.4) - 0.055)
    return srgb


def oklab_to_linear_rgb(lab: Reals) -> Reals:
    """Oklab (n, 3) to linear sRGB (n, 3), not clipped."""
    to_lms = np.array(
        [
            [1.0, 0.3963377774, 0.2158037573],
            [1.0, -0.1055613458, -0.0638541728],
            [1.0, -0.0894841775, -1.2914855480],
        ]
    )
    to_rgb = np.array(
        [
            [4.0767416621, -3.3077115913, 0.2309699292],
            [-1.2684380046, 2.6097574011, -0.3413193965],
            [-0.0041960863, -0.7034186147, 1.7076147010],
        ]
    )
    rgb: Reals = (lab @ to_lms.T) ** 3 @ to_rgb.T
    return rgb

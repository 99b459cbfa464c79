# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors of an image at places of its square."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..results import Reals


def to_linear(encoded: Reals) -> Reals:
    """Values (any shape) of 8-bit images, which are sRGB -> linear light."""
    linear: Reals = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    return linear


def colors_at(pixels: NDArray[np.float32], places: Reals, is_encoded: bool) -> Reals:
    """Linear colors (n, 4) of pixels (rows, columns, 4), the first row below, at places (n, 2) of the unit square.

    Mixed from the four pixels about each place; beyond the square the image repeats.
    """
    rows, columns = pixels.shape[:2]
    x = places[:, 0] * columns - 0.5
    y = places[:, 1] * rows - 0.5
    left, below = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    across, up = (x - left)[:, None], (y - below)[:, None]
    mixed = np.zeros((len(places), 4))
    for i, share_x in ((0, 1 - across), (1, across)):
        for j, share_y in ((0, 1 - up), (1, up)):
            mixed += share_x * share_y * _linear(pixels[(below + j) % rows, (left + i) % columns], is_encoded)
    return mixed


def _linear(colors: NDArray[np.float32], is_encoded: bool) -> Reals:
    """Returns the same colors, of which only alpha is never encoded."""
    linear = colors.astype(np.float64)
    if is_encoded:
        linear[:, :3] = to_linear(linear[:, :3])
    return linear

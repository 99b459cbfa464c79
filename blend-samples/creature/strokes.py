# SPDX-License-Identifier: GPL-3.0-or-later
"""The strokes that say which way the chameleon's scales lie: from the nose to the tip of the tail, down the legs."""

from __future__ import annotations

import numpy as np
from implicit import Array, catmull_rom
from shape import tail_stations

# Stations of the body as in shape.trunk: x, z and the half height and width there.
BODY = np.array(
    [(0.82, 0.69, 0.285, 0.215), (0.50, 0.69, 0.375, 0.255), (0.12, 0.71, 0.45, 0.29), (-0.30, 0.69, 0.43, 0.278),
     (-0.68, 0.62, 0.33, 0.228), (-1.0, 0.54, 0.22, 0.178), (-1.30, 0.485, 0.155, 0.135), (-1.68, 0.45, 0.122, 0.112)]
)  # fmt: skip
AROUND = (12, 45, 85, 125, 165)  # degrees from the back on which the body's strokes run
HEAD = (
    [(1.76, 0.06, 0.66), (1.56, 0.15, 0.69), (1.40, 0.20, 0.68), (1.16, 0.24, 0.67), (0.94, 0.22, 0.66)],
    [(1.70, 0.03, 0.72), (1.52, 0.10, 0.84), (1.30, 0.13, 0.98), (1.08, 0.10, 1.15), (0.86, 0.03, 1.28)],
    [(1.70, 0.03, 0.58), (1.44, 0.08, 0.50), (1.18, 0.10, 0.44), (0.90, 0.12, 0.42)],
    [(1.06, 0.12, 1.08), (0.96, 0.17, 0.96), (0.86, 0.20, 0.82), (0.66, 0.24, 0.76)],
)
LEFT_LEGS = (
    [(0.62, 0.24, 0.56), (0.58, 0.42, 0.42), (0.62, 0.44, 0.32), (0.74, 0.28, 0.22), (0.86, 0.17, 0.10)],
    [(-0.74, 0.24, 0.55), (-0.69, 0.42, 0.46), (-0.68, 0.46, 0.36), (-0.78, 0.28, 0.24), (-0.86, 0.17, 0.10)],
)
RIGHT_LEGS = (
    [(0.52, 0.26, 0.56), (0.34, 0.44, 0.44), (0.22, 0.49, 0.34), (0.31, 0.32, 0.22), (0.40, 0.17, 0.10)],
    [(-0.64, 0.26, 0.55), (-0.40, 0.46, 0.46), (-0.27, 0.52, 0.36), (-0.35, 0.32, 0.22), (-0.42, 0.17, 0.10)],
)


def strokes() -> list[Array]:
    """Rows of points (n, 3) beside the surface, each in the direction in which scales point."""
    left = [*map(np.array, HEAD), *map(np.array, LEFT_LEGS), *(_along_body(angle) for angle in AROUND), _along_tail()]
    right = [*map(np.array, HEAD), *map(np.array, RIGHT_LEGS), *(_along_body(angle) for angle in AROUND), _along_tail()]
    mirror = np.array([1, -1, 1])
    return [catmull_rom(row, 6 * len(row)) for row in [*left, *(row * mirror for row in right)]]


def _along_body(degrees: float) -> Array:
    x, z, tall, wide = BODY.T
    angle = np.radians(degrees)
    return np.stack([x, wide * np.sin(angle), z + tall * np.cos(angle)], axis=1)


def _along_tail() -> Array:
    """Returns how far a place is on the side of the spiral, to shortly before its end."""
    stations = np.array(tail_stations())[:-6:3]
    return np.stack([stations[:, 0], stations[:, 4], stations[:, 2]], axis=1)

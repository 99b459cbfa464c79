"""What a point at the centre of a cell carries: how large its cell is and how to turn something to stand on it."""

from __future__ import annotations

import numpy as np

from .results import Reals


def cell_size(area: Reals) -> Reals:
    """Radius (n,) of the disk that has the cell's area."""
    size: Reals = np.sqrt(np.maximum(area, 0.0) / np.pi)
    return size


def euler_to_normal(normal: Reals) -> Reals:
    """Euler angles XYZ (n,3) of the shortest turn that takes the Z axis to each unit normal (n,3), in radians.

    Straight down is half a turn about X. A normal of length zero gives no turn.
    """
    x, y, z = normal.T
    down = z < -1.0 + 1e-12  # the shortest turn is not unique there
    scale = 1.0 / np.where(down, 1.0, 1.0 + z)
    pitch = np.arcsin(np.clip(x, -1.0, 1.0))
    roll = np.arctan2(-y, z)
    yaw = np.arctan2(-x * y * scale, 1.0 - x * x * scale)
    euler = np.column_stack([roll, pitch, yaw])
    euler[down] = (np.pi, 0.0, 0.0)
    euler[(normal == 0.0).all(axis=1)] = 0.0
    return euler

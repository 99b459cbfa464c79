# SPDX-License-Identifier: GPL-3.0-or-later
"""Tells what a cell's center carries: how large its cell is and how to turn something to stand on it."""

from __future__ import annotations

import numpy as np

from ..results import Reals


def cell_size(area: Reals) -> Reals:
    """Radius (n,) of the disk that has the cell's area."""
    size: Reals = np.sqrt(np.maximum(area, 0.0) / np.pi)
    return size


def instance_size(area: Reals, tone: Reals | None, kind: str) -> Reals:
    """Radius (n,) of a disk on each center: by its cell's area (n,), by tone (n,), or equal.

    All disks together cover as much as the tone says, everything where there is none.
    """
    ink = area if tone is None else area * tone
    if kind == "EQUAL":
        return cell_size(np.full(len(area), ink.mean() if len(area) else 0.0))
    return cell_size(ink if kind == "TONE" else area)


def euler_to_normal(normal: Reals) -> Reals:
    """Euler angles XYZ (n,3) of the shortest turn that takes the Z axis to each normal (n,3), in radians.

    Straight down is half a turn about X. A normal of length zero gives no turn.
    """
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    x, y, z = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0).T
    across = x * x + y * y
    down = (across == 0.0) & (z < 0.0)  # the shortest turn is not unique there
    # 1 / (1 + z), for z near -1 without cancellation.
    scale = np.where(z < 0.0, (1.0 - z) / np.where(across > 0.0, across, 1.0), 1.0 / (1.0 + np.abs(z)))
    pitch = np.arcsin(np.clip(x, -1.0, 1.0))
    roll = np.arctan2(-y, z)
    yaw = np.arctan2(-x * y * scale, 1.0 - x * x * scale)
    euler = np.column_stack([roll, pitch, yaw])
    euler[down] = (np.pi, 0.0, 0.0)
    euler[(normal == 0.0).all(axis=1)] = 0.0
    return euler

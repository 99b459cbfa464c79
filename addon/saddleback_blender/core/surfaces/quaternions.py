# SPDX-License-Identifier: GPL-3.0-or-later
"""Turns as quaternions and as Euler angles, as every version of Blender reads them from attributes."""

from __future__ import annotations

import numpy as np

from ..results import Reals


def euler_of(quaternions: Reals) -> Reals:
    """(n, 4) unit quaternions, w first -> (n, 3) Euler angles XYZ, radians: about X first, then Y, then Z."""
    w, x, y, z = quaternions.T
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2 * (w * y - x * z), -1.0, 1.0))
    yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    # Straight up or down only the difference of the other two counts.
    locked = np.abs(2 * (w * y - x * z)) > 1 - 1e-12
    roll = np.where(locked, 0.0, roll)
    yaw = np.where(locked, np.arctan2(2 * (w * z - x * y), 1 - 2 * (x * x + z * z)), yaw)
    euler: Reals = np.column_stack([roll, pitch, yaw])
    return euler


def axes_of(euler: Reals) -> tuple[Reals, Reals]:
    """Returns where Euler angles XYZ (n, 3), radians, take the X axis and the Z axis: (n, 3) each."""
    (a, b, c), (d, e, f) = np.cos(euler.T), np.sin(euler.T)
    x = np.column_stack([c * b, f * b, -e])
    z = np.column_stack([a * e * c + d * f, a * e * f - d * c, a * b])
    return x, z


def turned(quaternions: Reals, vectors: Reals) -> Reals:
    """Vectors (n, 3) turned by quaternions (n, 4)."""
    w, axis = quaternions[:, :1], quaternions[:, 1:]
    twice = 2 * np.cross(axis, vectors)
    found: Reals = vectors + w * twice + np.cross(axis, twice)
    return found


def quaternions_of(x: Reals, y: Reals, z: Reals) -> Reals:
    """(n, 4), w first: the turns that take the axes to these unit vectors (n, 3), at right angles to each other."""
    m = np.stack([x, y, z], axis=2)
    diagonal = np.einsum("nii->ni", m)
    # The largest of four squares is divided by, so that nothing is lost near half turns.
    squares = np.column_stack([diagonal.sum(axis=1), *(2 * diagonal[:, i] - diagonal.sum(axis=1) for i in range(3))])
    rows = np.arange(len(m))
    found = np.empty((len(m), 4, 4))
    found[:, 0] = np.column_stack([1 + squares[:, 0], m[:, 2, 1] - m[:, 1, 2], m[:, 0, 2] - m[:, 2, 0],
                                   m[:, 1, 0] - m[:, 0, 1]])  # fmt: skip
    found[:, 1] = np.column_stack([m[:, 2, 1] - m[:, 1, 2], 1 + squares[:, 1], m[:, 0, 1] + m[:, 1, 0],
                                   m[:, 0, 2] + m[:, 2, 0]])  # fmt: skip
    found[:, 2] = np.column_stack([m[:, 0, 2] - m[:, 2, 0], m[:, 0, 1] + m[:, 1, 0], 1 + squares[:, 2],
                                   m[:, 1, 2] + m[:, 2, 1]])  # fmt: skip
    found[:, 3] = np.column_stack([m[:, 1, 0] - m[:, 0, 1], m[:, 0, 2] + m[:, 2, 0], m[:, 1, 2] + m[:, 2, 1],
                                   1 + squares[:, 3]])  # fmt: skip
    best: Reals = found[rows, squares.argmax(axis=1)]
    units: Reals = best / np.linalg.norm(best, axis=1, keepdims=True)
    return units

# SPDX-License-Identifier: MIT
"""Where two polygons touch last when they are slid apart: every corner of one against every edge of the other."""

from __future__ import annotations

import numpy as np

import saddleback as sb


def edges(shape: sb.Shape) -> tuple[np.ndarray, np.ndarray]:
    begins = np.concatenate(shape.loops)
    return begins, np.concatenate([np.roll(loop, -1, axis=0) for loop in shape.loops])


def turned(points: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """(poses, points, 2): the points turned by each angle."""
    c, s = np.cos(angles)[:, None], np.sin(angles)[:, None]
    return np.stack([points[:, 0] * c - points[:, 1] * s, points[:, 0] * s + points[:, 1] * c], axis=2)


def last_hit(corners: np.ndarray, begin: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Per pose the farthest that an edge must go along x to let go of the corners of the other shape."""
    y = corners[:, :, None, 1]
    low, high = begin[:, None, :, :], end[:, None, :, :]
    rise = high[..., 1] - low[..., 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(rise == 0, 0.0, (y - low[..., 1]) / rise)
        x = low[..., 0] + share * (high[..., 0] - low[..., 0])
    inside = (y >= np.minimum(low[..., 1], high[..., 1])) & (y <= np.maximum(low[..., 1], high[..., 1])) & (rise != 0)
    return np.where(inside, corners[:, :, None, 0] - x, -np.inf).max(axis=(1, 2))


def last_contact(
    a: sb.Shape, b: sb.Shape, alpha: np.ndarray, beta: np.ndarray, scale_a: np.ndarray, scale_b: np.ndarray
) -> np.ndarray:
    """The largest distance at which b, lying in the direction alpha of a and seeing it under beta, touches a."""
    a_begin, a_end = (turned(p, -alpha) * scale_a[:, None, None] for p in edges(a))
    b_begin, b_end = (turned(p, np.pi - beta) * scale_b[:, None, None] for p in edges(b))
    on_b = last_hit(a_begin, b_begin, b_end)  # corners of a against edges of b moving to the right
    on_a = last_hit(-b_begin, -a_begin, -a_end)
    return np.maximum(0, np.maximum(on_b, on_a))

# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair as it is drawn: smooth between its points."""

from __future__ import annotations

import numpy as np

from ..results import Reals

STEPS = 8  # from point to point


def through_points(points: Reals, is_closed: bool) -> Reals:
    """The Catmull-Rom spline of points (n, 3), two at least, as a polyline that goes through them."""
    if len(points) < 3:
        return points
    ends = (points[-1:], points[:2]) if is_closed else (points[:1], points[-1:])
    around = np.concatenate([ends[0], points, ends[1]])
    t = (np.arange(STEPS) / STEPS)[:, None]
    s = 1.0 - t
    weights = 0.5 * np.hstack([-t * s * s, 2.0 + t * t * (3.0 * t - 5.0), 2.0 + s * s * (3.0 * s - 5.0), -s * t * t])
    spans = np.stack([around[i : len(around) - 3 + i] for i in range(4)], axis=1)
    line = np.einsum("sk,nkj->nsj", weights, spans).reshape(-1, 3)
    smooth: Reals = line if is_closed else np.concatenate([line, points[-1:]])
    return smooth

# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces as the bridge would read them."""

import numpy as np

from saddleback_blender.core.requests import Surface


def grid(n, loose=0):
    """The unit square in n by n quads cut into triangles, after `loose` vertices of no face."""
    ticks = np.linspace(0.0, 1.0, n + 1)
    x, y = np.meshgrid(ticks, ticks)
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    number = np.arange(x.size).reshape(n + 1, n + 1)
    quads = np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]], axis=-1).reshape(-1, 4)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)
    used = np.arange(loose, loose + len(vertices), dtype=np.int32) if loose else None
    return Surface("Shape", vertices, triangles, loose + len(vertices), used)

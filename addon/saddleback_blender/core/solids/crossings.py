# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds where a triangle mesh passes through itself, as Blender will store it."""

from __future__ import annotations

from typing import Any

import numpy as np

from .. import native
from ..results import Indices, Reals


def find_crossings(vertices: Reals, triangles: Indices, among: Indices | None = None, job: Any = None) -> Indices:
    """Pairs (k, 2) of triangles that pass through each other, neighbors along an edge left out; only those of which one
    is `among` the n named, if given. Coordinates are rounded to single precision. O(m log n).
    """
    found: Indices = native.load().self_crossings(vertices.astype(np.float32), triangles, among, job=job)
    return found

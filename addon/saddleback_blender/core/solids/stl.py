# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles as a binary STL file."""

from __future__ import annotations

import numpy as np

from ..results import Indices, Reals

FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("color", "<u2")])


def stl_bytes(vertices: Reals, triangles: Indices) -> bytes:
    """The file's content: an empty header, the number of triangles (t, 3), each with its normal and corners."""
    facets = np.zeros(len(triangles), FACET)
    corners = np.asarray(vertices)[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    facets["corners"] = corners
    facets["normal"] = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)
    return bytes(80) + len(triangles).to_bytes(4, "little") + facets.tobytes()

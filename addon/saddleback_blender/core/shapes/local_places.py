# SPDX-License-Identifier: GPL-3.0-or-later
"""Tells where a corner of a cell's mesh lies within its cell: coordinates for materials that repeat in every cell."""

from __future__ import annotations

import numpy as np

from ..results import Indices, Reals


def local_uv(positions: Reals, triangles: Indices, triangle_cell: Indices, sites: Reals, normals: Reals) -> Reals:
    """(3 m, 2) places of the corners of triangles (m, 3): the site at (0.5, 0.5), the farthest corner at 0.5 from it.

    Seen straight along the site's normal (n, 3), in the directions that X and Y have after the shortest turn from Z to
    the normal, as instances on the centers have them. O(m).
    """
    cell = np.repeat(triangle_cell, 3)
    across, up = _axes(normals)
    away = positions[triangles.ravel()] - sites[cell]
    places = np.column_stack([np.einsum("ij,ij->i", away, axis[cell]) for axis in (across, up)])
    farthest = np.zeros(len(sites))
    np.maximum.at(farthest, cell, np.linalg.norm(places, axis=1))
    scaled: Reals = 0.5 + 0.5 * places / np.where(farthest > 0.0, farthest, 1.0)[cell, None]
    return scaled


def _axes(normals: Reals) -> tuple[Reals, Reals]:
    """X and Y (n, 3) after the shortest turn that takes Z to each unit normal; straight down it is half one about X."""
    x, y, z = normals.T
    is_down = z < -1.0 + 1e-12
    share = 1.0 / np.where(is_down, 1.0, 1.0 + z)
    across = np.column_stack([1.0 - x * x * share, -x * y * share, -x])
    up = np.column_stack([-x * y * share, 1.0 - y * y * share, -y])
    across[is_down], up[is_down] = (1.0, 0.0, 0.0), (0.0, -1.0, 0.0)
    return across, up

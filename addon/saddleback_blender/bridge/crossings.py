"""Where a triangle mesh passes through itself, asked of Blender's own search tree."""

from __future__ import annotations

import numpy as np
from mathutils.bvhtree import BVHTree

from ..core.results import Indices, Reals

# Triangles that share a corner cross where they share more than a point: a line longer than this, squared, in units of
# the mesh's extent. Blender's single precision sees shorter ones between neighbours in one plane.
SHORT = 1e-10


def find_crossings(vertices: Reals, triangles: Indices) -> Indices:
    """Pairs (k, 2) of triangles that pass through each other, neighbours along an edge left out. Touches no file.

    Coordinates are rounded alike whichever of the mesh's triangles are given. O(m log m). Blender's interpreter waits
    meanwhile: about a second for half a million triangles.
    """
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    used, corners = np.unique(triangles, return_inverse=True)
    places = (vertices[used] - 0.5 * (low + high)) / (high - low).max()
    tree = BVHTree.FromPolygons(places.tolist(), corners.reshape(-1, 3).tolist(), all_triangles=True, epsilon=SHORT)
    return np.array(tree.overlap(tree), np.int32).reshape(-1, 2)

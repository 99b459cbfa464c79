# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a mesh whose borders lie on each other, made one: texts and imported meshes are often not joined there."""

from __future__ import annotations

import numpy as np

from ..results import Indices, Reals
from .mesh_edges import border_edges, directed_edges


def sewn(vertices: Reals, triangles: Indices) -> Indices:
    """The triangles (t, 3), with one vertex for all that meet where borders lie on each other, edge by edge.

    A border edge is joined with the one that runs from its end to its start, at the very same places, where there is
    just one such. O(t + b log b) for b border edges.
    """
    start, end, _ = border_edges(triangles, len(vertices))
    if not len(start):
        return triangles
    used, number = np.unique(np.concatenate([start, end]), return_inverse=True)
    _, place = np.unique(vertices[used], axis=0, return_inverse=True)
    first, second = place.reshape(-1)[number.reshape(2, -1)]
    count = int(place.max()) + 1
    ahead, back = first.astype(np.int64) * count + second, second.astype(np.int64) * count + first
    order = np.argsort(ahead, kind="stable")
    low, high = (np.searchsorted(ahead[order], back, side) for side in ("left", "right"))
    times = np.bincount(np.searchsorted(ahead[order], ahead), minlength=len(ahead) + 1)
    is_joined = (high - low == 1) & (times[np.searchsorted(ahead[order], ahead)] == 1) & (first != second)
    other = order[np.minimum(low, len(order) - 1)][is_joined]
    label = np.arange(len(vertices))
    one, two = np.concatenate([start[is_joined], end[is_joined]]), np.concatenate([end[other], start[other]])
    while True:
        least = np.minimum(label[one], label[two])
        before = label.copy()
        np.minimum.at(label, one, least)
        np.minimum.at(label, two, least)
        if np.array_equal(label, before):
            break
    joined: Indices = label[triangles].astype(np.int32)
    starts, ends = directed_edges(joined)
    ways = np.sort(starts.astype(np.int64) * len(vertices) + ends)
    is_surface = bool((ways[1:] != ways[:-1]).all())
    return joined if is_surface else triangles

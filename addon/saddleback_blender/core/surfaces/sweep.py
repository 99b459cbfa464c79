# SPDX-License-Identifier: GPL-3.0-or-later
"""A sweep circle as it grows over a flat mesh: what of the diagram is there at which radius."""

from __future__ import annotations

from typing import Any

import numpy as np

from .. import native
from ..progress import Progress
from ..results import FlatCells, Indices, Reals, Sweep
from .plane_frame import PlaneFrame

MOST_RINGS = 400
RING_POINTS = 512
PIECES_ACROSS = 150  # edges grow in steps of about this part of the domain's extent


def sweep_over(
    sites: Reals, weights: Reals | None, cells: FlatCells, frame: PlaneFrame, frames: int, progress: Progress
) -> Sweep:
    """The circle grows from the middle of the domain, about one step of the beach curve a frame.

    A point x of an edge is passed by the beach curve of center c when the circle's radius is |x - c| + |x - s| - w, s
    being one of its two sites.
    """
    corners = frame.to_plane(cells.vertices)
    low, high = corners.min(axis=0), corners.max(axis=0)
    center = 0.5 * (low + high)
    inner = (cells.edge_cells >= 0).all(axis=1)
    step = float((high - low).max()) / PIECES_ACROSS
    places, edges, site = _pieces(corners, cells.edges[inner], cells.edge_cells[inner, 0], step)
    radius = np.linalg.norm(places - center, axis=1) + np.linalg.norm(places - sites[site], axis=1)
    if weights is not None:
        radius = radius - weights[site]
    last = float(radius.max(initial=0.0)) or float(np.linalg.norm(high - center))
    count = min(max(frames, 2), MOST_RINGS)
    rings = _rings(sites, weights, center, last * np.arange(1, count + 1) / count, progress)
    return Sweep(
        center=frame.to_world(center[None])[0],
        axes=frame.axes,
        last_radius=last,
        edge_vertices=frame.to_world(places),
        edges=edges,
        edge_radius=radius,
        rings=frame.to_world(rings.reshape(-1, 2)).reshape(count, -1, 3),
    )


def _pieces(corners: Reals, edges: Indices, cells: Indices, step: float) -> tuple[Reals, Indices, Indices]:
    """Edges in pieces of about `step`: places (n, 2), pieces (m, 2), and a site (n,) that each place is nearest to."""
    start, end = corners[edges[:, 0]], corners[edges[:, 1]]
    count = np.maximum(1, np.ceil(np.linalg.norm(end - start, axis=1) / step)).astype(np.int64)
    edge = np.repeat(np.arange(len(edges)), count)
    number = np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count)
    # Each edge has its two corners and, between them, points of its own.
    inner = number > 0
    share = (number / count[edge])[inner, None]
    between = (1 - share) * start[edge[inner]] + share * end[edge[inner]]
    own = len(corners) + np.cumsum(inner) - 1
    begins = np.where(inner, own, edges[edge, 0])
    is_last = number == count[edge] - 1
    ends = np.where(is_last, edges[edge, 1], np.roll(begins, -1))
    site = np.zeros(len(corners), np.int64)
    site[edges.ravel()] = np.repeat(cells, 2)
    places, sites = np.concatenate([corners, between]), np.concatenate([site, cells[edge[inner]]])
    used, pieces = np.unique(np.column_stack([begins, ends]), return_inverse=True)
    return places[used], pieces.reshape(-1, 2).astype(np.int32), sites[used].astype(np.int32)


def _rings(sites: Reals, weights: Reals | None, center: Reals, radii: Reals, progress: Progress) -> Reals:
    """(k, RING_POINTS, 2) the beach curve at each radius; all at the center before the first site is touched."""
    sweep: Any = native.load().SweepCircle(sites, center, weights)
    rings = np.empty((len(radii), RING_POINTS, 2))
    for number, radius in enumerate(radii):
        progress.check()
        sweep.grow(float(radius))
        curve = sweep.beach_curve(RING_POINTS)
        rings[number] = curve if len(curve) else center
    return rings

# SPDX-License-Identifier: GPL-3.0-or-later
"""Sweep circles as they grow over a flat mesh: what of the diagram is there at which radius."""

from __future__ import annotations

from typing import Any

import numpy as np

from .. import native
from ..progress import Progress
from ..results import FlatCells, Indices, Reals, Sweep
from .spaces import Space

MOST_RINGS = 400
RING_POINTS = 512
ALL_POINTS, FEWEST_POINTS = 2048, 64  # of the rings of several circles together, and of each of many
PIECES_ACROSS = 150  # edges grow in steps of about this part of the domain's extent


def sweep_over(
    sites: Reals,
    weights: Reals | None,
    cells: FlatCells,
    space: Space,
    centers: Reals | None,
    frames: int,
    progress: Progress,
) -> Sweep:
    """Circles grow from their centers, or one from the middle of the domain, about one step of the beach curve a frame.

    A point x of an edge is passed by the beach curve of center c when the circle's radius is |x - c| + |x - s| - w, s
    being one of its two sites. Of several circles the first that gets there uncovers it.
    """
    frame = space.frame
    assert frame is not None
    corners = frame.to_plane(cells.vertices)
    low, high = corners.min(axis=0), corners.max(axis=0)
    if centers is None:
        centers = 0.5 * (low + high)[None]
    inner = (cells.edge_cells >= 0).all(axis=1)
    step = float((high - low).max()) / PIECES_ACROSS
    places, edges, site = _pieces(corners, cells.edges[inner], cells.edge_cells[inner, 0], step)
    passed = np.linalg.norm(places[:, None] - centers, axis=2)
    passed += (np.linalg.norm(places - sites[site], axis=1) - (0.0 if weights is None else weights[site]))[:, None]
    if len(centers) > 1:
        ends = _ends(sites, weights, centers, space, float(passed.max(initial=0.0)), progress)
        is_met = passed <= ends * (1 + 1e-9)
        passed = np.where(is_met | ~is_met.any(axis=1)[:, None], passed, np.inf)
    radius: Reals = passed.min(axis=1)
    last = float(radius.max(initial=0.0)) or float(np.linalg.norm(high - centers[0]))
    count = min(max(frames, 2), MOST_RINGS)
    rings = _rings(sites, weights, centers, space, last * np.arange(1, count + 1) / count, progress)
    return Sweep(
        center=frame.to_space(centers[:1])[0],
        axes=frame.axes,
        last_radius=last,
        edge_vertices=frame.to_space(places),
        edges=edges,
        edge_radius=radius,
        rings=frame.to_space(rings.reshape(-1, 2)).reshape(*rings.shape[:3], 3),
    )


def _ends(
    sites: Reals, weights: Reals | None, centers: Reals, space: Space, longest: float, progress: Progress
) -> Reals:
    """(m,) radii at which circles stop, since they have found the cells of the sites that are nearest to them."""
    sweep: Any = native.load().SweepCircles(sites, centers, weights, domain=space.loops)
    progress.check()
    sweep.grow(2 * longest)
    return np.array(sweep.radii)


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


def _rings(
    sites: Reals, weights: Reals | None, centers: Reals, space: Space, radii: Reals, progress: Progress
) -> Reals:
    """(k, m or 2 m, s, 2): beach curves at each radius, all at their centers before the first site is
    touched; and the circles, where there are several.
    """
    sb: Any = native.load()
    several = len(centers) > 1
    sweep: Any = (
        sb.SweepCircles(sites, centers, weights, domain=space.loops)
        if several
        else sb.SweepCircle(sites, centers[0], weights)
    )
    points = min(RING_POINTS, max(FEWEST_POINTS, ALL_POINTS // len(centers)))
    rings = np.empty((len(radii), 2 * len(centers) if several else 1, points, 2))
    turn = 2 * np.pi * np.arange(points) / points
    round_one = np.column_stack([np.cos(turn), np.sin(turn)])
    for number, radius in enumerate(radii):
        progress.check()
        sweep.grow(float(radius))
        for circle, center in enumerate(centers):
            curve = sweep.beach_curve(circle, points) if several else sweep.beach_curve(points)
            rings[number, circle] = curve if len(curve) else center
        if several:
            reached = np.minimum(np.where(np.isfinite(sweep.radii), sweep.radii, 0.0), radius)
            rings[number, len(centers) :] = centers[:, None] + np.maximum(reached, 0.0)[:, None, None] * round_one
    return rings

# SPDX-License-Identifier: GPL-3.0-or-later
"""Raised cells of a tile that repeats: whole cells, cut where they reach over its sides, go on at the opposite ones."""

from __future__ import annotations

from itertools import product

import numpy as np

from ..results import CellPolygons, Reals

Polygons = list[Reals]  # corners (k, 3): along the tile's sides, and heights


def cut_to_tile(cells: CellPolygons, size: Reals, underside: bool) -> CellPolygons:
    """What lies in [0, size] of convex solids, each of which is whole, and of their copies a size (2,) away.

    Vertices are places and heights. Where a side cuts a solid, a wall closes it. Without `underside` what is all at
    height 0 is left out in the end. O(n log n).
    """
    sizes, first = np.diff(cells.offsets), cells.offsets[:-1]
    corner_cell = np.repeat(cells.polygon_cell, sizes)
    count = int(cells.polygon_cell.max(initial=-1)) + 1
    low, high = np.full((count, 2), np.inf), np.full((count, 2), -np.inf)
    places = cells.vertices[cells.corners]
    np.minimum.at(low, corner_cell, places[:, :2])
    np.maximum.at(high, corner_cell, places[:, :2])
    of_cell = np.split(np.argsort(cells.polygon_cell, kind="stable"), np.cumsum(np.bincount(cells.polygon_cell))[:-1])
    found: list[tuple[int, Polygons]] = []
    for shift in product((0, -1, 1), repeat=2):
        step = np.array([*(shift * size), 0.0])
        is_near = ((high + step[:2] > 0.0) & (low + step[:2] < size)).all(axis=1)
        is_whole = ((low + step[:2] >= 0.0) & (high + step[:2] <= size)).all(axis=1)
        for cell in np.flatnonzero(is_near).tolist():
            solid = [places[first[i] : first[i] + sizes[i]] + step for i in of_cell[cell]]
            part = solid if is_whole[cell] else _cut(solid, size)
            found.append((cell, [polygon for polygon in part if underside or polygon[:, 2].any()]))
    return _joined(found)


def _cut(solid: Polygons, size: Reals) -> Polygons:
    """The part of one convex solid that is in the tile."""
    for axis, is_far in product((0, 1), (False, True)):
        at, sign = (float(size[axis]), -1.0) if is_far else (0.0, 1.0)
        if all((sign * (polygon[:, axis] - at) >= 0.0).all() for polygon in solid):
            continue
        solid = [part for polygon in solid if len(part := _clipped(polygon, axis, at, sign)) > 2]
        wall = _wall(solid, axis, at)
        if len(wall) > 2:
            solid.append(wall if (axis == 0) == is_far else wall[::-1])
    return solid


def _clipped(polygon: Reals, axis: int, at: float, sign: float) -> Reals:
    """The part of a convex polygon on one side; edges of two polygons are cut at the same place to the bit."""
    depth = sign * (polygon[:, axis] - at)
    kept = []
    for i in range(len(polygon)):
        before = i - 1
        if (depth[before] < 0.0) != (depth[i] < 0.0):
            inside, outside = (before, i) if depth[i] < 0.0 else (i, before)
            share = depth[inside] / (depth[inside] - depth[outside])
            place = polygon[inside] + share * (polygon[outside] - polygon[inside])
            place[axis] = at
            kept.append(place)
        if depth[i] >= 0.0:
            kept.append(polygon[i])
    return np.array(kept).reshape(-1, 3)


def _wall(solid: Polygons, axis: int, at: float) -> Reals:
    """The convex polygon (k, 3) that closes a solid at a side, counter-clockwise by the other axis and the height."""
    points = np.concatenate([np.empty((0, 3)), *solid])
    points = np.unique(points[points[:, axis] == at], axis=0)
    along, up = (points - points.mean(axis=0))[:, [1 - axis, 2]].T if len(points) else np.empty((2, 0))
    wall: Reals = points[np.argsort(np.arctan2(up, along), kind="stable")]
    return wall


def _joined(found: list[tuple[int, Polygons]]) -> CellPolygons:
    vertices, corners, counts, owners, total = [np.empty((0, 3))], [np.empty(0, np.int64)], [0], [], 0
    for cell, solid in found:
        if not solid:
            continue
        own, numbers = np.unique(np.concatenate(solid), axis=0, return_inverse=True)
        vertices.append(own)
        corners.append(numbers.ravel() + total)
        counts += [len(polygon) for polygon in solid]
        owners += [cell] * len(solid)
        total += len(own)
    return CellPolygons(
        vertices=np.concatenate(vertices),
        corners=np.concatenate(corners).astype(np.int32),
        offsets=np.cumsum(counts).astype(np.int32),
        polygon_cell=np.array(owners, np.int32),
    )

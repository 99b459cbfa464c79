# SPDX-License-Identifier: GPL-3.0-or-later
"""Solids as signed distances: tubes along curves, blended into one body and turned into a closed mesh.

Distances are negative inside. Shapes join by a smooth minimum (the quadratic one of I. Quilez), so that a leg grows
out of a body instead of piercing it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FAR = 0.3  # a distance that counts as "nowhere near", wider than every blend


def catmull_rom(knots: Array, samples: int) -> Array:
    """A smooth curve (samples, d) through the rows of `knots`, any number of columns."""
    padded = np.vstack([2 * knots[0] - knots[1], knots, 2 * knots[-1] - knots[-2]])
    position = np.linspace(0, len(knots) - 1, samples)
    start = np.minimum(position.astype(int), len(knots) - 2)
    t = (position - start)[:, None]
    a, b, c, d = (padded[start + i] for i in range(4))
    return 0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3)


@dataclass
class Tube:
    """A tube along a polyline; rows of `stations` are x, y, z, radius in the plane y = const, radius along y."""

    stations: Array
    blend: float
    carve: bool = False
    low: Array = field(init=False)
    high: Array = field(init=False)

    def __post_init__(self) -> None:
        reach = self.stations[:, 3:].max(axis=1, keepdims=True) + FAR
        self.low = (self.stations[:, :3] - reach).min(axis=0)
        self.high = (self.stations[:, :3] + reach).max(axis=0)

    def distance(self, points: Array) -> Array:
        """Signed distance, exact for round tubes, scaled by the smaller radius for flattened ones."""
        best = np.full(len(points), FAR)
        stations = self.stations
        if len(stations) == 1:
            stations = np.vstack([stations, stations])
        for a, b in pairwise(stations):
            reach = max(a[3:].max(), b[3:].max()) + FAR
            box_low, box_high = np.minimum(a[:3], b[:3]) - reach, np.maximum(a[:3], b[:3]) + reach
            near = np.flatnonzero(np.all((points >= box_low) & (points <= box_high), axis=1))
            if not len(near):
                continue
            delta = b[:3] - a[:3]
            offset = points[near] - a[:3]
            t = np.clip(offset @ delta / max(delta @ delta, 1e-12), 0, 1)
            offset -= t[:, None] * delta
            radius_z = a[3] + t * (b[3] - a[3])
            radius_y = a[4] + t * (b[4] - a[4])
            smaller = np.minimum(radius_z, radius_y)
            relative = np.sqrt((offset[:, 0] ** 2 + offset[:, 2] ** 2) / radius_z**2 + offset[:, 1] ** 2 / radius_y**2)
            best[near] = np.minimum(best[near], (relative - 1) * smaller)
        return best


def tube(knots: list[tuple[float, ...]], blend: float = 0.05, samples: int = 0, carve: bool = False) -> Tube:
    """A tube through knots (x, y, z, radius) or (x, y, z, radius, radius along y)."""
    rows = np.array([knot if len(knot) == 5 else (*knot, knot[3]) for knot in knots], float)
    if len(rows) > 2 or samples:
        rows = catmull_rom(rows, samples or 8 * (len(rows) - 1) + 1)
    return Tube(rows, blend, carve)


def mirrored(part: Tube) -> Tube:
    """Returns the same part on the other side of the plane y = 0."""
    stations = part.stations.copy()
    stations[:, 1] *= -1
    return Tube(stations, part.blend, part.carve)


def join(current: Array, part: Array, blend: float, carve: bool) -> Array:
    """Smooth union of two distances, or the first with the second carved away."""
    sign = -1.0 if carve else 1.0
    a, b = sign * current, part
    overlap = np.maximum(blend - np.abs(a - b), 0)
    return sign * (np.minimum(a, b) - overlap**2 / (4 * blend))


def distance(parts: list[Tube], points: Array) -> Array:
    """Signed distance of points (n, 3) to the blended parts, cut off at FAR."""
    result = np.full(len(points), FAR)
    for part in parts:
        near = np.flatnonzero(np.all((points >= part.low) & (points <= part.high), axis=1))
        result[near] = join(result[near], part.distance(points[near]), part.blend, part.carve)
    return result


def sample_grid(parts: list[Tube], cell: float) -> tuple[Array, Array]:
    """The blended distance on a grid around the parts: origin (3,) and values (nx, ny, nz).

    A grid four times coarser says which blocks the surface can cross; only those are sampled finely, the others keep
    the coarse value, whose sign is all that matters there.
    """
    ratio = 4
    coarse = ratio * cell
    origin = np.min([p.low for p in parts], axis=0) + FAR - 4 * cell
    top = np.max([p.high for p in parts], axis=0) - FAR + 4 * cell
    blocks = np.ceil((top - origin) / coarse).astype(int)
    at = np.stack(np.meshgrid(*[np.arange(n) for n in blocks], indexing="ij"), axis=-1).reshape(-1, 3)
    center = distance(parts, origin + (at + 0.5) * coarse)
    # A flattened tube's distance can run up to 1.6 times as fast as a true distance.
    near = np.flatnonzero(np.abs(center) < 1.6 * 0.9 * coarse)
    values = np.repeat(center[:, None], ratio**3, axis=1)
    inner = np.stack(np.meshgrid(*3 * [np.arange(ratio)], indexing="ij"), axis=-1).reshape(-1, 3)
    points = origin + (at[near, None] * ratio + inner) * cell
    values[near] = distance(parts, points.reshape(-1, 3)).reshape(-1, ratio**3)
    grid = values.reshape(*blocks, ratio, ratio, ratio).transpose(0, 3, 1, 4, 2, 5).reshape(blocks * ratio)
    return origin, grid


def without_pinches(grid: Array) -> Array:
    """The grid with corners filled in wherever surface nets would touch themselves along an edge or at a vertex.

    Along an edge: at a face of the grid whose inside corners are diagonal neighbors. At a vertex: in a cell whose only
    inside corners, or only outside corners, are the two ends of its long diagonal. Corners are only ever filled, never
    emptied, so this ends.
    """
    grid = grid.copy()
    barely = 1e-3
    for _ in range(50):
        pinched = 0
        for axis in range(3):
            faces = np.moveaxis(grid, axis, 0)  # a view: writing to it changes the grid
            high, wide = faces.shape[1] - 1, faces.shape[2] - 1
            corners = [faces[:, a : high + a, b : wide + b] for a, b in ((0, 0), (0, 1), (1, 1), (1, 0))]
            inside = [corner < 0 for corner in corners]
            for first in (0, 1):
                bad = inside[first] & inside[first + 2] & ~inside[1 - first] & ~inside[3 - first]
                corners[1 - first][bad] = -barely
                pinched += np.count_nonzero(bad)
        cells = tuple(n - 1 for n in grid.shape)
        shifts = [(i >> 2 & 1, i >> 1 & 1, i & 1) for i in range(8)]
        corners = [grid[tuple(slice(s, s + n) for s, n in zip(shift, cells, strict=True))] for shift in shifts]
        inside = [corner < 0 for corner in corners]
        count = np.sum(inside, axis=0)
        for i in range(4):
            alone = (count == 2) & inside[i] & inside[7 - i]
            hole = (count == 6) & ~inside[i] & ~inside[7 - i]
            corners[i ^ 1][alone] = -barely
            corners[i][hole] = -barely
            pinched += np.count_nonzero(alone) + np.count_nonzero(hole)
        if not pinched:
            break
    return grid


def surface_nets(origin: Array, grid: Array, cell: float) -> tuple[Array, NDArray[np.int32]]:
    """The zero surface as quads, one vertex for each crossed cell (naive surface nets; S. Gibson, 1998)."""
    inside = grid < 0
    shape = np.array(grid.shape) - 1
    total = np.zeros((*shape, 3))
    crossings = np.zeros(shape, int)
    corner = np.stack(np.meshgrid(*[np.arange(n) for n in shape], indexing="ij"), axis=-1)
    for axis in range(3):
        others = [a for a in range(3) if a != axis]
        for shift_a in (0, 1):
            for shift_b in (0, 1):
                start = np.zeros(3, int)
                start[others[0]], start[others[1]] = shift_a, shift_b
                step = np.zeros(3, int)
                step[axis] = 1
                here = grid[tuple(slice(s, s + n) for s, n in zip(start, shape, strict=True))]
                there = grid[tuple(slice(s, s + n) for s, n in zip(start + step, shape, strict=True))]
                crossed = (here < 0) != (there < 0)
                weight = here[crossed] / (here[crossed] - there[crossed])
                total[crossed] += corner[crossed] + start + weight[:, None] * step
                crossings[crossed] += 1
    active = crossings > 0
    index = np.full(shape, -1)
    index[active] = np.arange(np.count_nonzero(active))
    vertices = total[active] / crossings[active][:, None] * cell + origin

    quads = []
    for axis in range(3):
        one, two = (axis + 1) % 3, (axis + 2) % 3
        here = inside.take(range(grid.shape[axis] - 1), axis)
        there = inside.take(range(1, grid.shape[axis]), axis)
        at = np.argwhere(here != there)
        at = at[(at[:, one] > 0) & (at[:, two] > 0) & (at[:, one] < shape[one]) & (at[:, two] < shape[two])]
        ring = []
        for back_one, back_two in ((0, 0), (1, 0), (1, 1), (0, 1)):
            around = at.copy()
            around[:, one] -= back_one
            around[:, two] -= back_two
            ring.append(index[tuple(around.T)])
        ring = np.stack(ring, axis=1)
        leaving = inside[tuple(at.T)]
        quads.append(np.where(leaving[:, None], ring, ring[:, ::-1]))
    return vertices, np.concatenate(quads).astype(np.int32)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Does what a sculptor does after the big forms stand: smoothing, creases, folds and fine noise."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from implicit import Array
from numpy.typing import NDArray
from shape import EYE_AXIS, EYE_CENTER, MOUTH, TAIL_CENTER

Ints = NDArray[np.int32]


def smooth(vertices: Array, quads: Ints, rounds: int) -> Array:
    """Takes the grid's steps out without shrinking (G. Taubin, 1995)."""
    ends = np.concatenate([quads[:, [i, (i + 1) % 4]] for i in range(4)])
    degree = np.bincount(ends[:, 0], minlength=len(vertices))[:, None]
    for _ in range(rounds):
        for step in (0.5, -0.52):
            mean = np.stack([np.bincount(ends[:, 0], vertices[ends[:, 1], a], len(vertices)) for a in range(3)], axis=1)
            vertices = vertices + step * (mean / degree - vertices)
    return vertices


def vertex_normals(vertices: Array, quads: Ints) -> Array:
    """Unit normals, each the area-weighted mean of the quads around."""
    face = np.cross(vertices[quads[:, 2]] - vertices[quads[:, 0]], vertices[quads[:, 3]] - vertices[quads[:, 1]])
    normal = np.zeros_like(vertices)
    for corner in range(4):
        for axis in range(3):
            normal[:, axis] += np.bincount(quads[:, corner], face[:, axis], len(vertices))
    return normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)


def noise(points: Array, seed: int) -> Array:
    """Gradient noise in [-1, 1] (K. Perlin, 1985) with a hashed lattice."""
    cell = np.floor(points).astype(np.int64)
    local = points - cell
    fade = local**3 * (local * (local * 6 - 15) + 10)
    total = np.zeros(len(points))
    for corner in range(8):
        shift = np.array([corner & 1, corner >> 1 & 1, corner >> 2])
        key = (cell + shift) @ np.array([73856093, 19349663, 83492791]) + seed * 2654435761
        key = (key ^ key >> 13) * 1274126177 & 0xFFFFFFFF
        key ^= key >> 16
        direction = np.stack([(key >> 8 * a & 255) / 127.5 - 1 for a in range(3)], axis=1)
        weight = np.prod(np.where(shift == 1, fade, 1 - fade), axis=1)
        total += weight * np.einsum("ij,ij->i", direction, local - shift)
    return total


def octaves(points: Array, frequency: float, count: int, seed: int) -> Array:
    """A sum of noises, each twice as fine and half as strong as the one before."""
    return sum((noise(points * frequency * 2**i, seed + i) / 2**i for i in range(count)), np.zeros(len(points)))


def step(value: Array, low: float, high: float) -> Array:
    """0 below `low`, 1 above `high`, smooth between; falls where high < low."""
    t = np.clip((value - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def distance_to_line(points: Array, line: Array) -> Array:
    """Distance in the plane from points (n, 2) to a polyline (m, 2)."""
    best = np.full(len(points), np.inf)
    for a, b in pairwise(line):
        t = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        best = np.minimum(best, np.linalg.norm(points - a - t[:, None] * (b - a), axis=1))
    return best


def eye_coordinates(points: Array) -> tuple[Array, Array]:
    """Returns for the nearer eye: distance from its axis and height along it."""
    offset = points * [1, 0, 1] + [0, 1, 0] * np.abs(points) - EYE_CENTER
    height = offset @ EYE_AXIS
    return np.linalg.norm(offset - height[:, None] * EYE_AXIS, axis=1), height


def detail(vertices: Array, normals: Array) -> Array:
    """Returns how far each vertex moves along its normal."""
    x, y, z = vertices.T
    head = step(x, 0.95, 1.1)
    trunk = step(x, -1.1, -0.7) * step(x, 1.0, 0.7) * step(z, 0.28, 0.45)
    from_axis, along_eye = eye_coordinates(vertices)
    turret = step(from_axis, 0.21, 0.13) * step(along_eye, -0.10, 0.0)

    lips = distance_to_line(vertices[:, [0, 2]], MOUTH)
    side = step(np.abs(y), 0.02, 0.06) + step(x, 1.55, 1.7)
    move = -0.030 * np.exp(-((lips / 0.016) ** 2)) * np.minimum(side, 1) * head
    move += 0.012 * np.exp(-(((lips - 0.045) / 0.025) ** 2)) * np.minimum(side, 1) * head

    # Rings around the turret, and the cup that holds the eye.
    move += turret * 0.0045 * np.cos(from_axis * 2 * np.pi / 0.034)
    move -= 0.035 * np.exp(-((from_axis / 0.036) ** 2)) * step(along_eye, 0.05, 0.10)

    # Soft ribs under the skin, slanted and broken up by noise.
    bend = x + 0.25 * (z - 0.7) + 0.05 * noise(vertices * 2.1, 11)
    rib = np.cos(2 * np.pi * bend / 0.155)
    move += trunk * step(z, 1.05, 0.80) * 0.009 * rib

    # Rings along the tail, folds at the throat.
    tail = step(x, -1.0, -1.35)
    angle = np.arctan2(z - TAIL_CENTER[2], x - TAIL_CENTER[0])
    move += tail * 0.0035 * np.cos(angle * 22)
    throat = step(z, 0.62, 0.48) * head * step(np.abs(y), 0.03, 0.08)
    move += throat * 0.006 * np.cos((z - 0.35 * x) * 2 * np.pi / 0.055)

    move += 0.016 * octaves(vertices, 2.2, 2, 3) * (1 - 0.6 * head)
    crest = step(np.abs(y), 0.05, 0.02) * step(np.abs(normals[:, 1]), 0.0, 0.4)
    move += 0.0065 * octaves(vertices, 9.0, 3, 7) * (1 - 0.7 * turret) * (1 - crest)
    return move


def paint(vertices: Array) -> Array:
    """The painted density in [0, 1]: finer cells on head, feet, tail tip and crest."""
    x, _, z = vertices.T
    from_axis, along_eye = eye_coordinates(vertices)
    paint = 0.10 + 0.38 * step(x, 0.80, 1.15) + 0.10 * step(x, 1.25, 1.6)
    paint += 0.50 * step(from_axis, 0.22, 0.10) * step(along_eye, -0.1, 0.0)
    paint = np.maximum(paint, 0.95 * step(z, 0.22, 0.06) * step(x, -1.18, -1.08))
    paint = np.maximum(paint, 0.10 + 0.35 * step(z, 0.45, 0.2) * step(x, -1.18, -1.08))
    spiral = np.hypot(x - TAIL_CENTER[0], z - TAIL_CENTER[2])
    tail = step(x, -0.95, -1.35)
    paint = np.maximum(paint, tail * (0.2 + 0.75 * step(spiral, 0.62, 0.12)))
    return np.clip(paint + 0.03 * noise(vertices * 3, 21), 0.06, 1.0)

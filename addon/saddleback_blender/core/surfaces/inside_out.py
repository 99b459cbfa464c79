# SPDX-License-Identifier: GPL-3.0-or-later
"""Tells which parts of a surface are turned inside out, so that what is put on them stands within."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import native
from ..requests import Surface
from ..results import Reals


def inside_out_of(surface: Surface) -> list[str]:
    """One sentence where closed parts are inside out."""
    count, parts = inside_out_parts(surface)
    if not count:
        return []
    what = "is" if count == parts else f"has {count} of {parts} parts that are"
    return [
        f"'{surface.name}' {what} inside out, and what is put there stands within: press Repair in the Saddleback tab, "
        "then run again"
    ]


def inside_out_parts(surface: Surface) -> tuple[int, int]:
    """The number of closed parts that face inward but for walls of hollows, and that of all parts."""
    part = np.asarray(native.load().connected_parts(surface.triangles, len(surface.vertices)))
    vertices = surface.vertices - surface.vertices.mean(axis=0)
    first, second, third = (vertices[corner] for corner in surface.triangles.T)
    volume = np.bincount(part, np.einsum("ij,ij->i", first, np.cross(second, third)) / 6.0)
    is_closed = np.ones(len(volume), bool)
    is_closed[part[native.load().border_edges(surface.triangles, len(vertices))[1]]] = False
    inward = is_closed & (volume < 0.0)
    if not inward.any():
        return 0, len(volume)
    least, most = np.full((len(volume), 3), np.inf), np.full((len(volume), 3), -np.inf)
    for corner in (first, second, third):
        np.minimum.at(least, part, corner)
        np.maximum.at(most, part, corner)
    inward &= volume < -1e-6 * np.prod(most - least, axis=1)  # a flat part has no inside; its volume is rounding
    outer = is_closed & (volume > 0.0)
    is_wall = lie_within(least[inward], most[inward], least[outer], most[outer])
    return int((~is_wall).sum()), len(volume)


def lie_within(least: Reals, most: Reals, outer_least: Reals, outer_most: Reals) -> NDArray[np.bool_]:
    """(n,) whether boxes lie within some outer one: corners (n, 3) and (m, 3). O((n + m) log m), typically.

    Outer boxes are the leaves of a binary tree, halved along one coordinate of their corners after the other.
    """
    found = np.zeros(len(least), bool)
    if not len(outer_least):
        return found
    corners = np.hstack([outer_least, -outer_most])  # one lies within another whose numbers are all no larger
    asked = np.hstack([least, -most])
    levels = (len(corners) - 1).bit_length()
    order = np.resize(np.arange(len(corners)), (1, 2**levels))
    for level in range(levels):
        along = corners[order, level % 6].argsort(axis=1, kind="stable")
        order = np.take_along_axis(order, along, axis=1).reshape(2 * len(order), -1)
    box, node = np.arange(len(asked)), np.zeros(len(asked), np.int64)
    for level in range(levels + 1):
        leaves = corners[order.reshape(2**level, -1)]
        found[box[(leaves.max(axis=1)[node] <= asked[box]).all(axis=1)]] = True  # all of them are around it
        may = (leaves.min(axis=1)[node] <= asked[box]).all(axis=1) & ~found[box]
        box, node = np.tile(box[may], 2), np.concatenate([2 * node[may], 2 * node[may] + 1])
    return found

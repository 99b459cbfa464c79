# SPDX-License-Identifier: GPL-3.0-or-later
"""Tells which parts of a surface are turned inside out, so that what is put on them stands within."""

from __future__ import annotations

import numpy as np

from .. import native
from ..requests import Surface


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
    outer = np.nonzero(is_closed & (volume > 0.0))[0]
    count = 0
    for i in np.nonzero(inward)[0]:
        is_wall = (least[outer] <= least[i]).all(axis=1) & (most[outer] >= most[i]).all(axis=1)
        count += not is_wall.any()
    return count, len(volume)

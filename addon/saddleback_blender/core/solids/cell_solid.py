# SPDX-License-Identifier: GPL-3.0-or-later
"""Raise a surface and close it: walls along its border, and a copy from below."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import native
from .level_cut import open_chords
from .mesh_edges import border_edges

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]


@dataclass(frozen=True)
class Raised:
    """A raised surface: of n vertices where they stand, which way and how far they go; triangles (m,3) of the solid,
    and the input triangle that each comes from (m,). After the n come those that stand below, on `feet` (k,) of them.
    """

    base: Floats
    direction: Floats
    height: Floats
    feet: Ints
    triangles: Ints
    parent: Ints

    def at(self, share: Floats) -> Floats:
        """The solid's vertices (n + k,3) when each goes a share (n,) of its way; some are used by no triangle."""
        raised = self.base + (share * self.height)[:, None] * self.direction
        return np.concatenate([raised, self.base[self.feet]])

    @property
    def place(self) -> Ints:
        """Which of the n vertices each of the solid's is, or stands below."""
        return np.concatenate([np.arange(len(self.base), dtype=np.int32), self.feet])


def vertex_normals(vertices: Floats, triangles: Ints) -> Floats:
    """Unit normals (V,3), weighted by triangle area; zero where no triangle with an area meets the vertex."""
    normals: Floats = native.load().vertex_normals(vertices, triangles)
    return normals


def _unit(vectors: Floats) -> Floats:
    length = np.sqrt(np.einsum("ij,ij->i", vectors, vectors))[:, None]
    unit: Floats = np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0.0)
    return unit


def raise_surface(fields: Floats, triangles: Ints, height: Floats, underside: bool) -> Raised:
    """Move the vertices by height (V,) >= 0 along their directions and build walls where the raised surface ends.

    fields (V,6) or wider: position and direction (any length) come first. With `underside` each piece is closed from
    below by a copy that was not moved, so that every edge has two triangles; where the border was not raised it is
    shared.
    """
    parent = np.arange(len(triangles), dtype=np.int32)
    if underside:
        start, end, _ = border_edges(triangles, len(fields))
        flat = (height[start] <= 0.0) & (height[end] <= 0.0)
        fields = np.column_stack([fields[:, :6], height])
        opened = open_chords(fields, triangles, np.stack([start[flat], end[flat]], axis=1))
        fields, triangles, parent, height = opened.fields, opened.triangles, opened.parent, opened.fields[:, 6]
    size = len(fields)
    # Below each vertex that needs one stands its foot, a vertex at height zero; one that was not raised is its own.
    start, end, owner = border_edges(triangles, size)
    is_border = np.zeros(size, dtype=np.bool_)
    is_border[start] = True
    stands = is_border & (height > 0.0)
    if underside:
        stands |= ~is_border
    foot = np.arange(size, dtype=np.int32)
    foot[stands] = size + np.arange(stands.sum(), dtype=np.int32)

    first = foot[start] != start
    second = foot[end] != end
    pieces = [
        triangles,
        np.stack([end, start, foot[start]], axis=1)[first],
        np.stack([end, foot[start], foot[end]], axis=1)[second],
    ]
    parents = [parent, parent[owner[first]], parent[owner[second]]]
    if underside:
        pieces.append(foot[triangles[:, ::-1]])
        parents.append(parent)
    return Raised(
        np.ascontiguousarray(fields[:, :3]),
        _unit(fields[:, 3:6]),
        height,
        np.flatnonzero(stands).astype(np.int32),
        np.concatenate(pieces),
        np.concatenate(parents),
    )

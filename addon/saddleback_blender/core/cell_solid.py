"""Raise a surface along its normals and close it: walls along its border, and a copy from below."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import native
from .level_cut import open_chords
from .mesh_edges import border_edges

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]


@dataclass(frozen=True)
class Solid:
    """Vertices (n,3), some of them unused, triangles (m,3), and the input triangle that each comes from (m,)."""

    vertices: Floats
    triangles: Ints
    parent: Ints


def vertex_normals(vertices: Floats, triangles: Ints) -> Floats:
    """Unit normals (V,3), weighted by triangle area; zero where no triangle with an area meets the vertex."""
    normals: Floats = native.load().vertex_normals(vertices, triangles)
    return normals


def _unit(vectors: Floats) -> Floats:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    unit: Floats = np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0.0)
    return unit


def raise_surface(fields: Floats, triangles: Ints, height: Floats, underside: bool) -> Solid:
    """Move the vertices by height (V,) >= 0 along their normals and build walls where the raised surface ends.

    fields (V,6) or wider: position and normal (any length) come first. With `underside` each piece is closed from below
    by a copy that was not moved, so that every edge has two triangles; where the border was not raised it is shared.
    """
    parent = np.arange(len(triangles), dtype=np.int32)
    fields = np.column_stack([fields[:, :6], height])
    if underside:
        start, end, _ = border_edges(triangles, len(fields))
        flat = (height[start] <= 0.0) & (height[end] <= 0.0)
        opened = open_chords(fields, triangles, np.stack([start[flat], end[flat]], axis=1))
        fields, triangles, parent = opened.fields, opened.triangles, opened.parent
    size = len(fields)
    base, height = fields[:, :3], fields[:, 6]
    raised = base + height[:, None] * _unit(fields[:, 3:6])

    # Below each vertex stands its foot: a vertex at height zero, or itself where the border was not raised.
    start, end, owner = border_edges(triangles, size)
    is_border = np.zeros(size, dtype=np.bool_)
    is_border[start] = True
    top = np.arange(size, dtype=np.int32)
    foot = np.where(is_border & (height <= 0.0), top, top + size).astype(np.int32)

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
    return Solid(np.concatenate([raised, base]), np.concatenate(pieces), np.concatenate(parents))

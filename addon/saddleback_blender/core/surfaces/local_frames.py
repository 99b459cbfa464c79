# SPDX-License-Identifier: GPL-3.0-or-later
"""Places and directions told by the surface about the place that they belong to, so that they go with it when it moves
and turns.
"""

from __future__ import annotations

import numpy as np

from ..progress import Progress, blocks
from ..requests import Surface
from ..results import Anchors, Indices, Reals

REST_STEP = 0.1  # of a triangle's shortest side


def frames_along(first: Reals, normals: Reals) -> Reals:
    """(n, 3, 3) rows: along the first side at right angles to the normal, across both, along the normal; of length 1.

    `first` (n, 3), `normals` (n, 3) of any length; zero where these have no directions. O(n).
    """
    z = _unit(normals)
    x = _unit(first - np.einsum("ni,ni->n", first, z)[:, None] * z)
    frames: Reals = np.stack([x, np.cross(z, x), z], axis=1)
    return frames


def rest_anchors(rest: Reals, corners: Indices, barycentric: Reals, has_steps: bool) -> tuple[Reals, ...]:
    """Returns where points (n,) stand on a mesh at rest and, where asked for, steps from there along the first sides of
    their triangles.

    `rest` (V, 3) its vertices' places, `corners` (n, 3) of the triangles, `barycentric` (n, 3). O(n).
    """
    found = np.empty((2 if has_steps else 1, len(corners), 3))
    for rows in blocks(len(corners)):
        places = rest[corners[rows]]
        found[0, rows] = np.einsum("ni,nij->nj", barycentric[rows], places)
        if has_steps:
            sides = np.linalg.norm(places - np.roll(places, 1, axis=1), axis=2)
            found[1, rows] = REST_STEP * sides.min(axis=1)[:, None] * _unit(places[:, 1] - places[:, 0])
    return tuple(found)


def in_frames(frames: Reals, vectors: Reals) -> Reals:
    """(n, 3) vectors by the axes of their frames (n, 3, 3)."""
    found: Reals = np.einsum("nij,nj->ni", frames, vectors)
    return found


def anchored(
    surface: Surface, triangles: Indices, faces: Indices, barycentric: Reals, points: Reals, progress: Progress
) -> Anchors:
    """Points (n, 3), and where on the triangles of the surface they stand. O(n).

    `triangles` are the library's, of which `faces` (n,) counts.
    """
    corners = triangles[faces]
    offset = np.empty((len(faces), 3))
    for rows in progress.blocks(len(faces)):
        feet = np.einsum("ni,nij->nj", barycentric[rows], surface.vertices[corners[rows]])
        offset[rows] = points[rows] - feet
    return Anchors(
        corners=corners if surface.used is None else surface.used[corners], barycentric=barycentric, offset=offset
    )


def _unit(vectors: Reals) -> Reals:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    units: Reals = np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0)
    return units

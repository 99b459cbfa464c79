"""Places and directions told by the triangle that they belong to, so that they go with it when it moves and turns."""

from __future__ import annotations

import numpy as np

from ..progress import Progress
from ..requests import Surface
from ..results import Anchors, Indices, Reals

REST_STEP = 0.1  # of a triangle's shortest side


def triangle_frames(corners: Reals) -> Reals:
    """(n, 3, 3) rows: along the first side, in the plane at right angles to it, along the normal, each of length 1.

    `corners` (n, 3, 3) counter-clockwise from outside. O(n).
    """
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(first, second)
    x, z = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in (first, normal))
    frames: Reals = np.stack([x, np.cross(z, x), z], axis=1)
    return frames


def rest_anchors(rest: Reals, corners: Indices, barycentric: Reals) -> tuple[Reals, Reals, Reals]:
    """Returns where points (n,) stand on a mesh at rest, and steps from there along the first two axes of their
    triangles.

    `rest` (V, 3) its vertices' places, `corners` (n, 3) of the triangles, `barycentric` (n, 3). O(n).
    """
    places = rest[corners]
    sides = np.linalg.norm(places - np.roll(places, 1, axis=1), axis=2)
    frames = triangle_frames(places) * (REST_STEP * sides.min(axis=1))[:, None, None]
    feet: Reals = np.einsum("ni,nij->nj", barycentric, places)
    return feet, frames[:, 0], frames[:, 1]


def in_frames(frames: Reals, vectors: Reals) -> Reals:
    """(n, 3) vectors by the axes of their frames (n, 3, 3)."""
    found: Reals = np.einsum("nij,nj->ni", frames, vectors)
    return found


def anchored(
    surface: Surface, triangles: Indices, faces: Indices, barycentric: Reals, points: Reals, progress: Progress
) -> Anchors:
    """Points (n, 3) as seen from the triangles of the surface that they stand on. O(n).

    `triangles` are the library's, of which `faces` (n,) counts.
    """
    corners = triangles[faces]
    shift = np.empty((len(faces), 3))
    for rows in progress.blocks(len(faces)):
        places = surface.vertices[corners[rows]]
        feet = np.einsum("ni,nij->nj", barycentric[rows], places)
        shift[rows] = in_frames(triangle_frames(places), points[rows] - feet)
    return Anchors(
        corners=corners if surface.used is None else surface.used[corners], barycentric=barycentric, shift=shift
    )

# SPDX-License-Identifier: GPL-3.0-or-later
"""Small shapes where those that overlap leave skin bare: where they had to be drawn smaller, and along borders."""

from __future__ import annotations

from typing import Any

import numpy as np

from .. import native
from ..results import Indices, Reals
from ..solids.crossings import find_crossings
from ..surfaces.local_frames import frames_along, in_frames
from ..surfaces.normals import normals_at
from ..surfaces.point_grid import PointGrid
from ..surfaces.quaternions import turned

PLACES_EACH = 20  # of a shape: where the surface is looked at, so that no gap of half a footprint's width is missed
SIZES = (0.6, 0.35, 0.2)  # of the shapes beside a gap: what it is filled with, the largest first
APART = 0.5  # of their size: how far those of one size lie from each other
WIDE = 0.6  # of their length: both are closer for shapes that are narrower than this
UNDER, THIN = 0.05, 1e-3  # of a shape's size: how far below the surface a line of sight begins, and how wide it is
SEED = 1


class Gaps:
    """Places spread over the surface, and which of them nothing lies over as seen along the normal."""

    def __init__(self, mesh: Any, shapes: Any, frames: tuple[Reals, Reals, Reals], extent: Reals) -> None:
        """`frames` of the shapes; `extent` (3,): how long and wide they are and how high they stand, of their size."""
        sb = native.load()
        self._mesh, self._shapes = mesh, shapes
        middle, turns, _ = frames
        x, y = (turned(turns, np.tile(axis, (len(middle), 1))) for axis in np.eye(3)[:2])
        self._along, scale = x, np.asarray(self._shapes.scale)
        self._closer = float(np.sqrt(min(extent[:2].min() / extent[:2].max() / WIDE, 1.0)))
        self._points = sb.sample(mesh, round(PLACES_EACH / self._closer) * len(middle), seed=SEED)
        self._places = np.asarray(self._points.positions(mesh))
        self._normals = normals_at(mesh.vertices, mesh.triangles, self._points.faces, self._points.barycentric)
        # The shape nearest to a place: a speck of a triangle stands for each.
        specks = np.stack([middle, middle + THIN * scale[:, None] * x, middle + THIN * scale[:, None] * y], axis=1)
        corners = np.arange(3 * len(middle), dtype=np.int32).reshape(-1, 3)
        self._near = sb.project(sb.Mesh(specks.reshape(-1, 3), corners), self._places).faces
        self._size, self._height = scale[self._near], extent[2]
        self._bare = np.arange(len(self._places))

    def look(self, vertices: Reals, triangles: Indices, job: Any) -> None:
        """Leaves out the places over which one of the triangles lies, as exact tests of thin lines of sight tell."""
        bare, first = self._bare, len(vertices)
        foot, normal, size = self._places[bare], self._normals[bare], self._size[bare, None]
        across = THIN * size * frames_along(np.roll(normal, 1, axis=1) + (0.1, 0.2, 0.4), normal)[:, 0]
        top = foot + self._height * size * normal
        lines = np.concatenate([foot - UNDER * size * normal, top - across, top + across])
        corners = first + np.arange(len(lines), dtype=np.int32).reshape(3, -1).T
        among = np.arange(len(triangles), len(triangles) + len(corners), dtype=np.int32)
        owners = np.repeat(np.array([0, 1], np.int32), [len(triangles), len(corners)])
        found = find_crossings(
            np.concatenate([vertices, lines]), np.concatenate([triangles, corners]), among, job, owners
        )
        self._bare = np.delete(bare, np.unique(found.max(axis=1)) - len(triangles))

    def fillers(self, share: float) -> Any:
        """Placements on bare places, of that share of the shapes nearest to them and turned as those are."""
        if not len(self._bare):
            return None
        largest, sizes, chosen = float(self._size.max()), self._size[self._bare], []
        octaves = np.round(np.log2(sizes / largest))  # those of about one size keep off each other
        for octave in np.unique(octaves):
            places = self._bare[octaves == octave]
            grid = PointGrid(APART * self._closer * share * largest * 2.0**octave)
            chosen.append(places[grid.take_free(self._places[places])])
        rows = np.sort(np.concatenate(chosen))
        near, faces = self._near[rows], self._points.faces[rows]
        a, b, c = (self._mesh.vertices[self._mesh.triangles[faces, side]] for side in range(3))
        along = in_frames(frames_along(b - a, np.cross(b - a, c - a)), self._along[near])
        sb, shapes = native.load(), self._shapes
        return sb.Placements(
            shapes.shape[near], sb.SurfacePoints(faces, self._points.barycentric[rows]),
            np.arctan2(along[:, 1], along[:, 0]), share * self._size[rows], shapes.mirrored[near],
        )  # fmt: skip

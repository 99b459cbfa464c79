# SPDX-License-Identifier: GPL-3.0-or-later
"""The surface that the outputs of a run stand on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import cache, native
from ..progress import Progress
from ..requests import Surface, digest
from ..results import Anchors, Indices, Reals
from .local_frames import anchored


@dataclass(frozen=True)
class Ground:
    """A surface and its triangles as the library has them, by which points on it are told."""

    surface: Surface
    mesh: Any  # the library's

    def anchors(self, points: Reals, feet: Reals | None, progress: Progress) -> Anchors:
        """Points (n, 3), and the triangles next to their feet (n, 3), by default to themselves.

        Those of points that were asked for before are kept. O(n log F).
        """
        feet = points if feet is None else feet
        key = ("anchors", self.surface.key, digest(points, feet))

        def find() -> Anchors:
            places = native.load().project(self.mesh, feet)
            triangles: Indices = np.asarray(self.mesh.triangles)
            return anchored(self.surface, triangles, places.faces, places.barycentric, points, progress)

        return cache.shared.get(key, find, lambda found: found.corners.nbytes + 2 * found.offset.nbytes)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Isolines of a distance, also across faces that are wide beside their spacing."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from . import native
from .progress import Progress
from .requests import Surface
from .results import Reals
from .settings import DistanceSettings
from .solids.level_lines import LevelLines, isoline_levels, isoline_spacing, level_lines
from .surfaces.halved_edges import HalvedEdges

WIDE = 4.0  # spacings: what is linear over wider faces shows no circles
FAR_WIDER = 4.0  # than that: where colors of vertices show nothing of the bands
MOST_TRIANGLES = 40_000  # of what faces are divided into


def isolines_of(
    surface: Surface, mesh: Any, values: Reals, between: Callable[[Any], Reals], settings: DistanceSettings,
    progress: Progress,
) -> LevelLines:  # fmt: skip
    """Isolines of distances (v,) of the vertices; `between` measures them at other points, where faces are wide."""
    farthest = float(values[np.isfinite(values)].max(initial=0.0))
    levels = isoline_levels(settings, farthest, surface.name)
    vertices, triangles = surface.vertices, surface.triangles
    if len(levels):
        sides = vertices[triangles] - vertices[np.roll(triangles, 1, axis=1)]
        width = float(np.linalg.norm(sides, axis=2).max()) / isoline_spacing(settings, farthest)
        times = min(math.ceil(math.log2(width)), int(math.log2(MOST_TRIANGLES / len(triangles)) / 2.0))
        if width > WIDE and times > 0:
            halved = HalvedEdges.of(vertices, np.asarray(mesh.triangles), times)
            fresh = slice(len(vertices), None)
            points = native.load().SurfacePoints(halved.faces[fresh], halved.barycentric[fresh])
            if settings.make_preview and width > FAR_WIDER * WIDE:
                progress.note(
                    f"'{surface.name}': its faces are wider than the bands, and only its vertices have colors; "
                    "subdivide it for colors as fine as the lines"
                )
            vertices, triangles, values = halved.vertices, halved.triangles, np.append(values, between(points))
    with progress.stage(0.98, "following the isolines"):
        return level_lines(vertices, triangles, values, levels)

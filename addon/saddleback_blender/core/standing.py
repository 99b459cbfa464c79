# SPDX-License-Identifier: GPL-3.0-or-later
"""Where on the surface the vertices of cells' outputs stand: found with the cells, not when they are written."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from . import cache
from .graphs import mesh_of_surface
from .progress import Progress
from .requests import Surface
from .results import CellsResult, Reals
from .settings import TessellateSettings
from .solids.edge_network import edge_network
from .surfaces.ground import Ground


def with_anchors(
    run: Callable[[Progress], CellsResult], surface: Surface, settings: TessellateSettings, progress: Progress
) -> CellsResult:
    """Runs, and finds the anchors on the whole `surface` that writing will ask for: Blender's window waits for that."""
    result = run(progress)
    ground = Ground(surface, mesh_of_surface(surface, progress, cache.shared))
    points: list[tuple[Reals, Reals | None]] = []
    if settings.make_edges and settings.edge_kind == "MESH":
        network = edge_network(result.edge_points, result.edge_offsets, result.edge_cells, result.edge_closed)
        points.append((network.vertices, None))
        result = replace(result, network=network)
    if result.mesh is not None:
        points.append((result.mesh.vertices, result.mesh.feet))
    if result.polygons is not None:
        points.append((result.polygons.vertices, None))
    if result.dual is not None:
        points.append((result.dual.vertices, None))
    if result.shell is not None:
        points.append((result.shell.vertices, result.shell.feet))
    for places, feet in points:
        ground.anchors(places, feet, progress)
    return result

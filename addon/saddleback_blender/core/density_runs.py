# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities: painted ones as they are, others computed from the surface, from curves, from a few painted places."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from . import native
from .errors import BadInputError
from .fields.curve_points import curves_on_surface
from .fields.density import DensityError, shape
from .progress import Progress
from .requests import CurvatureDensity, Density, DistanceDensity, SpreadDensity, Surface
from .results import Reals
from .settings import DensitySettings

REACH = 0.1  # of the surface's extent, where none is given
# More painted vertices than that are spread by one system for all instead of two for each.
MOST_SMOOTH = 24


def density_of(
    density: Density | None,
    surface: Surface,
    settings: DensitySettings,
    mesh: Any,
    find_graph: Callable[[], Any],
    progress: Progress,
) -> Reals | None:
    """(n,) density at the surface's vertices; None for uniform. Raises BadInputError and the library's errors.

    `find_graph` is asked for a distance graph only where distances count.
    """
    if density is None:
        return None
    if isinstance(density, np.ndarray):
        return surface.gather(density)
    upper: float | None = 1.0
    if isinstance(density, CurvatureDensity):
        values, label, upper = native.load().density_by_curvature(mesh), "the density by curvature", None
    elif isinstance(density, DistanceDensity):
        values, label = (
            _by_distance(density, surface, settings, mesh, find_graph(), progress),
            "the density about curves",
        )
    else:
        values, label = _spread(density, surface, mesh, progress), f"what spreads from {density.label}"
    try:
        # Curvature and distance say themselves how small cells are.
        smaller_by = settings.density_smaller_by if isinstance(density, SpreadDensity) else 0.0
        return shape(values, settings.density_invert, settings.density_contrast, upper, smaller_by)
    except DensityError as error:
        raise BadInputError(f"'{surface.name}': {label} {error}") from error


def _by_distance(
    density: DistanceDensity, surface: Surface, settings: DensitySettings, mesh: Any, graph: Any, progress: Progress
) -> Reals:
    sb = native.load()
    with progress.stage(0.55, "following the curves"):
        curves, lone = curves_on_surface(mesh, graph, density.curves)
    far = np.full(len(surface.vertices), np.inf)
    for part in (curves, lone):
        if part is not None and len(part):
            with progress.stage(0.6, "measuring distances to the curves") as job:
                far = np.minimum(far, graph.distances(part, job=job))
    tenth = REACH * float(np.linalg.norm(np.ptp(surface.vertices, axis=0)))
    reach = progress.choose("density_reach", settings.density_reach, tenth)
    ramp: Reals = sb.ramp_by_distance(far, 1.0, settings.density_beyond, reach)
    return ramp


def _spread(density: SpreadDensity, surface: Surface, mesh: Any, progress: Progress) -> Reals:
    vertices = surface.compact(density.vertices)
    on_surface = vertices >= 0
    if not on_surface.any():
        raise BadInputError(f"'{surface.name}': no vertex of a face is painted in {density.label}; paint a few")
    method = "biharmonic" if on_surface.sum() <= MOST_SMOOTH else "harmonic"
    with progress.stage(0.6, "spreading the painted values") as job:
        values: Reals = native.load().spread_values(
            mesh, vertices[on_surface], density.values[on_surface], method, job=job
        )
    return values

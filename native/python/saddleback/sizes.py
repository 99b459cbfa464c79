# SPDX-License-Identifier: MIT
"""Densities and sizes over a surface, as one could paint them: from distances and from how it bends."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from saddleback._arrays import real, reals
from saddleback._saddleback import InputError, Mesh, principal_curvatures

_Floats = NDArray[np.float64]


def blend_by_distance(distances: ArrayLike, values: ArrayLike, power: float = 2.0) -> _Floats:
    """Values of a few sources, blended by the inverse of the distance to each.

    Every source keeps its value, and the blend never leaves their range. O(sources n).

    Args:
        distances: (sources, n) distances from each source, as `SaddleVertexGraph.fields` gives them; inf where it does
            not reach.
        values: (sources,) values.
        power: of the inverse distance, > 0; large ones make cells of nearly one value about each source.

    Returns
    -------
        (n,) float64; where no source reaches the mean of the values.

    Raises
    ------
        InputError: shapes that do not fit, negative distances, values that are not finite.

    After [shepard1968], with geodesic distances.
    """
    far, known, power = reals(distances, "distances"), reals(values, "values"), real(power, "power")
    if far.ndim != 2 or known.shape != far.shape[:1] or not len(known):
        raise InputError(f"distances: wanted one row for each of the values, got {far.shape} and {known.shape}")
    if not np.isfinite(known).all():
        raise InputError(f"values: value at [{np.flatnonzero(~np.isfinite(known))[0]}] is not finite")
    if not (far >= 0).all():
        row, column = np.argwhere(~(far >= 0))[0]
        raise InputError(f"distances: {far[row, column]} at [{row}, {column}] is no distance")
    if not power > 0:
        raise InputError(f"power is {power}, but must be positive")
    nearest = far.min(axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        weights = np.where(far == nearest, 1.0, (nearest / far) ** power)  # of the nearest one: 1
    weights[:, np.isinf(nearest)] = 1
    blended: _Floats = (known @ weights) / weights.sum(axis=0)
    return np.clip(blended, known.min(), known.max())


def ramp_by_distance(distances: ArrayLike, at: float, beyond: float, reach: float) -> _Floats:
    """A value `at` a curve or points that changes smoothly into another one `beyond` a distance.

    Args:
        distances: (n,) distances, as of `SaddleVertexGraph.distances(curve)`; inf counts as beyond.
        at, beyond: the values at distance 0 and from `reach` on.
        reach: > 0, in the units of the distances.

    Returns
    -------
        (n,) float64.

    Raises
    ------
        InputError: a negative distance, values that are not finite, a reach that is not above 0.
    """
    far, reach = reals(distances, "distances"), real(reach, "reach")
    at, beyond = real(at, "at"), real(beyond, "beyond")
    if not (far >= 0).all():
        raise InputError(f"distances: {far[~(far >= 0)][0]} at [{np.flatnonzero(~(far >= 0))[0]}] is no distance")
    if not (np.isfinite(at) and np.isfinite(beyond)):
        raise InputError(f"at and beyond must be finite, got {at} and {beyond}")
    if not (reach > 0 and np.isfinite(reach)):
        raise InputError(f"reach is {reach}, but must be positive and finite")
    share = np.minimum(far / reach, 1.0)
    ramp: _Floats = at + (beyond - at) * share * share * (3 - 2 * share)
    return ramp


def density_by_curvature(mesh: Mesh, range_: float = 16.0, contrast: float = 1.0) -> _Floats:
    """A density that is larger where the surface bends more.

    In proportion to the root mean square of the principal curvatures, 1 at its median, kept within a factor
    `sqrt(range_)` of that, then raised to `contrast`. A surface that does not bend has 1 everywhere.

    Returns
    -------
        (V,) float64, > 0; the same for any scale of the mesh.

    Raises
    ------
        InputError: a range below 1, a contrast that is not finite.
    """
    range_, contrast = real(range_, "range_"), real(contrast, "contrast")
    if not (range_ >= 1 and np.isfinite(range_)):
        raise InputError(f"range_ is {range_}, but must be at least 1 and finite")
    if not np.isfinite(contrast):
        raise InputError(f"contrast is {contrast}, but must be finite")
    smallest, largest, _ = principal_curvatures(mesh)
    bending = np.sqrt((smallest**2 + largest**2) / 2)
    # What rounding bends a flat surface by counts for nothing.
    floor = 1e-9 / np.sqrt(mesh.area)
    middle = max(float(np.median(bending)), floor)
    density: _Floats = np.clip(np.maximum(bending, floor) / middle, range_**-0.5, range_**0.5) ** contrast
    return density

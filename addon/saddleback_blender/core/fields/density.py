# SPDX-License-Identifier: GPL-3.0-or-later
"""Leads from what was painted to the density that the tessellation is given."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..results import Reals

REC_709 = np.array([0.2126, 0.7152, 0.0722])  # luminance of linear red, green and blue


class DensityError(ValueError):
    """The density cannot be used; the message completes a sentence that begins with the object's name."""


def channel(colors: NDArray[np.floating], name: str) -> Reals:
    """(n, 4) linear colors -> (n,) the channel LUMINANCE, R, G, B or A."""
    if name == "LUMINANCE":
        luminance: Reals = colors[:, :3].astype(np.float64) @ REC_709
        return luminance
    return colors[:, "RGBA".index(name)].astype(np.float64)


def average_to_vertices(
    values: NDArray[np.generic], vertices: NDArray[np.integer], vertex_count: int
) -> NDArray[np.float64]:
    """Mean, at each vertex, of the values whose `vertices` entry it is; 0 where there is none.

    `values` (m,) or (m, c) and `vertices` (m,) -> (vertex_count,) or (vertex_count, c). O(m c).
    """
    times = np.bincount(vertices, minlength=vertex_count)
    times[times == 0] = 1
    columns = values if values.ndim == 2 else values[:, None]
    means = np.empty((vertex_count, columns.shape[1]))
    for column in range(columns.shape[1]):
        means[:, column] = np.bincount(vertices, weights=columns[:, column], minlength=vertex_count) / times
    return means.reshape((vertex_count, *values.shape[1:]))


def shape(
    values: NDArray[np.floating], invert: bool, contrast: float, upper: float | None, smaller_by: float = 0.0
) -> Reals:
    """Painted values -> density: inverted within 0 to `upper`, then raised to the power `contrast`.

    `upper` is the most that can be painted (1 for weights, masks and colors), None to take the largest value there is.
    With `smaller_by` cells are so many times smaller, in length, where the most is painted, and the density is 1 where
    nothing is.
    Raises DensityError for values that are negative, not finite, or zero everywhere.
    """
    density = values.astype(np.float64)
    _check(density, "is")
    if invert:
        density = np.maximum((density.max(initial=0.0) if upper is None else upper) - density, 0.0)
        if not density.any():
            raise DensityError("is zero everywhere once inverted; paint less of it somewhere")
    with np.errstate(over="ignore"):
        density = density**contrast
    _check(density, "with this contrast is")
    if smaller_by > 0.0:
        most = float(density.max()) if upper is None else max(upper**contrast, float(density.max()))
        density = (1.0 + (smaller_by - 1.0) * density / most) ** 2
    return density


def _check(density: Reals, verb: str) -> None:
    bad = np.nonzero(~np.isfinite(density) | (density < 0))[0]
    if len(bad):
        raise DensityError(f"{verb} {density[bad[0]]:.6g} at vertex {bad[0]}; it must be finite and not negative")
    if not density.any():
        raise DensityError(f"{verb} zero everywhere; paint something first")

# SPDX-License-Identifier: GPL-3.0-or-later
"""Seen from above: what an image or a mesh covers of its plane, as a mask that an outline is made from."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import native
from ..results import Indices, Reals
from .shape_templates import Parts

PIXELS = 256  # along the longer side of what is drawn
MARGIN = 2  # empty pixels all around
MOST_CORNERS = 96
MOST_GRAY = 1 / 3  # of an image; a drawing has it along its lines, a photograph or a ramp everywhere
LEAST_AREA = 1e-6  # of the square of the longer side: what covers less stands upright


def parts_of_mask(mask: Reals) -> Parts:
    """The outlines (in pixels, y up, the first row's first pixel at the origin) of a mask, its first row above.

    Raises the library's InputError where there is nothing clear to see.
    """
    shape = native.load().Shape.from_mask(mask, max_corners=MOST_CORNERS, centered=False)
    return tuple(tuple(np.asarray(loop) for loop in part) for part in shape.parts)


def silhouette(vertices: Reals, triangles: Indices) -> Parts:
    """Outlines in the mesh's own units of all that triangles (t, 3) cover seen along z; never less than that."""
    places = vertices[:, :2]
    low = places[triangles.ravel()].min(axis=0)
    pixel = float(np.ptp(places[triangles.ravel()], axis=0).max()) / PIXELS
    a, b, c = (places[triangles[:, i]] for i in range(3))
    areas = np.abs((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]))
    if not areas.sum() > LEAST_AREA * (PIXELS * pixel) ** 2:
        raise native.load().InputError("seen from above it covers nothing")
    origin = low - MARGIN * pixel
    columns, rows = (np.ceil(np.ptp(places[triangles.ravel()], axis=0) / pixel).astype(int) + 2 * MARGIN + 1).tolist()
    mask = np.zeros((rows, columns))
    for triangle in places[triangles]:
        _draw(mask, (triangle - origin) / pixel)
    # Pixel (0, 0) of the mask is below; from_mask takes rows from top to bottom, with y up.
    parts = parts_of_mask(mask[::-1])
    shift = np.array([0.5, 0.5 + (rows - 1) * 1.0])
    return tuple(tuple((loop + shift) * pixel + origin for loop in part) for part in parts)


def _draw(mask: NDArray[np.float64], triangle: Reals) -> None:
    """Fills all pixels that a triangle (3, 2) comes to within half a pixel of.

    Pixel (i, j) is the square from (j, i) to (j + 1, i + 1). The half pixel is what outlines cut off at corners.
    """
    low = np.floor(triangle.min(axis=0)).astype(int) - 1
    high = np.floor(triangle.max(axis=0)).astype(int) + 2
    x, y = np.meshgrid(np.arange(low[0], high[0]) + 0.5, np.arange(low[1], high[1]) + 0.5)
    inside = np.ones(x.shape, bool)
    a, b, c = triangle
    if (b[0] - a[0]) * (c[1] - a[1]) < (b[1] - a[1]) * (c[0] - a[0]):
        b, c = c, b
    for begin, end in ((a, b), (b, c), (c, a)):
        across = np.array([begin[1] - end[1], end[0] - begin[0]])
        # A square twice as wide touches the half plane where its most inward corner does.
        inside &= (x - begin[0]) * across[0] + (y - begin[1]) * across[1] + np.abs(across).sum() >= 0
    part = mask[low[1] : high[1], low[0] : high[0]]
    part[inside[: part.shape[0], : part.shape[1]]] = 1.0


def parts_of_image(mask: Reals) -> Parts:
    """Outlines of an image's mask (rows, columns), the first row below, in its pixels from the lower left corner.

    Raises the library's InputError where there is nothing clear to see.
    """
    gray = grayness(mask)
    if gray > MOST_GRAY:
        raise native.load().InputError(
            f"image: no clear mask, {gray:.0%} of it is neither in nor out; give it transparency or more contrast"
        )
    rows, columns = mask.shape
    block = max(1, -(-max(rows, columns) // PIXELS))
    cut = mask[: rows // block * block, : columns // block * block]
    small = np.pad(cut.reshape(rows // block, block, columns // block, block).mean(axis=(1, 3)), MARGIN)
    # The outline's origin is the middle of the upper left pixel.
    corner = np.array([0.5 - MARGIN, len(small) - 0.5 - MARGIN])
    return tuple(tuple((loop + corner) * block for loop in part) for part in parts_of_mask(small[::-1]))


def whole_image(rows: int, columns: int) -> Parts:
    """The border of an image, in its pixels from the lower left corner."""
    return ((np.array([(0.0, 0.0), (columns, 0.0), (columns, rows), (0.0, rows)]),),)


def grayness(mask: Reals) -> float:
    """Share of an image that is neither in nor out."""
    return float(((mask > 0.25) & (mask < 0.75)).mean())

# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of a mesh's vertices, corners and faces at points of its surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..results import Indices, Reals


@dataclass(frozen=True)
class Anchors:
    """Holds where n points lie in a Blender mesh: in a triangle between three vertices, and in which polygon."""

    vertices: Indices  # (n, 3)
    corners: Indices  # (n, 3) of the polygon
    polygons: Indices  # (n,)
    weights: Reals  # (n, 3) barycentric

    def values(self, values: NDArray[Any], domain: str) -> NDArray[Any]:
        """Values of the domain POINT, CORNER or FACE, (m,) or (m, c) -> (n,) or (n, c) at the points.

        Real numbers are mixed by the weights; whole numbers and truths, which have nothing in between, are those of the
        nearest corner. A point has the value of the polygon that it lies in, whatever lies beyond its border.
        """
        if domain == "FACE":
            return values[self.polygons]
        around = values[self.vertices if domain == "POINT" else self.corners]
        if values.dtype.kind != "f":
            nearest: NDArray[Any] = around[np.arange(len(around)), self.weights.argmax(axis=1)]
            return nearest
        weights = self.weights.reshape(*self.weights.shape, *(1,) * (values.ndim - 1))
        mixed: NDArray[Any] = (around * weights).sum(axis=1).astype(values.dtype)
        return mixed

# SPDX-License-Identifier: MIT
"""Measures how well an arrangement follows the density that was painted."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from saddleback._arrays import integer, reals
from saddleback._saddleback import InputError, Mesh, Placements

_Floats = NDArray[np.float64]
_Indices = NDArray[np.int64]


class DensityMatch(NamedTuple):
    """Copies wanted and found in parts of the surface of equal area."""

    correlation: float  #: Pearson's, of the two by area; not a number where the density is the same everywhere
    wanted: _Floats  #: (cells,) shares of all copies, summing to their number
    found: _Indices  #: (cells,) copies whose centers lie there


def equal_areas(mesh: Mesh, cells: int) -> _Indices:
    """Parts of the surface of nearly equal area: a label for each face, by cutting across the longest side in turn.

    Returns
    -------
        (F,) int64, 0 to cells - 1.
    """
    areas, centers = mesh.face_areas, mesh.vertices[mesh.triangles].mean(axis=1)
    labels = np.zeros(len(areas), dtype=np.int64)
    parts = [(np.arange(len(areas)), 0, cells)]
    while parts:
        faces, first, count = parts.pop()
        labels[faces] = first
        if count == 1 or len(faces) < 2:
            continue
        axis = int(np.ptp(centers[faces], axis=0).argmax())
        faces = faces[np.argsort(centers[faces, axis], kind="stable")]
        sums = np.cumsum(areas[faces])
        half = count // 2
        cut = int(np.searchsorted(sums, sums[-1] * half / count, side="right"))
        cut = min(max(cut, 1), len(faces) - 1)
        parts += [(faces[:cut], first, half), (faces[cut:], first + half, count - half)]
    return labels


def density_match(mesh: Mesh, placements: Placements, density: ArrayLike, cells: int = 200) -> DensityMatch:
    """Compare how many copies lie where with the density that was asked for.

    Args:
        mesh: what they lie on.
        placements: of all the copies.
        density: (V,) wanted copies per area, >= 0; only ratios matter.
        cells: in how many parts the surface is divided.

    Raises
    ------
        InputError: density of the wrong length, negative, not finite or zero everywhere; fewer than two cells, or more
            than faces; placements on faces that the mesh does not have.

    Notes
    -----
        O(F log F log cells).
    """
    painted = reals(density, "density")
    if painted.shape != (len(mesh.vertices),):
        raise InputError(f"density: wanted {len(mesh.vertices)} values, got an array of shape {painted.shape}")
    if not (np.isfinite(painted) & (painted >= 0)).all() or not painted.any():
        raise InputError("density: values must be finite, not negative and not all zero")
    cells = integer(cells, "cells")
    if not 2 <= cells <= len(mesh.triangles):
        raise InputError(f"cells is {cells}, but must be 2 to the number of faces ({len(mesh.triangles)})")
    faces = placements.center.faces
    if len(faces) and faces.max() >= len(mesh.triangles):
        raise InputError(
            f"placements: the center of {faces.argmax()} lies in face {faces.max()}, the mesh has {len(mesh.triangles)}"
        )
    areas, labels = mesh.face_areas, equal_areas(mesh, cells)
    painted = painted / painted.max()  # sums of the largest numbers would be more than any
    shares = np.bincount(labels, areas * painted[mesh.triangles].mean(axis=1), minlength=cells)
    found = np.bincount(labels[faces], minlength=cells).astype(np.int64)
    wanted = np.asarray(shares * (len(placements) / shares.sum()), dtype=np.float64)
    # Faces cannot be divided: what is left of the difference between the cells' areas must not count, nor cells that
    # large faces have left without any.
    sizes = np.bincount(labels, areas, minlength=cells)
    there = sizes > 0
    thin, dense = wanted[there] / sizes[there], found[there] / sizes[there]
    spread = thin.std() * dense.std()
    product = float(((thin - thin.mean()) * (dense - dense.mean())).mean())
    is_even = thin.std() <= 1e-9 * thin.mean() or dense.std() == 0
    return DensityMatch(float("nan") if is_even else product / float(spread), wanted, found)

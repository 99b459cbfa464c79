# SPDX-License-Identifier: GPL-3.0-or-later
"""The dual of cells: a triangle mesh of their sites, and how good its triangles are."""

from __future__ import annotations

from typing import Any

import numpy as np

from .. import native
from ..progress import Progress
from ..results import Dual, Figures, Indices


def dual_of(cells: Any, policy: str, threads: int, progress: Progress) -> Dual:
    """The library's dual mesh of its cells, by REPAIR or STRICT, without triangles that no mesh can hold.

    Raises the library's InputError where the cells cannot be repaired, and its Cancelled.
    """
    with progress.stage(0.99, "joining the sites") as job:
        mesh = cells.dual(policy=policy.lower(), threads=threads, job=job)
    return Dual(
        vertices=mesh.vertices,
        triangles=_simple(mesh.triangles),
        faces=mesh.sites.faces,
        barycentric=mesh.sites.barycentric,
        added=int(mesh.added),
        issues=tuple(str(issue) for issue in mesh.issues),
    )


def figures_of(dual: Dual, energy: float | None) -> Figures | None:
    """Returns what is told of a run; None where there is no triangle."""
    if not len(dual.triangles):
        return None
    quality = native.load().triangle_quality(dual.vertices, dual.triangles)
    return Figures(float(quality.mean_quality), float(quality.mean_angle), float(quality.irregular), energy)


def _simple(triangles: Indices) -> Indices:
    """Each triangle once, and only those with three different corners: others are no faces of a mesh."""
    a, b, c = triangles.T
    whole = np.flatnonzero((a != b) & (b != c) & (c != a))
    _, first = np.unique(np.sort(triangles[whole], axis=1), axis=0, return_index=True)
    kept: Indices = triangles[whole[np.sort(first)]]
    return kept

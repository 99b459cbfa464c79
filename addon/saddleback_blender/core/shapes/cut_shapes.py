# SPDX-License-Identifier: GPL-3.0-or-later
"""The surface with the outlines of its shapes cut in."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..progress import Progress
from ..results import CutShapes, Indices, Reals
from .shape_templates import ShapeTemplate, uv_of_classes


def cut_shapes(mesh: Any, mapped: Any, templates: Sequence[ShapeTemplate], progress: Progress) -> CutShapes:
    """The whole surface as triangles that know their shape, and where in it their corners are."""
    with progress.stage(0.96, "cutting outlines into the surface") as job:
        cut = mapped.cut(job=job)
    triangles, copy = np.asarray(cut.triangles), np.asarray(cut.triangle_shape)
    corner_faces = np.repeat(np.asarray(cut.triangle_face), 3)
    shape = np.where(copy >= 0, np.asarray(mapped.placements.shape)[copy], -1).astype(np.int32)
    classes, places = np.repeat(shape, 3), np.asarray(cut.uv)[triangles.ravel()]
    uv = np.where(classes[:, None] >= 0, uv_of_classes(templates, classes, places), 0.0)
    return CutShapes(
        vertices=np.asarray(cut.vertices),
        faces=cut.surface.faces,
        barycentric=cut.surface.barycentric,
        triangles=triangles,
        corner_faces=corner_faces,
        corner_barycentric=np.concatenate(
            [
                _weights(mesh, corner_faces[rows], np.asarray(cut.vertices)[triangles.ravel()[rows]])
                for rows in progress.blocks(len(corner_faces))
            ]
        ),
        copy=copy,
        shape=shape,
        uv=uv,
    )


def _weights(mesh: Any, faces: Indices, places: Reals) -> Reals:
    """(n, 3) barycentric coordinates of places (n, 3) in the planes of faces; none below 0."""
    a, b, c = (mesh.vertices[mesh.triangles[faces, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    sides = [np.cross(end - begin, places - begin) for begin, end in ((b, c), (c, a), (a, b))]
    areas = np.stack([np.einsum("ni,ni->n", side, normal) for side in sides], axis=1).clip(0.0)
    weights: Reals = areas / np.maximum(areas.sum(axis=1, keepdims=True), np.finfo(np.float64).tiny)
    return weights

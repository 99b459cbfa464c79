# SPDX-License-Identifier: GPL-3.0-or-later
"""Metrics by which round cells are, in space, stretched along a field, or small where the surface bends."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from . import native
from .cache import Cache
from .errors import BadInputError
from .field_runs import field_of
from .graphs import MESH_BYTES_PER_FACE, MESH_BYTES_PER_VERTEX
from .progress import Progress
from .requests import DirectionFieldRequest, Surface, TessellateRequest, digest
from .results import Reals

FULL_WEIGHT = 0.1  # of the normals where curvature is followed wholly, in parts of the root of the area


def measured(request: TessellateRequest, mesh: Any, progress: Progress, cache: Cache) -> tuple[Surface, Any]:
    """The surface and the library's mesh by whose lengths cells are found: those of space, or of a metric.

    Both have the same points, by triangle and weights. Raises BadInputError.
    """
    settings, surface = request.settings, request.surface
    if request.field is None and settings.follow_curvature == 0:
        return surface, mesh
    if request.field is not None and settings.follow_curvature > 0:
        raise BadInputError(
            f"'{surface.name}': cells are stretched along the field or follow curvature, not both; set Stretch to 1, "
            "or Follow Curvature to 0"
        )
    if request.field is None:
        name, lengths = f"bent {settings.follow_curvature}", partial(_bent, mesh, settings.follow_curvature)
    else:
        vectors = _vectors(request.field, mesh, progress, cache)
        name, lengths = digest(vectors, settings.stretch), partial(_stretched, mesh, vectors, settings.stretch)

    def build() -> Any:
        return native.load().Mesh(mesh.vertices, mesh.triangles, lengths=lengths())

    found = replace(surface, metric=f"-{name}")
    size = (24 + MESH_BYTES_PER_VERTEX) * len(surface.vertices) + (12 + MESH_BYTES_PER_FACE) * len(surface.triangles)
    return found, cache.get(("mesh", found.key), build, lambda _: size)


def _bent(mesh: Any, share: float) -> Any:
    return native.load().curvature_metric(mesh, FULL_WEIGHT * share)


def _stretched(mesh: Any, vectors: Reals, stretch: float) -> Any:
    return native.load().anisotropic_metric(mesh, vectors, stretch)


def _vectors(request: DirectionFieldRequest, mesh: Any, progress: Progress, cache: Cache) -> Reals:
    field = field_of(request, mesh, progress, cache).field
    if field.symmetry == 4:
        raise BadInputError(
            f"'{request.surface.name}': its direction field has crosses, along which of two lines shall cells be long? "
            "Choose Vectors or Lines as its Kind, or set Stretch to 1"
        )
    return np.asarray(field.vectors)

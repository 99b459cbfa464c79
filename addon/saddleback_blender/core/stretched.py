# SPDX-License-Identifier: GPL-3.0-or-later
"""The metric by which round cells are, in space, stretched along a field."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from . import native
from .cache import Cache
from .errors import BadInputError
from .field_runs import field_of
from .graphs import MESH_BYTES_PER_FACE, MESH_BYTES_PER_VERTEX
from .progress import Progress
from .requests import Surface, TessellateRequest, digest


def stretched(request: TessellateRequest, mesh: Any, progress: Progress, cache: Cache) -> tuple[Surface, Any]:
    """The surface and the library's mesh by whose lengths cells are found: other ones where cells are stretched.

    Both have the same points, by triangle and weights. Raises BadInputError.
    """
    settings, surface = request.settings, request.surface
    if request.field is None:
        return surface, mesh
    if settings.hold_sharp or settings.hold_boundary or request.marked_edges is not None:
        raise BadInputError(
            f"'{surface.name}': stretched cells cannot be kept on lines, nor mirrored; set Stretch to 1, or switch "
            "Keep and X Mirror off"
        )
    field = field_of(request.field, mesh, progress, cache).field
    if field.symmetry == 4:
        raise BadInputError(
            f"'{surface.name}': its direction field has crosses, along which of two lines shall cells be long? Choose "
            "Vectors or Lines as its Kind, or set Stretch to 1"
        )
    vectors = np.asarray(field.vectors)

    def build() -> Any:
        lengths = native.load().anisotropic_metric(mesh, vectors, settings.stretch)
        return native.load().Mesh(mesh.vertices, mesh.triangles, lengths=lengths)

    measured = replace(surface, metric=f"-{digest(vectors, settings.stretch)}")
    size = (24 + MESH_BYTES_PER_VERTEX) * len(surface.vertices) + (12 + MESH_BYTES_PER_FACE) * len(surface.triangles)
    return measured, cache.get(("mesh", measured.key), build, lambda _: size)

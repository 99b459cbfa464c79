# SPDX-License-Identifier: GPL-3.0-or-later
"""Barriers of an object: edges that no distance, path or cell crosses, and faces that are left out."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ... import compat
from ...core.errors import BadInputError
from ...core.results import Indices
from ...core.settings import BarrierSettings
from ...core.surfaces.parts import NO_EDGES
from .density import NUMBER_TYPES, no_attribute

OTHERS = "choose other barriers"
MARKS = {"SEAMS": ("use_seam", "marked as a seam"), "SHARP": ("use_edge_sharp", "marked sharp")}


def read_barriers(
    source: bpy.types.Object, mesh: bpy.types.Mesh, settings: BarrierSettings
) -> tuple[Indices, NDArray[np.bool_] | None]:
    """(n, 2) vertices of the edges, and (polygons,) which are left out or None. Raises BadInputError."""
    if settings.barriers == "NONE":
        return NO_EDGES, None
    if settings.barriers in MARKS:
        element, label = MARKS[settings.barriers]
        marked = np.empty(len(mesh.edges), np.bool_)
        mesh.edges.foreach_get(element, marked)
        return _edges(source, mesh, marked, label), None
    name = settings.barriers_name
    attribute = mesh.attributes.get(name) if name else None
    if attribute is None:
        raise BadInputError(
            f"{no_attribute(source, name, 'barriers')}; select edges or faces in Edit Mode and press Take "
            f"Selection, or {OTHERS}"
        )
    if attribute.domain not in ("EDGE", "FACE") or attribute.data_type not in NUMBER_TYPES:
        raise BadInputError(
            f"'{source.name}': barriers are numbers of edges or faces, and the attribute '{name}' is none; {OTHERS}"
        )
    kind, dtype = NUMBER_TYPES[attribute.data_type]
    values: NDArray[np.generic] = np.zeros(len(attribute.data), dtype)
    attribute.data.foreach_get(kind, values)
    marked = values.astype(np.float64) > 0.5
    if attribute.domain == "EDGE":
        return _edges(source, mesh, marked, f"above one half in the attribute '{name}'"), None
    if not marked.any():
        raise BadInputError(f"'{source.name}' has no face above one half in the attribute '{name}'; {OTHERS}")
    return NO_EDGES, marked


def _edges(source: bpy.types.Object, mesh: bpy.types.Mesh, marked: NDArray[np.bool_], label: str) -> Indices:
    if not marked.any():
        raise BadInputError(f"'{source.name}' has no edge that is {label}; mark some, or {OTHERS}")
    return compat.read_edge_vertices(mesh)[marked]

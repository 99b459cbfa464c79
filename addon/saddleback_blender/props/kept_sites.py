# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the centers of the cells are that were made last: kept on the object, for what is made of these cells later."""

from __future__ import annotations

import base64

import bpy
import numpy as np

from .. import rollback
from ..bridge.inputs.mesh_in import scaled, unscaled
from ..core.results import Reals

SITES = "sites"  # on the settings of Tessellate: places in the object's own space, as text
MOST_KEPT = 100_000  # a file need not carry more: what needs them makes them anew


def keep_sites(source: bpy.types.Object, places: Reals, frame: tuple[str, str]) -> None:
    """Keeps places (n, 3) of the surface, and what they were found by."""
    group = source.saddleback.tessellate
    own = unscaled(source, places) if len(places) <= MOST_KEPT else places[:0]
    text = " ".join((*frame, base64.b64encode(np.ascontiguousarray(own, "<f8").tobytes()).decode("ascii")))
    rollback.remember_setting(group, SITES)
    setattr(group, SITES, text)


def kept_sites(source: bpy.types.Object) -> Reals | None:
    """Places (n, 3) on the surface of the centers of the last cells; None where they are not known."""
    kept = kept_cells(source)
    return None if kept is None else kept[1]


def kept_cells(source: bpy.types.Object) -> tuple[tuple[str, str], Reals] | None:
    """What they were found by, and the places."""
    group = source.saddleback.tessellate
    if not group.is_property_set(SITES) or not getattr(group, SITES):
        return None
    surface, frame, text = getattr(group, SITES).split(" ")
    own = np.frombuffer(base64.b64decode(text), "<f8").reshape(-1, 3)
    return ((surface, frame), scaled(source, own)) if len(own) else None

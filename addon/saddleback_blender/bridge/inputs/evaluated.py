# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects as Blender shows them, those among them that it does not evaluate."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import bpy
import numpy as np

from ...core.results import Reals


@contextmanager
def evaluated(context: bpy.types.Context, items: Sequence[bpy.types.Object]) -> Iterator[list[bpy.types.Object]]:
    """The objects, in their order, as modifiers, parents and constraints leave them, to be read inside the `with`.

    Blender evaluates only what the view layer shows: an object of an excluded collection has neither modifiers nor a
    place that is up to date. A copy of such an object is shown for as long as it is read.
    """
    copies = {item: item.copy() for item in items if not item.visible_get(view_layer=context.view_layer)}
    try:
        for copy in copies.values():
            copy.hide_viewport = False
            context.scene.collection.objects.link(copy)
        depsgraph = context.evaluated_depsgraph_get()
        yield [copies.get(item, item).evaluated_get(depsgraph) for item in items]
    finally:
        for copy in copies.values():
            bpy.data.objects.remove(copy)


def places_of(context: bpy.types.Context, items: Sequence[bpy.types.Object]) -> Reals:
    """(n, 3) the objects' origins in the world."""
    with evaluated(context, items) as shown:
        return np.array([item.matrix_world.translation[:] for item in shown], np.float64).reshape(-1, 3)

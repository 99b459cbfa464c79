# SPDX-License-Identifier: GPL-3.0-or-later
"""Lets outputs stand still while what they follow is only painted.

To Blender paint belongs to the mesh, as places do: with each dab all that follows the mesh would be evaluated and drawn
anew, though nothing of it moves. So the modifiers of outputs that stand where they were put let go of the mesh, and the
outputs keep its object as a custom property, which a duplicate and its outputs have of their own.
"""

from __future__ import annotations

from collections.abc import Callable

import bpy
import numpy as np
from numpy.typing import NDArray

from ... import compat
from ...follow_nodes import CORNER_ATTRIBUTES, HOST, KEEPER, REST_ATTRIBUTES, WEIGHTS_ATTRIBUTE
from ...nodes import FOLLOW, modifier_of

STANDS = "saddleback_stands"  # on outputs: whom they follow again as soon as it may move
STILL_MODES = {"OBJECT", "WEIGHT_PAINT", "VERTEX_PAINT", "TEXTURE_PAINT"}
DEFORMED_BY_PARENT = {"ARMATURE", "LATTICE"}
SAME_PLACE = 1e-5  # of the mesh's extent


def may_move(source: bpy.types.Object) -> bool:
    """Tells whether the surface may be elsewhere than the mesh's vertices are, or they are being moved."""
    is_deformed = len(source.modifiers) or source.data.shape_keys is not None
    return bool(is_deformed or source.parent_type in DEFORMED_BY_PARENT or source.mode not in STILL_MODES)


def let_stand(source: bpy.types.Object, places: NDArray[np.float32]) -> None:
    """Lets stand what follows the source, whose vertices are at `places` (V, 3) now, and was put for just these."""
    for item in bpy.data.objects:
        modifier = modifier_of(item, FOLLOW) if item.library is None and item.override_library is None else None
        if modifier is not None and compat.modifier_input(modifier, HOST) == source:
            keeper = compat.modifier_input(modifier, KEEPER)
            if _is_put_for((item if keeper is None else keeper).data, places):
                item[STANDS] = source
                compat.set_modifier_input(modifier, HOST, None)


def follow_again(chosen: Callable[[bpy.types.Object], bool] = lambda _host: True) -> None:
    """Lets follow again what stands: all of it, or what stands on chosen objects."""
    for item in [item for item in bpy.data.objects if STANDS in item]:
        modifier, host = modifier_of(item, FOLLOW), item[STANDS]
        if host is None or chosen(host):
            del item[STANDS]
            if modifier is not None and host is not None:
                compat.set_modifier_input(modifier, HOST, host)


def _is_put_for(mesh: bpy.types.ID, places: NDArray[np.float32]) -> bool:
    """Tells whether the points whose anchors a mesh has stand where they stood when they were put."""
    if not isinstance(mesh, bpy.types.Mesh) or not len(mesh.vertices):
        return False
    found = [mesh.attributes.get(name) for name in (*CORNER_ATTRIBUTES, WEIGHTS_ATTRIBUTE, REST_ATTRIBUTES[0])]
    count = len(mesh.vertices)
    if any(attribute is None or len(attribute.data) != count for attribute in found):
        return False
    *corners, weights, rest = found
    now = np.zeros((count, 3))
    shares = compat.read_floats(weights.data, "vector", 3)
    for i, attribute in enumerate(corners):
        numbers = np.empty(count, np.int32)
        attribute.data.foreach_get("value", compat.as_copied(numbers))
        if not 0 <= numbers.min() <= numbers.max() < len(places):
            return False
        now += shares[:, i, None] * places[numbers]
    return bool(np.abs(now - compat.read_floats(rest.data, "vector", 3)).max() <= SAME_PLACE * np.ptp(places))

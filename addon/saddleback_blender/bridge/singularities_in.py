"""Empties -> the places about which a field turns, and how often."""

from __future__ import annotations

import bpy
import numpy as np

from ..core.errors import BadInputError
from ..core.requests import SingularPlace
from ..core.settings import DirectionFieldSettings
from ..core.singular_names import as_index, index_of_name

INDEX = "index"  # custom property of an empty: a number, or a text like "-1/2"


def read_singularities(source: bpy.types.Object, settings: DirectionFieldSettings) -> tuple[SingularPlace, ...] | None:
    """The empties of a collection or, without one, those parented to the object; None where the field chooses."""
    if settings.singularities == "AUTO":
        return None
    name = settings.singularities_collection
    if name:
        group = bpy.data.collections.get(name)
        if group is None:
            raise BadInputError(f"'{source.name}': there is no collection '{name}' to take empties from; choose one")
        candidates, where = list(group.all_objects), f"in collection '{name}'"
    else:
        candidates, where = list(source.children), f"parented to '{source.name}'"
    empties = sorted((item for item in candidates if item.type == "EMPTY"), key=lambda item: item.name)
    if not empties:
        raise BadInputError(f"'{source.name}': no empty is {where}; add one at each place that the field turns about")
    return tuple(_singular_place(source, item) for item in empties)


def _singular_place(source: bpy.types.Object, item: bpy.types.Object) -> SingularPlace:
    place = np.array(item.matrix_world.translation[:], np.float64)
    if INDEX not in item:
        return SingularPlace(place, index_of_name(item.name), item.name)
    index = as_index(item[INDEX])
    if index is None:
        raise BadInputError(
            f"'{source.name}': the index of '{item.name}' is {item[INDEX]!r}; write a number such as 1 or -1/2"
        )
    return SingularPlace(place, index, item.name)

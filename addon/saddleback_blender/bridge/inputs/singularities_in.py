# SPDX-License-Identifier: GPL-3.0-or-later
"""Empties -> the places about which a field turns, and how often."""

from __future__ import annotations

import bpy

from ...blocks import find
from ...core.errors import BadInputError
from ...core.fields.singular_names import as_index, index_of_name
from ...core.requests import SingularPlace
from ...core.results import Reals
from ...core.settings import DirectionFieldSettings
from .evaluated import places_of
from .mesh_in import seen_by

INDEX = "index"  # custom property of an empty: a number, or a text like "-1/2"


def read_singularities(
    context: bpy.types.Context, source: bpy.types.Object, settings: DirectionFieldSettings
) -> tuple[SingularPlace, ...] | None:
    """The empties of a collection or, without one, those parented to the object; None where the field chooses."""
    if settings.singularities == "AUTO":
        return None
    name = settings.singularities_collection
    if name:
        group = find(bpy.data.collections, name)
        if group is None:
            raise BadInputError(f"'{source.name}': there is no collection '{name}' to take empties from; choose one")
        candidates, where = list(group.all_objects), f"in collection '{name}'"
    else:
        candidates, where = list(source.children), f"parented to '{source.name}'"
    empties = sorted((item for item in candidates if item.type == "EMPTY"), key=lambda item: item.name_full)
    if not empties:
        raise BadInputError(f"'{source.name}': no empty is {where}; add one at each place that the field turns about")
    places = seen_by(source, places_of(context, empties))
    return tuple(_singular_place(source, item, place) for item, place in zip(empties, places, strict=True))


def _singular_place(source: bpy.types.Object, item: bpy.types.Object, place: Reals) -> SingularPlace:
    if INDEX not in item:
        return SingularPlace(place, index_of_name(item.name), item.name)
    index = as_index(item[INDEX])
    if index is None:
        raise BadInputError(
            f"'{source.name}': the index of '{item.name}' is {item[INDEX]!r}; write a number such as 1 or -1/2"
        )
    return SingularPlace(place, index, item.name)

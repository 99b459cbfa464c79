# SPDX-License-Identifier: GPL-3.0-or-later
"""Which data-blocks the runs of a layer read, by kind and name: references die with Undo."""

from __future__ import annotations

from typing import Any

import bpy

from ..bridge.tokens import SOURCE
from ..props import COLLECTION_NAMES, IMAGE_NAMES, LAYER_KINDS, OBJECT_NAMES, existing_group


def name_of_input(block: bpy.types.ID) -> tuple[str, str]:
    """Kind and name."""
    return type(block).__name__, str(block.name_full)


def inputs_of(source: bpy.types.Object) -> set[tuple[str, str]]:
    """The object, its mesh, and what its settings point to: objects, their data, those in collections, images."""
    found: list[Any] = [source]
    groups = [group for kind in LAYER_KINDS for group in [existing_group(source, kind)] if group is not None]
    for group in groups:
        blocks = [getattr(group, name, None) for name in (*OBJECT_NAMES, *COLLECTION_NAMES, *IMAGE_NAMES)]
        for block in blocks:
            found.append(block)
            if isinstance(block, bpy.types.Collection):
                found += block.all_objects
        if {"CURSOR", "CURSOR_PARTS"} & {getattr(group, "sources", ""), getattr(group, "points", "")}:
            found += [scene for scene in bpy.data.scenes if scene.user_of_id(source)]
    found += [item for item in source.children if SOURCE not in item]
    found += [item.data for item in found if isinstance(item, bpy.types.Object)]
    return {name_of_input(block) for block in found if block is not None}


def goes_along(source: bpy.types.Object, inputs: set[tuple[str, str]]) -> bool:
    """Tells whether all that is read goes along with the object where it is moved: no base that stands, no annotation,
    no other object.
    """
    groups = [group for kind in LAYER_KINDS for group in [existing_group(source, kind)] if group is not None]
    is_bound = any(
        getattr(group, "make_shell", False) or getattr(group, "strokes", "") == "ANNOTATIONS" for group in groups
    )
    return not is_bound and inputs <= {name_of_input(source), name_of_input(source.data)}


def is_child(block: bpy.types.ID, name: str) -> bool:
    """Tells whether it is an object that was parented to the one of this name, as an empty to measure from."""
    is_object = isinstance(block, bpy.types.Object) and SOURCE not in block
    return is_object and block.parent is not None and block.parent.name == name

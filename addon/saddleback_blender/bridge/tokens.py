# SPDX-License-Identifier: GPL-3.0-or-later
"""Lets an output know its source: by a token, a random word that both keep, so that both may be renamed and saved;
and the layer of the source that it belongs to, by a word of the layer's, "" of the first.
"""

from __future__ import annotations

import uuid

import bpy

from .. import rollback

TOKEN = "saddleback_token"  # on a source
SOURCE = "saddleback_source"  # on outputs: the token of their source
ROLE = "saddleback_role"  # on outputs: what it shows
NAME = "saddleback_name"  # on outputs: the name that we gave it
PLACE = "saddleback_place"  # on outputs: the matrix that we gave it
LOCAL = "saddleback_local"  # on outputs: the matrix that we gave it, as seen from the source
MARKS = "saddleback_marks"  # on outputs: where some vertices of the source were then, in its own space
OWN_MARKS = "saddleback_own_marks"  # on outputs: where some of their own points were then
MATERIALS = "saddleback_materials"  # on outputs: the names of the materials that we gave it, one a line
LAYER = "saddleback_layer"  # on outputs: the word of their layer; none on those of the first
# On a source that overrides one of another file, where Blender keeps registered properties only.
OVERRIDE_TOKEN = "saddleback_override_token"


def token_of(item: bpy.types.Object) -> str:
    """The object's token, "" where it has none. An override shows its original's, too, until it has its own."""
    return str(getattr(item, OVERRIDE_TOKEN, "") or item.get(TOKEN, ""))


def layer_of(source: bpy.types.Object) -> str:
    """The word of the source's active layer, which runs are made in."""
    return str(source.saddleback.layer_word) if source.is_property_set("saddleback") else ""


def source_token(source: bpy.types.Object) -> str:
    """The source's token; a new one for a new source, and for a duplicate of a source."""
    token = token_of(source)
    if token and owns(source, token):
        return token
    token = uuid.uuid4().hex
    if source.override_library is None:
        rollback.remember_keys(source, TOKEN)
        source[TOKEN] = token
    else:
        rollback.remember(source, OVERRIDE_TOKEN)
        setattr(source, OVERRIDE_TOKEN, token)
    return token


def forget_token(source: bpy.types.Object) -> None:
    """The object is no source any more."""
    rollback.remember_keys(source, TOKEN)
    if TOKEN in source:
        del source[TOKEN]
    if getattr(source, OVERRIDE_TOKEN, ""):
        rollback.remember(source, OVERRIDE_TOKEN)
        setattr(source, OVERRIDE_TOKEN, "")


def owns(source: bpy.types.Object, token: str) -> bool:
    """False for a duplicate, whose token's outputs are children of another object that has the token too."""
    twins = [item for item in bpy.data.objects if token_of(item) == token and item != source]
    if not twins:
        return True
    parents = [item.parent for item in bpy.data.objects if item.get(SOURCE) == token]
    return source in parents or not any(twin in parents for twin in twins)

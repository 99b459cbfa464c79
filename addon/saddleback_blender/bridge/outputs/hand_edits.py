# SPDX-License-Identifier: GPL-3.0-or-later
"""Notices what an artist changed in an output by hand, so that no run takes it away.

A run writes on each output what its data were. Where they are others by the next run, the edited ones stay, in an
ordinary object.
"""

from __future__ import annotations

import hashlib

import bpy
import numpy as np

from ... import compat, rollback
from ...nodes import FOLLOW, modifier_of
from ..tokens import LAYER, LOCAL, MARKS, MATERIALS, NAME, OWN_MARKS, PLACE, ROLE, SOURCE
from .out_attributes import recorded

CONTENT = "saddleback_content"  # on outputs: a hash of the data that we gave it
LAYERS = "saddleback_layers"  # on outputs: the names of the layers that it had then, one a line
SHADING = "saddleback_shading"  # on outputs: how its faces were drawn then
CHOSEN = "saddleback_chosen_shading"  # on outputs: how an artist wants them to be drawn
# Attributes that Blender makes by itself, or of what it kept otherwise in other versions.
OF_BLENDER = {
    "position", "material_index", "sharp_face", "sharp_edge", "crease_vert", "crease_edge", "bevel_weight_vert",
    "bevel_weight_edge", "custom_normal", "uv_seam", "id",
}  # fmt: skip
COLOR_STEPS = 1023  # of color channels, which Blender's versions may tell with another last digit

_kept: list[str] = []  # sentences on what was kept


def stamp(items: list[bpy.types.Object]) -> None:
    """Writes on outputs that are new what their data are."""
    for item in items:
        if CONTENT not in item:
            rollback.remember_keys(item, SHADING)
            compat.set_shading(item.data, str(item.get(CHOSEN, "")))
            item[SHADING] = compat.shading(item.data)
            _note(item)


def is_edited(item: bpy.types.Object) -> bool:
    """Tells whether an output's data are others than we gave it, or have more layers."""
    return CONTENT in item and (item[CONTENT] != _content(item) or _has_more(item))


def accept(item: bpy.types.Object) -> None:
    """Takes what was edited as ours: a run has read it, and goes on from it."""
    if is_edited(item):
        _note(item)


def _note(item: bpy.types.Object) -> None:
    rollback.remember_keys(item, CONTENT, LAYERS)
    item[CONTENT], item[LAYERS] = _content(item), "\n".join(sorted(_layers(item)))


def keep_shading(item: bpy.types.Object) -> None:
    """Notes how an artist wants the faces of an output to be drawn, where that is not as we gave it."""
    shading = compat.shading(item.data)
    if shading and shading != item.get(SHADING, shading):
        rollback.remember_keys(item, CHOSEN)
        item[CHOSEN] = shading


def keep_data(item: bpy.types.Object) -> None:
    """Makes an ordinary object, hidden, of an output that is about to get other data, if it was edited."""
    if not is_edited(item):
        return
    kept = item.copy()
    kept.name = f"{item.name} Edited"
    for collection in item.users_collection:
        collection.objects.link(kept)
    make_ordinary(kept)
    following = modifier_of(kept, FOLLOW)
    if following is not None and kept.type == "CURVE":  # what its points stand on goes with the output
        compat.remove_modifier(kept, following)
    kept.hide_viewport = kept.hide_render = True
    _kept.append(f"'{item.name}' was edited by hand: it stays as '{kept.name}', hidden")


def keep_object(item: bpy.types.Object) -> None:
    """Makes an output that was edited an ordinary object, in place of removing it."""
    make_ordinary(item)
    _kept.append(f"'{item.name}' was edited by hand and stays, as an object of its own")


def make_ordinary(item: bpy.types.Object) -> None:
    """Takes off an output all that makes it one."""
    keys = (ROLE, NAME, PLACE, LOCAL, MARKS, OWN_MARKS, MATERIALS, CONTENT, LAYERS, SHADING, CHOSEN, SOURCE, LAYER)
    rollback.remember_keys(item, *keys)
    for key in keys:
        if key in item:
            del item[key]


def notes() -> list[str]:
    """Says what was kept since it was asked last."""
    told = list(_kept)
    _kept.clear()
    return told


def _has_more(item: bpy.types.Object) -> bool:
    """Tells whether data got attributes, maps or shape keys, or faces that show a material which was added."""
    if LAYERS in item and not _layers(item) <= set(str(item[LAYERS]).split("\n")):
        return True
    if item.type != "MESH" or not len(item.data.polygons):
        return False
    given = len(str(item.get(MATERIALS, "")).split("\n"))
    numbers = compat.read_numbers(item.data.polygons, "material_index")
    return len(item.data.materials) > given and int(numbers.max()) >= given


def _layers(item: bpy.types.Object) -> set[str]:
    """The names of an output's attributes, maps and shape keys, but for Blender's own and what runs wrote there."""
    keys = item.data.shape_keys
    names = set() if keys is None else {f"key {key.name}" for key in keys.key_blocks}
    if item.type == "MESH":
        there = {layer.name for layers in (item.data.attributes, item.data.uv_layers) for layer in layers}
        names |= {name for name in there if not name.startswith(".") or name == ".sculpt_mask"}
        names -= OF_BLENDER | set(recorded(item.data))
    return names


def _content(item: bpy.types.Object) -> str:
    if item.mode == "EDIT":
        item.update_from_editmode()
    digest = hashlib.blake2b(f"{len(item.vertex_groups)}".encode(), digest_size=12)
    if isinstance(item.data, bpy.types.Curve):
        for spline in item.data.splines:
            points = spline.bezier_points if spline.type == "BEZIER" else spline.points
            digest.update(f"{spline.type}{spline.use_cyclic_u}".encode())
            digest.update(compat.read_floats(points, "co", 3 if spline.type == "BEZIER" else 4).data)
        return digest.hexdigest()
    mesh = item.data
    digest.update(f"{len(mesh.vertices)} {len(mesh.edges)} {len(mesh.polygons)}".encode())
    digest.update(compat.read_positions(mesh).data)
    digest.update(compat.read_corner_vertices(mesh).data)
    for layer in mesh.color_attributes:
        colors = compat.read_floats(layer.data, "color", 4)
        digest.update((colors * COLOR_STEPS).astype(np.int32).data)
    return digest.hexdigest()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Output objects: where they go, how they are found again, and how they all go away.

An output knows its source by a token, a random word kept on both as a custom property, so that both may be renamed,
saved and reopened; and by being its child, which tells a source from its duplicate (a duplicate has the same token, but
not the same children). An artist's duplicate of an output is the artist's: the name tells it from ours. No pointer is
kept, since a pointer in a custom property would keep a deleted object in the file.
"""

from __future__ import annotations

import re
from contextlib import suppress
from functools import partial

import bpy
import numpy as np
from mathutils import Matrix

from ... import nodes, rollback
from ...blocks import is_editable
from ...follow_nodes import follows
from ..tokens import (
    LAYER,
    LOCAL,
    MARKS,
    MATERIALS,
    NAME,
    OWN_MARKS,
    PLACE,
    ROLE,
    SOURCE,
    forget_token,
    layer_of,
    owns,
    source_token,
    token_of,
)
from .hand_edits import CONTENT, is_edited, keep_data, keep_object, keep_shading, make_ordinary
from .out_attributes import clear_attributes, forget_layer_names
from .rest_places import forget_rest
from .standing import follow_again

COLLECTION = "saddleback_outputs"  # on our collections

UNWANTED = "saddleback_unwanted"  # on outputs that a person no longer wants: whether they were hidden before
FORMER = "Saddleback Former"  # the name of what goes away when all is written

COLLECTION_NAME = "Saddleback"
HAIR = 5e-4  # of the longest side of the mesh: what is enough for a surface to hide another one
# Of the role of an object that keeps where the points of a curve stand.
KEEPER_ENDING = " anchors"
# Of a curve: what an artist makes of our lines.
CURVE_SETTINGS = (
    "bevel_mode", "bevel_depth", "bevel_resolution", "bevel_object", "extrude", "offset", "taper_object",
    "use_fill_caps", "fill_mode", "twist_mode", "twist_smooth",
)  # fmt: skip
SURFACE_ROLE = "surface"  # of the copy that has the attributes of all layers


def output_collection(context: bpy.types.Context, source: bpy.types.Object) -> bpy.types.Collection:
    """The collection `Saddleback` beside the source: found by its mark, whatever its name is by now, or made."""
    scene = context.scene.collection
    homes = [home for home in _reachable(context) if source.name in home.objects and is_editable(home)]
    home = homes[0] if homes else scene
    if COLLECTION in home:  # the source is an output itself
        return home
    for child in home.children:
        if COLLECTION in child and is_editable(child):
            return child
    collection = bpy.data.collections.new(COLLECTION_NAME)
    collection[COLLECTION] = True
    home.children.link(collection)
    return collection


def replace_object(
    context: bpy.types.Context, source: bpy.types.Object, role: str, data: bpy.types.ID, place: Matrix | None = None
) -> bpy.types.Object:
    """Shows `data` as the source's output of this role: in the object that is there from the last run, or a new one.

    `place` is the world matrix that the data is made for, the source's own by default. What the artist did to the
    object stays: name, collection, modifiers, materials, and a move away from where we put it. An output that was made
    in another scene is shown in this one, too.
    """
    place = source.matrix_world.copy() if place is None else place
    item = find_output(source, role)
    if item is not None and item.type != _object_type(data):
        _remove_all([item])
        item = None
    if item is None:
        item = bpy.data.objects.new(
            " ".join(filter(None, (source.name, _layer_name(source, role), role.title()))), data
        )
        item[ROLE], item[NAME] = role, item.name
        item.color = _color_of(data)
        moved = Matrix.Identity(4)
        given = _names(data)
    else:
        rollback.remember(item, "matrix_basis", "matrix_parent_inverse", "parent_type", "parent", "data")
        rollback.remember_keys(item, MATERIALS, SOURCE, PLACE, LOCAL, MARKS, OWN_MARKS, CONTENT)
        keep_data(item)
        keep_shading(item)
        if CONTENT in item:
            del item[CONTENT]
        _show_again(item)
        moved = _artists_move(item, source)
        given = _names(data)
        _swap_data(item, data)
    item[MATERIALS] = "\n".join(given)
    if not any(home in item.users_collection for home in _reachable(context)):
        collection = output_collection(context, source)
        collection.objects.link(item)
        rollback.undo_with(partial(collection.objects.unlink, item))
    mark(item, source, role)
    item.parent, item.parent_type = source, "OBJECT"
    # Location, rotation and scale cannot hold a shear: the parent's inverse holds it.
    basis, inverse = Matrix.LocRotScale(*place.decompose()), source.matrix_world.inverted_safe()
    is_sheared = not _are_equal(basis, place)
    item.matrix_parent_inverse = inverse @ place @ basis.inverted_safe() if is_sheared else inverse
    item[PLACE] = [value for row in (basis if is_sheared else place) for value in row]
    item[LOCAL] = [value for row in inverse @ place for value in row]
    item[MARKS], item[OWN_MARKS] = (marks_of(one).ravel().tolist() for one in (source, item))
    item.matrix_basis = moved @ (basis if is_sheared else place)
    data.name = item.name
    return item


def _color_of(data: bpy.types.ID) -> tuple[float, ...]:
    """The first material's color: Solid view shows the object's where it shows attributes and there is none."""
    materials = [material for material in getattr(data, "materials", ()) if material is not None]
    return tuple(materials[0].diffuse_color) if materials else (1.0, 1.0, 1.0, 1.0)


def mark(item: bpy.types.Object, source: bpy.types.Object, role: str) -> None:
    """Says on an object whose it is, in the source's active layer, and what it shows."""
    item[ROLE], item[SOURCE] = role, source_token(source)
    layer = _layer_of_role(source, role)
    if layer:
        item[LAYER] = layer


def _layer_of_role(source: bpy.types.Object, role: str) -> str:
    return "" if role == SURFACE_ROLE else layer_of(source)


def _layer_name(source: bpy.types.Object, role: str) -> str:
    """What tells the names of outputs of other layers than the first from those."""
    word = _layer_of_role(source, role)
    return next((str(layer.name) for layer in source.saddleback.layers if layer.word == word), "") if word else ""


def _reachable(context: bpy.types.Context) -> list[bpy.types.Collection]:
    scene = context.scene.collection
    return [scene, *scene.children_recursive]


def hair(source: bpy.types.Object) -> float:
    """A distance in the world that is enough for something to be seen before the source's surface."""
    return HAIR * float(max(source.dimensions))


def outputs_of(source: bpy.types.Object, layer: str | None = None) -> list[bpy.types.Object]:
    """Returns what we made for the source, or in one layer, and still exists, one object for each role and layer."""
    every = [item for item in _all_of(source) if not str(item[ROLE]).endswith(KEEPER_ENDING)]
    return every if layer is None else [item for item in every if _is_in(item, layer)]


def _is_in(item: bpy.types.Object, layer: str) -> bool:
    """The copy of the surface is in no layer."""
    return bool(item[ROLE] != SURFACE_ROLE and item.get(LAYER, "") == layer)


def _all_of(source: bpy.types.Object) -> list[bpy.types.Object]:
    """Returns the outputs of all layers, and what keeps where points of theirs stand."""
    token = token_of(source)
    if not token or not owns(source, token):
        return []
    by_role: dict[tuple[str, str], list[bpy.types.Object]] = {}
    for item in bpy.data.objects:
        is_ours = item.get(SOURCE) == token and ROLE in item and item.library is None and item != source
        is_here = item.parent is None or item.parent == source or token_of(item.parent) != token
        if is_ours and is_here and not _is_duplicate(source, item):
            by_role.setdefault((str(item[ROLE]), str(item.get(LAYER, ""))), []).append(item)
    return [_original(source, candidates) for candidates in by_role.values()]


def find_output(source: bpy.types.Object, role: str) -> bpy.types.Object | None:
    """The source's output of a role in the active layer, None where there is none."""
    layer = _layer_of_role(source, role)
    return next((item for item in _all_of(source) if item[ROLE] == role and item.get(LAYER, "") == layer), None)


def remove_output(source: bpy.types.Object, role: str) -> bool:
    """Removes the output of one role, when its kind is no longer wanted; says whether there was one."""
    item, keeper = find_output(source, role), find_output(source, role + KEEPER_ENDING)
    if item is None:
        return False
    _remove_all([item] if keeper is None else [item, keeper])
    return True


def hide_output(source: bpy.types.Object, role: str) -> None:
    """Hides the output of one role, when a person no longer wants it; a run that makes it again shows it."""
    item = find_output(source, role)
    if item is not None and UNWANTED not in item:
        rollback.remember(item, "hide_viewport", "hide_render")
        rollback.remember_keys(item, UNWANTED)
        item[UNWANTED] = f"{int(item.hide_viewport)}{int(item.hide_render)}"
        item.hide_viewport = item.hide_render = True


def _show_again(item: bpy.types.Object) -> None:
    if UNWANTED in item:
        rollback.remember(item, "hide_viewport", "hide_render")
        rollback.remember_keys(item, UNWANTED)
        item.hide_viewport, item.hide_render = (state == "1" for state in str(item[UNWANTED]))
        del item[UNWANTED]


def clear_layer(context: bpy.types.Context, source: bpy.types.Object, layer: str, is_last: bool) -> int:
    """Removes what was made in one layer; with the last one goes what all have. Returns how many there were."""
    if is_last:
        return clear_outputs(context, source)
    follow_again(source.__eq__)
    items = outputs_of(source, layer)
    _remove_all([item for item in _all_of(source) if _is_in(item, layer)])
    rollback.when_written(nodes.remove_unused)
    surfaces = [source, *(item for item in outputs_of(source) if item[ROLE] == SURFACE_ROLE)]
    cleared = sum(clear_attributes(item, layer) for item in surfaces)
    rollback.when_written(context.view_layer.update)
    return len(items) + cleared


def clear_outputs(context: bpy.types.Context, source: bpy.types.Object) -> int:
    """Removes all that we made for the source and nothing else; returns how many objects and attributes went."""
    follow_again(source.__eq__)
    items = outputs_of(source)
    _remove_all(_all_of(source))
    rollback.when_written(nodes.remove_unused)
    cleared = clear_attributes(source)
    if not any(follows(item, source) for item in bpy.data.objects if ROLE not in item and not _is_going(item)):
        forget_rest(source)
    forget_token(source)
    rollback.when_written(context.view_layer.update)
    return len(items) + cleared


def free_layer(source: bpy.types.Object, layer: str) -> int:
    """Makes all that was made in a layer the artist's own; returns how many objects and attributes that are."""
    follow_again(source.__eq__)
    items, surface = outputs_of(source, layer), find_output(source, SURFACE_ROLE)
    for item in [item for item in _all_of(source) if _is_in(item, layer)]:
        make_ordinary(item)
    meshes = [item.data for item in (source, surface) if item is not None and is_editable(item.data)]
    return len(items) + sum(forget_layer_names(mesh, layer) for mesh in meshes)


def _remove_all(items: list[bpy.types.Object]) -> None:
    """Removes outputs and keepers; those that were edited by hand stay as the artist's own, with their keepers."""
    edited = {(item.get(LAYER), item[ROLE]) for item in items if is_edited(item)}
    collections = [collection for item in items for collection in item.users_collection]
    for item in items:
        if (item.get(LAYER), str(item[ROLE]).removesuffix(KEEPER_ENDING)) not in edited:
            remove_object(item)
        elif str(item[ROLE]).endswith(KEEPER_ENDING):
            make_ordinary(item)
        else:
            keep_object(item)
    rollback.when_written(partial(_remove_empty, collections))


def remove_object(item: bpy.types.Object) -> None:
    """Removes an object, and its data and node groups unless something else uses them, when all is written.

    Until then it is no output any more, and its name is free.
    """
    rollback.remember_keys(item, ROLE, SOURCE)
    for key in (ROLE, SOURCE):
        if key in item:
            del item[key]
    for block in (item, item.data) if item.data.users == 1 else (item,):
        rollback.remember_name(block)
        block.name = FORMER
    rollback.when_written(partial(_remove, item))


def _is_going(item: bpy.types.Object) -> bool:
    """Tells whether an object is removed when all is written."""
    return str(item.name).startswith(FORMER)


def _remove(item: bpy.types.Object) -> None:
    data, animation = item.data, item.animation_data
    action = animation.action if animation is not None else None
    groups = [modifier.node_group for modifier in item.modifiers if modifier.type == "NODES"]
    bpy.data.objects.remove(item)
    _remove_data(data)
    for group in groups:
        if group is not None and nodes.is_ours(group) and group.users == 0:
            bpy.data.node_groups.remove(group)
    if action is not None and action.users == 0:
        bpy.data.actions.remove(action)


def _original(source: bpy.types.Object, candidates: list[bpy.types.Object]) -> bpy.types.Object:
    """A child comes first: others may be of a duplicate of the source that was deleted."""
    return min(candidates, key=lambda item: (item.parent != source, item.name != item.get(NAME), item.name))


def _is_duplicate(source: bpy.types.Object, item: bpy.types.Object) -> bool:
    """Tells an artist's duplicate of an output by Blender's number behind the name that we gave the output, while the
    source is called as it was then: one that is a duplicate itself has outputs with numbers. So has one that was
    appended where another object has the name.
    """
    name = str(item.get(NAME, ""))
    other = bpy.data.objects.get(name)
    if other is not None and other.get(SOURCE) != item.get(SOURCE):
        return False
    return name.startswith(f"{source.name} ") and bool(re.fullmatch(re.escape(name) + r"\.\d{3,}", item.name))


def _object_type(data: bpy.types.ID) -> str:
    return "CURVE" if isinstance(data, bpy.types.Curve) else "MESH"


def _names(data: bpy.types.ID) -> list[str]:
    return [material.name if material is not None else "" for material in data.materials]


def _swap_data(item: bpy.types.Object, data: bpy.types.ID) -> None:
    """Gives the object new data; materials that the artist put in the place of ours, or added, stay, and so do custom
    properties and a curve's bevel.

    Slots are filled one by one: `materials.clear` would forget which faces show which.
    """
    old = item.data
    before = str(item.get(MATERIALS, "\n".join(_names(data))))  # older files have no list
    given = _counted(before.split("\n") if before else [])
    chosen = dict(zip(given, old.materials, strict=False))
    for slot, (name, number) in enumerate(_counted(_names(data))):
        material = chosen.get((name, number), chosen.get((name, 0), data.materials[slot]))
        data.materials[slot] = material
    for material in old.materials[len(given) :]:
        data.materials.append(material)
    _keep_settings(old, data)
    item.data = data
    if old.users == 0:
        rollback.remember_name(old)
        old.name = FORMER
    rollback.when_written(partial(_remove_data, old))


def _keep_settings(old: bpy.types.ID, data: bpy.types.ID) -> None:
    """Gives new data what is none of ours on the old: custom properties, and how thick a curve is."""
    for key, value in old.items():
        if not key.startswith("saddleback") and key not in data:
            data[key] = value.to_dict() if hasattr(value, "to_dict") else value
            with suppress(TypeError):  # of kinds that have no range
                data.id_properties_ui(key).update_from(old.id_properties_ui(key))
    for name in CURVE_SETTINGS if isinstance(data, bpy.types.Curve) else ():
        setattr(data, name, getattr(old, name))


def _counted(names: list[str]) -> list[tuple[str, int]]:
    """Each name and how often it came before."""
    return [(name, names[:i].count(name)) for i, name in enumerate(names)]


def _remove_data(data: bpy.types.ID) -> None:
    if data.users == 0:
        (bpy.data.curves if isinstance(data, bpy.types.Curve) else bpy.data.meshes).remove(data)


def _artists_move(item: bpy.types.Object, source: bpy.types.Object) -> Matrix:
    """Returns what the artist did to the place that we gave the object; exactly nothing where that is only rounding."""
    before = _noted(item, PLACE)
    if before is None or was_applied(item, source) or was_applied_itself(item):
        return Matrix.Identity(4)
    return Matrix.Identity(4) if _are_equal(item.matrix_basis, before) else item.matrix_basis @ before.inverted_safe()


def was_applied(item: bpy.types.Object, source: bpy.types.Object) -> bool:
    """Tells whether the source's transform was applied, or its origin set, since the output was made: its vertices are
    elsewhere in its space, and at the same places as seen from the output, which Blender leaves where it is.
    """
    local, noted = _noted(item, LOCAL), np.array(item.get(MARKS, ()), np.float64).reshape(-1, 3)
    now = marks_of(source)
    if local is None or len(now) != len(noted) or np.array_equal(now, noted):
        return False
    way = np.array(source.matrix_world.inverted_safe() @ item.matrix_world @ local.inverted_safe(), np.float64)
    expected = noted @ way[:3, :3].T + way[:3, 3]
    rounding = 1e-5 * max(np.abs(now).max(), np.abs(noted).max())
    return bool(np.abs(expected - now).max() <= rounding < np.abs(expected - noted).max())


def was_applied_itself(item: bpy.types.Object) -> bool:
    """Tells whether an output's own transform was applied, or its origin set: its points have other places in its
    space, and it has another place.
    """
    place, noted = _noted(item, PLACE), np.array(item.get(OWN_MARKS, ()), np.float64).reshape(-1, 3)
    if place is None or not len(noted) or np.array_equal(marks_of(item), noted):
        return False
    return not _are_equal(item.matrix_basis, place)


def marks_of(item: bpy.types.Object) -> np.ndarray:
    """(4, 3) where some points of a mesh or a curve are, in its space; (0, 3) where it has none."""
    if item.type == "CURVE":
        points = [spline.points[0] for spline in item.data.splines if len(spline.points)]
    else:
        points = item.data.vertices
    some = [points[i * (len(points) - 1) // 3].co[:3] for i in range(4 if len(points) else 0)]
    return np.array(some, np.float64).reshape(-1, 3)


def _noted(item: bpy.types.Object, key: str) -> Matrix | None:
    values = [float(value) for value in item.get(key, ())]
    return Matrix([values[4 * row : 4 * row + 4] for row in range(4)]) if len(values) == 16 else None


def _are_equal(one: Matrix, other: Matrix) -> bool:
    """Tells whether two are equal but for rounding."""
    size = max(1.0, max(abs(value) for row in one for value in row))
    return all(abs(one[i][j] - other[i][j]) <= 1e-5 * size for i in range(4) for j in range(4))


def _remove_empty(collections: list[bpy.types.Collection]) -> None:
    """Removes those of our collections that hold nothing any more."""
    for collection in set(collections):
        if COLLECTION in collection and not collection.objects and not collection.children:
            bpy.data.collections.remove(collection)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers: several patterns on one object, each with settings and outputs of its own.

The active layer's settings are those of `Object.saddleback` itself, where scripts, panels and files of version 0.1 have
them; the other layers keep theirs until they are chosen. Outputs know their layer by its word; the first layer's is "".
"""

from __future__ import annotations

import uuid
from collections.abc import Iterable
from functools import partial
from typing import Any

import bpy
from bpy.props import BoolProperty, IntProperty, PointerProperty, StringProperty

from .. import jobs, rollback
from ..bridge.outputs.layer_visibility import show_layer
from ..core.errors import BadInputError
from ..looks import NO_LOOK
from .kinds import is_chosen
from .region import LAYER_SETTINGS

# Of each kind of settings: attributes that it writes, whose names other layers must not have.
ATTRIBUTE_NAMES = {
    "tessellate": ("cell_attribute", "distance_attribute", "density_attribute", "edge_distance_attribute"),
    "distance": ("distance_attribute",),
    "direction_field": ("direction_attribute",),
}


def _show(layer: Any, _context: bpy.types.Context) -> None:
    show_layer(layer.id_data, layer)


def _ask(layer: Any, _context: bpy.types.Context) -> None:
    if layer.auto_update:
        jobs.state.live_asked.add(layer.id_data.name)
    layer.id_data.update_tag()


def _choose(props: Any, _context: bpy.types.Context) -> None:
    source = props.id_data
    if 0 <= props.layer_index < len(props.layers):
        activate(source, props.layers[props.layer_index])


# What a layer has beside settings.
OWN = ("name", "word", "given_name", "number", "is_frozen", "auto_update", "show_viewport", "show_render")


def layer_annotations(groups: dict[str, type]) -> dict[str, Any]:
    """What a layer keeps: its name and switches, and a group of settings for each operator."""
    return {
        "name": StringProperty(name="Name", description="Name of the layer"),
        "word": StringProperty(name="Word", description="By which outputs know their layer", options={"HIDDEN"}),
        "given_name": StringProperty(name="Given Name", description="The name it has of itself", options={"HIDDEN"}),
        "number": IntProperty(name="Number", description="At the end of its attributes' names", options={"HIDDEN"}),
        "is_frozen": BoolProperty(
            name="Frozen", description="What was made is no longer Saddleback's: it stays as it is",
            options={"HIDDEN"},
        ),
        "auto_update": BoolProperty(
            name="Auto Update", default=False, update=_ask,
            description="Make anew what was made in this layer whenever its settings, its mesh, paint, strokes or "
            "empties change, while the layer is the chosen one",
        ),
        "show_viewport": BoolProperty(
            name="Show in Viewport", description="Show what was made in this layer in the viewport", default=True,
            update=_show,
        ),
        "show_render": BoolProperty(
            name="Show in Renders", description="Show what was made in this layer in renders", default=True,
            update=_show,
        ),
        **{name: PointerProperty(type=kind) for name, kind in groups.items()},
    }  # fmt: skip


INDEX = IntProperty(name="Active Layer", description="Whose settings the panels show", update=_choose)
WORD = StringProperty(name="Layer", description="Word of the active layer", options={"HIDDEN"})


def layers_of(source: bpy.types.Object) -> list[Any]:
    """The object's layers; none before its first run."""
    return list(source.saddleback.layers) if source.is_property_set("saddleback") else []


def active_layer(source: bpy.types.Object) -> Any:
    """The layer whose settings `Object.saddleback` has; None where there are no layers yet."""
    return next((layer for layer in layers_of(source) if layer.word == source.saddleback.layer_word), None)


def first_layer(source: bpy.types.Object) -> Any:
    """The active layer; one is made for the settings and outputs of an object that has none, or lost it to a script."""
    if active_layer(source) is None:
        _new(source, source.saddleback.layer_word)
    return active_layer(source)


def add_layer(source: bpy.types.Object) -> Any:
    """Makes a layer without settings and chooses it."""
    is_first = not layers_of(source)
    if is_first and not has_settings(source):
        return first_layer(source)
    first_layer(source)
    layer = _new(source, uuid.uuid4().hex[:8])
    _name_attributes(layer, layer, 0)
    activate(source, layer)
    return layer


def duplicate_layer(source: bpy.types.Object) -> Any:
    """Makes a layer with the active one's settings, but attributes of its own, and chooses it."""
    first = first_layer(source)
    store(source)
    word, number, name = first.word, first.number, first.name
    layer = _new(source, uuid.uuid4().hex[:8], name)
    old = next(other for other in source.saddleback.layers if other.word == word)  # which may have moved in memory
    copy_layer(old, layer, _kinds())
    _name_attributes(old, layer, number)
    activate(source, layer)
    return layer


def forget_layer(source: bpy.types.Object) -> None:
    """Takes the active layer off the list and chooses the one before it; without any, the object has no settings."""
    props = source.saddleback
    index = next(i for i, layer in enumerate(props.layers) if layer.word == props.layer_word)
    props.layers.remove(index)
    if not len(props.layers):
        source.property_unset("saddleback")
        return
    _load(source, props.layers[max(index - 1, 0)])


def activate(source: bpy.types.Object, layer: Any) -> None:
    """Keeps the settings of the layer that was active, and takes those of this one."""
    if source.saddleback.layer_word != layer.word:
        store(source)
        _load(source, layer)


def store(source: bpy.types.Object) -> None:
    """Writes the object's settings into its active layer."""
    layer = active_layer(source)
    if layer is not None:
        copy_layer(source.saddleback, layer, _kinds())


def _load(source: bpy.types.Object, layer: Any) -> None:
    props = source.saddleback
    copy_layer(layer, props, _kinds())
    props.layer_word = layer.word
    show_index(source)


def show_index(source: bpy.types.Object) -> None:
    """Lets the list show which layer is active."""
    props = source.saddleback
    index = next((i for i, other in enumerate(props.layers) if other.word == props.layer_word), 0)
    if props.layer_index != index:
        props.layer_index = index


def name_after(source: bpy.types.Object, name: str) -> None:
    """Names the active layer after what was made, unless somebody gave it a name."""
    layer = first_layer(source)
    if layer.name == layer.given_name and not layer.name.startswith(name):
        for setting in ("name", "given_name"):
            rollback.remember_setting(layer, setting)
        layer.name = layer.given_name = _unique(source, name, layer.word)


def look_of(source: bpy.types.Object) -> str:
    """The look that the body below is seen with: of the active layer, or else of the first that has one.

    What covers a part of the body leaves the rest of it as it is.
    """
    every = [source.saddleback, *source.saddleback.layers] if source.is_property_set("saddleback") else []
    word = source.saddleback.layer_word if every else ""
    owners = [owner for owner in every if owner.region == "WHOLE" and getattr(owner, "word", None) != word]
    groups = [getattr(owner, kind) for owner in owners for kind in _kinds() if owner.is_property_set(kind)]
    looks = (getattr(group, "look", NO_LOOK) for group in groups)
    return next((look for look in looks if look != NO_LOOK), NO_LOOK)


def check_layer(source: bpy.types.Object) -> None:
    """Refuses what would be made in a frozen layer. Raises BadInputError."""
    layer = active_layer(source)
    if layer is not None and layer.is_frozen:
        raise BadInputError(
            f"'{source.name}': the layer '{layer.name}' is frozen, so that nothing is made in it: choose another one, "
            "or duplicate it"
        )


def copy_layer(old: Any, new: Any, kinds: Iterable[str]) -> None:
    """Copies what is set, and nothing else."""
    for kind in kinds:
        if old.is_property_set(kind):
            _copy(getattr(old, kind), getattr(new, kind))
        elif new.is_property_set(kind):
            new.property_unset(kind)
    for name in LAYER_SETTINGS:
        _copy_one(old, new, name)


def _copy(old: Any, new: Any) -> None:
    for name in old.bl_rna.properties.keys():  # noqa: SIM118  (no dict)
        if name in ("rna_type", "name", "evenness"):
            continue
        _copy_one(old, new, name)


def _copy_one(old: Any, new: Any, name: str) -> None:
    if is_chosen(old, name):
        setattr(new, name, getattr(old, name))
    elif new.is_property_set(name):
        new.property_unset(name)


def _kinds() -> tuple[str, ...]:
    from . import LAYER_KINDS

    return LAYER_KINDS


def _new(source: bpy.types.Object, word: str, name: str = "Layer") -> Any:
    number = 1 + max((layer.number for layer in layers_of(source)), default=0)
    while number > 1 and any(_numbered(known, number) == known for known in source.data.attributes.keys()):  # noqa: SIM118
        number += 1
    unique = _unique(source, name)
    layer = source.saddleback.layers.add()
    layer.name = layer.given_name = unique
    layer.word, layer.number = word, number
    rollback.undo_with(partial(_take_back, source, word))
    return layer


def _take_back(source: bpy.types.Object, word: str) -> None:
    index = next((i for i, layer in enumerate(layers_of(source)) if layer.word == word), None)
    if index is not None:
        source.saddleback.layers.remove(index)


def _unique(source: bpy.types.Object, wanted: str, own: str | None = None) -> str:
    names = {layer.name for layer in layers_of(source) if layer.word != own}
    number, base = 1, wanted.rstrip("0123456789 ") or wanted
    while wanted in names:
        number += 1
        wanted = f"{base} {number}"
    return wanted


def has_settings(source: bpy.types.Object) -> bool:
    """Tells whether anything was chosen for the object."""
    props = source.saddleback if source.is_property_set("saddleback") else None
    groups = [getattr(props, kind) for kind in _kinds() if props is not None and props.is_property_set(kind)]
    return any(group.is_property_set(name) for group in groups for name in group.bl_rna.properties.keys())  # noqa: SIM118


def _name_attributes(old: Any, new: Any, number: int) -> None:
    """Gives a layer's attributes names of its own: those of another layer with another number at their ends."""
    for kind, names in ATTRIBUTE_NAMES.items():
        for name in names:
            former = getattr(getattr(old, kind), name)
            setattr(getattr(new, kind), name, _numbered(former.removesuffix(f"_{number}"), new.number))


def _numbered(name: str, number: int) -> str:
    return f"{name.removesuffix(f'_{number}')}_{number}"


def suffix_of(source: bpy.types.Object) -> str:
    """What attributes of the active layer have at the ends of their names; "" in the first."""
    layer = active_layer(source)
    return f"_{layer.number}" if layer is not None and layer.number > 1 else ""

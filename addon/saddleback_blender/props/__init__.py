# SPDX-License-Identifier: GPL-3.0-or-later
"""Every setting once: as a property of its operator and, for the panel and the next session, kept on the object.

The properties themselves lie in a file a panel.
"""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import fields
from typing import Any, TypeVar

import bpy
from bpy.props import CollectionProperty, IntProperty, PointerProperty, StringProperty

from .. import jobs, rollback
from ..blocks import find, name_of
from ..core.lengths import SHARE
from ..core.settings import (
    BakeSettings,
    DirectionFieldSettings,
    DistanceSettings,
    DistributeSettings,
    PathSettings,
    RepairSettings,
    RibbonSettings,
    TessellateSettings,
    Voronoi2dSettings,
)
from . import layers, old_files, overrides
from .bake import BAKE
from .direction_field import DIRECTION_FIELD, DIRECTION_FIELD_BEGIN
from .distance import DISTANCE, DISTANCE_BEGIN
from .distribute import DISTRIBUTE, DISTRIBUTE_BEGIN
from .kept_sites import SITES
from .kinds import is_chosen
from .path import PATH, PATH_BEGIN
from .region import LAYER_SETTINGS
from .repair import REPAIR
from .ribbon import RIBBON, RIBBON_BEGIN
from .tessellate import EVENNESS, TESSELLATE, TESSELLATE_BEGIN
from .voronoi_2d import VORONOI_2D, VORONOI_2D_BEGIN

Settings = TypeVar(
    "Settings",
    TessellateSettings,
    DistanceSettings,
    PathSettings,
    RibbonSettings,
    Voronoi2dSettings,
    DirectionFieldSettings,
    DistributeSettings,
    BakeSettings,
    RepairSettings,
)

# An operator names objects by strings, so that scripts and presets can; the object itself keeps pointers, which survive
# renaming. These names are pointers on the object and strings on the operator.
OBJECT_NAMES = (
    "sites_object",
    "instance_object",
    "sources_object",
    "strokes_object",
    "density_object",
    "curves_object",
    "ribbon_object",
)
COLLECTION_NAMES = (
    "sources_collection",
    "points_collection",
    "strokes_collection",
    "singularities_collection",
    "density_collection",
    "shapes_collection",
    "curves_collection",
    "circles_collection",
)
IMAGE_NAMES = ("image_name", "density_image", "shapes_image", "direction_image", "painted_image")
TOLD, FIGURES = "told", "figures"  # on each group: what the last run said of the object, a sentence a line
SHARED = "shared"  # in texts: the settings that all operators in a layer share
CALL = "left_by_call"  # on each group: the values in it that a script's call has set, in JSON

PROPERTIES = {
    "tessellate": TESSELLATE,
    "distance": DISTANCE,
    "path": PATH,
    "ribbon": RIBBON,
    "voronoi_2d": VORONOI_2D,
    "direction_field": DIRECTION_FIELD,
    "distribute": DISTRIBUTE,
    "bake": BAKE,
    "repair": REPAIR,
}
# What the panel begins with where that is better than what a script gets that names nothing: its defaults never change.
BEGIN: dict[str, dict[str, Any]] = {
    "tessellate": TESSELLATE_BEGIN,
    "distance": DISTANCE_BEGIN,
    "path": PATH_BEGIN,
    "ribbon": RIBBON_BEGIN,
    "voronoi_2d": VORONOI_2D_BEGIN,
    "direction_field": DIRECTION_FIELD_BEGIN,
    "distribute": DISTRIBUTE_BEGIN,
}


def _followed(prop: Any, own: dict[str, Any]) -> Any:
    """The same property with keywords of its own, whose changes Auto Update sees."""
    return prop.function(**(prop.keywords | own | {"update": jobs.note_setting}))


def _kept(settings_name: str) -> dict[str, Any]:
    """Makes the same properties for an object to keep: named objects, collections and images become pointers."""
    begin = BEGIN.get(settings_name, {})
    pointers = (
        dict.fromkeys(OBJECT_NAMES, bpy.types.Object)
        | dict.fromkeys(COLLECTION_NAMES, bpy.types.Collection)
        | dict.fromkeys(IMAGE_NAMES, bpy.types.Image)
    )
    kept = {
        CALL: StringProperty(name="From a Call", description="Values that a script's call left", options={"HIDDEN"}),
        TOLD: StringProperty(name="Last Run", description="What the last run made", options={"HIDDEN"}),
        FIGURES: StringProperty(name="Figures", description="Numbers of the last run", options={"HIDDEN"}),
    }
    for name, prop in PROPERTIES[settings_name].items():
        if name in LAYER_SETTINGS:  # which the layer keeps
            continue
        if name in pointers:
            kept[name] = PointerProperty(
                type=pointers[name], name=prop.keywords["name"], description=prop.keywords["description"],
                update=jobs.note_setting,
            )  # fmt: skip
        else:
            kept[name] = _followed(prop, {"default": begin[name]} if name in begin else {})
    if settings_name == "tessellate":
        kept["evenness"] = EVENNESS
        kept[SITES] = StringProperty(name="Sites", description="Centers of the last cells", options={"HIDDEN"})
    return kept


class SaddlebackTessellateProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.tessellate`."""

    __annotations__ = _kept("tessellate")


class SaddlebackDistanceProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.distance`."""

    __annotations__ = _kept("distance")


class SaddlebackPathProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.path`."""

    __annotations__ = _kept("path")


class SaddlebackRibbonProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.ribbon`."""

    __annotations__ = _kept("ribbon")


class SaddlebackVoronoi2dProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.voronoi_2d`."""

    __annotations__ = _kept("voronoi_2d")


class SaddlebackDirectionFieldProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.direction_field`."""

    __annotations__ = _kept("direction_field")


class SaddlebackDistributeProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.distribute`."""

    __annotations__ = _kept("distribute")


class SaddlebackBakeProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.bake`."""

    __annotations__ = _kept("bake")


class SaddlebackRepairProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.repair`."""

    __annotations__ = _kept("repair")


# Of a layer each; what Repair does to the mesh is of none.
LAYER_KINDS = tuple(name for name in PROPERTIES if name != "repair")


class SaddlebackLayer(bpy.types.PropertyGroup):
    """One pattern on an object: its settings, while another is active."""

    __annotations__ = layers.layer_annotations(
        {
            "tessellate": SaddlebackTessellateProps,
            "distance": SaddlebackDistanceProps,
            "path": SaddlebackPathProps,
            "ribbon": SaddlebackRibbonProps,
            "voronoi_2d": SaddlebackVoronoi2dProps,
            "direction_field": SaddlebackDirectionFieldProps,
            "distribute": SaddlebackDistributeProps,
            "bake": SaddlebackBakeProps,
        }
    ) | dict(LAYER_SETTINGS)


class SaddlebackObjectProps(bpy.types.PropertyGroup):
    """`Object.saddleback`: the settings of each operator in the active layer, as last used or set in the panel."""

    __annotations__ = {
        "tessellate": PointerProperty(type=SaddlebackTessellateProps),
        "distance": PointerProperty(type=SaddlebackDistanceProps),
        "path": PointerProperty(type=SaddlebackPathProps),
        "ribbon": PointerProperty(type=SaddlebackRibbonProps),
        "voronoi_2d": PointerProperty(type=SaddlebackVoronoi2dProps),
        "direction_field": PointerProperty(type=SaddlebackDirectionFieldProps),
        "distribute": PointerProperty(type=SaddlebackDistributeProps),
        "bake": PointerProperty(type=SaddlebackBakeProps),
        "repair": PointerProperty(type=SaddlebackRepairProps),
        "layers": CollectionProperty(
            type=SaddlebackLayer,
            name="Layers",
            description="Patterns on the object",
            override={"LIBRARY_OVERRIDABLE", "USE_INSERTION"},
        ),
        "layer_index": layers.INDEX,
        "layer_word": layers.WORD,
        **{name: _followed(prop, {}) for name, prop in LAYER_SETTINGS.items()},
        "layout_number": IntProperty(name="Layout", description="Of these settings", options={"HIDDEN"}),
    }


CLASSES = (
    SaddlebackTessellateProps,
    SaddlebackDistanceProps,
    SaddlebackPathProps,
    SaddlebackRibbonProps,
    SaddlebackVoronoi2dProps,
    SaddlebackDirectionFieldProps,
    SaddlebackDistributeProps,
    SaddlebackBakeProps,
    SaddlebackRepairProps,
    SaddlebackLayer,
    SaddlebackObjectProps,
)


def fill_operator(
    operator: bpy.types.Operator, source: bpy.types.Object, settings_name: str, is_by_hand: bool
) -> tuple[str, ...]:
    """Gives the operator's properties that the caller did not set the object's values; returns those that he did set.

    A caller who sets none asks for what was last run. One who sets some means them, and the panel's values for the
    others, but never what an earlier call set and nobody chose since. What nobody ever set is as the panel shows it
    where a person asks, and as it always was where a script does.
    """
    called = tuple(name for name in PROPERTIES[settings_name] if operator.properties.is_property_set(name))
    if is_by_hand:
        for name, value in BEGIN.get(settings_name, {}).items():
            if name not in called:
                setattr(operator, name, value)
    group = existing_group(source, settings_name)
    called = _with_unit(operator, called)
    if not source.is_property_set("saddleback"):
        return called
    left = _left_by_call(group) if called and group is not None else {}
    for name in PROPERTIES[settings_name]:
        home = source.saddleback if name in LAYER_SETTINGS else group
        if name not in called and home is not None and is_chosen(home, name):
            value = _plain(home, name)
            if name not in left or left[name] != value:
                setattr(operator, name, value)
    return called


def _with_unit(operator: bpy.types.Operator, called: tuple[str, ...]) -> tuple[str, ...]:
    """A call that names a length, or a share, and not how lengths are given, says that by the name."""
    if "lengths" in called:
        return called
    shares = [name for name in called if name.endswith(SHARE)]
    absolute = [name for name in called if hasattr(operator, name + SHARE)]
    if not shares and not absolute:
        return called
    operator.lengths = "ABSOLUTE" if absolute else "RELATIVE"
    return (*called, "lengths")


def note_call(source: bpy.types.Object, settings_name: str, called: tuple[str, ...], is_by_hand: bool) -> None:
    """Notes which of the kept values a script's call has set; none where they were chosen by hand."""
    group = existing_group(source, settings_name)
    if group is None:
        return
    before = {name: value for name, value in _left_by_call(group).items() if value == _plain(group, name)}
    left = {} if is_by_hand else before | {name: _plain(group, name) for name in called}
    text = json.dumps(left, sort_keys=True)
    if getattr(group, CALL) != text and (text != "{}" or group.is_property_set(CALL)):
        rollback.remember_setting(group, CALL)
        setattr(group, CALL, text)


def keep_settings(settings: Settings, settings_name: str, source: bpy.types.Object) -> None:
    """Writes the settings of a run to the object, so that tomorrow's run is the same, whoever asks for it."""
    group, begin = getattr(source.saddleback, settings_name), BEGIN.get(settings_name, {})
    for field in fields(settings):
        # Default values stay unset, so that an object carries no more than what was chosen for it.
        value = getattr(settings, field.name)
        home = _home(group, field.name)
        is_open = field.name in begin and not home.is_property_set(field.name)
        if is_open or _plain(group, field.name) != value:
            rollback.remember_setting(home, field.name)
            _set_plain(group, field.name, value)


def keep_texts(source: bpy.types.Object, settings_name: str, told: list[str], figures: list[str]) -> None:
    """Writes on the object what a run said of it."""
    group = getattr(source.saddleback, settings_name)
    for name, lines in ((TOLD, told), (FIGURES, figures)):
        if getattr(group, name) != "\n".join(lines):
            rollback.remember_setting(group, name)
            setattr(group, name, "\n".join(lines))


def forget_texts(source: bpy.types.Object) -> None:
    """Takes all of that away, in all layers."""
    owners = [source.saddleback, *source.saddleback.layers] if source.is_property_set("saddleback") else []
    kept = [(owner, name) for owner in owners for name in LAYER_KINDS if owner.is_property_set(name)]
    groups = [existing_group(source, "repair"), *(getattr(owner, name) for owner, name in kept)]
    for group in groups:
        for name in (TOLD, FIGURES, SITES):
            if group is not None and name in group.bl_rna.properties and group.is_property_set(name):
                rollback.remember_setting(group, name)
                group.property_unset(name)


def existing_group(source: bpy.types.Object, settings_name: str) -> bpy.types.PropertyGroup | None:
    """Asks before it looks: reading a group or a pointer for the first time stores an empty one in the file."""
    if not source.is_property_set("saddleback") or not source.saddleback.is_property_set(settings_name):
        return None
    return getattr(source.saddleback, settings_name)


def _left_by_call(group: bpy.types.PropertyGroup) -> dict[str, Any]:
    return dict(json.loads(getattr(group, CALL) or "{}"))


def _home(group: bpy.types.PropertyGroup, name: str) -> bpy.types.PropertyGroup:
    """What keeps a setting: the operator's group, or all of the layer's settings."""
    return group.id_data.saddleback if name in LAYER_SETTINGS else group


def _plain(group: bpy.types.PropertyGroup, name: str) -> Any:
    """A kept value as the operator has it: of a pointer the name that leads to it."""
    value = getattr(_home(group, name), name)
    return value if _blocks(name) is None else name_of(_blocks(name), value)


def _set_plain(group: bpy.types.PropertyGroup, name: str, value: Any) -> None:
    setattr(_home(group, name), name, value if _blocks(name) is None else find(_blocks(name), value))


def _blocks(name: str) -> Any:
    """Returns where the data-blocks are that a setting points to; None for any other setting."""
    if name in OBJECT_NAMES:
        return bpy.data.objects
    if name in COLLECTION_NAMES:
        return bpy.data.collections
    return bpy.data.images if name in IMAGE_NAMES else None


def kept_settings(source: bpy.types.Object, settings_name: str, kind: type[Settings]) -> Settings:
    """The settings that the object keeps, or the defaults."""
    group = existing_group(source, settings_name)
    if group is None:
        return kind()
    return kind(
        **{
            field.name: _plain(group, field.name)
            for field in fields(kind)
            if is_chosen(_home(group, field.name), field.name)
        }
    )


def settings_of(operator: bpy.types.Operator, kind: type[Settings]) -> Settings:
    """The operator's properties as the core's dataclass."""
    return kind(**{field.name: getattr(operator, field.name) for field in fields(kind)})


def told_settings(source: bpy.types.Object) -> dict[str, Any]:
    """Returns what the object keeps: by operator and name, and of its other layers the same."""
    if not source.is_property_set("saddleback"):
        return {}
    props = source.saddleback
    told = _told(props)
    if len(props.layers):
        told["layer_word"] = props.layer_word
        told["layers"] = [
            {**_told(layer), "own": {name: getattr(layer, name) for name in layers.OWN}} for layer in props.layers
        ]
    return told


def _told(owner: bpy.types.PropertyGroup) -> dict[str, Any]:
    kinds = [name for name in PROPERTIES if name in owner.bl_rna.properties and owner.is_property_set(name)]
    told: dict[str, Any] = {}
    for kind in kinds:
        group = getattr(owner, kind)
        names = [name for name in (*PROPERTIES[kind], CALL) if name not in LAYER_SETTINGS]
        told[kind] = {name: _plain(group, name) for name in names if is_chosen(group, name)}
    shared = {name: getattr(owner, name) for name in LAYER_SETTINGS if is_chosen(owner, name)}
    return told | ({SHARED: shared} if shared else {})


def take_settings(source: bpy.types.Object, told: dict[str, Any]) -> None:
    """Gives the object what `told_settings` told; what is not known, as from another version, is left out."""
    props = source.saddleback
    _take(props, told)
    for values in told.get("layers", []):
        own = values.get("own", {})
        layer = next((layer for layer in props.layers if layer.word == own.get("word")), None) or props.layers.add()
        for name in layers.OWN:
            if name in own:
                setattr(layer, name, own[name])
        _take(layer, values)
    props.layer_word = told.get("layer_word", "")
    layers.show_index(source)


def _take(owner: bpy.types.PropertyGroup, told: dict[str, Any]) -> None:
    for settings_name, values in told.items():
        if settings_name != SHARED and settings_name not in PROPERTIES:
            continue
        group = owner if settings_name == SHARED else getattr(owner, settings_name)
        for name, value in values.items():
            if name in group.bl_rna.properties:
                with suppress(TypeError):  # another kind of value, or a choice that there is not here
                    setattr(group, name, value if _blocks(name) is None else find(_blocks(name), value))


def register() -> None:
    """Makes everything of this module known to Blender."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Object.saddleback = PointerProperty(type=SaddlebackObjectProps)
    overrides.register()
    old_files.register()


def unregister() -> None:
    """Takes it back, in the opposite order."""
    old_files.unregister()
    overrides.unregister()
    del bpy.types.Object.saddleback
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)

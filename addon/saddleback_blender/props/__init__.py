"""Every setting once: as a property of its operator and, for the panel and the next session, kept on the object.

The properties themselves lie in a file a panel.
"""

from __future__ import annotations

from dataclasses import fields
from typing import Any, TypeVar

import bpy
from bpy.props import PointerProperty

from ..core.settings import (
    DirectionFieldSettings,
    DistanceSettings,
    DistributeSettings,
    PathSettings,
    RepairSettings,
    TessellateSettings,
    Voronoi2dSettings,
)
from .direction_field import DIRECTION_FIELD
from .distance import DISTANCE
from .distribute import DISTRIBUTE
from .path import PATH
from .repair import REPAIR
from .tessellate import TESSELLATE
from .voronoi_2d import VORONOI_2D

Settings = TypeVar(
    "Settings",
    TessellateSettings,
    DistanceSettings,
    PathSettings,
    Voronoi2dSettings,
    DirectionFieldSettings,
    DistributeSettings,
    RepairSettings,
)

# An operator names objects by strings, so that scripts and presets can; the object itself keeps pointers, which survive
# renaming. These names are pointers on the object and strings on the operator.
OBJECT_NAMES = ("sites_object", "instance_object", "sources_object", "strokes_object", "density_object")
COLLECTION_NAMES = (
    "sources_collection",
    "points_collection",
    "strokes_collection",
    "singularities_collection",
    "density_collection",
    "shapes_collection",
)
IMAGE_NAMES = ("image_name", "density_image", "shapes_image")

PROPERTIES = {
    "tessellate": TESSELLATE,
    "distance": DISTANCE,
    "path": PATH,
    "voronoi_2d": VORONOI_2D,
    "direction_field": DIRECTION_FIELD,
    "distribute": DISTRIBUTE,
    "repair": REPAIR,
}


def _kept(properties: dict[str, Any]) -> dict[str, Any]:
    """The same properties for an object to keep: named objects, collections and images become pointers."""
    pointers = (
        dict.fromkeys(OBJECT_NAMES, bpy.types.Object)
        | dict.fromkeys(COLLECTION_NAMES, bpy.types.Collection)
        | dict.fromkeys(IMAGE_NAMES, bpy.types.Image)
    )
    kept = {}
    for name, prop in properties.items():
        if name in pointers:
            kept[name] = PointerProperty(
                type=pointers[name], name=prop.keywords["name"], description=prop.keywords["description"]
            )
        else:
            kept[name] = prop
    return kept


class SaddlebackTessellateProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.tessellate`."""

    __annotations__ = _kept(TESSELLATE)


class SaddlebackDistanceProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.distance`."""

    __annotations__ = _kept(DISTANCE)


class SaddlebackPathProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.path`."""

    __annotations__ = _kept(PATH)


class SaddlebackVoronoi2dProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.voronoi_2d`."""

    __annotations__ = _kept(VORONOI_2D)


class SaddlebackDirectionFieldProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.direction_field`."""

    __annotations__ = _kept(DIRECTION_FIELD)


class SaddlebackDistributeProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.distribute`."""

    __annotations__ = _kept(DISTRIBUTE)


class SaddlebackRepairProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.repair`."""

    __annotations__ = _kept(REPAIR)


class SaddlebackObjectProps(bpy.types.PropertyGroup):
    """`Object.saddleback`: the settings of each operator, as last used or set in the panel."""

    __annotations__ = {
        "tessellate": PointerProperty(type=SaddlebackTessellateProps),
        "distance": PointerProperty(type=SaddlebackDistanceProps),
        "path": PointerProperty(type=SaddlebackPathProps),
        "voronoi_2d": PointerProperty(type=SaddlebackVoronoi2dProps),
        "direction_field": PointerProperty(type=SaddlebackDirectionFieldProps),
        "distribute": PointerProperty(type=SaddlebackDistributeProps),
        "repair": PointerProperty(type=SaddlebackRepairProps),
    }


CLASSES = (
    SaddlebackTessellateProps,
    SaddlebackDistanceProps,
    SaddlebackPathProps,
    SaddlebackVoronoi2dProps,
    SaddlebackDirectionFieldProps,
    SaddlebackDistributeProps,
    SaddlebackRepairProps,
    SaddlebackObjectProps,
)


def fill_operator(operator: bpy.types.Operator, source: bpy.types.Object, settings_name: str) -> None:
    """Gives each property of the operator that the caller did not set the value that the object keeps.

    Asks before it looks: reading a group or a pointer for the first time stores an empty one in the file.
    """
    if not source.is_property_set("saddleback") or not source.saddleback.is_property_set(settings_name):
        return
    group = getattr(source.saddleback, settings_name)
    for name in PROPERTIES[settings_name]:
        if not operator.properties.is_property_set(name) and group.is_property_set(name):
            value = getattr(group, name)
            if name in OBJECT_NAMES + COLLECTION_NAMES + IMAGE_NAMES:
                value = value.name if value is not None else ""
            setattr(operator, name, value)


def keep_settings(settings: Settings, group: bpy.types.PropertyGroup) -> None:
    """Writes the settings of a run to the object, so that tomorrow's run is the same."""
    for field in fields(settings):
        value = getattr(settings, field.name)
        if field.name in OBJECT_NAMES:
            value = bpy.data.objects.get(value)
        elif field.name in COLLECTION_NAMES:
            value = bpy.data.collections.get(value)
        elif field.name in IMAGE_NAMES:
            value = bpy.data.images.get(value)
        # Default values stay unset, so that an object carries no more than what was chosen for it.
        if getattr(group, field.name) != value:
            setattr(group, field.name, value)


def kept_settings(source: bpy.types.Object, settings_name: str, kind: type[Settings]) -> Settings:
    """The settings that the object keeps, or the defaults; asks before it looks, as `fill_operator` does."""
    if not source.is_property_set("saddleback") or not source.saddleback.is_property_set(settings_name):
        return kind()
    group = getattr(source.saddleback, settings_name)
    values = {}
    for field in fields(kind):
        if group.is_property_set(field.name):
            value = getattr(group, field.name)
            if field.name in OBJECT_NAMES + COLLECTION_NAMES + IMAGE_NAMES:
                value = value.name if value is not None else ""
            values[field.name] = value
    return kind(**values)


def settings_of(operator: bpy.types.Operator, kind: type[Settings]) -> Settings:
    """The operator's properties as the core's dataclass."""
    return kind(**{field.name: getattr(operator, field.name) for field in fields(kind)})


def register() -> None:
    """Makes everything of this module known to Blender."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Object.saddleback = PointerProperty(type=SaddlebackObjectProps)


def unregister() -> None:
    """Takes it back, in the opposite order."""
    del bpy.types.Object.saddleback
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)

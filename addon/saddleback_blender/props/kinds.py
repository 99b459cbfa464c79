# SPDX-License-Identifier: GPL-3.0-or-later
"""Kinds of properties that several panels have, each made anew for each of them."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from ..looks import LOOKS, NO_LOOK, of_operator

QUALITIES = (
    ("FAST", "Fast", "Distances at most 2 % too long"),
    ("NORMAL", "Normal", "Distances at most 0.5 % too long"),
    ("FINE", "Fine", "Distances at most 0.2 % too long"),
)
EXACT_QUALITY = ("EXACT", "Exact", "Exact distances, with nothing kept for the next run")


def quality(items: tuple[tuple[str, str, str], ...] = QUALITIES) -> Any:
    """Returns how exact distances are."""
    return choice("Quality", "How exact distances are, and how long the first run on a mesh takes", items, "NORMAL")


def detail() -> Any:
    """Vertices in each neighborhood of the graph."""
    return IntProperty(
        name="Detail",
        description="Vertices in each neighborhood of the distance graph; 0 means as the quality needs",
        default=0,
        min=0,
        max=10000,
        soft_max=500,
        options={"SKIP_SAVE"},
    )


def on_disk() -> Any:
    """Tells whether the graph is kept."""
    return switch("Keep on Disk", "Keep the distance graph of this mesh in the folder of the preferences", False)


def use_modifiers() -> Any:
    """Tells whether the modifiers' result is worked on."""
    return BoolProperty(
        name="Use Modifiers",
        description="Work on what the modifiers make of the object; where they add vertices, a new object is made",
        default=False,
        options={"SKIP_SAVE"},
    )


def name_of(label: str, description: str, default: str = "", search: Any = None) -> Any:
    """The name of something in the file, or of an attribute; `search` gives those to choose from."""
    return StringProperty(
        name=label, description=description, default=default, options={"SKIP_SAVE"},
        **({} if search is None else {"search": search}),
    )  # fmt: skip


def painted_names(_settings: Any, context: bpy.types.Context, _typed: str) -> list[str]:
    """Names of what was painted on the active object: groups, numbers, colors."""
    item = context.object
    if item is None or item.type != "MESH":
        return []
    kinds = ("FLOAT", "FLOAT_COLOR", "BYTE_COLOR")
    attributes = [found.name for found in item.data.attributes if found.data_type in kinds]
    return [*item.vertex_groups.keys(), *(name for name in attributes if not name.startswith("."))]


def length(label: str, description: str, default: float, least: float = 0.0) -> Any:
    """A length in world units."""
    return FloatProperty(
        name=label, description=description, default=default, min=least, soft_max=10.0, precision=4, step=1,
        subtype="DISTANCE", options={"SKIP_SAVE"},
    )  # fmt: skip


def share(label: str, description: str, default: float) -> Any:
    """A length in percent of another."""
    return FloatProperty(
        name=label, description=description, default=default, min=0.0, soft_max=100.0, precision=2, step=10,
        subtype="PERCENTAGE", options={"SKIP_SAVE"},
    )  # fmt: skip


def lengths(of_what: str) -> Any:
    """How lengths are given."""
    items = (
        ("RELATIVE", "Relative", f"In percent of {of_what}"),
        ("ABSOLUTE", "World Units", "As they are, whatever the size of the model"),
    )
    return choice("Lengths", "How widths and heights are given", items, "ABSOLUTE")


def switch(label: str, description: str, default: bool) -> Any:
    """Yes or no."""
    return BoolProperty(name=label, description=description, default=default, options={"SKIP_SAVE"})


def choice(label: str, description: str, items: tuple[tuple[str, str, str], ...], default: str) -> Any:
    """One of several, each with its name and what it means."""
    return EnumProperty(name=label, description=description, items=items, default=default, options={"SKIP_SAVE"})


def look(operator: str) -> Any:
    """One of the looks that an operator makes, or none."""
    items = tuple((key, found.label, found.description) for key, found in of_operator(operator).items())
    none = (NO_LOOK, "None", "Plain colors and materials")
    return choice("Look", "Whose colors and material what is made has", (none, *items), NO_LOOK)


def any_look() -> Any:
    """One of all looks."""
    items = tuple((key, found.label, found.description) for key, found in LOOKS.items())
    return choice("Look", "What the object gets", items, next(iter(LOOKS)))


def is_chosen(group: bpy.types.PropertyGroup, name: str) -> bool:
    """Tells whether a value is kept. A choice that another version wrote, and there is not here, reads as "": none."""
    is_enum = group.bl_rna.properties[name].type == "ENUM"
    return bool(group.is_property_set(name)) and not (is_enum and getattr(group, name) == "")

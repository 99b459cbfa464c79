"""All texts of the tab that Blender can translate: labels and tips of operators, panels, menus and properties, the
choices of enumerations, and what panels write themselves.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy

import saddleback_blender

KINDS = ("Operator", "Panel", "Menu", "UIList", "PropertyGroup", "AddonPreferences")


def ui_texts() -> set[str]:
    """Those with a letter in them; the add-on must be registered."""
    found = {text.strip() for text in (*_of_classes(), *_of_sources()) if text}
    return {text for text in found if any(letter.isalpha() for letter in text)}


def _classes(base: type) -> Iterator[type]:
    for kind in base.__subclasses__():
        yield from _classes(kind)
        if kind.__module__.startswith(saddleback_blender.__name__):
            yield kind


def _of_classes() -> Iterator[str]:
    for kind in KINDS:
        base = getattr(bpy.types, kind)
        inherited = set(base.bl_rna.properties.keys())
        for own in _classes(base):
            if not own.is_registered:
                continue
            rna = own.bl_rna if kind != "Operator" else _operator(own).get_rna_type()
            yield from (rna.name, rna.description) if kind == "Operator" else (getattr(own, "bl_label", ""),)
            for prop in rna.properties:
                if prop.identifier not in inherited:
                    yield from _of_property(prop)


def _operator(own: Any) -> Any:
    family, name = own.bl_idname.split(".")
    return getattr(getattr(bpy.ops, family), name)


def _of_property(prop: Any) -> Iterator[str]:
    yield from (prop.name if prop.name != prop.identifier else "", prop.description)
    if prop.type == "ENUM":
        for item in prop.enum_items:
            yield from (item.name, item.description)


def _of_sources() -> Iterator[str]:
    """Texts that are handed to layouts as they are."""
    for path in Path(saddleback_blender.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.Call):
                continue
            for given in node.keywords:
                if given.arg == "text" and isinstance(given.value, ast.Constant) and isinstance(given.value.value, str):
                    yield given.value.value

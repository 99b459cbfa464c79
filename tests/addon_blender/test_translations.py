# SPDX-License-Identifier: GPL-3.0-or-later
"""The tab in other languages."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import pytest

import saddleback_blender
from saddleback_blender import translations

LANGUAGES = sorted(translations.LOCALES)
KINDS = ("Operator", "Panel", "Menu", "UIList", "PropertyGroup", "AddonPreferences")


def ui_texts() -> set[str]:
    """All texts of the tab that Blender can translate: labels and tips of operators, panels, menus and properties, the
    choices of enumerations, and what panels write themselves.
    """
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
            if kind == "Operator":
                yield from (rna.name, rna.description)
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
    """Labels of panels and menus, which Blender writes over when a preset is chosen, and texts that are handed to
    layouts as they are.
    """
    for path in Path(saddleback_blender.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            values = (
                [given.value for given in node.keywords if given.arg == "text"] if isinstance(node, ast.Call) else []
            )
            if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
                values += [node.value] if node.targets[0].id == "bl_label" else []
            yield from (
                value.value for value in values if isinstance(value, ast.Constant) and isinstance(value.value, str)
            )


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_text_is_translated_and_none_is_stale(language):
    texts, wanted = translations.texts(language), ui_texts()
    missing, stale = sorted(wanted - texts.keys()), sorted(texts.keys() - wanted)
    assert not missing, f"{language}.json has no translation of these"
    assert not stale, f"{language}.json translates what the tab no longer shows"
    assert [english for english, text in texts.items() if not text.strip()] == []


@pytest.mark.parametrize("language", LANGUAGES)
def test_numbers_and_names_are_kept(language):
    for english, text in translations.texts(language).items():
        kept = re.findall(r"saddleback_\w+|%|\d+", english)
        assert [mark for mark in kept if mark not in text] == [], english
        assert english.endswith(".") == text.endswith((".", "\N{IDEOGRAPHIC FULL STOP}")), english


@pytest.mark.parametrize("language", LANGUAGES)
def test_blender_finds_them(language):
    view = bpy.context.preferences.view
    before = view.language, view.use_translate_interface
    if not bpy.app.translations.locales:
        pytest.skip("Blender as a Python module has no languages; Blender itself has")
    locale = next(name for name in translations.LOCALES[language] if name in bpy.app.translations.locales)
    try:
        view.language, view.use_translate_interface = locale, True
        label = translations.texts(language)["Tessellate"]
        assert bpy.app.translations.pgettext_iface("Tessellate", "Operator") == label
        assert bpy.app.translations.pgettext_iface("Direction Field") == translations.texts(language)["Direction Field"]
    finally:
        view.language, view.use_translate_interface = before


def test_files_are_sorted():
    for language in LANGUAGES:
        keys = list(translations.texts(language))
        assert keys == sorted(keys), f"{language}.json: the next one to add a text looks for its place"

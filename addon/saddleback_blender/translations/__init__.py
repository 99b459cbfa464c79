# SPDX-License-Identifier: GPL-3.0-or-later
"""The tab in other languages, through Blender's own tables: one JSON file a language, English text to its translation.

Figures, results and refusals, which are sentences with names and numbers in them, stay English.
"""

from __future__ import annotations

import json
from importlib.resources import files

import bpy

# Blender's names of a language: Chinese is zh_CN up to 3.6 and zh_HANS from 4.0 on.
LOCALES = {"de": ("de_DE",), "es": ("es",), "fr": ("fr_FR",), "ja": ("ja_JP",), "zh": ("zh_CN", "zh_HANS")}
# Blender looks for the labels of operators in a context of their own.
CONTEXTS = ("*", "Operator")


def texts(language: str) -> dict[str, str]:
    """English to the language, as in its file."""
    found: dict[str, str] = json.loads(files(__package__).joinpath(f"{language}.json").read_text(encoding="utf-8"))
    return found


def register() -> None:
    """Gives Blender the tables."""
    tables = {
        locale: {(context, english): text for english, text in texts(language).items() for context in CONTEXTS}
        for language, locales in LOCALES.items()
        for locale in locales
    }
    bpy.app.translations.register(__package__, tables)


def unregister() -> None:
    """Takes them back."""
    bpy.app.translations.unregister(__package__)

"""The tab in other languages."""

import re

import bpy
import pytest

from saddleback_blender import translations
from tests.addon_blender.ui_texts import ui_texts

LANGUAGES = sorted(translations.LOCALES)


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

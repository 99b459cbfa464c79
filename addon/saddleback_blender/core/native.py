# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds the native library when it is first needed, so that Blender starts, updates and removes the add-on without it.

In the extension the library is a wheel that Blender installs; in the legacy zip it lies in a folder of the package.
"""

from __future__ import annotations

import importlib
import platform
import sys
from types import ModuleType
from typing import Any

VERSION = "0.1.0"
REQUIRED_VERSION = (0, 1)  # major and minor of the library that this add-on was written against


class NativeMissingError(Exception):
    """The native library cannot be loaded; the message says why and what to do."""


def load() -> Any:
    """The module `saddleback`. Raises NativeMissingError with one readable sentence."""
    module = sys.modules.get("saddleback")
    if module is None:
        module = _import()
    _check_version(module)
    return module


def problem() -> str:
    """Says why the native library cannot be used, or "" when it can."""
    try:
        load()
    except NativeMissingError as error:
        return str(error)
    return ""


def description() -> str:
    """One line for people: the library's version and the devices that it sees."""
    try:
        module = load()
    except NativeMissingError as error:
        return str(error)
    devices = getattr(module, "devices", None)
    seen = ", ".join(str(device) for device in devices()) if devices else "CPU"
    return f"Saddleback library {module.__version__} on {seen}"


def _import() -> ModuleType:
    try:
        return importlib.import_module("saddleback")
    except ImportError as error:
        wrong_package = error.name in ("saddleback", "saddleback._saddleback")
        raise NativeMissingError(
            (
                f"This package of Saddleback is not for Python {sys.version_info.major}.{sys.version_info.minor} on "
                f"{platform.system()} {platform.machine()}"
                if wrong_package
                else f"Saddleback's native library does not load ({error})"
            )
            + f": install {right_package()}, then restart Blender"
        ) from error


def right_package() -> str:
    """The file that addon/package makes for this Blender."""
    system = {"Darwin": "macos"}.get(platform.system(), platform.system().lower())
    machine = {"x86_64": "x64", "amd64": "x64", "aarch64": "arm64"}.get(platform.machine().lower(), platform.machine())
    # Before 4.2 Blender had Python 3.10, but for 4.1 and Debian's 3.4, and no extensions.
    legacy = sys.version_info < (3, 11) or (sys.version_info < (3, 12) and not __name__.startswith("bl_ext."))
    return f"saddleback-{VERSION}-{'legacy-' if legacy else ''}{system}_{machine}.zip"


def _check_version(module: ModuleType) -> None:
    text = str(getattr(module, "__version__", ""))
    try:
        version = tuple(int(part) for part in text.split(".")[:2])
    except ValueError:
        version = ()
    if version != REQUIRED_VERSION:
        wanted = ".".join(map(str, REQUIRED_VERSION))
        raise NativeMissingError(
            f"Saddleback's add-on needs its native library {wanted}, but {text or 'an unknown version'} is loaded from "
            f"{getattr(module, '__file__', '?')}: restart Blender after an update, or reinstall the add-on"
        )

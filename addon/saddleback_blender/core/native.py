"""Finds the native library when it is first needed, so that Blender starts, updates and removes the add-on without it.

In the extension the library is a wheel that Blender installs; in the legacy zip it lies in `lib/` beside this package.
"""

from __future__ import annotations

import importlib
import platform
import sys
import sysconfig
from pathlib import Path
from types import ModuleType
from typing import Any

REQUIRED_VERSION = (0, 1)  # major and minor of the library that this add-on was written against
LIBRARY_FOLDER = Path(__file__).resolve().parent.parent / "lib"


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
    if LIBRARY_FOLDER.is_dir() and str(LIBRARY_FOLDER) not in sys.path:
        sys.path.append(str(LIBRARY_FOLDER))
    try:
        return importlib.import_module("saddleback")
    except ImportError as error:
        suffix = sysconfig.get_config_var("EXT_SUFFIX")
        raise NativeMissingError(
            f"Saddleback's native library does not load ({error}): install the package made for {platform.system()} "
            f"{platform.machine()} and Python {sys.version_info.major}.{sys.version_info.minor} (it holds "
            f"_saddleback{suffix}), then restart Blender"
        ) from error


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

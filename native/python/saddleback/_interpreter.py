# SPDX-License-Identifier: MIT
"""Refuses to load the compiled module where it cannot work: under another Python or system, in a sub-interpreter."""

from __future__ import annotations

import sys
import sysconfig
from importlib import import_module
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path


def _is_main() -> bool:
    """Tells by the module that the interpreter has for it, under its name of 3.13 or before; without either there is
    one.
    """
    for name in ("_interpreters", "_xxsubinterpreters"):
        try:
            interpreters = import_module(name)
        except ImportError:
            continue
        return bool(interpreters.get_current() == interpreters.get_main())
    return True


def _wrong_package() -> str:
    """Names the wheel to install when the modules beside this file are for other interpreters, or returns ""."""
    found = sorted(path.name for path in Path(__file__).parent.glob("_saddleback.*") if path.suffix in (".so", ".pyd"))
    if not found or any(f"_saddleback{suffix}" in found for suffix in EXTENSION_SUFFIXES):
        return ""
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    system = sysconfig.get_platform().replace("linux", "manylinux_2_28").replace("-", "_").replace(".", "_")
    return (
        f"this saddleback holds {' and '.join(found)}, made for another Python or system: install the wheel "
        f"{python}-{python}-{system}, as `pip install saddleback` does by itself"
    )


if not _is_main():
    raise ImportError("saddleback works in a process's main interpreter only; start another process instead")
if _wrong := _wrong_package():
    raise ImportError(_wrong, name="saddleback._saddleback")

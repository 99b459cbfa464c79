"""Refuses to load the compiled module where it would wait for ever: in a sub-interpreter."""

from __future__ import annotations

from importlib import import_module


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


if not _is_main():
    raise ImportError("saddleback works in a process's main interpreter only; start another process instead")

"""Operators: gather from Blender, let the core compute, write the result."""

from __future__ import annotations


def register() -> None:
    pass


def unregister() -> None:
    pass

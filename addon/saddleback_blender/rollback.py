# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes to the file that are taken back where what they belong to fails: a run is written as a whole or not at all.

What is new goes away by itself. Whatever changes something older says how it was (`remember` and the like); whatever
removes something leaves that to the end (`when_written`), when nothing can fail any more.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import bpy
import numpy as np

from . import compat

KINDS = ("objects", "meshes", "curves", "collections", "node_groups", "materials", "actions", "images")

# Type of an attribute -> its elements' property, how many numbers that has, and the type that Blender copies in one go.
ELEMENTS: dict[str, tuple[str, int, type[np.generic]]] = {
    "FLOAT": ("value", 1, np.float32),
    "INT": ("value", 1, np.int32),
    "INT8": ("value", 1, np.int8),
    "BOOLEAN": ("value", 1, np.bool_),
    "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_VECTOR": ("vector", 3, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32),
    "BYTE_COLOR": ("color", 4, np.float32),
}


class _Changes:
    """Holds what is being written."""

    def __init__(self) -> None:
        self.before = {kind: {block.as_pointer() for block in getattr(bpy.data, kind)} for kind in KINDS}
        self.undo: list[Callable[[], None]] = []
        self.names: list[tuple[bpy.types.ID, str]] = []
        self.at_end: list[Callable[[], None]] = []

    def take_back(self) -> None:
        """Makes the file what it was. Names come last, since those of new data-blocks have to be free again."""
        for step in reversed(self.undo):
            step()
        for kind, known in self.before.items():
            blocks = getattr(bpy.data, kind)
            for block in [block for block in blocks if block.as_pointer() not in known]:
                blocks.remove(block)
        for block, name in reversed(self.names):
            block.name = name


_open: list[_Changes] = []  # one at most


@contextmanager
def all_or_nothing() -> Iterator[None]:
    """Keeps what is changed in the `with` only if nothing in it raises. One in another is part of that."""
    if _open:
        yield
        return
    changes = _Changes()
    _open.append(changes)
    try:
        yield
    except BaseException:
        _open.clear()
        changes.take_back()
        raise
    _open.clear()
    for step in changes.at_end:
        step()


def is_writing() -> bool:
    """Tells whether something is being written as a whole or not at all."""
    return bool(_open)


def when_written(step: Callable[[], None]) -> None:
    """Calls it when all is written and nothing has failed; at once where nothing is being written."""
    if _open:
        _open[0].at_end.append(step)
    else:
        step()


def undo_with(step: Callable[[], None]) -> None:
    """Says how a change that is made now is taken back."""
    if _open:
        _open[0].undo.append(step)


def remember(owner: Any, *names: str) -> None:
    """Properties that are about to change."""
    for name in names if _open else ():
        value = getattr(owner, name)
        undo_with(partial(setattr, owner, name, value.copy() if hasattr(value, "freeze") else value))


def remember_name(block: bpy.types.ID) -> None:
    """The name of a data-block that is about to get another."""
    if _open:
        _open[0].names.append((block, block.name))


def remember_setting(group: bpy.types.PropertyGroup, name: str) -> None:
    """A registered property that is about to change, and whether it was set at all."""
    if _open and not group.is_property_set(name):
        undo_with(partial(group.property_unset, name))
    else:
        remember(group, name)


def remember_keys(block: bpy.types.ID, *keys: str) -> None:
    """Custom properties that are about to change."""
    for key in keys if _open else ():
        value = block.get(key)
        undo_with(partial(_set_key, block, key, value.to_list() if hasattr(value, "to_list") else value))


def remember_attribute(mesh: bpy.types.Mesh, name: str) -> None:
    """An attribute that is about to be made, changed or removed."""
    if not _open or mesh.as_pointer() not in _open[0].before["meshes"]:
        return
    attribute = mesh.attributes.get(name)
    if attribute is None:
        undo_with(partial(_remove_attribute, mesh, name))
    elif attribute.data_type in ELEMENTS:
        element, width, dtype = ELEMENTS[attribute.data_type]
        values: np.ndarray[Any, Any] = np.empty(width * len(attribute.data), dtype)
        attribute.data.foreach_get(element, compat.as_copied(values))
        undo_with(partial(_set_attribute, mesh, name, attribute.data_type, attribute.domain, values))


def _set_key(block: bpy.types.ID, key: str, value: Any) -> None:
    if value is not None:
        block[key] = value
    elif key in block:
        del block[key]


def _remove_attribute(mesh: bpy.types.Mesh, name: str) -> None:
    attribute = mesh.attributes.get(name)
    if attribute is not None:
        mesh.attributes.remove(attribute)


def _set_attribute(mesh: bpy.types.Mesh, name: str, data_type: str, domain: str, values: np.ndarray[Any, Any]) -> None:
    attribute = mesh.attributes.get(name)
    if attribute is not None and (attribute.data_type, attribute.domain) != (data_type, domain):
        mesh.attributes.remove(attribute)
        attribute = None
    if attribute is None:
        attribute = mesh.attributes.new(name, data_type, domain)
    attribute.data.foreach_set(ELEMENTS[data_type][0], compat.as_copied(values))
    mesh.update_tag()

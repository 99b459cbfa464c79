# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays -> named attributes of a mesh, and the list of those that we made."""

from __future__ import annotations

import json
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ... import compat, rollback
from ...blocks import is_editable
from ...core.errors import BadInputError
from ..tokens import SOURCE, layer_of, owns, source_token, token_of

# On a mesh: the attributes that we wrote, each with the token of the object that they are of, and the word of the layer
# behind a "/", in JSON. Files of older versions have names only, one a line. Clear removes these and no others.
RECORD = "saddleback_attributes"
# On a mesh: how many directions the attribute that was written last stands for; and each of ours, by its name, in JSON.
SYMMETRY, SYMMETRIES = "saddleback_symmetry", "saddleback_symmetries"

# dtype kind and trailing shape -> attribute type, its element property, and the dtype that is copied without a loop.
KINDS: dict[tuple[str, tuple[int, ...]], tuple[str, str, type[np.generic]]] = {
    ("f", ()): ("FLOAT", "value", np.float32),
    ("i", ()): ("INT", "value", np.int32),
    ("b", ()): ("BOOLEAN", "value", np.bool_),
    ("f", (2,)): ("FLOAT2", "vector", np.float32),
    ("f", (3,)): ("FLOAT_VECTOR", "vector", np.float32),
    ("f", (4,)): ("FLOAT_COLOR", "color", np.float32),
}
DOMAIN_ELEMENTS = {"POINT": "vertices", "EDGE": "edges", "FACE": "polygons", "CORNER": "loops"}


def write_vertex_attributes(item: bpy.types.Object, values: dict[str, NDArray[Any]]) -> None:
    """Writes arrays (V,) or (V, c) as vertex attributes of the object's mesh and remembers that they are ours."""
    write_attributes(item, "POINT", values)


def write_attributes(item: bpy.types.Object, domain: str, values: dict[str, NDArray[Any]]) -> None:
    """Writes arrays (n,) or (n, c) as attributes of n elements of the object's mesh and remembers that they are ours.

    An attribute of the same name is written over; one of another type or domain is replaced. Where nothing differs
    nothing is written, so that Blender need not evaluate the object anew.
    """
    mesh = item.data
    changed = {name: array for name, array in values.items() if not _holds(mesh, name, domain, array)}
    for name, array in changed.items():
        set_attribute(mesh, name, domain, array)
    record(item, values)
    if changed:
        mesh.update_tag()


def _holds(mesh: bpy.types.Mesh, name: str, domain: str, values: NDArray[Any]) -> bool:
    """Tells whether the mesh has this attribute with just these values."""
    kind, element, dtype = KINDS[values.dtype.kind, values.shape[1:]]
    attribute = mesh.attributes.get(name)
    if attribute is None or (attribute.data_type, attribute.domain) != (kind, domain):
        return False
    if len(attribute.data) != len(values):
        return False
    now = np.empty(values.size, dtype)
    attribute.data.foreach_get(element, compat.as_copied(now))
    return bool(np.array_equal(now, np.ascontiguousarray(values, dtype).ravel()))


def set_attribute(mesh: bpy.types.Mesh, name: str, domain: str, values: NDArray[Any]) -> bpy.types.Attribute:
    """Makes or fills one attribute. Raises BadInputError where Blender refuses the name or the length does not fit."""
    kind, element, dtype = KINDS[values.dtype.kind, values.shape[1:]]
    wanted = len(getattr(mesh, DOMAIN_ELEMENTS[domain]))
    if len(values) != wanted:
        raise BadInputError(f"'{mesh.name}': attribute '{name}' has {len(values)} values for {wanted} elements")
    rollback.remember_attribute(mesh, name)
    attribute = mesh.attributes.get(name)
    if attribute is not None and (attribute.data_type, attribute.domain) != (kind, domain):
        mesh.attributes.remove(attribute)
        attribute = None
    if attribute is None:
        attribute = mesh.attributes.new(name=name, type=kind, domain=domain)
        if attribute is None or attribute.name != name:
            if attribute is not None:
                mesh.attributes.remove(attribute)
            raise BadInputError(
                f"'{mesh.name}': the name '{name}' is taken or too long; choose another name for the attribute"
            )
    attribute.data.foreach_set(element, compat.as_copied(np.ascontiguousarray(values, dtype).ravel()))
    return attribute


def record(item: bpy.types.Object, names: Any) -> None:
    """Adds names to the list of the object's mesh, as the object's; an output's own mesh is nobody else's."""
    source = item.parent if SOURCE in item else item
    layer = "" if source is None else layer_of(source)
    writer = ("" if SOURCE in item else source_token(item)) + (f"/{layer}" if layer else "")
    _keep(item.data, _writers(item.data) | dict.fromkeys(names, writer))


def forget(mesh: bpy.types.Mesh, name: str) -> None:
    """Takes a name off the mesh's list: the attribute is the artist's from now on."""
    _keep(mesh, {other: token for other, token in _writers(mesh).items() if other != name})


def forget_layer_names(mesh: bpy.types.Mesh, layer: str) -> int:
    """Takes a layer's attributes off the mesh's list: they are the artist's from now on; returns how many."""
    own = [name for name, writer in _writers(mesh).items() if writer.partition("/")[2] == layer]
    _keep(mesh, {name: writer for name, writer in _writers(mesh).items() if name not in own})
    return len(own)


def recorded(mesh: bpy.types.Mesh, item: bpy.types.Object | None = None) -> list[str]:
    """The attributes that we wrote, whether or not they still exist; with an object those of others with its mesh not
    among them.
    """
    others = set() if item is None else {token for twin in twins_of(item) if owns(twin, token := token_of(twin))}
    return [name for name, writer in _writers(mesh).items() if writer.partition("/")[0] not in others - {""}]


def twins_of(item: bpy.types.Object) -> list[bpy.types.Object]:
    """The other objects with the same data."""
    return [twin for twin in bpy.data.objects if twin.data == item.data and twin != item]


def belongs_to_other_layer(source: bpy.types.Object, name: str) -> bool:
    """Tells whether another layer of the object wrote an attribute of its mesh."""
    token, _, layer = _writers(source.data).get(name, "").partition("/")
    return bool(token) and token == token_of(source) and layer != layer_of(source) and owns(source, token)


def clear_attributes(source: bpy.types.Object, layer: str | None = None) -> int:
    """Removes the attributes that we wrote for the object, or in one layer of it; returns how many there were.

    Those of another object with the same mesh stay.
    """
    mesh = source.data
    if not is_editable(mesh):
        return 0
    writers = _writers(mesh)
    own = [name for name in recorded(mesh, source) if layer in (None, writers[name].partition("/")[2])]
    count = 0
    for name in own:
        attribute = mesh.attributes.get(name)
        if attribute is not None:
            rollback.remember_attribute(mesh, name)
            mesh.attributes.remove(attribute)
            count += 1
    _keep(mesh, {name: token for name, token in writers.items() if name not in own})
    _keep_symmetries(mesh, _symmetries(mesh))
    return count


def note_symmetry(mesh: bpy.types.Mesh, name: str, symmetry: int) -> None:
    """Notes how many directions an attribute of vectors stands for."""
    _keep_symmetries(mesh, {**_symmetries(mesh), name: symmetry})
    if mesh.get(SYMMETRY) != symmetry:
        rollback.remember_keys(mesh, SYMMETRY)
        mesh[SYMMETRY] = symmetry


def symmetry_of(mesh: bpy.types.Mesh, name: str) -> int:
    """Tells how many directions an attribute stands for: of one that is not ours what the mesh says; 0: unknown."""
    return int(_symmetries(mesh).get(name, mesh.get(SYMMETRY, 0)))


def _symmetries(mesh: bpy.types.Mesh) -> dict[str, int]:
    return dict(json.loads(str(mesh.get(SYMMETRIES, "{}"))))


def _keep_symmetries(mesh: bpy.types.Mesh, symmetries: dict[str, int]) -> None:
    """Those of attributes that are there; without any the mesh says nothing."""
    there = {name: symmetry for name, symmetry in symmetries.items() if name in mesh.attributes}
    text = json.dumps(there, sort_keys=True)
    if text == mesh.get(SYMMETRIES, "{}"):
        return
    rollback.remember_keys(mesh, SYMMETRY, SYMMETRIES)
    mesh[SYMMETRIES] = text
    for key in () if there else (SYMMETRY, SYMMETRIES):
        if key in mesh:
            del mesh[key]


def _writers(mesh: bpy.types.Mesh) -> dict[str, str]:
    """Token and layer by name of the attributes that we wrote; "" where an older version wrote it."""
    text = str(mesh.get(RECORD, ""))
    return dict(json.loads(text)) if text.startswith("{") else dict.fromkeys(filter(None, text.split("\n")), "")


def _keep(mesh: bpy.types.Mesh, writers: dict[str, str]) -> None:
    text = json.dumps(writers, sort_keys=True)
    if mesh.get(RECORD, "{}") == text:
        return
    rollback.remember_keys(mesh, RECORD)
    if writers:
        mesh[RECORD] = text
    else:
        del mesh[RECORD]

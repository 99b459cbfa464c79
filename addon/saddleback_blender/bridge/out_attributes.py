"""Arrays -> named attributes of a mesh, and the list of those that we made."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..core.errors import BadInputError

# A mesh's own list of the attributes that we wrote, one name a line: clear removes these and no others.
RECORD = "saddleback_attributes"

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
    record(mesh, values)
    if changed:
        mesh.update_tag()


def _holds(mesh: bpy.types.Mesh, name: str, domain: str, values: NDArray[Any]) -> bool:
    """Whether the mesh has this attribute with just these values."""
    kind, element, dtype = KINDS[values.dtype.kind, values.shape[1:]]
    attribute = mesh.attributes.get(name)
    if attribute is None or (attribute.data_type, attribute.domain) != (kind, domain):
        return False
    if len(attribute.data) != len(values):
        return False
    now = np.empty(values.size, dtype)
    attribute.data.foreach_get(element, now)
    return bool(np.array_equal(now, np.ascontiguousarray(values, dtype).ravel()))


def set_attribute(mesh: bpy.types.Mesh, name: str, domain: str, values: NDArray[Any]) -> bpy.types.Attribute:
    """Makes or fills one attribute. Raises BadInputError where Blender refuses the name or the length does not fit."""
    kind, element, dtype = KINDS[values.dtype.kind, values.shape[1:]]
    wanted = len(getattr(mesh, DOMAIN_ELEMENTS[domain]))
    if len(values) != wanted:
        raise BadInputError(f"'{mesh.name}': attribute '{name}' has {len(values)} values for {wanted} elements")
    attribute = mesh.attributes.get(name)
    if attribute is not None and (attribute.data_type, attribute.domain) != (kind, domain):
        mesh.attributes.remove(attribute)
        attribute = None
    if attribute is None:
        attribute = mesh.attributes.new(name=name, type=kind, domain=domain)
        if attribute.name != name:
            mesh.attributes.remove(attribute)
            raise BadInputError(f"'{mesh.name}': the name '{name}' is taken; choose another name for the attribute")
    attribute.data.foreach_set(element, np.ascontiguousarray(values, dtype).ravel())
    return attribute


def record(mesh: bpy.types.Mesh, names: Any) -> None:
    """Adds names to the mesh's list."""
    names = "\n".join(sorted({*recorded(mesh), *names}))
    if mesh.get(RECORD) != names:
        mesh[RECORD] = names


def forget(mesh: bpy.types.Mesh, name: str) -> None:
    """Takes a name off the mesh's list: the attribute is the artist's from now on."""
    names = [other for other in recorded(mesh) if other != name]
    if names:
        mesh[RECORD] = "\n".join(names)
    elif RECORD in mesh:
        del mesh[RECORD]


def recorded(mesh: bpy.types.Mesh) -> list[str]:
    """The attributes that we wrote, whether or not they still exist."""
    return str(mesh.get(RECORD, "")).split("\n") if mesh.get(RECORD) else []


def clear_attributes(mesh: bpy.types.Mesh) -> int:
    """Removes the attributes that we wrote, and their list; returns how many there were."""
    count = 0
    for name in recorded(mesh):
        attribute = mesh.attributes.get(name)
        if attribute is not None:
            mesh.attributes.remove(attribute)
            count += 1
    if RECORD in mesh:
        del mesh[RECORD]
    return count

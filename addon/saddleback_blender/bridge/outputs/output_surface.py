# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh that attributes go to: the object's own or, where modifiers made other vertices, a new object beside it."""

from __future__ import annotations

import bpy
import numpy as np

from ... import compat
from ...blocks import is_editable
from ...core.errors import BadInputError
from ..inputs.mesh_in import mesh_of
from ..tokens import ROLE
from .following import Follower
from .lifting import lift
from .out_attributes import belongs_to_other_layer, recorded
from .out_collection import SURFACE_ROLE, find_output, remove_output, replace_object


def output_surface(
    context: bpy.types.Context,
    source: bpy.types.Object,
    use_modifiers: bool,
    aside: str = "",
    follower: Follower | None = None,
) -> bpy.types.Object:
    """The object whose mesh has the vertices that were read: the source, unless its own are others or are linked.

    A new one lies on what the source shows and would fight with it for every pixel: `aside` "HIDE" hides it at first,
    "LIFT" lifts it by a hair.
    """
    existing = holder(context, source, use_modifiers)
    if existing == source:
        if use_modifiers:  # a copy from when modifiers made other faces has no more to tell
            remove_output(source, SURFACE_ROLE)
        return source
    if existing is not None and _same_shape(context, source, existing, use_modifiers):
        return existing  # with the other operators' results on it
    if use_modifiers:
        depsgraph = context.evaluated_depsgraph_get()
        mesh = bpy.data.meshes.new_from_object(
            source.evaluated_get(depsgraph), preserve_all_data_layers=True, depsgraph=depsgraph
        )
    else:
        mesh = source.data.copy()
    item = replace_object(context, source, SURFACE_ROLE, mesh)
    if use_modifiers and aside == "HIDE" and existing is None:
        item.hide_viewport = item.hide_render = True
    elif use_modifiers and aside == "LIFT" and existing is None:
        lift(source, item)
    if follower is not None:
        follower.take_all(item, source.matrix_world)
    return item


def holder(context: bpy.types.Context, source: bpy.types.Object, use_modifiers: bool) -> bpy.types.Object | None:
    """The object whose mesh has the attributes of runs: the source, or what was made beside it, None before."""
    if is_editable(source.data) and (not use_modifiers or has_own_faces(context, source)):
        return source
    return find_output(source, SURFACE_ROLE)


def check_attribute_names(
    source: bpy.types.Object, names: dict[str, str], types: dict[str, str], domain: str = "POINT"
) -> None:
    """Refuses names that would overwrite something else.

    `names`: property -> attribute to be written; `types`: property -> its data type.
    """
    seen: set[str] = set()
    for prop, name in names.items():
        label = prop.replace("_", " ")
        if not name or name.startswith(".") or name in ("position", "material_index"):
            raise BadInputError(f"'{source.name}': the {label} cannot be called '{name}'; choose another name")
        if name in seen:
            raise BadInputError(
                f"'{source.name}': two attributes are to be called '{name}'; choose another name for one"
            )
        seen.add(name)
        if name in source.vertex_groups:
            raise BadInputError(f"'{source.name}' has a vertex group '{name}': choose another name for the {label}")
        if belongs_to_other_layer(source, name):
            raise BadInputError(
                f"'{source.name}': the attribute '{name}' is another layer's: choose another name for the {label}"
            )
        old = source.data.attributes.get(name)
        is_made_by_us = ROLE in source and name.startswith("saddleback_")  # cells on an output's cells
        if (
            old is not None
            and name not in recorded(source.data)
            and not is_made_by_us
            and (old.domain != domain or old.data_type != types[prop])
        ):
            raise BadInputError(
                f"'{source.name}' has another kind of attribute '{name}': choose another name for the {label}"
            )


def has_own_faces(context: bpy.types.Context, source: bpy.types.Object) -> bool:
    """Tells whether the object's faces are those of its own mesh after its modifiers, too, wherever they have moved."""
    with mesh_of(context, source, True, has_layers=False) as mesh:
        return _equal_faces(mesh, source.data)


def _same_shape(
    context: bpy.types.Context, source: bpy.types.Object, other: bpy.types.Object, use_modifiers: bool
) -> bool:
    # With layers, as it was made: what Blender drew by the GPU may differ in the last bit.
    with mesh_of(context, source, use_modifiers) as mesh:
        return _equal_faces(mesh, other.data) and np.array_equal(
            compat.read_positions(mesh), compat.read_positions(other.data)
        )


def _equal_faces(mesh: bpy.types.Mesh, other: bpy.types.Mesh) -> bool:
    counts = [(len(one.vertices), len(one.loops), len(one.polygons)) for one in (mesh, other)]
    if counts[0] != counts[1]:
        return False
    return bool(np.array_equal(compat.read_corner_vertices(mesh), compat.read_corner_vertices(other)))

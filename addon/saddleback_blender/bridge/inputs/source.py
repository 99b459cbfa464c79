# SPDX-License-Identifier: GPL-3.0-or-later
"""The object that an operator works on: may it be used, and is it still the same when the answer comes?"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from ... import compat
from ...blocks import is_editable
from ...core.errors import BadInputError
from .mesh_in import mesh_of, scale_of

# Share of the volume of its edge lengths below which a transform's parallelepiped counts as flat.
FLAT_TRANSFORM = 1e-9

CONVERTIBLE = {"CURVE", "SURFACE", "FONT", "META"}
"""The types of objects that Blender makes meshes of at a press."""


def active_object(context: bpy.types.Context) -> Any:
    """The active object or None: of `Context.temp_override` where that names one, else of the view layer."""
    own = context.view_layer.objects.active
    named = (getattr(context, name, None) for name in ("object", "active_object"))  # neither is there without a window
    return next((item for item in named if item is not None and item != own), own)


def why_not(context: bpy.types.Context) -> str:
    """Says why no operator can run on the active object, or "". Cheap enough to be asked at every redraw."""
    active = active_object(context)
    if active is None:
        return "Choose a mesh object first: there is no active object"
    if active.type != "MESH":
        kind = active.bl_rna.properties["type"].enum_items[active.type].name
        convert = "press Object > Convert > Mesh, or " if active.type in CONVERTIBLE else ""
        return f"'{active.name}' is no mesh but of the type {kind}: {convert}choose a mesh object"
    if active.mode == "EDIT":
        return f"'{active.name}' is in Edit Mode: leave it first (Tab)"
    return ""


def usable_source(context: bpy.types.Context, is_evaluated: bool = False) -> bpy.types.Object:
    """The active object. Raises BadInputError saying why it cannot be used."""
    problem = why_not(context)
    if problem:
        raise BadInputError(problem)
    source: bpy.types.Object = active_object(context)
    name = source.name
    if source.library is not None:
        raise BadInputError(
            f"'{name}' is linked from {source.library.filepath}: make a library override of it first, or make it local "
            "(Object > Library Override, Object > Relations)"
        )
    if not source.visible_get(view_layer=context.view_layer):
        raise BadInputError(f"'{name}' is hidden: show it first")
    if source.mode == "SCULPT" and source.use_dynamic_topology_sculpting:
        raise BadInputError(f"'{name}' is sculpted with dynamic topology: leave Sculpt Mode first")
    if source.mode == "SCULPT" and any(modifier.type == "MULTIRES" for modifier in source.modifiers):
        raise BadInputError(f"'{name}' is sculpted with a Multiresolution modifier: leave Sculpt Mode first")
    if not is_evaluated:
        context.view_layer.update()  # a script may have moved it just now
    _check_transform(source)
    if not len(source.data.vertices):
        raise BadInputError(f"'{name}' is empty: it has no vertices")
    return source


def check_own_mesh(source: bpy.types.Object) -> None:
    """Refuses an object whose mesh is another file's. Raises BadInputError."""
    if not is_editable(source.data):
        library = source.data.library or source.data.override_library.reference.library
        raise BadInputError(
            f"The mesh of '{source.name}' is linked from {library.filepath}: make it local first "
            "(Object > Relations > Make Local)"
        )


def shared_mesh_warning(source: bpy.types.Object) -> str:
    """Returns what to say about a mesh that other objects show too, or ""."""
    users = sum(item.data == source.data for item in bpy.data.objects)
    if users < 2:
        return ""
    return f"The mesh of '{source.name}' is shared by {users} objects: all of them show the new attributes"


@dataclass(frozen=True)
class Source:
    """Finds the object again after a run, without holding on to Blender's memory meanwhile."""

    name: str
    identity: int
    use_modifiers: bool
    content: str

    @classmethod
    def of(cls, context: bpy.types.Context, source: bpy.types.Object, use_modifiers: bool) -> Source:
        """Notes what is needed to know the object again."""
        return cls(source.name, compat.identity(source), use_modifiers, _content(context, source, use_modifiers))

    def find(self, context: bpy.types.Context) -> bpy.types.Object:
        """The object, unchanged. Raises BadInputError when it is gone, busy or another."""
        source = bpy.data.objects.get(self.name)
        if source is None or compat.identity(source) != self.identity or source.type != "MESH":
            raise BadInputError(f"'{self.name}' was deleted or renamed during the run: nothing was written")
        if source.mode == "EDIT":
            raise BadInputError(
                f"'{self.name}' went into Edit Mode during the run, so nothing was written: leave it and run again"
            )
        if source.name not in context.view_layer.objects:
            raise BadInputError(f"'{self.name}' left the view layer during the run: nothing was written")
        if _content(context, source, self.use_modifiers) != self.content:
            raise BadInputError(f"'{self.name}' was changed during the run, so nothing was written: run again")
        return source


def _content(context: bpy.types.Context, source: bpy.types.Object, use_modifiers: bool) -> str:
    """A hash of what a run reads of the shape: places, faces and scale."""
    digest = hashlib.blake2b(scale_of(source).tobytes(), digest_size=16)
    with mesh_of(context, source, use_modifiers, has_layers=False) as mesh:
        digest.update(f"{len(mesh.vertices)} {len(mesh.loops)} {len(mesh.polygons)}".encode())
        digest.update(compat.read_positions(mesh).data)
        digest.update(compat.read_numbers(mesh.polygons, "loop_total").data)
        digest.update(compat.read_corner_vertices(mesh).data)
    return digest.hexdigest()


def _check_transform(source: bpy.types.Object) -> None:
    matrix = np.array(source.matrix_world, np.float64)
    if not np.isfinite(matrix).all():
        raise BadInputError(
            f"'{source.name}' has a transform that is not finite: clear its location, rotation and scale"
        )
    lengths = np.linalg.norm(matrix[:3, :3], axis=0)
    if (
        abs(np.linalg.det(matrix[:3, :3])) <= FLAT_TRANSFORM * lengths.max() * np.sort(lengths)[1] ** 2
        or not lengths.all()
    ):
        axes = " and ".join(
            axis for axis, length in zip("XYZ", lengths, strict=True) if length <= FLAT_TRANSFORM * lengths.max()
        )
        raise BadInputError(
            f"'{source.name}' has zero scale{' along ' + axes if axes else ''}: set a scale that is not zero"
        )

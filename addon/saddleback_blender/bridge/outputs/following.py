# SPDX-License-Identifier: GPL-3.0-or-later
"""Lets outputs go along with their source where armatures, shape keys, lattices and subdivision move its surface."""

from __future__ import annotations

from functools import cached_property

import bpy
import numpy as np
from mathutils import Matrix

from ...core import cache, runs
from ...core.graphs import mesh_of_surface
from ...core.progress import blocks
from ...core.requests import Surface
from ...core.results import Anchors, Reals
from ...core.surfaces.ground import Ground
from ...core.surfaces.local_frames import frames_along, in_frames
from ...core.surfaces.quaternions import axes_of
from ...follow_nodes import (
    BY_PLACE,
    CORNER_ATTRIBUTES,
    NOT_AT_ALL,
    SHIFT_ATTRIBUTE,
    WEIGHTS_ATTRIBUTE,
    X_ATTRIBUTE,
    Z_ATTRIBUTE,
    Host,
    Known,
    set_following,
)
from ..inputs.mesh_in import mesh_of, read_vertex_normals, scale_of
from ..tokens import NAME, ROLE
from .out_attributes import set_attribute
from .out_collection import KEEPER_ENDING, find_output, mark, remove_object
from .rest_places import Rest, read_rest, write_rest

# Of the surface's extent: points nearer to it are on it, since Blender's single precision cannot tell.
ON_SURFACE = 1e-7


class Follower:
    """Knows the surface that one run was made on, and lets what was made of it follow."""

    def __init__(
        self, context: bpy.types.Context, source: bpy.types.Object, surface: Surface, use_modifiers: bool
    ) -> None:
        self._context, self._source, self._surface, self._use_modifiers = context, source, surface, use_modifiers

    @cached_property
    def _rest(self) -> Rest:
        return read_rest(self._context, self._source, self._use_modifiers, self._surface.vertex_count)

    @cached_property
    def _ground(self) -> Ground:
        return Ground(self._surface, mesh_of_surface(self._surface, runs.new_progress(), cache.shared))

    def read(self) -> None:
        """Reads what outputs that stand off the surface, or are turned, need; before the first of several is made."""
        _ = self._rest, self._normals

    def take(
        self,
        item: bpy.types.Object,
        place: Matrix,
        points: Reals,
        feet: Reals | None = None,
        rotations: Reals | None = None,
    ) -> None:
        """Lets an output follow whose points (n, 3) stand on the surface at their `feet` (n, 3).

        `place` is the world matrix that the output was made for, and `rotations` (n, 3) are the Euler angles of what is
        put on the points.
        """
        self.take_anchored(item, place, self._ground.anchors(points, feet, runs.new_progress()), rotations)

    def take_all(self, item: bpy.types.Object, place: Matrix) -> None:
        """Lets a copy of the surface follow, vertex by vertex."""
        count = self._surface.vertex_count
        corners = np.repeat(np.arange(count, dtype=np.int32)[:, None], 3, axis=1)
        self.take_anchored(item, place, Anchors(corners, np.tile([1.0, 0.0, 0.0], (count, 1)), np.zeros((count, 3))))

    def take_anchored(
        self, item: bpy.types.Object, place: Matrix, anchors: Anchors, rotations: Reals | None = None
    ) -> None:
        """Does the same where it is known where the points stand."""
        extent = float(np.ptp(self._surface.vertices, axis=0).max())
        is_shifted = bool(np.abs(anchors.offset).max(initial=0.0) > ON_SURFACE * extent)
        vectors = {SHIFT_ATTRIBUTE: anchors.offset} if is_shifted else {}
        if rotations is not None:
            vectors |= zip((X_ATTRIBUTE, Z_ATTRIBUTE), axes_of(rotations), strict=True)
        # All that is read, before anything is written: Blender would evaluate what was made so far each time.
        rest, seen = self._rest, self._seen(anchors, vectors) if vectors else {}
        _remove_keeper(self._source, item)
        keeper = _new_keeper(self._source, item, len(anchors.corners)) if item.type == "CURVE" else None
        self._write(item.data if keeper is None else keeper.data, anchors, seen)
        known = Known(is_shifted, rotations is not None, keeper)
        host = Host.of(self._source, place, self._surface.vertex_count, rest.otherwise, rest.area, rest.places)
        set_following(item, host, known)

    def _write(self, mesh: bpy.types.Mesh, anchors: Anchors, vectors: dict[str, Reals]) -> None:
        """Gives a mesh's vertices what the node group asks for: where they stand, and vectors as seen from there."""
        for i, name in enumerate(CORNER_ATTRIBUTES):
            set_attribute(mesh, name, "POINT", np.ascontiguousarray(anchors.corners[:, i]))
        set_attribute(mesh, WEIGHTS_ATTRIBUTE, "POINT", anchors.barycentric)
        for name, values in vectors.items():
            set_attribute(mesh, name, "POINT", values)
        if self._rest.places is not None and self._rest.otherwise == BY_PLACE:
            write_rest(mesh, self._rest.places, anchors.corners, anchors.barycentric, bool(vectors))

    def _seen(self, anchors: Anchors, vectors: dict[str, Reals]) -> dict[str, Reals]:
        """Vectors (n, 3) by the axes of the surface where points stand, as the node group finds them."""
        seen, scale = {name: np.empty_like(values) for name, values in vectors.items()}, scale_of(self._source)
        for rows in blocks(len(anchors.corners)):
            corners = anchors.corners[rows]
            first, second = (self._surface.vertices[self._surface.compact(corners[:, i])] for i in range(2))
            normals = np.einsum("ni,nij->nj", anchors.barycentric[rows], self._normals[corners])
            frames = frames_along(second - first, normals @ np.linalg.inv(scale))
            for name, values in vectors.items():
                seen[name][rows] = in_frames(frames, values[rows])
        return seen

    @cached_property
    def _normals(self) -> Reals:
        """(V, 3) of the vertices of the mesh that was read, in the object's space."""
        with mesh_of(self._context, self._source, self._use_modifiers, has_layers=False) as mesh:
            return read_vertex_normals(mesh)

    def notes(self) -> list[str]:
        """Says in one sentence where following ends."""
        if "_rest" not in vars(self) or self._rest.otherwise != NOT_AT_ALL or not self._differs():
            return []
        kinds = ", ".join(sorted({modifier.name for modifier in self._source.modifiers}))
        return [
            f"'{self._source.name}': its modifiers repeat faces or make new ones ({kinds}), so where they make another "
            "number of vertices than now, as in the render, what was made of it stays where it is"
        ]

    def _differs(self) -> bool:
        """Tells whether the modifiers may make another number of vertices than now."""
        return self._rest.places is None or any(
            modifier.show_viewport != modifier.show_render
            or getattr(modifier, "levels", 0) != getattr(modifier, "render_levels", 0)
            for modifier in self._source.modifiers
        )


def _new_keeper(source: bpy.types.Object, item: bpy.types.Object, count: int) -> bpy.types.Object:
    """An object in no collection that knows where the points of a curve stand, which curves cannot."""
    mesh = bpy.data.meshes.new(f"{item.name} Anchors")
    mesh.vertices.add(count)
    keeper = bpy.data.objects.new(mesh.name, mesh)
    keeper[NAME] = keeper.name
    mark(keeper, source, item[ROLE] + KEEPER_ENDING)
    return keeper


def _remove_keeper(source: bpy.types.Object, item: bpy.types.Object) -> None:
    keeper = find_output(source, item[ROLE] + KEEPER_ENDING)
    if keeper is not None:
        remove_object(keeper)

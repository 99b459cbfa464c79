# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender mesh -> the arrays of a surface, as seen from where its object stands."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from ... import compat
from ...core.errors import BadInputError
from ...core.requests import Direction, Surface
from ...core.results import EdgeMarks, Indices, Reals
from ...core.solids.mesh_edges import edge_keys
from ...core.surfaces.parts import NO_EDGES, lonely_edge, part
from .evaluated import evaluated

NOISE_BITS = 46  # what is below so many of the largest number's is rounding
SCALE_DIGITS = 5  # that a scale has which somebody typed
SCALE_ROUNDING = 5e-7  # of the largest number of a transform, what Blender's single precision may leave


@contextmanager
def mesh_of(
    context: bpy.types.Context, source: bpy.types.Object, use_modifiers: bool, has_layers: bool = True
) -> Iterator[bpy.types.Mesh]:
    """The object's mesh, or with `use_modifiers` its evaluated one, to be read only inside the `with`.

    Without `has_layers` it has the shape for sure, and of vertex groups, UV maps and colors what is drawn: Blender
    evaluates all modifiers once more for the others.
    """
    if not use_modifiers:
        yield source.data
        return
    with modified(context, source, has_layers) as (_, mesh):
        yield mesh


@contextmanager
def modified(
    context: bpy.types.Context, item: bpy.types.Object, has_layers: bool = True
) -> Iterator[tuple[bpy.types.Object, bpy.types.Mesh]]:
    """The object and its mesh as evaluated, whether or not the view layer shows it; to be read inside the `with`."""
    with evaluated(context, [item]) as (shown,):
        mesh = shown.to_mesh(preserve_all_data_layers=has_layers, depsgraph=context.evaluated_depsgraph_get())
        try:
            yield shown, mesh
        finally:
            shown.to_mesh_clear()


def read_surface(
    source: bpy.types.Object,
    mesh: bpy.types.Mesh,
    check: bool = True,
    is_inside: NDArray[np.bool_] | None = None,
    barriers: Indices = NO_EDGES,
) -> Surface:
    """The surface of `mesh` as `source` scales it, seen from `level_place`: polygons are cut into triangles.

    So it is the same to the bit wherever the object stands and however it is turned, and so is what is made of it.
    With `is_inside` (polygons,) it is a part of that, and it is parted along `barriers` (n, 2), edges of the mesh.
    Raises BadInputError for a mesh without faces, a barrier that parts nothing and, with `check`, for coordinates that
    are not finite.
    """
    vertices = scaled(source, compat.read_positions(mesh))
    if check and not np.isfinite(vertices).all():
        vertex = int(np.nonzero(~np.isfinite(vertices).all(axis=1))[0][0])
        raise BadInputError(f"'{source.name}': vertex {vertex} is not at a finite place; delete it or press Repair")
    triangles = read_triangles(mesh)
    if not len(triangles):
        if mesh != source.data and len(source.data.polygons):
            raise BadInputError(
                f"'{source.name}' has no faces as its modifiers leave it; where Geometry Nodes make instances, let "
                "them end with Realize Instances"
            )
        raise BadInputError(f"'{source.name}' has no faces; choose an object with a surface")
    if source.matrix_world.determinant() < 0:  # a mirrored object shows its faces from the other side
        triangles = np.ascontiguousarray(triangles[:, ::-1])
    count, kept, copied = len(vertices), None, np.empty(0, np.int32)
    if is_inside is not None:
        kept = np.flatnonzero(is_inside[read_triangle_polygons(mesh)]).astype(np.int32)
        triangles = triangles[kept]
    lonely = lonely_edge(triangles, count, barriers) if len(barriers) else None
    if lonely is not None:
        raise BadInputError(
            f"'{source.name}': the barrier from vertex {lonely[0]} to {lonely[1]} is a single edge, which parts "
            "nothing; mark an edge beside it, too"
        )
    if is_inside is not None or len(barriers):
        triangles, copied = part(triangles, count, barriers)
    used, triangles = _compact(triangles, count + len(copied))
    if len(copied):
        used = np.concatenate([np.arange(count, dtype=np.int32), copied])[slice(None) if used is None else used]
    return Surface(source.name, vertices if used is None else vertices[used], triangles, count, used, kept)


def read_triangles(mesh: bpy.types.Mesh) -> Indices:
    """(F, 3) vertices of the mesh's triangles, polygons cut as Blender draws them."""
    if len(mesh.loops) == 3 * len(mesh.polygons) and _all_triangles(mesh):
        return compat.read_corner_vertices(mesh).reshape(-1, 3)
    mesh.calc_loop_triangles()
    return compat.read_numbers(mesh.loop_triangles, "vertices", 3).reshape(-1, 3)


def read_triangle_polygons(mesh: bpy.types.Mesh) -> Indices:
    """(F,) polygon that each triangle of `read_triangles` is part of."""
    mesh.calc_loop_triangles()
    return compat.read_numbers(mesh.loop_triangles, "polygon_index")


def read_marks(mesh: bpy.types.Mesh) -> EdgeMarks:
    """The edges that are marked sharp or as seams, or creased."""
    sharp, seam = (np.empty(len(mesh.edges), np.bool_) for _ in range(2))
    mesh.edges.foreach_get("use_edge_sharp", sharp)
    mesh.edges.foreach_get("use_seam", seam)
    crease = compat.read_creases(mesh).astype(np.float64)
    marked = sharp | seam | (crease > 0.0)
    return EdgeMarks(compat.read_edge_vertices(mesh)[marked], sharp[marked], seam[marked], crease[marked])


def write_marks(mesh: bpy.types.Mesh, marks: EdgeMarks) -> None:
    """Marks the edges between the vertices of a mesh that has its edges; those that it has not are left out."""
    ends, count = compat.read_edge_vertices(mesh), len(mesh.vertices)
    keys = edge_keys(ends[:, 0], ends[:, 1], count)
    order = np.argsort(keys)
    wanted = edge_keys(marks.edges[:, 0], marks.edges[:, 1], count)
    place = order[np.minimum(np.searchsorted(keys, wanted, sorter=order), len(keys) - 1)]
    there = keys[place] == wanted
    for name, values in (("use_edge_sharp", marks.sharp), ("use_seam", marks.seam)):
        written = np.zeros(len(keys), np.bool_)
        written[place[there]] = values[there]
        mesh.edges.foreach_set(name, written)
    if (marks.crease > 0.0).any():
        creases = np.zeros(len(keys), np.float32)
        creases[place[there]] = marks.crease[there]
        compat.write_creases(mesh, creases)


def read_vertex_normals(mesh: bpy.types.Mesh) -> Reals:
    """(V, 3) unit normals of the shape, whatever an artist made of them: from 4.5 on Blender's own tell that."""
    flat = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("normal", flat)
    if not mesh.has_custom_normals:
        return flat.reshape(-1, 3).astype(np.float64)
    count, vertices = compat.read_numbers(mesh.polygons, "loop_total"), compat.read_corner_vertices(mesh)
    size, first = np.repeat(count, count), np.repeat(compat.read_numbers(mesh.polygons, "loop_start"), count)
    step = np.arange(len(first)) - np.repeat(np.cumsum(count) - count, count)
    places = compat.read_positions(mesh).astype(np.float64)[vertices]
    sides = [_unit(places[first + (step + way) % size] - places[first + step]) for way in (1, -1)]
    angle = np.arccos(np.clip(np.einsum("ij,ij->i", *sides), -1.0, 1.0))
    faces = np.empty(3 * len(mesh.polygons), np.float32)
    mesh.polygons.foreach_get("normal", faces)
    normals = np.zeros((len(mesh.vertices), 3))
    np.add.at(normals, vertices[first + step], angle[:, None] * np.repeat(faces.reshape(-1, 3), count, axis=0))
    return _unit(normals)


def _unit(vectors: Reals) -> Reals:
    units: Reals = vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), np.finfo(np.float64).tiny)
    return units


def level_place(source: bpy.types.Object) -> Matrix:
    """The source's place and turn without its scale: from here surfaces are seen, and round tubes stay round."""
    location, rotation, _ = source.matrix_world.decompose()
    place: Matrix = Matrix.Translation(location) @ rotation.to_matrix().to_4x4()
    return place


def scale_of(source: bpy.types.Object) -> Reals:
    """(3, 3) what the object's transform does to its mesh beside `level_place`: scale, and the shear of parents.

    Blender's matrices are rounded to single precision, each turn to others. Within that these are numbers of few digits
    where they are it, or else the object's own scale where no parent has one.
    """
    matrix, place = (np.array(matrix, np.float64)[:3, :3] for matrix in (source.matrix_world, level_place(source)))
    scale: Reals = np.asarray(np.linalg.solve(place, matrix), np.float64)
    largest = float(np.abs(scale).max())
    if not 0.0 < largest < np.inf:
        return scale
    digits = SCALE_DIGITS - math.ceil(math.log10(largest))
    own: Reals = np.diag(np.copysign(np.array(source.scale, np.float64), np.diag(scale)))
    for exact in (np.round(scale, digits) + 0.0, own):
        if np.abs(exact - scale).max() <= SCALE_ROUNDING * largest:
            return exact
    return scale


def scaled(source: bpy.types.Object, positions: NDArray[np.floating]) -> Reals:
    """(n, 3) positions in the object's space -> as its surface has them, in double precision."""
    places: Reals = positions.astype(np.float64) @ scale_of(source).T
    return places


def unscaled(source: bpy.types.Object, points: Reals) -> Reals:
    """(n, 3) points of the surface -> the object's own space."""
    frame = np.eye(4)
    frame[:3, :3] = scale_of(source)
    return _seen_from(frame, points)


def to_world(item: bpy.types.Object, positions: NDArray[np.floating]) -> Reals:
    """(n, 3) positions in an object's space -> the world, in double precision."""
    matrix = np.array(item.matrix_world, np.float64)
    return positions.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]


def seen_by(source: bpy.types.Object, points: Reals) -> Reals:
    """(n, 3) places in the world -> as the object's surface has them."""
    return _seen_from(np.array(level_place(source), np.float64), points)


def world_axes(source: bpy.types.Object) -> Reals:
    """(3, 3) rows are the axes of the world as the object's surface has them."""
    return np.array(level_place(source), np.float64)[:3, :3]


def up_of(source: bpy.types.Object) -> Direction:
    """The world's Z as the object's surface has it."""
    x, y, z = world_axes(source)[2].tolist()
    return x, y, z


def _seen_from(frame: Reals, points: NDArray[np.floating]) -> Reals:
    """Positions (n, 3) as seen from a frame (4, 4), without the noise of rounding.

    So what lies at 0 is at 0, and what is mirrored there is so in single precision to the bit.
    """
    inverse = np.linalg.inv(frame)
    seen: Reals = points @ inverse[:3, :3].T + inverse[:3, 3]
    size = np.abs(inverse[:3, :3]).max() * max(np.abs(points).max(initial=0.0), np.abs(frame[:3, 3]).max())
    if not 0.0 < size < np.inf:
        return seen
    noise = 2.0 ** (np.floor(np.log2(size)) - NOISE_BITS)
    return np.asarray(np.rint(seen / noise) * noise)


def _all_triangles(mesh: bpy.types.Mesh) -> bool:
    return bool((compat.read_numbers(mesh.polygons, "loop_total") == 3).all())


def _compact(triangles: Indices, vertex_count: int) -> tuple[Indices | None, Indices]:
    """Drops the numbers that no triangle uses: (n,) old number of each vertex left, or None when all are; triangles."""
    is_used = np.zeros(vertex_count, bool)
    is_used[triangles.ravel()] = True
    if is_used.all():
        return None, triangles
    used = np.nonzero(is_used)[0].astype(np.int32)
    numbers = np.cumsum(is_used, dtype=np.int32) - np.int32(1)
    return used, numbers[triangles]

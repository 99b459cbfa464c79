# SPDX-License-Identifier: MIT
"""Metrics of a surface's own, for `Mesh(..., lengths=)`: of cells stretched along a field, or small where it bends."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from saddleback._arrays import real, reals
from saddleback._saddleback import DirectionField, InputError, Mesh, vertex_normals

_Floats = NDArray[np.float64]

# A face that has less than this share of the area it was to have is mended: cells are as large as areas say.
_LEAST_AREA = 0.5
_STEP = 0.125  # by which edges of such faces go back to what they are in space


def anisotropic_metric(
    mesh: Mesh, field: DirectionField | ArrayLike, stretch: ArrayLike, density: ArrayLike | None = None
) -> _Floats:
    """Lengths by which round cells are, in space, so many times as long along a field as they are wide.

    ``sb.Mesh(mesh.vertices, mesh.triangles, lengths=sb.anisotropic_metric(mesh, field, 3))`` has the same points, by
    face and barycentric coordinates, and areas about the same. Cells, sites and graphs of it are those of the metric.

    Args:
        mesh: as it is in space.
        field: of that mesh, of symmetry 1 or 2; or (F, 3) a vector for each face, of which the part within the face
            counts; where it is zero, nothing is stretched.
        stretch: > 0, one for all or (V,): 5 makes cells five times as long along the field, 0.2 across it.
        density: (V,) wanted number of cells per area; only ratios matter. None for the same everywhere.

    Returns
    -------
        (F, 3) float64: lengths from corner i to corner i + 1.

    Raises
    ------
        InputError: shapes that do not fit, a stretch or density that is not positive and finite, a field of symmetry
        4, a mesh that has lengths of its own.

    Notes
    -----
    Each edge has the root of the mean of the squares of its lengths in the metrics of its two faces. Squared lengths of
    triangles are a convex cone: where the field turns so fast that three of these are no triangle's, or one of less
    than half of its area, they are mixed with those of space, step by step, until they are. O(F), a few rounds.
    """
    if mesh.is_intrinsic:
        raise InputError("mesh: a field stretches lengths of space, but this mesh has lengths of its own")
    vectors = _vectors(mesh, field)
    stretches = _at_corners(mesh, stretch, "stretch").mean(axis=1)
    densities = np.ones((mesh.face_count, 3)) if density is None else _at_corners(mesh, density, "density")
    scale = mesh.face_areas @ densities.mean(axis=1) / mesh.area

    corners = mesh.vertices[mesh.triangles]
    sides = np.roll(corners, -1, axis=1) - corners
    in_space = np.einsum("fij,fij->fi", sides, sides)
    along = np.einsum("fij,fj->fi", sides, vectors) ** 2
    stretches[~vectors.any(axis=1)] = 1
    of_ends = (densities + np.roll(densities, -1, axis=1)) / (2 * scale)
    wanted = of_ends * (along / stretches[:, None] + (in_space - along) * stretches[:, None])

    edge, count = _edges_of_sides(mesh)
    shared = np.bincount(edge.ravel())

    def of_edges(values: _Floats) -> _Floats:
        mean: _Floats = np.bincount(edge.ravel(), values.ravel()) / shared
        return mean

    wanted, plain, mixed = of_edges(wanted), of_edges(in_space), np.zeros(count)
    areas = mesh.face_areas * densities.mean(axis=1) / scale
    while True:
        squares = ((1 - mixed) * wanted + mixed * plain)[edge]
        small = _sixteen_squared_areas(squares) < (4 * _LEAST_AREA * areas) ** 2
        small &= (mixed[edge] < 1).any(axis=1)
        if not small.any():
            lengths: _Floats = np.sqrt(squares)
            return lengths
        again = np.unique(edge[small])
        mixed[again] = np.minimum(1, mixed[again] + _STEP)


def curvature_metric(mesh: Mesh, weight: float = 0.1) -> _Floats:
    """Lengths by which round cells are, in space, small where the surface bends, and long where it bends one way only.

    With ``sb.Mesh(mesh.vertices, mesh.triangles, lengths=sb.curvature_metric(mesh))`` a dual mesh of so many vertices
    is nearer to the surface than one of even triangles, twice to three times on usual scans.

    Args:
        mesh: as it is in space.
        weight: >= 0, of the normals: what a turn by a radian counts as, in parts of the root of the mesh's area. 0 for
            the lengths of space; beyond some 0.3 flat parts have too few cells.

    Returns
    -------
        (F, 3) float64: lengths from corner i to corner i + 1.

    Raises
    ------
        InputError: a weight that is negative or not finite, a mesh that has lengths of its own.

    Notes
    -----
    The lengths of the surface of places and weighted normals in six dimensions [levy2013]; normals are the vertices',
    weighted by area. O(F).
    """
    if mesh.is_intrinsic:
        raise InputError("mesh: normals are those of space, but this mesh has lengths of its own")
    weight = real(weight, "weight")
    if not 0 <= weight < np.inf:
        raise InputError(f"weight: wanted 0 or more, got {weight}")
    normals = weight * np.sqrt(mesh.area) * vertex_normals(mesh.vertices, mesh.triangles)
    corners = np.concatenate([mesh.vertices, normals], axis=1)[mesh.triangles]
    lengths: _Floats = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    return lengths


def _sixteen_squared_areas(squares: _Floats) -> _Floats:
    """Of faces by their squared sides; negative where there is no such triangle."""
    result: _Floats = squares.sum(axis=1) ** 2 - 2 * (squares**2).sum(axis=1)
    return result


def _edges_of_sides(mesh: Mesh) -> tuple[NDArray[np.intp], int]:
    """(F, 3) the edge of each side, and how many edges there are."""
    ends = np.stack([mesh.triangles, np.roll(mesh.triangles, -1, axis=1)], axis=2).astype(np.int64)
    ends.sort(axis=2)
    keys, edge = np.unique((ends[..., 0] * mesh.vertex_count + ends[..., 1]).ravel(), return_inverse=True)
    return edge.reshape(-1, 3), len(keys)


def _vectors(mesh: Mesh, field: DirectionField | ArrayLike) -> _Floats:
    """(F, 3) unit vectors within the faces, zero where there are none."""
    if isinstance(field, DirectionField):
        if field.symmetry == 4:
            raise InputError("field: of symmetry 4, along which of its two lines shall cells be long? Use 1 or 2")
        field = field.vectors
    vectors = reals(field, "field")
    if vectors.shape != (mesh.face_count, 3):
        raise InputError(f"field: wanted shape ({mesh.face_count}, 3), got {vectors.shape}")
    if not np.isfinite(vectors).all():
        raise InputError(
            f"field: the vector of face {np.flatnonzero(~np.isfinite(vectors).all(axis=1))[0]} is not finite"
        )
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    within = vectors - np.einsum("fj,fj->f", vectors, normals)[:, None] * normals
    size = np.linalg.norm(within, axis=1, keepdims=True)
    return np.where(size > 1e-9 * np.linalg.norm(vectors, axis=1, keepdims=True), within / np.maximum(size, 1e-300), 0)


def _at_corners(mesh: Mesh, values: ArrayLike, name: str) -> _Floats:
    """(F, 3) values at the corners of one for all or of (V,), which must be positive."""
    given = reals(values, name)
    if given.shape not in ((), (mesh.vertex_count,)):
        raise InputError(f"{name}: wanted one number or shape ({mesh.vertex_count},), got {given.shape}")
    everywhere = np.broadcast_to(given, mesh.vertex_count)
    wrong = np.flatnonzero(~((everywhere > 0) & np.isfinite(everywhere)))
    if len(wrong):
        raise InputError(f"{name}: wanted positive numbers, got {everywhere[wrong[0]]} at [{wrong[0]}]")
    return everywhere[mesh.triangles]

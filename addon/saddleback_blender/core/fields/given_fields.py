# SPDX-License-Identifier: GPL-3.0-or-later
"""Vector attributes and flow maps -> the library's field."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import native
from ..errors import BadInputError
from ..requests import GivenDirections, Surface
from ..results import Indices, Reals

LEAST = 1e-6  # of the longest vector: shorter ones are no direction


def given_field(surface: Surface, given: GivenDirections, mesh: Any) -> Any:
    """The field of the vectors; faces without one are told. Raises BadInputError."""
    within, bad = _within_faces(surface, given, mesh)
    if bad.any():
        raise BadInputError(
            f"'{surface.name}': {given.label} has no direction along the surface on {int(bad.sum())} of {len(bad)} "
            "faces; fill it, or let the Direction Field panel make the field"
        )
    return native.load().DirectionField.from_vectors(mesh, within, given.symmetry)


def painted_directions(surface: Surface, given: GivenDirections, mesh: Any) -> Reals:
    """(F, 3) the vectors along the faces, zero where there is none. Raises BadInputError where there is none at all."""
    within, bad = _within_faces(surface, given, mesh)
    if bad.all():
        raise BadInputError(
            f"'{surface.name}': {given.label} has no direction along the surface anywhere; paint some, or choose None"
        )
    within[bad] = 0.0
    return within


def _within_faces(surface: Surface, given: GivenDirections, mesh: Any) -> tuple[Reals, NDArray[np.bool_]]:
    """(F, 3) the vectors' parts within the faces, and where these are no direction."""
    vectors = _of_faces(surface, given, mesh)
    normals = _face_normals(mesh)
    within: Reals = vectors - np.einsum("ij,ij->i", vectors, normals)[:, None] * normals
    lengths = np.linalg.norm(within, axis=1)
    usable = np.isfinite(lengths)
    longest = float(lengths[usable].max(initial=0.0))
    return within, ~usable | ~(lengths > LEAST * max(longest, 1e-30))


def _of_faces(surface: Surface, given: GivenDirections, mesh: Any) -> Reals:
    """(F, 3): a polygon's own, or the mean of the corners' as far as the symmetry lets them agree."""
    if given.polygons is not None:
        polygons = given.polygons if surface.kept is None else given.polygons[surface.kept]
        polygon_vectors: Reals = given.vectors[polygons]
        return polygon_vectors
    corners = given.vectors if surface.used is None else given.vectors[surface.used]
    triangles, normals, n = mesh.triangles, _face_normals(mesh), given.symmetry
    vertices = mesh.vertices
    x = vertices[triangles[:, 1]] - vertices[triangles[:, 0]]
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    y = np.cross(normals, x)
    total = np.zeros(len(triangles), complex)
    for i in range(3):
        vector = corners[triangles[:, i]]
        number = np.einsum("ij,ij->i", vector, x) + 1j * np.einsum("ij,ij->i", vector, y)
        length = np.abs(number)
        unit = np.divide(number, length, out=np.zeros_like(number), where=length > 0)
        total += length * unit**n
    angle = np.angle(total) / n
    found: Reals = np.abs(total)[:, None] * (np.cos(angle)[:, None] * x + np.sin(angle)[:, None] * y)
    return found


def _face_normals(mesh: Any) -> Reals:
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    units: Reals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    return units


def corner_directions(surface: Surface, given: GivenDirections) -> Reals:
    """(3 F, 3) the vectors at the corners of the surface's triangles."""
    if given.polygons is not None:
        polygons = given.polygons if surface.kept is None else given.polygons[surface.kept]
        of_faces: Reals = np.repeat(given.vectors[polygons], 3, axis=0)
        return of_faces
    corners: Reals = given.vectors[_numbers(surface)[surface.triangles.ravel()]]
    return corners


def in_tangents(surface: Surface, uv: Reals, vectors: Reals) -> Reals:
    """Vectors (3 F, 3) at the corners by the axes of each triangle in the UV map (3 F, 2); zero where that has none."""
    axes = tangent_axes(surface.vertices[surface.triangles], uv)
    along: Reals = np.einsum("fij,fkj->fki", axes, vectors.reshape(-1, 3, 3)).reshape(-1, 3)
    return along


def flow_of_polygons(corners: Reals, uv: Reals, colors: Reals, polygons: Indices) -> Reals:
    """Vectors (polygons, 3) of a flow map: means over triangles with corners (F, 3, 3) at UV places (3 F, 2).

    Of the colors (3 F, 3 or more) red tells how far to the right along the UV map, green how far upwards, 0.5 being
    nowhere.
    """
    axes = tangent_axes(corners, uv)
    along = 2.0 * colors.reshape(len(corners), 3, -1)[:, :, :2].mean(axis=1) - 1.0
    sides = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    weights = np.linalg.norm(sides, axis=1)
    vectors = np.zeros((int(polygons.max(initial=-1)) + 1, 3))
    np.add.at(vectors, polygons, weights[:, None] * np.einsum("fi,fij->fj", along, axes[:, :2]))
    total = np.bincount(polygons, weights, len(vectors))
    means: Reals = np.divide(vectors, total[:, None], out=vectors, where=total[:, None] > 0)
    return means


def tangent_axes(corners: Reals, uv: Reals) -> Reals:
    """(F, 3, 3) unit axes of triangles (F, 3, 3) by a UV map (3 F, 2): to its right along the surface, upwards at right
    angles to that, out of the surface. Where the map has no area, zero.
    """
    places = uv.reshape(-1, 3, 2)
    (e, f), (p, q) = (np.moveaxis(sides[:, 1:] - sides[:, :1], 1, 0) for sides in (corners, places))
    normals, turn = np.cross(e, f), np.sign(p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])[:, None]
    right = turn * (q[:, 1:] * e - p[:, 1:] * f)
    up = turn * np.cross(normals, right)
    axes: Reals = np.stack([_units(right), _units(up), _units(normals) * np.abs(turn)], axis=1)
    return axes


def _units(vectors: Reals) -> Reals:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    units: Reals = np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0)
    return units


def _numbers(surface: Surface) -> Indices:
    return np.arange(surface.vertex_count, dtype=np.int32) if surface.used is None else surface.used

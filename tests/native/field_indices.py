# SPDX-License-Identifier: MIT
"""Indices of a field told from nothing but its vectors: the independent reference of the tests and the benchmark."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import saddleback as sb

Floats = NDArray[np.float64]
Indices = NDArray[np.int32]


def twins(triangles: Indices) -> Indices:
    """(F, 3): half-edge 3 f + i that runs against edge i of each face, -1 on the boundary."""
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    count = int(triangles.max()) + 1
    key, back = start.astype(np.int64) * count + end, end.astype(np.int64) * count + start
    order = np.argsort(key)
    place = np.minimum(np.searchsorted(key, back, sorter=order), len(key) - 1)
    found = order[place]
    return np.where(key[found] == back, found, -1).reshape(-1, 3).astype(np.int32)


def angles_to(mesh: sb.Mesh, vectors: Floats) -> Floats:
    """(F, 3): counter-clockwise angle from each edge of a face to its vector."""
    corners = mesh.vertices[mesh.triangles]
    edges = np.roll(corners, -1, axis=1) - corners
    normals = np.cross(edges[:, 0], -edges[:, 2])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    across = np.cross(normals[:, None], edges)
    return np.arctan2((across * vectors[:, None]).sum(axis=2), (edges * vectors[:, None]).sum(axis=2))


def turns(mesh: sb.Mesh, vectors: Floats, symmetry: int) -> Floats:
    """(F, 3): the least turning across each edge, outwards; 0 on the boundary."""
    angle, twin = angles_to(mesh, vectors), twins(mesh.triangles)
    other = angle.ravel()[twin] + np.pi  # the twin runs the other way
    quantum = 2 * np.pi / symmetry
    step = other - angle
    return np.where(twin >= 0, step - quantum * np.round(step / quantum), 0.0)


def index_sums(mesh: sb.Mesh, vectors: Floats, symmetry: int) -> Floats:
    """(V,): angle defect (on the boundary pi less the total angle) plus turning about each vertex, in full turns."""
    total = np.zeros(len(mesh.vertices))
    # Counter-clockwise about a vertex, faces are left across the edges that run into it.
    np.add.at(total, np.roll(mesh.triangles, -1, axis=1), turns(mesh, vectors, symmetry))
    full = np.full(len(mesh.vertices), 2 * np.pi)
    full[mesh.boundary_vertices] = np.pi
    return (total + full - mesh.total_angles) / (2 * np.pi)


def indices(mesh: sb.Mesh, vectors: Floats, symmetry: int) -> dict[int, float]:
    """Interior vertices of index other than 0."""
    sums = index_sums(mesh, vectors, symmetry)
    sums[mesh.boundary_vertices] = 0
    units = np.round(symmetry * sums)
    assert np.abs(symmetry * sums - units).max() < 1e-6
    return {int(v): float(units[v] / symmetry) for v in np.flatnonzero(units)}


def loop_indices(mesh: sb.Mesh, vectors: Floats, symmetry: int) -> list[float]:
    """Of each boundary loop: how often the field turns against it."""
    sums = index_sums(mesh, vectors, symmetry)
    return [float(np.round(symmetry * sums[loop].sum()) / symmetry) for loop in mesh.boundary_loops]


def euler_characteristic(mesh: sb.Mesh) -> int:
    return int(mesh.vertex_count - mesh.edge_count + mesh.face_count)

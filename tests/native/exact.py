# SPDX-License-Identifier: MIT
"""Exact geodesic distances by a library that is not ours: MMP as wrapped by pygeodesic."""

from __future__ import annotations

import numpy as np
import pygeodesic.geodesic as mmp
from numpy.typing import NDArray

import saddleback as sb


def exact_distances(mesh: sb.Mesh, vertex: int) -> NDArray[np.float64]:
    """Distance of every vertex from one vertex; inf where it cannot be reached."""
    algorithm = mmp.PyGeodesicAlgorithmExact(np.array(mesh.vertices), np.array(mesh.triangles))
    distances, _ = algorithm.geodesicDistances(np.array([vertex]))
    distances = np.array(distances)
    distances[distances > 1e9] = np.inf
    return distances


def with_vertex_at(mesh: sb.Mesh, point: sb.SurfacePoints) -> sb.Mesh:
    """The mesh with one face cut in three, so that a surface point becomes the last vertex."""
    face, center = int(point.faces[0]), len(mesh.vertices)
    a, b, c = mesh.triangles[face]
    triangles = np.delete(mesh.triangles, face, axis=0)
    return sb.Mesh(
        np.vstack([mesh.vertices, point.positions(mesh)]),
        np.vstack([triangles, [[a, b, center], [b, c, center], [c, a, center]]]),
    )


def random_points(mesh: sb.Mesh, count: int, seed: int = 0) -> sb.SurfacePoints:
    """Points inside faces, without preference."""
    rng = np.random.default_rng(seed)
    weights = rng.dirichlet([1.0, 1.0, 1.0], count)
    return sb.SurfacePoints(rng.integers(len(mesh.triangles), size=count), weights)

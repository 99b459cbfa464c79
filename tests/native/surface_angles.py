# SPDX-License-Identifier: MIT
"""Checks of curves on a mesh that use nothing but positions: straight across edges, legal at vertices."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

import saddleback as sb

Floats = NDArray[np.float64]


def corners_of(mesh: sb.Mesh, face: int, barycentric: Floats) -> list[int]:
    """The vertices of the smallest thing that holds the point: one vertex, the ends of an edge, or a whole face."""
    return [int(v) for v, weight in zip(mesh.triangles[face], barycentric, strict=True) if weight > 0]


def angle_between(a: Floats, b: Floats) -> float:
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))


class Fan:
    """The corners about a vertex, in order."""

    def __init__(self, mesh: sb.Mesh, vertex: int):
        self.mesh, self.vertex = mesh, vertex
        follows = {}
        for triangle in mesh.triangles[(mesh.triangles == vertex).any(axis=1)].tolist():
            i = triangle.index(vertex)
            follows[triangle[(i + 1) % 3]] = triangle[(i + 2) % 3]
        starts = set(follows) - set(follows.values())
        self.is_closed = not starts
        at = min(starts or follows)
        self.rim = [at]
        while at in follows:
            at = follows.pop(at)
            self.rim.append(at)
        spokes = mesh.vertices[self.rim] - mesh.vertices[vertex]
        corners = [angle_between(a, b) for a, b in itertools.pairwise(spokes)]
        self.polar = np.concatenate([[0.0], np.cumsum(corners)])

    @property
    def total(self) -> float:
        return float(self.polar[-1])

    def angle_of(self, around: list[int], direction: Floats) -> float:
        """Polar angle of a direction that lies in the face, or along the edge, of those rim vertices."""
        first = min(self.rim.index(v) for v in around)
        if len(around) == 2 and {self.rim[first], self.rim[first + 1]} != set(around):
            first = len(self.rim) - 2  # the corner between the last rim vertex and the first
        spoke = self.mesh.vertices[self.rim[first]] - self.mesh.vertices[self.vertex]
        return float(self.polar[first] + angle_between(spoke, direction))


def worst_bend(mesh: sb.Mesh, path: sb.GeodesicPath) -> float:
    """How far the path is from a geodesic, radians: its bend at edges, and at vertices what a side lacks of pi."""
    worst = 0.0
    points, surface = path.points, path.surface
    held = [
        corners_of(mesh, int(face), barycentric)
        for face, barycentric in zip(surface.faces, surface.barycentric, strict=True)
    ]
    for i in range(1, len(points) - 1):
        back, ahead = points[i - 1] - points[i], points[i + 1] - points[i]
        if len(held[i]) == 2:
            edge = mesh.vertices[held[i][1]] - mesh.vertices[held[i][0]]
            worst = max(worst, abs(angle_between(back, edge) + angle_between(ahead, edge) - np.pi))
        elif len(held[i]) == 1:
            fan = Fan(mesh, held[i][0])
            sides = [
                fan.angle_of(sorted(set(held[j]) - set(held[i]))[:2], direction)
                for j, direction in ((i - 1, back), (i + 1, ahead))
            ]
            turn = abs(sides[0] - sides[1])
            lacking = [np.pi - turn] if not fan.is_closed else [np.pi - turn, np.pi - (fan.total - turn)]
            worst = max(worst, *lacking)
        else:
            worst = np.inf  # a bend inside a face
    return worst

# SPDX-License-Identifier: MIT
"""Surfaces and shapes to lay on them, and what is asked of copies that lie there."""

from __future__ import annotations

import functools

import numpy as np

import saddleback as sb
from tests import meshes

STAR, NEEDLE, DISK, CRESCENT = sb.Shape.star(), sb.Shape.needle(6), sb.Shape.disk(24), sb.Shape.crescent(0.8, 0.4, 20)
SQUARE = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1.0]])
FRAME = sb.Shape([SQUARE * 0.7, SQUARE * 0.4])


@functools.cache
def plane(turning: bool = False) -> tuple[sb.Mesh, sb.DirectionField]:
    mesh = sb.Mesh(*meshes.grid(25, 25))
    return mesh, sb.direction_field(mesh, 1, {312: 2} if turning else {})


@functools.cache
def ring() -> tuple[sb.Mesh, sb.DirectionField]:
    mesh = sb.Mesh(*meshes.torus(60, 30))
    return mesh, sb.direction_field(mesh, 2, {100: 0.5, 900: -0.5})


def laid_flat(result: sb.Distribution, scale: float = 1.0) -> list[sb.Shape]:
    """The copies of a distribution on a plane, as shapes of that plane."""
    mesh, placements = result.mesh, result.placements
    places = placements.center.positions(mesh)[:, :2]
    corners = mesh.vertices[mesh.triangles[placements.center.faces]]
    edge = corners[:, 1] - corners[:, 0]
    angles = placements.angle + np.arctan2(edge[:, 1], edge[:, 0])
    shapes = [result.shapes[i].mirrored() if m else result.shapes[i] for i, m in zip(*_kinds(placements), strict=True)]
    return [
        shape.moved(size * scale, angle, place)
        for shape, size, angle, place in zip(shapes, placements.scale, angles, places, strict=True)
    ]


def _kinds(placements: sb.Placements) -> tuple[np.ndarray, np.ndarray]:
    return placements.shape, placements.mirrored


def collisions(shapes: list[sb.Shape]) -> int:
    boxes = [(np.concatenate(s.loops).min(axis=0), np.concatenate(s.loops).max(axis=0)) for s in shapes]
    return sum(
        shapes[i].overlaps(shapes[j])
        for i in range(len(shapes))
        for j in range(i)
        if (boxes[i][0] <= boxes[j][1]).all() and (boxes[j][0] <= boxes[i][1]).all()
    )


def same(a: sb.Distribution, b: sb.Distribution) -> bool:
    p, q = a.placements, b.placements
    return (
        np.array_equal(p.shape, q.shape)
        and np.array_equal(p.center.faces, q.center.faces)
        and np.array_equal(p.center.barycentric, q.center.barycentric)
        and np.array_equal(p.angle, q.angle)
        and np.array_equal(p.scale, q.scale)
        and np.array_equal(p.mirrored, q.mirrored)
    )


def at(points: sb.SurfacePoints, i: int) -> sb.SurfacePoints:
    return sb.SurfacePoints(points.faces[[i]], points.barycentric[[i]])


def angle_in_face(mesh: sb.Mesh, field: sb.DirectionField, point: sb.SurfacePoints) -> float:
    """The angle of a field's direction, as placements have it."""
    corners = mesh.vertices[mesh.triangles[point.faces[0]]]
    first = corners[1] - corners[0]
    normal = np.cross(first, corners[2] - corners[0])
    ahead = field.directions(point)[0]
    return float(np.arctan2(np.cross(normal, first) @ ahead / np.linalg.norm(normal), first @ ahead))


def fits(
    result: sb.Distribution, shape: int, point: sb.SurfacePoints, field: sb.DirectionField, larger: float
) -> bool | None:
    """Whether another copy of a class, turned as the field says and larger by a share, fits among those that lie there;
    None where it cannot be laid at all.
    """
    mesh, laid = result.mesh, result.placements
    size = laid.scale[laid.shape == shape][0]
    away = np.linalg.norm(laid.center.positions(mesh) - point.positions(mesh), axis=1)
    laid = laid[away < 1.2 * (size + laid.scale.max())]  # the circumradii are 1
    among = sb.Placements(
        np.append(laid.shape, shape),
        sb.SurfacePoints(
            np.append(laid.center.faces, point.faces), np.vstack([laid.center.barycentric, point.barycentric])
        ),
        np.append(laid.angle, angle_in_face(mesh, field, point)),
        np.append(laid.scale, (1 + larger) * size),
        np.append(laid.mirrored, False),
    )
    mapped = sb.map_shapes(mesh, result.shapes, among, result.field)
    return None if mapped.failures else bool(sb.check_distribution(mesh, mapped, samples=1).ok)

# SPDX-License-Identifier: MIT
"""Truths about meshes themselves: counts, areas, borders, normals, samples, nearest points, by plain numpy."""

from __future__ import annotations

import math
from collections import Counter
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

import saddleback as sb
from tests.truth.registry import guards

Floats = NDArray[np.float64]
Random = np.random.Generator


def edge_counts(triangles: NDArray[np.int32]) -> Counter[tuple[int, int]]:
    """How many triangles meet at each edge."""
    return Counter(
        (min(a, b), max(a, b)) for face in triangles.tolist() for a, b in zip(face, face[1:] + face[:1], strict=True)
    )


def face_area(corners: Floats) -> float:
    """By exact arithmetic, rounded once at the end."""
    a, b, c = ([Fraction(x) for x in corner] for corner in corners.tolist())
    u, v = ([q - p for p, q in zip(a, end, strict=True)] for end in (b, c))
    normal = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    size = max(map(abs, normal))
    return float(size) * math.sqrt(sum(float(x / size) ** 2 for x in normal)) / 2 if size else 0.0


def part_count(mesh: sb.Mesh) -> int:
    """By spreading the smaller number until nothing changes."""
    label = np.arange(len(mesh.vertices))
    while True:
        least = label[mesh.triangles].min(axis=1)
        before = label.copy()
        for corner in range(3):
            np.minimum.at(label, mesh.triangles[:, corner], least)
        if (label == before).all():
            return len(np.unique(label))


def distance_to_triangle(point: Floats, a: Floats, b: Floats, c: Floats) -> float:
    """From a point to a triangle: over the plane where the foot lies inside, else over the three sides."""
    normal = np.cross(b - a, c - a)
    size = normal @ normal
    inside = size > 0 and all(np.cross(q - p, point - p) @ normal >= 0 for p, q in ((a, b), (b, c), (c, a)))
    if inside:
        return float(abs((point - a) @ normal) / np.sqrt(size))
    best = np.inf
    for p, q in ((a, b), (b, c), (c, a)):
        side = q - p
        t = np.clip((point - p) @ side / max(side @ side, 1e-300), 0, 1)
        best = min(best, float(np.linalg.norm(point - p - t * side)))
    return best


@guards("Mesh")
def counts_and_areas(mesh: sb.Mesh, rng: Random) -> None:
    """Edges, areas, parts, borders and genus against plain counting."""
    counts = edge_counts(mesh.triangles)
    assert mesh.edge_count == len(counts)
    assert {tuple(edge) for edge in np.sort(mesh.edges, axis=1).tolist()} == set(counts)
    assert max(counts.values()) <= 2
    corners = mesh.vertices[mesh.triangles]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    areas = np.array([face_area(face) for face in corners])
    assert (abs(mesh.face_areas - areas) <= 1e-15 * longest**2 + 1e-14 * areas).all()
    assert abs(mesh.area - mesh.face_areas.sum()) <= 1e-12 * mesh.area
    assert mesh.component_count == part_count(mesh) == len(np.unique(mesh.components))
    on_border = {v for edge, count in counts.items() if count == 1 for v in edge}
    assert set(mesh.boundary_vertices.tolist()) == on_border
    assert mesh.is_closed == (not on_border)
    chi = mesh.vertex_count - mesh.edge_count + mesh.face_count
    assert chi == 2 * mesh.component_count - 2 * mesh.genus - len(mesh.boundary_loops)


@guards(
    "triangle_edges",
    "border_edges",
    "vertex_normals",
    "cell_boundary",
    "cell_boundary_distance",
    "refine_to_cell_boundary",
    "connected_parts",
)
def array_functions(mesh: sb.Mesh, rng: Random) -> None:
    """What is told of bare arrays, against plain counting."""
    counts = edge_counts(mesh.triangles)
    edges, _ = sb.triangle_edges(mesh.triangles, mesh.vertex_count)
    assert sorted(tuple(sorted(edge)) for edge in edges.tolist()) == sorted(counts)
    border = sb.border_edges(mesh.triangles, mesh.vertex_count)[0]
    assert {tuple(sorted(edge)) for edge in border.reshape(-1, 2).tolist()} == {e for e, n in counts.items() if n == 1}
    parts = sb.connected_parts(mesh.triangles, mesh.vertex_count)
    known = mesh.components[mesh.triangles[:, 0]]
    assert len(set(zip(parts.tolist(), known.tolist(), strict=True))) == len(set(known.tolist())) == parts.max() + 1
    normals = sb.vertex_normals(mesh.vertices, mesh.triangles)
    lengths = np.linalg.norm(normals, axis=1)
    assert np.isfinite(normals).all()
    assert ((abs(lengths - 1) < 1e-9) | (lengths == 0)).all()
    cells = rng.integers(0, 3, mesh.face_count).astype(np.int32)
    distance = sb.cell_boundary_distance(mesh.vertices, mesh.triangles, cells)
    assert (distance >= 0).all()
    fields = np.column_stack([mesh.vertices, np.zeros(mesh.vertex_count)])
    level = 0.5 * float(distance[np.isfinite(distance)].max(initial=1.0))
    if level > 0:
        refined, parts, owners = sb.refine_to_cell_boundary(fields, mesh.triangles, cells, [level], 0.2)
        np.testing.assert_array_equal(refined[: mesh.vertex_count, 3], distance)
        a, b, c = (refined[parts[:, i], :3] for i in range(3))
        areas = np.bincount(owners, np.linalg.norm(np.cross(b - a, c - a), axis=1), minlength=3)
        a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
        whole = np.bincount(cells, np.linalg.norm(np.cross(b - a, c - a), axis=1), minlength=3)
        np.testing.assert_allclose(areas, whole, rtol=1e-6)


@guards("sample", "SurfacePoints")
def samples(mesh: sb.Mesh, rng: Random) -> None:
    """Samples lie in their faces, the same for a seed."""
    seed = int(rng.integers(1 << 30))
    points = sb.sample(mesh, 20, seed=seed)
    again = sb.sample(mesh, 20, seed=seed)
    assert (points.faces == again.faces).all()
    assert (points.barycentric == again.barycentric).all()
    assert (points.barycentric >= 0).all()
    np.testing.assert_allclose(points.barycentric.sum(axis=1), 1, atol=1e-12)
    corners = mesh.vertices[mesh.triangles[points.faces]]
    expected = np.einsum("ni,nij->nj", points.barycentric, corners)
    np.testing.assert_allclose(points.positions(mesh), expected, atol=1e-12 * np.abs(mesh.vertices).max())


@guards("project", "SurfacePoints.positions")
def nearest_points(mesh: sb.Mesh, rng: Random) -> None:
    """`project` finds points as near as the nearest of all triangles."""
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    size = float(np.linalg.norm(high - low))
    xyz = low + (high - low) * rng.uniform(-0.5, 1.5, (3, 3))
    found = np.linalg.norm(sb.project(mesh, xyz).positions(mesh) - xyz, axis=1)
    for point, distance in zip(xyz, found, strict=True):
        truth = min(distance_to_triangle(point, *mesh.vertices[face]) for face in mesh.triangles)
        rounding = 1e-12 * (size + np.abs(mesh.vertices).max())
        assert abs(distance - truth) <= rounding, f"{distance} for {truth} from {point.tolist()}"


@guards("triangle_quality", "Quality")
def qualities(mesh: sb.Mesh, rng: Random) -> None:
    """Angles by the law of cosines, at any unit."""
    unit = 2.0 ** rng.integers(-300, 300)  # a power of two rounds no coordinate
    quality = sb.triangle_quality(mesh.vertices * unit, mesh.triangles)
    plain = sb.triangle_quality(mesh.vertices, mesh.triangles)
    np.testing.assert_allclose(quality.quality, plain.quality, rtol=1e-6, atol=1e-9)
    assert (plain.quality >= 0).all()
    assert (plain.quality <= 1 + 1e-12).all()
    assert (plain.least_angle <= np.pi / 3 + 1e-9).all()
    assert (plain.greatest_angle >= np.pi / 3 - 1e-9).all()

# SPDX-License-Identifier: MIT
"""Lines on surfaces, maps into the plane, curvature, distances between surfaces: closed forms and invariants."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

import saddleback as sb
from tests.truth.registry import guards
from tests.truth.surfaces import distance_to_triangle, edge_counts

Floats = NDArray[np.float64]
Random = np.random.Generator


def rotation(rng: Random) -> Floats:
    """A random one."""
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return q * np.sign(np.linalg.det(q))


def polyline_length(points: Floats) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def is_disk(mesh: sb.Mesh) -> bool:
    return mesh.component_count == 1 and len(mesh.boundary_loops) == 1 and mesh.genus == 0


def turns(uv: Floats, triangles: NDArray[np.int32]) -> list[int]:
    """The exact sign of each triangle's area."""
    signs = []
    for face in triangles:
        (ax, ay), (bx, by), (cx, cy) = ([Fraction(x) for x in uv[v].tolist()] for v in face)
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        signs.append((area > 0) - (area < 0))
    return signs


@guards("harmonic_map", "Chart", "Chart.locate", "Chart.places")
def disk_maps(mesh: sb.Mesh, rng: Random) -> None:
    """No face of a harmonic map flips, by exact sign; a chart finds its own corners' places again."""
    if not is_disk(mesh):
        return
    uv = sb.harmonic_map(mesh)
    assert set(turns(uv, mesh.triangles)) == {1}
    assert (np.hypot(*uv.T) <= 1 + 1e-12).all()
    chart = sb.Chart(mesh, uv)
    points = sb.sample(mesh, 5, seed=int(rng.integers(1 << 30)))
    places = np.einsum("ni,nij->nj", points.barycentric, uv[mesh.triangles[points.faces]])
    np.testing.assert_allclose(chart.places(points), places, atol=1e-12)


@guards("hausdorff_distance", "HausdorffDistance")
def distances_between_surfaces(mesh: sb.Mesh, rng: Random) -> None:
    """Against distances of samples to every triangle; a moved copy is at most as far as it was moved."""
    size = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    move = size * 10.0 ** rng.uniform(-6, 0) * rng.normal(size=3) / 2
    vertices = mesh.vertices @ rotation(rng).T if rng.random() < 0.3 else mesh.vertices + move
    if rng.random() < 0.3:
        vertices = mesh.vertices + size * 10.0 ** rng.uniform(-6, -2) * rng.normal(size=vertices.shape)
    moved, tolerance = sb.Mesh(vertices, mesh.triangles), 10.0 ** rng.uniform(-6, -2)
    result = sb.hausdorff_distance(mesh, moved, tolerance)
    slack = 1.001 * tolerance * float(np.linalg.norm(np.ptp(np.vstack([mesh.vertices, vertices]), axis=0)))
    samples = np.vstack([mesh.vertices[:4], sb.sample(mesh, 12, seed=1).positions(mesh)])
    least = max(min(distance_to_triangle(p, *vertices[face]) for face in mesh.triangles) for p in samples)
    assert result.from_first >= least - slack
    assert result.distance == max(result.from_first, result.from_second)
    bound = np.linalg.norm(vertices - mesh.vertices, axis=1).max()
    assert result.distance <= bound * (1 + 1e-9) + 1e-12 * np.abs(vertices).max()


@guards("principal_curvatures", "density_by_curvature")
def curvatures(mesh: sb.Mesh, rng: Random) -> None:
    """Finite; they turn with the surface and fall with its size."""
    smallest, largest, direction = sb.principal_curvatures(mesh)
    assert np.isfinite([smallest, largest]).all()
    assert np.isfinite(direction).all()
    assert (smallest <= largest).all()
    np.testing.assert_allclose(np.linalg.norm(direction, axis=1), 1, atol=1e-9)
    scale = 2.0 ** rng.integers(-20, 20)
    scaled = sb.Mesh(mesh.vertices * scale, mesh.triangles)
    np.testing.assert_allclose(np.array(sb.principal_curvatures(scaled)[:2]) * scale, [smallest, largest], rtol=1e-9)
    density = sb.density_by_curvature(mesh)
    assert np.isfinite(density).all()
    assert (density > 0).all()
    np.testing.assert_allclose(sb.density_by_curvature(scaled), density, rtol=1e-9)


@guards("feature_curves", "SurfaceCurve")
def feature_lines(mesh: sb.Mesh, rng: Random) -> None:
    """The edges that bend by more than the angle, each once, in curves as long as their polylines; with a least length,
    those that hang together with so much, and the border.
    """
    angle = float(rng.uniform(0.1, 3.0))
    p = mesh.vertices[mesh.triangles]
    normals = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    faces: dict[tuple[int, int], list[int]] = {}
    for face, corners in enumerate(mesh.triangles.tolist()):
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
            faces.setdefault((min(a, b), max(a, b)), []).append(face)
    bends = {
        edge: np.arctan2(np.linalg.norm(np.cross(normals[f[0]], normals[f[1]])), normals[f[0]] @ normals[f[1]])
        for edge, f in faces.items()
        if len(f) == 2
    }
    wanted = {edge for edge, bend in bends.items() if bend > angle + 1e-6}
    possible = wanted | {edge for edge, bend in bends.items() if bend > angle - 1e-6}
    border = {edge for edge, count in edge_counts(mesh.triangles).items() if count == 1}
    found = feature_edges(mesh, sb.feature_curves(mesh, angle))
    assert len(found) == len(set(found))
    assert wanted | border <= set(found) <= possible | border
    lengths = {edge: float(np.linalg.norm(np.subtract(*mesh.vertices[list(edge)]))) for edge in found}
    least = float(rng.uniform(0, 4)) * mesh.mean_edge_length
    kept = set(feature_edges(mesh, sb.feature_curves(mesh, angle, least_length=least)))
    assert border <= kept <= set(found)
    for network in connected(found):
        total = sum(lengths[edge] for edge in network)
        if abs(total - least) > 1e-9 * least:
            assert network - border <= kept if total > least else not (network - border) & kept


def connected(edges: list[tuple[int, int]]) -> list[set[tuple[int, int]]]:
    """The edges by what hangs together."""
    left, networks = set(edges), []
    while left:
        network, ends = set(), set(next(iter(left)))
        while more := {edge for edge in left if ends & set(edge)}:
            network |= more
            left -= more
            ends |= {vertex for edge in more for vertex in edge}
        networks.append(network)
    return networks


def feature_edges(mesh: sb.Mesh, curves: list[sb.SurfaceCurve]) -> list[tuple[int, int]]:
    """The edges of curves along them, each by its vertices; lengths are those of the edges."""
    found: list[tuple[int, int]] = []
    for curve in curves:
        corners = mesh.triangles[curve.points.faces, curve.points.barycentric.argmax(axis=1)]
        assert (curve.points.barycentric.max(axis=1) == 1).all()
        steps = list(pairwise(corners))
        if curve.closed and corners[0] != corners[-1]:
            steps.append((corners[-1], corners[0]))
        found += [(min(a, b), max(a, b)) for a, b in ((int(a), int(b)) for a, b in steps)]
        length = sum(float(np.linalg.norm(mesh.vertices[a] - mesh.vertices[b])) for a, b in steps)
        assert abs(curve.length - length) <= 1e-12 * length
    return found


@guards("streamline", "Streamline")
def lines_along_fields(mesh: sb.Mesh, rng: Random) -> None:
    """A line follows its field in every face, and is as long as its polyline and no longer than asked for."""
    field = sb.direction_field(mesh, int(rng.choice([1, 2, 4])))
    start = sb.sample(mesh, 1, seed=int(rng.integers(1 << 30)))
    length = float(mesh.mean_edge_length * rng.uniform(0.1, 4))
    line = sb.streamline(mesh, field, start, length)
    assert abs(line.length - polyline_length(line.points)) <= 1e-9 * max(length, line.length)
    rounding = 1e-9 * np.abs(mesh.vertices).max()
    assert line.length <= length * (1 + 1e-9) + rounding
    np.testing.assert_allclose(line.surface.positions(mesh), line.points, atol=rounding)


@guards("blend_by_distance", "ramp_by_distance", on="nothing")
def values_by_distance(rng: Random) -> None:
    """Blends stay within their values and meet them at the sources; ramps go from one value to the other."""
    distances, values = rng.random((3, 20)), rng.normal(size=3)
    distances[1, 4] = 0.0
    blend = sb.blend_by_distance(distances, values)
    assert (blend >= values.min() - 1e-12).all()
    assert (blend <= values.max() + 1e-12).all()
    assert abs(blend[4] - values[1]) <= 1e-12
    ramp = sb.ramp_by_distance(np.array([0.0, 0.3, 1.0, np.inf]), values[0], values[1], 1.0)
    np.testing.assert_allclose(ramp[[0, 2, 3]], values[[0, 1, 1]], atol=1e-12)


@guards("cut_at_level")
def level_cuts(mesh: sb.Mesh, rng: Random) -> None:
    """Both sides together are the whole surface, and none crosses the level."""
    height = mesh.vertices @ rng.normal(size=3)
    fields = np.column_stack([mesh.vertices, height])
    level = float(rng.choice([np.median(height), rng.uniform(height.min(), height.max()), height[0]]))
    cut, triangles, parents, aboves = sb.cut_at_level(fields, mesh.triangles, 3, level)
    p = cut[triangles][:, :, :3]
    areas = np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1) / 2
    whole = np.zeros(mesh.face_count)
    np.add.at(whole, parents, areas)
    longest = np.linalg.norm(p - np.roll(p, 1, axis=1), axis=2).max()
    np.testing.assert_allclose(whole, mesh.face_areas, rtol=1e-9, atol=1e-8 * longest**2)
    slack = 3e-9 * np.abs(height).max() + 1e-9 * np.ptp(height)
    corner_heights = cut[triangles][:, :, 3]
    assert (corner_heights[aboves] >= level - slack).all()
    assert (corner_heights[~aboves] <= level + slack).all()

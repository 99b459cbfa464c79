# SPDX-License-Identifier: MIT
"""Truths about ways on surfaces: paths of exact fields, traced lines and their way back, coordinates along curves on
flat pieces of the plane by Euclid, maps along curves that do not fold, graphs that went through a file.
"""

from __future__ import annotations

import tempfile
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import numpy as np

import saddleback as sb
from tests.truth.distances import Floats, Random, area_between, assert_near, is_convex_and_flat, longest_edge
from tests.truth.graph import ROUNDING, promised, random_rule
from tests.truth.lines_and_maps import polyline_length
from tests.truth.registry import guards


def random_points(mesh: sb.Mesh, rng: Random, count: int, faces: np.ndarray | None = None) -> sb.SurfacePoints:
    """Anywhere, or in some of these faces; also on edges and at vertices."""
    chosen = rng.choice(np.arange(mesh.face_count) if faces is None else faces, count).astype(np.int32)
    weights = rng.dirichlet([1.0, 1.0, 1.0], count)
    weights[rng.random((count, 3)) < 0.15] = 0.0
    weights[weights.sum(axis=1) == 0] = (1.0, 0.0, 0.0)
    return sb.SurfacePoints(chosen, weights / weights.sum(axis=1, keepdims=True))


def assert_is_way(path: sb.GeodesicPath, mesh: sb.Mesh, start: Floats, end: Floats, share: float = 1e-9) -> None:
    """From end to end over the surface: neighbors share a face, and the length is the polyline's."""
    rounding = 1e-9 * longest_edge(mesh) + 1e-13 * np.abs(mesh.vertices).max()
    np.testing.assert_allclose(path.points[[0, -1]], [start, end], atol=rounding)
    np.testing.assert_allclose(path.surface.positions(mesh), path.points, atol=rounding)
    along = polyline_length(path.points)
    assert abs(path.length - along) <= share * along + rounding, f"length {path.length}, along it {along}"
    touched = [
        set(mesh.triangles[face][weights > 0].tolist())
        for face, weights in zip(path.surface.faces.tolist(), path.surface.barycentric, strict=True)
    ]
    faces = [set(face) for face in mesh.triangles.tolist()]
    for one, next_one in pairwise(touched):
        assert any(one | next_one <= face for face in faces), f"no face holds {one} and {next_one}"


@guards("ExactField", "ExactField.distance_to", "ExactField.path", "ExactField.paths", "GeodesicPath")
def paths_of_exact_fields(mesh: sb.Mesh, rng: Random) -> None:
    """Every path leads from its nearest source over the surface and is as long as the distance, which is that of the
    field of one source and at most the straight way over the faces' corners.
    """
    sources = random_points(mesh, rng, int(rng.integers(1, 4)))
    field = sb.ExactField(mesh, sources)
    near = np.flatnonzero(np.isfinite(field.distances))
    assert (field.nearest >= 0).sum() == len(near)
    reached = np.flatnonzero(np.isin(mesh.triangles, near).all(axis=1))
    targets = random_points(mesh, rng, 4, reached)
    distance, places = field.distance_to(targets), targets.positions(mesh)
    rounding = 1e-12 * longest_edge(mesh) + 1e-15 * np.abs(mesh.vertices).max()
    alone = np.array([sb.ExactField(mesh, sources[i]).distance_to(targets) for i in range(len(sources))])
    assert_near(distance, alone.min(axis=0), mesh, "the least of each source's", 1e-9)
    for i, path in enumerate(field.paths(targets)):
        assert abs(path.length - distance[i]) <= 1e-8 * distance[i] + rounding, f"{path.length}, {distance[i]}"
        starts = [k for k in range(len(sources)) if alone[k, i] <= distance[i] * (1 + 1e-9) + rounding]
        gaps = np.linalg.norm(sources.positions(mesh)[starts] - path.points[0], axis=1)
        assert_is_way(path, mesh, sources.positions(mesh)[starts[int(gaps.argmin())]], places[i])
        assert field.path(targets[i]).points.tobytes() == path.points.tobytes()
        corners = mesh.triangles[targets.faces[i]]
        over = field.distances[corners] + np.linalg.norm(mesh.vertices[corners] - places[i], axis=1)
        excess = distance[i] - over.min()
        assert excess <= 1e-9 * over.min() + rounding, f"{excess} longer than over a corner, of {distance[i]}"


@guards("GeodesicPaths", "SaddleVertexGraph.paths")
def paths_in_flat_arrays(mesh: sb.Mesh, rng: Random) -> None:
    """Flat arrays hold what the paths one by one hold; a path begins at the source that is nearest."""
    if mesh.edge_lengths.min() < 1e-5 * longest_edge(mesh):
        return  # see graph.path_lengths
    graph = sb.SaddleVertexGraph(mesh, threads=1)
    sources = rng.permutation(mesh.vertex_count)[:2].astype(np.int32)
    targets = rng.integers(0, mesh.vertex_count, 5).astype(np.int32)
    distance, nearest = graph.nearest(sources)
    targets = targets[nearest[targets] >= 0]
    if len(targets) == 0:
        return
    paths = graph.paths(sources, targets, threads=1)
    assert len(paths) == len(targets) == len(paths.lengths)
    assert paths.offsets[0] == 0
    assert paths.offsets[-1] == len(paths.points) == len(paths.surface)
    assert (paths.sources == nearest[targets]).all()
    for i, path in enumerate(paths):
        mine = slice(int(paths.offsets[i]), int(paths.offsets[i + 1]))
        assert path.points.tobytes() == paths.points[mine].tobytes()
        assert path.length == paths.lengths[i]
        assert abs(path.length - distance[targets[i]]) <= ROUNDING * path.length + 1e-12 * longest_edge(mesh)
        start, end = mesh.vertices[[sources[nearest[targets[i]]], targets[i]]]
        assert_is_way(path, mesh, start, end, ROUNDING)


@guards("trace", "TracedPath")
def there_and_back(mesh: sb.Mesh, rng: Random) -> None:
    """A traced line is as long as asked for unless it meets the border, and its way back leads to its beginning."""
    faces = np.flatnonzero(mesh.face_areas > 1e-6 * mesh.face_areas.max())
    start = sb.SurfacePoints(rng.choice(faces, 1).astype(np.int32), rng.dirichlet([3.0, 3.0, 3.0], 1))
    length = float(mesh.mean_edge_length * rng.uniform(0, 2))
    line = sb.trace(mesh, start, float(rng.uniform(0, 7)), length)
    size = longest_edge(mesh)
    assert_is_way(line, mesh, start.positions(mesh)[0], line.points[-1])
    assert line.length <= length * (1 + 1e-12)
    if line.length < length * (1 - 1e-9):
        assert line.hit_boundary
        last = line.surface.barycentric[-1]
        corners = mesh.triangles[line.surface.faces[-1]][last > 1e-9]
        assert np.isin(corners, mesh.boundary_vertices).all()
    corners = mesh.vertices[mesh.triangles[line.surface.faces[-1]]]
    along, normal = corners[1] - corners[0], np.cross(corners[1] - corners[0], corners[2] - corners[0])
    along, normal = along / np.linalg.norm(along), normal / np.linalg.norm(normal)
    wanted = np.cos(line.end_angle) * along + np.sin(line.end_angle) * np.cross(normal, along)
    np.testing.assert_allclose(line.end_direction, wanted, atol=1e-6)
    if line.surface.barycentric.max(axis=1).max() > 1 - 1e-6 or line.hit_boundary:
        return  # through a vertex the way back leaves elsewhere
    back = sb.trace(mesh, line.surface[-1], -line.end_direction, line.length)
    missed = float(np.linalg.norm(back.points[-1] - line.points[0]))
    assert missed <= 1e-6 * size, f"back again {missed} beside the start"


def to_polyline(point: Floats, line: Floats) -> list[tuple[float, float, float]]:
    """Distance, arc length and side (positive on the left) of the nearest point of every segment, the nearest first."""
    found, before = [], 0.0
    for a, b in pairwise(line):
        along = b - a
        length = float(np.hypot(*along))
        share = min(max(float((point - a) @ along) / length**2, 0.0), 1.0)
        foot = a + share * along
        side = along[0] * (point - foot)[1] - along[1] * (point - foot)[0]
        found.append((float(np.hypot(*(point - foot))), before + share * length, float(side) / length))
        before += length
    return sorted(found)


@guards("polar_coordinates", "PolarCoordinates")
def along_a_curve(mesh: sb.Mesh, rng: Random) -> None:
    """On flat convex pieces of the plane: distance, foot and side of a straight line or a bent one by Euclid."""
    if not is_convex_and_flat(mesh):
        return
    graph = sb.SaddleVertexGraph(mesh, threads=1)
    ends = random_points(mesh, rng, int(rng.integers(2, 4)))
    places = ends.positions(mesh)[:, :2]
    size = longest_edge(mesh)
    if np.hypot(*np.diff(places, axis=0).T).min() < 1e-3 * size:
        return
    ways = [sb.ExactField(mesh, ends[i]).path(ends[i + 1]).surface for i in range(len(ends) - 1)]
    curve = sb.SurfaceCurve(
        mesh,
        sb.SurfacePoints(np.concatenate([w.faces for w in ways]), np.concatenate([w.barycentric for w in ways])),
    )
    assert abs(curve.length - polyline_length(places)) <= 1e-9 * curve.length
    radius = float(rng.choice([np.inf, size * rng.uniform(0.2, 2)]))
    found = sb.polar_coordinates(graph, curve, radius)
    faces_up = np.cross(*(mesh.vertices[mesh.triangles[0, i]] - mesh.vertices[mesh.triangles[0, 0]] for i in (1, 2)))[2]
    feet = [to_polyline(point, places) for point in mesh.vertices[:, :2]]
    wanted = np.array([foot[0][0] for foot in feet])
    sure = np.abs(wanted - radius) > 1e-8 * size
    inside = np.isin(np.arange(mesh.vertex_count), found.vertices)
    assert (inside == (wanted < radius))[sure].all()
    for vertex, distance, along in zip(found.vertices, found.distance, found.along, strict=True):
        near = [f for f in feet[vertex] if f[0] <= wanted[vertex] + 1e-7 * size]
        assert abs(abs(distance) - wanted[vertex]) <= 1e-7 * size, f"vertex {vertex}: {distance}, {wanted[vertex]}"
        assert min(abs(along - f[1]) for f in near) <= 1e-3 * size, f"vertex {vertex} is at {along}, by Euclid {near}"
        if len(places) == 2 and abs(near[0][2]) > 1e-7 * size:
            assert (distance > 0) == ((near[0][2] > 0) == (faces_up > 0)), f"vertex {vertex} is on the other side"


@guards("LogMap", "SaddleVertexGraph.log_map")
def map_of_a_disk(mesh: sb.Mesh, rng: Random) -> None:
    """On flat convex pieces of the plane the map about a point is the plane itself, turned to the face's first edge."""
    if not is_convex_and_flat(mesh):
        return
    center = sb.SurfacePoints(rng.integers(0, mesh.face_count, 1).astype(np.int32), rng.dirichlet([1, 1, 1], 1))
    corners = mesh.vertices[mesh.triangles[center.faces[0]]][:, :2]
    place, size = center.barycentric[0] @ corners, longest_edge(mesh)
    if area_between(corners[1] - corners[0], corners[2] - corners[0]) < 1e-6 * size**2:
        return  # seen from behind, or a needle whose edges have no direction
    radius = float(rng.choice([np.inf, size]))
    found = sb.SaddleVertexGraph(mesh, threads=1).log_map(center, radius)
    along = (corners[1] - corners[0]) / np.hypot(*(corners[1] - corners[0]))
    offset = mesh.vertices[:, :2] - place
    turned = np.column_stack([offset @ along, offset @ np.array([-along[1], along[0]])])
    wanted = np.hypot(*turned.T)
    sure = abs(wanted - radius) > 1e-8 * size
    inside = np.isin(np.arange(mesh.vertex_count), found.vertices)
    assert (inside == (wanted < radius))[sure].all()
    assert not found.shadowed.any() or len(mesh.saddle_vertices)
    wanted, turned = wanted[found.vertices], turned[found.vertices]
    np.testing.assert_allclose(found.distance, wanted, rtol=1e-9, atol=1e-12 * size)
    # A way first bent at a of d, by a vertex that is h beside the line, is longer by d h^2 / 2 a (d - a) at least and
    # begins h / a beside the direction: its place is off by the root of 2 d^2 / a times what it is longer, at most.
    longer = np.where(found.shadowed, abs(found.distance - wanted) + 1e-15 * size, 0)
    room = 1e-7 * size + np.sqrt(2 * wanted**2 / wanted.min() * longer)
    around = np.column_stack([np.cos(found.angle), np.sin(found.angle)]) * found.distance[:, None]
    for places in (found.uv, around):
        assert (np.hypot(*(places - turned).T) <= room).all(), f"{places} for {turned}"


@guards("SaddleVertexGraph.save", "SaddleVertexGraph.load")
def graphs_in_files(mesh: sb.Mesh, rng: Random) -> None:
    """A graph that was read gives the same bits; one that was damaged, or of another mesh, is refused by a sentence."""
    graph = sb.SaddleVertexGraph(mesh, threads=1)
    source = int(rng.integers(mesh.vertex_count))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "graph"
        graph.save(path)
        again = sb.SaddleVertexGraph.load(path, mesh)
        assert again.distances([source]).tobytes() == graph.distances([source]).tobytes()
        assert (again.arc_count, again.k, again.accuracy) == (graph.arc_count, graph.k, graph.accuracy)
        content = bytearray(path.read_bytes())
        moved = mesh.vertices.copy()
        moved[source] = np.nextafter(moved[source], np.inf)
        refuses(path, sb.Mesh(moved, mesh.triangles))
        at = int(rng.integers(len(content)))
        kind = rng.integers(3)
        if kind == 0:
            content[at] ^= 1 << int(rng.integers(8))
        elif kind == 1:
            del content[at:]
        else:
            content[at:at] = b"x"
        path.write_bytes(content)
        refuses(path, mesh)


def refuses(path: Path, mesh: sb.Mesh) -> None:
    try:
        sb.SaddleVertexGraph.load(path, mesh)
    except sb.InputError as refusal:
        assert str(path) in str(refusal), str(refusal)
        return
    raise AssertionError("loaded all the same")


@guards("SaddleVertexGraph.distances", "SaddleVertexGraph", "exact_distances")
def from_points_of_faces(mesh: sb.Mesh, rng: Random) -> None:
    """From points within faces, on edges and at vertices: graphs within their accuracy of exact distances, both as
    Euclid says on flat convex pieces of the plane.
    """
    if mesh.edge_lengths.min() < 1e-5 * longest_edge(mesh):
        return  # exact distances take long
    rule = random_rule(mesh, rng)
    graph = sb.SaddleVertexGraph(mesh, **rule, threads=1)
    rounding = 1e-12 * longest_edge(mesh) + 1e-14 * np.abs(mesh.vertices).max()
    for point in random_points(mesh, rng, 3):
        exact, found = sb.exact_distances(mesh, point), graph.distances(point)
        if is_convex_and_flat(mesh):
            straight = np.linalg.norm(mesh.vertices - point.positions(mesh), axis=1)
            np.testing.assert_allclose(exact, straight, rtol=1e-9, atol=rounding)
        near = np.isfinite(exact)
        assert (np.isfinite(found) == near).all()
        exact, found = exact[near], found[near]
        assert (found >= exact * (1 - ROUNDING) - rounding).all(), "a distance is too short"
        over = found - exact * (1 + ROUNDING) - rounding
        assert (over <= exact * min(promised(rule), 1e3)).all(), f"{over.max()} too long, from {point.barycentric}"


# Of triangles with smaller angles some vertices have no nearer neighbor and are left out, and the distance at others is
# that of a way within the patch.
NEEDLE = np.radians(10)


def flipped(found: sb.StrokeMap) -> int:
    """How many triangles are not counter-clockwise in the plane: in doubles where these are sure, else in fractions."""
    a, b, c = found.uv[found.triangles].transpose(1, 0, 2)
    left, right = (b - a)[:, 0] * (c - a)[:, 1], (b - a)[:, 1] * (c - a)[:, 0]
    size = np.abs(left) + np.abs(right)
    unsure = left - right <= 1e-12 * size
    bad = 0
    for corners in found.uv[found.triangles[unsure]].tolist():
        (ax, ay), (bx, by), (cx, cy) = ([Fraction(x) for x in corner] for corner in corners)
        bad += (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) <= 0
    return bad


def overlapping(found: sb.StrokeMap) -> int:
    """How many pairs of triangles have an inner point in common: no edge of either parts them, but for rounding."""
    corners = found.uv[found.triangles]
    size = float(np.ptp(found.uv, axis=0).max()) if len(found.uv) else 0.0
    low, high = corners.min(axis=1), corners.max(axis=1)
    order = np.argsort(low[:, 0], kind="stable")
    corners, low, high = corners[order], low[order], high[order]
    ends = np.searchsorted(low[:, 0], high[:, 0])
    pairs = []
    for i, end in enumerate(ends):
        j = np.arange(i + 1, end)
        j = j[(low[j, 1] < high[i, 1]) & (low[i, 1] < high[j, 1])]
        pairs.append(np.column_stack([np.full(len(j), i), j]))
    if not pairs:
        return 0
    first, second = np.concatenate(pairs).T
    parted = np.zeros(len(first), dtype=bool)
    for one, other in ((first, second), (second, first)):
        for k in range(3):
            a, along = corners[one, k], corners[one, (k + 1) % 3] - corners[one, k]
            way = corners[other] - a[:, None]
            side = along[:, None, 0] * way[..., 1] - along[:, None, 1] * way[..., 0]
            parted |= (side <= 1e-9 * size * np.hypot(*along.T)[:, None]).all(axis=1)
    return int((~parted).sum())


def covered(
    mesh: sb.Mesh, graph: sb.SaddleVertexGraph, curve: sb.SurfaceCurve, radius: float, found: sb.StrokeMap, count: int,
    rng: Random,
) -> tuple[int, int, float]:  # fmt: skip
    """Of random points about the curve: how many lie beside it, how many of these the map has, and how far distances
    are off, by their root mean square.

    A point lies beside the curve when its nearest point there is no end: by distances of the graph, which knows nothing
    of windows that leave curves.
    """
    distances = graph.distances(curve, limit=3 * radius)
    near = np.isfinite(distances[mesh.triangles]).any(axis=1)
    near[np.unique(found.face_origin)] = near[curve.points.faces] = True
    faces = np.flatnonzero(near)
    chosen = rng.choice(faces, count, p=mesh.face_areas[faces] / mesh.face_areas[faces].sum()).astype(np.int32)
    points = sb.SurfacePoints(chosen, rng.dirichlet([1.0, 1.0, 1.0], count))
    distance = graph.distances_to(curve, points)
    beside = distance < radius * (1 - 2e-3)
    if not curve.closed:
        ends = sb.SurfacePoints(curve.points.faces[[0, -1]], curve.points.barycentric[[0, -1]])
        beside &= distance < graph.distances_to(ends, points) - 4e-3 * radius
    there, off = 0, []
    by_face: dict[int, list[int]] = {}
    for t, face in enumerate(found.face_origin.tolist()):
        by_face.setdefault(face, []).append(t)
    for i in np.flatnonzero(beside):
        own = by_face.get(int(chosen[i]), [])
        if not own:
            continue
        place = points.barycentric[i] @ mesh.vertices[mesh.triangles[chosen[i]]]
        corners = found.vertices[found.triangles[own]]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        weights = np.stack(
            [np.einsum("ij,ij->i", np.cross(corners[:, (k + 2) % 3] - corners[:, (k + 1) % 3],
                                            place - corners[:, (k + 1) % 3]), normal) for k in range(3)],
            axis=1,
        ) / np.einsum("ij,ij->i", normal, normal)[:, None]  # fmt: skip
        best = int(weights.min(axis=1).argmax())
        if weights[best].min() < -1e-6:
            continue
        there += 1
        off.append(abs(weights[best] @ found.uv[found.triangles[own[best]], 1]) - distance[i])
    return int(beside.sum()), there, float(np.sqrt(np.mean(np.square(off)))) if off else 0.0


def least_angle(mesh: sb.Mesh) -> float:
    """Of all corners of triangles, radians."""
    corners = mesh.vertices[mesh.triangles]
    sides = np.roll(corners, -1, axis=1) - corners
    lengths = np.linalg.norm(sides, axis=2)
    cosines = -np.einsum("ijk,ijk->ij", sides, np.roll(sides, 1, axis=1)) / (lengths * np.roll(lengths, 1, axis=1))
    return float(np.arccos(np.clip(cosines, -1, 1)).min())


def random_curve(mesh: sb.Mesh, rng: Random) -> sb.SurfaceCurve | None:
    """Shortest ways from point to point, sometimes back to the first one; None where they do not meet."""
    field = random_points(mesh, rng, int(rng.integers(2, 5)))
    closed = len(field) > 2 and rng.random() < 0.3
    pairs = [*pairwise(range(len(field))), *([(len(field) - 1, 0)] if closed else [])]
    try:
        ways = [sb.ExactField(mesh, field[i]).path(field[j]).surface for i, j in pairs]
    except sb.InputError:
        return None
    faces, weights = (np.concatenate([getattr(way, name) for way in ways]) for name in ("faces", "barycentric"))
    if closed:
        faces, weights = faces[:-1], weights[:-1]
    return sb.SurfaceCurve(mesh, sb.SurfacePoints(faces, weights), closed=closed)


def places_about(mesh: sb.Mesh, points: sb.SurfacePoints) -> Floats:
    """Places of points beside the first vertex: those beside a far origin are rounded to more than a narrow radius."""
    corners = (mesh.vertices - mesh.vertices[0])[mesh.triangles[points.faces]]
    found: Floats = np.einsum("ij,ijk->ik", points.barycentric, corners)
    return found


@guards("stroke_map", "StrokeMap")
def maps_do_not_fold(mesh: sb.Mesh, rng: Random) -> None:
    """Triangles keep their orientation by exact sign and none overlaps another; areas, arc lengths, distances agree."""
    curve = random_curve(mesh, rng)
    if curve is None:
        return
    size = float(np.ptp(mesh.vertices, axis=0).max())
    radius = size * float(rng.choice([0.02, 0.1, 0.3, 1.0])) * rng.uniform(0.5, 1.5)
    found = sb.stroke_map(mesh, curve, radius)
    assert flipped(found) == 0
    assert overlapping(found) == 0
    corners = places_about(mesh, found.points)[found.triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    np.testing.assert_allclose(found.area, areas.sum(), rtol=1e-9)
    assert 0 <= found.coverage <= 1
    np.testing.assert_allclose(found.points.positions(mesh), found.vertices, atol=1e-9 * size)
    assert (np.abs(found.uv[:, 1]) <= radius).all()
    assert (found.uv[:, 0] >= -1e-9 * curve.length).all() and (found.uv[:, 0] <= curve.length * (1 + 1e-9)).all()
    if least_angle(mesh) < NEEDLE:
        return
    is_vertex = found.points.barycentric.max(axis=1) == 1
    vertices = mesh.triangles[found.points.faces, found.points.barycentric.argmax(axis=1)][is_vertex]
    exact = sb.SaddleVertexGraph(mesh, exact=True, threads=1).distances(curve)[vertices]
    np.testing.assert_allclose(np.abs(found.uv[is_vertex, 1]), exact, atol=1e-4 * radius)


@guards("stroke_map")
def maps_hold_what_lies_beside(mesh: sb.Mesh, rng: Random) -> None:
    """On flat convex pieces a map has Euclid's distances from a straight line, and of a bent one it has what it tells:
    at least nine tenths of all points whose nearest point on the line is no end. Without needles.
    """
    if not is_convex_and_flat(mesh) or least_angle(mesh) < NEEDLE:
        return
    ends = random_points(mesh, rng, int(rng.integers(2, 4)))
    places = ends.positions(mesh)[:, :2]
    size = longest_edge(mesh)
    if np.hypot(*np.diff(places, axis=0).T).min() < 1e-2 * size:
        return
    ways = [sb.ExactField(mesh, ends[i]).path(ends[i + 1]).surface for i in range(len(ends) - 1)]
    curve = sb.SurfaceCurve(
        mesh,
        sb.SurfacePoints(np.concatenate([w.faces for w in ways]), np.concatenate([w.barycentric for w in ways])),
    )
    radius = size * float(rng.uniform(0.05, 1))
    found = sb.stroke_map(mesh, curve, radius)
    if len(places) == 2:
        along = (places[1] - places[0]) / np.hypot(*(places[1] - places[0]))
        offset = found.vertices[:, :2] - places[0]
        up = np.sign(np.cross(*(mesh.vertices[mesh.triangles[0, i]] - mesh.vertices[mesh.triangles[0, 0]]
                                for i in (1, 2)))[2])  # fmt: skip
        across = up * (offset @ np.array([-along[1], along[0]]))
        np.testing.assert_allclose(found.uv[:, 1], across, atol=1e-4 * radius)
    graph = sb.SaddleVertexGraph(mesh, exact=True, threads=1)
    beside, there, _ = covered(mesh, graph, curve, radius, found, 400, rng)
    assert there >= 0.9 * beside - 3, f"{there} of {beside} points"
    assert abs(found.coverage - there / max(beside, 1)) <= 0.1 + 3 / max(beside, 1)


@guards("stroke_map")
def maps_of_narrow_bands(mesh: sb.Mesh, rng: Random) -> None:
    """A radius down to 1e-4 of the extent, along ways over the surface and along bent lines within a face down to 1e-4
    of it: nothing folds, of lines within the face distances are Euclid's, and there are no more triangles than are
    told. A radius that asks for too many is refused, with the least one that works.
    """
    size = float(np.ptp(mesh.vertices, axis=0).max())
    is_in_face = bool(rng.random() < 0.6)
    if is_in_face:
        face = int(rng.integers(mesh.face_count))
        share = 10 ** rng.uniform(-4, 0)
        center, around = rng.dirichlet([2.0, 2.0, 2.0]), rng.dirichlet([1.0, 1.0, 1.0], int(rng.integers(2, 5)))
        points = sb.SurfacePoints(np.full(len(around), face, np.int32), center + share * (around - center))
        if np.linalg.norm(np.diff(points.positions(mesh), axis=0), axis=1).min() < 1e-3 * share * longest_edge(mesh):
            return
        curve = sb.SurfaceCurve(mesh, points)
        radius = curve.length * 10 ** rng.uniform(-2.5, 0)
    else:
        way = random_curve(mesh, rng)
        if way is None:
            return
        curve, radius = way, size * 10 ** rng.uniform(-4, -1.5)
    try:
        found = sb.stroke_map(mesh, curve, radius)
    except sb.InputError as error:
        if "triangles" not in str(error):
            raise
        least = float(str(error).rsplit(" ", 1)[1])
        assert radius < least
        job = sb.Job()
        job.cancel()
        try:
            sb.stroke_map(mesh, curve, least, job=job)
        except sb.Cancelled:
            return  # not refused any more
        raise AssertionError("a cancelled job went on") from None
    assert flipped(found) == 0
    if len(found.triangles) < 20_000:
        assert overlapping(found) == 0
    np.testing.assert_allclose(found.points.positions(mesh), found.vertices, atol=1e-9 * size)
    assert (np.abs(found.uv[:, 1]) <= radius).all()
    if not is_in_face or least_angle(mesh) < NEEDLE or (found.face_origin != face).any():
        return
    corners = mesh.vertices[mesh.triangles[face]]
    across = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    axes = np.stack([corners[1] - corners[0], np.cross(across, corners[1] - corners[0])])
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    line, places = ((places_about(mesh, at) - places_about(mesh, points)[0]) @ axes.T for at in (points, found.points))
    wanted = np.array([to_polyline(place, line)[0][0] for place in places])
    off = np.abs(np.abs(found.uv[:, 1]) - wanted)
    assert off.max() <= (1e-4 if len(line) == 2 else 1 / 3) * radius
    corners = found.vertices[found.triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    assert np.average((off <= 1e-2 * radius)[found.triangles].mean(axis=1), weights=areas) > 0.9

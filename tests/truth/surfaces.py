# SPDX-License-Identifier: MIT
"""Truths about meshes themselves: counts, areas, borders, normals, samples, nearest points, by plain numpy.

Then about those with lengths of their own: where a surface lies must not matter, so with the lengths of one and other
positions every answer is the mesh's; and surfaces whose distances are known.
"""

from __future__ import annotations

import math
from collections import Counter
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes
from tests.truth.distances import assert_near
from tests.truth.registry import guards

Floats = NDArray[np.float64]
Random = np.random.Generator
WORST_FACE = 1e4  # longest side over height: lengths of thinner faces tell too little of their angles


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
    "neighbor_means",
    "smoothed_directions",
    "segment_distances",
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
    values = rng.random((mesh.vertex_count, 2))
    beside: list[list[int]] = [[] for _ in range(mesh.vertex_count)]
    for corners in mesh.triangles.tolist():
        for corner in corners:
            beside[corner] += [other for other in corners if other != corner]
    means = [values[others].mean(axis=0) if others else [0.0, 0.0] for others in beside]
    np.testing.assert_allclose(sb.neighbor_means(mesh.triangles, values), means, rtol=1e-9)
    directions = rng.normal(size=(mesh.vertex_count, 3))
    turned = np.array(
        [d / 5 + (directions[o].mean(axis=0) if o else 0) for d, o in zip(directions, beside, strict=True)]
    )
    turned /= np.linalg.norm(turned, axis=1)[:, None]
    np.testing.assert_allclose(sb.smoothed_directions(mesh.triangles, directions, 1), turned, atol=1e-9)
    twice = sb.smoothed_directions(mesh.triangles, turned, 1)
    np.testing.assert_allclose(sb.smoothed_directions(mesh.triangles, directions, 2), twice, atol=1e-9)
    group, other = rng.integers(0, 4, mesh.vertex_count), rng.integers(0, 3, 20)
    starts, ends = mesh.vertices[rng.integers(0, mesh.vertex_count, (2, 20))]
    shares = np.linspace(0, 1, 201)[:, None]
    on = [starts[other == g][:, None] * (1 - shares) + ends[other == g][:, None] * shares for g in range(4)]
    sampled = np.array(
        [np.linalg.norm(on[g] - p, axis=2).min(initial=np.inf) for g, p in zip(group, mesh.vertices, strict=True)]
    )
    found = sb.segment_distances(mesh.vertices, group, starts, ends, other)
    step, rounding = np.linalg.norm(ends - starts, axis=1).max() / 400, 1e-12 * np.abs(mesh.vertices).max()
    assert (np.isinf(found) == np.isinf(sampled)).all()
    assert ((found <= sampled + rounding) & (found >= sampled - step - rounding)).all()
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


def sides(vertices: Floats, triangles: NDArray[np.int32]) -> Floats:
    """(F, 3) lengths from each corner to the next."""
    corners = vertices[triangles]
    lengths: Floats = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    return lengths


def elsewhere(mesh: sb.Mesh, rng: Random) -> sb.Mesh:
    """The surface with other positions: scattered, pressed flat, far larger, or all in one place."""
    scattered = rng.normal(size=mesh.vertices.shape)
    places = [scattered, mesh.vertices * [1, 1, 0], 1e3 * mesh.vertices, 1e-3 * scattered, 0 * mesh.vertices]
    lengths = sides(mesh.vertices, mesh.triangles) if rng.random() < 0.5 else mesh.edge_lengths
    return sb.Mesh(places[rng.integers(len(places))], mesh.triangles, lengths=lengths)


def are_fat(mesh: sb.Mesh) -> bool:
    """Whether lengths tell the shape of all faces."""
    longest = sides(mesh.vertices, mesh.triangles).max(axis=1)
    return bool((longest**2 <= WORST_FACE * 2 * mesh.face_areas).all())


def some_points(mesh: sb.Mesh, count: int, rng: Random) -> sb.SurfacePoints:
    faces = rng.integers(len(mesh.triangles), size=count).astype(np.int32)
    return sb.SurfacePoints(faces, rng.dirichlet([1, 1, 1], count))


def steps(mesh: sb.Mesh, path: sb.GeodesicPath) -> float:
    """The length of a path's image on a mesh that its positions show truly.

    From a corner on the way: far from the origin places are rounded by more than steps may be wrong.
    """
    corners = mesh.vertices[mesh.triangles[path.surface.faces]]
    places = np.einsum("ni,nij->nj", path.surface.barycentric, corners - corners[0, 0])
    return float(np.linalg.norm(np.diff(places, axis=0), axis=1).sum())


@guards("Mesh", "exact_distances", "exact_nearest", "ExactField", "SurfaceCurve", "harmonic_map")
def lengths_without_places(mesh: sb.Mesh, rng: Random) -> None:
    """Measures, exact distances and paths, curves and maps of a surface elsewhere against the surface itself."""
    if not are_fat(mesh):
        return
    moved = elsewhere(mesh, rng)
    assert moved.is_intrinsic
    assert not mesh.is_intrinsic
    assert moved.fingerprint != mesh.fingerprint
    assert np.array_equal(moved.edge_lengths, mesh.edge_lengths)
    assert np.allclose(moved.face_areas, mesh.face_areas, rtol=1e-7, atol=0)
    assert np.allclose(moved.corner_angles, mesh.corner_angles, rtol=0, atol=1e-7)
    sources = some_points(mesh, 2, rng)
    assert_near(sb.exact_distances(moved, sources), sb.exact_distances(mesh, sources), mesh, "exact_distances")
    places = some_points(mesh, 6, rng)
    field, true = sb.ExactField(moved, sources), sb.ExactField(mesh, sources)
    assert_near(field.distance_to(places), true.distance_to(places), mesh, "ExactField.distance_to")
    for path in field.paths(places) if np.isfinite(true.distance_to(places)).all() else ():
        length = steps(mesh, path)
        assert abs(path.length - length) <= 1e-9 * length, f"a path says {path.length} for {length}"
        curve = path.surface if len(path.surface) > 1 and length > 0 else None
        if curve is not None:
            here, there = sb.SurfaceCurve(mesh, curve).length, sb.SurfaceCurve(moved, curve).length
            assert abs(here - there) <= 1e-9 * here, f"a curve says {there} for {here}"
    if len(mesh.boundary_loops) == 1 and mesh.genus == 0 and mesh.component_count == 1:
        assert np.allclose(sb.harmonic_map(moved), sb.harmonic_map(mesh), rtol=0, atol=1e-6)


@guards(
    "SaddleVertexGraph",
    "SaddleVertexGraph.distances",
    "SaddleVertexGraph.distances_to",
    "SaddleVertexGraph.distance",
    "SaddleVertexGraph.nearest",
    "SaddleVertexGraph.path",
    "SaddleVertexGraph.paths",
    "SaddleVertexGraph.log_map",
    "trace",
    "exp_map",
)
def graphs_without_places(mesh: sb.Mesh, rng: Random) -> None:
    """The exact graph's distances and ways, log maps and traces of a surface elsewhere against the surface itself."""
    if not are_fat(mesh):
        return
    moved = elsewhere(mesh, rng)
    graph, true = (sb.SaddleVertexGraph(m, exact=True, threads=1) for m in (moved, mesh))
    sources, targets = some_points(mesh, 2, rng), some_points(mesh, 6, rng)
    assert_near(graph.distances(sources), true.distances(sources), mesh, "distances", 2e-9)
    found = graph.distances_to(sources, targets)
    exact = sb.ExactField(mesh, sources).distance_to(targets)
    assert_near(found, exact, mesh, "distances_to", 2e-9)
    a, b = sources[:1], targets[:1]
    between = true.distance(a, b)
    assert_near(np.array([graph.distance(a, b)]), np.array([between]), mesh, "distance", 2e-9)
    if np.isfinite(between):
        path = graph.path(a, b, shorten=True)
        assert abs(steps(mesh, path) - path.length) <= 1e-9 * path.length
        assert path.length >= between * (1 - 2e-9)
    start, angle = int(rng.integers(len(mesh.vertices))), float(rng.uniform(0, 2))
    length = float(rng.uniform(0.1, 2)) * mesh.mean_edge_length
    here, there = sb.trace(mesh, start, angle, length), sb.trace(moved, start, angle, length)
    assert abs(here.length - there.length) <= 1e-9 * length
    end = there.surface.positions(mesh)[-1]
    missed = float(np.linalg.norm(end - here.points[-1]))
    assert missed <= 1e-6 * length, f"a line of length {length} ends {missed} apart"


@guards("Mesh", "SaddleVertexGraph.distances", on="nothing")
def planes_in_many_dimensions(rng: Random) -> None:
    """A flat grid scaled by a linear map and turned in d dimensions: Euclid's distances, all told by lengths."""
    vertices, triangles = meshes.grid(*(int(n) for n in rng.integers(3, 10, 2)), jitter=0.3, seed=int(rng.integers(99)))
    dimension = int(rng.integers(4, 9))
    turned = np.linalg.qr(rng.normal(size=(dimension, dimension)))[0][:2]
    there = vertices[:, :2] @ (np.diag(rng.uniform(0.3, 3, 2)) @ np.linalg.qr(rng.normal(size=(2, 2)))[0])
    by_lengths = sb.Mesh(vertices, triangles, lengths=sides(there, triangles))
    for mesh in (sb.Mesh(there @ turned, triangles), by_lengths, sb.Mesh(there, triangles)):
        assert mesh.is_intrinsic == (mesh.vertices[:, 2].any() or mesh is by_lengths)
        source = int(rng.integers(len(vertices)))
        true = np.linalg.norm(there - there[source], axis=1)
        assert_near(sb.exact_distances(mesh, [source]), true, mesh, "exact_distances")
        assert_near(sb.SaddleVertexGraph(mesh, exact=True, threads=1).distances([source]), true, mesh, "distances")


@guards("Mesh", "exact_distances", on="nothing")
def flat_tori(rng: Random) -> None:
    """A torus in four dimensions, which is flat: the least of Euclid's distances of all copies of the plane."""
    across, along = (int(n) for n in rng.integers(3, 9, 2))
    u, v = (2 * np.pi * np.arange(n) / n for n in (across, along))
    big, small = rng.uniform(0.5, 2, 2)
    u, v = np.tile(u, along), np.repeat(v, across)
    places = np.stack([big * np.cos(u), big * np.sin(u), small * np.cos(v), small * np.sin(v)], axis=1)
    i, j = np.arange(across * along) % across, np.arange(across * along) // across
    right, up = (i + 1) % across + across * j, i + across * ((j + 1) % along)
    far = (i + 1) % across + across * ((j + 1) % along)
    triangles = np.vstack([np.stack([i + across * j, right, far], 1), np.stack([i + across * j, far, up], 1)])
    mesh = sb.Mesh(places, triangles.astype(np.int32))
    width, height = 2 * big * math.sin(math.pi / across), 2 * small * math.sin(math.pi / along)
    dx, dy = np.minimum(i, across - i) * width, np.minimum(j, along - j) * height
    assert_near(sb.exact_distances(mesh, [0]), np.hypot(dx, dy), mesh, "a flat torus")
    assert mesh.genus == 1


def spokes(rings: int, around: int) -> NDArray[np.int32]:
    """A disk: vertex 0 in the middle, then rings of vertices, ring by ring."""
    one, other = np.arange(around), (np.arange(around) + 1) % around
    parts = [np.stack([0 * one, 1 + one, 1 + other], axis=1)]
    for ring in range(rings - 1):
        inner, outer = 1 + around * ring, 1 + around * (ring + 1)
        parts.append(np.stack([inner + one, outer + one, outer + other], axis=1))
        parts.append(np.stack([inner + one, outer + other, inner + other], axis=1))
    return np.vstack(parts).astype(np.int32)


@guards("Mesh", "exact_distances", on="nothing")
def cones_of_any_angle(rng: Random) -> None:
    """A cone by lengths alone, also of more than a full turn: by the law of cosines, or over its tip."""
    around, radii = int(rng.integers(5, 30)), np.sort(rng.uniform(0.1, 1, 3))
    total = float(rng.uniform(1, min(9, 1.2 * around)))
    triangles = spokes(3, around)
    radius = np.concatenate([[0], np.repeat(radii, around)])
    place = np.concatenate([[0], np.tile(np.arange(around), 3)])

    def between(a: NDArray[np.int32], b: NDArray[np.int32]) -> Floats:
        steps = np.abs(place[a] - place[b])
        angle = np.minimum(steps, around - steps) * total / around
        straight = np.hypot(radius[a] - radius[b], 2 * np.sqrt(radius[a] * radius[b]) * np.sin(angle / 2))
        return np.where((angle < np.pi) & (radius[a] * radius[b] > 0), straight, radius[a] + radius[b])

    lengths = np.stack([between(triangles[:, i], triangles[:, (i + 1) % 3]) for i in range(3)], axis=1)
    mesh = sb.Mesh(rng.normal(size=(len(radius), 3)), triangles, lengths=lengths)
    assert abs(mesh.total_angles[0] - total) <= 1e-9
    # Between the vertices of the inner ring no way leaves the cone, where the rim is far enough.
    rim = radii[2] * math.cos(total / around / 2)
    inner = 1 + np.arange(around, dtype=np.int32)
    source = int(rng.integers(around))
    found = sb.exact_distances(mesh, [1 + source])
    if rim >= radii[0]:
        assert_near(found[inner], between(inner, np.full(around, 1 + source)), mesh, "a cone")
    assert_near(sb.exact_distances(mesh, [0]), radius, mesh, "from a cone's tip")


@guards("Mesh", "exact_distances", on="nothing")
def spokes_of_the_hyperbolic_plane(rng: Random) -> None:
    """Poincare's disk: along lines through its middle, about which the mesh is symmetric, lengths are the plane's."""
    around, rings = 2 * int(rng.integers(3, 12)), int(rng.integers(2, 7))
    radii = np.sort(rng.uniform(0.05, 0.95, rings))
    if np.diff(radii).min() < 0.02:
        return
    triangles = mirrored_spokes(rings, around)
    angle = 2 * np.pi * np.tile(np.arange(around), rings) / around
    z = np.concatenate([[0], np.repeat(radii, around) * np.exp(1j * angle)])
    a, b = z[triangles], z[np.roll(triangles, -1, axis=1)]
    mesh = sb.Mesh(
        np.stack([z.real, z.imag], axis=1), triangles, lengths=2 * np.arctanh(abs((a - b) / (1 - a.conj() * b)))
    )
    # Flat triangles have wider angles than hyperbolic ones: every vertex has 2 pi or more, and what is straight is
    # shortest.
    inner = np.ones(len(z), dtype=bool)
    inner[-around:] = False
    assert (mesh.total_angles[inner] >= 2 * np.pi - 1e-9).all()
    assert_near(sb.exact_distances(mesh, [0]), 2 * np.arctanh(abs(z)), mesh, "from the middle of the hyperbolic plane")
    opposite = 1 + around * np.arange(rings) + around // 2
    across = 2 * np.arctanh(radii) + 2 * np.arctanh(radii[0])
    assert_near(sb.exact_distances(mesh, [1])[opposite], across, mesh, "across the hyperbolic plane")


def mirrored_spokes(rings: int, around: int) -> NDArray[np.int32]:
    """The disk with diagonals that are mirrored at every spoke; `around` is even."""
    triangles = [(0, 1 + i, 1 + (i + 1) % around) for i in range(around)]
    for ring in range(rings - 1):
        for i in range(around):
            a, b = (1 + around * ring + k % around for k in (i, i + 1))
            c, d = a + around, b + around
            triangles += [(a, c, d), (a, d, b)] if i % 2 else [(a, c, b), (c, d, b)]
    return np.array(triangles, dtype=np.int32)


def rough(rng: Random) -> sb.Mesh:
    """A good closed mesh of 320 faces without symmetries, which could leave a choice to rounding."""
    vertices, triangles = meshes.torus(20, 8) if rng.random() < 0.5 else meshes.icosphere(2)
    spacing = float(sides(vertices, triangles).mean())
    return sb.Mesh(vertices + 0.12 * spacing * rng.normal(size=vertices.shape), triangles)


@guards(
    "geodesic_voronoi",
    "GeodesicVoronoi.locate",
    "GeodesicVoronoi.split",
    "GeodesicVoronoi.dual",
    "centroidal_voronoi",
    "geodesic_center",
    on="nothing",
)
def cells_without_places(rng: Random) -> None:
    """Cells, their dual, centers and relaxed sites of a surface elsewhere against those of the surface itself."""
    mesh = rough(rng)
    moved = elsewhere(mesh, rng)
    graph, true = (sb.SaddleVertexGraph(m, exact=True, threads=1) for m in (moved, mesh))
    sites = some_points(mesh, int(rng.integers(20, 40)), rng)
    here, there = sb.geodesic_voronoi(true, sites), sb.geodesic_voronoi(graph, sites)
    assert_near(there.vertex_distance, here.vertex_distance, mesh, "vertex_distance", 1e-8)
    assert np.mean(there.vertex_cell != here.vertex_cell) <= 0.01
    assert np.allclose(there.areas, here.areas, rtol=0, atol=1e-6 * mesh.area)
    duals = [cells.dual(policy="strict") for cells in (here, there)]
    one, other = ({frozenset(face) for face in dual.triangles.tolist()} for dual in duals)
    assert len(one ^ other) <= 0.1 * len(one), "other triangles of the dual"
    places = some_points(mesh, 10, rng)
    found, distance = there.locate(places)
    assert (np.asarray(distance) >= sb.ExactField(mesh, sites).distance_to(places) * (1 - 1e-9)).all()
    assert np.array_equal(found, here.locate(places)[0])
    options = {"sites": sites, "method": "lloyd", "max_iterations": 2, "threads": 1}
    first, second = (sb.centroidal_voronoi(g, **options) for g in (true, graph))
    assert np.allclose(first.energy, second.energy, rtol=1e-4), f"energies {first.energy} and {second.energy}"
    # The sum may have several leasts: found is where the point nearest to the mean leads, or else the first one.
    near = np.flatnonzero(np.isin(mesh.triangles, mesh.triangles[rng.integers(mesh.face_count)]).any(axis=1))[:3]
    weights = rng.dirichlet([1, 1, 1], 3)
    places = sb.SurfacePoints(near.astype(np.int32), weights).positions(mesh)
    order = np.argsort(np.linalg.norm(places - places.mean(axis=0), axis=1), kind="stable")
    points = sb.SurfacePoints(near[order].astype(np.int32), weights[order])
    center, same = (sb.geodesic_center(g, points) for g in (true, graph))
    spread = sb.ExactField(mesh, center).distance_to(points).max()
    missed = sb.ExactField(mesh, center).distance_to(same)[0]
    assert missed <= 1e-5 * spread, f"a center is {missed} away, its points {spread}"


@guards("centroidal_voronoi", "SurfaceCurve", on="nothing")
def sites_on_curves_without_places(rng: Random) -> None:
    """Held sites of a surface elsewhere begin at the nearest points of their curves, and slide as on the surface."""
    mesh = rough(rng)
    moved = elsewhere(mesh, rng)
    ends = some_points(mesh, 2, rng)
    way = sb.ExactField(mesh, ends[:1]).path(ends[1:]).surface
    here, there = sb.SurfaceCurve(mesh, way), sb.SurfaceCurve(moved, way)
    graphs = [sb.SaddleVertexGraph(m, exact=True, threads=1) for m in (mesh, moved)]
    held = np.repeat(np.array([0, -1], dtype=np.int32), [4, 16])
    sites = some_points(mesh, len(held), rng)
    options = {"held": held, "method": "lloyd", "threads": 1}
    start = sb.centroidal_voronoi(graphs[1], sites=sites, curves=[there], max_iterations=0, **options)
    along = along_curve(mesh, way, 200)
    for i in np.flatnonzero(held == 0):
        field, found = sb.ExactField(mesh, sites[i]), start.sites[i]
        least = field.distance_to(along).min()
        assert field.distance_to(found)[0] <= least * (1 + 1e-9), f"site {i} begins farther away than need be"
        assert sb.ExactField(mesh, found).distance_to(along).min() <= here.length / 200, f"site {i} is not on the curve"
    first, second = (
        sb.centroidal_voronoi(graph, sites=start.sites, curves=[curve], max_iterations=2, **options)
        for graph, curve in zip(graphs, (here, there), strict=True)
    )
    assert np.allclose(first.energy, second.energy, rtol=1e-4), f"energies {first.energy} and {second.energy}"
    missed = np.linalg.norm(first.sites.positions(mesh) - second.sites.positions(mesh), axis=1)[held == 0].max()
    assert missed <= 1e-3 * mesh.mean_edge_length, f"held sites are {missed} apart"


def along_curve(mesh: sb.Mesh, way: sb.SurfacePoints, count: int) -> sb.SurfacePoints:
    """So many points of each step of a curve, its points among them."""
    faces, weights = [], []
    for a, b in zip(range(len(way) - 1), range(1, len(way)), strict=True):
        for face in np.flatnonzero(np.isin(mesh.triangles, mesh.triangles[way.faces[a]]).any(axis=1)):
            one, other = (weights_in(mesh, way, i, int(face)) for i in (a, b))
            if one is not None and other is not None:
                share = np.linspace(0, 1, count)[:, None]
                faces.append(np.full(count, face, dtype=np.int32))
                weights.append((1 - share) * one + share * other)
                break
    return sb.SurfacePoints(np.concatenate(faces), np.concatenate(weights))


def weights_in(mesh: sb.Mesh, points: sb.SurfacePoints, i: int, face: int) -> Floats | None:
    """A point's weights in a face that it lies on; None where it does not."""
    corners, weights = mesh.triangles[points.faces[i]].tolist(), points.barycentric[i]
    own = mesh.triangles[face].tolist()
    if any(weight > 1e-12 and corner not in own for corner, weight in zip(corners, weights, strict=True)):
        return None
    found = np.array([weights[corners.index(corner)] if corner in corners else 0.0 for corner in own])
    return np.asarray(found / found.sum())


@guards("direction_field", "streamline", on="nothing")
def fields_without_places(rng: Random) -> None:
    """A field along a curve, and a line along it, of a surface elsewhere against those of the surface itself."""
    mesh = rough(rng)
    moved = elsewhere(mesh, rng)
    way = sb.ExactField(mesh, some_points(mesh, 1, rng)).path(some_points(mesh, 1, rng)).surface
    symmetry = int(rng.choice([1, 2, 4]))
    true, field = (sb.direction_field(m, symmetry, strokes=[sb.SurfaceCurve(m, way)]) for m in (mesh, moved))
    apart = np.remainder(symmetry * (field.angles - true.angles) + np.pi, 2 * np.pi) - np.pi
    assert np.mean(abs(apart) > 1e-3) <= 0.01, f"another field: {np.sort(abs(apart))[-5:]}"
    if field.singularities == true.singularities:
        start = some_points(mesh, 1, rng)
        length = 5 * mesh.mean_edge_length
        line = sb.streamline(moved, field, start, length)
        walked = steps(mesh, line)
        assert abs(line.length - walked) <= 1e-9 * walked, f"a line says {line.length} for {walked}"


@guards("distribute", "check_distribution", on="nothing")
def shapes_without_places(rng: Random) -> None:
    """Shapes laid on a surface elsewhere, checked on the surface itself: the same shapes, and none meets another."""
    mesh = rough(rng)
    moved = elsewhere(mesh, rng)
    laid = sb.distribute(moved, [sb.Shape.star(), sb.Shape.disk()], [6, 6], size=2 * mesh.mean_edge_length, seed=1)
    assert len(laid.placements) > 0
    for surface in (moved, mesh):
        report = sb.check_distribution(surface, laid)
        assert report.ok, f"{report} on {'the surface' if surface is mesh else 'the surface elsewhere'}"


@guards("curvature_metric")
def bent_lengths(mesh: sb.Mesh, rng: Random) -> None:
    """Edges are as long as in six dimensions, of places and normals by numpy; moving and scaling change no ratio."""
    weight = float(rng.choice([0.0, 0.1, 3.0]))
    found = sb.curvature_metric(mesh, weight)
    assert sb.Mesh(mesh.vertices, mesh.triangles, lengths=found).is_intrinsic
    corners = mesh.vertices[mesh.triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.stack([np.bincount(mesh.triangles.ravel(), np.repeat(areas[:, k], 3)) for k in range(3)], axis=1)
    size = np.linalg.norm(normals, axis=1)
    clear = size > 1e-6 * np.bincount(mesh.triangles.ravel(), np.repeat(np.linalg.norm(areas, axis=1), 3))
    normals /= np.where(size > 0, size, 1)[:, None]
    turns = np.linalg.norm(np.roll(normals[mesh.triangles], -1, axis=1) - normals[mesh.triangles], axis=2)
    true = np.hypot(sides(mesh.vertices, mesh.triangles), weight * math.sqrt(mesh.area) * turns)
    known = clear[mesh.triangles] & np.roll(clear[mesh.triangles], -1, axis=1)
    assert np.allclose(found[known], true[known], rtol=1e-9, atol=1e-9 * float(true.max())), f"{found} for {true}"


@guards("anisotropic_metric")
def stretched_lengths(mesh: sb.Mesh, rng: Random) -> None:
    """Whatever field and stretch, lengths of a metric; where one face is alone, those that its tensor says, to 1e-9."""
    vectors, stretch = rng.normal(size=(mesh.face_count, 3)), float(np.exp(rng.normal(scale=2)))
    lengths = sb.anisotropic_metric(mesh, vectors, stretch, np.exp(rng.normal(size=mesh.vertex_count)))
    assert sb.Mesh(mesh.vertices, mesh.triangles, lengths=lengths).is_intrinsic
    face = int(rng.integers(mesh.face_count))
    corners = mesh.vertices[mesh.triangles[face]]
    found = sb.anisotropic_metric(sb.Mesh(corners, [[0, 1, 2]]), vectors[face : face + 1], stretch)[0]
    if not are_fat(sb.Mesh(corners, [[0, 1, 2]])):
        return
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    across = np.cross(normal, vectors[face])
    across /= np.linalg.norm(across)
    along = np.cross(across, normal / np.linalg.norm(normal))
    sides_of_it = np.roll(corners, -1, axis=0) - corners
    true = np.hypot(sides_of_it @ along / math.sqrt(stretch), sides_of_it @ across * math.sqrt(stretch))
    assert np.allclose(found, true, rtol=1e-9, atol=1e-9 * float(true.max())), f"{found} for {true}"

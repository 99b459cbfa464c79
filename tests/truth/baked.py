# SPDX-License-Identifier: MIT
"""Truths about baked images: each texel by itself, its way to the cell's edge by unfolding the faces about it."""

from __future__ import annotations

from heapq import heappop, heappush
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

import saddleback as sb
from tests.truth.cells import random_sites
from tests.truth.distances import longest_edge
from tests.truth.registry import guards

Floats = NDArray[np.float64]
Random = np.random.Generator

SURE = 1e-7
"""Of a triangle: nearer to its border a texel may be in the next one."""


PATIENCE = 30_000
"""Sides that ways cross: more lead about small faces beside far larger ones, and are not followed."""
GRADED = 1e4
"""The longest edge over the shortest: beyond that, faces laid side by side in one plane lose what matters."""


class TooManyWaysError(Exception):
    """The truth would take too long."""


class Unfolded:
    """The straight ways from a place to the edges of cells, face by face, and to vertices where ways may bend."""

    def __init__(self, mesh: sb.Mesh, cells: sb.GeodesicVoronoi, patience: float = np.inf) -> None:
        self.patience = patience
        self.triangles = mesh.triangles.tolist()
        corners = mesh.vertices[mesh.triangles]
        self.lengths = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)  # from corner i to i + 1
        self.flat = _flat(corners)
        self.beside = {(a, b): (f, i) for f, t in enumerate(self.triangles) for i, (a, b) in enumerate(_sides(t))}
        self.faces_at: dict[int, list[int]] = {}
        for face, triangle in enumerate(self.triangles):
            for vertex in triangle:
                self.faces_at.setdefault(vertex, []).append(face)
        self.segments = _segments_by_face(self.triangles, cells)
        self.bends = _bending(self)
        self.by_edges = self._ways_by_edges()
        self.looks: dict[int, tuple[float, dict[int, float]]] = {}

    def distance(self, face: int, weights: Floats) -> float:
        """From a place to the nearest edge of a cell; infinity where none is."""
        flat = self.flat[face]
        place = weights @ flat
        corners = zip(self.triangles[face], np.linalg.norm(flat - place, axis=1), strict=True)
        no_more = min(way + self.by_edges.get(v, np.inf) for v, way in corners)
        if not np.isfinite(no_more):
            return np.inf
        best, seen = self._look(face, flat - place, no_more)
        queue = sorted((way, vertex) for vertex, way in seen.items())
        done: set[int] = set()
        while queue and queue[0][0] < best:
            way, vertex = heappop(queue)
            if vertex in done:
                continue
            done.add(vertex)
            straight, seen = self._look_from(vertex)
            best = min(best, way + straight)
            for other, step in seen.items():
                heappush(queue, (way + step, other))
        return best

    def _look_from(self, vertex: int) -> tuple[float, dict[int, float]]:
        """The same from a vertex."""
        if vertex not in self.looks:
            best, seen = self.by_edges[vertex], {}
            for face in self.faces_at[vertex]:
                flat, i = self.flat[face], self.triangles[face].index(vertex)
                best, others = self._look(face, flat - flat[i], best, (i + 1) % 3)
                seen.update({v: min(way, seen.get(v, np.inf)) for v, way in others.items()})
            self.looks[vertex] = (best, seen)
        return self.looks[vertex]

    def _ways_by_edges(self) -> dict[int, float]:
        """Lengths of ways along the mesh's edges to the edges of cells, which are never too short."""
        queue: list[tuple[float, int]] = []
        for face, pieces in self.segments.items():
            flat = self.flat[face]
            for i, vertex in enumerate(self.triangles[face]):
                queue.append((min(_to_segment(a @ flat - flat[i], b @ flat - flat[i]) for a, b in pieces), vertex))
        queue.sort()
        found: dict[int, float] = {}
        while queue:
            way, vertex = heappop(queue)
            if vertex in found:
                continue
            found[vertex] = way
            for face in self.faces_at[vertex]:
                i = self.triangles[face].index(vertex)
                heappush(queue, (way + self.lengths[face][i], self.triangles[face][(i + 1) % 3]))
                heappush(queue, (way + self.lengths[face][i - 1], self.triangles[face][i - 1]))
        return found

    def _look(self, face: int, corners: Floats, best: float, only: int | None = None) -> tuple[float, dict[int, float]]:
        """From the origin, in a plane where the face's corners are: the shortest straight way, and vertices in sight.

        Ways of `best` or more are none. `only`: the one side across which to go on, opposite to the origin at a corner.
        """
        seen: dict[int, float] = {}
        triangle = self.triangles[face]
        for a, b in self.segments.get(face, ()):
            best = min(best, _to_segment(a @ corners, b @ corners))
        for i in range(3):
            self._see(triangle[i], corners[i], seen)
        rest = []
        for i, (a, b) in enumerate(_sides(triangle)):
            if only is None or i == only:
                rest.append((b, a, corners[(i + 1) % 3], corners[i], corners[i], corners[(i + 1) % 3]))
        while rest:
            self.patience -= 1
            if self.patience < 0:
                raise TooManyWaysError
            # From the side (v, w) of the face beyond, with v on the left of whom looks; between two rays.
            v, w, at_v, at_w, right, left = rest.pop()
            beside = self.beside.get((v, w))
            if beside is None or _cross(right, left) <= 0:
                continue
            visible = _within(at_w, at_v, right, left)
            if visible is None or _to_segment(*visible) >= best:
                continue
            other, i = beside
            self.patience -= len(self.segments.get(other, ()))
            flat = self.flat[other]
            along = (at_w - at_v) / self.lengths[other][i]
            frame = np.array([along, [-along[1], along[0]]])
            own = (flat[(i + 1) % 3] - flat[i]) / self.lengths[other][i]
            turned = (flat - flat[i]) @ np.array([own, [-own[1], own[0]]]).T
            there = at_v + turned @ frame
            apex, tip = there[(i + 2) % 3], self.triangles[other][(i + 2) % 3]
            for a, b in self.segments.get(other, ()):
                part = _within(a @ there, b @ there, right, left)
                if part is not None:
                    best = min(best, _to_segment(*part))
            if _cross(right, apex) >= 0 and _cross(apex, left) >= 0:
                self._see(tip, apex, seen)
            rest.append((tip, w, apex, at_w, right, apex if _cross(apex, left) > 0 else left))
            rest.append((v, tip, at_v, apex, apex if _cross(right, apex) > 0 else right, left))
        return best, seen

    def _see(self, vertex: int, at: Floats, seen: dict[int, float]) -> None:
        if vertex in self.bends:
            seen[vertex] = min(seen.get(vertex, np.inf), float(np.hypot(*at)))


def _flat(corners: Floats) -> Floats:
    """(F, 3, 2) the corners of each face (F, 3, 3) in its plane: the first at the origin, the second on the x axis."""
    first, last = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    length = np.linalg.norm(first, axis=1)
    flat = np.zeros((len(corners), 3, 2))
    flat[:, 1, 0] = length
    flat[:, 2, 0] = np.einsum("ij,ij->i", first, last) / length
    flat[:, 2, 1] = np.linalg.norm(np.cross(first, last), axis=1) / length
    return flat


def _sides(triangle: list[int]) -> list[tuple[int, int]]:
    return [(triangle[i], triangle[(i + 1) % 3]) for i in range(3)]


def _segments_by_face(triangles: list[list[int]], cells: sb.GeodesicVoronoi) -> dict[int, list[tuple[Floats, Floats]]]:
    """Weights of the ends of the pieces of all edges between cells, in every face that they lie in."""
    found: dict[int, list[tuple[Floats, Floats]]] = {}
    about: dict[int, set[int]] = {}
    for face, triangle in enumerate(triangles):
        for vertex in triangle:
            about.setdefault(vertex, set()).add(face)
    for edge in cells.edges:
        ends = [
            {v: float(w) for v, w in zip(triangles[face], weights, strict=True) if w > 0}
            for face, weights in zip(edge.surface.faces, edge.surface.barycentric, strict=True)
        ]
        for one, other in pairwise(ends):
            for face in set.intersection(*(about[v] for v in one | other)):
                a, b = (np.array([end.get(v, 0.0) for v in triangles[face]]) for end in (one, other))
                found.setdefault(face, []).append((a, b))
    return found


def _bending(unfolded: Unfolded) -> set[int]:
    """Vertices with more than a full turn about them, or on the border."""
    angles: dict[int, float] = {}
    for face, triangle in enumerate(unfolded.triangles):
        flat = unfolded.flat[face]
        for i, vertex in enumerate(triangle):
            a, b = flat[(i + 1) % 3] - flat[i], flat[(i + 2) % 3] - flat[i]
            angles[vertex] = angles.get(vertex, 0.0) + float(np.arctan2(_cross(a, b), a @ b))
    border = {v for a, b in unfolded.beside if (b, a) not in unfolded.beside for v in (a, b)}
    return border | {v for v, angle in angles.items() if angle > 2 * np.pi - 1e-9}


def _cross(a: Floats, b: Floats) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def _to_segment(a: Floats, b: Floats) -> float:
    along = b - a
    squared = float(along @ along)
    share = min(1.0, max(0.0, float(-a @ along) / squared)) if squared > 0 else 0.0
    return float(np.hypot(*(a + share * along)))


def _within(a: Floats, b: Floats, right: Floats, left: Floats) -> tuple[Floats, Floats] | None:
    """The part of a segment between two rays from the origin."""
    low, high = 0.0, 1.0
    for at_a, at_b in ((_cross(right, a), _cross(right, b)), (_cross(a, left), _cross(b, left))):
        if at_a < 0 and at_b < 0:
            return None
        if at_a < 0:
            low = max(low, at_a / (at_a - at_b))
        elif at_b < 0:
            high = min(high, at_a / (at_a - at_b))
    return (a + low * (b - a), a + high * (b - a)) if low <= high else None


def atlas(face_count: int, rng: Random) -> Floats:
    """(3 F, 2) UV places: a square of a grid for each face, in which it is any triangle that is no needle."""
    side = int(np.ceil(np.sqrt(face_count)))
    places = np.empty((face_count, 3, 2))
    for face in range(face_count):
        while True:
            corners = rng.random((3, 2))
            if abs(_cross(corners[1] - corners[0], corners[2] - corners[0])) > 0.2:
                break
        places[face] = (np.array([face % side, face // side]) + corners) / side
    return places.reshape(-1, 2).astype(np.float32).astype(np.float64)


def weights_at(uv: Floats, triangles: NDArray[np.integer], places: Floats) -> Floats:
    """(n, 3) barycentric coordinates of places (n, 2) in triangles of a UV map (3 F, 2)."""
    corners = uv.reshape(-1, 3, 2)[triangles]
    sides = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=2)
    weights = np.linalg.solve(sides, (places - corners[:, 0])[:, :, None])[:, :, 0]
    return np.column_stack([1 - weights.sum(axis=1), weights])


def surface_points(triangles: NDArray[np.integer], weights: Floats) -> sb.SurfacePoints:
    positive = np.clip(weights, 0, None)
    return sb.SurfacePoints(triangles.astype(np.int32), positive / positive.sum(axis=1, keepdims=True))


@guards("bake_cells", "BakedCells")
def texels_of_cells(mesh: sb.Mesh, rng: Random) -> None:
    """Each texel's face, cell, distance to the cell's edge, and logarithm are what is found of it alone."""
    graph = sb.SaddleVertexGraph(mesh, threads=1)
    cells = sb.geodesic_voronoi(graph, random_sites(mesh, rng, 12), threads=1, exact=bool(rng.integers(2)))
    uv, size = atlas(mesh.face_count, rng), tuple(int(n) for n in rng.integers(20, 90, 2))
    values = rng.normal(size=(3 * mesh.face_count, 2))
    baked = sb.bake_cells(cells, uv, values=values, size=size, margin=int(rng.integers(4)), threads=1)
    assert not len(baked.overlapping)
    rows, columns = np.nonzero(baked.triangle >= 0)
    places = (np.column_stack([columns, rows]) + 0.5) / size
    faces = baked.triangle[rows, columns]
    weights = weights_at(uv, faces, places)
    assert (weights > -SURE).all(), "a texel is outside its triangle"
    inside = np.zeros(baked.triangle.shape, bool)
    grid = (np.stack(np.meshgrid(*(np.arange(n) for n in size)), axis=2) + 0.5) / size
    for face in range(mesh.face_count):
        within = weights_at(uv, np.full(grid[..., 0].size, face), grid.reshape(-1, 2)) > SURE
        inside |= within.all(axis=1).reshape(inside.shape)
    assert not (inside & (baked.triangle < 0)).any(), "a texel inside a triangle is empty"
    expected = np.einsum("ni,nik->nk", weights, values.reshape(-1, 3, 2)[faces])
    np.testing.assert_allclose(baked.values[rows, columns], expected, atol=1e-5)
    some = rng.choice(len(rows), min(len(rows), 25), replace=False)
    rows, columns, faces, weights = rows[some], columns[some], faces[some], weights[some]
    points = surface_points(faces, weights)
    check_cells(cells, points, baked.cell[rows, columns], baked.edge_distance[rows, columns], mesh)
    check_logarithms(mesh, cells, points, baked.cell[rows, columns], baked.local_uv[rows, columns].astype(float))
    truth = Unfolded(mesh, cells, PATIENCE)
    if truth.lengths.max() > GRADED * truth.lengths.min():
        return
    try:
        wanted = [truth.distance(int(f), w) for f, w in zip(points.faces, points.barycentric, strict=True)]
    except TooManyWaysError:
        return
    atol = 2e-7 * longest_edge(mesh)
    np.testing.assert_allclose(baked.edge_distance[rows, columns], wanted, rtol=2e-7, atol=atol)


def check_cells(
    cells: sb.GeodesicVoronoi, points: sb.SurfacePoints, found: NDArray[np.int32], to_edge: Floats, mesh: sb.Mesh
) -> None:
    """Beyond the rounding of outlines, which of exact cells are as near as a hundred-thousandth of a cell."""
    sure = to_edge > 1e-4 * longest_edge(mesh)
    assert (found == cells.cells_at(points))[sure].all()


def check_logarithms(
    mesh: sb.Mesh, cells: sb.GeodesicVoronoi, points: sb.SurfacePoints, own: NDArray[np.int32], uv: Floats
) -> None:
    """As long as the distance from the site; and, where no vertex bends the way, traced from there they end there."""
    size, length = longest_edge(mesh), np.linalg.norm(uv, axis=1)
    for cell in np.unique(own):
        site = sb.SurfacePoints(cells.sites.faces[[cell]], cells.sites.barycentric[[cell]])
        here = own == cell
        these = sb.SurfacePoints(points.faces[here], points.barycentric[here])
        exact = sb.ExactField(mesh, site).distance_to(these)
        np.testing.assert_allclose(length[here], exact, rtol=2e-7, atol=2e-7 * size)
        if len(mesh.saddle_vertices) == 0:
            off = np.linalg.norm(sb.exp_map(mesh, site, uv[here]).positions(mesh) - these.positions(mesh), axis=1)
            assert (off <= 1e-5 * size).all(), f"traced {off.max()} beside the texel"

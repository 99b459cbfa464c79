# SPDX-License-Identifier: MIT
"""Meshes made in code, by property: closed(), boundary(), good() (both), broken().

Each is a `Case`: arrays, what is known about them in closed form, and `mesh`, built on demand. Use as
``@pytest.mark.parametrize("case", meshes.closed(), ids=str)``.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import saddleback as sb

Floats = NDArray[np.float64]
Indices = NDArray[np.int32]
Arrays = tuple[Floats, Indices]


@dataclass(frozen=True, eq=False)
class Case:
    """A mesh and what is known of it. `fault` names what is wrong with a broken one."""

    name: str
    vertices: Floats
    triangles: Indices
    genus: int = 0
    loops: int = 0
    components: int = 1
    fault: str = ""

    def __str__(self) -> str:
        return self.name

    @functools.cached_property
    def mesh(self) -> sb.Mesh:
        return sb.Mesh(self.vertices, self.triangles)


def _arrays(vertices: object, triangles: object) -> Arrays:
    return np.array(vertices, dtype=np.float64).reshape(-1, 3), np.array(triangles, dtype=np.int32).reshape(-1, 3)


def merge(*parts: Arrays) -> Arrays:
    """The parts as one list, without joining anything."""
    starts = np.cumsum([0] + [len(vertices) for vertices, _ in parts[:-1]])
    return (
        np.concatenate([vertices for vertices, _ in parts]),
        np.concatenate([triangles + np.int32(start) for (_, triangles), start in zip(parts, starts, strict=True)]),
    )


# --- with boundary ----------------------------------------------------------------------------------------------------


def grid(columns: int = 12, rows: int = 12, jitter: float = 0.0, seed: int = 0) -> Arrays:
    """The unit square of the plane z = 0; inner vertices move by up to `jitter` of a cell."""
    x, y = np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows))
    vertices = np.column_stack([x.ravel(), y.ravel(), np.zeros(columns * rows)])
    inner = (vertices[:, :2] > 0).all(axis=1) & (vertices[:, :2] < 1).all(axis=1)
    moves = np.random.default_rng(seed).uniform(-jitter, jitter, (int(inner.sum()), 2))
    vertices[inner, :2] += moves / (columns - 1, rows - 1)
    return vertices, _grid_triangles(columns, rows)


def spike_on_a_plate(height: float, count: int = 12) -> Arrays:
    """Needles from a bent ring (vertices 0 to count - 1) within a plate to a tip (the last vertex)."""
    turn = 2 * np.pi * np.arange(count) / count
    ring = np.column_stack([np.cos(turn), np.sin(turn), 0.5 * np.cos(turn)])
    sides = [(i, (i + 1) % count) for i in range(count)]
    plate = [[i, count + i, count + j] for i, j in sides] + [[i, count + j, j] for i, j in sides]
    needles = [[2 * count, i, j] for i, j in sides]
    return np.vstack([ring, 3 * ring, [[0, 0, height]]]), np.array(plate + needles)


def spikes(size: int = 60, height: float = 10.0, seed: int = 1) -> Arrays:
    """A grid whose vertices are so high and low that hardly any see each other along the surface."""
    vertices, triangles = grid(size, size)
    vertices[:, 2] = height / (size - 1) * np.random.default_rng(seed).random(len(vertices))
    return vertices, triangles


def _grid_triangles(columns: int, rows: int) -> Indices:
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    lower = np.column_stack([corner, corner + 1, corner + columns + 1])
    upper = np.column_stack([corner, corner + columns + 1, corner + columns])
    return np.stack([lower, upper], axis=1).reshape(-1, 3).astype(np.int32)


def _wrap(around: int, along: int, closed_along: bool = False, flip: bool = False) -> Indices:
    """Triangles of a tube of `along` rings of `around` vertices; `flip` mirrors the last ring (a Moebius strip)."""
    triangles = []
    rings = along if closed_along else along - 1
    for j in range(rings):
        last = j == along - 1
        for i in range(around - 1 if flip else around):
            a, b = j * around + i, j * around + (i + 1) % around
            up = [(around - 1 - k if last and flip else k) + ((j + 1) % along) * around for k in (i, (i + 1) % around)]
            triangles += [(a, b, up[1]), (a, up[1], up[0])]
    return np.array(triangles, dtype=np.int32)


def cylinder(around: int = 24, along: int = 9, radius: float = 1.0, height: float = 2.0) -> Arrays:
    """An open, developable cylinder about z, outward."""
    angle, z = np.meshgrid(2 * np.pi * np.arange(around) / around, np.linspace(0, height, along))
    vertices = np.column_stack([radius * np.cos(angle).ravel(), radius * np.sin(angle).ravel(), z.ravel()])
    return vertices, _wrap(around, along)


def cone(around: int = 24, along: int = 8, radius: float = 1.0, height: float = 1.5) -> Arrays:
    """An open cone: the apex is vertex 0, its total angle below 2 pi."""
    share = np.arange(1, along + 1) / along
    angle = 2 * np.pi * np.arange(around) / around
    ring = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    rings = [np.column_stack([s * ring, np.full(around, height * (1 - s))]) for s in share]
    vertices = np.concatenate([np.array([[0.0, 0.0, height]]), *rings])
    apex = [(0, 1 + i, 1 + (i + 1) % around) for i in range(around)]
    sides = _wrap(around, along)[:, ::-1] + 1  # rings go down: reversed to face outward
    return vertices, np.concatenate([np.array(apex, dtype=np.int32), sides]).astype(np.int32)


def saddle(size: int = 13) -> Arrays:
    """The graph of x^2 - y^2: every inner vertex has more than 2 pi around it."""
    vertices, triangles = grid(size, size)
    vertices[:, :2] = 2 * vertices[:, :2] - 1
    vertices[:, 2] = vertices[:, 0] ** 2 - vertices[:, 1] ** 2
    return vertices, triangles


def needles(columns: int = 4, rows: int = 200) -> Arrays:
    """A flat strip whose triangles are about 1000 times longer than wide."""
    vertices, triangles = grid(columns, rows)
    return vertices * (15.0, 1.0, 1.0), triangles


def graded_disk(finest: float = 1e-6, rings: int = 80, around: int = 20) -> Arrays:
    """A flat disk about vertex 0; the rings' radii fall from 1 to `finest` by a constant factor."""
    angle = 2 * np.pi * np.arange(around) / around
    radii = np.geomspace(finest, 1, rings)[:, None]
    x, y = (radii * np.cos(angle)).ravel(), (radii * np.sin(angle)).ravel()
    vertices = np.vstack([np.zeros((1, 3)), np.column_stack([x, y, np.zeros(len(x))])])
    center = [(0, 1 + i, 1 + (i + 1) % around) for i in range(around)]
    return vertices, np.concatenate([np.array(center, dtype=np.int32), _wrap(around, rings)[:, ::-1] + 1]).astype(
        np.int32
    )


def holes(size: int = 13) -> Arrays:
    """A flat grid with two square holes."""
    vertices, triangles = grid(size, size)
    middle = vertices[triangles].mean(axis=1)
    inside = [(np.abs(middle[:, :2] - center) < 0.14).all(axis=1) for center in ((0.3, 0.3), (0.7, 0.65))]
    return without_unused(vertices, triangles[~(inside[0] | inside[1])])


def without_unused(vertices: Floats, triangles: Indices) -> Arrays:
    """Drop vertices of no face."""
    used, inverse = np.unique(triangles, return_inverse=True)
    return vertices[used], inverse.reshape(-1, 3).astype(np.int32)


# --- closed -----------------------------------------------------------------------------------------------------------


def tetrahedron() -> Arrays:
    """Regular, vertices at alternate corners of a cube, outward."""
    return _arrays([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)], [(0, 1, 2), (0, 2, 3), (0, 3, 1), (1, 3, 2)])


def cube() -> Arrays:
    """The unit cube, outward, two triangles a side."""
    return voxels(np.ones((1, 1, 1), dtype=bool))


def icosphere(level: int = 2, radius: float = 1.0) -> Arrays:
    """A subdivided icosahedron on the sphere, outward: 10 * 4^level + 2 vertices."""
    g = (1 + 5**0.5) / 2
    vertices, triangles = _arrays(
        [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g),
         (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)],
        [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
         (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8),
         (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)],
    )  # fmt: skip
    for _ in range(level):
        vertices, triangles = subdivide(vertices, triangles)
        vertices = vertices / np.linalg.norm(vertices, axis=1)[:, None]
    return radius * vertices / np.linalg.norm(vertices, axis=1)[:, None], triangles


def subdivide(vertices: Floats, triangles: Indices) -> Arrays:
    """Every triangle into four, in its own plane."""
    ends = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    edges, inverse = np.unique(ends, axis=0, return_inverse=True)
    x, y, z = inverse.reshape(3, -1) + len(vertices)
    p, q, r = triangles.T
    split = np.stack([np.stack(t, axis=1) for t in ((p, x, z), (x, q, y), (z, y, r), (x, y, z))], axis=1)
    return np.concatenate([vertices, vertices[edges].mean(axis=1)]), split.reshape(-1, 3).astype(np.int32)


def refined(vertices: Floats, triangles: Indices, within: NDArray[np.bool_]) -> Arrays:
    """Edges between two vertices of a set (V,) are halved; faces with some of them become two, three or four."""
    ends = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    edges, inverse = np.unique(ends, axis=0, return_inverse=True)
    is_halved = within[edges].all(axis=1)
    middle = np.where(is_halved, len(vertices) + np.cumsum(is_halved) - 1, -1)[inverse.reshape(3, -1).T]
    count = (middle >= 0).sum(axis=1)
    # Turned so that one halved edge comes first, or one whole edge last.
    first = np.where(count == 2, np.argmin(middle >= 0, axis=1) + 1, np.argmax(middle >= 0, axis=1))
    turned = (np.arange(3) + first[:, None]) % 3
    p, q, r = np.take_along_axis(triangles, turned, 1).T
    x, y, z = np.take_along_axis(middle, turned, 1).T
    kinds = (
        ((p, q, r),),
        ((p, x, r), (x, q, r)),
        ((x, q, y), (p, x, y), (p, y, r)),
        ((p, x, z), (x, q, y), (z, y, r), (x, y, z)),
    )
    faces = [np.stack(t, axis=1)[count == number] for number, kind in enumerate(kinds) for t in kind]
    halves = vertices[edges[is_halved]].mean(axis=1)
    return np.concatenate([vertices, halves]), np.concatenate(faces).astype(np.int32)


def torus(around: int = 36, tube: int = 14, radius: float = 1.0, tube_radius: float = 0.35) -> Arrays:
    """About z, outward."""
    u, v = np.meshgrid(2 * np.pi * np.arange(tube) / tube, 2 * np.pi * np.arange(around) / around)
    ring = radius + tube_radius * np.cos(u)
    vertices = np.column_stack(
        [(ring * np.cos(v)).ravel(), (ring * np.sin(v)).ravel(), (tube_radius * np.sin(u)).ravel()]
    )
    return vertices, _wrap(tube, around, closed_along=True)[:, ::-1].copy()


def lathed(radii: Sequence[float], steps: Sequence[float], around: int) -> Arrays:
    """A profile turned about z, open at both ends, outward: rows of these radii, so far above one another."""
    angle = 2 * np.pi * np.arange(around) / around
    ring = np.asarray(radii)[:, None]
    height = np.broadcast_to(np.concatenate([[0], np.cumsum(steps)])[:, None], (len(radii), around))
    vertices = np.column_stack([(ring * np.cos(angle)).ravel(), (ring * np.sin(angle)).ravel(), height.ravel()])
    return vertices, _wrap(around, len(radii))


def voxels(occupied: NDArray[np.bool_]) -> Arrays:
    """The surface of unit cubes, outward; manifold as long as no two cubes touch in an edge or corner only."""
    solid = np.pad(occupied, 1)
    faces = []
    for axis in range(3):
        for side in (-1, 1):
            open_side = solid & ~np.roll(solid, -side, axis)
            u, v = np.eye(3, dtype=int)[(axis + 1) % 3], np.eye(3, dtype=int)[(axis + 2) % 3]
            base = np.argwhere(open_side) + (np.eye(3, dtype=int)[axis] if side > 0 else 0)
            quad = [base, base + u, base + u + v, base + v]
            faces.append(np.stack(quad if side > 0 else quad[::-1], axis=1))
    corners = np.concatenate(faces)
    points, inverse = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    quads = inverse.reshape(-1, 4)
    triangles = np.stack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]], axis=1).reshape(-1, 3)
    return points.astype(np.float64) - 1, triangles.astype(np.int32)


def bored_plate(around: int = 48, radius: float = 0.9, height: float = 0.5) -> Arrays:
    """A square plate of side 2 with a round hole, parted as modelers do: each corner to a quarter of the rim."""
    angles = 2 * np.pi * (np.arange(around) + 0.5) / around
    rim = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    outline = np.vstack([[[1, 1], [-1, 1], [-1, -1], [1, -1]], rim])
    count, quarter = len(outline), around // 4
    top = []
    for corner in range(4):
        on_rim = [4 + (corner * quarter + i) % around for i in range(quarter + 1)]
        top += [(corner, b, a) for a, b in itertools.pairwise(on_rim)]
        top.append((corner, (corner + 1) % 4, on_rim[-1]))
    walls = [(i, (i + 1) % 4) for i in range(4)] + [(4 + (i + 1) % around, 4 + i) for i in range(around)]
    bottom = [(count + a, count + c, count + b) for a, b, c in top]
    sides = [side for a, b in walls for side in ((b, a, count + a), (b, count + a, count + b))]
    vertices = np.vstack([np.column_stack([outline, np.full(count, z)]) for z in (height, 0.0)])
    return _arrays(vertices, top + bottom + sides)


def double_torus() -> Arrays:
    """A plate with two square holes, refined once and softened: genus 2."""
    plate = np.ones((7, 5, 2), dtype=bool)
    plate[1:3, 1:4] = plate[4:6, 1:4] = False
    vertices, triangles = subdivide(*voxels(plate))
    ends = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    for _ in range(3):
        total, degree = np.zeros_like(vertices), np.bincount(ends[:, 0], minlength=len(vertices))
        np.add.at(total, ends[:, 0], vertices[ends[:, 1]])
        vertices = 0.5 * vertices + 0.5 * total / degree[:, None]
    return vertices, triangles


def two_components() -> Arrays:
    """A sphere and a torus that stand apart."""
    vertices, triangles = torus(24, 10)
    return merge(icosphere(1), (vertices + np.array([3.0, 0.0, 0.0]), triangles))


# --- broken -----------------------------------------------------------------------------------------------------------


def moebius(along: int = 40, across: int = 5, width: float = 0.6) -> Arrays:
    """A strip with half a twist: no orientation exists."""
    turn, offset = np.meshgrid(2 * np.pi * np.arange(along) / along, np.linspace(-width, width, across), indexing="ij")
    ring = 1 + offset / 2 * np.cos(turn / 2)
    vertices = np.stack([ring * np.cos(turn), ring * np.sin(turn), offset / 2 * np.sin(turn / 2)], axis=-1)
    return vertices.reshape(-1, 3), _wrap(across, along, closed_along=True, flip=True)


def bow_tie() -> Arrays:
    """Two tetrahedra that share one vertex."""
    vertices, triangles = merge(tetrahedron(), tetrahedron())
    vertices[4:] += 2.0
    triangles[triangles == 7] = 0
    vertices[4:7] = [(3, 3, 1), (3, 1, 3), (1, 3, 3)]
    return without_unused(vertices, triangles)


def non_manifold_edge(wings: int = 3) -> Arrays:
    """Triangles fanned about one edge, all in the same direction along it but the second."""
    angle = 2 * np.pi * np.arange(wings) / wings
    vertices = [(0, 0, 0), (0, 0, 1), *np.column_stack([np.cos(angle), np.sin(angle), np.full(wings, 0.5)])]
    return _arrays(vertices, [(1, 0, 2 + i) if i == 1 else (0, 1, 2 + i) for i in range(wings)])


def soup() -> Arrays:
    """A torus whose triangles share no vertex."""
    vertices, triangles = torus(24, 10)
    return vertices[triangles].reshape(-1, 3), np.arange(3 * len(triangles), dtype=np.int32).reshape(-1, 3)


def with_nan() -> Arrays:
    vertices, triangles = icosphere(2)
    vertices[17, 1] = np.nan
    return vertices, triangles


def collapsed_edge() -> Arrays:
    """A sphere with two neighbors at one place: two faces without area, two vertices that coincide."""
    vertices, triangles = icosphere(2)
    vertices[triangles[30, 0]] = vertices[triangles[30, 1]]
    return vertices, triangles


def with_cap() -> Arrays:
    """A tetrahedron-like closed mesh with a fourth corner on the middle of an edge: one face is a collinear cap."""
    vertices, triangles = tetrahedron()
    middle = (vertices[0] + vertices[1]) / 2
    # Face (0, 1, 2) becomes (0, 4, 2), (4, 1, 2) and the cap (0, 1, 4): its long edge still meets face (0, 3, 1).
    return _arrays([*vertices, middle], [(0, 4, 2), (4, 1, 2), (0, 1, 4), *triangles[1:]])


def mixed_orientation() -> Arrays:
    vertices, triangles = icosphere(2)
    triangles[::3] = triangles[::3, ::-1]
    return vertices, triangles


def _case(name: str, arrays: Arrays, genus: int = 0, loops: int = 0, components: int = 1, fault: str = "") -> Case:
    return Case(name, *arrays, genus=genus, loops=loops, components=components, fault=fault)


@functools.cache
def closed() -> tuple[Case, ...]:
    return (
        _case("tetrahedron", tetrahedron()),
        _case("cube", cube()),
        _case("icosphere", icosphere(3)),
        _case("torus", torus(), genus=1),
        _case("double_torus", double_torus(), genus=2),
        _case("two_components", two_components(), genus=1, components=2),
    )


@functools.cache
def boundary() -> tuple[Case, ...]:
    return (
        _case("triangle", _arrays([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]), loops=1),
        _case("grid", grid(), loops=1),
        _case("grid_jittered", grid(jitter=0.3, seed=1), loops=1),
        _case("cylinder", cylinder(), loops=2),
        _case("cone", cone(), loops=1),
        _case("saddle", saddle(), loops=1),
        _case("needles", needles(), loops=1),
        _case("holes", holes(), loops=3),
    )


def good() -> tuple[Case, ...]:
    return closed() + boundary()


@functools.cache
def broken() -> tuple[Case, ...]:
    sphere_v, sphere_t = icosphere(2)
    with_repeat = np.vstack([sphere_t, np.array([(3, 3, 9)], dtype=np.int32)])
    return (
        _case("moebius", moebius(), fault="opposite orientation"),
        _case("bow_tie", bow_tie(), fault="non-manifold vertex"),
        _case("non_manifold_edge", non_manifold_edge(), fault="non-manifold edge"),
        _case("four_wings", non_manifold_edge(4), fault="non-manifold edge"),
        _case("nan", with_nan(), fault="not finite"),
        _case("collapsed_edge", collapsed_edge(), fault="no area"),
        _case("cap", with_cap(), fault="no area"),
        _case("mixed_orientation", mixed_orientation(), fault="opposite orientation"),
        _case("repeated_index", (sphere_v, with_repeat), fault="uses a vertex twice"),
        _case("duplicate_face", (sphere_v, np.vstack([sphere_t, sphere_t[5, [1, 2, 0]]])), fault="duplicate face"),
        _case("mirrored_duplicate", (sphere_v, np.vstack([sphere_t, sphere_t[5, ::-1]])), fault="duplicate face"),
        _case("unreferenced", (np.vstack([sphere_v, [(5, 5, 5)]]), sphere_t), fault="belongs to no face"),
    )

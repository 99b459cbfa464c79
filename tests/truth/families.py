# SPDX-License-Identifier: MIT
"""Random meshes and sites of every kind that once broke something, and of kinds that did not yet.

A family is a function of a random generator that returns vertices (V, 3) and triangles (F, 3), of some 4 to 300 faces.
Not all are good meshes: the runner repairs what `Mesh` refuses.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, Delaunay, QhullError

import saddleback as sb
from tests import meshes

Floats = NDArray[np.float64]
Arrays = tuple[Floats, NDArray[np.int32]]
Random = np.random.Generator


def small_number(rng: Random, coarsest: float = 1e-1, finest: float = 1e-12) -> float:
    """A magnitude, spread evenly over the powers of ten."""
    return float(np.exp(rng.uniform(np.log(finest), np.log(coarsest))))


def delaunay(points: Floats) -> Arrays:
    """The plane z = 0 over these points (n, 2), triangulated; what coincides too nearly is left out."""
    try:
        triangles = Delaunay(points).simplices.astype(np.int32)
    except QhullError:
        return meshes.grid(3, 3)
    a, b, c = (points[triangles[:, i]] for i in range(3))
    turn = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    triangles[turn < 0] = triangles[turn < 0][:, ::-1]
    return meshes.without_unused(np.column_stack([points, np.zeros(len(points))]), triangles[turn != 0])


def square(points: Floats) -> Floats:
    """The points with the four corners of the unit square."""
    return np.vstack([points, [(0, 0), (1, 0), (0, 1), (1, 1)]])


def jittered_grid(rng: Random) -> Arrays:
    columns, rows = (int(count) for count in rng.integers(2, 11, 2))
    return meshes.grid(columns, rows, jitter=float(rng.choice([0.0, 0.2, 0.45])), seed=int(rng.integers(1 << 30)))


def near_coincident(rng: Random) -> Arrays:
    """A flat square where each of some points has a twin that is 1e-3 to 1e-9 away."""
    points = rng.random((int(rng.integers(2, 25)), 2))
    twins = points + small_number(rng, 1e-3, 1e-9) * rng.normal(size=points.shape)
    return delaunay(square(np.clip(np.vstack([points, twins]), 0, 1)))


def two_lines(rng: Random) -> Arrays:
    """A flat square with two lines of points, 1e-3 to 1e-9 apart."""
    count, gap, at = int(rng.integers(2, 21)), small_number(rng, 1e-3, 1e-9), rng.uniform(0.1, 0.9)
    along = np.sort(rng.random((2, count)), axis=1)
    line = np.vstack([np.column_stack([np.full(count, at + side * gap), along[side]]) for side in (0, 1)])
    return delaunay(square(line if rng.random() < 0.5 else line[:, ::-1]))


def graded_grid(rng: Random) -> Arrays:
    """A flat or bent grid whose columns and rows narrow by a constant factor."""
    columns, rows = rng.integers(3, 9, 2)
    x, y = (np.cumsum(rng.uniform(0.05, 1.0) ** np.arange(n)) for n in (columns, rows))
    vertices, triangles = meshes.grid(int(columns), int(rows))
    vertices[:, 0], vertices[:, 1] = np.tile(x, rows), np.repeat(y, columns)
    vertices[:, 2] = rng.choice([0.0, 0.3]) * vertices[:, 0] * vertices[:, 1]
    return vertices, triangles


def graded_disk(rng: Random) -> Arrays:
    return meshes.graded_disk(small_number(rng, 1e-2, 1e-12), int(rng.integers(2, 12)), int(rng.integers(3, 13)))


def parts_of_ratio(rng: Random) -> Arrays:
    """Two spheres or tetrahedra, the second 1 to 1e-12 of the first."""
    spheres = [meshes.tetrahedron(), meshes.icosphere(0), meshes.icosphere(1)]
    first, second = (spheres[rng.integers(3)] for _ in range(2))
    return meshes.merge((first[0] + [5.0, 0, 0], first[1]), (second[0] * small_number(rng, 1.0), second[1]))


def fan(rng: Random) -> Arrays:
    """A wheel about vertex 0: flat, a cone, or a saddle of total angle above 2 pi."""
    count = int(rng.choice([3, 10, 40, 150]))
    angle = 2 * np.pi * np.arange(count) / count
    height = float(rng.choice([0.0, 1.0, 0.0])) + rng.choice([0.0, 1.5]) * np.cos(2 * angle)
    ring = np.column_stack([np.cos(angle), np.sin(angle), height])
    return np.vstack([np.zeros((1, 3)), ring]), np.array(
        [(0, 1 + i, 1 + (i + 1) % count) for i in range(count)], dtype=np.int32
    )


def needle_ring(rng: Random) -> Arrays:
    """A cylinder of one ring of needles."""
    return meshes.cylinder(int(rng.choice([3, 10, 40, 120])), 2, height=float(rng.choice([0.01, 1.0, 50.0])))


def needles(rng: Random) -> Arrays:
    return meshes.needles(int(rng.integers(2, 5)), int(rng.integers(3, 30)))


def terrain(rng: Random) -> Arrays:
    """A rough height field far from the origin, as surveys have it."""
    size = int(rng.integers(3, 11))
    vertices, triangles = meshes.grid(size, size, jitter=0.3, seed=int(rng.integers(1 << 30)))
    vertices[:, 2] = rng.choice([0.02, 0.2, 1.0]) * rng.random(len(vertices))
    return vertices * rng.choice([1.0, 100.0]) + rng.choice([0.0, 1.0, 1e3]) * np.array([500.0, 5000.0, 0.1]), triangles


def plate(rng: Random) -> Arrays:
    """A body of unit cubes with holes and handles: flat faces, right angles, coplanar triangles of all sizes."""
    solid = np.ones((int(rng.integers(2, 5)), int(rng.integers(2, 5)), 1), dtype=bool)
    if min(solid.shape[:2]) >= 3 and rng.random() < 0.7:
        solid[1:-1:2, 1:-1:2] = False
    return meshes.voxels(solid)


def lattice(rng: Random) -> Arrays:
    """A row of cubes with a tunnel each: genus 1 to 12."""
    tunnels = int(rng.integers(1, 4))
    solid = np.ones((2 * tunnels + 1, 3, 1), dtype=bool)
    solid[1::2, 1] = False
    return meshes.voxels(solid)


def torus(rng: Random) -> Arrays:
    """A rough torus."""
    around, tube, thickness = int(rng.integers(5, 16)), int(rng.integers(3, 9)), float(rng.uniform(0.1, 0.6))
    vertices, triangles = meshes.torus(around, tube, 1.0, thickness)
    return vertices + rng.choice([0.0, 0.005, 0.05]) * rng.normal(size=vertices.shape), triangles


def sphere(rng: Random) -> Arrays:
    """A rough ellipsoid."""
    vertices, triangles = meshes.icosphere(int(rng.integers(0, 3)))
    rough = 1 + rng.choice([0.0, 0.1, 0.3]) * rng.random((len(vertices), 1))
    return vertices * rng.uniform(0.2, 1.0, 3) * rough, triangles


def convex(rng: Random) -> Arrays:
    """The hull of random points: every vertex is convex."""
    points = rng.normal(size=(int(rng.integers(4, 40)), 3))
    hull = ConvexHull(points)
    triangles = hull.simplices.astype(np.int32)
    a, b, c = (points[triangles[:, i]] for i in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    return meshes.without_unused(points, triangles)


def spikes(rng: Random) -> Arrays:
    return meshes.spikes(int(rng.integers(3, 11)), float(rng.choice([1.0, 10.0])), int(rng.integers(1 << 30)))


def folded(rng: Random) -> Arrays:
    """A strip of paper, folded flat or nearly so."""
    vertices, triangles = meshes.grid(int(rng.integers(3, 9)), 3)
    column = np.round(vertices[:, 0] * (vertices[:, 0] > 0).sum()).astype(int)
    vertices[:, 0] = np.abs((vertices[:, 0] * 4) % 2 - 1)
    vertices[:, 2] = small_number(rng, 1e-2, 1e-9) * column * rng.choice([0.0, 1.0, 1.0])
    return vertices, triangles


def soup(rng: Random) -> Arrays:
    """Triangles of a good mesh that share no vertex, or were turned at random."""
    vertices, triangles = torus(rng)
    if rng.random() < 0.5:
        return vertices[triangles].reshape(-1, 3), np.arange(3 * len(triangles), dtype=np.int32).reshape(-1, 3)
    turned = rng.random(len(triangles)) < 0.5
    triangles = np.where(turned[:, None], triangles[:, ::-1], triangles)
    return vertices, triangles


def moebius(rng: Random) -> Arrays:
    return meshes.moebius(int(rng.integers(6, 30)), int(rng.integers(2, 5)), float(rng.uniform(0.1, 0.6)))


def shrunk_region(rng: Random) -> Arrays:
    """A mesh a part of which is drawn together to 1e-1 to 1e-10 of its size."""
    vertices, triangles = rng.choice([sphere, torus, terrain])(rng)  # type: ignore[arg-type]
    center = vertices[rng.integers(len(vertices))]
    offset = vertices - center
    reach = np.linalg.norm(offset, axis=1)
    near = reach < rng.uniform(0.2, 0.6) * reach.max()
    vertices[near] = center + offset[near] * small_number(rng, 1e-1, 1e-10)
    return vertices, triangles


def single_triangle(rng: Random) -> Arrays:
    return rng.normal(size=(3, 3)), np.array([[0, 1, 2]], dtype=np.int32)


def thickened(vertices: Floats, triangles: NDArray[np.int32], offset: Floats | float) -> Arrays:
    """An open surface and its copy beneath, joined along the border; `offset` down along z, or of each vertex."""
    down = np.array([0.0, 0.0, offset]) if np.ndim(offset) == 0 else offset
    count = len(vertices)
    ends = {(a, b) for face in triangles.tolist() for a, b in zip(face, face[1:] + face[:1], strict=True)}
    rim = [(a, b) for a, b in sorted(ends) if (b, a) not in ends]
    walls = [side for a, b in rim for side in ((b, a, count + a), (b, count + a, count + b))]
    below = count + triangles[:, ::-1]
    return np.vstack([vertices, vertices - down]), np.vstack([triangles, below, *walls]).astype(np.int32)


def holed(columns: int, rows: int, around: int, radius: float, turn: float = 0.0) -> Arrays:
    """A flat plate with a hole in each unit square: round, or of four sides. Corners see a quarter of a rim each."""
    corners = np.stack(np.meshgrid(np.arange(columns + 1.0), np.arange(rows + 1.0)), axis=-1).reshape(-1, 2)
    angles = turn + 2 * np.pi * (np.arange(around) + 0.5) / around
    rim = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    points, triangles = [corners], []
    for cell in range(columns * rows):
        row, column = divmod(cell, columns)
        first, low = len(corners) + around * cell, row * (columns + 1) + column
        around_cell = [low + columns + 2, low + columns + 1, low, low + 1]
        points.append(rim + [column + 0.5, row + 0.5])
        for k, corner in enumerate(around_cell):
            seen = [first + (k * around // 4 + i) % around for i in range(around // 4 + 1)]
            triangles += [(corner, b, a) for a, b in itertools.pairwise(seen)]
            triangles.append((corner, around_cell[(k + 1) % 4], seen[-1]))
    flat = np.vstack(points)
    return np.column_stack([flat, np.zeros(len(flat))]), np.array(triangles, dtype=np.int32)


def ear_clipped(outline: Floats) -> Arrays:
    """A flat polygon (n, 2), counter-clockwise, whose first ear is cut off until none is left: long slivers."""

    def turn(a: int, b: int, c: int) -> float:
        (ax, ay), (bx, by), (cx, cy) = outline[[a, b, c]].tolist()
        return float((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))

    left, triangles = list(range(len(outline))), []
    while len(left) > 3:
        for i, tip in enumerate(left):
            a, b = left[i - 1], left[(i + 1) % len(left)]
            others = [v for v in left if v not in (a, tip, b)]
            if turn(a, tip, b) > 0 and all(min(turn(a, tip, v), turn(tip, b, v), turn(b, a, v)) < 0 for v in others):
                triangles.append((a, tip, b))
                left.remove(tip)
                break
        else:
            break
    flat = np.column_stack([outline, np.zeros(len(outline))])
    return flat, np.array([*triangles, left[:3]], dtype=np.int32)


def arc(center: tuple[float, float], radius: float, start: float, end: float, count: int) -> Floats:
    """Points (count + 1, 2) of a circle, ends included; clockwise where the end is the lesser angle."""
    angle = np.linspace(start, end, count + 1)
    return np.array(center) + radius * np.column_stack([np.cos(angle), np.sin(angle)])


def bored(rng: Random) -> Arrays:
    """A square plate with a round hole that leaves much or little of it."""
    around, radius = 4 * int(rng.integers(1, 13)), float(rng.uniform(0.1, 0.99))
    return meshes.bored_plate(around, radius, float(rng.uniform(0.01, 1.5)))


def perforated(rng: Random) -> Arrays:
    """A plate with rows of holes, thick or open."""
    columns, rows = (int(count) for count in rng.integers(1, 4, 2))
    around = 4 * int(rng.integers(1, 4))
    flat = holed(columns, rows, around, float(rng.uniform(0.05, 0.49)), float(rng.choice([0.0, 0.3])))
    return flat if rng.random() < 0.3 else thickened(*flat, float(rng.uniform(0.02, 1.0)))


def dented(rng: Random) -> Arrays:
    """A square plate with a bowl of small faces in its large ones, as booleans with a ball leave them."""
    around, rings, radius = 4 * int(rng.integers(1, 7)), int(rng.integers(2, 5)), float(rng.uniform(0.1, 0.49))
    flat, triangles = holed(1, 1, around, radius)
    middle, height = np.array([0.5, 0.5, 0.0]), np.array([0, 0, radius])
    steepness = np.pi / 2 * np.arange(1, rings)[:, None, None] / rings
    bowl = np.cos(steepness) * (flat[4:] - middle) - np.sin(steepness) * height + middle
    places = np.vstack([flat, bowl.reshape(-1, 3), [middle - height]])
    upper = 4 + np.arange(around * (rings - 1)).reshape(rings - 1, around)
    following = np.roll(upper, -1, axis=1)
    last, deepest = 4 + around * (rings - 1) + np.arange(around), np.full(around, len(places) - 1)
    parts = [(upper, following, following + around), (upper, following + around, upper + around)]
    parts.append((last, np.roll(last, -1), deepest))
    sides = [np.stack(part, axis=-1).reshape(-1, 3) for part in parts]
    return thickened(places, np.vstack([triangles, *sides]).astype(np.int32), float(rng.uniform(0.02, 1.5)))


def extruded(rng: Random) -> Arrays:
    """An outline with two flat caps: gear, bracket, comb, or a box less a cylinder at its corner or side."""
    kind, count = rng.integers(5), int(rng.integers(3, 16))
    if kind == 0:  # a gear
        angle = 2 * np.pi * (np.arange(4 * count) + rng.choice([0.0, 0.2])) / (4 * count)
        radius = np.where(np.arange(4 * count) % 4 < 2, 1.0, rng.uniform(0.6, 0.97))
        outline = radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    elif kind == 1:  # a bracket, its inner corner round
        leg, web = float(rng.uniform(0.05, 0.4)), float(rng.uniform(0.05, 0.4))
        fillet = float(rng.uniform(0.02, 0.2))
        inner = arc((web + fillet, leg + fillet), fillet, 1.5 * np.pi, np.pi, int(rng.integers(1, 8)))
        outline = np.vstack([[(0, 0), (1, 0), (1, leg)], inner, [(web, 1), (0, 1)]])
    elif kind == 2:  # a comb
        count = min(count, 8)
        depth, gap = rng.uniform(0.1, 0.95), rng.uniform(0.05, 0.9)
        notch = [[(1 - (k + 1 - gap) / count, 1.0), (1 - (k + 1 - gap) / count, 1 - depth)] for k in range(count)]
        back = [[(1 - (k + 1) / count, 1 - depth), (1 - (k + 1) / count, 1.0)] for k in range(count)]
        teeth = [point for k in range(count - 1) for point in notch[k] + back[k]]
        outline = np.array([(0, 0), (1, 0), (1, 1), *teeth, (0, 1)])
    elif kind == 3:  # less a cylinder at a corner
        bite = arc((1, 1), float(rng.uniform(0.1, 0.95)), 1.5 * np.pi, np.pi, count)
        outline = np.vstack([[(0, 0), (1, 0)], bite, [(0, 1)]])
    else:  # and at a side
        bite = arc((0.5, 1), float(rng.uniform(0.05, 0.49)), 0, -np.pi, count)
        outline = np.vstack([[(0, 0), (1, 0), (1, 1)], bite, [(0, 1)]])
    cap = ear_clipped(np.roll(outline, int(rng.integers(len(outline))), axis=0))
    return thickened(*cap, float(rng.uniform(0.02, 3)))


def shell(rng: Random) -> Arrays:
    """An open surface made solid: two sheets, thin or thick, joined along the border."""
    open_ones = (meshes.grid(6, 6), meshes.saddle(6), meshes.cylinder(12, 4), meshes.cone(12, 4), meshes.holes(9))
    vertices, triangles = open_ones[rng.integers(len(open_ones))]
    if rng.random() < 0.5:
        vertices = vertices + rng.uniform(0, 0.5) * np.column_stack([np.zeros((len(vertices), 2)), vertices[:, 0] ** 2])
    return thickened(vertices, triangles, small_number(rng, 0.2, 1e-3) * sb.vertex_normals(vertices, triangles))


def beams(rng: Random) -> Arrays:
    """A frame of beams, thin beside their lengths, of few long faces."""
    counts = rng.integers(1, 3, 3)
    cell = np.stack(np.meshgrid(*(np.arange(2 * n + 1) for n in counts), indexing="ij"), axis=-1)
    solid = (cell % 2 == 1).sum(axis=-1) <= rng.choice([1, 1, 2])
    vertices, triangles = meshes.voxels(solid)
    return stretched(vertices, float(rng.uniform(0.01, 0.5))), triangles


def stretched(vertices: Floats, thin: float) -> Floats:
    """Places on the lattice of integers, every other step of which is `thin` instead of 1."""
    at = np.round(vertices - vertices.min(axis=0)).astype(int)
    return np.cumsum(np.append(0, np.where(np.arange(at.max()) % 2 == 0, thin, 1.0)))[at]


def blocks(rng: Random) -> Arrays:
    """Boxes of all sizes joined at random."""
    solid = rng.random(rng.integers(1, 4, 3)) < rng.choice([0.5, 0.8])
    solid.flat[rng.integers(solid.size)] = True
    vertices, triangles = meshes.voxels(solid)
    widths = np.exp(rng.uniform(np.log(0.02), 0, (4, 3)))
    at = np.round(vertices - vertices.min(axis=0)).astype(int)
    lines = np.vstack([np.zeros((1, 3)), np.cumsum(widths, axis=0)])
    return np.column_stack([lines[at[:, axis], axis] for axis in range(3)]), triangles


FAMILIES: dict[str, Callable[[Random], Arrays]] = {
    family.__name__: family
    for family in (
        jittered_grid, near_coincident, two_lines, graded_grid, graded_disk, parts_of_ratio, fan, needle_ring, needles,
        terrain, plate, lattice, torus, sphere, convex, spikes, folded, soup, moebius, shrunk_region, single_triangle,
        bored, perforated, dented, extruded, shell, beams, blocks,
    )
}  # fmt: skip
KNOWN = (21, 28)
"""How many of the families a seed chooses from, by its trillion: whatever is added, it meets the mesh that it met."""
NEWEST = 10**12 * (len(KNOWN) - 1)
"""Seeds from here on choose from all of them."""


def random_mesh(seed: int) -> tuple[str, Arrays]:
    """A family's name and one of its meshes, sometimes at another unit."""
    rng = np.random.default_rng([seed, 1])
    name = str(rng.choice(list(FAMILIES)[: KNOWN[min(seed, NEWEST) // 10**12]]))
    vertices, triangles = FAMILIES[name](rng)
    return name, (vertices * 10.0 ** rng.choice([-6, -3, 0, 0, 0, 0, 3, 6]), triangles)


def random_sites(rng: Random) -> Floats:
    """Sites (n, 2) of the plane: scattered, on lattices, lines and circles, with twins, at offsets and other units."""
    count = int(rng.integers(1, 13))
    kind = rng.integers(6)
    if kind == 0:
        sites = rng.random((count, 2))
    elif kind == 1:
        sites = rng.integers(0, 4, (count, 2)).astype(np.float64)
    elif kind == 2:
        sites = np.column_stack([rng.random(count), np.full(count, rng.random())])
    elif kind == 3:
        angle = 2 * np.pi * rng.integers(0, 16, count) / 16
        sites = np.column_stack([np.cos(angle), np.sin(angle)])
    else:
        sites = rng.random((count, 2))
        twins = sites + small_number(rng, 1e-3, 1e-17) * rng.normal(size=sites.shape)
        sites = np.vstack([sites, twins[: int(rng.integers(1, count + 1))]])
    return sites * 10.0 ** rng.choice([-9, 0, 0, 0, 6]) + rng.choice([0.0, 0.0, 1.0, 1e6])

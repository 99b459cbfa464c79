# SPDX-License-Identifier: MIT
"""Random meshes and sites of every kind that once broke something, and of kinds that did not yet.

A family is a function of a random generator that returns vertices (V, 3) and triangles (F, 3), of some 4 to 300 faces.
Not all are good meshes: the runner repairs what `Mesh` refuses.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, Delaunay, QhullError

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


FAMILIES: dict[str, Callable[[Random], Arrays]] = {
    family.__name__: family
    for family in (
        jittered_grid, near_coincident, two_lines, graded_grid, graded_disk, parts_of_ratio, fan, needle_ring, needles,
        terrain, plate, lattice, torus, sphere, convex, spikes, folded, soup, moebius, shrunk_region, single_triangle,
    )
}  # fmt: skip


def random_mesh(rng: Random) -> tuple[str, Arrays]:
    """A family's name and one of its meshes, sometimes at another unit."""
    name = str(rng.choice(list(FAMILIES)))
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

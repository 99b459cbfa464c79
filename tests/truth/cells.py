# SPDX-License-Identifier: MIT
"""Truths about geodesic cells: nearest sites by brute force over one exact field a site.

    python -m tests.truth.cells [--runs 200] [--seed 0] MESH...

tries 1 to 30 sites of every kind on each mesh (files, or `torus` for rough tori made in code).
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

if __name__ == "__main__":  # as a file, too: the project's root holds the package `tests`
    sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import saddleback as sb
from tests import meshes
from tests.truth.cell_parts import faces_at
from tests.truth.graph import shortness
from tests.truth.registry import guards

Floats = NDArray[np.float64]
Indices = NDArray[np.int32]
Random = np.random.Generator

ROUNDING = 1e-9
"""Of arcs, relative, and of ties."""
AS_LONG = 2e-9
"""Ways of a graph that differ by no more are equally long to its cells."""


def random_sites(mesh: sb.Mesh, rng: Random, most: int = 30) -> sb.SurfacePoints:
    """1 to 30: anywhere, in one region, in few faces, in one place or nearly so, at vertices; on every part."""
    count = int(rng.integers(1, most + 1))
    kind = rng.integers(5)
    centers = mesh.vertices[mesh.triangles].mean(axis=1)
    if kind == 1:  # the faces next to one
        near = np.argsort(np.linalg.norm(centers - centers[rng.integers(len(centers))], axis=1))
        faces = rng.choice(near[: max(3, len(near) // 50)], count)
    elif kind == 2:
        faces = rng.choice(rng.integers(mesh.face_count, size=3), count)
    else:
        faces = rng.integers(mesh.face_count, size=count)
    weights = rng.dirichlet([1.0, 1.0, 1.0], count)
    if kind == 3:  # twins
        twin = rng.integers(count, size=count)
        faces = faces[twin]
        gap = rng.choice([0.0, 1e-12, 1e-6, 1e-3])
        weights = np.abs(weights[twin] + gap * rng.normal(size=(count, 3)))
        weights /= weights.sum(axis=1, keepdims=True)
    if kind == 4:
        weights = np.eye(3)[rng.integers(3, size=count)]
    for part in range(mesh.component_count):
        own = np.flatnonzero(mesh.components[mesh.triangles[:, 0]] == part)
        faces, weights = np.append(faces, rng.choice(own)), np.vstack([weights, rng.dirichlet([1.0, 1.0, 1.0])])
    return sb.SurfacePoints(faces.astype(np.int32), weights)


def exact_table(mesh: sb.Mesh, sites: sb.SurfacePoints) -> Floats:
    """Exact distances (n, V) of the vertices, one site after the other."""
    return np.array([sb.exact_distances(mesh, sites[i : i + 1]) for i in range(len(sites))])


def check_vertices(mesh: sb.Mesh, graph: sb.SaddleVertexGraph, sites: sb.SurfacePoints, accuracy: float) -> None:
    """Labels are the graph's, and the exact ones within the accuracy; no distance is too short."""
    cells = sb.geodesic_voronoi(graph, sites)
    distance, nearest = graph.nearest(sites)
    table = exact_table(mesh, sites)
    least, vertices = table.min(axis=0), np.arange(mesh.vertex_count)
    scale = float(least.max())
    of_label, of_graph = table[cells.vertex_cell, vertices], table[nearest, vertices]
    other = cells.vertex_cell != nearest
    assert (abs(of_label - of_graph)[other] <= ROUNDING * scale).all(), f"{other.sum()} labels are not the graph's"
    assert (of_label <= (1 + accuracy) * least + ROUNDING * scale).all(), "vertices in another cell than the nearest's"
    assert (distance >= least * (1 - shortness(mesh)) - 1e-15 * scale).all(), "the graph's distances are too short"
    assert (cells.vertex_distance >= least * (1 - shortness(mesh)) - 1e-15 * scale).all(), "distances too short"
    assert (cells.vertex_distance <= distance * (1 + AS_LONG)).all(), "longer than the graph's"
    assert abs(cells.areas.sum() - mesh.area) <= 1e-9 * mesh.area
    assert (cells.areas >= 0).all()


def check_exact_vertices(mesh: sb.Mesh, graph: sb.SaddleVertexGraph, sites: sb.SurfacePoints) -> None:
    """Labels and distances of exact cells are those of brute force."""
    cells = sb.geodesic_voronoi(graph, sites, exact=True)
    table = exact_table(mesh, sites)
    least = table.min(axis=0)
    slack = ROUNDING * float(least.max())
    of_label = table[cells.vertex_cell, np.arange(mesh.vertex_count)]
    assert (of_label <= least * (1 + ROUNDING) + slack).all(), "vertices in another exact cell than the nearest's"
    np.testing.assert_allclose(cells.vertex_distance, least, rtol=ROUNDING, atol=slack)
    assert abs(cells.areas.sum() - mesh.area) <= 1e-9 * mesh.area


def check_points(mesh: sb.Mesh, graph: sb.SaddleVertexGraph, sites: sb.SurfacePoints, accuracy: float) -> None:
    """Distances of points between the exact ones and those within the accuracy."""
    cells = sb.geodesic_voronoi(graph, sites)
    points = sb.sample(mesh, 20, seed=len(sites))
    cell, distance = cells.locate(points)
    assert (cell == cells.cells_at(points)).all()
    fields = [sb.ExactField(mesh, sites[i : i + 1]) for i in range(len(sites))]
    least = np.min([field.distance_to(points) for field in fields], axis=0)
    scale = float(least.max())
    assert (distance >= least * (1 - shortness(mesh)) - 1e-15 * scale).all(), "distances too short"
    assert (distance <= (1 + accuracy) * least + ROUNDING * scale).all(), "distances too long"


def told_by_corners(mesh: sb.Mesh, squares: Floats, points: sb.SurfacePoints) -> Floats:
    """Squared distances (n, m) at points from those of the vertices (n, V), as of a site that sees a face straight."""
    sides = mesh.vertices[mesh.triangles[points.faces]]
    lengths = ((sides - np.roll(sides, -1, axis=1)) ** 2).sum(axis=2)
    weights = points.barycentric
    at_corners: Floats = (squares[:, mesh.triangles[points.faces]] * weights).sum(axis=2)
    return at_corners - (weights * np.roll(weights, -1, axis=1) * lengths).sum(axis=1)


def random_places(mesh: sb.Mesh, split: sb.SplitMesh, rng: Random) -> tuple[sb.SurfacePoints, Indices]:
    """Points within the triangles of a split mesh, small ones as well as large, and their cells."""
    a, b, c = (split.vertices[split.triangles[:, i]] for i in range(3))
    sizes = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    some = np.append(rng.choice(len(sizes), 40, p=sizes / sizes.sum()), rng.integers(len(sizes), size=40))
    weights = rng.dirichlet([1.0, 1.0, 1.0], len(some))
    places = np.einsum("ni,nij->nj", weights, split.vertices[split.triangles[some]])
    alone = np.array([faces_at(mesh, place, ROUNDING) == 1 for place in places])  # not on a sheet that lies on another
    return sb.project(mesh, places[alone]), split.triangle_cell[some[alone]]


def exact_squares(mesh: sb.Mesh, sites: sb.SurfacePoints, points: sb.SurfacePoints) -> Floats:
    """Exact squared distances (n, m) of points, one site after the other."""
    table = np.array([sb.ExactField(mesh, sites[i : i + 1]).distance_to(points) for i in range(len(sites))])
    return table**2


def excess(mesh: sb.Mesh, sites: sb.SurfacePoints, points: sb.SurfacePoints, cell: Indices, accuracy: float) -> Floats:
    """By how much points (n,) are farther from their cells' sites than the nearest one and the accuracy let them be.

    In squares: corners of faces may be told too long by the accuracy, and squared distances are told straight between
    them. Where in truth they are not, nothing is claimed.
    """
    exact, corners = exact_squares(mesh, sites, points), exact_table(mesh, sites) ** 2
    corners[~np.isfinite(corners)] = 0  # on another part
    told = told_by_corners(mesh, corners, points)
    room = told_by_corners(mesh, (1 + accuracy) ** 2 * corners, points) - told
    nearest, at = exact.argmin(axis=0), np.arange(len(cell))
    slack = ROUNDING * (corners.max() + exact[nearest, at])
    own_is_straight = told[cell, at] >= exact[cell, at] * (1 - ROUNDING) - slack
    nearest_is_straight = abs(told - exact)[nearest, at] <= exact[nearest, at] * ROUNDING + slack
    behind = exact[cell, at] - exact[nearest, at] - room[nearest, at] - slack
    return np.where(own_is_straight & nearest_is_straight, behind, 0)


def any_graph(mesh: sb.Mesh) -> tuple[sb.SaddleVertexGraph, float]:
    """A graph with room for what paths of few arcs add up to beyond its accuracy."""
    return sb.SaddleVertexGraph(mesh, accuracy=5e-3), 1e-2


@guards("geodesic_voronoi", "GeodesicVoronoi", "SaddleVertexGraph.nearest")
def cells_of_few_sites(mesh: sb.Mesh, rng: Random) -> None:
    """Cells, graph and brute force over exact fields agree about the vertices."""
    graph, accuracy = any_graph(mesh)
    check_vertices(mesh, graph, random_sites(mesh, rng, 6), accuracy)


@guards("geodesic_voronoi")
def exact_cells_of_few_sites(mesh: sb.Mesh, rng: Random) -> None:
    """Exact cells and brute force over exact fields agree about the vertices."""
    check_exact_vertices(mesh, sb.SaddleVertexGraph(mesh, k=3), random_sites(mesh, rng, 6))


@guards("GeodesicVoronoi.locate", "GeodesicVoronoi.cells_at")
def places_in_cells(mesh: sb.Mesh, rng: Random) -> None:
    """`locate` against exact fields, on coarse faces, too."""
    graph, accuracy = any_graph(mesh)
    check_points(mesh, graph, random_sites(mesh, rng, 4), accuracy)


@guards(
    "geodesic_voronoi",
    "GeodesicVoronoi.cells_at",
    "GeodesicVoronoi.split",
    unsettled="faces that a site sees by two ways, round a corner, are laid by one, once in 2,000 (1000020291564)",
)
def cells_of_places(mesh: sb.Mesh, rng: Random) -> None:
    """The cell in which a point within a face lies, by `split` and `cells_at`, is its nearest site's by exact fields,
    where both sites see the face straight.
    """
    graph, accuracy = any_graph(mesh)
    sites = random_sites(mesh, rng, int(rng.choice([6, 40])))
    cells = sb.geodesic_voronoi(graph, sites)
    points, cell = random_places(mesh, cells.split(), rng)
    for of_points in (cell, cells.cells_at(points)):
        behind = excess(mesh, sites, points, of_points, accuracy)
        assert (behind <= 0).all(), f"{(behind > 0).sum()} of {len(points)}, by {np.sqrt(behind.max())}"


@guards("geodesic_voronoi", "GeodesicVoronoi.split")
def exact_cells_of_places(mesh: sb.Mesh, rng: Random) -> None:
    """At no point of an exact cell is another site nearer by more than 1e-5 of a cell's size, by exact fields."""
    sites = random_sites(mesh, rng, int(rng.choice([6, 40])))
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=3), sites, exact=True)
    points, cell = random_places(mesh, cells.split(), rng)
    table = np.sqrt(exact_squares(mesh, sites, points))
    parts = mesh.components[mesh.triangles[:, 0]]
    areas = np.bincount(parts, mesh.face_areas) / np.bincount(parts[sites.faces])
    extent = np.linalg.norm(np.ptp(mesh.vertices, axis=0))  # sites within 1e-10 of it are one
    behind = table[cell, np.arange(len(cell))] - table.min(axis=0)
    allowed = 1e-5 * np.sqrt(areas[parts[points.faces]]) + 1e-9 * extent
    assert (behind <= allowed).all(), f"{(behind > allowed).sum()} of {len(points)}, by {behind.max()}"


def rough_torus(rng: Random) -> sb.Mesh:
    vertices, triangles = meshes.torus(int(rng.integers(30, 90)), int(rng.integers(12, 40)), 1.0, rng.uniform(0.2, 0.6))
    return sb.Mesh(vertices + rng.choice([0.002, 0.005]) * rng.normal(size=vertices.shape), triangles)


def finding(mesh: sb.Mesh, graph: sb.SaddleVertexGraph, sites: sb.SurfacePoints, accuracy: float) -> str:
    """What is wrong about the graph's cells and exact ones, or nothing."""
    try:
        check_vertices(mesh, graph, sites, accuracy)
        check_exact_vertices(mesh, graph, sites)
    except AssertionError as error:
        return str(error).splitlines()[0]
    return ""


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("meshes", nargs="+")
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    for name in arguments.meshes:
        rng = np.random.default_rng(arguments.seed)
        mesh = rough_torus(rng) if name == "torus" else sb.read_mesh(name)
        graph, accuracy = any_graph(mesh)
        findings = [finding(mesh, graph, random_sites(mesh, rng), accuracy) for _ in range(arguments.runs)]
        for run, words in enumerate(findings):
            if words:
                print(f"{name} run {run}: {words}")
        count = sum(map(bool, findings))
        print(f"{Path(name).stem}, {mesh.vertex_count} vertices: {count} findings in {arguments.runs} runs", flush=True)


if __name__ == "__main__":
    main()

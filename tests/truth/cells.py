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
from tests.truth.graph import shortness
from tests.truth.registry import guards

Floats = NDArray[np.float64]
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

# SPDX-License-Identifier: MIT
"""Random and damaged meshes through the whole native library, or damaged graph files through its loader.

    python tests/fuzz.py [meshes|graph-files] [CASES] [SEED]

Every case ends in a result that passes its checks or in one of our errors. Run it on the sanitizer build
(tests/sanitize) to see what only a sanitizer sees. A failing case tells its seed: `python tests/fuzz.py WHAT 1 SEED`.
"""

from __future__ import annotations

import sys
import traceback
from collections import Counter
from collections.abc import Callable

import fuzz_graph_files
import meshes
import numpy as np
from numpy.typing import NDArray

import saddleback as sb

Arrays = tuple[NDArray[np.float64], NDArray[np.int32]]
STRANGE = np.array([np.nan, np.inf, -np.inf, 0.0, -0.0, 1e300, -1e300, 1e-300, 1e60, 1e-40, 1.0, -1.0])
SEEDLINGS: list[Arrays] = [
    (case.vertices, case.triangles) for case in (*meshes.good(), *meshes.broken()) if len(case.vertices) <= 200
]


def random_arrays(rng: np.random.Generator) -> Arrays:
    """Indices without sense, in and out of range; coordinates from a few strange values or on a small lattice."""
    count, faces = int(rng.integers(0, 9)), int(rng.integers(0, 12))
    vertices = (
        rng.choice(STRANGE, (count, 3)) if rng.random() < 0.3 else rng.integers(-2, 3, (count, 3)).astype(np.float64)
    )
    slack = int(rng.random() < 0.2)
    return vertices, rng.integers(-slack, max(count, 1) + slack, (faces, 3)).astype(np.int32)


def damaged(rng: np.random.Generator) -> Arrays:
    """A sensible mesh with a few accidents."""
    vertices, triangles = SEEDLINGS[rng.integers(len(SEEDLINGS))]
    vertices, triangles = vertices.copy(), triangles.copy()
    for _ in range(int(rng.integers(0, 4))):
        face, vertex, other = rng.integers(len(triangles)), rng.integers(len(vertices)), rng.integers(len(vertices))
        accident = rng.integers(8)
        if accident == 0:
            triangles[face, rng.integers(3)] = vertex
        elif accident == 1:
            triangles[face] = triangles[face, ::-1]
        elif accident == 2:
            triangles = np.vstack([triangles, triangles[face]])
        elif accident == 3 and len(triangles) > 1:
            triangles = np.delete(triangles, face, axis=0)
        elif accident == 4:
            vertices[vertex] = vertices[other]
        elif accident == 5:
            vertices[vertex] = vertices[triangles[face]].mean(axis=0)
        elif accident == 6:
            vertices[vertex, rng.integers(3)] = rng.choice(STRANGE)
        else:
            vertices[:, rng.integers(3)] *= 10.0 ** rng.integers(-9, 3)
    return vertices, triangles


def use(mesh: sb.Mesh, rng: np.random.Generator) -> None:
    """Everything that can be asked of a good mesh, with what must hold."""
    count = len(mesh.vertices)
    graph = sb.SaddleVertexGraph(mesh, k=int(rng.integers(1, min(count, 30) + 1)), threads=1)
    distances = graph.distances(rng.integers(count, size=2))
    assert (distances >= 0).all()
    sites = sb.sample(mesh, int(rng.integers(1, 9)), seed=int(rng.integers(99)))
    assert np.isfinite(sites.positions(mesh)).all()
    sb.project(mesh, rng.normal(size=(3, 3)))
    try:
        path = sb.trace(mesh, sites[:1], float(rng.uniform(-7, 7)), float(mesh.mean_edge_length * rng.uniform(0, 20)))
        assert np.isfinite(path.points).all()
    except sb.InputError as error:  # round a spike thinner than rounding a curve turns without end
        assert "too long to follow" in str(error)
    try:
        cells = sb.centroidal_voronoi(graph, count=int(rng.integers(1, 9)), max_iterations=2, threads=1).cells
    except sb.InputError:  # fewer cells than parts
        return
    assert abs(cells.areas.sum() / mesh.area - 1) < 1e-9
    assert np.isfinite(cells.split().vertices).all()
    assert len(cells.edges) == len(cells.edge_cells)
    cells.corners(0)


def case(seed: int) -> str:
    """Outcome of one case in a word."""
    rng = np.random.default_rng(seed)
    arrays = random_arrays(rng) if rng.random() < 0.5 else damaged(rng)
    try:
        mesh = sb.Mesh(*arrays)
        outcome = "good"
    except sb.Error:
        try:
            mesh, report = sb.repair(*arrays)
        except sb.Error:
            return "refused"
        assert len(report.vertex_map) == len(arrays[0])
        assert report.face_map.max(initial=-1) < len(mesh.triangles)
        outcome = "repaired"
    use(mesh, rng)
    return outcome


TARGETS: dict[str, Callable[[int], str]] = {"meshes": case, "graph-files": fuzz_graph_files.case}


def attempt(target: Callable[[int], str], seed: int) -> str:
    """What became of a case, a failure told and counted."""
    try:
        return target(seed)
    except Exception:
        print(f"seed {seed}:", file=sys.stderr)
        traceback.print_exc()
        return "finding"


def main(arguments: list[str]) -> int:
    what = arguments.pop(0) if arguments and arguments[0] in TARGETS else "meshes"
    cases = int(arguments[0]) if arguments else 1000
    first = int(arguments[1]) if len(arguments) > 1 else 0
    outcomes = Counter(attempt(TARGETS[what], seed) for seed in range(first, first + cases))
    print(f"{cases} cases of {what}: " + ", ".join(f"{count} {word}" for word, count in sorted(outcomes.items())))
    return outcomes["finding"] != 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

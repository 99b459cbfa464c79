# SPDX-License-Identifier: MIT
"""Whether every point lies in the cell of its nearest site: `python -m tests.bench cells [--points N] [MESH...]`.

Cells by exact distances, on each mesh for three sets of random sites: 20, one for 70 vertices, three for each triangle
(on meshes of fewer than 3,000). Random points of the cells, half of them by area and half by the diagram's triangles,
which lie about the boundaries; where the exact distance names another site, that of the cell's own site is found alone.
`lag`: by how much the worst point's site is farther than the nearest, in sizes of a cell.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from pathlib import Path

import saddleback as sb
from tests import meshes
from tests.native.cell_checks import lag, points_of_cells
from tests.native.exact import random_points

HEADER = (
    f"{'mesh':<24} {'sites':>6} {'seconds':>8} {'bends':>8} {'areas':>8} {'points':>8} {'beyond 1e-5':>11} {'lag':>8}"
)


def row(name: str, mesh: sb.Mesh, count: int, points: int) -> str:
    graph = sb.SaddleVertexGraph(mesh, k=min(10, len(mesh.vertices) - 1))
    start = time.process_time()
    cells = sb.geodesic_voronoi(graph, random_points(mesh, count, seed=count), exact=True)
    seconds = time.process_time() - start
    areas = abs(cells.areas.sum() / mesh.area - 1)
    lags = [lag(mesh, cells, *points_of_cells(cells, points // 2, 1, by_area)) for by_area in (True, False)]
    wrong, worst = sum(int((some > 1e-5).sum()) for some in lags), max(some.max() for some in lags)
    return (
        f"{name:<24} {count:>6} {seconds:>8.2f} {len(cells.edge_points):>8} {areas:>8.1e} {points:>8}"
        f" {wrong:>11} {worst:>8.1e}"
    )


def rows(name: str, mesh: sb.Mesh, points: int) -> Iterator[str]:
    counts = [20, len(mesh.vertices) // 70]
    if len(mesh.triangles) < 3000:
        counts.append(3 * len(mesh.triangles))
    for count in counts:
        yield row(name, mesh, count, points)


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.bench cells")
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("meshes", nargs="*", type=Path)
    options = parser.parse_args(arguments)
    inputs = {path.stem: path for path in options.meshes}
    named = {name: sb.read_mesh(path) for name, path in inputs.items()} or {
        "icosphere": sb.Mesh(*meshes.icosphere(3)),
        "torus": sb.Mesh(*meshes.torus(36, 14)),
        "double torus": sb.Mesh(*meshes.double_torus()),
        "saddle": sb.Mesh(*meshes.saddle()),
        "needles": sb.Mesh(*meshes.needles()),
    }
    print(HEADER)
    for name, mesh in named.items():
        for line in rows(name, mesh, options.points):
            print(line, flush=True)
    return 0

# SPDX-License-Identifier: MIT
"""Makes graph-tiers.svg of the first mesh, and graph-k.svg of all: python make_graph_plots.py MESH [MESH ...].

After figures 4.3 and 4.7 of [ying2014]: the arcs of one vertex in their tiers; degree and mean error over k.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

import saddleback as sb

HERE = Path(__file__).parent
SIZE, GAP = 260, 45
COUNTS = (8, 16, 30, 50, 100, 200)
COLORS = ("#222", "#2a6fdb", "#c22", "#2a9d4a", "#a35fc9")
PUBLISHED = {8: 1.96, 16: 0.61, 30: 0.13, 50: 0.08, 100: 0.035}  # its figure 4.6, of Bimba
Floats = NDArray[np.float64]


def page(width: float, height: float, parts: list[str]) -> str:
    head = f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}" height="{height:g}" font-family="sans-serif">'
    return "\n".join([head, *parts, "</svg>\n"])


def line(places: Floats, style: str) -> str:
    text = "L".join(f"{x:.1f} {y:.1f}" for x, y in places)
    return f'<path d="M{text}" fill="none" {style}/>'


def text(x: float, y: float, words: str, more: str = "") -> str:
    return f'<text x="{x:.0f}" y="{y:.0f}" font-size="12" {more}>{words}</text>'


def tiers(mesh: sb.Mesh) -> str:
    """The saddle vertices that are seen from the side, and all arcs of a vertex, by their tiers."""
    graph = sb.SaddleVertexGraph(mesh, k=60)
    corners = mesh.vertices[mesh.triangles]
    normals = sb.vertex_normals(mesh.vertices, mesh.triangles)
    eye, up = np.array([0.8, 0.55, 0.25]), np.array([0.0, 1.0, 0.0])
    eye /= np.linalg.norm(eye)
    right = np.cross(up, eye) / np.linalg.norm(np.cross(up, eye))
    flat = np.stack([right, -np.cross(eye, right)], axis=1)
    places = mesh.vertices @ flat
    low, extent = places.min(axis=0), float(np.ptp(places, axis=0).max())
    parts = []
    kinds, faces_us = mesh.vertex_kinds, normals @ eye > 0.25
    middle = (mesh.vertices.max(axis=0) + mesh.vertices.min(axis=0)) / 2
    near = np.argsort(np.linalg.norm(mesh.vertices - (middle + 0.3 * extent * eye), axis=1))
    seen = [int(v) for v in near if faces_us[v]]
    saddle = next(v for v in seen if kinds[v] < 0)
    other = next(v for v in seen if kinds[v] > 0)
    for number, (vertex, kind, name) in enumerate(((saddle, -1, "S-S"), (other, -1, "N-S"), (other, 1, "N-N"))):

        def at(points: Floats, number: int = number) -> Floats:
            shifted: Floats = (points @ flat - low) / extent * SIZE + (number * (SIZE + 10) + 5, 5)
            return shifted

        shown = np.einsum("ij,j->i", np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), eye) > 0
        outline = mesh.triangles[shown]
        rim = sb.border_edges(outline, mesh.vertex_count)[0]
        rims = "".join(
            "M{:.0f} {:.0f}L{:.0f} {:.0f}".format(*np.ravel(at(mesh.vertices[edge]))) for edge in rim.tolist()
        )
        parts.append(f'<path d="{rims}" stroke="#bbb" fill="none"/>')
        dots = at(mesh.vertices[faces_us & (kinds < 0)])
        parts.append(f'<path d="{"".join(f"M{x:.0f} {y:.0f}h1" for x, y in dots)}" stroke="#c22" stroke-width="1.5"/>')
        targets = [target for target in graph.neighbors(vertex)[0].tolist() if np.sign(kinds[target]) == kind]
        style = f'stroke="{COLORS[1 + number]}"'
        parts += [line(at(graph.path(vertex, target).points), style) for target in targets]
        parts.append(text(number * (SIZE + 10) + 5, SIZE + 20, f"{name}, of {graph.tiers[name]:,} in all"))
    return page(3 * (SIZE + 10), SIZE + 30, parts)


def errors_of(mesh: sb.Mesh) -> tuple[list[float], list[float]]:
    """Degrees, and mean errors in percent of four fields."""
    sources = np.random.default_rng(1).permutation(mesh.vertex_count)[:4].astype(np.int32)
    exact = [sb.exact_distances(mesh, [source]) for source in sources]
    degrees, errors = [], []
    for k in COUNTS:
        graph = sb.SaddleVertexGraph(mesh, k=k)
        degrees.append(graph.mean_degree)
        parts = [
            graph.distances([source])[true > 0] / true[true > 0] - 1
            for source, true in zip(sources, exact, strict=True)
        ]
        errors.append(100 * float(np.nanmean(np.concatenate(parts))))
    return degrees, errors


def errors_in_the_plane(count: int = 9000) -> tuple[list[float], list[float]]:
    """Of straight lines between even points of a square and their k nearest: none of this library's distances."""
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    points = sb.relax_2d(np.random.default_rng(0).random((count, 2)), square, max_iterations=30).sites
    tree = cKDTree(points)
    sources = tree.query([(0.5, 0.5), (0.3, 0.6), (0.1, 0.1), (0.7, 0.2)])[1]
    degrees, errors = [], []
    for k in COUNTS:
        length, target = tree.query(points, k + 1)
        rows = np.repeat(np.arange(count), k)
        one_way = csr_matrix((length[:, 1:].ravel(), (rows, target[:, 1:].ravel())), shape=(count, count))
        arcs = one_way.maximum(one_way.T)
        straight = np.linalg.norm(points[None] - points[sources][:, None], axis=2)
        found = dijkstra(arcs, indices=sources)
        degrees.append(arcs.nnz / count)
        errors.append(100 * float((found[straight > 0] / straight[straight > 0] - 1).mean()))
    return degrees, errors


def curves(series: dict[str, tuple[list[float], list[float]]]) -> str:
    """Both plots with logarithmic axes."""
    parts = []

    def draw(left: float, low: float, high: float, values: dict[str, list[float]], title: str) -> None:
        def at(k: float, value: float) -> tuple[float, float]:
            across = np.log(k / COUNTS[0]) / np.log(COUNTS[-1] / COUNTS[0])
            return left + across * SIZE, 20 + SIZE * np.log(high / value) / np.log(high / low)

        parts.append(text(left, 12, title))
        for k in COUNTS:
            x = at(k, low)[0]
            parts.append(line(np.array([at(k, low), at(k, high)]), 'stroke="#eee"'))
            parts.append(text(x, SIZE + 36, str(k), 'text-anchor="middle"'))
        for tick in (0.01, 0.1, 1.0, 10.0, 100.0):
            if low <= tick <= high:
                parts.append(line(np.array([at(COUNTS[0], tick), at(COUNTS[-1], tick)]), 'stroke="#ccc"'))
                parts.append(text(left - 4, at(1, tick)[1] + 4, f"{tick:g}", 'text-anchor="end"'))
        for number, found in enumerate(values.values()):
            places = np.array([at(k, value) for k, value in zip(COUNTS, found, strict=True)])
            parts.append(line(places, f'stroke="{COLORS[number]}" stroke-width="1.5"'))

    draw(GAP, 5, 300, {name: found[0] for name, found in series.items()}, "arcs of a vertex over k")
    second = 2 * GAP + SIZE
    draw(second, 0.008, 5, {name: found[1] for name, found in series.items()}, "mean error, percent, over k")
    for k, value in PUBLISHED.items():
        x = second + np.log(k / COUNTS[0]) / np.log(COUNTS[-1] / COUNTS[0]) * SIZE
        y = 20 + SIZE * np.log(5 / value) / np.log(5 / 0.008)
        parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="#e58a00"/>')
    for number, name in enumerate(series):
        parts.append(text(GAP + number * 150, SIZE + 58, name, f'fill="{COLORS[number]}"'))
    parts.append(text(GAP + len(series) * 150, SIZE + 58, "[ying2014], Bimba", 'fill="#e58a00"'))
    return page(second + SIZE + 15, SIZE + 70, parts)


meshes = {Path(name).stem: sb.read_mesh(name) for name in sys.argv[1:]}
(HERE / "graph-tiers.svg").write_text(tiers(next(iter(meshes.values()))))
found = {"even points, plane": errors_in_the_plane()} | {name: errors_of(mesh) for name, mesh in meshes.items()}
(HERE / "graph-k.svg").write_text(curves(found))
for name, (degrees, errors) in found.items():
    print(name, [f"{value:.1f}" for value in degrees], [f"{value:.3f}" for value in errors])

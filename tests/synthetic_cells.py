# SPDX-License-Identifier: MIT
"""Cells made without the native library: straight-line Voronoi cells of small meshes, cut along linear boundaries.

They have everything that a real result has (branch points, closed loops, open borders), so that the add-on's writers
can be tested on their own.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]


@dataclass(frozen=True)
class SplitCells:
    """A mesh cut along its cells, with the names and shapes of the add-on's CellsResult."""

    vertex_cell: Ints
    vertex_distance: Floats
    sites_position: Floats
    sites_normal: Floats
    cell_area: Floats
    edge_points: Floats
    edge_offsets: Ints
    edge_cells: Ints
    edge_closed: NDArray[np.bool_]
    split_vertices: Floats
    split_triangles: Ints
    split_cell: Ints
    split_origin: Ints


def grid(columns: int, rows: int, width: float = 1.0, height: float = 1.0) -> tuple[Floats, Ints]:
    """A rectangle of the plane z = 0, each square cut along the same diagonal."""
    x, y = np.meshgrid(np.linspace(0, width, columns), np.linspace(0, height, rows))
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    lower = np.column_stack([corner, corner + 1, corner + columns + 1])
    upper = np.column_stack([corner, corner + columns + 1, corner + columns])
    triangles = np.stack([lower, upper], axis=1).reshape(-1, 3)
    return np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)]), triangles.astype(np.int32)


def sphere(levels: int, radius: float = 1.0) -> tuple[Floats, Ints]:
    """An octahedron, subdivided `levels` times and blown up."""
    vertices = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], dtype=np.float64)
    triangles = np.array(
        [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)], dtype=np.int64
    )
    for _ in range(levels):
        pairs = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
        edges, index = np.unique(pairs, axis=0, return_inverse=True)
        ab, bc, ca = (len(vertices) + index.ravel()).reshape(3, -1)
        vertices = np.concatenate([vertices, vertices[edges].mean(axis=1)])
        vertices /= np.linalg.norm(vertices, axis=1, keepdims=True)
        a, b, c = triangles.T
        triangles = np.concatenate([np.column_stack(t) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return radius * vertices, triangles.astype(np.int32)


def triangle_areas(vertices: Floats, triangles: Ints) -> Floats:
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


def split_cells(vertices: Floats, triangles: Ints, site_vertices: Ints) -> SplitCells:
    """Cut the mesh along the cells of some of its vertices, each vertex going to the nearest in a straight line."""
    to_site = np.linalg.norm(vertices[:, None] - vertices[site_vertices][None], axis=2)
    label = to_site.argmin(axis=1).astype(np.int32)
    corner_label = label[triangles]
    edge_pairs = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    edges, edge_of = np.unique(edge_pairs, axis=0, return_inverse=True)
    a, b = edges.T
    gap_at_a = to_site[a, label[b]] - to_site[a, label[a]]
    gap_at_b = to_site[b, label[a]] - to_site[b, label[b]]
    total = gap_at_a + gap_at_b
    t = np.clip(np.divide(gap_at_a, total, out=np.full(len(a), 0.5), where=total > 0), 0.05, 0.95)
    crossing = vertices[a] + t[:, None] * (vertices[b] - vertices[a])
    mid = (len(vertices) + edge_of.reshape(-1, 3)).astype(np.int32)  # vertex on edge i of each triangle

    different = [corner_label[:, i] != corner_label[:, (i + 1) % 3] for i in range(3)]
    kinds = sum(d.astype(int) for d in different)
    pieces, cells, segments, beside = [triangles[kinds == 0]], [corner_label[kinds == 0, 0]], [], []
    for i in range(3):  # the corner that differs from the other two
        j, k = (i + 1) % 3, (i + 2) % 3
        row = np.flatnonzero((kinds == 2) & different[i] & different[k])
        p, q, r, x, y = triangles[row, i], triangles[row, j], triangles[row, k], mid[row, i], mid[row, k]
        for corners, cell in (((p, x, y), i), ((x, q, r), j), ((x, r, y), j)):
            pieces.append(np.column_stack(corners))
            cells.append(corner_label[row, cell])
        segments.append(np.column_stack([x, y]))
        beside.append(np.column_stack([corner_label[row, i], corner_label[row, j]]))
    row = np.flatnonzero(kinds == 3)
    center = (len(vertices) + len(edges) + np.arange(len(row))).astype(np.int32)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        p, x, y = triangles[row, i], mid[row, i], mid[row, k]
        for corners in ((p, x, center), (p, center, y)):
            pieces.append(np.column_stack(corners))
            cells.append(corner_label[row, i])
        segments.append(np.column_stack([x, center]))
        beside.append(np.column_stack([corner_label[row, i], corner_label[row, j]]))
    middle = crossing[mid[row] - len(vertices)].mean(axis=1)
    points = np.concatenate([vertices, crossing, middle])
    split = np.concatenate(pieces).astype(np.int32)
    split_cell = np.concatenate(cells).astype(np.int32)

    chains, chain_cells, closed = _chains(np.concatenate(segments), np.concatenate(beside))
    used = np.unique(split)
    number = np.full(len(points), -1, dtype=np.int32)
    number[used] = np.arange(len(used), dtype=np.int32)
    areas = np.bincount(split_cell, triangle_areas(points, split), minlength=len(site_vertices))
    return SplitCells(
        vertex_cell=label,
        vertex_distance=to_site.min(axis=1),
        sites_position=vertices[site_vertices],
        sites_normal=_normals(vertices, triangles)[site_vertices],
        cell_area=areas,
        edge_points=np.concatenate([points[chain] for chain in chains]) if chains else np.empty((0, 3)),
        edge_offsets=np.cumsum([0] + [len(chain) for chain in chains]).astype(np.int32),
        edge_cells=np.array(chain_cells, dtype=np.int32).reshape(-1, 2),
        edge_closed=np.array(closed, dtype=np.bool_),
        split_vertices=points[used],
        split_triangles=number[split],
        split_cell=split_cell,
        split_origin=np.where(used < len(vertices), used, -1).astype(np.int32),
    )


def _normals(vertices: Floats, triangles: Ints) -> Floats:
    normals = np.zeros_like(vertices)
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    for i in range(3):
        np.add.at(normals, triangles[:, i], np.cross(b - a, c - a))
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def _chains(segments: Ints, beside: Ints) -> tuple[list[list[int]], list[tuple[int, int]], list[bool]]:
    """Join segments (s,2) to polylines that end at branch points and mesh borders, or close."""
    at: dict[int, list[int]] = defaultdict(list)
    for s, (a, b) in enumerate(segments):
        at[int(a)].append(s)
        at[int(b)].append(s)
    done = np.zeros(len(segments), dtype=bool)
    chains, cells, closed = [], [], []

    def walk(first: int, s: int) -> list[int]:
        chain = [first]
        while True:
            done[s] = True
            a, b = (int(v) for v in segments[s])
            chain.append(b if a == chain[-1] else a)
            onward = [n for n in at[chain[-1]] if not done[n]]
            if len(at[chain[-1]]) != 2 or not onward:
                return chain
            s = onward[0]

    ends = [v for v in at if len(at[v]) != 2]
    for v in ends + list(at):
        for s in at[v]:
            if not done[s]:
                chain = walk(v, s)
                closed.append(chain[0] == chain[-1])
                chains.append(chain[:-1] if closed[-1] else chain)
                cells.append(tuple(sorted(int(c) for c in beside[s])))
    return chains, cells, closed

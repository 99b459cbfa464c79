# SPDX-License-Identifier: MIT
"""Makes metrics.svg, cells stretched along a field and cells of the hyperbolic plane: python make_metric_plot.py."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay

import saddleback as sb

SIZE, GAP, RIM = 300, 20, 0.96
Floats = NDArray[np.float64]


def disk(rings: int, radius: float) -> sb.Mesh:
    """A flat disk, its vertices as far apart everywhere, turned from ring to ring."""
    places = [np.zeros((1, 2))]
    for ring in range(1, rings + 1):
        turn = 2 * np.pi * (np.arange(6 * ring) + 0.5 * (ring % 2)) / (6 * ring)
        places.append(radius * ring / rings * np.column_stack([np.cos(turn), np.sin(turn)]))
    points = np.vstack(places)
    triangles = Delaunay(points).simplices
    u, v = points[triangles[:, 1]] - points[triangles[:, 0]], points[triangles[:, 2]] - points[triangles[:, 0]]
    turned = u[:, 0] * v[:, 1] < u[:, 1] * v[:, 0]
    triangles[turned] = triangles[turned][:, ::-1]
    return sb.Mesh(points, triangles[abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) > 1e-9])


def cells(mesh: sb.Mesh, lengths: Floats, count: int) -> sb.GeodesicVoronoi:
    """Even cells by those lengths, where they are in the plane."""
    metric = sb.Mesh(mesh.vertices, mesh.triangles, lengths=lengths)
    return sb.centroidal_voronoi(sb.SaddleVertexGraph(metric), count=count, seed=2, annealing=100).cells


def line(points: Floats, left: float) -> str:
    places = " ".join(f"{left + SIZE / 2 * (1 + x):.1f},{SIZE / 2 * (1 - y):.1f}" for x, y, _ in points)
    return f'<polyline points="{places}" fill="none" stroke="#2a6fdb" stroke-width="1.3"/>'


flat = disk(45, 1.0)
x, y = flat.vertices[flat.triangles].mean(axis=1)[:, :2].T
whirl = np.column_stack([-y - 0.5 * x, x - 0.5 * y, 0 * x])
stretched = cells(flat, sb.anisotropic_metric(flat, whirl, 4.0), 240)

bent = disk(90, RIM)
z = bent.vertices[:, 0] + 1j * bent.vertices[:, 1]
a, b = z[bent.triangles], z[np.roll(bent.triangles, -1, axis=1)]
hyperbolic = cells(bent, 2 * np.arctanh(abs((a - b) / (1 - a.conj() * b))), 240)

picture = [
    f'<svg xmlns="http://www.w3.org/2000/svg" width="{2 * SIZE + 3 * GAP}" height="{SIZE + 2 * GAP}"'
    f' viewBox="{-GAP} {-GAP} {2 * SIZE + 3 * GAP} {SIZE + 2 * GAP}">'
]
for found, left, radius in ((stretched, 0, 1.0), (hyperbolic, SIZE + GAP, RIM)):
    picture += [line(edge.points, left) for edge in found.edges]
    rim = f'cx="{left + SIZE / 2}" cy="{SIZE / 2}" r="{radius * SIZE / 2:g}"'
    picture.append(f'<circle {rim} fill="none" stroke="#222" stroke-width="2"/>')
Path(__file__).with_name("metrics.svg").write_text("\n".join([*picture, "</svg>\n"]))

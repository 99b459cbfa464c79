# SPDX-License-Identifier: MIT
"""Makes barriers.svg, distances and cells around curves, edges and faces of a square: python make_barrier_plot.py."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import saddleback as sb

SIDE, SIZE, GAP, COUNT = 60, 300, 20, 24
Floats = NDArray[np.float64]

x, y = np.meshgrid(np.linspace(0, 1, SIDE), np.linspace(0, 1, SIDE))
number = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)
low, high = number[:-1, :-1].ravel(), number[1:, 1:].ravel()
right, above = number[:-1, 1:].ravel(), number[1:, :-1].ravel()
triangles = np.vstack([np.column_stack([low, right, high]), np.column_stack([low, high, above])])
mesh = sb.Mesh(np.column_stack([x.ravel(), y.ravel(), np.zeros(SIDE * SIDE)]), triangles)


def curve_through(places: Floats) -> sb.SurfaceCurve:
    """Straight from place to place: on a flat mesh the shortest ways."""
    field = sb.project(mesh, np.column_stack([places, np.zeros(len(places))]))
    ways = [sb.ExactField(mesh, field[i]).path(field[i + 1]).surface for i in range(len(field) - 1)]
    faces = np.concatenate([way.faces for way in ways])
    weights = np.concatenate([way.barycentric for way in ways])
    return sb.SurfaceCurve(mesh, sb.SurfacePoints(faces, weights))


def lines(pieces: Floats, left: float, style: str) -> str:
    """Pieces (n, points, 2) of the unit square as one element of the picture."""
    places = np.round(pieces * (SIZE, -SIZE) + (left, SIZE), 1)
    text = "".join("M" + "L".join(f"{px:g} {py:g}" for px, py in piece) for piece in places)
    return f'<path d="{text}" fill="none" {style}/>'


def levels(barred: sb.BarredMesh, values: Floats, spacing: float) -> Floats:
    """(n, 2, 2) pieces of the lines at multiples of the spacing, one triangle after the other."""
    corners, at = barred.mesh.vertices[barred.mesh.triangles, :2], values[barred.mesh.triangles] / spacing
    found = []
    for level in range(1, int(at[np.isfinite(at)].max()) + 1):
        above = at > level
        for i in range(3):
            alone = (above[:, i] != above[:, i - 1]) & (above[:, i] != above[:, i - 2]) & np.isfinite(at).all(axis=1)
            ends = []
            for k in (i - 1, i - 2):
                share = ((level - at[alone, i]) / (at[alone, k] - at[alone, i]))[:, None]
                ends.append(corners[alone, i] + share * (corners[alone, k] - corners[alone, i]))
            found.append(np.stack(ends, axis=1))
    return np.concatenate(found)


turn = np.linspace(0.0, 3.6 * np.pi, 60)
spiral = np.column_stack([np.cos(turn), np.sin(turn)]) * (0.03 + 0.02 * turn)[:, None] + (0.35, 0.62)
middles = mesh.vertices[mesh.triangles].mean(axis=1)[:, :2]
hole = np.linalg.norm(middles - (0.75, 0.28), axis=1) < 0.12
column, row = 40, 25
wall = np.column_stack([number[row:-1, column], number[row + 1 :, column]])
fence = np.column_stack([number[12, :30], number[12, 1:31]])
barred = sb.add_barriers(mesh, edges=np.vstack([wall, fence]), curves=[curve_through(spiral)], faces=hole)

source = sb.project(mesh, [(0.35, 0.62, 0)])
field = sb.ExactField(barred.mesh, barred.to_barred(source)[0])
ways = field.paths(barred.to_barred(sb.project(mesh, [(0.95, 0.9, 0), (0.1, 0.05, 0)]))[0])
cells = sb.centroidal_voronoi(sb.SaddleVertexGraph(barred.mesh), count=COUNT, seed=1).cells

rims = [barred.mesh.vertices[np.append(loop, loop[0]), :2] for loop in barred.mesh.boundary_loops]
picture = [
    f'<svg xmlns="http://www.w3.org/2000/svg" width="{2 * SIZE + 3 * GAP}" height="{SIZE + 2 * GAP}"'
    f' viewBox="{-GAP} {-GAP} {2 * SIZE + 3 * GAP} {SIZE + 2 * GAP}">',
    lines(levels(barred, field.distances, 0.05), 0, 'stroke="#8ab" stroke-width="1"'),
    *[lines(way.points[None, :, :2], 0, 'stroke="#c22" stroke-width="2"') for way in ways],
    *[lines(edge.points[None, :, :2], SIZE + GAP, 'stroke="#2a6fdb" stroke-width="1.5"') for edge in cells.edges],
]
for left in (0, SIZE + GAP):
    picture += [lines(rim[None], left, 'stroke="#222" stroke-width="2.5" stroke-linejoin="round"') for rim in rims]
Path(__file__).with_name("barriers.svg").write_text("\n".join([*picture, "</svg>\n"]))

# SPDX-License-Identifier: MIT
"""Makes stroke-map.svg, lines of equal coordinates along a stroke, and the map: python make_stroke_plot.py."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import saddleback as sb

SIDE, SIZE, GAP, RADIUS, STEP = 60, 300, 20, 0.16, 0.04
Floats = NDArray[np.float64]

x, y = np.meshgrid(np.linspace(0, 1, SIDE), np.linspace(0, 1, SIDE))
number = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)
low, high = number[:-1, :-1].ravel(), number[1:, 1:].ravel()
right, above = number[:-1, 1:].ravel(), number[1:, :-1].ravel()
triangles = np.vstack([np.column_stack([low, right, high]), np.column_stack([low, high, above])])
height = 0.06 * np.sin(9 * x) * np.cos(8 * y)
mesh = sb.Mesh(np.column_stack([x.ravel(), y.ravel(), height.ravel()]), triangles)

turn = np.linspace(0, 1, 40)
places = np.column_stack([0.15 + 0.7 * turn, 0.5 + 0.24 * np.sin(2 * np.pi * turn), np.zeros(40)])
ends = sb.project(mesh, places)
ways = [sb.ExactField(mesh, ends[i]).path(ends[i + 1]).surface for i in range(len(ends) - 1)]
faces, weights = (np.concatenate([getattr(way, name) for way in ways]) for name in ("faces", "barycentric"))
found = sb.stroke_map(mesh, sb.SurfaceCurve(mesh, sb.SurfacePoints(faces, weights)), RADIUS)


def levels(values: Floats, corners: Floats) -> Floats:
    """(n, 2, 2) pieces of the lines at multiples of the step, one triangle after the other."""
    at, pieces = values / STEP, []
    for level in range(int(np.ceil(at.min())), int(at.max()) + 1):
        above = at > level + 1e-9
        for i in range(3):
            alone = (above[:, i] != above[:, i - 1]) & (above[:, i] != above[:, i - 2])
            ends = []
            for k in (i - 1, i - 2):
                share = ((level - at[alone, i]) / (at[alone, k] - at[alone, i]))[:, None]
                ends.append(corners[alone, i] + share * (corners[alone, k] - corners[alone, i]))
            pieces.append(np.stack(ends, axis=1))
    return np.concatenate(pieces)


def lines(pieces: Floats, style: str) -> str:
    """Pieces (n, points, 2) in pixels as one element of the picture."""
    text = "".join("M" + "L".join(f"{px:g} {py:g}" for px, py in piece) for piece in np.round(pieces, 1))
    return f'<path d="{text}" fill="none" {style}/>'


uv = found.uv[found.triangles]
on_surface = found.vertices[found.triangles, :2] * (SIZE, -SIZE) + (0, SIZE)
flat = uv * (SIZE, -SIZE) + (SIZE + GAP, SIZE / 2)
width = SIZE + GAP + SIZE * found.length + 2 * GAP
picture = [
    f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{SIZE + 2 * GAP}"'
    f' viewBox="{-GAP} {-GAP} {width:.0f} {SIZE + 2 * GAP}">',
    f'<rect width="{SIZE}" height="{SIZE}" fill="none" stroke="#222" stroke-width="2"/>',
]
for corners in (on_surface, flat):
    for axis, color in ((0, "#2a6fdb"), (1, "#c22")):
        picture.append(lines(levels(uv[..., axis], corners), f'stroke="{color}" stroke-width="1.2"'))
Path(__file__).with_name("stroke-map.svg").write_text("\n".join([*picture, "</svg>\n"]))

# SPDX-License-Identifier: MIT
"""Makes tight-curves.svg, rings about a vase and curves through points: python make_curve_plot.py."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import saddleback as sb

AROUND, ROWS, SIZE = 36, 30, 280
Floats = NDArray[np.float64]

at = np.linspace(0, 1, ROWS)
radii = 0.42 + 0.16 * np.cos(2 * np.pi * at) - 0.2 * (at - 0.25) ** 2
turn, height = np.meshgrid(2 * np.pi * np.arange(AROUND) / AROUND, 2 * at)
vertices = np.column_stack(
    [(radii[:, None] * np.cos(turn)).ravel(), (radii[:, None] * np.sin(turn)).ravel(), height.ravel()]
)
number = np.arange(AROUND * ROWS).reshape(ROWS, AROUND)
low, right = number[:-1].ravel(), np.roll(number, -1, axis=1)[:-1].ravel()
high, above = np.roll(number, -1, axis=1)[1:].ravel(), number[1:].ravel()
mesh = sb.Mesh(vertices, np.vstack([np.column_stack([low, right, high]), np.column_stack([low, high, above])]))
graph = sb.SaddleVertexGraph(mesh)

toward = np.array([0.0, -0.94, 0.342])  # from the vase to whom looks at it
up = np.array([0.0, 0.342, 0.94])


def flat(places: Floats) -> Floats:
    """Pixels."""
    return np.column_stack([0.5 * SIZE + 230 * places[:, 0], 445 - 230 * (places @ up)])


def polygon(places: Floats, style: str, shape: str = "polygon") -> str:
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in flat(places))
    return f'<{shape} points="{points}" {style}/>'


def seen(curve: sb.SurfacePoints, closed: bool, color: str) -> list[str]:
    """The stretches of a curve that are on the near side."""
    places = curve.positions(mesh)
    near = normals[curve.faces] @ toward > 0
    if closed:
        places, near = np.vstack([places, places[:1]]), np.append(near, near[0])
    style = f'fill="none" stroke="{color}" stroke-width="2.5" stroke-linejoin="round"'
    breaks = np.flatnonzero(np.diff(near.astype(int))) + 1
    runs = np.split(np.arange(len(places)), breaks)
    return [polygon(places[run], style, "polyline") for run in runs if near[run[0]] and len(run) > 1]


corners = mesh.vertices[mesh.triangles]
normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
normals /= np.linalg.norm(normals, axis=1)[:, None]
bright = normals @ (np.array([-0.5, -0.7, 0.5]) / np.linalg.norm([0.5, 0.7, 0.5]))
order = np.argsort(corners.mean(axis=1) @ toward)
body = []
for face in order[(normals @ toward)[order] > 0]:
    gray = int(205 + 40 * max(0.0, float(bright[face])))
    body.append(polygon(corners[face], f'fill="rgb({gray},{gray},{gray})" stroke="rgb({gray},{gray},{gray})"'))


def place(row: int, column: int) -> int:
    return int(number[row, column % AROUND])


loose = sb.curve_through(graph, [place(20 + 5 * (i % 2), 9 * i // 2) for i in range(8)], closed=True)
tight = sb.shorten_curve(loose)
stops = [place(4, 22), place(11, 31), place(6, 33), place(15, 24), place(25, 30)]
smooth = sb.curve_through(graph, stops, smooth=True)
straight = sb.curve_through(graph, stops)
dots = [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="#222"/>' for x, y in flat(mesh.vertices[stops])]
picture = [
    f'<svg xmlns="http://www.w3.org/2000/svg" width="{2 * SIZE}" height="490" viewBox="0 0 {2 * SIZE} 490">',
    f'<defs><g id="vase">{"".join(body)}</g></defs><use href="#vase"/>',
    *seen(loose.points, True, "#e08a2c"),
    *seen(tight.surface, True, "#2a6fdb"),
    f'<g transform="translate({SIZE} 0)"><use href="#vase"/>',
    *seen(straight.points, False, "#e08a2c"),
    *seen(smooth.points, False, "#2a6fdb"),
    *dots,
    "</g>",
]
Path(__file__).with_name("tight-curves.svg").write_text("\n".join([*picture, "</svg>\n"]))

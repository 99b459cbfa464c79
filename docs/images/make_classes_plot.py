# SPDX-License-Identifier: MIT
"""Makes classes.svg and directions.svg, four classes of shapes and directions given in part: make_classes_plot.py."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import saddleback as sb

SIZE, GAP, SIDE = 320, 12, 81
COLORS = ("#2a6fdb", "#d9822b", "#3a9d5d", "#a23b72")
Floats = NDArray[np.float64]


def sheet() -> sb.Mesh:
    """The unit square."""
    y, x = np.divmod(np.arange(SIDE * SIDE), SIDE)
    row, column = np.divmod(np.arange((SIDE - 1) ** 2), SIDE - 1)
    a = row * SIDE + column
    triangles = np.vstack([np.stack([a, a + 1, a + SIDE + 1], 1), np.stack([a, a + SIDE + 1, a + SIDE], 1)])
    return sb.Mesh(np.column_stack([x, y, 0 * x]) / (SIDE - 1), triangles)


def place(point: Floats) -> str:
    return f"{SIZE * point[0]:.1f},{SIZE * (1 - point[1]):.1f}"


def save(name: str, parts: list[str]) -> None:
    size = SIZE + 2 * GAP
    head = f'width="{size}" height="{size}" viewBox="{-GAP} {-GAP} {size} {size}"'
    frame = f'<rect width="{SIZE}" height="{SIZE}" fill="none" stroke="#222"/>'
    text = "\n".join([f'<svg xmlns="http://www.w3.org/2000/svg" {head}>', *parts, frame, "</svg>\n"])
    Path(__file__).with_name(name).write_text(text)


def classes(mesh: sb.Mesh) -> list[str]:
    """Needles, leaves, drops and stars, each most in a corner of its own, along lines of its own."""
    shapes = [sb.Shape.needle(), sb.Shape.leaf(), sb.Shape.drop(), sb.Shape.star()]
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    near = [np.exp(-2.5 * ((mesh.vertices[:, :2] - corner) ** 2).sum(axis=1)) for corner in corners]
    x, y = mesh.vertices[mesh.triangles].mean(axis=1)[:, :2].T
    level, middle = 0 * x, np.stack([0.5 - y, x - 0.5, 0 * x], axis=1)
    vectors = [
        np.stack([1 + level, 0.6 * np.cos(8 * x), level], axis=1),
        middle,
        np.stack([level, 1 + level, level], axis=1),
        np.stack([x + 0.1, y - 1.1, level], axis=1),
    ]
    fields = [sb.DirectionField.from_vectors(mesh, vector) for vector in vectors]
    found = sb.distribute(
        mesh, shapes, 420, fields, near, [0.03, 0.026, 0.024, 0.018], seed=3, shares=[4, 3, 3, 2], gap=0.004
    )
    assert sb.check_distribution(mesh, found, samples=1000).ok
    return [
        f'<polygon points="{" ".join(map(place, loop))}" fill="{COLORS[shape]}"/>'
        for i, shape in enumerate(found.placements.shape.tolist())
        for loop in found.outline(i)
    ]


def directions(mesh: sb.Mesh) -> list[str]:
    """Three painted spots, and the field of lines about them."""
    centers = mesh.vertices[mesh.triangles].mean(axis=1)
    given = np.zeros_like(centers)
    spots = (((0.22, 0.7), (1, 0.2)), ((0.75, 0.75), (0.2, -1)), ((0.55, 0.22), (1, 1)))
    for spot, direction in spots:
        given[np.linalg.norm(centers[:, :2] - spot, axis=1) < 0.1] = (*direction, 0)
    field = sb.direction_field(mesh, 2, directions=given)
    parts = [
        f'<circle cx="{SIZE * x:g}" cy="{SIZE * (1 - y):g}" r="{SIZE / 10}" fill="#f3d9bd"/>' for (x, y), _ in spots
    ]
    grid = (np.mgrid[0:26, 0:26].reshape(2, -1).T + 0.5) / 26
    points = np.column_stack([grid, np.zeros(len(grid))])
    along = field.directions(sb.project(mesh, points)) * 0.014
    return parts + [
        f'<polyline points="{place(a)} {place(b)}" stroke="#2a6fdb" stroke-width="1.4"/>'
        for a, b in zip(points - along, points + along, strict=True)
    ]


flat = sheet()
save("classes.svg", classes(flat))
save("directions.svg", directions(flat))

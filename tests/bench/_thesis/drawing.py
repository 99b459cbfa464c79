# SPDX-License-Identifier: MIT
"""Pictures of surfaces and curves on them, by matplotlib alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path

import matplotlib as mpl

mpl.use("agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from numpy.typing import ArrayLike

import saddleback as sb

PICTURES = Path(__file__).resolve().parents[3] / "docs/thesis"
LIGHT = np.array([0.3, -0.5, 0.8]) / np.linalg.norm([0.3, -0.5, 0.8])
BLUE, RED, GREEN, GRAY = "#2a6fdb", "#d0342c", "#1a9850", (0.82, 0.82, 0.85)


@contextmanager
def picture(name: str, columns: int = 1, size: float = 3.2) -> Iterator[list[Axes]]:
    """Save what is drawn into its axes as docs/thesis/NAME."""
    figure, axes = plt.subplots(1, columns, figsize=(size * columns, size), squeeze=False, layout="constrained")
    yield list(axes[0])
    path = PICTURES / name
    path.parent.mkdir(parents=True, exist_ok=True)
    options = {"optimize": True} | ({"quality": 85} if path.suffix == ".jpg" else {})
    figure.savefig(path, dpi=110, pil_kwargs=options)
    plt.close(figure)


def plane(axes: Axes, low: ArrayLike = (0, 0), high: ArrayLike = (1, 1)) -> None:
    (x, y), (to_x, to_y) = np.asarray(low), np.asarray(high)
    axes.set(xlim=(x, to_x), ylim=(y, to_y), aspect="equal")
    axes.set_axis_off()


def palette(count: int, seed: int = 0) -> np.ndarray:
    """Return light colors in no order."""
    rng = np.random.default_rng(seed)
    return 0.45 + 0.5 * rng.random((count, 3))


def turned(azimuth: float, elevation: float) -> np.ndarray:
    """Return the rows right, up and towards the viewer, who stands there in degrees; z is up."""
    a, e = np.radians([azimuth, elevation])
    towards = np.array([np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0])
    return np.array([right, np.cross(towards, right), towards])


def draw(
    axes: Axes,
    vertices: ArrayLike,
    triangles: ArrayLike,
    colors: ArrayLike = GRAY,
    view: tuple[float, float] = (-60, 20),
    up: str = "y",
    lines: Sequence[tuple[ArrayLike, str, float]] = (),
) -> None:
    """Draw faces from back to front, each in one shaded color, with polylines (points, color, width) among them."""
    turn = turned(*view) @ (np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]) if up == "y" else np.eye(3))
    places, corners = np.asarray(vertices) @ turn.T, np.asarray(triangles)
    extent = float(np.ptp(places, axis=0).max())
    faces = places[corners]
    normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    shade = 0.55 + 0.45 * np.abs(normals @ LIGHT)
    tints = np.broadcast_to(np.asarray(colors, dtype=float), (len(faces), 3)) * shade[:, None]
    seen = normals[:, 2] > 0 if is_closed(corners) else np.ones(len(faces), dtype=bool)
    polygons, depths = list(faces[seen][:, :, :2]), list(faces[seen][:, :, 2].max(axis=1))
    tints = [*np.clip(tints[seen], 0, 1)]
    widths = [0.3] * len(polygons)
    for points, color, width in lines:
        ends = np.asarray(points) @ turn.T
        for a, b in pairwise(ends):
            polygons.append(np.array([a[:2], b[:2], a[:2]]))
            depths.append(max(a[2], b[2]) + 0.015 * extent)
            tints.append(np.array(mpl.colors.to_rgb(color)))
            widths.append(width)
    order = np.argsort(depths, kind="stable")
    axes.add_collection(
        PolyCollection(
            [polygons[i] for i in order],
            facecolors=np.array(tints)[order],
            edgecolors=np.array(tints)[order],
            linewidths=np.array(widths)[order],
        )
    )
    low, high = places[:, :2].min(axis=0), places[:, :2].max(axis=0)
    plane(axes, low - 0.02 * extent, high + 0.02 * extent)


def is_closed(triangles: np.ndarray) -> bool:
    return len(sb.border_edges(triangles, int(triangles.max()) + 1)[0]) == 0


def draw_cells(axes: Axes, cells: sb.GeodesicVoronoi, **options: object) -> None:
    """Draw cells in colors of their own."""
    cut = cells.split()
    draw(axes, cut.vertices, cut.triangles, palette(len(cells.areas))[cut.triangle_cell], **options)  # type: ignore[arg-type]


def draw_values(axes: Axes, mesh: sb.Mesh, values: ArrayLike, bands: int = 16, **options: object) -> None:
    """Draw values of vertices in bands of color."""
    found = np.asarray(values, dtype=float)
    finite = np.isfinite(found)
    scaled = np.where(finite, found, 0) / max(float(found[finite].max()), 1e-300)
    of_faces = np.floor(scaled[mesh.triangles].mean(axis=1) * bands) / bands
    draw(axes, mesh.vertices, mesh.triangles, mpl.colormaps["turbo"](0.1 + 0.8 * of_faces)[:, :3], **options)  # type: ignore[arg-type]


def draw_shapes(axes: Axes, mesh: sb.Mesh, result: sb.Distribution, **options: object) -> None:
    """Draw shapes as cut into the surface, each class in a color."""
    cut = result.mapped.cut()
    inside = cut.triangle_shape >= 0
    of_class = np.array([[0.85, 0.35, 0.25], [0.2, 0.5, 0.8], [0.95, 0.75, 0.2], [0.3, 0.65, 0.35]])
    colors = np.tile(np.array([0.85, 0.85, 0.87]), (len(cut.triangles), 1))
    colors[inside] = of_class[result.placements.shape[cut.triangle_shape[inside]] % len(of_class)]
    draw(axes, cut.vertices, cut.triangles, colors, **options)  # type: ignore[arg-type]

# SPDX-License-Identifier: MIT
"""Tables and figures of [ying2014], each with what it shows and a function that does the same with Saddleback."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes

Floats = NDArray[np.float64]
FOLDER = os.environ.get("SADDLEBACK_MESHES", "")
replaced: dict[str, str] = {}
"""The meshes that were not there, and what stood in for each."""
used: set[str] = set()
"""The meshes that the item at hand has used."""


@dataclass(frozen=True)
class Answer:
    """What we got, what differs from the thesis and why, and pictures (paths in docs/thesis)."""

    ours: str
    differs: str
    pictures: tuple[str, ...] = ()


@dataclass(frozen=True)
class Item:
    name: str
    shows: str
    run: Callable[[], Answer]


ITEMS: list[Item] = []


def item(name: str, shows: str) -> Callable[[Callable[[], Answer]], Callable[[], Answer]]:
    """Register a function as the answer to a table or figure."""

    def register(run: Callable[[], Answer]) -> Callable[[], Answer]:
        ITEMS.append(Item(name, shows, run))
        return run

    return register


def bumpy_sphere(level: int = 5) -> sb.Mesh:
    vertices, triangles = meshes.icosphere(level)
    x, y, z = vertices.T
    bumps = 1 + 0.12 * np.sin(5 * x + 1) * np.cos(6 * y) + 0.05 * np.sin(13 * z) * np.cos(11 * x)
    return sb.Mesh(vertices * bumps[:, None], triangles)


def surface(name: str) -> sb.Mesh:
    """Return a mesh of the folder that SADDLEBACK_MESHES names, or else one made in code, which the page then says."""
    used.add(name)
    path = Path(FOLDER) / f"{name}.ply"
    if FOLDER and path.exists():
        return sb.repair(*sb.read_arrays(path))[0]
    if "open" in name:
        replaced[name] = "a hilly square of 2,601 vertices"
        x, y = (part.ravel() for part in np.meshgrid(np.linspace(-1, 1, 51), np.linspace(-1, 1, 51)))
        corner = (np.arange(50)[:, None] * 51 + np.arange(50)).ravel()
        faces = np.concatenate([np.c_[corner, corner + 1, corner + 52], np.c_[corner, corner + 52, corner + 51]])
        return sb.Mesh(np.c_[x, y, 0.3 * np.sin(4 * x) * np.cos(3 * y)], faces)
    if "torus" in name or "genus" in name or "knot" in name:
        replaced[name] = "a double torus of cubes, divided twice"
        return sb.Mesh(*meshes.subdivide(*meshes.subdivide(*meshes.double_torus())))
    level = 3 if name == "fox" else 5  # the coarse one, whose graph is exact
    mesh = bumpy_sphere(level)
    replaced[name] = f"a bumpy sphere of {mesh.vertex_count:,} vertices"
    return mesh


graphs: dict[tuple[str, object], sb.SaddleVertexGraph] = {}


def graph_of(name: str, k: int | None = None) -> sb.SaddleVertexGraph:
    """Return the graph of a mesh by its name, made once."""
    used.add(name)
    if (name, k) not in graphs:
        mesh = graphs[name, None].mesh if (name, None) in graphs else surface(name)
        graphs[name, k] = sb.SaddleVertexGraph(mesh, k) if k else sb.SaddleVertexGraph(mesh)
    return graphs[name, k]


def sources_of(mesh: sb.Mesh, count: int, seed: int = 1) -> NDArray[np.int64]:
    return np.random.default_rng(seed).choice(mesh.vertex_count, count, replace=False)


@dataclass(frozen=True)
class Errors:
    """Relative errors: the largest, root of mean squares, mean."""

    largest: float
    rms: float
    mean: float

    def __str__(self) -> str:
        return f"{percent(self.largest)} / {percent(self.rms)} / {percent(self.mean)}"


def errors(graph: sb.SaddleVertexGraph, count: int = 4) -> Errors:
    """Compare distances from a few vertices with exact ones."""
    found = []
    for source in sources_of(graph.mesh, count):
        exact = sb.exact_distances(graph.mesh, [source])
        there = (exact > 0) & np.isfinite(exact)
        found.append(np.abs(graph.distances([source])[there] / exact[there] - 1))
    all_ = np.concatenate(found)
    return Errors(float(all_.max()), float(np.sqrt((all_**2).mean())), float(all_.mean()))


def seconds(work: Callable[[], object], times: int = 3) -> float:
    """Return the least processor time of a few calls: for ratios alone."""
    took = []
    for _ in range(times):
        start = time.process_time()
        work()
        took.append(time.process_time() - start)
    return min(took)


def percent(value: float) -> str:
    return f"{100 * value:.4g} %" if value > 0.1 else f"{100 * value:.2g} %"

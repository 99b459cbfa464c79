# SPDX-License-Identifier: MIT
"""``saddleback bench``."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable
from time import perf_counter
from typing import Any

import click
import numpy as np

import saddleback as sb
from saddleback.command_line import runs


@click.command("bench")
@click.argument("mesh", metavar="[MESH]", required=False)
@click.option("--repeat", type=click.IntRange(1), default=3, show_default=True, help="The best of so many runs counts.")
@click.option("--cells", type=click.IntRange(1), default=500, show_default=True, help="Cells of the even tessellation.")
@runs.THREADS
@runs.JSON
def bench(mesh: str | None, repeat: int, cells: int, threads: int, as_json: bool) -> None:
    """How long this machine takes for what a mesh is asked; without one, for a torus of 20,000 vertices."""
    surface = sb.read_mesh(mesh) if mesh else _torus(100, 200)
    graph = sb.SaddleVertexGraph(surface, threads=threads)
    sites = sb.sample(surface, cells)
    questions: dict[str, Callable[[], Any]] = {
        "check_mesh": lambda: sb.Mesh(surface.vertices, surface.triangles),
        "build_graph": lambda: sb.SaddleVertexGraph(surface, threads=threads),
        "distances": lambda: graph.distances(0),
        "hundred_paths": lambda: graph.paths(
            np.zeros(1, int), np.arange(0, surface.vertex_count, surface.vertex_count // 100 or 1)
        ),
        "cells": lambda: sb.geodesic_voronoi(graph, sites, threads=threads),
        "even_cells": lambda: sb.centroidal_voronoi(graph, sites, max_iterations=20, threads=threads),
    }
    summary: runs.Summary = {
        "mesh": mesh or "torus",
        "vertices": surface.vertex_count,
        "faces": surface.face_count,
        "saddleback": sb.__version__,
        "machine": f"{platform.machine()}, {os.cpu_count()} cores, {platform.system()}",
    }
    for name, ask in questions.items():
        summary[f"{name}_seconds"] = min(_seconds(ask) for _ in range(repeat))
    runs.say(summary, as_json)


def _seconds(ask: Callable[[], Any]) -> float:
    begin = perf_counter()
    ask()
    return perf_counter() - begin


def _torus(rings: int, sides: int) -> sb.Mesh:
    ring, side = (grid.ravel() for grid in np.meshgrid(np.arange(rings), np.arange(sides), indexing="ij"))
    around, across = 2 * np.pi * side / sides, 2 * np.pi * ring / rings
    reach = 1 + 0.4 * np.cos(across)
    vertices = np.column_stack([reach * np.cos(around), reach * np.sin(around), 0.4 * np.sin(across)])

    def number(i: Any, j: Any) -> Any:
        return (i % rings) * sides + j % sides

    corners = number(ring, side), number(ring, side + 1), number(ring + 1, side + 1), number(ring + 1, side)
    halves = np.stack(
        [np.column_stack([corners[0], corners[1], corners[2]]), np.column_stack([corners[0], corners[2], corners[3]])]
    )
    return sb.Mesh(vertices, halves.reshape(-1, 3))

# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes and distance graphs for the runs: found in memory, on disk, or built."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from . import devices, native
from .cache import Cache
from .disk_cache import DiskCache
from .progress import Progress
from .requests import Surface

# Quality -> the largest relative error of a distance.
ACCURACY = {"FAST": 2e-2, "NORMAL": 5e-3, "FINE": 2e-3}
EXACT = "EXACT"  # no graph at all, for distances and paths

# Bytes that the native mesh holds beside its input: half-edge twins, lengths, angles, areas, flags.
MESH_BYTES_PER_VERTEX, MESH_BYTES_PER_FACE = 48, 84


@dataclass(frozen=True)
class GraphChoice:
    """Says which graph of a surface: by the error accepted or, where k is not 0, by the vertices in a neighborhood."""

    quality: str
    k: int

    @property
    def is_exact(self) -> bool:
        """No graph: distances straight from windows, as exact as numbers are."""
        return self.quality == EXACT and self.k == 0

    def options(self, surface: Surface) -> dict[str, Any]:
        """Returns what the library is asked for."""
        if self.k > 0:  # a neighborhood cannot hold more than the whole surface
            return {"k": min(self.k, len(surface.vertices))}
        return {"accuracy": ACCURACY[self.quality]}

    def name(self, surface: Surface) -> str:
        """Returns the same for the same graph of whatever object, today and tomorrow."""
        if self.is_exact:
            return f"{surface.key}-exact"
        (option, value), *_ = self.options(surface).items()
        return f"{surface.key}-{option}-{value:g}"


def mesh_of_surface(surface: Surface, progress: Progress, cache: Cache) -> Any:
    """The library's mesh, checked."""

    def build() -> Any:
        with progress.stage(0.05, "checking the mesh") as job:
            return native.load().Mesh(surface.vertices, surface.triangles, job=job)

    size = surface.vertices.nbytes + surface.triangles.nbytes
    size += MESH_BYTES_PER_VERTEX * len(surface.vertices) + MESH_BYTES_PER_FACE * len(surface.triangles)
    return cache.get(("mesh", surface.key), build, lambda _: size)


def graph_of_surface(
    surface: Surface,
    mesh: Any,
    choice: GraphChoice,
    threads: int,
    disk: DiskCache | None,
    progress: Progress,
    cache: Cache,
) -> Any:
    """The distance graph: of an earlier run, of an earlier session where `disk` is given, or a new one."""
    name = choice.name(surface)

    def build() -> Any:
        with progress.stage(0.5, "building the distance graph") as job:
            return devices.build_graph(mesh, choice.options(surface), threads, progress, job)

    def find() -> Any:
        if disk is not None and disk.has(name):
            with progress.stage(0.2, "loading the distance graph") as job:
                graph = disk.load(name, mesh, job, progress.note)
            if graph is not None:
                return graph
        return build()

    graph = cache.get(("graph", name), find, lambda graph: int(graph.nbytes))
    if disk is not None and not disk.has(name):
        with progress.stage(0.55, "keeping the distance graph on disk") as job:
            disk.save(name, graph, job, progress.note)
    return graph

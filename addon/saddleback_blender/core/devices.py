# SPDX-License-Identifier: GPL-3.0-or-later
"""Chooses where graphs and diagrams are found, as the preferences say. The result is the same everywhere."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from . import native
from .progress import Progress

AUTO, CPU, CUDA = "AUTO", "CPU", "CUDA"

_chosen = "auto"


def choose(kind: str, index: int = 0) -> None:
    """Takes effect with the next run."""
    global _chosen
    _chosen = f"cuda:{index}" if kind == CUDA else kind.lower()


def chosen() -> str:
    """Returns the choice in the library's words."""
    return _chosen


def status() -> str:
    """One sentence: whether CUDA can be used here and, when not, why. Empty where there is no library."""
    if native.problem():
        return ""
    return str(native.load().cuda_status())


def build_graph(mesh: Any, options: dict[str, Any], threads: int, progress: Progress, job: Any) -> Any:
    """A distance graph by the chosen device."""
    sb = native.load()
    return by_chosen(
        lambda device: sb.SaddleVertexGraph(mesh, **options, threads=threads, device=device, job=job), progress
    )


def plane_diagram(sites: Any, weights: Any, threads: int, progress: Progress, job: Any) -> Any:
    """A Voronoi diagram by the chosen device."""
    sb = native.load()
    return by_chosen(
        lambda device: sb.voronoi_2d(sites, weights=weights, threads=threads, device=device, job=job), progress
    )


def by_chosen(work: Callable[[str], Any], progress: Progress) -> Any:
    """Runs on the chosen device; where that fails the processor does it, and the user is told."""
    try:
        return work(_chosen)
    except native.load().DeviceError as error:
        progress.note(f"Done by the processor instead: {str(error).removeprefix('device: ')}")
        return work("cpu")

"""Where graphs are built: what the preferences say, for the whole session. The result is the same to the bit."""

from __future__ import annotations

from typing import Any

from . import native
from .progress import Progress

AUTO, CPU, CUDA = "AUTO", "CPU", "CUDA"

_chosen = "auto"


def choose(kind: str, index: int = 0) -> None:
    """Takes effect with the next graph."""
    global _chosen
    _chosen = f"cuda:{index}" if kind == CUDA else kind.lower()


def chosen() -> str:
    """In the library's words."""
    return _chosen


def status() -> str:
    """One sentence: whether CUDA can be used here and, when not, why. Empty where there is no library."""
    if native.problem():
        return ""
    return str(native.load().cuda_status())


def build_graph(mesh: Any, options: dict[str, Any], threads: int, progress: Progress, job: Any) -> Any:
    """A distance graph by the chosen device; where it fails the processor builds it, and the user is told."""
    sb = native.load()
    try:
        return sb.SaddleVertexGraph(mesh, **options, threads=threads, device=_chosen, job=job)
    except sb.DeviceError as error:
        progress.note(f"Built on the processor instead: {str(error).removeprefix('device: ')}")
        return sb.SaddleVertexGraph(mesh, **options, threads=threads, device="cpu", job=job)

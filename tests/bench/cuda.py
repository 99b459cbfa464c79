"""Graphs on a CUDA device: `python -m tests.bench cuda MESH...`.

The device's own clock for its parts, the wall clock for all from a `Mesh` to a graph, and the processor's time for the
same graph; each the best of five. Files of both graphs are compared as well.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import saddleback as sb
from tests.parity.test_graph_twin import saved

RULES: tuple[dict[str, Any], ...] = ({"k": 100}, {"accuracy": 5e-3})
TIMES = 5
PARTS = ("upload", "find", "unite", "download")


def best(build: Callable[[], sb.SaddleVertexGraph]) -> tuple[float, list[sb.SaddleVertexGraph]]:
    """Seconds of the quickest, and all graphs."""
    seconds, graphs = float("inf"), []
    for _ in range(TIMES):
        start = time.perf_counter()
        graphs.append(build())
        seconds = min(seconds, time.perf_counter() - start)
    return seconds, graphs


def main(arguments: list[str]) -> int:
    if not any(device.kind == "cuda" for device in sb.devices()):
        print(f"Nothing to measure: {sb.cuda_status()}.")
        return 1
    print(
        f"{'mesh':<28} {'rule':<15}" + "".join(f"{part:>10}" for part in PARTS) + "   wall    CPU  ms, and who did what"
    )
    for name in arguments:
        mesh = sb.read_mesh(name)
        for rule in RULES:
            measure(Path(name).stem, mesh, rule)
    return 0


def measure(name: str, mesh: sb.Mesh, rule: dict[str, Any]) -> None:
    wall, twins = best(lambda: sb.SaddleVertexGraph(mesh, device="cuda", **rule))
    processor, (graph, *_) = best(lambda: sb.SaddleVertexGraph(mesh, device="cpu", **rule))
    times = [twin.device_times or {} for twin in twins]
    parts = "".join(f"{1e3 * min(one[part] for one in times):10.2f}" for part in PARTS)
    with tempfile.TemporaryDirectory() as folder:
        same = saved(twins[0], Path(folder)) == saved(graph, Path(folder))
    done = f"second pass {times[0]['second_pass']}, processor {times[0]['by_processor']}, "
    done += "equal" if same else "DIFFERENT"
    how = ", ".join(f"{key}={value}" for key, value in rule.items())
    print(f"{name:<28} {how:<15}{parts} {1e3 * wall:6.1f} {1e3 * processor:6.1f}  {done}", flush=True)

# SPDX-License-Identifier: MIT
"""A CUDA device: `python -m tests.bench cuda MESH...` for graphs of meshes and diagrams of the plane.

Where there are several devices, also what they gain together: all parts but the transfers, against one of them.

The device's own clock for its parts, the wall clock for all from a `Mesh` or sites to the result, and the processor's
time for the same; each the best of five. Both results are compared as well.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

import saddleback as sb
from tests.native import plane_sites
from tests.parity.test_graph_cuda import saved

RULES: tuple[dict[str, Any], ...] = ({"k": 100}, {"accuracy": 5e-3})
TIMES = 5
PARTS = ("upload", "order", "find", "unite", "download")
PLANE = (("uniform", 10**5), ("uniform", 10**6), ("uniform", 10**7)) + tuple(
    (kind, 10**6) for kind in ("clusters", "grid", "duplicates", "nearly_collinear", "circle")
)
HEAD = "".join(f"{part:>10}" for part in PARTS) + "   wall    CPU  ms, and who did what"

Result = TypeVar("Result", sb.SaddleVertexGraph, sb.Voronoi2d)


def best(build: Callable[[int], Result]) -> tuple[float, list[Result]]:
    """Seconds of the quickest, and all results."""
    seconds, results = float("inf"), []
    for number in range(TIMES):
        start = time.perf_counter()
        results.append(build(number))
        seconds = min(seconds, time.perf_counter() - start)
    return seconds, results


def parts_of(twins: list[Any]) -> str:
    times = [twin.device_times or dict.fromkeys(PARTS, float("nan")) for twin in twins]
    return "".join(f"{1e3 * min(one[part] for one in times):10.2f}" for part in PARTS)


def main(arguments: list[str]) -> int:
    if not any(device.kind == "cuda" for device in sb.devices()):
        print(f"Nothing to measure: {sb.cuda_status()}.")
        return 1
    print(f"{'sites':<28} {'':<15}{HEAD}")
    for kind, count in PLANE:
        measure_plane(kind, count)
    for radius in (0.2, 1.0):
        measure_plane("uniform", 1_000_000, radius)
    print("The same from pinned memory to pinned memory, one after the other:")
    for count in (10**5, 10**6, 10**7):
        measure_pinned(count)
    print(f"{'mesh':<28} {'rule':<15}{HEAD}")
    for name in arguments:
        mesh = sb.read_mesh(name)
        for rule in RULES:
            measure(Path(name).stem, mesh, rule)
    if sum(device.kind == "cuda" for device in sb.devices()) > 1:
        measure_several_devices(arguments)
    print(f"{'mesh':<28} {'query':<15}{HEAD}")
    for name in arguments:
        measure_queries(Path(name).stem, sb.SaddleVertexGraph(sb.read_mesh(name), **RULES[-1]))
    return 0


def measure_plane(kind: str, count: int, radius: float = 0) -> None:
    """Weights, where there are any, are up to `radius` mean distances of the sites of a square."""
    rng = np.random.default_rng(count)
    inputs = []
    for _ in range(TIMES):
        sites = plane_sites.KINDS[kind](count, rng)
        inputs.append((sites, radius / np.sqrt(count) * rng.random(count) if radius > 0 else None))
    wall, twins = best(lambda number: sb.voronoi_2d(*inputs[number], device="cuda"))
    processor, diagrams = best(lambda number: sb.voronoi_2d(*inputs[number], device="cpu"))
    same = all(
        getattr(twin, name).tobytes() == getattr(own, name).tobytes()
        for twin, own in zip(twins, diagrams, strict=True)
        for name in ("vertices", "edges", "edge_sites")
    )
    far = [twin.device_times["second_pass"] if twin.device_times else -1 for twin in twins]
    done = "left to the processor" if min(far) < 0 else f"second pass {max(far)}, {'equal' if same else 'DIFFERENT'}"
    name = kind if radius == 0 else f"{kind}, weights to {radius}"
    print(f"{name:<28} {count:<15,}{parts_of(twins)} {1e3 * wall:6.1f} {1e3 * processor:6.1f}  {done}", flush=True)


def measure_pinned(count: int) -> None:
    """Sites lie in a diagram that is pinned itself, so that no other library is needed to pin them."""
    rng = np.random.default_rng(count)
    there = sb.voronoi_2d(rng.random((count, 2)), device="cuda", pinned=True)
    times, wall = [], float("inf")
    for _ in range(TIMES + 1):  # the first pins what the others find at hand
        start = time.perf_counter()
        diagram = sb.voronoi_2d(there.sites, device="cuda", pinned=True)
        wall = min(wall, time.perf_counter() - start)
        times.append(diagram.device_times or {})
        del diagram
    parts = [min(one[part] for one in times[1:]) for part in PARTS]
    print(f"{'uniform, pinned':<28} {count:<15,}{''.join(f'{1e3 * part:10.2f}' for part in parts)} {1e3 * wall:6.1f}")


def measure_several_devices(meshes: list[str]) -> None:
    print(f"{'several devices':<28} {'which':<15}{HEAD.split(' ms')[0].replace('CPU', 'gain')}")
    for count in (10**7, 10**8):
        sites = np.random.default_rng(1).random((count, 2))
        compare_devices(f"uniform, {count:,}", lambda device, s=sites: sb.voronoi_2d(s, device=device))  # type: ignore[misc]
    for name in meshes:
        mesh = sb.read_mesh(name)
        for rule in RULES:
            how = ", ".join(f"{key}={value}" for key, value in rule.items())
            compare_devices(
                f"{Path(name).stem}, {how}",
                lambda device, m=mesh, r=rule: sb.SaddleVertexGraph(m, device=device, **r),  # type: ignore[misc]
            )


def compare_devices(what: str, build: Callable[[str], sb.SaddleVertexGraph | sb.Voronoi2d]) -> None:
    """Results are dropped at once: those of a hundred million sites take gigabytes."""
    cards = sum(device.kind == "cuda" for device in sb.devices())
    alone = float("nan")
    for count in sorted({1, 2, cards}):
        device = "cuda:" + ",".join(map(str, range(count)))
        runs, wall = [], float("inf")
        for _ in range(TIMES + 1):
            start = time.perf_counter()
            runs.append(build(device).device_times or dict.fromkeys(PARTS, float("nan")))
            wall = min(wall, time.perf_counter() - start)
        run = min(runs[1:], key=lambda times: times["order"] + times["find"] + times["unite"])
        together = run["order"] + run["find"] + run["unite"]
        alone = together if count == 1 else alone
        parts = "".join(f"{1e3 * run[part]:10.2f}" for part in PARTS)
        print(f"{what:<28} {device:<15}{parts} {1e3 * wall:6.1f} {alone / together:6.2f}", flush=True)


def measure_queries(name: str, graph: sb.SaddleVertexGraph) -> None:
    rng = np.random.default_rng(1)
    queries: tuple[tuple[str, int, Callable[..., Any]], ...] = (
        ("distances", 1, graph.distances),
        ("fields", 64, graph.fields),
        ("nearest", 1500, graph.nearest),
    )
    for word, count, query in queries:
        sources = rng.integers(0, len(graph.mesh.vertices), count).astype(np.int32)
        twins, times, walls, processor = [], [], [], []
        for _ in range(TIMES):
            start = time.perf_counter()
            twins.append(query(sources, device="cuda"))
            walls.append(time.perf_counter() - start)
            times.append(graph.query_times or {})
            start = time.perf_counter()
            own = query(sources, device="cpu")
            processor.append(time.perf_counter() - start)
        same = all(np.array_equal(twin, own) for twin in twins)
        parts = "".join(f"{1e3 * min(one[part] for one in times):10.2f}" for part in PARTS)
        how = f"{word} of {count:,}"
        print(
            f"{name:<28} {how:<15}{parts} {1e3 * min(walls):6.1f} {1e3 * min(processor):6.1f}  "
            f"{'equal' if same else 'DIFFERENT'}",
            flush=True,
        )


def measure(name: str, mesh: sb.Mesh, rule: dict[str, Any]) -> None:
    wall, twins = best(lambda _: sb.SaddleVertexGraph(mesh, device="cuda", **rule))
    processor, (graph, *_) = best(lambda _: sb.SaddleVertexGraph(mesh, device="cpu", **rule))
    parts, times = parts_of(twins), twins[0].device_times or {}
    with tempfile.TemporaryDirectory() as folder:
        same = saved(twins[0], Path(folder)) == saved(graph, Path(folder))
    done = f"second pass {times['second_pass']}, processor {times['by_processor']}, "
    done += "equal" if same else "DIFFERENT"
    how = ", ".join(f"{key}={value}" for key, value in rule.items())
    print(f"{name:<28} {how:<15}{parts} {1e3 * wall:6.1f} {1e3 * processor:6.1f}  {done}", flush=True)

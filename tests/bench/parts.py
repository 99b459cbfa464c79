# SPDX-License-Identifier: MIT
"""Graphs in parts: the bytes of the graph built at once, what the parts cost together, and opening by a memory map.

python -m tests.bench parts [--parts 4] [--k K | --accuracy A] MESH ...
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

import saddleback as sb

PROCESS = """
import sys, time
import saddleback as sb
mesh = sb.read_mesh(sys.argv[1])
part, parts, rule = int(sys.argv[2]), int(sys.argv[3]), eval(sys.argv[4])
begun = time.process_time()
if parts:
    made = sb.find_arcs(mesh, part, parts, threads=1, **rule)
else:
    sb.SaddleVertexGraph(mesh, threads=1, device="cpu", **rule)
print(time.process_time() - begun, time.process_time())
if parts:
    with open(sys.argv[5], "wb") as file:
        file.write(made)
"""


def process(path: str, part: int, parts: int, rule: dict[str, Any], target: Path) -> tuple[float, float]:
    """Seconds of the processor for the call, and for the whole process with the mesh's file."""
    command = [sys.executable, "-c", PROCESS, path, str(part), str(parts), repr(rule), str(target)]
    call, whole = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
    return float(call), float(whole)


def file_of(graph: sb.SaddleVertexGraph, path: Path) -> bytes:
    graph.save(path)
    return path.read_bytes()


def measure(path: str, parts: int, rule: dict[str, Any], folder: Path) -> None:
    once, once_whole = process(path, 0, 0, rule, folder / "none")
    each = [process(path, part, parts, rule, folder / str(part)) for part in range(parts)]
    calls, wholes = (sum(times) for times in zip(*each, strict=True))
    mesh = sb.read_mesh(path)
    found = [(folder / str(part)).read_bytes() for part in range(parts)]
    begun = time.process_time()
    joined = sb.SaddleVertexGraph.from_parts(mesh, found, threads=1)
    joining = time.process_time() - begun
    graph = sb.SaddleVertexGraph(mesh, device="cpu", **rule)
    right = file_of(graph, folder / "graph")
    same = file_of(joined, folder / "joined") == right
    sizes = ", ".join(f"{len(part) / 1e6:.1f}" for part in found[:8])
    print(f"{path}: {mesh.vertex_count} vertices, {graph.arc_count} arcs, {rule or 'accuracy=0.005'}")
    print(f"  at once {once:.2f} s, {parts} parts {calls:.2f} s together: {calls / once:.3f} times")
    print(
        f"  with joining ({joining:.2f} s) {(calls + joining) / once:.3f} times; with reading the mesh in each", end=""
    )
    print(f" process {wholes / once_whole:.3f} times; slowest part {max(call for call, _ in each):.2f} s")
    print(f"  {'the same bytes' if same else 'OTHER BYTES'}; parts of {sizes} MB, a graph of {len(right) / 1e6:.1f} MB")
    opened = []
    for _ in range(5):
        begun = time.perf_counter()
        mapped = sb.SaddleVertexGraph.load(folder / "graph", mesh, mmap=True)
        opened.append(time.perf_counter() - begun)
    begun = time.perf_counter()
    answer = mapped.distances([0])
    asked = time.perf_counter() - begun
    equal = np.array_equal(answer, graph.distances([0]))
    begun = time.perf_counter()
    sb.SaddleVertexGraph.load(folder / "graph", mesh)
    read = time.perf_counter() - begun
    begun = time.perf_counter()
    mapped.check()
    checked = time.perf_counter() - begun
    times = ", ".join(f"{seconds * 1e3:.1f}" for seconds in opened)
    print(
        f"  opened in {times} ms (read in {read:.2f} s), asked in {asked * 1e3:.0f} ms, checked in {checked:.2f} s:",
        end="",
    )
    print(f" {'the same bits' if equal else 'OTHER BITS'}", flush=True)


def main(arguments: list[str]) -> None:
    parser = argparse.ArgumentParser(prog="tests.bench parts", description=__doc__)
    parser.add_argument("--parts", type=int, default=4)
    parser.add_argument("--k", type=int)
    parser.add_argument("--accuracy", type=float)
    parser.add_argument("meshes", nargs="+")
    given = parser.parse_args(arguments)
    rule = {name: value for name in ("k", "accuracy") if (value := getattr(given, name)) is not None}
    for path in given.meshes:
        with tempfile.TemporaryDirectory() as folder:
            measure(path, given.parts, rule, Path(folder))
    print(f"peak of memory: {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6:.2f} GB")

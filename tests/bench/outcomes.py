# SPDX-License-Identifier: MIT
"""What becomes of each mesh of a folder: `python -m tests.bench outcomes FOLDER`.

Per file, in a process of its own: Mesh or the sentence that refuses it, repair, graph with k = 30, 200 relaxed cells,
and whether the result is valid. A crash, a run over the time limit or an invalid result is a failure.
"""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import saddleback as sb

TIME_LIMIT = 900.0
CELLS, DISK = 200, 30


def outcome(path: Path) -> str:
    """One line about a file: steps with their results, " | " between them."""
    try:
        vertices, triangles = sb.read_arrays(path)
    except sb.Error as error:
        return f"not read: {error}"
    try:
        mesh = sb.Mesh(vertices, triangles)
        first = "good"
    except sb.MeshError as error:
        first = f"refused ({str(error)[:60]}...)"
    try:
        mesh, report = sb.repair(vertices, triangles)
    except sb.MeshError as error:
        return f"{first} | repair: {error}"
    changes = ", ".join(f"{name} {count}" for name, count in report.changes.items() if count) or "nothing"
    # A soup of triangles is a good mesh of many parts; only what coincides may be joined in it.
    if first == "good" and changes != "nothing" and not report.changes.get("vertices_welded"):
        return f"INVALID: repair changed a good mesh: {changes}"
    start = time.perf_counter()
    graph = sb.SaddleVertexGraph(mesh, k=min(DISK, len(mesh.vertices)))
    built = time.perf_counter() - start
    try:
        relaxed = sb.centroidal_voronoi(graph, count=CELLS, max_iterations=5)
    except sb.InputError as error:
        return f"{first} | repaired: {changes} | graph {built:.1f} s | {error}"
    faults = validity(mesh, relaxed)
    state = f"INVALID: {faults}" if faults else "valid"
    return f"{first} | repaired: {changes} | graph {built:.1f} s | {CELLS} cells {state}, {relaxed.stop_reason}"


def validity(mesh: sb.Mesh, relaxed: sb.CentroidalVoronoi) -> str:
    """What is wrong with relaxed cells; empty: nothing."""
    cells, wrong = relaxed.cells, []
    split = cells.split()
    if abs(cells.areas.sum() / mesh.area - 1) > 1e-9:
        wrong.append(f"areas off by {cells.areas.sum() / mesh.area - 1:.1e}")
    if not np.isfinite(cells.vertex_distance).all():
        wrong.append("distances not finite")
    if not np.isfinite(split.vertices).all():
        wrong.append("split vertices not finite")
    if (np.diff(relaxed.energy) > 0).any():
        wrong.append("energy rose")
    off = np.abs(cells.edge_surface.positions(mesh) - cells.edge_points).max(initial=0)
    if off > 1e-9 * np.abs(mesh.vertices).max():
        wrong.append(f"edges {off:.1e} off the surface")
    return "; ".join(wrong)


def main(arguments: list[str]) -> int:
    if len(arguments) == 2 and arguments[0] == "--one":
        print(outcome(Path(arguments[1])))
        return 0
    failures = 0
    files = sorted(
        p
        for folder in arguments
        for p in Path(folder).iterdir()
        if p.suffix.lower() in (".ply", ".obj", ".off", ".stl")
    )
    for path in files:
        start = time.perf_counter()
        try:
            command = [sys.executable, __file__, "--one", str(path)]
            run = subprocess.run(command, capture_output=True, text=True, timeout=TIME_LIMIT)
            line = run.stdout.strip() if run.returncode == 0 else f"CRASH {run.returncode}: {run.stderr.strip()[-200:]}"
        except subprocess.TimeoutExpired:
            line = f"HANG: over {TIME_LIMIT:.0f} s"
        failures += line.startswith(("CRASH", "HANG")) or "INVALID" in line
        print(f"{path.name:36s} {time.perf_counter() - start:6.1f} s  {line}", flush=True)
    print(f"{len(files)} meshes, {failures} failures")
    return failures != 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

# SPDX-License-Identifier: MIT
"""Maps along curves: `python -m tests.bench stroke_maps FOLDER [CURVES]`.

On ten meshes, 50 curves each, half of them shortest paths and half of them strokes that bend as a hand might draw, the
radius .02 to .2 of the mesh's extent: triangles flipped by exact sign, triangles that overlap by an independent test,
the share of random points beside the curve that the map has, how much of their distance is wrong, and the time.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import saddleback as sb
from tests.truth.ways import covered, flipped, overlapping

Floats = NDArray[np.float64]
MESHES = (
    "bimba-9k", "rocker-arm-10k", "camelhead-11k-open", "fandisk-6k", "spot-3k", "hand-17k", "sculpture-8k",
    "max-planck-13k", "double-torus-14k", "gargoyle-26k",
)  # fmt: skip


def random_stroke(
    mesh: sb.Mesh, graph: sb.SaddleVertexGraph, rng: np.random.Generator, extent: float
) -> sb.SurfaceCurve:
    """A shortest path, or straight pieces that turn a little each: up to three times around in all."""
    while True:
        if rng.random() < 0.5:
            ends = sb.sample(mesh, 2, seed=int(rng.integers(1 << 30)))
            path = graph.path(ends[0], ends[1], shorten=True)
            if 0.05 * extent < path.length < extent:
                return sb.SurfaceCurve(mesh, path.surface)
            continue
        point = sb.sample(mesh, 1, seed=int(rng.integers(1 << 30)))
        length, pieces = extent * rng.uniform(0.1, 0.7), 60
        bend, turn = rng.uniform(-6, 6), rng.uniform(-1, 1)
        points, heading = [point], float(rng.uniform(0, 2 * np.pi))
        for i in range(pieces):
            line = sb.trace(mesh, points[-1], heading, length / pieces)
            if line.hit_boundary or len(line.surface) < 2:
                break
            points += [line.surface[i : i + 1] for i in range(1, len(line.surface))]
            heading = line.end_angle + (bend + 6 * turn * np.sin(6 * i / pieces)) / pieces
        faces, weights = (np.concatenate([getattr(p, name) for p in points]) for name in ("faces", "barycentric"))
        curve = sb.SurfaceCurve(mesh, sb.SurfacePoints(faces, weights))
        if curve.length > 0.05 * extent:
            return curve


def main(arguments: Sequence[str]) -> None:
    folder, curves = arguments[0], int(arguments[1]) if len(arguments) > 1 else 50
    print(f"{'mesh':<26} {'curves':>6} {'flips':>6} {'overlaps':>8} {'coverage: all':>13} {'least':>6} {'told':>6} "
          f"{'distance off':>12} {'ms':>6} {'most':>6} {'vertices':>8}")  # fmt: skip
    for name in MESHES:
        mesh = sb.read_mesh(Path(folder) / f"{name}.ply")
        graph = sb.SaddleVertexGraph(mesh, accuracy=1e-3)
        rng = np.random.default_rng(47)
        extent = float(np.ptp(mesh.vertices, axis=0).max())
        rows, crossing = [], 0
        while len(rows) < curves:
            curve, radius = random_stroke(mesh, graph, rng, extent), extent * rng.uniform(0.02, 0.2)
            start = time.process_time()
            try:
                found = sb.stroke_map(mesh, curve, radius)
            except sb.InputError as error:
                if "crosses or touches itself" not in str(error):
                    raise
                crossing += 1
                continue
            seconds = time.process_time() - start
            beside, there, off = covered(mesh, graph, curve, radius, found, 1500, rng)
            rows.append(
                (flipped(found), overlapping(found), there / max(beside, 1), found.coverage, off / radius, seconds,
                 len(found.vertices), beside, there)
            )  # fmt: skip
        table = np.array(rows)
        print(f"{name:<26} {len(rows):>6} {table[:, 0].sum():>6.0f} {table[:, 1].sum():>8.0f} "
              f"{table[:, 2].mean():>13.2%} {table[:, 2].min():>6.1%} {table[:, 3].mean():>6.1%} "
              f"{table[:, 4].max():>12.2%} {1e3 * np.median(table[:, 5]):>6.1f} {1e3 * table[:, 5].max():>6.1f} "
              f"{table[:, 6].mean():>8.0f}  ({crossing} crossed themselves)", flush=True)  # fmt: skip

# SPDX-License-Identifier: MIT
"""Paths and coordinates: `python -m tests.bench paths FOLDER [FACTOR]`.

How long a path takes after its field (CPU time of one thread, from the difference between many targets and one),
whether paths are as long as distances, straight over edges and legal at vertices, and how exact log maps and polar
coordinates are. FACTOR: how many times slower than the reference this machine is; bars are multiplied by it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes
from tests.native.exact import random_points, with_vertex_at
from tests.native.surface_angles import Fan, angle_between, corners_of

Floats = NDArray[np.float64]
TIMED = "bunny-35k-closed"
CHECKED = (TIMED, "kitten-53k", "elephant-25k", "face-17k-open", "turbine-9k-genus11")
INVERTED = ("icosphere-10k", "max-planck-13k", "face-17k-open", "double-torus-14k", "spot-3k")


def seconds(work: Callable[[], object]) -> float:
    """The shortest of five, CPU time of this thread."""
    best = np.inf
    for _ in range(5):
        start = time.thread_time()
        work()
        best = min(best, time.thread_time() - start)
    return float(best)


def row(measure: str, value: str, bar: str = "") -> None:
    print(f"{measure:<74} {value:>22}  {bar}", flush=True)


# --- time -------------------------------------------------------------------------------------------------------------


def time_of_a_path(graph: sb.SaddleVertexGraph, shorten: bool) -> tuple[float, float]:
    """Microseconds a path of about 175 points takes, and how many points those have."""
    source = np.array([0], dtype=np.int32)
    paths = graph.paths(source, np.arange(0, len(graph.distances(source)), 3, dtype=np.int32), threads=1)
    sizes = np.diff(paths.offsets)
    targets = 3 * np.argsort(np.abs(sizes - 175), kind="stable")[:1000].astype(np.int32)
    many = seconds(lambda: graph.paths(source, targets, shorten, threads=1))
    one = seconds(lambda: graph.paths(source, targets[:1], shorten, threads=1))
    points = np.diff(graph.paths(source, targets, shorten).offsets).mean()
    return 1e6 * (many - one) / (len(targets) - 1), float(points)


# --- geometry ---------------------------------------------------------------------------------------------------------


class Bends:
    """The worst that was seen, radians: bends at edges; what a side lacks of pi at saddles and at other vertices."""

    def __init__(self, mesh: sb.Mesh):
        self.mesh = mesh
        self.at_edges = self.at_saddles = self.at_others = 0.0
        self.saddles = set(mesh.saddle_vertices.tolist())
        self.fans: dict[int, Fan] = {}

    def see(self, path: sb.GeodesicPath) -> None:
        points, surface = path.points, path.surface
        held = [corners_of(self.mesh, int(f), b) for f, b in zip(surface.faces, surface.barycentric, strict=True)]
        for i in range(1, len(points) - 1):
            back, ahead = points[i - 1] - points[i], points[i + 1] - points[i]
            # Directions of tiny steps are no better than the points: 1e-16 of the mesh's size.
            if min(np.linalg.norm(back), np.linalg.norm(ahead)) < 1e-4 * self.mesh.mean_edge_length:
                continue
            if len(held[i]) == 2:
                edge = self.mesh.vertices[held[i][1]] - self.mesh.vertices[held[i][0]]
                bend = abs(angle_between(back, edge) + angle_between(ahead, edge) - np.pi)
                self.at_edges = max(self.at_edges, bend)
            elif len(held[i]) == 1:
                self.see_vertex(held[i][0], [(held[j], d) for j, d in ((i - 1, back), (i + 1, ahead))])

    def see_vertex(self, vertex: int, sides: Sequence[tuple[list[int], Floats]]) -> None:
        fan = self.fans.setdefault(vertex, Fan(self.mesh, vertex))
        angles = [fan.angle_of(sorted(set(held) - {vertex})[:2], direction) for held, direction in sides]
        turn = abs(angles[0] - angles[1])
        lacking = np.pi - turn if not fan.is_closed else max(np.pi - turn, np.pi - (fan.total - turn))
        if vertex in self.saddles:
            self.at_saddles = max(self.at_saddles, lacking)
        else:
            self.at_others = max(self.at_others, lacking)


def check_paths(name: str, graph: sb.SaddleVertexGraph, mesh: sb.Mesh) -> None:
    rng = np.random.default_rng(0)
    targets = rng.choice(len(mesh.vertices), 150, replace=False).astype(np.int32)
    distance = graph.distances([0])[targets]
    targets = targets[np.isfinite(distance) & (distance > 0)]
    distance = distance[np.isfinite(distance) & (distance > 0)]
    exact = sb.ExactField(mesh, [0])
    for kind, paths, length in (
        ("", graph.paths([0], targets), distance),
        (", shortened", graph.paths([0], targets, True), None),
        (", exact", exact.paths(targets), exact.distances[targets]),
    ):
        bends = Bends(mesh)
        polyline = []
        for path in paths:
            bends.see(path)
            polyline.append(np.linalg.norm(np.diff(path.points, axis=0), axis=1).sum())
        told = np.array([path.length for path in paths]) if length is None else length
        error = np.abs(np.array(polyline) / told - 1).max()
        row(f"{name}{kind}: length against {'its own' if length is None else 'distance'}", f"{error:.1e}", "1e-9")
        angles = f"{bends.at_edges:.1e} / {max(0.0, bends.at_saddles):.1e} / {max(0.0, bends.at_others):.1e}"
        row("    bend at edges / lack of pi at saddles / at other vertices, rad", angles, "1e-9")
    points = random_points(mesh, 40, seed=1)
    near = [sb.trace(mesh, p, float(rng.uniform(0, 6)), 2 * mesh.mean_edge_length).surface for p in points]
    gaps = [
        abs(graph.path(p, ends[len(ends) - 1 :]).length / max(graph.distance(p, ends[len(ends) - 1 :]), 1e-300) - 1)
        for p, ends in zip(points, near, strict=True)
        if len(ends) > 1
    ]
    row(f"{name}: between points of faces, length against distance", f"{max(gaps):.1e}", "1e-9")


# --- maps -------------------------------------------------------------------------------------------------------------


def plane_error(found: Floats, expected: Floats) -> float:
    """Largest distance between two maps after the best rotation, relative to their size."""
    product = (found[:, 0] + 1j * found[:, 1]) @ np.conj(expected[:, 0] + 1j * expected[:, 1])
    turned = (expected[:, 0] + 1j * expected[:, 1]) * np.exp(1j * np.angle(product))
    return float(np.abs(found[:, 0] + 1j * found[:, 1] - turned).max() / np.abs(turned).max())


def check_maps() -> None:
    bar = "1e-6"
    for name, arrays in (("plane", meshes.grid(60, 60, 0.3)), ("plane, needles", meshes.needles())):
        mesh = sb.Mesh(*arrays)
        graph = sb.SaddleVertexGraph(mesh, k=3)
        center = sb.SurfacePoints([len(mesh.triangles) // 2], [[0.2, 0.3, 0.5]])
        flat = (mesh.vertices - center.positions(mesh))[:, :2]
        row(f"log map, {name}", f"{plane_error(graph.log_map(center, np.inf).uv, flat):.1e}", bar)
        line = sb.trace(mesh, center, [1.0, 0.0, 0.0], 0.3)
        found = sb.polar_coordinates(graph, line, np.inf)
        along = np.clip(flat[:, 0], 0, line.length)
        side = np.hypot(flat[:, 0] - along, flat[:, 1]) * np.sign(flat[:, 1])
        error = max(np.abs(found.distance - side).max(), np.abs(found.along - along).max())
        row(f"polar coordinates, {name}", f"{error / np.abs(flat).max():.1e}", bar)
    check_cylinder(bar)
    check_cone(bar)
    check_sphere()


def check_cylinder(bar: str) -> None:
    around, along = 48, 81
    mesh = sb.Mesh(*meshes.cylinder(around, along, 1.0, 6.0))
    graph = sb.SaddleVertexGraph(mesh, k=3)
    side, source = 2 * np.sin(np.pi / around), 40 * around + 5
    step = (np.arange(len(mesh.vertices)) - source) % around
    flat = np.column_stack([np.where(step > around // 2, step - around, step) * side, mesh.vertices[:, 2] - 3.0])
    keep = step != around // 2
    row("log map, cylinder", f"{plane_error(graph.log_map(source, np.inf).uv[keep], flat[keep]):.1e}", bar)
    ring = sb.SurfaceCurve(mesh, 40 * around + np.arange(around), closed=True)
    found = sb.polar_coordinates(graph, ring, np.inf)
    error = max(
        np.abs(found.distance - (mesh.vertices[:, 2] - 3.0)).max(),
        np.abs(found.along - np.arange(len(mesh.vertices)) % around * side).max(),
    )
    row("polar coordinates, cylinder", f"{error / 3:.1e}", bar)


def check_cone(bar: str) -> None:
    around, along = 48, 40
    mesh = sb.Mesh(*meshes.cone(around, along))
    graph = sb.SaddleVertexGraph(mesh, k=3)
    slant = np.linalg.norm(mesh.vertices - mesh.vertices[0], axis=1)
    turn = 2 * np.pi * ((np.arange(len(mesh.vertices)) - 1) % around) / around
    flat = slant[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    found = graph.log_map(0, np.inf).uv
    row("log map, cone", f"{min(plane_error(found, flat), plane_error(found, flat * (1, -1))):.1e}", bar)
    ruling = sb.SurfaceCurve(mesh, np.arange(1, len(mesh.vertices), around, dtype=np.int32))
    polar = sb.polar_coordinates(graph, ruling, np.inf)
    index = (np.arange(len(mesh.vertices)) - 1) % around
    angle = np.minimum(index, around - index) * mesh.total_angles[0] / around
    x, y = slant * np.cos(angle), slant * np.sin(angle)
    foot = np.clip(x, slant[1], slant[-1])
    distance = np.where(slant > 0, np.hypot(x - foot, y), slant[1])
    near = angle < np.pi / 2
    error = max(
        np.abs(np.abs(polar.distance) - distance)[near].max(), np.abs(polar.along - (foot - slant[1]))[near].max()
    )
    row("polar coordinates, cone", f"{error / slant.max():.1e}", bar)


def check_sphere() -> None:
    """The polyhedron is not the sphere: what converges with its edges, and what is exact."""
    for level in (4, 6):
        mesh = sb.Mesh(*meshes.icosphere(level))
        found = sb.SaddleVertexGraph(mesh, k=3).log_map(0, 1.0)
        x, there = mesh.vertices[0], mesh.vertices[found.vertices]
        axis = np.cross(x, [0.3, 0.4, 0.5])
        axis /= np.linalg.norm(axis)
        turn = np.arctan2(there @ np.cross(x, axis), there @ axis)
        flat = np.arccos(np.clip(there @ x, -1, 1))[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
        row(
            f"log map, sphere of {len(mesh.vertices)} vertices, against the smooth one",
            f"{plane_error(found.uv, flat):.1e}",
        )
        ends = sb.exp_map(mesh, 0, found.uv).positions(mesh)
        row(
            "    its exponential map, against the vertices", f"{np.linalg.norm(ends - there, axis=1).max():.1e}", "1e-6"
        )


def check_inverse(folder: Path) -> None:
    """log(exp(v)) = v for vectors whose straightest curve is a shortest path."""
    for name in INVERTED:
        mesh = sb.read_mesh(folder / f"{name}.ply")
        rng = np.random.default_rng(2)
        worst, count = 0.0, 0
        for center in random_points(mesh, 10, seed=3):
            exact = sb.ExactField(mesh, center)
            uv = rng.normal(size=(6, 2)) * 4 * mesh.mean_edge_length
            ends = sb.exp_map(mesh, center, uv)
            for vector, end in zip(uv, ends, strict=True):
                length = float(np.linalg.norm(vector))
                if end.faces[0] == center.faces[0] or abs(exact.distance_to(end)[0] / length - 1) > 1e-9:
                    continue
                cut = with_vertex_at(mesh, end)
                face = int(np.flatnonzero((cut.triangles == mesh.triangles[center.faces[0]]).all(axis=1))[0])
                found = sb.SaddleVertexGraph(cut, k=3).log_map(
                    sb.SurfacePoints([face], center.barycentric), 1.01 * length
                )
                there = found.uv[found.vertices == len(mesh.vertices)][0]
                worst = max(worst, float(np.linalg.norm(there - vector)) / length)
                count += 1
        row(f"log(exp(v)) = v, {name}, {count} vectors", f"{worst:.1e}", "1e-6")


def main(arguments: list[str]) -> int:
    folder = Path(arguments[0])
    factor = float(arguments[1]) if len(arguments) > 1 else 1.0
    row("measure", "found", "bar (goal)")
    for name in CHECKED:
        mesh = sb.read_mesh(folder / f"{name}.ply")
        graph = sb.SaddleVertexGraph(mesh, accuracy=5e-3)
        if name == TIMED:
            for shorten in (False, True):
                spent, points = time_of_a_path(graph, shorten)
                bar = "" if shorten else f"{40 * factor:.0f} ({20 * factor:.0f})"
                row(f"{name}: a path of {points:.0f} points{', shortened' if shorten else ''}, us", f"{spent:.1f}", bar)
        check_paths(name, graph, mesh)
    check_maps()
    check_inverse(folder)
    return 0

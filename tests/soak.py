# SPDX-License-Identifier: GPL-3.0-or-later
"""A long time of use in one process; see tests/soak. Runs where `bpy` is."""

from __future__ import annotations

import contextlib
import ctypes
import gc
import hashlib
import random
import re
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "addon")]
bpy.ops.preferences.addon_enable(module="saddleback_blender")

import saddleback as sb
from saddleback_blender import jobs
from saddleback_blender.core import cache

KINDS = 4
SCENARIOS = 120  # of all kinds together; each is repeated in every round, in another order
ROUNDS_TO_WARM = 3
FLAT = 0.02
OPERATORS = (
    "tessellate",
    "distance",
    "path",
    "ribbon",
    "direction_field",
    "distribute",
    "check_distribution",
    "voronoi_2d",
    "repair",
    "apply_look",
)
NAMES = ("", "Density", "numbers", "UV", "Kept", "Line", "Gone", "\u00e4" * 70, "\n")
CHANGED = 0.06  # of an operator's settings: with more of them at random nearly every run is refused
MOST = {"count": 40, "iterations": 4, "starts": 2, "annealing": 3, "isoline_count": 8, "arrow_count": 50}


class FindingError(Exception):
    """What the soak is after."""


def main() -> int:
    minutes = float(sys.argv[1]) if len(sys.argv) > 1 else 120.0
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else random.SystemRandom().randrange(10**6)
    print(f"seed {seed}", flush=True)
    order = random.Random(seed)
    first: dict[int, str] = {}
    sizes: list[float] = []
    end = time.monotonic() + 60 * minutes
    while time.monotonic() < end or len(sizes) <= ROUNDS_TO_WARM + 1:
        for number in order.sample(range(SCENARIOS), SCENARIOS):
            digest = scenario(1000 * seed + number, number % KINDS)
            if first.setdefault(number, digest) != digest:
                raise FindingError(f"scenario {number} of seed {seed} gave another result in round {len(sizes)}")
        sizes.append(resident())
        print(f"round {len(sizes)}: {sizes[-1]:.1f} MiB", flush=True)
    settled = np.array(sizes[ROUNDS_TO_WARM:])
    half = max(1, len(settled) // 2)
    growth = float(np.median(settled[-half:]) / np.median(settled[:half]) - 1)
    print(f"{len(sizes)} rounds, {SCENARIOS * len(sizes)} calls, memory {growth:+.2%}")
    if growth > FLAT:
        raise FindingError(f"memory grew by {growth:.2%} from the first to the second half")
    return 0


def resident() -> float:
    """MiB of this process, caches emptied."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    cache.shared.clear()
    gc.collect()
    ctypes.CDLL("libc.so.6").malloc_trim(0)
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096 / 2**20


def scenario(seed: int, kind: int) -> str:
    """What one call with its input gives, as a digest."""
    rng = random.Random(seed)
    digest = hashlib.blake2b(digest_size=16)
    (operators, library, stopped, files)[kind](rng, digest)
    return digest.hexdigest()


def arrays(rng: random.Random) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """A bumpy ball, torus or sheet of a few hundred triangles."""
    n, noise = rng.randrange(6, 14), np.random.default_rng(rng.randrange(10**6))
    u, v = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(n)))
    kind = rng.choice(("torus", "sheet"))
    number = np.arange(n * n).reshape(n, n)
    if kind == "torus":
        a, b = 2 * np.pi * u / n, 2 * np.pi * v / n
        vertices = np.stack([(2 + np.cos(b)) * np.cos(a), (2 + np.cos(b)) * np.sin(a), np.sin(b)], axis=1)
        near, far = number, np.roll(number, -1, axis=1)
        quads = np.stack([near, far, np.roll(far, -1, axis=0), np.roll(near, -1, axis=0)], axis=-1).reshape(-1, 4)
    else:
        vertices = np.stack([u / n, v / n, np.zeros(n * n)], axis=1)
        quads = np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]], axis=-1).reshape(-1, 4)
    vertices = vertices + noise.normal(size=vertices.shape) * 0.2 / n
    return vertices, np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]]).astype(np.int32)


def operators(rng: random.Random, digest: Any) -> None:
    """A few operators with settings at random; what they refuse has a sentence."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    cache.shared.clear()
    item = scene(rng)
    for _ in range(rng.randrange(1, 4)):
        name = rng.choice(OPERATORS)
        try:
            getattr(bpy.ops.saddleback, name)(**settings(name, rng))
            line = jobs.state.line
        except RuntimeError as error:
            line = str(error)
            if "Traceback" in line:
                raise FindingError(f"{name}: {line}") from error
        digest.update(re.sub(r", [\d.]+ s$", "", line).encode())
    for block in sorted(bpy.data.objects, key=lambda other: other.name):
        digest.update(block.name.encode())
        if block.type == "MESH":
            tell_mesh(block.data, digest)
    if rng.random() < 0.3:
        bpy.context.view_layer.objects.active = item
        bpy.ops.saddleback.clear()
        digest.update(str(len(bpy.data.objects)).encode())


def scene(rng: random.Random) -> bpy.types.Object:
    """An object with something painted on it, and things beside it."""
    vertices, triangles = arrays(rng)
    mesh = bpy.data.meshes.new("Body")
    mesh.from_pydata(vertices.tolist(), [], triangles.tolist())
    item = bpy.data.objects.new("Body", mesh)
    kept = bpy.data.collections.new("Kept")
    bpy.context.scene.collection.objects.link(item)
    bpy.context.scene.collection.children.link(kept)
    curve = bpy.data.curves.new("Line", "CURVE")
    curve.dimensions = "3D"
    spline = curve.splines.new("POLY")
    spline.points.add(3)
    for point in spline.points:
        point.co = (*(rng.uniform(-1, 1) for _ in range(3)), 1)
    spline.use_cyclic_u = rng.random() < 0.5
    for beside in (bpy.data.objects.new("Line", curve), bpy.data.objects.new("1", None)):
        kept.objects.link(beside)
    bpy.context.view_layer.layer_collection.children["Kept"].exclude = rng.random() < 0.5
    group = item.vertex_groups.new(name="Density")
    for vertex in range(0, len(vertices), 2):
        group.add([vertex], rng.random(), "REPLACE")
    mesh.uv_layers.new(name="UV")
    numbers = mesh.attributes.new("numbers", "FLOAT", "POINT")
    numbers.data.foreach_set("value", np.linspace(0.1, 1.0, len(vertices), dtype=np.float32))
    chosen = np.zeros(len(vertices), bool)
    chosen[: rng.randrange(5)] = True
    mesh.vertices.foreach_set("select", chosen)
    if rng.random() < 0.3:
        item.modifiers.new("Fine", "SUBSURF").levels = 1
    bpy.context.view_layer.objects.active = item
    bpy.context.view_layer.update()
    return item


def settings(name: str, rng: random.Random) -> dict[str, Any]:
    """Some of the operator's properties, at their limits or within them."""
    chosen: dict[str, Any] = {}
    for prop in getattr(bpy.ops.saddleback, name).get_rna_type().properties:
        # How long it takes to fill a surface is as small shapes say: minutes where those are tiny.
        if prop.identifier in ("rna_type", "maximal") or rng.random() > CHANGED:
            continue
        if prop.type == "BOOLEAN":
            chosen[prop.identifier] = rng.random() < 0.5
        elif prop.type == "INT":
            value = rng.choice((prop.hard_min, prop.soft_min, prop.default, 1, 7))
            chosen[prop.identifier] = max(prop.hard_min, min(prop.hard_max, value, MOST.get(prop.identifier, 60)))
        elif prop.type == "FLOAT":
            chosen[prop.identifier] = rng.choice((prop.soft_min, prop.default, prop.soft_max, 0.05, 0.3))
        elif prop.type == "ENUM":
            chosen[prop.identifier] = rng.choice([item.identifier for item in prop.enum_items])
        elif prop.type == "STRING":
            chosen[prop.identifier] = rng.choice(NAMES)
    if name in ("tessellate", "distribute", "check_distribution", "voronoi_2d"):
        chosen["count"] = rng.randrange(1, 40)
    return chosen


def tell_mesh(mesh: bpy.types.Mesh, digest: Any) -> None:
    places = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", places)
    digest.update(places.tobytes())
    for attribute in sorted(mesh.attributes, key=lambda other: other.name):
        if attribute.data_type in ("FLOAT", "INT") and not attribute.name.startswith("."):
            values = np.empty(len(attribute.data), np.float32 if attribute.data_type == "FLOAT" else np.int32)
            attribute.data.foreach_get("value", values)
            digest.update(attribute.name.encode() + values.tobytes())


def library(rng: random.Random, digest: Any) -> None:
    """Calls of the library on one mesh, on one thread and on two."""
    mesh = sb.Mesh(*arrays(rng))
    seed, count = rng.randrange(99), rng.randrange(2, 30)
    one, two = (_library(mesh, seed, count, threads) for threads in (1, 2))
    if one != two:
        raise FindingError("two threads give another result than one")
    digest.update(one)


def _library(mesh: sb.Mesh, seed: int, count: int, threads: int) -> bytes:
    graph = sb.SaddleVertexGraph(mesh, k=20, threads=threads)
    cvt = sb.centroidal_voronoi(graph, count=count, seed=seed, max_iterations=5, threads=threads)
    disks = sb.distribute(graph, [sb.Shape.disk(8)], 10, size=0.1, seed=seed, threads=threads).placements
    exact = sb.exact_distances(mesh, [seed % len(mesh.vertices)])
    found = (graph.distances([0]), cvt.sites.barycentric, cvt.cells.areas, exact, disks.angle)
    return b"".join(np.ascontiguousarray(values).tobytes() for values in found)


def stopped(rng: random.Random, digest: Any) -> None:
    """A call that another thread stops at some moment, and then the same to its end."""
    mesh = sb.Mesh(*arrays(rng))
    seed = rng.randrange(99)
    calls: tuple[Callable[[Any], Any], ...] = (
        lambda job: sb.SaddleVertexGraph(mesh, k=30, job=job).distances([seed % 30]),
        lambda job: sb.exact_distances(mesh, [seed % 30], job=job),
        lambda job: sb.distribute(mesh, [sb.Shape.disk(8)], 60, size=0.05, seed=seed, job=job).placements.angle,
    )
    call = rng.choice(calls)
    job = sb.Job()
    timer = threading.Timer(rng.uniform(0, 0.01), job.cancel)
    timer.start()
    with contextlib.suppress(sb.Cancelled):
        call(job)
    timer.join()
    digest.update(np.ascontiguousarray(call(sb.Job())).tobytes())


def files(rng: random.Random, digest: Any) -> None:
    """Graphs, meshes and .blend files, written and read."""
    mesh = sb.Mesh(*arrays(rng))
    graph = sb.SaddleVertexGraph(mesh, k=15)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder)
        graph.save(path / "graph.svg")
        again = sb.SaddleVertexGraph.load(path / "graph.svg", mesh)
        if not np.array_equal(again.distances([1]), graph.distances([1])):
            raise FindingError("a graph that was saved gives other distances")
        corners = "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in mesh.vertices.tolist())
        faces = "".join("f {} {} {}\n".format(*face) for face in (mesh.triangles + 1).tolist())
        (path / "mesh.obj").write_text(corners + faces)
        if not np.array_equal(sb.read_mesh(path / "mesh.obj").vertices, mesh.vertices):
            raise FindingError("a mesh that was written is read otherwise")
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        item = scene(rng)
        bpy.ops.saddleback.tessellate(count=6, iterations=2, make_cells=True)
        for _ in range(2):
            bpy.ops.wm.save_as_mainfile(filepath=str(path / "file.blend"), check_existing=False)
            bpy.ops.wm.open_mainfile(filepath=str(path / "file.blend"))
            item = bpy.data.objects["Body"]
            bpy.context.view_layer.objects.active = item
            bpy.ops.saddleback.tessellate()
            digest.update(",".join(sorted(bpy.data.objects.keys())).encode())
            tell_mesh(item.data, digest)


if __name__ == "__main__":
    sys.exit(main())

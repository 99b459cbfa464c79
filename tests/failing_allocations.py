# SPDX-License-Identifier: MIT
"""Lets the n-th allocation of native work fail, for each entry point and each n: a MemoryError, or the right result.

    python tests/failing_allocations.py [PATTERN]

A shared library with an `operator new` of its own is compiled, loaded before all others, and told which allocation
shall fail. Afterwards the same call must give what it gave before: nothing half-made may be left behind.
"""

from __future__ import annotations

import ctypes
import fnmatch
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
SOURCE = r"""
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <dlfcn.h>
#include <new>
namespace {
std::atomic<long> countdown{-1};
// What has Python's lock is pybind11's, which does not survive a failure in its own books.
bool has_python_lock() {
  static const auto check = reinterpret_cast<int (*)()>(dlsym(RTLD_DEFAULT, "PyGILState_Check"));
  return check && check();
}
}
extern "C" void fail_after(long n) { countdown = n; }
extern "C" long left() { return countdown; }
namespace {
void* allocate(std::size_t size, std::size_t alignment) {
  if (countdown.load() >= 0 && !has_python_lock() && countdown.fetch_sub(1) == 0) return nullptr;
  if (alignment <= alignof(std::max_align_t)) return std::malloc(size ? size : 1);
  return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}
void* or_throw(void* memory) { if (!memory) throw std::bad_alloc(); return memory; }
}
using A = std::align_val_t;
void* operator new(std::size_t n) { return or_throw(allocate(n, 1)); }
void* operator new[](std::size_t n) { return or_throw(allocate(n, 1)); }
void* operator new(std::size_t n, A a) { return or_throw(allocate(n, static_cast<std::size_t>(a))); }
void* operator new[](std::size_t n, A a) { return or_throw(allocate(n, static_cast<std::size_t>(a))); }
void* operator new(std::size_t n, const std::nothrow_t&) noexcept { return allocate(n, 1); }
void* operator new[](std::size_t n, const std::nothrow_t&) noexcept { return allocate(n, 1); }
void operator delete(void* p) noexcept { std::free(p); }
void operator delete[](void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t) noexcept { std::free(p); }
void operator delete(void* p, A) noexcept { std::free(p); }
void operator delete[](void* p, A) noexcept { std::free(p); }
void operator delete(void* p, std::size_t, A) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t, A) noexcept { std::free(p); }
"""


def calls() -> dict[str, Callable[[], object]]:
    """Entry points by name, each with something that tells whether a result is right."""
    import saddleback as sb
    from tests import meshes

    vertices, triangles = meshes.icosphere(2)
    mesh = sb.Mesh(vertices, triangles)
    disk = sb.Mesh(*meshes.grid(8, 8, jitter=0.3))
    graph = sb.SaddleVertexGraph(mesh, threads=2)
    cells = sb.geodesic_voronoi(graph, [0, 9, 40, 70])
    field = sb.direction_field(mesh, 1)
    sites = np.random.default_rng(1).random((60, 2))
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    diagram = sb.voronoi_2d(sites)
    laid = sb.distribute(mesh, sb.Shape.star(), 5, size=0.05)
    uv = sb.harmonic_map(disk)
    chart = sb.Chart(disk, uv)
    few = np.arange(5, dtype=np.int32)
    return {
        "Mesh": lambda: sb.Mesh(vertices, triangles).area,
        "repair": lambda: sb.repair(vertices[triangles].reshape(-1, 3), np.arange(960).reshape(-1, 3))[0].fingerprint,
        "SaddleVertexGraph": lambda: sb.SaddleVertexGraph(mesh, threads=2).arc_count,
        "exact_distances": lambda: sb.exact_distances(mesh, 0).sum(),
        "ExactField.path": lambda: sb.ExactField(mesh, [0]).path(50).length,
        "graph.distances": lambda: graph.distances(few).sum(),
        "graph.fields": lambda: graph.fields(few).sum(),
        "graph.nearest": lambda: graph.nearest(few)[0].sum(),
        "graph.paths": lambda: graph.paths(few, np.arange(20, 40, dtype=np.int32), shorten=True).lengths.sum(),
        "graph.log_map": lambda: graph.log_map(0, 1.0).uv.sum(),
        "polar_coordinates": lambda: sb.polar_coordinates(graph, graph.path(0, 50), 0.5).distance.sum(),
        "shorten_curve": lambda: sb.shorten_curve(sb.curve_through(graph, [0, 20, 50])).length,
        "stroke_map": lambda: sb.stroke_map(mesh, graph.path(0, 50), 0.5).uv.sum(),
        "exp_map": lambda: sb.exp_map(mesh, 0, [(0.1, 0.2)]).barycentric.sum(),
        "geodesic_voronoi": lambda: sb.geodesic_voronoi(graph, few).areas.sum(),
        "geodesic_voronoi exact": lambda: sb.geodesic_voronoi(graph, few, exact=True).areas.sum(),
        "split": lambda: cells.split().vertices.sum(),
        "dual": lambda: cells.dual().vertices.sum(),
        "dual_paths": lambda: sum(path.length for path in cells.dual_paths()),
        "centroidal_voronoi": lambda: sb.centroidal_voronoi(graph, count=8, max_iterations=3).energy[-1],
        "direction_field": lambda: sb.direction_field(mesh, 4).vectors.sum(),
        "streamline": lambda: sb.streamline(mesh, field, 3, 0.7).length,
        "spread_values": lambda: sb.spread_values(mesh, few, np.arange(5.0)).sum(),
        "principal_curvatures": lambda: sb.principal_curvatures(mesh)[0].sum(),
        "distribute": lambda: len(sb.distribute(mesh, sb.Shape.star(), 5, size=0.05).placements),
        "distribute maximal": lambda: len(sb.distribute(mesh, sb.Shape.disk(), size=0.5, maximal=True).placements),
        "check_distribution": lambda: str(sb.check_distribution(mesh, laid)),
        "cut": lambda: laid.mapped.cut().vertices.sum(),
        "voronoi_2d": lambda: sb.voronoi_2d(sites).vertices.sum(),
        "voronoi_2d weighted": lambda: sb.voronoi_2d(sites, np.linspace(0, 0.1, 60)).vertices.sum(),
        "clip": lambda: diagram.clip(square).areas.sum(),
        "locate": lambda: diagram.locate(sites).sum(),
        "relax_2d": lambda: sb.relax_2d(sites, square, max_iterations=3).energy[-1],
        "SweepCircle": lambda: sb.SweepCircle(sites, (0.5, 0.5)).step() is not None,
        "harmonic_map": lambda: sb.harmonic_map(disk).sum(),
        "Chart": lambda: sb.Chart(disk, uv).places(sb.sample(disk, 4)).sum(),
        "lift": lambda: len(chart.lift(diagram).areas),
        "sample": lambda: sb.sample(mesh, 50).barycentric.sum(),
        "project": lambda: sb.project(mesh, vertices * 1.1).barycentric.sum(),
        "trace": lambda: sb.trace(mesh, 0, 0.3, 2.0).length,
        "feature_curves": lambda: len(sb.feature_curves(mesh, 0.1)),
        "add_barriers": lambda: sb.add_barriers(mesh, edges=mesh.edges[::5], faces=[3]).mesh.area,
        "hausdorff_distance": lambda: sb.hausdorff_distance(mesh, disk, 1e-2).distance,
        "self_crossings": lambda: len(sb.self_crossings(vertices, triangles)),
        "from_mask": lambda: sb.Shape.from_mask(np.pad(np.ones((20, 20), bool), 4)).area,
        "SafeDistanceTable": lambda: sb.SafeDistanceTable(sb.Shape.star(), sb.Shape.leaf()).distance(
            0.1, 0.2, 1.0, 1.0
        ),
    }


def numbers() -> list[int]:
    """All of the first, then fewer and fewer: later allocations are mostly those of loops."""
    return [*range(60), *np.unique(np.geomspace(60, 100_000, 60).astype(int)).tolist()]


def attempt(name: str, call: Callable[[], object], shim: ctypes.CDLL) -> list[str]:
    """What goes wrong for one entry point."""
    right, found = call(), []
    for number in numbers():
        shim.fail_after(number)
        try:
            got, has_failed = call(), False
        except MemoryError:
            got, has_failed = right, True
        except BaseException as error:
            got, has_failed = right, True
            if "more than the memory there is" not in str(error):  # that would be a sentence
                found.append(f"{name}, allocation {number}: {type(error).__name__}: {error}")
        reached = shim.left() < 0
        shim.fail_after(-1)
        if got != right or call() != right:
            found.append(f"{name}, allocation {number}: another result {'later' if has_failed else ''}")
        if not reached:
            break
    return found


def main(pattern: str) -> int:
    if "SADDLEBACK_FAILING_NEW" not in os.environ:
        with tempfile.TemporaryDirectory() as folder:
            library = Path(folder) / "failing_new.so"
            command = ["g++", "-O1", "-shared", "-fPIC", "-x", "c++", "-", "-o", str(library)]
            subprocess.run(command, input=SOURCE, text=True, check=True)
            environment = os.environ | {"SADDLEBACK_FAILING_NEW": str(library), "LD_PRELOAD": str(library)}
            return subprocess.run([sys.executable, *sys.argv], env=environment, check=False).returncode
    sys.path.insert(0, str(ROOT))
    shim = ctypes.CDLL(os.environ["SADDLEBACK_FAILING_NEW"])
    shim.fail_after.argtypes, shim.left.restype = [ctypes.c_long], ctypes.c_long
    total = 0
    for name, call in calls().items():
        if not fnmatch.fnmatch(name, pattern):
            continue
        found = attempt(name, call, shim)
        total += len(found)
        print(f"{name}: {len(found)} findings", *found[:5], sep="\n  ", flush=True)
    return bool(total)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else "*"))

# SPDX-License-Identifier: MIT
"""Safe in any process: after a fork, in daemon threads at the end, under Ctrl-C and limits of memory, when pickled."""

from __future__ import annotations

import contextlib
import copy
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import saddleback as sb
from tests import meshes

posix = pytest.mark.skipif(os.name != "posix", reason="fork, signals and limits as POSIX has them")
START = """
import os, signal, sys, threading, time
import numpy as np
import saddleback as sb
from tests import meshes
mesh = sb.Mesh(*meshes.icosphere(6))
TURN = np.array([[0.96, 0.28, 0], [-0.28, 0.96, 0], [0, 0, 1]])
def work():
    graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.icosphere(3)), threads=4)
    return float(graph.distances(0).sum())
"""


def run(code: str, timeout: float = 60, **options: object) -> subprocess.CompletedProcess[str]:
    """A Python of its own."""
    root = str(Path(__file__).resolve().parents[3])
    paths = os.pathsep.join([root, os.environ.get("PYTHONPATH", "")])
    return subprocess.run(
        [sys.executable, "-c", START + code],
        capture_output=True,
        text=True,
        timeout=timeout,
        check=False,
        env=os.environ | {"PYTHONPATH": paths},
        **options,  # type: ignore[call-overload]
    )


@posix
@pytest.mark.parametrize("before", ["pass", "work()"], ids=["fresh", "after a parallel call"])
def test_a_forked_child_computes_as_its_parent(before):
    done = run(f"""
{before}
child = os.fork()
value = work()
if child == 0:
    os._exit(0 if value > 0 else 1)
assert os.waitpid(child, 0)[1] == 0
print(value == work())
""")
    assert done.stdout.strip() == "True", done.stderr


@posix
def test_a_fork_amid_anothers_parallel_call():
    done = run("""
other = threading.Thread(target=lambda: sb.SaddleVertexGraph(mesh, accuracy=2e-3, threads=4))
other.start()
codes = []
for _ in range(5):
    time.sleep(0.05)
    child = os.fork()
    if child == 0:
        work()
        os._exit(0)
    codes.append(os.waitpid(child, 0)[1])
other.join()
print(codes)
""")
    assert done.stdout.strip() == "[0, 0, 0, 0, 0]", done.stderr


@posix
def test_multiprocessing_by_fork():
    done = run("""
import multiprocessing
work()
with multiprocessing.get_context("fork").Pool(2) as pool:
    print(len(set(pool.starmap(work, [()] * 4))))
""")
    assert done.stdout.strip() == "1", done.stderr


@pytest.mark.parametrize(
    "call",
    [
        "sb.SaddleVertexGraph(mesh, accuracy=1e-3)",
        "sb.SaddleVertexGraph(mesh, accuracy=1e-3, job=sb.Job())",
        "[sb.voronoi_2d(np.random.rand(20000, 2)) for _ in range(10**6)]",
        "[sb.relax_2d(np.random.rand(50, 2), [(0,0),(1,0),(1,1),(0,1)], lambda p: p[:, 0] + 1) for _ in range(10**6)]",
        "[sb.exact_distances(mesh, 0) for _ in range(10**6)]",
    ],
)
def test_daemon_threads_at_the_end(call):
    done = run(f"""
for _ in range(3):
    threading.Thread(target=lambda: {call}, daemon=True).start()
time.sleep(0.4)
print("leaving", flush=True)
""")
    assert (done.returncode, done.stdout.strip(), done.stderr) == (0, "leaving", "")


INTERRUPTED = {
    "graph": "sb.SaddleVertexGraph(mesh, accuracy=3e-4)",
    "graph with a job": "sb.SaddleVertexGraph(mesh, accuracy=3e-4, job=sb.Job())",
    "exact": "sb.exact_distances(sb.Mesh(*meshes.icosphere(7)), [0, 9])",
    "relaxation": "sb.relax_2d(np.random.rand(30000, 2), [(0,0),(1,0),(1,1),(0,1)], max_iterations=1000, tolerance=0)",
    "plane": "[sb.voronoi_2d(np.random.rand(1000000, 2)) for _ in range(100)]",
    "farthest point": "sb.hausdorff_distance(mesh, sb.Mesh(1.01 * mesh.vertices @ TURN, mesh.triangles), 1e-9)",
}


@posix
@pytest.mark.parametrize("call", INTERRUPTED.values(), ids=INTERRUPTED.keys())
def test_ctrl_c_stops_a_call(call):
    done = run(f"""
handler = signal.getsignal(signal.SIGINT)
def press():
    global pressed
    pressed = time.monotonic()
    os.kill(os.getpid(), signal.SIGINT)
threading.Timer(0.6, press).start()
try:
    {call}
    print("ended by itself")
except KeyboardInterrupt:
    waited = time.monotonic() - pressed
    assert signal.getsignal(signal.SIGINT) is handler
    print("stopped" if waited < 0.6 else f"after {{waited}} s")  # 0.1 s of our own, on a machine that does other things
""")
    assert done.stdout.strip() == "stopped", done.stdout + done.stderr


@posix
def test_ctrl_c_is_left_to_a_handler_of_the_programs_own():
    """It may want the call to go on."""
    done = run("""
seen = []
signal.signal(signal.SIGINT, lambda *_: seen.append(1))
threading.Timer(0.1, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
start = time.monotonic()
while time.monotonic() - start < 0.5:
    work()
print(seen)
""")
    assert done.stdout.strip() == "[1]", done.stderr


@posix
def test_ctrl_c_reaches_only_the_main_threads_call():
    done = run("""
result = []
other = threading.Thread(target=lambda: result.append(sb.SaddleVertexGraph(mesh, accuracy=5e-3).arc_count))
other.start()
try:
    threading.Timer(0.1, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    time.sleep(10)
except KeyboardInterrupt:
    pass
other.join()
print(len(result))
""")
    assert done.stdout.strip() == "1", done.stderr


@posix
@pytest.mark.parametrize("threads", [8, 32])
@pytest.mark.parametrize("spare", [0, 1, 4, 12, 16, 22, 28, 36, 48, 64])
def test_little_memory_is_an_exception_or_enough(spare, threads):
    done = run(f"""
import resource
sites = np.random.default_rng(1).random((200000, 2))
size = int(open("/proc/self/statm").read().split()[0]) * 4096 + ({spare} << 20)
resource.setrlimit(resource.RLIMIT_AS, (size, size))
def ask():
    for call in (lambda: sb.SaddleVertexGraph(mesh, threads={threads}), lambda: sb.voronoi_2d(sites, threads={threads}),
                 lambda: sb.exact_distances(mesh, 0), lambda: sb.project(mesh, mesh.vertices, threads={threads})):
        try:
            call()
        except MemoryError:
            pass
ask()
try:
    thread = threading.Thread(target=ask)
    thread.start()
    thread.join()
except (MemoryError, RuntimeError):  # no thread for want of memory
    pass
os.write(1, b"alive")
""")
    assert done.stdout.strip() == "alive", done.stderr


@posix
def test_arrays_that_no_memory_is_left_for_are_a_memory_error():
    """Those that have to be brought into another order or type: no ValueError."""
    done = run("""
import resource
places, corners = np.ones((4_000_000, 4), np.float32)[:, :3], np.zeros((4_000_000, 4), np.int32)[:, :3]
size = int(open("/proc/self/statm").read().split()[0]) * 4096 + (32 << 20)
resource.setrlimit(resource.RLIMIT_AS, (size, size))
for ask in (lambda: sb.project(mesh, places), lambda: sb.triangle_edges(corners, 1)):
    try:
        ask()
    except MemoryError:
        print("none left")
""")
    assert done.stdout.split("\n")[:2] == ["none left"] * 2, done.stderr


def some_objects() -> dict[str, object]:
    mesh = sb.Mesh(*meshes.grid(8, 8))
    graph = sb.SaddleVertexGraph(mesh)
    cells = sb.geodesic_voronoi(graph, [0, 9, 20])
    laid = sb.distribute(mesh, sb.Shape.star(), 3, size=0.05)
    return {
        "mesh": mesh,
        "graph": graph,
        "cells": cells,
        "dual": cells.dual(),
        "split": cells.split(),
        "path": graph.path(0, 9),
        "log map": graph.log_map(0, 1.0),
        "field": sb.direction_field(mesh, 1),
        "shape": sb.Shape.star(),
        "distribution": laid,
        "placements": laid.placements,
        "mapped": laid.mapped,
        "diagram": sb.voronoi_2d(np.random.default_rng(0).random((9, 2))),
        "job": sb.Job(),
        "sweep": sb.SweepCircle(np.random.default_rng(0).random((9, 2)), (0.5, 0.5)),
        "exact": sb.ExactField(mesh, [0]),
    }


def is_copied_or_refused(how: Callable[[object], object], value: object) -> bool:
    """Give another object of the same type, or a sentence that names the type."""
    try:
        return type(how(value)) is type(value)
    except TypeError as error:
        return type(value).__name__ in str(error)


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_what_is_not_pickled_says_so(protocol):
    for name, value in some_objects().items():
        assert is_copied_or_refused(lambda value: pickle.loads(pickle.dumps(value, protocol)), value), name


@pytest.mark.parametrize("how", [copy.copy, copy.deepcopy])
def test_what_is_not_copied_says_so(how):
    for name, value in some_objects().items():
        assert is_copied_or_refused(how, value), name


def test_no_empty_object_is_made_of_a_class_that_nobody_constructs():
    """It would hold whatever was in its memory before."""
    for made in (sb.GeodesicVoronoi, sb.DualMesh, sb.CentroidalVoronoi, sb.Distribution, sb.Quality, sb.RepairReport):
        with pytest.raises(TypeError):
            made.__new__(made)
        with pytest.raises(TypeError, match="is made by the calls that return one"):
            made()


def test_a_sub_interpreter_is_refused():
    done = run("""
try:
    import _interpreters as interpreters
except ImportError:
    import _xxsubinterpreters as interpreters
other = interpreters.create()
try:
    failed = interpreters.run_string(other, "import saddleback")
except Exception as error:
    failed = error
print("main interpreter only" in str(failed), work() > 0)
""")
    assert done.stdout.strip() == "True True", done.stdout + done.stderr


def test_arrays_that_another_thread_writes_meanwhile():
    """What was checked is what is used: the numbers of corners are copied while nobody else runs."""
    vertices, triangles = meshes.icosphere(5)
    cells = np.zeros(len(triangles), np.int32)
    stop = threading.Event()

    def write() -> None:
        rng = np.random.default_rng(0)
        while not stop.is_set():
            triangles[rng.integers(len(triangles)), 1] = rng.choice([-1, 10**9, 5])
            cells[rng.integers(len(cells))] = rng.choice([-1, 10**9, 2])

    _, clean = meshes.icosphere(5)
    writer = threading.Thread(target=write)
    writer.start()
    try:
        for _ in range(5):
            for call in (
                lambda: sb.triangle_edges(triangles, len(vertices)),
                lambda: sb.border_edges(triangles, len(vertices)),
                lambda: sb.vertex_normals(vertices, triangles),
                lambda: sb.triangle_quality(vertices, triangles),
                lambda: sb.self_crossings(vertices, triangles),
                lambda: sb.cell_boundary(triangles, cells, len(vertices)),
                lambda: sb.cell_boundary_distance(vertices, triangles, cells),
                lambda: sb.Mesh(vertices, triangles),
            ):
                triangles[:], cells[:] = clean, 1
                with contextlib.suppress(sb.Error):
                    call()
    finally:
        stop.set()
        writer.join()


def test_signals_between_calls_do_not_linger():
    """A job that was cancelled by one Ctrl-C is not that of the next call."""
    if threading.current_thread() is not threading.main_thread():
        pytest.skip("signals belong to the main thread")
    mesh = sb.Mesh(*meshes.icosphere(3))
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)
        time.sleep(1)
    assert sb.SaddleVertexGraph(mesh).arc_count > 0


@pytest.mark.skipif(sys.platform != "linux", reason="the size of the process is read as Linux shows it")
def test_what_a_limit_leaves_is_known_beforehand():
    """Not only what the machine has: a sentence instead of a try that fails half-way."""
    done = run("""
import resource
graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.icosphere(5)))
size = int(open("/proc/self/statm").read().split()[0]) * 4096 + (200 << 20)
resource.setrlimit(resource.RLIMIT_AS, (size, size))
try:
    graph.fields(np.arange(8000, dtype=np.int32))
except sb.InputError as error:
    print(error)
""")
    assert "vertices take 0.7 GB, more than the memory there is (0." in done.stdout, done.stderr


@pytest.mark.skipif(sys.platform != "linux", reason="the size of the process is read as Linux shows it")
def test_windows_that_memory_cannot_keep_are_refused_while_some_is_left():
    """On smooth surfaces their number for each vertex grows with the root of the vertices: 50 GB of a million."""
    done = run("""
import resource
mesh = sb.Mesh(*meshes.icosphere(6))
size = int(open("/proc/self/statm").read().split()[0]) * 4096 + (200 << 20)
resource.setrlimit(resource.RLIMIT_AS, (size, size))
try:
    sb.ExactField(mesh, [0])
except sb.InputError as error:
    print(error)
print(np.isfinite(sb.exact_distances(mesh, [0])).all())
""")
    assert "the windows of exact distances take 0." in done.stdout, done.stderr
    assert "of 40962 vertices are reached, and 0." in done.stdout, done.stdout
    assert done.stdout.strip().endswith("True"), done.stdout


@posix
@pytest.mark.parametrize("what", ["geodesic_voronoi", "voronoi_2d", "graph.paths"])
def test_an_allocation_that_fails_is_a_memory_error(what):
    """`python tests/failing_allocations.py` does so for every entry point."""
    root = str(Path(__file__).resolve().parents[3])
    command = [sys.executable, os.path.join(root, "tests/failing_allocations.py"), what]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert (done.returncode, done.stdout.strip()) == (0, f"{what}: 0 findings"), done.stdout + done.stderr

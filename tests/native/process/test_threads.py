# SPDX-License-Identifier: MIT
"""Threads stay from loop to loop, number no more than makes sense, and leave signals to the program."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import saddleback as sb
from tests import meshes

TASKS = Path("/proc/self/task")
on_linux = pytest.mark.skipif(sys.platform != "linux", reason="only Linux shows a program's threads as files")


def thread_names() -> set[str]:
    return {task.name for task in TASKS.iterdir()}


@on_linux
def test_threads_stay_from_loop_to_loop() -> None:
    """To begin one takes longer than most loops, of which an iteration has dozens, some with few pieces of work."""
    graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.grid(60, 60)), k=40, threads=6)

    def threads_after_relaxing() -> set[str]:
        sb.centroidal_voronoi(graph, count=200, max_iterations=5, tolerance=0, threads=6)
        return thread_names()

    before = threads_after_relaxing()
    assert threads_after_relaxing() <= before


@on_linux
@pytest.mark.parametrize("threads", [100_000, 2**31 - 1])
def test_far_too_many_threads_count_as_what_makes_sense(threads) -> None:
    mesh = sb.Mesh(*meshes.grid(80, 80))
    few = sb.SaddleVertexGraph(mesh, k=20, threads=1)
    many = sb.SaddleVertexGraph(mesh, k=20, threads=threads)
    assert (few.distances(0) == many.distances(0)).all()
    assert len(thread_names()) <= 64 + 4 * (os.cpu_count() or 1) + 20


@on_linux
def test_workers_take_no_signals() -> None:
    """A signal is for the threads of the program that made it; ours would only delay what it interrupts."""
    code = """
import re, pathlib
before = {task.name for task in pathlib.Path('/proc/self/task').iterdir()}
import saddleback as sb
sb.voronoi_2d([[x % 317, x % 331] for x in range(100000)], threads=4)
new = [task for task in pathlib.Path('/proc/self/task').iterdir() if task.name not in before]
ours = [task for task in new if int(re.search('SigBlk:\\t(.*)', (task / 'status').read_text())[1], 16) >> 1 & 1]
print(len(ours))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert int(done.stdout) >= 3


def test_an_error_in_one_thread_reaches_the_caller_and_the_team_works_on() -> None:
    mesh = sb.Mesh(*meshes.icosphere(4))
    for _ in range(20):
        job = sb.Job()
        job.cancel()
        with pytest.raises(sb.Cancelled):
            sb.SaddleVertexGraph(mesh, threads=4, job=job)
    assert sb.SaddleVertexGraph(mesh, threads=4).arc_count == sb.SaddleVertexGraph(mesh, threads=1).arc_count


def test_many_callers_at_once_get_what_one_gets() -> None:
    """Each of them borrows a team of its own."""
    import threading

    sites = np.random.default_rng(1).random((20_000, 2))
    wanted = sb.voronoi_2d(sites, threads=1).vertices.tobytes()
    right: list[bool] = []

    def call() -> None:
        right.extend(sb.voronoi_2d(sites, threads=3).vertices.tobytes() == wanted for _ in range(5))

    callers = [threading.Thread(target=call) for _ in range(8)]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join()
    assert len(right) == 40
    assert all(right)


@on_linux
def test_other_programs_on_the_processors_do_not_slow_many_short_loops() -> None:
    """A thread that waits for another, which the system holds up, must not burn the time that the other needs."""
    code = """
import os, sys, time
os.sched_setaffinity(0, [int(processor) for processor in sys.argv[1:]])
import numpy as np
import saddleback as sb
from tests import meshes
vertices, triangles = meshes.torus(240, 120)
mesh = sb.Mesh(vertices + 1e-3 * np.random.default_rng(0).normal(size=vertices.shape), triangles)
times = []
for _ in range(4):
    begin = time.process_time()
    sb.direction_field(mesh)
    times.append(time.process_time() - begin)
print(min(times))
"""

    def least_processor_time(processors: list[str]) -> float:
        done = subprocess.run([sys.executable, "-c", code, *processors], capture_output=True, text=True, check=True)
        return float(done.stdout)

    processors = [str(processor) for processor in sorted(os.sched_getaffinity(0))[:2]]
    others = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(os.cpu_count() or 1)]
    try:
        alone, beside = least_processor_time(processors[:1]), least_processor_time(processors)
    finally:
        for other in others:
            other.kill()
            other.wait()
    assert beside < 1.4 * alone, (beside, alone)

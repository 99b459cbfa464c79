"""Threads leave the cores to others while they wait."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import saddleback as sb
from tests import meshes

TASKS = Path("/proc/self/task")
SCRIPT = """
import os
before = dict(os.environ)
import saddleback
assert os.environ == before
"""


def shown(**settings: str) -> str:
    """What the OpenMP library was loaded with, as it tells itself."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("OMP_", "GOMP_"))}
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        env=environment | {"OMP_DISPLAY_ENV": "verbose"} | settings,
        capture_output=True,
        text=True,
        check=True,
    )
    if "GOMP_SPINCOUNT" not in done.stderr:
        pytest.skip("the compiler's OpenMP library is not GNU's")
    return next(line for line in done.stderr.splitlines() if "GOMP_SPINCOUNT" in line)


def test_idle_threads_spin_shortly() -> None:
    assert "'10000'" in shown()


def test_the_users_wish_is_respected() -> None:
    assert "'77'" in shown(GOMP_SPINCOUNT="77")
    assert "'10000'" not in shown(OMP_WAIT_POLICY="active")


@pytest.mark.skipif(not TASKS.exists(), reason="the system does not show a program's threads")
def test_threads_stay_from_loop_to_loop() -> None:
    """To begin one takes longer than most loops, of which an iteration has dozens, some with few pieces of work."""
    graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.grid(60, 60)), k=40, threads=6)

    def threads_after_relaxing() -> set[str]:
        sb.centroidal_voronoi(graph, count=200, max_iterations=5, tolerance=0, threads=6)
        return {task.name for task in TASKS.iterdir()}

    before = threads_after_relaxing()
    assert threads_after_relaxing() <= before

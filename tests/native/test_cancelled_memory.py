"""What a cancelled call leaves behind goes back to the system while the caller goes on."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

# Where there are no huge pages a gigabyte goes back in tens of milliseconds.
CANCELLED_AT_THE_END = """
import ctypes, threading, time
import numpy as np
import saddleback as sb

PR_SET_THP_DISABLE = 41
assert ctypes.CDLL(None).prctl(PR_SET_THP_DISABLE, 1, 0, 0, 0) == 0
sites = np.random.default_rng(1).random((8 * 10**6, 2))
diagram = sb.voronoi_2d(sites)
start = time.perf_counter()
del diagram
print(time.perf_counter() - start)

for _ in range(5):
    job, asked = sb.Job(), []

    def stop():
        while job.fraction < 0.9:
            time.sleep(0.0005)
        asked.append(time.perf_counter())
        job.cancel()

    watcher = threading.Thread(target=stop)
    watcher.start()
    try:
        sb.voronoi_2d(sites, job=job)
    except sb.Cancelled:
        print(time.perf_counter() - asked[0])
    watcher.join()
"""


@pytest.mark.skipif(
    sys.platform != "linux" or "ASAN_OPTIONS" in os.environ,
    reason="no small pages to be asked for, or a heap of its own",
)
def test_who_cancels_does_not_wait_for_memory_to_be_freed() -> None:
    done = subprocess.run([sys.executable, "-c", CANCELLED_AT_THE_END], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    freed, *cancelled = map(float, done.stdout.split())
    assert min(cancelled) < freed / 4

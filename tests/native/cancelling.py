# SPDX-License-Identifier: MIT
"""A long call, watched and cancelled from another thread."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

import saddleback as sb


def check_progress_and_cancel(call: Callable[[sb.Job], object], fraction: float) -> None:
    """Progress rises until `fraction`; a call cancelled there ends with `Cancelled`, at once.

    A call that was over before this thread had its turn again on a busy machine is tried once more, five times in all.
    """
    for _ in range(5):
        job, seen, ended = sb.Job(), [], []

        def run(job: sb.Job = job, ended: list[float] = ended) -> None:
            try:
                call(job)
            except sb.Cancelled:
                ended.append(time.perf_counter())

        worker = threading.Thread(target=run)
        worker.start()
        while job.fraction < fraction and worker.is_alive():
            seen.append(job.fraction)
            time.sleep(0.002)
        asked = time.perf_counter()
        job.cancel()
        worker.join()
        assert seen == sorted(seen)
        if ended:
            assert ended[0] - asked < 0.1 * 5  # five times the promise: other work may hold the core
            return
    raise AssertionError("the call was never cancelled")


def seconds_to_stop(call: Callable[[sb.Job], object], is_time: Callable[[sb.Job], bool]) -> float:
    """From the moment when a call is cancelled, as soon as `is_time` says so, to its end; 0 when that comes before."""
    job, asked, is_over = sb.Job(), [], threading.Event()

    def stop() -> None:
        while not is_time(job):
            if is_over.wait(0.0005):
                return
        asked.append(time.perf_counter())
        job.cancel()

    watcher = threading.Thread(target=stop)
    watcher.start()
    try:
        call(job)
    except sb.Cancelled:
        return time.perf_counter() - asked[0]
    finally:
        is_over.set()
        watcher.join()
    return 0.0


def check_it_stops_when_silent(call: Callable[[sb.Job], object], fraction: float) -> None:
    """Cancelled beyond `fraction`, once it has told nothing new for a tenth of a second, a call ends within another.

    Tried again where other work may have held the core. A machine that is never silent for so long passes.
    """
    late = 0.0
    for _ in range(3):
        told, since = 0.0, time.perf_counter()

        def is_silent(job: sb.Job) -> bool:
            nonlocal told, since
            if job.fraction != told:
                told, since = job.fraction, time.perf_counter()
            return told >= fraction and time.perf_counter() - since > 0.1

        late = seconds_to_stop(call, is_silent)
        if late < 0.1:
            return
    raise AssertionError(f"ended {late:.2f} s after it was cancelled")

"""A long call, watched and cancelled from another thread."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

import saddleback as sb


def check_progress_and_cancel(call: Callable[[sb.Job], object], fraction: float) -> None:
    """Progress rises until `fraction`; a call cancelled there ends with `Cancelled`, at once."""
    job, seen, ended = sb.Job(), [], []

    def run() -> None:
        try:
            call(job)
        except sb.Cancelled:
            ended.append(time.perf_counter())

    worker = threading.Thread(target=run)
    worker.start()
    while job.fraction < fraction and worker.is_alive():
        seen.append(job.fraction)
        time.sleep(0.005)
    asked = time.perf_counter()
    job.cancel()
    worker.join()
    assert seen == sorted(seen)
    assert ended
    assert ended[0] - asked < 0.1 * 5  # five times the promise: other work may hold the core

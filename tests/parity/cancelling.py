# SPDX-License-Identifier: MIT
"""Work on a device that is stopped in its midst."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

import pytest

import saddleback as sb


def expect_to_stop_within_a_moment(
    work: Callable[[sb.Job], object], after: float, beyond: float = 0, within: float = 0.15
) -> None:
    """Does the work again and again until it is asked to stop, `after` some seconds; then it ends `within` others.

    `beyond`: the share that has to be done before the seconds begin.
    """
    job = sb.Job()
    asked = [0.0]

    def stop() -> None:
        while job.fraction < beyond:
            time.sleep(0.0005)
        time.sleep(after)
        asked[0] = time.perf_counter()
        job.cancel()

    thread = threading.Thread(target=stop)
    thread.start()
    with pytest.raises(sb.Cancelled):
        while True:
            work(job)
    assert time.perf_counter() - asked[0] < within
    thread.join()

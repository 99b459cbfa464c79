# SPDX-License-Identifier: MIT
"""A progress bar for scripts: long work can be watched on a terminal and stopped with Ctrl-C."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TextIO

from saddleback._saddleback import Job

_WIDTH = 30
_SECONDS_BETWEEN_LOOKS = 0.1


@contextmanager
def progress_bar(stream: TextIO | None = None) -> Iterator[Job]:
    """Give a job whose progress is drawn until the block ends; Ctrl-C cancels the job and raises KeyboardInterrupt.

    Parameters
    ----------
    stream : text stream, optional
        Where to draw; by default stderr. Nothing is drawn where it is no terminal.

    Yields
    ------
    Job
        To be passed as ``job=``.

    Examples
    --------
    >>> with saddleback.progress_bar() as job:  # doctest: +SKIP
    ...     mesh = saddleback.read_mesh("bunny.ply", job=job)
    """
    job = Job()
    out = sys.stderr if stream is None else stream
    done = threading.Event()
    painter = threading.Thread(target=_paint, args=(job, out, done), daemon=True)
    previous = None
    if threading.current_thread() is threading.main_thread() and signal.getsignal(signal.SIGINT) is not None:
        # With Python's own handler Ctrl-C cancels native work at once.
        previous = signal.signal(signal.SIGINT, signal.default_int_handler)
    painter.start()
    try:
        yield job
    except KeyboardInterrupt:
        job.cancel()  # threads that still work for it
        raise
    finally:
        done.set()
        painter.join()
        if previous is not None:
            signal.signal(signal.SIGINT, previous)


def _paint(job: Job, out: TextIO, done: threading.Event) -> None:
    if not out.isatty():
        return
    while not done.wait(_SECONDS_BETWEEN_LOOKS):
        filled = round(_WIDTH * job.fraction)
        bar = "#" * filled + "-" * (_WIDTH - filled)
        out.write(f"\r[{bar}] {100 * job.fraction:3.0f} %  {job.text}\x1b[K")
        out.flush()
    out.write("\r\x1b[K")
    out.flush()

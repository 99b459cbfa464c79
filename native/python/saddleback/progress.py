"""A progress bar for scripts: long work can be watched on a terminal and stopped with Ctrl-C."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TextIO

from saddleback._saddleback import Cancelled, Job

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
    interrupted = False

    def on_interrupt(_signal: int, _frame: FrameType | None) -> None:
        nonlocal interrupted
        interrupted = True
        job.cancel()
        raise KeyboardInterrupt

    previous, poller = None, None
    if threading.current_thread() is threading.main_thread() and signal.getsignal(signal.SIGINT) is not None:
        # Python runs signal handlers only between bytecodes, and native work is one long bytecode. A wake-up pipe lets
        # the other thread see Ctrl-C at once.
        previous = signal.signal(signal.SIGINT, on_interrupt)
        poller = _InterruptWatch(job)
    painter.start()
    try:
        yield job
    except Cancelled:
        if interrupted or (poller is not None and poller.seen):
            raise KeyboardInterrupt from None
        raise
    finally:
        done.set()
        painter.join()
        if poller is not None:
            poller.close()
            signal.signal(signal.SIGINT, previous)


class _InterruptWatch:
    """Cancels the job as soon as a SIGINT arrives, from a thread of its own."""

    def __init__(self, job: Job) -> None:
        import socket

        self.seen = False
        self._job = job
        self._reader, self._writer = socket.socketpair()
        self._writer.setblocking(False)
        self._previous = signal.set_wakeup_fd(self._writer.fileno(), warn_on_full_buffer=False)
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()

    def _watch(self) -> None:
        while received := self._reader.recv(64):
            if signal.SIGINT in received:
                self.seen = True
                self._job.cancel()

    def close(self) -> None:
        signal.set_wakeup_fd(self._previous)
        self._writer.close()  # ends the thread's recv
        self._thread.join()
        self._reader.close()


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

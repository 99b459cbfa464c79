# SPDX-License-Identifier: MIT
"""A progress bar for scripts: long work can be watched on a terminal and stopped with Ctrl-C."""

from __future__ import annotations

import importlib
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, TextIO

from saddleback._saddleback import Job

_WIDTH = 30
_SECONDS_BETWEEN_LOOKS = 0.1


@contextmanager
def progress_bar(stream: TextIO | None = None) -> Iterator[Job]:
    """Give a job whose progress is drawn until the block ends; Ctrl-C cancels the job and raises KeyboardInterrupt.

    Parameters
    ----------
    stream : text stream, optional
        Where to draw; by default stderr. Nothing is drawn where it is no terminal; but in a notebook tqdm's bar is
        shown when tqdm is installed, else a line of text.

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
    is_notebook = stream is None and "ipykernel" in sys.modules and not out.isatty()
    bar = _notebook_bar() if is_notebook else None
    done = threading.Event()
    painter = threading.Thread(target=_paint, args=(job, out, done, bar, is_notebook), daemon=True)
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


def _notebook_bar() -> Any:
    """Tqdm's bar, made in the thread whose cell it belongs to; None without tqdm."""
    try:
        tqdm: Any = importlib.import_module("tqdm.auto").tqdm
    except ImportError:
        return None
    return tqdm(total=100, bar_format="{l_bar}{bar}| {elapsed}", leave=False)


def _paint(job: Job, out: TextIO, done: threading.Event, bar: Any, is_notebook: bool) -> None:
    if bar is None and not is_notebook and not out.isatty():
        return
    erase = " " * 79 + "\r" if is_notebook else "\x1b[K"  # a notebook knows no codes of terminals
    while not done.wait(_SECONDS_BETWEEN_LOOKS):
        if bar is not None:
            bar.set_description_str(job.text, refresh=False)
            bar.n = round(100 * job.fraction)
            bar.refresh()
            continue
        filled = round(_WIDTH * job.fraction)
        line = "#" * filled + "-" * (_WIDTH - filled)
        out.write(f"\r[{line}] {100 * job.fraction:3.0f} %  {job.text}{erase}")
        out.flush()
    if bar is not None:
        bar.close()
        return
    out.write(f"\r{erase}")
    out.flush()

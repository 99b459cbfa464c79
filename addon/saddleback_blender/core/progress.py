# SPDX-License-Identifier: GPL-3.0-or-later
"""The watched part of a run: several native calls told as one rising fraction, stopped by one cancel."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

BLOCK = 1 << 15  # rows between two looks at whether the run is to stop
BEATS, MOST_DOTS = 4, 3  # dots move so many times a second; as many as a native Job shows


def blocks(count: int) -> Iterator[slice]:
    """Slices that make up `count` rows, few enough in each that what is made of them on the way takes little memory."""
    for begin in range(0, max(count, 1), BLOCK):
        yield slice(begin, begin + BLOCK)


class Progress:
    """Shows a run to another thread. The thread that computes opens stages; any other reads, or cancels.

    Each stage has a native Job of its own, since a used one still shows the call before until the next call begins.
    """

    def __init__(self, make_job: Callable[[], Any], cancelled_error: type[Exception]) -> None:
        self._make_job = make_job
        self._cancelled_error = cancelled_error
        self._job = make_job()
        self._begin, self._end, self._reached = 0.0, 0.0, 0.0
        self._cancelled = False
        self._can_settle = False
        self._text = ""
        self._beat, self._dots, self._has_checked = 0, 0, False
        self.notes: list[str] = []  # what a person should know when the run is over
        self.chosen: dict[str, float] = {}  # by setting: the value in place of a 0, which leaves it to the run

    @property
    def fraction(self) -> float:
        """Share of the run done, 0 to 1; never falls."""
        begin, end, job = self._begin, self._end, self._job
        self._reached = max(self._reached, begin + (end - begin) * job.fraction)
        return self._reached

    @property
    def text(self) -> str:
        """Returns the work being done, for a person to read; dots behind it move during work that cannot be counted."""
        beat = int(BEATS * time.monotonic())
        if beat != self._beat and self._has_checked:
            self._dots, self._has_checked = self._dots + 1, False
        self._beat = beat
        told: str = self._job.text
        dots = len(told) - len(told.rstrip(".")) + self._dots
        return self._text + "." * (dots % (MOST_DOTS + 1)) if self._text else ""

    @property
    def cancelled(self) -> bool:
        """True once `cancel` was called."""
        return self._cancelled

    def cancel(self) -> None:
        """Asks the run to stop: it ends within 0.1 s."""
        # The flag first: a stage that begins between the two lines sees it, one that had begun has its job stopped.
        self._cancelled = True
        self._job.cancel()

    def settle(self) -> bool:
        """Asks the stage for what it has so far; says whether it is one that can give that."""
        if self._can_settle:
            self._job.cancel()
        return self._can_settle

    def note(self, text: str) -> None:
        """Adds a sentence to be told when the run is over."""
        self.notes.append(text)

    def choose(self, name: str, asked: float, otherwise: float) -> float:
        """Returns what is asked for or, where that is 0, the other value, to be told when the run is over."""
        if asked:
            return asked
        self.chosen[name] = otherwise
        return otherwise

    def check(self) -> None:
        """Raises the library's Cancelled when asked to stop; between native calls, where it also moves the dots."""
        self._has_checked = True
        if self._cancelled:
            raise self._cancelled_error("cancelled")

    def blocks(self, count: int) -> Iterator[slice]:
        """Slices that make up `count` rows, few enough in each that a run that is to stop does so between two."""
        for rows in blocks(count):
            self.check()
            yield rows

    @contextmanager
    def stage(self, end: float, text: str, can_settle: bool = False) -> Iterator[Any]:
        """Yields the job for one native call that takes the run up to `end`, in 0 to 1.

        `can_settle`: cancelling that job makes the call return early what it has.
        """
        job = self._make_job()
        self._begin = self._end = self._reached
        self._job = job
        self.check()
        self._text = text
        self._dots, self._has_checked = 0, False
        self._end = end
        self._can_settle = can_settle
        try:
            yield job
        finally:
            self._can_settle = False
        self._begin = self._end
        self.check()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Cells while they are being relaxed: the lines between them after the latest step, found in a thread of their own."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import native
from .progress import Progress
from .results import Reals
from .solids.edge_network import EdgeNetwork, edge_network

LOOK = 0.02  # seconds between looks at the relaxation


@dataclass(frozen=True)
class LiveStep:
    """The lines between the cells after some iterations."""

    lines: EdgeNetwork
    iterations: int


class LiveCells:
    """Follows one relaxation. The run opens `follow`; any other thread takes what is new with `newest`.

    Nothing is made before somebody looks. One that `stays` goes on with each density that it is given, until `keep`.
    """

    def __init__(self, stays: bool = False) -> None:
        self.stays = stays
        self._news = threading.Event()
        self._painted: deque[Any] = deque(maxlen=1)  # which two threads put and take in one go
        self._used: Reals | None = None
        self._round = 0  # of relaxations, each by a density
        self._newest: LiveStep | None = None
        self._ended = threading.Event()
        self._is_looked_at = False

    def change_density(self, painted: Any) -> None:
        """Gives what was painted since. The caller then lets the relaxation settle."""
        self._painted.append(painted)
        self._news.set()

    def keep(self) -> None:
        """Asks for the cells as they are."""
        self.stays = False
        self._news.set()

    def waits_for_density(self, progress: Progress) -> bool:
        """Waits, where it stays; tells whether there is a new density."""
        while self.stays and not self._painted:
            progress.check()
            self._news.wait(LOOK)
            self._news.clear()
        return bool(self._painted)

    def take_density(self, density_of_paint: Callable[[Any], Reals | None]) -> Reals | None:
        """Returns the new density (n,)."""
        self._round += 1
        self._used = density_of_paint(self._painted.pop())
        return self._used

    def density_used(self, first: Reals | None) -> Reals | None:
        """The last one (n,), or the first where there was no other."""
        return first if self._used is None else self._used

    def newest(self) -> LiveStep | None:
        """The latest step whose lines are known, None where it was taken before."""
        self._is_looked_at = True
        step, self._newest = self._newest, None
        return step

    @contextmanager
    def follow(self, graph: Any) -> Iterator[Any]:
        """Yields the watch to give to the relaxation; its end ends the following, too."""
        sb = native.load()
        watch, job = sb.RelaxationWatch(), sb.Job()
        follower = threading.Thread(target=self._follow, args=(graph, watch, job), name="saddleback live", daemon=True)
        follower.start()
        try:
            yield watch
        finally:
            self._ended.set()
            job.cancel()
            follower.join()

    def _follow(self, graph: Any, watch: Any, job: Any) -> None:
        sb, shown = native.load(), (-1, -1)
        while not self._ended.is_set():
            step, number = watch.latest(), self._round
            if not self._is_looked_at or step is None or (number, step.iterations) == shown:
                self._ended.wait(LOOK)
                continue
            try:
                cells = sb.geodesic_voronoi(graph, step.sites, threads=1, job=job)
            except sb.Cancelled:
                return
            closed = np.asarray(cells.edge_closed, bool)
            lines = edge_network(cells.edge_points, cells.edge_offsets, cells.edge_cells, closed)
            shown = number, step.iterations
            self._newest = LiveStep(lines, step.iterations)

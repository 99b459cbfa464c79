# SPDX-License-Identifier: GPL-3.0-or-later
"""Cells while they are being relaxed: the lines between them after the latest step, found in a thread of their own."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import native
from .solids.edge_network import EdgeNetwork, edge_network

LOOK = 0.02  # seconds between looks at the relaxation


@dataclass(frozen=True)
class LiveStep:
    """The lines between the cells after some iterations, in the world."""

    lines: EdgeNetwork
    iterations: int


class LiveCells:
    """Follows one relaxation. The run opens `follow`; any other thread takes what is new with `newest`.

    Nothing is made before somebody looks.
    """

    def __init__(self) -> None:
        self._newest: LiveStep | None = None
        self._ended = threading.Event()
        self._is_looked_at = False

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
        sb, shown = native.load(), -1
        while not self._ended.is_set():
            step = watch.latest()
            if not self._is_looked_at or step is None or step.iterations == shown:
                self._ended.wait(LOOK)
                continue
            try:
                cells = sb.geodesic_voronoi(graph, step.sites, threads=1, job=job)
            except sb.Cancelled:
                return
            closed = np.asarray(cells.edge_closed, bool)
            lines = edge_network(cells.edge_points, cells.edge_offsets, cells.edge_cells, closed)
            shown = step.iterations
            self._newest = LiveStep(lines, shown)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Cells that go on from where they were, run after run, while what says where they are small changes."""

from __future__ import annotations

import os
import sys
import threading
import uuid
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import native
from .live_cells import LiveStep
from .progress import Progress
from .results import Reals
from .settings import TessellateSettings
from .solids.edge_network import edge_network

# Of a cell's size: sites that would move by less rest, and their cells are not found anew. Less than one sees.
UNSEEN = 1e-3
# The same in the first step after a change: cells about it are to be seen to move at once, those farther away follow.
NEAR = 2e-2
BEHIND = 10  # how nice a thread is to the window once something is seen


@dataclass(frozen=True)
class Relaxed:
    """Cells after some iterations."""

    cells: Any
    energy: Reals
    iterations: int
    stop_reason: str
    normalized_energy: float


class FlowingCells:
    """Keeps the cells of one layer. The thread of a run lets them flow; any other takes what is new with `newest`.

    `frame` names all that decides on the cells but the density. While it stays the same, cells go on from where they
    are, so that only those change about which the density does.
    """

    def __init__(self) -> None:
        self.word = uuid.uuid4().hex  # tells what was made of its cells from what others made
        self._newest: LiveStep | None = None
        self._frame = ("", "")
        self._sites: Any = None
        self._kept: tuple[tuple[str, str], Reals] | None = None
        self._cells: Any = None  # from one run to the next: a dab changes those about it

    def begin_at(self, frame: tuple[str, str], places: Reals) -> None:
        """Notes where cells are that another run made, of a frame: places (n, 3)."""
        self._kept = frame, places

    def take_kept(self, frame: tuple[str, str], mesh: Any) -> None:
        """Goes on from those cells, where they are of this frame and there are none yet."""
        if self._frame != frame and self._kept is not None and self._kept[0] == frame:
            self._frame, self._sites = frame, native.load().project(mesh, self._kept[1])

    def newest(self) -> LiveStep | None:
        """The latest lines between cells, None where they were taken before."""
        step, self._newest = self._newest, None
        return step

    def sites(self, frame: tuple[str, str]) -> Any:
        """Where cells of this frame are by now; None where there are none."""
        return self._sites if self._frame == frame else None

    def keep(self, frame: tuple[str, str], cells: Any) -> None:
        """Notes cells to go on from."""
        self._frame, self._sites = frame, cells.sites

    def show(self, cells: Any, iterations: int) -> None:
        """Lets another thread see cells."""
        closed = np.asarray(cells.edge_closed, bool)
        self._newest = LiveStep(
            edge_network(cells.edge_points, cells.edge_offsets, cells.edge_cells, closed), iterations
        )

    def sketch(
        self, graph: Any, density: Reals | None, settings: TessellateSettings, threads: int, progress: Progress
    ) -> None:
        """Shows cells of this number that are not even yet."""
        with progress.stage(0.6, "finding the cells") as job:
            cvt = native.load().centroidal_voronoi(
                graph, count=settings.count, density=density, max_iterations=1, seed=settings.seed, start="sample",
                threads=threads, job=job,
            )  # fmt: skip
        self.show(cvt.cells, 1)

    def flow(
        self,
        frame: tuple[str, str],
        graph: Any,
        density: Reals | None,
        settings: TessellateSettings,
        threads: int,
        progress: Progress,
    ) -> Relaxed:
        """Evens out the cells of this frame by a density, in calls that are longer and longer: each is shown."""
        sb = native.load()
        self._cells = self._cells or sb.CellCache()
        done, steps, least_move = 0, 1, NEAR if settings.iterations > 1 else UNSEEN
        while True:
            end = 0.5 + 0.4 * min(1.0, (done + steps) / settings.iterations)
            with progress.stage(end, "evening out the cells") as job:
                cvt = sb.centroidal_voronoi(
                    graph, sites=self._sites, density=density, method=settings.method.lower(), max_iterations=steps,
                    least_move=least_move, cache=self._cells, threads=threads, job=job,
                )  # fmt: skip
            self.keep(frame, cvt.cells)
            done += int(cvt.iterations)
            self.show(cvt.cells, done)
            is_at_rest = cvt.iterations < steps and least_move == UNSEEN
            if is_at_rest or done >= settings.iterations:
                energy = np.asarray(cvt.energy, np.float64)
                return Relaxed(cvt.cells, energy, done, str(cvt.stop_reason), float(cvt.normalized_energy))
            steps, least_move = min(2 * steps, settings.iterations - done), UNSEEN
            threads = _step_back(threads)


def _step_back(threads: int) -> int:
    """Lets the window come first from now on: it shall have a core, where it draws by the processor all that it needs.

    Returns of how many threads a run is to make use.
    """
    if sys.platform == "linux" and threading.current_thread() is not threading.main_thread():
        with suppress(OSError):
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), BEHIND)
    return max(1, min(threads or sys.maxsize, (os.cpu_count() or 1) - 1))

# SPDX-License-Identifier: GPL-3.0-or-later
"""Several native calls are told as one rising fraction and stopped by one cancel."""

import inspect
import sys
from itertools import pairwise

import pytest

from saddleback_blender.core.live_cells import LiveCells
from saddleback_blender.core.progress import Progress


class StoppedError(Exception):
    pass


class Job:
    def __init__(self):
        self.fraction = 0.0
        self.text = "Measuring"
        self.stopped = False

    def cancel(self):
        self.stopped = True


def test_stages_map_onto_parts_and_never_fall():
    progress = Progress(Job, StoppedError)
    assert progress.fraction == 0
    with progress.stage(0.4, "first") as job:
        assert progress.text == "first" and progress.fraction == 0
        job.fraction = 0.5
        assert progress.fraction == pytest.approx(0.2)
        job.text = "Measuring.."
        assert progress.text == "first.."
        job.fraction = 1.0
    assert progress.fraction == pytest.approx(0.4)
    with progress.stage(0.9, "second") as job:
        assert progress.fraction == pytest.approx(0.4)
        job.fraction = 0.5
        assert progress.fraction == pytest.approx(0.65)
    assert progress.fraction == pytest.approx(0.9)


def test_steps_between_native_calls_move_the_dots(monkeypatch):
    progress, seconds = Progress(Job, StoppedError), [100.0]
    monkeypatch.setattr("time.monotonic", lambda: seconds[0])
    with progress.stage(0.5, "making ribs"):
        told = []
        for _ in range(5):
            progress.check()
            told += [progress.text, progress.text]  # whoever else reads it
            seconds[0] += 0.25
        assert told[::2] == told[1::2] and all(a != b for a, b in pairwise(told[::2]))
        told = []
        for _ in range(3):  # nobody works
            told.append(progress.text)
            seconds[0] += 0.25
        assert len(set(told)) == 1


def test_a_stage_that_is_left_out_costs_nothing():
    progress = Progress(Job, StoppedError)
    with progress.stage(0.9, "only") as job:
        job.fraction = 1.0
    assert progress.fraction == pytest.approx(0.9)


def test_cancel_reaches_the_call_that_runs():
    progress = Progress(Job, StoppedError)
    with pytest.raises(StoppedError), progress.stage(0.5, "running") as job:
        progress.cancel()
        assert job.stopped
    assert progress.cancelled


def test_after_a_cancel_no_stage_begins():
    progress = Progress(Job, StoppedError)
    progress.cancel()
    with pytest.raises(StoppedError), progress.stage(0.5, "never"):
        raise AssertionError("the stage began")
    with pytest.raises(StoppedError):
        progress.check()


class Waiting:
    def check(self):
        raise StoppedError


@pytest.mark.parametrize("when", range(len(inspect.getsource(LiveCells.take_density).splitlines())))
def test_paint_that_comes_while_the_last_one_is_taken_is_not_lost(when):
    live, left = LiveCells(stays=True), [when]

    def paint(frame, event, _):
        if event == "line":
            left[0] -= 1
            if left[0] == -1:
                live.change_density("second")
        return paint

    live.change_density("first")
    assert live.waits_for_density(Waiting())
    before = sys.gettrace()
    sys.settrace(lambda frame, *_: paint if frame.f_code is LiveCells.take_density.__code__ else None)
    try:
        taken = live.take_density(str)
    finally:
        sys.settrace(before)
    if left[0] < 0 and taken == "first":
        assert live.waits_for_density(Waiting()) and live.take_density(str) == "second"
    with pytest.raises(StoppedError):  # and does not end before it is told to
        live.waits_for_density(Waiting())
    live.keep()
    assert not live.waits_for_density(Waiting())

# SPDX-License-Identifier: GPL-3.0-or-later
"""Paint that comes while a live relaxation goes on with the last one."""

import inspect
import sys

import pytest

from saddleback_blender.core.live_cells import LiveCells

LINES = len(inspect.getsource(LiveCells.take_density).splitlines())


class WaitError(Exception):
    pass


class Waiting:
    def check(self):
        raise WaitError


@pytest.mark.parametrize("when", range(LINES))
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
    with pytest.raises(WaitError):  # and does not end before it is told to
        live.waits_for_density(Waiting())
    live.keep()
    assert not live.waits_for_density(Waiting())

# SPDX-License-Identifier: MIT
"""Every public entry point in forked children, with far too many threads, with little memory, and under Ctrl-C.

On a small mesh; `python -m tests.entry_points` asks them on a larger one.
"""

from __future__ import annotations

import os
import random
import signal
import time

import pytest

from tests import entry_points as asked
from tests.truth.table import entry_points

pytestmark = [
    pytest.mark.skipif(os.name != "posix", reason="fork, signals and limits as POSIX has them"),
    pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning"),  # that it works is what is asked
]
SIZE = 4
ANSWER = 0.6  # seconds to KeyboardInterrupt, on a machine that does other things
NAMES = [name for name in entry_points() if not asked.is_made_by_calls(name)]


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    return asked.calls(asked.Inputs(SIZE, tmp_path_factory.mktemp("entry_points")))


def test_none_is_missing_and_none_is_of_the_past(table):
    assert asked.missing(table) == []
    assert set(table) == set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_a_result_or_an_exception(table, name):
    assert asked.findings(name, table[name], random.Random(name), ANSWER) == []


def test_what_goes_wrong_is_seen():
    """In none of the calls it does."""

    def is_deaf() -> None:
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        time.sleep(1.5)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})

    assert asked.in_a_child(lambda: os.kill(os.getpid(), signal.SIGKILL)) == "dies of SIGKILL"
    assert asked.in_a_child(lambda: asked.answers(lambda: [][0])) == "IndexError: list index out of range"
    assert asked.in_a_child(lambda: asked.answers(lambda: bytearray(1 << 60))) == ""
    assert asked.in_a_child(lambda: asked.with_little_memory(lambda: bytearray(1 << 30), 200)) == ""
    assert asked.in_a_child(lambda: asked.interrupted(is_deaf, 0.01)).endswith(" s")
    assert asked.in_a_child(lambda: asked.interrupted(lambda: time.sleep(3), 0.05)) == ""

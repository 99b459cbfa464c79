# SPDX-License-Identifier: MIT
"""Every public entry point in forked children, with far too many threads, with little memory, and under Ctrl-C.

On a small mesh; `python -m tests.entry_points` asks them on a larger one.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import time
from concurrent.futures import ProcessPoolExecutor

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
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("entry_points")


@pytest.fixture(scope="module")
def elsewhere(folder):
    """A process that holds little else: to fork this one, with all its tests, takes three times as long."""
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, spawn, asked.prepare, (SIZE, folder)) as process:
        yield process


def test_none_is_missing_and_none_is_of_the_past(folder):
    table = asked.calls(asked.Inputs(SIZE, folder))
    assert asked.missing(table) == []
    assert set(table) == set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_a_result_or_an_exception(elsewhere, name):
    assert elsewhere.submit(asked.findings_prepared, name, ANSWER).result() == []


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

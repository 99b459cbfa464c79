# SPDX-License-Identifier: GPL-3.0-or-later
"""The cache keeps by content, drops the least recently used, and counts what is made."""

import threading

import pytest

from saddleback_blender.core.cache import Cache


def size(value):
    return value


def test_a_value_is_made_once():
    cache = Cache(100)
    for _ in range(3):
        assert cache.get(("graph", "a"), lambda: 10, size) == 10
    assert cache.builds == {"graph": 1} and cache.nbytes == 10 and ("graph", "a") in cache


def test_the_least_recently_used_goes_first():
    cache = Cache(25)
    cache.get(("graph", "a"), lambda: 10, size)
    cache.get(("graph", "b"), lambda: 10, size)
    cache.get(("graph", "a"), lambda: 10, size)
    cache.get(("graph", "c"), lambda: 10, size)
    assert ("graph", "a") in cache and ("graph", "c") in cache and ("graph", "b") not in cache
    assert cache.nbytes == 20


def test_what_is_larger_than_the_cache_is_returned_but_not_kept():
    cache = Cache(5)
    cache.get(("mesh", "a"), lambda: 4, size)
    assert cache.get(("graph", "a"), lambda: 10, size) == 10
    assert cache.nbytes == 4 and ("graph", "a") not in cache and ("mesh", "a") in cache


def test_resizing_drops_and_clearing_empties():
    cache = Cache(100)
    for name in "abc":
        cache.get(("graph", name), lambda: 10, size)
    cache.resize(15)
    assert ("graph", "c") in cache and cache.nbytes == 10
    cache.clear()
    assert cache.nbytes == 0 and cache.builds == {"graph": 3}


def test_a_failing_build_leaves_nothing():
    cache = Cache(100)

    def fail():
        raise ValueError("no")

    with pytest.raises(ValueError, match="no"):
        cache.get(("graph", "a"), fail, size)
    assert ("graph", "a") not in cache and not cache.builds


def test_many_threads_see_one_consistent_cache():
    cache = Cache(50)

    def work(start):
        for step in range(300):
            number = (start + step) % 7
            assert cache.get(("graph", str(number)), lambda number=number: number + 5, size) == number + 5

    threads = [threading.Thread(target=work, args=(start,)) for start in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert cache.nbytes <= 50

# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps what was computed, by content, so that the next run computes only what changed."""

from __future__ import annotations

import threading
from collections import Counter, OrderedDict
from collections.abc import Callable
from typing import Any, TypeVar

Value = TypeVar("Value")


class Cache:
    """Least recently used values go first when the sum of their bytes passes the limit. Safe from several threads.

    `builds` counts the values made, by kind (the first word of the key): what a test asks to see that nothing is
    computed twice.
    """

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._entries: OrderedDict[tuple[str, ...], tuple[Any, Callable[[Any], int]]] = OrderedDict()
        self._lock = threading.Lock()
        self.builds: Counter[str] = Counter()

    def get(self, key: tuple[str, ...], make: Callable[[], Value], nbytes: Callable[[Value], int]) -> Value:
        """The value kept for `key`, or the one that `make` returns, which is then kept if its `nbytes` fit."""
        with self._lock:
            if key in self._entries:
                self._entries.move_to_end(key)
                value: Value = self._entries[key][0]
                return value
        value = make()
        with self._lock:
            self.builds[key[0]] += 1
            if nbytes(value) <= self._limit:  # else all the others would go for nothing
                self._entries[key] = (value, nbytes)
                self._entries.move_to_end(key)
                self._trim()
        return value

    def __contains__(self, key: tuple[str, ...]) -> bool:
        with self._lock:
            return key in self._entries

    @property
    def nbytes(self) -> int:
        """Sum of what is kept."""
        with self._lock:
            return self._total()

    def resize(self, limit: int) -> None:
        """Sets the limit in bytes and drops what no longer fits."""
        with self._lock:
            self._limit = limit
            self._trim()

    def clear(self) -> None:
        """Forgets everything."""
        with self._lock:
            self._entries.clear()

    def _trim(self) -> None:
        while self._entries and self._total() > self._limit:
            self._entries.popitem(last=False)

    def _total(self) -> int:
        """Values may have grown since they were made: graphs do when sites are relaxed on them."""
        return sum(nbytes(value) for value, nbytes in self._entries.values())


shared = Cache(2048 * 2**20)

"""Loads the compiled module with threads that wait politely.

GNU's OpenMP lets idle threads spin for a millisecond or more. Where other programs want the cores, too, threads spin
while those that they wait for have none: the same work then takes two to three times as long as its share of the
machine. Spinning for some microseconds costs nothing on an idle machine.
"""

from __future__ import annotations

import os

_SPINS = "10000"


def _load() -> None:
    """The number is read once, when the library is loaded; other programs that this one starts shall not see it."""
    asked = any(name in os.environ for name in ("GOMP_SPINCOUNT", "OMP_WAIT_POLICY"))
    if not asked:
        os.environ["GOMP_SPINCOUNT"] = _SPINS
    try:
        import saddleback._saddleback  # noqa: F401
    finally:
        if not asked:
            del os.environ["GOMP_SPINCOUNT"]


_load()

# SPDX-License-Identifier: MIT
"""Makes a failing input small, so that a person can read it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.int64]


def fewest_rows(count: int, fails: Callable[[Rows], bool], tries: int = 400) -> Rows:
    """Fewer and fewer of `count` rows, as long as the rest still fails: delta debugging.

    After [zeller2002].
    """
    rows, block = np.arange(count), max(count // 2, 1)
    while tries > 0:
        start, shrunk = 0, False
        while start < len(rows) and tries > 0:
            rest = np.delete(rows, slice(start, start + block))
            tries -= 1
            if len(rest) and fails(rest):
                rows, shrunk = rest, True
            else:
                start += block
        if block == 1 and not shrunk:
            break
        block = block if shrunk and block < len(rows) else max(block // 2, 1)
    return rows

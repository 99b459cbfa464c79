# SPDX-License-Identifier: MIT
"""What is no argument of ours is refused in a sentence, whichever call it is given to."""

from __future__ import annotations

import numpy as np
import pytest

import saddleback as sb

WINDOWS = {"show"}  # opens one for what it takes
CALLS = sorted(name for name in set(sb.__all__) - WINDOWS if callable(getattr(sb, name)) and not name.endswith("Error"))
MOST = 6  # arguments by position: no call needs more


class Stranger:
    """Converts to nothing."""


def refusal(name: str, *arguments: object) -> str:
    try:
        getattr(sb, name)(*arguments)
    except (TypeError, ValueError, AttributeError, OSError) as error:
        return str(error)
    return ""


@pytest.mark.parametrize("name", CALLS)
def test_strangers_are_refused(name):
    mesh = sb.Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]], np.int32))
    for first in (Stranger(), mesh, 1, "a", None):
        for count in range(MOST + 1):
            told = refusal(name, first, *[Stranger()] * count)
            assert "Unable to cast" not in told
            assert "C++" not in told

# SPDX-License-Identifier: GPL-3.0-or-later
"""World places as seen from an object."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..results import Reals

WORLD: Reals = np.eye(4)  # the frame of the world
NOISE_BITS = 46  # what is below so many of the largest number's is rounding


def seen_from(frame: Reals, points: NDArray[np.floating]) -> Reals:
    """World positions (n, 3) as seen from a frame (4, 4), without the noise of rounding.

    So what lies at 0 is at 0, and what is mirrored there is so in single precision to the bit.
    """
    inverse = np.linalg.inv(frame)
    seen: Reals = points @ inverse[:3, :3].T + inverse[:3, 3]
    size = np.abs(inverse[:3, :3]).max() * max(np.abs(points).max(initial=0.0), np.abs(frame[:3, 3]).max())
    if not 0.0 < size < np.inf:
        return seen
    noise = 2.0 ** (np.floor(np.log2(size)) - NOISE_BITS)
    return np.asarray(np.rint(seen / noise) * noise)

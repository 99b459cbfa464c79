# SPDX-License-Identifier: GPL-3.0-or-later
"""A color for each shape on a surface: of its class, a little lighter or darker by chance."""

from __future__ import annotations

import numpy as np

from ..results import Indices, Reals

# Linear: teal, copper, olive, plum, sand, slate.
CLASSES = np.array(
    [(0.030, 0.210, 0.220), (0.500, 0.160, 0.055), (0.190, 0.240, 0.040), (0.210, 0.040, 0.130), (0.620, 0.420, 0.190),
     (0.080, 0.110, 0.180)]
)  # fmt: skip
SPREAD = 0.45  # of the brightness, up or down


def random_of(count: int, seed: int) -> Reals:
    """(count,) numbers from 0 to 1, one for each shape; the first ones are the same whatever the count."""
    return np.random.default_rng([seed, 7]).random(count)


def shape_colors(classes: Indices, random: Reals) -> Reals:
    """(n, 3) linear colors."""
    base = CLASSES[classes % len(CLASSES)]
    bright: Reals = base * (1.0 + SPREAD * (2.0 * random[:, None] - 1.0))
    return np.clip(bright, 0.0, 1.0)


def palette_colors(random: Reals, palette: Reals, contrast: float) -> Reals:
    """(n, 3) linear colors: one of the palette's (m, 3) for each shape, lighter or darker by up to `contrast`."""
    place = random * len(palette)
    base = palette[place.astype(np.int64)]
    bright: Reals = base * (1.0 + contrast * (2.0 * (place % 1.0)[:, None] - 1.0))
    return np.clip(bright, 0.0, 1.0)

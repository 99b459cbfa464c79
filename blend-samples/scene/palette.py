# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors that go together: a ramp along the subject, bands across it, and a little life from cell to cell."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# sRGB, from the tail (0) to the head (1)
ALONG = ["#31307e", "#25609b", "#148a93", "#1f9d6b", "#5db544", "#3fa867", "#1d9f9a", "#2b7fb6"]
BAND = "#f2a33a"
BELLY = "#f6e3b0"
CREST = "#e4572e"
# The same for scales: dusk from the tail to the head.
DUSK = ["#3a1445", "#7a1f4d", "#b8323f", "#e0602f", "#efa02f", "#e9c04a", "#5fa58a", "#1f7f86"]
DUSK_BAND = "#2a1038"


def linear(codes: list[str]) -> Array:
    """Linear RGB (n, 3) of colors written #rrggbb."""
    srgb = np.array([[int(c[i : i + 2], 16) for i in (1, 3, 5)] for c in codes]) / 255
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


TO_LMS = np.array(
    [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ]
)
TO_LAB = np.array(
    [
        [0.2104542553, 0.7936177850, -0.0040720468],
        [1.9779984951, -2.4285922050, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.8086757660],
    ]
)


def to_oklab(rgb: Array) -> Array:
    """Linear RGB to OKLab (B. Ottosson, 2020), where mixing and lightening look even."""
    return np.cbrt(rgb @ TO_LMS.T) @ TO_LAB.T


def from_oklab(lab: Array) -> Array:
    """OKLab to linear RGB, cut to [0, 1]."""
    return np.clip((lab @ np.linalg.inv(TO_LAB).T) ** 3 @ np.linalg.inv(TO_LMS).T, 0, 1)


def mix(a: Array, b: Array, amount: Array) -> Array:
    """Mixes from a (n, 3) to b (3,) by amount (n,)."""
    return a + amount[:, None] * (b - a)


def smoothstep(value: Array, low: float, high: float) -> Array:
    """Returns 0 at `low`, 1 at `high`, smooth between."""
    t = np.clip((value - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def scale_colors(centers: Array, random: Array, low: Array, high: Array) -> Array:
    """Linear RGB (n, 3) for scales with these centers and random numbers (n,) in the bounding box low..high."""
    stops, band = to_oklab(linear(DUSK)), to_oklab(linear([DUSK_BAND]))[0]
    place = (centers - low) / np.maximum(high - low, 1e-12)
    long = int(np.argmax((high - low)[:2]))
    wobble = 0.02 * np.sin(9 * place[:, 2] + 5 * place[:, 1 - long]) + 0.012 * np.sin(23 * place[:, 2] + 1)
    along = np.clip(place[:, long] + wobble, 0, 1) * (len(stops) - 1)
    lab = np.stack([np.interp(along, np.arange(len(stops)), stops[:, i]) for i in range(3)], axis=1)
    stripe = smoothstep(np.cos(2 * np.pi * (place[:, long] + 0.14 * place[:, 2] + wobble) * 6.5), 0.62, 0.92)
    lab = mix(lab, band, 0.8 * stripe)
    lab[:, 0] += 0.10 * (random - 0.5)
    return from_oklab(lab)


def cell_colors(centers: Array, normals: Array, areas: Array, low: Array, high: Array) -> Array:
    """Linear RGB (n, 3) for cells with these centers, normals and areas in the bounding box low..high."""
    stops = to_oklab(linear(ALONG))
    band, belly, crest = (to_oklab(linear([c]))[0] for c in (BAND, BELLY, CREST))
    place = (centers - low) / np.maximum(high - low, 1e-12)
    long = int(np.argmax((high - low)[:2]))
    wobble = 0.02 * np.sin(9 * place[:, 2] + 5 * place[:, 1 - long]) + 0.012 * np.sin(23 * place[:, 2] + 1)
    along = np.clip(place[:, long] + wobble, 0, 1) * (len(stops) - 1)
    lab = np.stack([np.interp(along, np.arange(len(stops)), stops[:, i]) for i in range(3)], axis=1)
    slant = place[:, long] + 0.10 * place[:, 2] + wobble
    stripe = smoothstep(np.cos(2 * np.pi * slant * 7.5), 0.45, 0.9)
    lab = mix(lab, band, 0.85 * stripe * smoothstep(np.abs(normals[:, 1 - long]), 0.25, 0.6))
    lab = mix(lab, belly, 0.75 * smoothstep(-normals[:, 2], 0.35, 0.85))
    lab = mix(lab, crest, 0.9 * smoothstep(normals[:, 2], 0.80, 0.97) * smoothstep(place[:, 2], 0.55, 0.7))
    size = np.log(np.maximum(areas, 1e-30) / np.median(areas))
    lab[:, 0] += 0.025 * np.clip(size, -1.5, 1.5)
    rng = np.random.default_rng(4)
    lab += rng.normal(0, [0.028, 0.012, 0.012], lab.shape)
    return from_oklab(lab)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Thumbnails of the assets: a patch of cells, drawn from what the node groups make of their attributes."""

from __future__ import annotations

import numpy as np

from ..core.results import Reals

SIZE = 128


def picture(name: str) -> Reals:
    """(SIZE, SIZE, 4) colors of an asset's thumbnail, from the lowest row up."""
    places = np.stack(np.meshgrid(*[(np.arange(SIZE) + 0.5) / SIZE * 4.0 - 2.0] * 2), axis=-1)
    rng = np.random.default_rng(7)
    rows = np.arange(-4, 5)
    sites = np.stack([a.ravel() for a in np.meshgrid(rows * 0.9, rows * 0.78)], axis=-1)
    sites[:, 0] += 0.45 * (np.arange(len(sites)) // len(rows) % 2)
    sites += rng.uniform(-0.16, 0.16, sites.shape)
    tints = rng.uniform(0.55, 1.0, len(sites))
    ways = places[:, :, None, :] - sites
    lengths = np.linalg.norm(ways, axis=-1)
    first, second = np.argsort(lengths, axis=-1)[..., :2].transpose(2, 0, 1)
    near, next_near = (np.take_along_axis(lengths, index[..., None], -1)[..., 0] for index in (first, second))
    apart = np.linalg.norm(sites[first] - sites[second], axis=-1)
    to_edge = (next_near**2 - near**2) / (2.0 * apart)
    draw = {
        "Cell Panels": lambda: _shaded(np.clip((to_edge - 0.04) / 0.06, 0.0, 1.0), (0.85, 0.82, 0.76), to_edge > 0.04),
        "Cell Pebbles": lambda: _shaded(
            np.sqrt(1.0 - (1.0 - np.clip((to_edge - 0.03) / 0.4, 0.0, 1.0)) ** 2), (0.6, 0.54, 0.46), to_edge > 0.03
        ),
        "Cell Color": lambda: _flat(np.array((1.0, 0.55, 0.3)) * tints[first][..., None], to_edge > 0.03),
        "Tubes by Cell Size": lambda: _shaded(
            np.sqrt(np.clip(1.0 - (to_edge / 0.07) ** 2, 0.0, 1.0)), (0.9, 0.75, 0.4), to_edge < 0.07
        ),
        "Stipple Dots": lambda: _flat(np.full((SIZE, SIZE, 3), 0.92), near > 0.12 + 0.2 * (tints[first] - 0.55)),
        "Distance Ramp": lambda: _bands(np.linalg.norm(places - (-1.2, -1.0), axis=-1)),
        "Overlapping Scales": lambda: _overlapping(places),
    }
    colors: Reals = np.ones((SIZE, SIZE, 4))
    colors[..., :3] = draw[name]()
    return colors


def _flat(color: Reals, is_shown: np.ndarray) -> Reals:
    shown: Reals = np.where(is_shown[..., None], color, 0.06)
    return shown


def _shaded(height: Reals, color: tuple[float, float, float], is_shown: np.ndarray) -> Reals:
    """A relief with its light from above on the left."""
    slope_y, slope_x = np.gradient(height * 0.25, 4.0 / SIZE)
    normal = np.stack([-slope_x, -slope_y, np.ones_like(height)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    shade = np.clip(normal @ (np.array((-0.5, 0.6, 0.62)) / np.linalg.norm((-0.5, 0.6, 0.62))), 0.0, 1.0)
    return _flat(np.clip(np.array(color) * (0.25 + 0.95 * shade[..., None]), 0.0, 1.0), is_shown)


def _bands(distance: Reals) -> Reals:
    share = (distance / distance.max())[..., None]
    color = (1.0 - share) * np.array((0.98, 0.85, 0.3)) + share * np.array((0.12, 0.2, 0.5))
    bands: Reals = np.where((distance % 0.35 < 0.05)[..., None], 0.3 * color, color)
    return bands


def _overlapping(places: Reals) -> Reals:
    """Rows of disks, each over the one above it."""
    colors: Reals = np.full((SIZE, SIZE, 3), 0.06)
    for row in range(8, -9, -1):
        for column in range(-5, 6):
            middle = np.array((0.7 * column + 0.35 * (row % 2), 0.42 * row))
            away = np.linalg.norm(places - middle, axis=-1)
            lower = np.clip((middle[1] - places[..., 1]) / 0.42, -1.0, 1.0)
            shade = 0.45 + 0.3 * lower
            inside = away < 0.42
            colors[inside] = (np.array((0.25, 0.72, 0.6)) * shade[..., None])[inside]
            colors[inside & (away > 0.38)] = (0.04, 0.16, 0.13)
    return colors

# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes that come with the add-on: scales, studs, feathers, leaves, tiles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..results import Reals
from .shape_templates import ShapeTemplate, Solid, dome, fitted, rounded

CENTER = np.zeros(2)


def _scales() -> list[ShapeTemplate]:
    """A shield with a keel that rises towards its tip, which points along the field."""
    half = np.array([(1.0, 0.0), (0.86, 0.2), (0.58, 0.46), (0.2, 0.62), (-0.3, 0.62), (-0.66, 0.5), (-0.84, 0.26)])
    outline = _smooth(np.concatenate([half, [(-0.9, 0.0)], half[:0:-1] * (1, -1)]))
    solid = _pillow(outline, 0.17, 6)
    x, y, z = solid.vertices.T
    # Of places, not of directions from the middle, where those would leave a knob.
    lift = 0.55 + 0.45 * (x - x.min()) / np.ptp(x)
    keel = 0.09 * np.exp(-((y / 0.09) ** 2)) * np.clip(1.0 - x**2, 0, 1) * (z > 0)
    solid = replace(solid, vertices=np.column_stack([x, y, z * lift + keel]))
    return [_template("Scale", outline, solid)]


def _studs() -> list[ShapeTemplate]:
    """A round head with a flat rim."""
    turn = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    outline = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    levels = np.array([1.0, 1.0, 0.92, 0.8, 0.72, 0.64, 0.5, 0.34, 0.16])
    heights = np.array([0.0, 0.08, 0.12, 0.12, 0.18, 0.32, 0.46, 0.54, 0.58])
    return [_template("Stud", outline, dome(outline, levels, heights))]


def _feathers() -> list[ShapeTemplate]:
    """A long vane with a round tip, barbs aslant of the quill, and the quill bare at its root."""
    root = np.array([(-1.0, 0.018), (-0.9, 0.024), (-0.8, 0.03)])
    x = np.cos(np.linspace(np.pi, 0.0, 27))[1:-1]  # from the root of the vane to its tip
    vane = np.column_stack([0.87 * x + 0.13, 0.27 * (1 - x**2) ** 0.5 * (0.9 + 0.22 * x - 0.12 * x**2)])
    half = np.concatenate([root, vane[vane[:, 0] > -0.72]])  # wider than the quill: all is seen from the middle
    outline = np.concatenate([half * (1, -1), [(1.0, 0.0)], half[::-1]])
    solid = _pillow(outline, 0.05, 5)
    along, across = solid.vertices[:, 0], np.abs(solid.vertices[:, 1])
    inside = solid.vertices[:, 2] > 0
    quill = 0.055 * np.exp(-((across / 0.03) ** 2)) * np.clip(1.1 - np.abs(along), 0, 1)
    barbs = 0.016 * np.sin(26 * (along - 1.3 * across)) * np.clip(12 * across, 0, 1)
    return [_template("Feather", outline, _raised(solid, (quill + barbs * (along > -0.7)) * inside))]


def _leaves() -> list[ShapeTemplate]:
    """Two leaves of different slenderness, folded along the midrib."""
    found = []
    for name, aspect, size, share in (("Leaf", 0.44, 1.0, 1.0), ("Small Leaf", 0.56, 0.6, 1.5)):
        x = np.linspace(-1.0, 1.0, 25)
        width = aspect * np.clip(1 - x**2, 0, 1) * (1.0 - 0.28 * x)
        outline = np.concatenate([np.stack([x, -width], axis=1), np.stack([x, width], axis=1)[-2:0:-1]])
        solid = _pillow(outline, 0.1)
        fold = 0.1 * np.clip(np.abs(solid.vertices[:, 1]) / aspect, 0, 1) * (1 - np.abs(solid.vertices[:, 0]))
        veins = 0.012 * np.cos(26 * (solid.vertices[:, 0] - 0.8 * np.abs(solid.vertices[:, 1])))
        template = _template(name, outline, _raised(solid, (fold + veins) * (solid.vertices[:, 2] > 0)))
        found.append(replace(template, size=size, share=share))
    return found


def _mosaic() -> list[ShapeTemplate]:
    """Tiles: squares, bricks, triangles."""
    outlines = {
        "Square": (np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float), 1.0, 1.0),
        "Brick": (np.array([(-1, -0.5), (1, -0.5), (1, 0.5), (-1, 0.5)], float), 1.0, 0.8),
        "Triangle": (np.array([(1.0, 0.0), (-0.5, 0.866), (-0.5, -0.866)]), 0.7, 0.6),
    }
    found = []
    for name, (corners, size, share) in outlines.items():
        outline = _along(rounded(corners, 0.16, 3), 0.12)
        levels = np.array([1.0, 1.0, 0.97, 0.91, 0.7, 0.4])
        heights = np.array([0.0, 0.1, 0.14, 0.16, 0.16, 0.16])
        found.append(replace(_template(name, outline, dome(outline, levels, heights)), size=size, share=share))
    return found


def _smooth(outline: Reals) -> Reals:
    """Twice as many corners, by corner cutting: a closed curve near the polygon."""
    onward = np.roll(outline, -1, axis=0)
    return np.stack([0.75 * outline + 0.25 * onward, 0.25 * outline + 0.75 * onward], axis=1).reshape(-1, 2)


def _along(outline: Reals, step: float) -> Reals:
    """The outline with further corners, none farther from the next than `step`."""
    pieces = []
    for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        count = max(1, int(np.ceil(np.linalg.norm(b - a) / step)))
        pieces.append(a + np.arange(count)[:, None] / count * (b - a))
    return np.concatenate(pieces)


def _pillow(outline: Reals, height: float, steps: int = 9) -> Solid:
    """A low wall, then a round back in so many steps."""
    slope = np.linspace(0.0, 1.0, steps)
    levels = np.concatenate([[1.0], 1.0 - 0.97 * slope])
    heights = height * np.concatenate([[0.0], 0.35 + 0.65 * np.sqrt(1 - (1 - slope) ** 2)])
    return dome(outline, levels, heights)


def _raised(solid: Solid, height: Reals) -> Solid:
    return replace(solid, vertices=solid.vertices + np.column_stack([0 * height, 0 * height, height]))


def _template(name: str, outline: Reals, solid: Solid) -> ShapeTemplate:
    return fitted(name, [[outline]], CENTER, solid)


PRESETS: dict[str, Callable[[], list[ShapeTemplate]]] = {
    "SCALES": _scales,
    "STUDS": _studs,
    "FEATHERS": _feathers,
    "LEAVES": _leaves,
    "MOSAIC": _mosaic,
}


def preset(name: str) -> list[ShapeTemplate]:
    """The shapes of a preset."""
    return PRESETS[name]()

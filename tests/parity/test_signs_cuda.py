# SPDX-License-Identifier: MIT
"""A CUDA device decides on points of the plane as rational numbers do."""

from __future__ import annotations

import importlib
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

UNKNOWN = 2
COUNT = 3000


def _small_integers(rng: np.random.Generator) -> np.ndarray:
    return rng.integers(0, 6, (COUNT, 4, 2)).astype(float)


def _ulps_off(points: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    last_digit = np.spacing(np.maximum(np.abs(points), 1e-3))  # products of less would underflow
    return points + rng.integers(-1, 2, points.shape) * last_digit


def _of_two_sizes(rng: np.random.Generator) -> np.ndarray:
    points = _small_integers(rng)
    tiny = points * 1e-9 + 1e-25 * rng.integers(0, 7, points.shape)
    return np.where(rng.random(points.shape) < 0.5, tiny, points)


def _in_a_row(rng: np.random.Generator) -> np.ndarray:
    start, step = rng.random((2, COUNT, 1, 2))
    return _ulps_off(start + step * rng.integers(-9, 10, (COUNT, 4, 1)) / 7, rng)


def _on_a_circle(rng: np.random.Generator) -> np.ndarray:
    angles = rng.integers(0, 24, (COUNT, 4)) * (np.pi / 12)
    return _ulps_off(rng.random((COUNT, 1, 2)) + np.stack((np.cos(angles), np.sin(angles)), axis=-1), rng)


KINDS = {
    "small integers": _small_integers,
    "thirds": lambda rng: _small_integers(rng) / 3,
    "thirds far away": lambda rng: _small_integers(rng) / 3 + 1000,
    "a digit off integers": lambda rng: _ulps_off(_small_integers(rng), rng),
    "a digit off tenths": lambda rng: _small_integers(rng) * 0.1 + rng.integers(-1, 2, (COUNT, 4, 2)) * 1e-17,
    "of two sizes": _of_two_sizes,
    "in a row": _in_a_row,
    "on a circle": _on_a_circle,
    "anywhere": lambda rng: rng.normal(size=(COUNT, 4, 2)),
}


def _sign(value: Fraction) -> int:
    return (value > 0) - (value < 0)


def _decided(four: np.ndarray) -> tuple[int, int, int]:
    """Return the turn of a, b and c, the circle's side that d is on, and which of b and c is nearer to a."""
    a, b, c, d = [(Fraction(float(x)), Fraction(float(y))) for x, y in four]
    turn = (a[0] - c[0]) * (b[1] - c[1]) - (a[1] - c[1]) * (b[0] - c[0])
    rows = [(p[0] - d[0], p[1] - d[1], (p[0] - d[0]) ** 2 + (p[1] - d[1]) ** 2) for p in (a, b, c)]
    (ax, ay, al), (bx, by, bl), (cx, cy, cl) = rows
    circle = al * (bx * cy - cx * by) + bl * (cx * ay - ax * cy) + cl * (ax * by - bx * ay)
    to_b, to_c = [(p[0] - a[0]) ** 2 + (p[1] - a[1]) ** 2 for p in (b, c)]
    return _sign(turn), _sign(circle), _sign(to_b - to_c)


@pytest.fixture(scope="module")
def module() -> Any:
    return importlib.import_module("saddleback._saddleback_cuda")


@pytest.mark.parametrize("kind", KINDS)
def test_the_same_signs(kind: str, module: Any) -> None:
    points = KINDS[kind](np.random.default_rng(len(kind)))
    signs = module.plane_signs(points)
    wanted = np.array([_decided(four) for four in points])
    turn, circle, order = wanted.T
    assert (signs[:, 0] == turn).all() and (signs[:, 1] == order).all()
    assert (signs[:, 2] == turn).all() and (signs[:, 4] == order).all()
    is_known = signs[:, 3] != UNKNOWN
    assert (signs[is_known, 3] == circle[is_known]).all()
    assert is_known.mean() > 0.5, "too few are decided there to say anything"


def test_what_is_wrong_with_the_points(module: Any) -> None:
    with pytest.raises(ValueError, match="points: wanted an"):
        module.plane_signs(np.zeros((3, 4)))
    assert module.plane_signs(np.zeros((0, 4, 2))).shape == (0, 5)

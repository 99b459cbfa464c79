# SPDX-License-Identifier: MIT
"""What the compiled part asks of numbers, for the calls that are written in Python."""

from __future__ import annotations

import operator

import numpy as np
from numpy.typing import ArrayLike, NDArray

from saddleback._saddleback import InputError


def reals(values: ArrayLike, name: str) -> NDArray[np.float64]:
    """Numbers as float64 in row order; what is none, as text and dates, and what is masked is refused by its name."""
    try:
        array = np.asarray(values)
    except (TypeError, ValueError):
        raise InputError(f"{name}: wanted real numbers, got a {type(values).__name__} that is no array") from None
    if np.ma.is_masked(values):
        raise InputError(f"{name}: wanted real numbers, got masked elements")
    if array.dtype.kind not in "biuf":
        raise InputError(f"{name}: wanted real numbers, got type {array.dtype}")
    return np.asarray(array, dtype=np.float64, order="C")


def integer(value: object, name: str) -> int:
    """One whole number."""
    try:
        return operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        raise InputError(f"{name}: wanted an integer, got a {type(value).__name__}") from None


def real(value: object, name: str) -> float:
    """One number."""
    array = reals(value, name)  # type: ignore[arg-type]
    if array.ndim:
        raise InputError(f"{name}: wanted a real number, got shape {array.shape}")
    return float(array)

# SPDX-License-Identifier: MIT
"""How questions are asked, and what answers are made of."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import saddleback as sb


@dataclass(frozen=True)
class Way:
    """How a question is asked: by so many threads, on this device."""

    threads: int = 1
    device: str = "cpu"


@dataclass(frozen=True)
class Question:
    name: str
    subject: str
    portable: bool
    ask: Callable[[Way], Iterable[object]]
    has_threads: bool  # the answer may depend on their number, if there is a fault


QUESTIONS: list[Question] = []


def asked(subjects: dict[str, Any], *, portable: bool = False, **rules: dict[str, Any]) -> Callable[..., Any]:
    """Ask a function of a subject, perhaps of the way, and of each rule's options, about each of the subjects."""

    def add(function: Callable[..., Iterable[object]]) -> Callable[..., Iterable[object]]:
        has_way = "way" in inspect.signature(function).parameters
        for subject, thing in subjects.items():
            for rule, options in (rules or {"": {}}).items():

                def ask(way: Way, thing: Any = thing, options: dict[str, Any] = options) -> Iterable[object]:
                    return function(thing, way, **options) if has_way else function(thing, **options)

                name = function.__name__ + (f" {rule}" if rule else "")
                QUESTIONS.append(Question(name, subject, portable, ask, has_way))
        return function

    return add


def rounded(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """To 24 bits."""
    return points.astype(np.float32).astype(np.float64)


def all_of(thing: object, names: str) -> list[object]:
    return [getattr(thing, name) for name in names.split()]


def surface(points: sb.SurfacePoints) -> list[object]:
    return [points.faces, points.barycentric]

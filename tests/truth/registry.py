# SPDX-License-Identifier: MIT
"""The checks of this folder, by name, and the public entry points that each guards."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

Input = Literal["mesh", "plane", "nothing"]
CheckFunction = Callable[..., None]


@dataclass(frozen=True)
class Check:
    """A function that raises on a finding.

    `on` says what it is given before a random generator: a good mesh of some 4 to 300 faces (`"mesh"`, an `sb.Mesh`),
    sites of the plane (`"plane"`, an array (n, 2) with n >= 1), or nothing. An `sb.Error` that it lets through is a
    refusal, not a finding: what must not be refused, it asserts. `unsettled` tells what the check still finds: such a
    check is no part of `tests/run`, but of every longer search.
    """

    name: str
    function: CheckFunction
    guards: tuple[str, ...]
    on: Input
    unsettled: str = ""

    @property
    def summary(self) -> str:
        """The first line of the docstring: what is compared with what."""
        return (self.function.__doc__ or "").strip().split("\n")[0]


CHECKS: dict[str, Check] = {}


def guards(*entry_points: str, on: Input = "mesh", unsettled: str = "") -> Callable[[CheckFunction], CheckFunction]:
    """Register a check of these entry points, named as users call them: "exact_distances", "SaddleVertexGraph.path"."""

    def register(function: CheckFunction) -> CheckFunction:
        name = f"{function.__module__.rpartition('.')[2]}.{function.__name__}"
        if name in CHECKS and CHECKS[name].function is not function:
            raise ValueError(f"two checks are called {name}")
        CHECKS[name] = Check(name, function, entry_points, on, unsettled)
        return function

    return register


def load_checks() -> dict[str, Check]:
    """Import every module of this folder, which registers its checks: by name, whatever was imported before."""
    package: Any = importlib.import_module("tests.truth")
    for module in pkgutil.iter_modules(package.__path__):
        if not module.name.startswith("test_"):
            importlib.import_module(f"tests.truth.{module.name}")
    return dict(sorted(CHECKS.items()))

# SPDX-License-Identifier: MIT
"""Every public entry point with the checks that guard it: `python -m tests.truth.table` writes docs/truths.md."""

from __future__ import annotations

import operator
import sys
from collections.abc import Iterator
from pathlib import Path

import saddleback as sb
from tests.truth.registry import Check, load_checks

PAGE = Path(__file__).resolve().parents[2] / "docs/truths.md"
INTRODUCTION = """# What guards each answer

Every public entry point, and the checks of `tests/truth` that compare it with a slower, independent truth or with what
must hold whatever the input. `python -m tests.truth.fuzz` runs them on random input; this page is made by
`python -m tests.truth.table`.

"""
UNSETTLED = """## What is not settled

Checks that still find something now and then. They are no part of `tests/run`, but of every longer search.
"""


def is_public(name: str) -> bool:
    return not name.startswith("_")


def entry_points() -> Iterator[str]:
    """Functions and classes by name, methods as Class.method; what a class merely holds is guarded with the class."""
    for name in filter(is_public, sb.__all__):
        value = getattr(sb, name)
        if not callable(value) or (isinstance(value, type) and issubclass(value, Exception)):
            continue
        yield name
        if isinstance(value, type):
            yield from (
                f"{name}.{part}" for part, method in vars(value).items() if is_public(part) and callable(method)
            )


def guards_of(checks: dict[str, Check]) -> dict[str, list[Check]]:
    """The checks of every entry point, also of those that have none; and of what a class holds if a check names it."""
    found: dict[str, list[Check]] = {name: [] for name in entry_points()}
    for check in checks.values():
        for name in check.guards:
            operator.attrgetter(name)(sb)  # raises for what there is not
            found.setdefault(name, []).append(check)
    return found


def page() -> str:
    """The page's text."""
    checks = load_checks()
    rows = [
        f"| `{name}` | {', '.join(f'`{check.name}`' for check in found)} |" for name, found in guards_of(checks).items()
    ]
    lines = [f"- `{name}`: {check.summary}" for name, check in checks.items()]
    unsettled = [f"- `{name}`: {check.unsettled}" for name, check in checks.items() if check.unsettled]
    head = [INTRODUCTION + "| entry point | checks |", "|---|---|"]
    return "\n".join([*head, *rows, "", "## The checks", "", *lines, "", UNSETTLED, *unsettled, ""])


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    empty = [name for name, guards in guards_of(load_checks()).items() if not guards]
    print(f"{len(empty)} entry points without a guard: {', '.join(empty)}")
    sys.exit(bool(empty))

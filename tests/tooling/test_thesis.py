# SPDX-License-Identifier: MIT
"""docs/thesis.md has a row for each table and figure of chapters 3 to 6 of [ying2014], made by `tests.bench thesis`."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FIGURES, TABLES = {3: 12, 4: 9, 5: 12, 6: 12}, {3: 0, 4: 2, 5: 1, 6: 2}
PAGE = (ROOT / "docs/thesis.md").read_text(encoding="utf-8")


def wanted() -> list[str]:
    return [
        f"{kind} {chapter}.{number}"
        for kind, counts in (("Figure", FIGURES), ("Table", TABLES))
        for chapter, count in counts.items()
        for number in range(1, count + 1)
    ]


@pytest.mark.parametrize("name", wanted())
def test_it_has_its_row(name: str) -> None:
    (found,) = re.findall(rf"^\| \*\*{re.escape(name)}\.\*\* (.+) \| (.+) \| (.+) \|$", PAGE, re.MULTILINE)
    assert all(len(cell) > 6 for cell in found)


def test_the_bench_makes_them_all_and_no_others() -> None:
    calls = [
        node.args[0]
        for path in (ROOT / "tests/bench/_thesis").glob("chapter_*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call) and ast.unparse(node.func) == "item"
    ]
    names = [ast.literal_eval(call) for call in calls]
    assert sorted(names) == sorted(wanted())


def test_pictures_are_there_and_shown() -> None:
    assert set(re.findall(r"\(thesis/([^)]+)\)", PAGE)) == {
        f"{path.parent.name}/{path.name}" for path in (ROOT / "docs/thesis").glob("*/*")
    }


def test_nothing_in_it_went_wrong() -> None:
    """Answers shout where something does not hold; without meshes of one's own the page would say so, too."""
    assert not re.findall(r"FAULTS|DIFFERENT|NOT |stands in", PAGE)

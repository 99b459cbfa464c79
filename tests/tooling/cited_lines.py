# SPDX-License-Identifier: MIT
"""Corrects the numbers of the lines that docs/releasing.md cites as `file:line`: `what stands there`.

python -m tests.tooling.cited_lines
"""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/releasing.md"


def corrected(page: str) -> str:
    """Return the page with the first line of each file that has the text; ValueError where none has."""
    return re.sub(r"`([\w./-]+):\d+`: `([^`]+)`", _citation, page)


def _citation(found: re.Match[str]) -> str:
    name, text = found.groups()
    for number, line in enumerate((ROOT / name).read_text(encoding="utf-8").splitlines(), 1):
        if text in line:
            return f"`{name}:{number}`: `{text}`"
    raise ValueError(f"{PAGE.name} says that {name} has {text!r}")


if __name__ == "__main__":
    PAGE.write_text(corrected(PAGE.read_text(encoding="utf-8")), encoding="utf-8")

# SPDX-License-Identifier: MIT
"""Benchmarks by hand: ``.venv/bin/python -m tests.bench NAME`` runs tests/bench/NAME.py; no name lists them."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path


def names() -> list[str]:
    return sorted(path.stem for path in Path(__file__).parent.glob("*.py") if not path.stem.startswith("_"))


def main(arguments: list[str]) -> int:
    if not arguments:
        print("\n".join(names()))
        return 0
    if arguments[0] not in names():
        print(f"No benchmark {arguments[0]!r}; there are: {', '.join(names())}", file=sys.stderr)
        return 2
    return int(importlib.import_module(f"tests.bench.{arguments[0]}").main(arguments[1:]) or 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

# SPDX-License-Identifier: MIT
"""Sorts the arguments of tests/run: what the outer pytest gets, and what the one inside each Blender gets.

Run as a script, prints what the arguments need to be set up: "blender", "bpy", both or nothing. Standard library only,
for it runs before anything is installed.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from pathlib import Path

INSIDE = Path("tests/addon_blender")
"""The folder of the tests that import bpy."""
STARTS_BLENDER = Path("tests/addon_ui")
"""The folder of the tests that start a Blender with a window and look at it from outside."""


@dataclass
class Arguments:
    """`plain` and `inside` are paths; `options` is everything else and goes to both."""

    plain: list[str] = field(default_factory=list)
    inside: list[str] = field(default_factory=list)
    options: list[str] = field(default_factory=list)
    starts_blender: bool = False

    @property
    def wants_plain(self) -> bool:
        return bool(self.plain) or not self.inside

    @property
    def wants_inside(self) -> bool:
        return bool(self.inside) or not self.plain

    @property
    def needs(self) -> list[str]:
        """What has to be installed: Debian's Blender, the bpy wheels."""
        return ["blender"] * (self.wants_inside or self.starts_blender) + ["bpy"] * self.wants_inside


def split(arguments: list[str], root: Path) -> Arguments:
    """Tell paths from options: a path is what exists below `root` (`file.py::test` counts as file.py)."""
    result = Arguments()
    for argument in arguments:
        path = root / argument.split("::")[0]
        if argument.startswith("-") or not argument or not path.exists():
            result.options.append(argument)
            continue
        relative = path.resolve().relative_to(root.resolve()) if path.resolve().is_relative_to(root.resolve()) else path
        if relative == INSIDE or INSIDE in relative.parents:
            result.inside.append(argument)
        elif relative in (Path(), Path("tests")):  # the whole: what no path at all means
            continue
        else:
            result.plain.append(argument)
            result.starts_blender |= relative == STARTS_BLENDER or STARTS_BLENDER in relative.parents
    return result


if __name__ == "__main__":
    print(*split(sys.argv[1:], Path.cwd()).needs)

# SPDX-License-Identifier: MIT
"""The files of the repository."""

from __future__ import annotations

import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MADE = {"build", "dist", "__pycache__", ".venv", ".cache", ".git", ".hypothesis"}


def git(*arguments: str) -> str | None:
    """Return what git says; None where there is no git, or no checkout of its own."""
    command = ["git", *arguments]
    try:
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    except OSError:
        return None
    return done.stdout if done.returncode == 0 else None


def tracked() -> list[str]:
    """Return the names of the files that git tracks, or of all that nothing has made where git cannot tell."""
    said = git("ls-files", "-z")
    if said is not None:
        return [name for name in said.split("\0") if name]
    paths = (path.relative_to(ROOT) for path in ROOT.rglob("*") if path.is_file())
    return [path.as_posix() for path in paths if not any(is_made(part) for part in path.parts)]


def is_made(part: str) -> bool:
    """Tell whether builds, tests and tools make what a part of a path names."""
    return part in MADE or part.startswith("build-") or part.endswith("_cache")

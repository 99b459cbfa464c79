# SPDX-License-Identifier: MIT
"""What the tools say of the whole tree: formatting, lint, types, names."""

from __future__ import annotations

import concurrent.futures
import functools
import hashlib
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.tooling.tracked import git

ROOT = Path(__file__).resolve().parents[2]
BIN = Path(sys.executable).parent
CACHE = ROOT / ".cache/clang-tidy"


def run(*command: str | Path) -> str:
    """Run a tool in the root and return all it says; fail with that when it is not content."""
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    said = done.stdout + done.stderr
    if done.returncode:
        pytest.fail(said, pytrace=False)
    return said


def sources(*suffixes: str) -> list[Path]:
    """List our C++ (and CUDA) files."""
    return sorted(path for path in (ROOT / "native").rglob("*") if path.suffix in suffixes)


def test_ruff_check():
    run(BIN / "ruff", "check", "--quiet", ".")


def test_ruff_format():
    run(BIN / "ruff", "format", "--check", "--quiet", ".")


@pytest.mark.parametrize("package", ["saddleback", "saddleback_blender"])
def test_mypy_strict(package):
    run(BIN / "mypy", "--strict", "-p", package)


def test_clang_format():
    run(BIN / "clang-format", "--dry-run", "--Werror", *sources(".h", ".cpp", ".cu", ".cuh"))


@functools.cache
def headers_of(file: Path) -> frozenset[Path]:
    """Return all of our headers that a file includes, also through others; by the ends of their paths."""
    found, last = set(), {file}
    while last:
        names = {name for path in last for name in re.findall(r'#include "([^"]+)"', path.read_text(encoding="utf-8"))}
        last = {header for name in names for header in headers_by_end().get(name, ())} - found
        found |= last
    return frozenset(found)


@functools.cache
def headers_by_end() -> dict[str, set[Path]]:
    """Return our headers by all that they can be included as: mesh/mesh.h, mesh.h."""
    found: dict[str, set[Path]] = {}
    for header in sources(".h", ".cuh"):
        parts = header.relative_to(ROOT).parts
        for i in range(len(parts)):
            found.setdefault("/".join(parts[i:]), set()).add(header)
    return found


def include_digest(file: Path) -> str:
    """Digest what a verdict depends on: the rules, the tool, the file, and our headers that it includes."""
    read = [ROOT / ".clang-tidy", ROOT / "tests/requirements.txt", file, *sorted(headers_of(file))]
    return hashlib.sha256(b"".join(path.read_bytes() for path in read)).hexdigest()


# Sources are read without the headers that the build compiles before, so that each must include what it uses.
WITHOUT_PRECOMPILED = [
    "--removed-arg=-include",
    *(
        f"--removed-arg={ROOT}/build/native/{target}/cmake_pch.hxx"
        for target in ("CMakeFiles/saddleback.dir", "bindings/CMakeFiles/_saddleback.dir")
    ),
]


def tidy(file: str) -> str:
    """Return what clang-tidy says of one file, "" when it is content; files that have passed are not read again."""
    verdict = CACHE / include_digest(Path(file))
    if verdict.exists():
        return ""
    # -w: the compiler's own warnings are GCC's business, and errors there.
    command = [BIN / "clang-tidy", "-p", ROOT / "build", "--quiet", "--extra-arg=-w", *WITHOUT_PRECOMPILED, file]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode:
        return done.stdout + done.stderr
    verdict.touch()
    return ""


def changed() -> set[Path]:
    """Return what differs from the commit before the last one; with no such commit, what differs from the last."""
    for commit in ("HEAD~1", "HEAD"):
        names = git("diff", "--name-only", commit)
        if names is not None:
            return {ROOT / name for name in names.split()}
    return set()


def worth_reading(differing: set[Path]) -> set[Path]:
    """Return these files and all of ours that include one of them, also through other headers."""
    return differing | {path for path in sources(".h", ".cpp") if headers_of(path) & differing}


def test_clang_tidy():
    """`tests/run --lint` reads every source, which takes minutes; without it those that have changed are read."""
    CACHE.mkdir(parents=True, exist_ok=True)
    commands = json.loads((ROOT / "build/compile_commands.json").read_text())
    ours = sorted({entry["file"] for entry in commands if Path(entry["file"]).is_relative_to(ROOT / "native")})
    assert ours, "the compilation database names none of our files"
    if os.environ.get("SADDLEBACK_LINT") != "all":
        ours = sorted(set(ours) & {str(path) for path in worth_reading(changed())})
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        complaints = [said for said in pool.map(tidy, ours) if said]
    if complaints:
        pytest.fail("\n".join(complaints), pytrace=False)


def test_a_source_is_read_again_when_a_header_of_its_own_changed():
    engine = ROOT / "native/src/geodesics/exact"
    assert engine / "exact_propagation.cpp" in worth_reading({engine / "exact_queue.h"})
    assert worth_reading({engine / "exact_path.cpp"}) == {engine / "exact_path.cpp"}
    bindings = ROOT / "native/bindings"
    assert bindings / "bind_state.cpp" in worth_reading({bindings / "convert/state.h"})
    assert bindings / "convert/state.h" in headers_of(bindings / "bind_state.cpp")

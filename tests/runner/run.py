# SPDX-License-Identifier: MIT
"""The second half of tests/run: one pytest session over everything, the Blenders included.

python tests/runner/run.py --bpy "4.5 5.0" -- PYTEST_ARGUMENTS
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from tests.runner.arguments import INSIDE, split
from tests.runner.sessions import Blender, SessionsPlugin

SCRIPT = "tests/run_in_blender.py"


def debian_blender() -> Blender:
    """Debian's Blender brings no pytest of its own; numpy stays its own."""
    executable = os.environ.get("SADDLEBACK_BLENDER", "blender")
    packages = next((ROOT / ".venv/lib").glob("python3*/site-packages"))
    command = (executable, "-b", "--factory-startup", "--python-exit-code", "9", "--python", SCRIPT, "--")
    return Blender("blender-3.4", command, {"SADDLEBACK_PYTHONPATH": f"{ROOT / 'build/python'}{os.pathsep}{packages}"})


def bpy_wheel(version: str) -> Blender:
    """Name the environment that tests/setup.sh made for this version, with the build for its Python."""
    folder = ROOT / f".cache/bpy-{version}"
    own_build = ROOT / f"build-bpy-{version}"
    build = own_build if own_build.is_dir() else ROOT / "build"
    return Blender(
        f"bpy-{version}",
        (str(folder / "bin/python"), SCRIPT, "--"),
        {"SADDLEBACK_PYTHONPATH": str(build / "python")},
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bpy", default="", help="versions of the bpy wheels to test in")
    parser.add_argument("arguments", nargs="*")
    known = parser.parse_args()
    arguments = split(known.arguments, ROOT)
    blenders = []
    if arguments.wants_inside:
        blenders = [debian_blender(), *(bpy_wheel(version) for version in known.bpy.split())]
    inside = [*arguments.options, "--rootdir", str(ROOT), *(arguments.inside or [str(INSIDE)])]
    # With nothing to test here, a folder without tests: no path at all would mean all of them.
    plain = arguments.plain if arguments.plain or arguments.wants_plain else ["tests/runner"]
    os.chdir(ROOT)
    return pytest.main([*arguments.options, *plain], plugins=[SessionsPlugin(blenders, inside)])


if __name__ == "__main__":
    sys.exit(main())

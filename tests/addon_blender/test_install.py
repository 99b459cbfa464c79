# SPDX-License-Identifier: GPL-3.0-or-later
"""The packages of addon/package in an empty profile: installed, used, reopened, switched off and on."""

import os
import subprocess
import sys
from pathlib import Path

import bpy
import pytest

ROOT = Path(__file__).resolve().parents[2]
IS_EXTENSION = bpy.app.version >= (4, 2)


def package():
    """The package that this Blender takes; tests/run makes it before the tests."""
    found = [
        path
        for path in (ROOT / "dist").glob("saddleback-*.zip")
        if ("legacy" in path.name) != IS_EXTENSION and ("windows" in path.name) == (os.name == "nt")
    ]
    assert len(found) == 1, f"dist/ holds {len(found)} packages for this Blender: run addon/package"
    return found[0]


@pytest.fixture
def step(tmp_path):
    """Runs one of installed_steps.py in this Blender's program, each time in the same profile; returns its words."""
    script = str(Path(__file__).with_name("installed_steps.py"))
    if bpy.app.binary_path:
        command = [bpy.app.binary_path, "-b", "--python-exit-code", "9", "--python", script, "--"]
    else:
        command = [sys.executable, script, "--"]
    clean = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "PYTEST", "SADDLEBACK"))}
    profile = tmp_path / "Jörg Müller 猫"
    profile.mkdir()

    def run(*arguments):
        done = subprocess.run(
            [*command, *map(str, arguments)],
            env={**clean, "BLENDER_USER_RESOURCES": str(profile)},
            capture_output=True,
            text=True,
            check=False,
            timeout=300,
        )
        assert done.returncode == 0, f"{arguments[0]} ended with {done.returncode}\n{done.stdout}\n{done.stderr}"
        return done.stdout.split()

    return run


def test_install_use_and_come_back(step, tmp_path):
    file = tmp_path / "Bälle 猫.blend"
    said = step("first", package(), file)
    steps = ["installed", "ran", "others", "saved"]
    assert [word for word in steps if word in said] == steps
    said = step("again", file)
    steps = ["reopened", "ran", "undone", "disabled", "enabled"]
    assert [word for word in steps if word in said] == steps


@pytest.mark.skipif(not IS_EXTENSION, reason="extensions came with 4.2")
def test_blender_finds_the_extension_valid():
    scripts = Path(bpy.utils.system_resource("SCRIPTS"))
    (validator,) = scripts.glob("addons_core/bl_pkg/cli/blender_ext.py")
    command = [sys.executable, str(validator), "validate", str(package())]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "warning" not in done.stdout.lower(), done.stdout

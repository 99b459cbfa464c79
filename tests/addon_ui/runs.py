# SPDX-License-Identifier: GPL-3.0-or-later
"""Starts a Blender in a window that nobody sees; it plays scenarios and reports."""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parents[1]
BLENDER = os.environ.get("SADDLEBACK_BLENDER", "blender")


@contextmanager
def display(width, height):
    """A screen that nobody sees."""
    assert shutil.which("Xvfb"), "these tests need Xvfb; tests/run installs it"
    read, write = os.pipe()
    size = f"{width}x{height}x24"
    command = ["Xvfb", "-displayfd", str(write), "-screen", "0", size, "+extension", "GLX", "-nolisten", "tcp"]
    server = subprocess.Popen(command, pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    with os.fdopen(read) as stream:
        number = stream.readline().strip()
    assert number, "Xvfb did not start"
    yield f":{number}"
    server.terminate()
    server.wait(20)


def play(plays, width, height, patience):
    """What the scenarios of a module saw, by name; `patience` in seconds for all of them."""
    folder = Path(os.environ.get("SADDLEBACK_UI_FOLDER") or tempfile.mkdtemp(prefix="saddleback-ui-"))
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "report.json").unlink(missing_ok=True)
    profile = tempfile.mkdtemp(prefix="saddleback-profile-")
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    environment |= {
        "LIBGL_ALWAYS_SOFTWARE": "1",
        "BLENDER_USER_RESOURCES": profile,
        "SADDLEBACK_UI_FOLDER": str(folder),
        "SADDLEBACK_UI_PLAYS": plays,
    }
    environment.setdefault("SADDLEBACK_PYTHONPATH", str(REPOSITORY / "build/python"))
    command = [BLENDER, "--factory-startup", "--enable-event-simulate"]
    command += ["--window-geometry", "0", "0", str(width), str(height)]
    log = folder / "blender.log"
    with display(width, height) as screen, log.open("w") as stream:
        blender = subprocess.Popen(
            [*command, "--python-exit-code", "9", "--python", str(HERE / "driver.py")],
            env=environment | {"DISPLAY": screen}, stdout=stream, stderr=subprocess.STDOUT, start_new_session=True,
        )  # fmt: skip
        try:
            blender.wait(patience)
        except subprocess.TimeoutExpired:
            os.killpg(blender.pid, signal.SIGKILL)
            blender.wait()
    shutil.rmtree(profile, ignore_errors=True)
    result = folder / "report.json"
    assert result.exists(), f"Blender ended without a report ({blender.returncode}):\n{log.read_text()[-4000:]}"
    # Errors in draw functions reach only the log.
    text = log.read_text()
    assert "Traceback" not in text, text[-4000:]
    print(f"screenshots: {folder}", file=sys.stderr)
    return json.loads(result.read_text())


def seen(report, name):
    """What one scenario saw."""
    assert "error" not in report[name], report[name]["error"]
    return report[name]["seen"]

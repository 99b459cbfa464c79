# SPDX-License-Identifier: MIT
"""What is handed to PyVista, Open3D, Polyscope and matplotlib arrives there: tests of tests/native, with these.

They are 2 GB, so they are fetched into an environment of their own, and only where SADDLEBACK_PACKAGING=all asks for
it, as the workflows do. A bare Debian lacks what they draw with: libgl1 libegl1 libusb-1.0-0 libx11-6.
"""

import os
import subprocess
import sys
import venv
from pathlib import Path

import pytest

import saddleback

pytestmark = pytest.mark.skipif(
    os.environ.get("SADDLEBACK_PACKAGING") != "all", reason="fetches 1 GB: SADDLEBACK_PACKAGING=all"
)
ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / ".cache/other-packages"
LARGE = ("pyvista>=0.43", "open3d>=0.18", "polyscope>=2.2", "matplotlib>=3.6")
SMALL = ("click", "trimesh", "meshio", "tqdm", "joblib", "pytest", "hypothesis", "numpy", "scipy")


@pytest.fixture(scope="module")
def python() -> str:
    found = FOLDER / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
    if not found.exists():
        venv.create(FOLDER, with_pip=True)
    subprocess.run([found, "-m", "pip", "install", "-q", *SMALL, *LARGE], check=True)
    return str(found)


def test_with_all_of_them(python: str) -> None:
    paths = os.pathsep.join([str(Path(saddleback.__file__).parents[1]), str(ROOT)])
    done = subprocess.run(
        [python, "-m", "pytest", "-q", "-p", "no:dash", "tests/native/mesh/test_exchange.py"],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": paths, "SADDLEBACK_OTHER_PACKAGES": "all"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-4000:]
    assert "skipped" not in done.stdout

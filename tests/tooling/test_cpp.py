# SPDX-License-Identifier: MIT
"""The C++ library as others have it: its public headers, and an example built against an installed copy."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

import saddleback

ROOT = Path(__file__).resolve().parents[2]
INCLUDE = ROOT / "native/include"
UMBRELLA = INCLUDE / "saddleback/saddleback.h"
BUILD = Path(saddleback.__file__).parents[2]
LONGEST = 200  # lines that one reads in one sitting


def public_headers() -> list[Path]:
    return sorted(header for header in INCLUDE.rglob("*.h") if header != UMBRELLA)


def strangers(text: str) -> list[str]:
    """Return what a public header includes that neither the standard library, Eigen nor another public header is."""
    names = re.findall(r'^#include ([<"][^>"]+)[>"]', text, re.MULTILINE)
    return [name for name in names if not re.match(r'<([a-z_]+|Eigen/\w+)$|"saddleback/', name)]


def test_public_headers_include_no_others():
    wrong = {str(header.relative_to(INCLUDE)): strangers(header.read_text()) for header in public_headers()}
    assert not {name: found for name, found in wrong.items() if found}


def test_the_rule_of_public_headers_finds_what_it_forbids():
    text = '#include <vector>\n#include <Eigen/Core>\n#include "saddleback/job.h"\n#include "support/planar.h"\n'
    assert strangers(text + "#include <OpenMesh/Core.h>\n") == ['"support/planar.h', "<OpenMesh/Core.h"]


def test_public_headers_are_short():
    assert not [header.name for header in public_headers() if header.read_text().count("\n") > LONGEST]


def test_the_umbrella_holds_every_public_header():
    wanted = [header.relative_to(INCLUDE).as_posix() for header in public_headers()]
    assert re.findall(r'^#include "(.*)"$', UMBRELLA.read_text(), re.MULTILINE) == wanted


def run(*command: object) -> str:
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def installed(tmp_path_factory) -> Path:
    if not (BUILD / "CMakeCache.txt").exists():
        pytest.skip("the module was not built by CMake here")
    folder = tmp_path_factory.mktemp("installed")
    run("cmake", "--install", BUILD, "--prefix", folder, "--component", "cpp")
    assert {path.name for path in (folder / "share/licenses/saddleback").iterdir()} >= {"LICENSE", "OpenMesh.txt"}
    return folder


def test_the_example_runs_on_the_installed_library(installed, tmp_path):
    run("cmake", "-S", ROOT / "native/examples", "-B", tmp_path, f"-DCMAKE_PREFIX_PATH={installed}")
    run("cmake", "--build", tmp_path)
    said = run(tmp_path / "torus")
    found = re.fullmatch(r"farthest ([\d.]+)\ncells 100 area ([\d.]+) of ([\d.]+)\nstars 50\n", said)
    assert found is not None, said
    # From the outermost point: half way around along the outside is longer than along the top.
    assert 2.8 < float(found[1]) < 1.4 * 3.1416
    assert abs(float(found[2]) / float(found[3]) - 1) < 1e-8


def test_python_packages_hold_nothing_of_the_cpp_library(tmp_path):
    if not (BUILD / "CMakeCache.txt").exists():
        pytest.skip("the module was not built by CMake here")
    run("cmake", "--install", BUILD, "--prefix", tmp_path, "--component", "python")
    files = [path.relative_to(tmp_path) for path in tmp_path.rglob("*") if path.is_file()]
    assert [(path.parent.name, path.name.split(".")[0]) for path in files] == [("saddleback", "_saddleback")]
    assert 'install.components = ["python"]' in (ROOT / "pyproject.toml").read_text()

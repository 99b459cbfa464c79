# SPDX-License-Identifier: MIT
"""The source package: what is in it, and that strangers can build it.

Building takes minutes, so it is done only where SADDLEBACK_PACKAGING=all asks for it, as the workflows do.
"""

import os
import re
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

from tests.tooling.tracked import tracked

ROOT = Path(__file__).resolve().parents[2]
slow = pytest.mark.skipif(
    os.environ.get("SADDLEBACK_PACKAGING") != "all", reason="takes minutes: SADDLEBACK_PACKAGING=all"
)


def make_sdist(folder: Path) -> Path:
    """In a process of its own: the builder wants to stand in the project's root."""
    code = f"from scikit_build_core.build import build_sdist; build_sdist({str(folder)!r})"
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True, capture_output=True)
    (made,) = folder.glob("saddleback-*.tar.gz")
    return made


@pytest.fixture(scope="module")
def sdist(tmp_path_factory) -> Path:
    return make_sdist(tmp_path_factory.mktemp("sdist"))


def names(sdist: Path) -> set[str]:
    with tarfile.open(sdist) as archive:
        return {name.partition("/")[2] for name in archive.getnames()}


def test_holds_what_the_build_reads_and_nothing_else(sdist):
    needed = (
        "native/src/",
        "native/include/",
        "native/bindings/",
        "native/python/",
        "native/cmake/",
        "native/licenses/",
    )
    wanted = {name for name in tracked() if name.startswith(needed)} - {
        name for name in tracked() if name.startswith("native/cmake/platforms/")
    }
    wanted |= {"CMakeLists.txt", "native/CMakeLists.txt", "pyproject.toml", "README.md", "PKG-INFO"}
    wanted |= {"LICENSE", "native/LICENSE"}
    assert names(sdist) == wanted


def test_all_in_it_is_under_mit(sdist):
    with tarfile.open(sdist) as archive:
        texts = {item.name: archive.extractfile(item).read() for item in archive if item.isfile()}
    (about,) = (text.decode() for name, text in texts.items() if name.endswith("PKG-INFO"))
    assert "License-Expression: MIT\n" in about and "License-File: native/licenses/OpenMesh.txt\n" in about
    said = {line for text in texts.values() for line in re.findall(rb"SPDX-License-Identifier: (\S+)", text[:200])}
    assert said == {b"MIT"}


def test_a_stray_file_stays_out(tmp_path):
    stray = ROOT / "native/stray.o"
    stray.write_bytes(b"\x7fELF")
    try:
        assert "native/stray.o" not in names(make_sdist(tmp_path))
    finally:
        stray.unlink()


def test_the_same_bytes_again(sdist, tmp_path):
    assert make_sdist(tmp_path).read_bytes() == sdist.read_bytes()


def build_wheel(sdist: Path, folder: Path, *arguments: str, **variables: str) -> Path:
    """Build as a stranger would: a fresh environment, isolation, no settings of ours. Only the compiler remembers."""
    python = folder / "venv/bin/python"
    subprocess.run([sys.executable, "-m", "venv", folder / "venv"], check=True)
    (folder / "tmp").mkdir()
    environment = {**os.environ, "TMPDIR": str(folder / "tmp"), "CCACHE_BASEDIR": str(folder), **variables}
    environment["SOURCE_DATE_EPOCH"] = "1577836800"  # as addon/package and the workflows set it; else files have a date
    if subprocess.run(["which", "ccache"], capture_output=True, check=False).returncode == 0:
        environment["CMAKE_CXX_COMPILER_LAUNCHER"] = "ccache"
    command = [python, "-m", "pip", "wheel", "--no-deps", "--wheel-dir", folder / "out", *arguments, sdist]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
    (wheel,) = (folder / "out").glob("*.whl")
    return wheel


@pytest.fixture(scope="module")
def wheel(sdist, tmp_path_factory) -> Path:
    return build_wheel(sdist, tmp_path_factory.mktemp("isolated"))


@slow
def test_builds_in_isolation_and_works(wheel, tmp_path):
    subprocess.run([sys.executable, "-m", "venv", tmp_path / "venv"], check=True)
    python = tmp_path / "venv/bin/python"
    subprocess.run([python, "-m", "pip", "install", "-q", wheel], check=True)
    code = "import saddleback as sb; m = sb.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]); print(m.area)"
    done = subprocess.run([python, "-c", code], check=True, capture_output=True, text=True, cwd=tmp_path)
    assert done.stdout.strip() == "0.5"


@slow
def test_the_licenses_of_all_that_it_holds_are_in_the_wheel(wheel):
    licenses = {Path(name).name for name in zipfile.ZipFile(wheel).namelist() if ".dist-info/licenses/" in name}
    assert licenses == {"LICENSE", *(path.name for path in (ROOT / "native/licenses").iterdir())}


@slow
def test_builds_without_a_network_and_to_the_same_bytes(sdist, wheel, tmp_path):
    local = tmp_path / "local"
    download = [sys.executable, "-m", "pip", "download", "-q"]
    # What pyproject.toml and scikit-build-core ask for, and what native/cmake fetches where the system has none.
    wanted = ["scikit-build-core>=1.0,<2", "pybind11>=3.0,<4", "pip>=23", "cmake", "ninja", "cmeel-eigen==3.4.0.2"]
    subprocess.run([*download, "--dest", local, *wanted], check=True)
    subprocess.run([*download, "--dest", tmp_path, "--no-deps", "--no-binary", ":all:", "openmesh==1.2.1"], check=True)
    subprocess.run(["tar", "-xzf", tmp_path / "openmesh-1.2.1.tar.gz", "-C", tmp_path], check=True)
    offline = build_wheel(
        sdist,
        tmp_path,
        f"--config-settings=cmake.define.SADDLEBACK_OPENMESH_SOURCE={tmp_path / 'openmesh-1.2.1'}",
        PIP_NO_INDEX="1",  # variables, which the pip that CMake starts heeds as well; arguments stay with the first
        PIP_FIND_LINKS=str(local),
    )
    assert offline.read_bytes() == wheel.read_bytes()

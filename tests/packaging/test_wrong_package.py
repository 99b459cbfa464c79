# SPDX-License-Identifier: GPL-3.0-or-later
"""A package for another Python or system says in one sentence which file is right."""

import importlib
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import saddleback
from saddleback_blender.core import native


@pytest.fixture
def foreign(tmp_path):
    """The package as a wheel for another Python leaves it."""
    folder = tmp_path / "saddleback"
    folder.mkdir()
    for path in Path(saddleback.__file__).parent.glob("*.py"):
        shutil.copy(path, folder)
    (folder / "_saddleback.cp39-win_amd64.pyd").write_bytes(b"")
    (folder / "_saddleback.cpython-39-x86_64-linux-gnu.so").write_bytes(b"")
    return tmp_path


def last_line(code, path):
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, cwd=path)
    return done.stderr.strip().splitlines()[-1]


def test_the_module_names_the_wheel(foreign):
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    said = last_line("import saddleback", foreign)
    assert "_saddleback.cp39-win_amd64.pyd and _saddleback.cpython-39-x86_64-linux-gnu.so" in said
    assert f"install the wheel {python}-{python}-" in said


def test_the_add_on_names_the_zip(foreign, monkeypatch):
    monkeypatch.setattr(sys, "path", [str(foreign), *sys.path])
    for name in [name for name in sys.modules if name.partition(".")[0] == "saddleback"]:
        monkeypatch.delitem(sys.modules, name)
    with pytest.raises(native.NativeMissingError) as error:
        native.load()
    assert str(error.value).startswith("This package of Saddleback is not for Python 3.")
    assert f": install {native.right_package()}, then restart Blender" in str(error.value)


@pytest.mark.parametrize(
    ("python", "module", "system", "machine", "name"),
    [
        ((3, 10), "saddleback_blender.core.native", "Linux", "x86_64", "legacy-linux_x64"),
        ((3, 11), "saddleback_blender.core.native", "Windows", "AMD64", "legacy-windows_x64"),
        ((3, 11), "bl_ext.user_default.saddleback.core.native", "Windows", "AMD64", "windows_x64"),
        ((3, 13), "saddleback_blender.core.native", "Darwin", "arm64", "macos_arm64"),
        ((3, 13), "bl_ext.user_default.saddleback.core.native", "Linux", "aarch64", "linux_arm64"),
    ],
)
def test_which_zip_is_right(monkeypatch, python, module, system, machine, name):
    monkeypatch.setattr(sys, "version_info", python)
    monkeypatch.setattr(native, "__name__", module)
    monkeypatch.setattr(native.platform, "system", lambda: system)
    monkeypatch.setattr(native.platform, "machine", lambda: machine)
    assert native.right_package() == f"saddleback-{native.VERSION}-{name}.zip"


def test_the_version_is_the_librarys():
    assert importlib.import_module("saddleback").__version__ == native.VERSION

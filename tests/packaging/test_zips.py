# SPDX-License-Identifier: MIT
"""The packages for Blender, made of wheels that hold a word instead of a library."""

import ast
import sys
import zipfile
from pathlib import Path

import pytest
import tomllib

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "addon"))

import make_packages

VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]


@pytest.fixture
def wheels(tmp_path):
    """Wheels of all Pythons for a platform."""

    def make(platform="manylinux_2_28_x86_64", pythons=("cp310", "cp311", "cp312", "cp313")):
        made = []
        for python in pythons:
            made.append(tmp_path / f"saddleback-{VERSION}-{python}-{python}-{platform}.whl")
            with zipfile.ZipFile(made[-1], "w") as archive:
                archive.writestr("saddleback/__init__.py", "")
                archive.writestr(f"saddleback/_saddleback.{python}.so", python)
                archive.writestr(f"saddleback-{VERSION}.dist-info/METADATA", "")
        return made

    return make


@pytest.fixture
def dist(tmp_path, monkeypatch):
    monkeypatch.setattr(make_packages, "ROOT", tmp_path)
    monkeypatch.setattr(make_packages, "DIST", tmp_path / "dist")
    for name in ("LICENSE", "native", "addon", "pyproject.toml"):
        (tmp_path / name).symlink_to(ROOT / name)
    return tmp_path / "dist"


def contents(path):
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


@pytest.mark.parametrize(
    ("tag", "name"),
    [
        ("manylinux_2_28_x86_64", "linux_x64"),
        ("manylinux_2_27_aarch64.manylinux_2_28_aarch64", "linux_arm64"),
        ("macosx_11_0_arm64", "macos_arm64"),
        ("macosx_10_15_x86_64", "macos_x64"),
        ("win_amd64", "windows_x64"),
    ],
)
def test_the_names_are_blenders(dist, wheels, tag, name):
    make_packages.main(wheels(tag))
    zips = {path.name for path in dist.glob("*.zip")}
    assert zips == {f"saddleback-{VERSION}-{name}.zip", f"saddleback-{VERSION}-legacy-{name}.zip"}
    manifest = tomllib.loads(contents(dist / f"saddleback-{VERSION}-{name}.zip")["blender_manifest.toml"].decode())
    assert manifest["platforms"] == [name.replace("_", "-")]


def test_the_extension(dist, wheels):
    make_packages.main(wheels())
    files = contents(dist / f"saddleback-{VERSION}-linux_x64.zip")
    manifest = tomllib.loads(files["blender_manifest.toml"].decode())
    assert [name.split("-")[2] for name in manifest["wheels"]] == ["cp311", "cp313"]
    assert {name for name in files if name.endswith(".whl")} == {name[2:] for name in manifest["wheels"]}
    assert {"LICENSE", "licenses/OpenMesh.txt", "licenses/Eigen.txt", "licenses/pybind11.txt"} <= set(files)
    assert b"GNU GENERAL PUBLIC LICENSE" in files["LICENSE"] and b"MIT" in files["licenses/Saddleback-library.txt"]
    assert not any("__pycache__" in name for name in files)
    for name, data in files.items():
        if name.endswith(".py"):
            assert b"bl_info" not in data and b"sys.path" not in data, name


def test_the_legacy_zip(dist, wheels):
    make_packages.main(wheels())
    files = contents(dist / f"saddleback-{VERSION}-legacy-linux_x64.zip")
    assert {name.partition("/")[0] for name in files} == {"saddleback_blender"}
    libraries = {name.removeprefix("saddleback_blender/lib/") for name in files if "/lib/" in name}
    assert libraries == {
        "saddleback/__init__.py",
        "saddleback/_saddleback.cp310.so",
        "saddleback/_saddleback.cp311.so",
    }
    assert {f"saddleback_blender/licenses/{name}.txt" for name in ("OpenMesh", "Saddleback-library")} <= set(files)
    assert "saddleback_blender/blender_manifest.toml" not in files
    tree = ast.parse(files["saddleback_blender/__init__.py"])
    (info,) = (
        ast.literal_eval(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "bl_info"
    )
    assert info["blender"] == (3, 4, 0) and ".".join(map(str, info["version"])) == VERSION


def test_the_same_bytes_again(dist, wheels):
    made = wheels()
    make_packages.main(made)
    first = {path.name: path.read_bytes() for path in dist.iterdir()}
    for path in (ROOT / "addon/saddleback_blender").rglob("*.py"):
        path.touch()
    make_packages.main(made)
    assert {path.name: path.read_bytes() for path in dist.iterdir()} == first


def test_a_zip_without_a_library_is_not_made(dist, wheels):
    make_packages.main(wheels(pythons=("cp310", "cp312")))
    assert [path.name for path in dist.glob("*.zip")] == [f"saddleback-{VERSION}-legacy-linux_x64.zip"]


def test_what_was_made_for_other_platforms_stays(dist, wheels):
    make_packages.main(wheels("win_amd64"))
    make_packages.main(wheels())
    make_packages.main(wheels(pythons=("cp311",)))
    kept = {(path.name.split("-")[2], make_packages.platform_of(path)) for path in dist.glob("*.whl")}
    windows = {(python, "win_amd64") for python in ("cp310", "cp311", "cp312", "cp313")}
    assert kept == windows | {("cp311", "linux_x86_64")}
    assert len(list(dist.glob("*.zip"))) == 4

# SPDX-License-Identifier: MIT
"""The library and the package are under MIT, what needs Blender under the GPL; nothing under MIT needs GPL code."""

from __future__ import annotations

import ast
import re
import sys
from pathlib import Path

import pytest
import tomllib
from elftools.elf.elffile import ELFFile

import saddleback
from tests.tooling.tracked import tracked

ROOT = Path(__file__).resolve().parents[2]
MIT, GPL = "MIT", "GPL-3.0-or-later"
SOURCES = re.compile(r"\.(h|cpp|cuh?|pyi?|cmake|cmake\.in|sh)$|/CMakeLists\.txt$")
CPP = re.compile(r"native/.*\.(h|cpp|cuh?)$")
NEEDS_GPL = re.compile(
    r"^\s*(?:import|from) (?:bpy|bpy_extras|bmesh|mathutils|gpu|gpu_extras|addon_utils|saddleback_blender)\b"
    r"|^#include <CGAL/",
    re.MULTILINE,
)
# What the Python package may import, all of it but NumPy only where the user has it; none is under the GPL.
PERMISSIVE = {
    **dict.fromkeys(("numpy", "click", "dask", "distributed", "IPython"), "BSD-3-Clause"),
    **dict.fromkeys(("typer", "rich", "pyvista", "polyscope", "trimesh", "meshio", "open3d", "tqdm"), "MIT"),
    "matplotlib": "PSF-based",
}
# Folders of headers, and the parts of Eigen that are wholly under its MPL2. Headers that lie in no folder are the
# language's or the system's, whose libraries the test of the module's links would see.
INCLUDED = {"saddleback", "pybind11", "OpenMesh", "cub", "thrust", "sys"}
EIGEN = {f"Eigen/{part}" for part in ("Core", "Dense", "Geometry", "Eigenvalues")}
SYSTEM_LIBRARIES = re.compile(r"(lib(c|m|pthread|dl|rt|gcc_s|stdc\+\+)|ld-linux[-\w]*)\.so\.\d")


def sources() -> dict[str, str]:
    """Texts of all sources by name: scripts without a suffix are those with a `#!`."""
    found = {}
    for name in tracked():
        path = ROOT / name
        if path.is_file() and (SOURCES.search(name) or ("." not in path.name and path.read_bytes()[:2] == b"#!")):
            found[name] = path.read_text(encoding="utf-8")
    return found


def license_of(text: str) -> str | None:
    found = re.match(r"(?:#!.*\n)?(?://|#) SPDX-License-Identifier: (\S+)\n", text)
    return found and found[1]


def license_by_path(name: str) -> str:
    """Return what REUSE.toml says, whose last entry that fits counts."""
    found = ""
    for entry in tomllib.loads((ROOT / "REUSE.toml").read_text(encoding="utf-8"))["annotations"]:
        patterns = [entry["path"]] if isinstance(entry["path"], str) else entry["path"]
        if any(re.fullmatch(re.escape(p).replace(r"\*\*", ".*").replace(r"\*", "[^/]*"), name) for p in patterns):
            found = entry["SPDX-License-Identifier"]
    return found


TEXTS = sources()
LICENSES = {
    name: license_of(text) or (license_by_path(name) if CPP.search(name) else None) for name, text in TEXTS.items()
}


def imported(name: str) -> set[str]:
    """The modules that a Python file imports, absolutely."""
    found = set()
    for node in ast.walk(ast.parse(TEXTS[name])):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and not node.level:
            found |= {node.module or "", *(f"{node.module}.{alias.name}" for alias in node.names)}
    return found


def test_every_source_says_its_license() -> None:
    """In its first line, but C++, of which REUSE.toml tells."""
    assert len(TEXTS) > 1000
    assert not [name for name, found in LICENSES.items() if found not in (MIT, GPL)]


def test_the_library_is_mit_and_the_addon_gpl() -> None:
    assert not [name for name, found in LICENSES.items() if name.startswith("native/") and found != MIT]
    assert not [
        name for name, found in LICENSES.items() if name.startswith(("addon/", "blend-samples/")) and found != GPL
    ]


def test_nothing_under_mit_needs_what_is_under_the_gpl() -> None:
    modules = {name[:-3].replace("/", ".") for name, found in LICENSES.items() if found == GPL and name.endswith(".py")}
    for name, found in LICENSES.items():
        if found == MIT:
            assert not NEEDS_GPL.search(TEXTS[name]), name
            assert not name.endswith(".py") or not imported(name) & modules, name


@pytest.mark.parametrize(
    "text", ["import bpy", "    from saddleback_blender.core import runs", "#include <CGAL/Kernel.h>"]
)
def test_the_rule_sees_what_it_forbids(text: str) -> None:
    assert NEEDS_GPL.search(f"a = 1\n{text}\n")


def test_the_package_imports_what_anyone_may_use() -> None:
    known = {*sys.stdlib_module_names, *PERMISSIVE, "saddleback"}
    for name in (name for name in TEXTS if name.startswith("native/python/") and name.endswith((".py", ".pyi"))):
        strange = {module.split(".")[0] for module in imported(name)} - known
        assert not strange, f"{name} imports {strange}: under which license? PERMISSIVE lists what is known"


def test_the_library_includes_what_anyone_may_use() -> None:
    for name in (name for name in TEXTS if re.match(r"native/.*\.(h|cpp|cuh?)$", name)):
        for header in re.findall(r"^#include <([^>]+)>", TEXTS[name], re.MULTILINE):
            folder, _, _ = header.partition("/")
            known = folder in INCLUDED or header in EIGEN or folder == header
            assert known, f"{name} includes <{header}>: under which license?"


@pytest.mark.skipif(sys.platform != "linux", reason="reads ELF; tests/run is Linux")
def test_the_module_links_the_systems_own_libraries_alone() -> None:
    with Path(saddleback._saddleback.__file__).open("rb") as file:
        tags = ELFFile(file).get_section_by_name(".dynamic").iter_tags()
        needed = [tag.needed for tag in tags if tag.entry.d_tag == "DT_NEEDED"]
    assert needed and not [name for name in needed if not SYSTEM_LIBRARIES.fullmatch(name)]


def test_manifests_and_license_texts_agree() -> None:
    def read(name: str) -> str:
        return (ROOT / name).read_text(encoding="utf-8")

    for name in ("pyproject.toml", "native/cuda/pyproject.toml"):
        assert tomllib.loads(read(name))["project"]["license"] == MIT
        assert (ROOT / name).with_name("LICENSE").is_file(), "the wheel carries it"
    assert tomllib.loads(read("addon/saddleback_blender/blender_manifest.toml"))["license"] == [f"SPDX:{GPL}"]
    assert read("LICENSE") == read("native/LICENSE") == read("native/cuda/LICENSE")
    assert read("LICENSE").startswith("MIT License\n") and "GNU GENERAL PUBLIC LICENSE" in read("addon/LICENSE")
    assert "[MIT license](LICENSE)" in read("README.md") and "(addon/LICENSE)" in read("README.md")

# SPDX-License-Identifier: MIT
"""The arrows between the rooms point one way, and the versions agree."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest
import tomllib

import saddleback
from tests.tooling.tracked import tracked

ROOT = Path(__file__).resolve().parents[2]
ADDON = ROOT / "addon/saddleback_blender"


def modules(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*.py") if "lib" not in path.relative_to(folder).parts)


def imported(tree: ast.AST) -> Iterator[str]:
    """Yield the dotted names that a module imports, relative ones with their leading dots."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            name = "." * node.level + (node.module or "")
            yield name
            yield from (f"{name}{'' if name.endswith('.') else '.'}{alias.name}" for alias in node.names)


def offenders(paths: list[Path], wrong) -> list[str]:
    found = []
    for path in paths:
        names = imported(ast.parse(path.read_text(encoding="utf-8")))
        found += [f"{path.relative_to(ROOT)} imports {name}" for name in names if wrong(name)]
    return found


BLENDER = {"bpy", "bpy_extras", "bmesh", "mathutils", "gpu", "gpu_extras", "blf", "addon_utils"}


def is_blender(name: str) -> bool:
    return name.split(".")[0] in BLENDER


def leads_to(*rooms: str):
    """Tell whether a relative import goes out of its room into one of these."""
    pattern = re.compile(rf"^\.\.+({'|'.join(rooms)})(\.|$)")
    return lambda name: bool(pattern.match(name))


@pytest.mark.parametrize("room", ["core", "bridge", "ops", "ui"])
def test_the_rooms_exist(room):
    assert modules(ADDON / room), f"no module in {room}: the rules below would hold for nothing"


def test_core_never_imports_blender():
    assert not offenders(modules(ADDON / "core"), is_blender)


def test_core_knows_neither_bridge_nor_operators_nor_panels():
    assert not offenders(modules(ADDON / "core"), leads_to("bridge", "ops", "ui"))


def test_bridge_knows_neither_operators_nor_panels():
    assert not offenders(modules(ADDON / "bridge"), leads_to("ops", "ui"))


WRITING_CALLS = {"new", "remove", "foreach_set", "link", "unlink", "update_tag", "tag_redraw", "from_pydata"}


def writes(tree: ast.AST) -> Iterator[str]:
    """Yield what changes Blender's data inside a draw or poll function: assignments, writing calls, operators."""
    for function in (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)):
        if not (function.name == "poll" or function.name.startswith("draw")):
            continue
        for node in ast.walk(function):
            if isinstance(node, ast.Assign | ast.AugAssign):
                for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
                    text = ast.unparse(target)
                    if re.match(r"(context|bpy|obj|item|mesh|scene|settings)\b.*[.\[]", text):
                        yield f"line {node.lineno}: {text} = ..."
            elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                text = ast.unparse(node.func)
                if node.func.attr in WRITING_CALLS or text.startswith("bpy.ops."):
                    yield f"line {node.lineno}: {text}()"


def test_panels_only_draw():
    found = [
        f"{path.relative_to(ROOT)}, {what}"
        for path in modules(ADDON / "ui")
        for what in writes(ast.parse(path.read_text(encoding="utf-8")))
    ]
    assert not found


def test_the_rule_of_panels_finds_what_it_forbids():
    code = """
def draw(self, context):
    context.object.name = "x"
    context.object.data.attributes.new("a")
    bpy.ops.mesh.primitive_cube_add()
"""
    assert len(list(writes(ast.parse(code)))) == 3


@pytest.mark.parametrize("text", ["bpy.app.version", "hasattr(bpy"])
def test_blender_versions_are_told_apart_in_one_place(text):
    found = [
        str(path.relative_to(ROOT))
        for path in modules(ADDON)
        if path != ADDON / "compat.py" and text in path.read_text(encoding="utf-8")
    ]
    assert not found, f"{text} belongs into compat.py"


def test_no_absolute_import_of_the_addon_inside_it():
    """As an extension it is called bl_ext.user_default.saddleback."""
    assert not offenders(modules(ADDON), lambda name: name.split(".")[0] == "saddleback_blender")


def test_native_headers_know_neither_python_nor_openmesh():
    for header in (ROOT / "native/include").rglob("*.h"):
        text = header.read_text(encoding="utf-8")
        assert not re.search(r"#include\s*[<\"](Python\.h|pybind11|OpenMesh)", text), header
    for source in (ROOT / "native/src").rglob("*.*"):
        text = source.read_text(encoding="utf-8")
        assert not re.search(r"#include\s*[<\"](Python\.h|pybind11)", text), source
        if source.relative_to(ROOT / "native/src").parts[0] != "mesh":
            assert not re.search(r"#include\s*[<\"]OpenMesh", text), f"{source}: OpenMesh stays in mesh/"


def test_hypotenuses_are_measured_alike_on_every_system():
    """std::hypot rounds as the system's library does, and glibc's own since 2.35 shuts out older systems."""
    for source in [*(ROOT / "native/include").rglob("*.h"), *(ROOT / "native/src").rglob("*.*")]:
        assert "std::hypot(" not in source.read_text(encoding="utf-8"), f"{source}: support/hypotenuse.h has it"


def test_results_keep_others_alive_in_one_way():
    """pybind11 3.1 applies keep_alive<0, ...> also where it has refused the arguments, and crashes."""
    for source in (ROOT / "native/bindings").rglob("*.cpp"):
        assert "py::keep_alive<0" not in source.read_text(encoding="utf-8"), f"{source}: convert.h has keeping()"


ROOMS = ROOT / "native/src"
# From the ground up: a subfolder includes itself and those before it.
SUBFOLDERS = {
    "support": ["threads", "memory", "cuda", "simd"],
    "mesh": ["tables", "cutting", "read", "repair", "soup"],
    "voronoi2d": ["sites", "sweep", "diagram", "clipping", "weighted", "power", "cuda"],
    "geodesics": ["unfolding", "graph", "exact", "wavefront", "queries", "cuda"],
    "tessellation": ["bisectors", "log_map", "cells", "relaxation", "polygons", "baking"],
    "field": ["linear", "connection", "smoothing"],
    "distribution": ["check", "collision"],
}
# From the ground up as well: a room includes itself and those before it, but for the headers of the public door.
ORDER = ["support", "predicates", "mesh", "voronoi2d", "geodesics", "tessellation", "charts", "field"]
ORDER += ["shapes", "shape_mapping", "distribution"]


def native_sources() -> list[Path]:
    return sorted(path for path in ROOMS.rglob("*") if path.suffix in {".h", ".cpp", ".cu", ".cuh"})


def included(source: Path) -> list[str]:
    return re.findall(r'^#include "([^"]+)"', source.read_text(encoding="utf-8"), re.MULTILINE)


def place(path: str) -> tuple[str, str]:
    """Return the room and the subfolder ("" at the door) of a path within native/src."""
    parts = path.split("/")
    return parts[0], parts[1] if len(parts) == 3 else ""


def is_allowed(source: str, name: str) -> bool:
    (room, folder), (other, beneath) = place(source), place(name)
    if room != other:
        return ORDER.index(other) < ORDER.index(room)
    if not folder or folder == beneath:
        return True
    order = SUBFOLDERS[room]
    return beneath != "" and order.index(beneath) < order.index(folder)


def test_rooms_and_subfolders_are_those_of_the_plan():
    assert {path.name for path in ROOMS.iterdir() if path.is_dir()} == set(ORDER)
    for room in ORDER:
        folders = {path.name for path in (ROOMS / room).iterdir() if path.is_dir()}
        assert folders == set(SUBFOLDERS.get(room, [])), room


def test_includes_name_the_whole_path():
    """`"saddleback/room/x.h"` for the public headers, `"room/folder/x.h"` for the others."""
    for source in native_sources():
        for name in included(source):
            root = ROOT / "native/include" if name.startswith("saddleback/") else ROOMS
            assert (root / name).is_file(), f"{source.relative_to(ROOT)} includes {name}"


def test_includes_lead_downwards():
    wrong = [
        f"{source.relative_to(ROOMS)} includes {name}"
        for source in native_sources()
        for name in included(source)
        if not name.startswith("saddleback/") and not is_allowed(source.relative_to(ROOMS).as_posix(), name)
    ]
    assert not wrong, wrong


def test_the_rule_of_includes_finds_what_it_forbids():
    assert not is_allowed("geodesics/graph/a.cpp", "geodesics/queries/b.h")  # upwards
    assert not is_allowed("geodesics/graph/a.cpp", "geodesics/b.h")  # the door
    assert not is_allowed("geodesics/a.cpp", "tessellation/cells/b.h")  # a room above
    assert is_allowed("tessellation/cells/a.cpp", "geodesics/graph/b.h")


def test_namespaces_are_that_of_the_library_or_those_of_the_rooms():
    names = {"saddleback", "detail", *(f"saddleback::{room}" for room in ORDER)}
    for source in native_sources() + sorted((ROOT / "native/include").rglob("*.h")):
        found = set(re.findall(r"^namespace ([\w:]+) \{", source.read_text(encoding="utf-8"), re.MULTILINE))
        assert found <= names, f"{source.relative_to(ROOT)}: {found - names}"


MOST_FILES = 30
CROWDED = {"docs/images"}  # on its way down


def test_no_folder_grows_beyond_what_one_can_overlook():
    counts = Counter(str(Path(name).parent) for name in tracked())
    crowded = {folder: count for folder, count in counts.items() if count > MOST_FILES and folder not in CROWDED}
    assert not crowded


def test_no_binaries_are_tracked():
    for name in tracked():
        path = ROOT / name
        if path.suffix not in {".png", ".jpg", ".gif", ".svg", ".blend", ".npz"} and path.is_file():
            assert b"\0" not in path.read_bytes(), f"{name} is a binary"


def test_every_version_is_the_same():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    cuda = tomllib.loads((ROOT / "native/cuda/pyproject.toml").read_text())["project"]
    assert cuda["version"] == project and cuda["dependencies"] == [f"saddleback=={project}"]
    manifest = tomllib.loads((ADDON / "blender_manifest.toml").read_text())["version"]
    cmake = re.search(r"project\(saddleback VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())
    bl_info = re.search(r'"version": \((\d+), (\d+), (\d+)\)', (ADDON / "__init__.py").read_text())
    assert cmake is not None and bl_info is not None
    assert {project, manifest, cmake[1], ".".join(bl_info.groups()), saddleback.__version__} == {project}


def test_the_public_names_are_sorted_and_there():
    assert sorted(saddleback.__all__) == list(saddleback.__all__)
    assert all(hasattr(saddleback, name) for name in saddleback.__all__)

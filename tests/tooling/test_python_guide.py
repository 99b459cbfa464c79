# SPDX-License-Identifier: MIT
"""The examples of the Python guide run, page by page, on small meshes in place of the reader's."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BEGIN = """
import sys
sys.path.insert(0, {root!r})
import numpy as np
import saddleback as sb
from tests import meshes

def write(name, vertices, triangles):
    with open(name, "w") as file:
        file.write("".join("v {{}} {{}} {{}}\\n".format(*v) for v in vertices.tolist()))
        file.write("".join("f {{}} {{}} {{}}\\n".format(*t) for t in (triangles + 1).tolist()))

"""
LIZARD = 'write("lizard.obj", *meshes.saddle(25))\n'
# What a page takes for granted, and what takes too long there.
PAGES: dict[str, tuple[str, dict[str, str]]] = {
    "meshes": ("", {}),
    "points": ("", {}),
    "distances": (LIZARD, {"1000": "60"}),
    "cells": (
        LIZARD + "before = after = sb.triangle_quality(*meshes.icosphere(2))\n",
        {"900": "60", "annealing=300": "annealing=5"},
    ),
    "voronoi_2d": ('write("leaf.obj", *meshes.saddle(25))\n', {}),
    "fields": (
        "vertices, triangles = meshes.icosphere(3)\n"
        "north, south, places, values, start = 3, 17, [0, 9, 40], [1.0, 2.0, 5.0], 30\n"
        "given = sb.Mesh(vertices, triangles)\n"
        "graph = sb.SaddleVertexGraph(given)\n"
        "points, path = sb.sample(given, 5), sb.trace(given, 60, 0.3, 0.5)\n"
        "curve = sb.SurfaceCurve(given, path.surface)\n"
        "painted, pressure = given.face_areas > np.median(given.face_areas), np.ones(len(triangles))\n"
        "vectors = sb.direction_field(given).vectors\n",
        {},
    ),
    "exchange": (LIZARD, {}),
    "machines": (LIZARD, {}),
    "shapes": (
        "mesh = sb.Mesh(*meshes.icosphere(4))\n"
        "curve = sb.trace(mesh, 60, 0.3, 0.5)\n"
        "leaf_vertices, leaf_triangles = np.array([[0, 0, 0], [0.5, 0, 0], [0, 0.3, 0.1]]), np.array([[0, 1, 2]])\n"
        "the_same_mesh_deformed = sb.Mesh(1.1 * mesh.vertices, mesh.triangles)\n",
        {"[500, 200]": "[20, 10]", "size=0.02": "size=0.1"},
    ),
}


def examples(page: str) -> str:
    text = (ROOT / f"docs/python/{page}.md").read_text(encoding="utf-8")
    code = "\n".join(re.findall(r"```python\n(.*?)```", text, re.DOTALL))
    return re.sub(r'(read_\w+\(\W*"\w+)\.ply', r"\1.obj", code)  # what the page takes for granted is written as obj


def test_every_page_is_run() -> None:
    """All but the one that needs a CUDA device, the one of shell commands (test_command_line.py), and the contents."""
    assert {path.stem for path in (ROOT / "docs/python").glob("*.md")} == {*PAGES, "README", "cuda", "command_line"}


@pytest.mark.parametrize("page", PAGES)
def test_the_examples_run(page: str, tmp_path: Path) -> None:
    given, quicker = PAGES[page]
    code = examples(page)
    for slow, quick in quicker.items():
        assert slow in code
        code = code.replace(slow, quick)
    (tmp_path / "page.py").write_text(BEGIN.format(root=str(ROOT)) + given + code, encoding="utf-8")
    done = subprocess.run([sys.executable, "page.py"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr

# SPDX-License-Identifier: MIT
"""What the README shows, runs."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def examples() -> list[str]:
    return re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.DOTALL)


def test_the_python_example_runs_and_says_what_it_promises(tmp_path):
    (example,) = (code for code in examples() if "import saddleback" in code)
    done = subprocess.run([sys.executable, "-c", example], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    said = re.match(r"([\d.]+) = ([\d.]+) in (\d+) cells", done.stdout)
    assert said is not None, done.stdout
    area, whole, count = said.groups()
    assert abs(float(area) / float(whole) - 1) < 1e-9
    assert int(count) == 60


def test_the_blender_example_names_what_the_addon_has():
    """tests/addon_blender runs the operators; here the names of the example are compared with theirs."""
    (example,) = (code for code in examples() if "import bpy" in code)
    compile(example, "README.md", "exec")
    (call,) = re.findall(r"bpy\.ops\.saddleback\.(\w+)\((.*?)\)\n", example)
    addon = ROOT / "addon/saddleback_blender"
    files = [addon / "ops" / f"{call[0]}.py", *sorted((addon / "props").glob("*.py"))]
    source = "".join(file.read_text() for file in files)
    for name in re.findall(r"(\w+)=", call[1]):
        assert re.search(rf"\b{name}\b", source), f"{call[0]} has no property {name}"

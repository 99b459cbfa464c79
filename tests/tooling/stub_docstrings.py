# SPDX-License-Identifier: MIT
"""Puts the docstrings of the compiled module into its stub, where editors read them.

python -m tests.tooling.stub_docstrings

They are written once, in native/bindings; whatever docstring the stub has is replaced.
"""

from __future__ import annotations

import ast
import inspect
import re
import subprocess
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path

from saddleback import _saddleback

STUB = Path(__file__).resolve().parents[2] / "native/python/saddleback/_saddleback.pyi"
Definition = ast.ClassDef | ast.FunctionDef


def definitions(body: list[ast.stmt], owner: object) -> Iterator[tuple[Definition, str]]:
    """Yield classes, functions, methods and properties of the stub with the docstrings that the module has for them."""
    seen = set()
    for node in body:
        if isinstance(node, Definition):
            # Of overloads the first one gets it; what Python itself says of special methods tells nothing.
            tells = node.name not in seen and not node.name.startswith("__")
            seen.add(node.name)
            value = inspect.getattr_static(owner, node.name, None)
            yield node, docstring(value) if tells or node.name == "__init__" else ""
            if isinstance(node, ast.ClassDef):
                yield from definitions(node.body, value)


def docstring(value: object) -> str:
    """Return what is said of it, without the signature that pybind11 puts in front of it."""
    if isinstance(value, staticmethod):
        value = value.__func__
    said = value.__doc__ or ""
    if not isinstance(value, type | property):
        said = re.sub(r"\A\w+\(.*\) -> .*(?:\n|\Z)", "", said)
    return inspect.cleandoc(said)


def quoted(text: str, column: int) -> str:
    margin = " " * column
    raw = "r" if "\\" in text else ""
    end = "\n" + margin if "\n" in text else ""
    return f'{raw}"""{textwrap.indent(text, margin).strip()}{end}"""'


def with_docstrings(stub: str) -> str:
    """Return the text of a stub with the module's docstrings."""
    starts = [0, 0]  # of lines, counted from 1, in bytes as the syntax tree counts
    for line in stub.encode().splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    edits = []
    for node, said in definitions(ast.parse(stub).body, _saddleback):
        first = node.body[0]
        begin = starts[first.lineno] + first.col_offset
        end = starts[first.end_lineno or 0] + (first.end_col_offset or 0)
        column = node.col_offset + 4
        if not isinstance(first, ast.Expr):  # a class begins with what it holds, decorated or not
            begin = end = starts[min([first.lineno, *(part.lineno for part in getattr(first, "decorator_list", []))])]
            edits.append((begin, end, " " * column + quoted(said, column) + "\n" if said else ""))
        else:
            is_only = len(node.body) == 1
            new = f"\n{' ' * column}{quoted(said, column)}" if said else "..." if is_only else ""
            edits.append((begin, end, new))
    text = stub.encode()
    for begin, end, new in sorted(edits, reverse=True):
        text = text[:begin] + new.encode() + text[end:]
    command = [Path(sys.executable).with_name("ruff"), "format", "--quiet", "--stdin-filename", STUB, "-"]
    return subprocess.run(command, input=text, capture_output=True, check=True).stdout.decode()


if __name__ == "__main__":
    STUB.write_text(with_docstrings(STUB.read_text(encoding="utf-8")), encoding="utf-8")

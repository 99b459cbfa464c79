# SPDX-License-Identifier: MIT
"""The signatures in docs/algorithms, as the package's stub has them: `python -m tests.tooling.signatures` writes them.

A page names what it shows in a line ``<!-- signatures: name, Class.method -->`` before a block of Python.
"""

from __future__ import annotations

import ast
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted((ROOT / "docs/algorithms").glob("*.md"))
STUB = ROOT / "native/python/saddleback/_saddleback.pyi"
BLOCK = re.compile(r"<!-- signatures: (.*?) -->\n```python\n.*?```\n", re.DOTALL)
WIDTH = 112


def functions() -> dict[str, ast.FunctionDef]:
    """Functions by name, methods as Class.method, constructors by the name of their class."""
    found: dict[str, ast.FunctionDef] = {}
    for node in ast.parse(STUB.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef):
            found[node.name] = node
        elif isinstance(node, ast.ClassDef):
            for part in node.body:
                if isinstance(part, ast.FunctionDef):
                    found.setdefault(node.name if part.name == "__init__" else f"{node.name}.{part.name}", part)
    return found


def parameters(node: ast.FunctionDef) -> list[str]:
    """As they are written, without types."""
    given = node.args
    plain = [argument.arg for argument in given.args if argument.arg != "self"]
    defaults = dict(zip(plain[len(plain) - len(given.defaults) :], given.defaults, strict=True))
    defaults |= {a.arg: d for a, d in zip(given.kwonlyargs, given.kw_defaults, strict=True) if d is not None}
    names = [*plain, *([f"*{given.vararg.arg}"] if given.vararg else []), *(["*"] if given.kwonlyargs else [])]
    names += [argument.arg for argument in given.kwonlyargs]
    return [name + (f"={ast.unparse(defaults[name])}" if name in defaults else "") for name in names]


def signature(name: str, node: ast.FunctionDef) -> str:
    is_class = name.rsplit(".", maxsplit=1)[-1][0].isupper()
    returned = (
        "" if is_class else " -> " + re.sub("_Floats|_Indices", "array", ast.unparse(node.returns or ast.Name("None")))
    )
    given = [part.replace("'", '"') for part in parameters(node)]
    line = f"sb.{name}({', '.join(given)}){returned}"
    if len(line) <= WIDTH:
        return line
    lines = [""]
    for part in given:
        if len(lines[-1]) + len(part) > WIDTH - 8:
            lines.append("")
        lines[-1] += f" {part}," if lines[-1] else f"{part},"
    return "\n".join([f"sb.{name}(", *(f"    {one}" for one in lines), f"){returned}"])


def with_signatures(page: str) -> str:
    known = functions()

    def block(match: re.Match[str]) -> str:
        shown = "\n".join(signature(name, known[name]) for name in match[1].split(", "))
        return f"<!-- signatures: {match[1]} -->\n```python\n{shown}\n```\n"

    return BLOCK.sub(block, page)


if __name__ == "__main__":
    for path in PAGES:
        path.write_text(with_signatures(path.read_text(encoding="utf-8")), encoding="utf-8")

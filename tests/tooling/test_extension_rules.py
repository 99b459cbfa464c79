# SPDX-License-Identifier: MIT
"""What the extensions site forbids, and that docs/releasing.md points at what it says."""

import ast
import re
from pathlib import Path

import pytest

from tests.tooling.cited_lines import PAGE, corrected

ROOT = Path(__file__).resolve().parents[2]
ADDON = ROOT / "addon/saddleback_blender"

FORBIDDEN_MODULES = re.compile(r"(socket|urllib|http|ftplib|requests|aiohttp|subprocess|pip|ensurepip)(\.|$)")
FORBIDDEN_NAMES = re.compile(r"(sys\.path|__file__|os\.system|os\.popen|exec|eval|__import__)$")


def offences(tree: ast.AST):
    """Yield what a module imports or names of it."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if FORBIDDEN_MODULES.match(alias.name))
        elif isinstance(node, ast.ImportFrom) and not node.level and FORBIDDEN_MODULES.match(node.module or ""):
            yield node.module
        elif isinstance(node, ast.Attribute | ast.Name) and FORBIDDEN_NAMES.match(ast.unparse(node)):
            yield ast.unparse(node)


@pytest.mark.parametrize("path", sorted(ADDON.rglob("*.py")), ids=lambda path: path.relative_to(ADDON).as_posix())
def test_the_extension_does_not(path):
    assert not list(offences(ast.parse(path.read_text(encoding="utf-8"))))


def test_the_rule_finds_what_it_forbids():
    code = (
        "import urllib.request\nfrom requests import get\nsys.path.append(__file__)\nfrom .core.requests import Points"
    )
    assert set(offences(ast.parse(code))) == {"urllib.request", "requests", "sys.path", "__file__"}


def test_the_page_points_at_what_it_says():
    page = PAGE.read_text(encoding="utf-8")
    assert len(re.findall(r":\d+`: `", page)) > 12
    assert corrected(page) == page, "lines moved: python -m tests.tooling.cited_lines"

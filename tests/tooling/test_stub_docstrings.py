# SPDX-License-Identifier: MIT
"""Editors show the docstrings of the compiled module, which its stub repeats."""

from __future__ import annotations

import ast

import saddleback
from tests.tooling.stub_docstrings import STUB, with_docstrings

TEXT = STUB.read_text(encoding="utf-8")


def test_the_stub_says_what_the_module_says() -> None:
    assert with_docstrings(TEXT) == TEXT, "python -m tests.tooling.stub_docstrings writes the docstrings"


def test_every_public_class_and_function_says_something() -> None:
    documented = ast.ClassDef | ast.FunctionDef
    nodes = [node for node in ast.parse(TEXT).body if isinstance(node, documented) and node.name in saddleback.__all__]
    assert len(nodes) > 80
    assert not [node.name for node in nodes if not ast.get_docstring(node)]

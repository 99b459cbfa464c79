# SPDX-License-Identifier: MIT
"""The package as a whole: its names, errors, types and documentation."""

import ast
import inspect
from pathlib import Path

import pytest

import saddleback as sb
from saddleback import _saddleback


def test_errors_derive_as_promised():
    assert sb.Error.__bases__ == (Exception,)
    assert sb.MeshError.__bases__ == sb.InputError.__bases__ == (sb.Error, ValueError)
    assert sb.Cancelled.__bases__ == sb.DeviceError.__bases__ == (sb.Error,)
    assert sb.VersionError.__bases__ == (sb.InputError,)
    assert {e.__module__ for e in (sb.Error, sb.MeshError, sb.InputError, sb.Cancelled, sb.DeviceError)} == {
        "saddleback"
    }


def test_all_names_exist_and_are_sorted_for_reading():
    for name in sb.__all__:
        assert hasattr(sb, name)
    assert len(set(sb.__all__)) == len(sb.__all__)


def test_version():
    assert sb.__version__ == _saddleback.__version__
    assert sb.__version__.count(".") == 2


def stub_names(body):
    defined = (node.name for node in body if isinstance(node, ast.ClassDef | ast.FunctionDef))
    return {name for name in defined if not name.startswith("_")}


def test_type_stub_knows_everything_public():
    package = Path(sb.__file__).parent
    assert (package / "py.typed").exists()
    stub = ast.parse((package / "_saddleback.pyi").read_text(encoding="utf-8"))
    public = {name for name in vars(_saddleback) if not name.startswith("_")}
    assert stub_names(stub.body) == public
    for node in stub.body:
        if not isinstance(node, ast.ClassDef) or node.name == "predicates":
            continue
        members = {name for name in vars(getattr(_saddleback, node.name)) if not name.startswith("_")}
        assert stub_names(node.body) == members, node.name


@pytest.mark.parametrize("name", ["Mesh", "repair", "read_mesh", "read_arrays", "progress_bar"])
def test_documentation_tells_errors_and_shapes(name):
    doc = inspect.getdoc(getattr(sb, name))
    assert doc
    assert "Parameters" in doc

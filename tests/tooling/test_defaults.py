# SPDX-License-Identifier: GPL-3.0-or-later
"""An option's default is the same wherever it is written down: property, settings, binding, stub."""

from __future__ import annotations

import ast
import importlib
import math
import sys
from dataclasses import fields
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import saddleback
from saddleback_blender.core import settings as kept
from tests.tooling.signatures import functions

ROOT = Path(__file__).resolve().parents[2]
SETTINGS = {
    "tessellate": kept.TessellateSettings,
    "distance": kept.DistanceSettings,
    "path": kept.PathSettings,
    "ribbon": kept.RibbonSettings,
    "voronoi_2d": kept.Voronoi2dSettings,
    "direction_field": kept.DirectionFieldSettings,
    "distribute": kept.DistributeSettings,
    "repair": kept.RepairSettings,
}
# What each operator calls, and what it calls by another name.
CALLED = {
    "tessellate": ("centroidal_voronoi", "GeodesicVoronoi.dual", "SaddleVertexGraph"),
    "distance": ("SaddleVertexGraph", "SaddleVertexGraph.distances"),
    "path": ("SaddleVertexGraph", "SaddleVertexGraph.path"),
    "voronoi_2d": ("sample", "Voronoi2d.clip", "relax_2d"),
    "direction_field": ("direction_field",),
    "distribute": ("distribute", "MappedShapes.bend"),
    "repair": ("repair",),
}
RENAMED = {
    "tessellate.iterations": "centroidal_voronoi.max_iterations",
    "tessellate.keep_count": "centroidal_voronoi.closed_ball",
    "tessellate.dual_policy": "GeodesicVoronoi.dual.policy",
    "tessellate.sharp_angle": "feature_curves.angle",
    "voronoi_2d.iterations": "relax_2d.max_iterations",
    "direction_field.hard_strokes": "Stroke.hard",
    "direction_field.stroke_weight": "Stroke.weight",
    "distribute.fit": "MappedShapes.bend.tolerance",
    "repair.close_cracks": "repair.stitch",
}
# Where an artist is better served by another start than a script, and by which.
ON_PURPOSE = {
    "tessellate.count": (200, None),  # a script gives either sites or their number
    "tessellate.iterations": (15, 100),  # even enough to look at, in a seventh of the time
    "tessellate.keep_count": (True, False),  # only a run that makes a dual mesh asks for it
    "path.shorten": (True, False),  # a curve that is seen is wanted straight
    "distribute.size": (0.0, 1.0),  # 0 is by the count, which the add-on finds
    "voronoi_2d.iterations": (0, 100),  # chosen sites stay where they are
}


def default_of(node: ast.expr) -> Any:
    """Evaluate a default as a signature shows it."""
    return eval(ast.unparse(node), {"inf": math.inf, "nan": math.nan})  # a literal, of our own module


def defaults_of(function: ast.FunctionDef) -> dict[str, ast.expr]:
    given = function.args
    plain = given.args[len(given.args) - len(given.defaults) :]
    found = {argument.arg: default for argument, default in zip(plain, given.defaults, strict=True)}
    return found | {a.arg: d for a, d in zip(given.kwonlyargs, given.kw_defaults, strict=True) if d is not None}


def built_in(name: str) -> dict[str, Any]:
    """Return the defaults of a function of the built module, by parameter."""
    found: Any = saddleback._saddleback
    for part in name.split("."):
        found = getattr(found, part)
    doc = (found.__init__ if isinstance(found, type) else found).__doc__
    (function,) = ast.parse(f"def {doc.splitlines()[0]}: ...").body
    assert isinstance(function, ast.FunctionDef)
    return {parameter: default_of(default) for parameter, default in defaults_of(function).items()}


def test_the_stub_tells_what_the_module_does():
    compared = 0
    for name, function in functions().items():
        told = {key: node for key, node in defaults_of(function).items() if ast.unparse(node) != "..."}
        does = built_in(name) if told else {}
        wrong = {key: does.get(key) for key, node in told.items() if key not in does or default_of(node) != does[key]}
        assert not wrong, f"{name}: {wrong}"
        compared += len(told)
    assert compared > 150


@pytest.fixture
def properties(monkeypatch) -> dict[str, dict[str, Any]]:
    """Return the keywords of every property, from modules that take this for Blender."""
    bpy, kinds, props = ModuleType("bpy"), ModuleType("bpy.props"), ModuleType("saddleback_blender.props")
    for kind in ("Bool", "Enum", "Float", "Int", "String"):
        setattr(kinds, f"{kind}Property", lambda **keywords: keywords)
    props.__path__ = [str(ROOT / "addon/saddleback_blender/props")]  # its files, without what needs Blender's types
    modules = {name: module for name, module in sys.modules.items() if not name.startswith(props.__name__)}
    monkeypatch.setattr(sys, "modules", {**modules, "bpy": bpy, "bpy.props": kinds, props.__name__: props})
    return {name: getattr(importlib.import_module(f"{props.__name__}.{name}"), name.upper()) for name in SETTINGS}


def test_properties_begin_as_settings_do(properties):
    for name, kind in SETTINGS.items():
        begins = {key: keywords["default"] for key, keywords in properties[name].items()}
        assert begins == {field.name: field.default for field in fields(kind)}, name


def library_defaults(operator: str) -> dict[str, Any]:
    """Return the defaults of what the library is asked for, by the operator's names."""
    found: dict[str, Any] = {}
    names = {field.name for field in fields(SETTINGS[operator])}
    for function in CALLED[operator]:
        found |= {key: default for key, default in built_in(function).items() if key in names}
    for ours, theirs in RENAMED.items():
        if ours.startswith(f"{operator}."):
            function, parameter = theirs.rsplit(".", 1)
            found[ours.split(".")[1]] = built_in(function)[parameter]
    return found


def alike(ours: Any, theirs: Any) -> bool:
    """Blender has no None and no infinity: 0, an empty name and such words stand for them. Words are in capitals."""
    if theirs in (None, (), math.inf):
        return ours in (0, "", "AUTO", "NONE")
    return ours.lower() == str(theirs).lower() if isinstance(ours, str) else bool(ours == theirs)


@pytest.mark.parametrize("operator", CALLED)
def test_the_addon_begins_as_the_library_does(operator):
    theirs = library_defaults(operator)
    ours = {field.name: field.default for field in fields(SETTINGS[operator]) if field.name in theirs}
    different = {f"{operator}.{key}": (ours[key], theirs[key]) for key in ours if not alike(ours[key], theirs[key])}
    assert different == {key: pair for key, pair in ON_PURPOSE.items() if key.startswith(f"{operator}.")}
    assert ours

# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that nobody pressed: the phases of a run (reading, computing, writing) without a window or Undo."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import bpy
import numpy as np

from .. import jobs
from ..bridge.inputs.source import Source
from ..core import runs
from ..core.progress import Progress
from ..core.requests import content_of
from ..props import PROPERTIES
from .base import SurfaceOperator
from .direction_field import FieldOperator, SADDLEBACK_OT_direction_field
from .distance import DistanceOperator, SADDLEBACK_OT_distance
from .distribute import SADDLEBACK_OT_distribute, ShapesOperator
from .path import PathOperator, SADDLEBACK_OT_path
from .ribbon import RibbonOperator, SADDLEBACK_OT_ribbon
from .tessellate import CellsOperator, SADDLEBACK_OT_tessellate
from .voronoi_2d import PlaneOperator, SADDLEBACK_OT_voronoi_2d

# The phases of each kind of run, and the operator whose they are.
KINDS: dict[str, tuple[type[SurfaceOperator], Any]] = {
    "direction_field": (FieldOperator, SADDLEBACK_OT_direction_field),
    "tessellate": (CellsOperator, SADDLEBACK_OT_tessellate),
    "distance": (DistanceOperator, SADDLEBACK_OT_distance),
    "path": (PathOperator, SADDLEBACK_OT_path),
    "ribbon": (RibbonOperator, SADDLEBACK_OT_ribbon),
    "voronoi_2d": (PlaneOperator, SADDLEBACK_OT_voronoi_2d),
    "distribute": (ShapesOperator, SADDLEBACK_OT_distribute),
}


class Quiet:
    """Mixin: stands for what Blender gives to an operator. Settings are those that the panel shows."""

    settings_name: str
    use_modifiers: bool
    _prepare: Callable[..., tuple[bpy.types.Object, Callable[[Progress], Any]]]
    _refuse: Callable[..., set[str]]
    _end: Callable[..., set[str]]
    _task: jobs.Task | None

    def __init__(self) -> None:
        for name, prop in PROPERTIES[self.settings_name].items():
            value = prop.keywords["default"]
            setattr(self, name, float(np.float32(value)) if isinstance(value, float) else value)  # as Blender keeps it
        self.properties = SimpleNamespace(is_property_set=lambda _name: False)
        self.options = SimpleNamespace(is_invoke=True, is_repeat=False)
        self.errors: list[str] = []
        self.content = ""  # of what was read
        self.shape = ""  # of the surface that was read
        self._is_filled, self._others = False, list[str]()

    def report(self, level: set[str], text: str) -> None:
        """Keeps what a person has to know."""
        if "ERROR" in level:
            self.errors.append(text)

    def read(self, context: bpy.types.Context) -> Callable[[Progress], Any] | None:
        """Reads everything from Blender; None where it cannot be used, which is told in `errors`."""
        try:
            source, call = self._prepare(context, True)
            self._source = Source.of(context, source, getattr(self, "use_modifiers", False))
        except Exception as error:
            self._refuse(error, context)
            return None
        self.content, self.shape = content_of(call), self._source.content
        return call

    def start(self, call: Callable[[Progress], Any]) -> None:
        """Begins to compute, in a thread."""
        self._task = jobs.start_unseen(call, runs.new_progress(), self._source.name)

    @property
    def task(self) -> jobs.Task:
        """What computes."""
        assert self._task is not None
        return self._task

    def finish(self, context: bpy.types.Context) -> bool:
        """Writes what was computed, as a whole or not at all; says whether."""
        return self._end(context, self.task) == {"FINISHED"}


def quiet(settings_name: str) -> Any:
    """Makes such an operator."""
    phases, operator = KINDS[settings_name]
    return type(f"Quiet {operator.bl_label}", (Quiet, phases), {"bl_label": operator.bl_label})()

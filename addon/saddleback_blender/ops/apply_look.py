# SPDX-License-Identifier: GPL-3.0-or-later
"""`saddleback.apply_look`: one click, one picture; it asks one of the other operators, with the look's settings."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy

from .. import jobs
from ..bridge.inputs.source import usable_source, why_not
from ..core.errors import BadInputError
from ..looks import LOOKS, of_operator
from ..props import BEGIN, PROPERTIES, existing_group
from ..props.kinds import any_look


class LookOperator:
    """Mixin: asks another operator, which can be watched, stopped, adjusted and undone as ever."""

    report: Callable[..., None]

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether there is a mesh to work on. A button that turned gray during its run would stay dead after."""
        problem = why_not(context)
        if problem:
            cls.poll_message_set(problem)  # type: ignore[attr-defined]  # of bpy.types.Operator
        return not problem

    def wanted(self, context: bpy.types.Context) -> tuple[str, dict[str, Any]]:
        """The operator and its settings. Raises BadInputError."""
        raise NotImplementedError

    def ask(self, context: bpy.types.Context, how: str) -> set[str]:
        """Calls the other operator; its errors are this one's."""
        try:
            if jobs.state.task is not None:
                raise BadInputError(f"{jobs.state.task.name} is being computed: wait, or press ESC")
            operator, values = self.wanted(context)
            answer: set[str] = getattr(bpy.ops.saddleback, operator)(how, **values)
        except (BadInputError, RuntimeError, TypeError) as error:
            self.report({"ERROR"}, str(error).removeprefix("Error: ").strip())
            return {"CANCELLED"}
        # A run that goes on ends as the other operator's, and that is what can be undone.
        return {"CANCELLED"} if answer == {"RUNNING_MODAL"} else answer


class SADDLEBACK_OT_apply_look(LookOperator, bpy.types.Operator):
    """Applies a look."""

    bl_idname = "saddleback.apply_look"
    bl_label = "Apply Look"
    bl_description = "Cover the active object with a finished look"
    bl_options = {"REGISTER", "UNDO"}
    __annotations__ = {"look": any_look()}

    @classmethod
    def description(cls, _context: bpy.types.Context, properties: Any) -> str:
        """Says what the one look is."""
        return LOOKS[properties.look].description

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Computes and writes before it returns: scripts and the redo panel."""
        return self.ask(context, "EXEC_DEFAULT")

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Starts the run: the panel."""
        return self.ask(context, "INVOKE_DEFAULT")

    def wanted(self, context: bpy.types.Context) -> tuple[str, dict[str, Any]]:
        """The look's settings and, for what only other looks set, what the panel begins with."""
        look = LOOKS[self.look]
        group, begin = existing_group(usable_source(context), look.operator), BEGIN[look.operator]
        free = {name for name in begin if group is None or not group.is_property_set(name)}
        owned = {name for other in of_operator(look.operator).values() for name in other.settings}
        values = {name: begin.get(name, PROPERTIES[look.operator][name].keywords["default"]) for name in free | owned}
        return look.operator, {**values, "lengths": "RELATIVE", **look.settings, "look": self.look}


CLASSES = (SADDLEBACK_OT_apply_look,)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks of the artist's own, in Blender's preset menu and the folder of its presets."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import Any

import bpy
from bl_operators.presets import AddPresetBase
from bpy.props import BoolProperty, StringProperty

from .. import jobs
from ..bridge.inputs.source import active_object, usable_source
from ..bridge.outputs.out_looks import ROLES
from ..core.errors import BadInputError
from ..looks import NO_LOOK
from ..props import COLLECTION_NAMES, IMAGE_NAMES, OBJECT_NAMES, PROPERTIES, existing_group
from .apply_look import LookOperator

PRESET_FOLDER = "saddleback/looks"  # below Blender's presets
# What belongs to one object and not to a look.
OWN = (
    *OBJECT_NAMES,
    *COLLECTION_NAMES,
    *IMAGE_NAMES,
    "density_",
    "sites_",
    "sources",
    "forbidden_",
    "region",
    "barriers",
    "mirror_x",
)
LINE = re.compile(r"settings\.(\w+)\.(\w+) = (.+)")


class SADDLEBACK_OT_look_preset_add(AddPresetBase, bpy.types.Operator):
    """Saves a look."""

    bl_idname = "saddleback.look_preset_add"
    bl_label = "Add Look Preset"
    bl_description = "Keep the settings of the active object's look, or remove a look that was kept"
    preset_menu = "SADDLEBACK_PT_look_presets"
    preset_subdir = PRESET_FOLDER
    preset_defines = ("settings = bpy.context.object.saddleback",)

    @property
    def preset_values(self) -> list[str]:
        """Returns what is saved."""
        operator = _shown(active_object(bpy.context))
        return [f"settings.{operator}.{name}" for name in PROPERTIES[operator] if not name.startswith(OWN)]


class SADDLEBACK_OT_run_preset(LookOperator, bpy.types.Operator):
    """Applies a look that was saved."""

    bl_idname = "saddleback.run_preset"
    bl_label = "Apply Look Preset"
    bl_description = "Cover the active object with a look that was kept"
    bl_options = {"REGISTER", "UNDO"}
    __annotations__ = {
        "filepath": StringProperty(name="File", description="Of the preset", subtype="FILE_PATH"),
        "wait": BoolProperty(name="Wait", description="Compute before returning, as a script wants it", default=True),
    }

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Runs the look: a panel of presets calls this, too."""
        return self.ask(context, "EXEC_DEFAULT" if self.wait else "INVOKE_DEFAULT")

    def wanted(self, context: bpy.types.Context) -> tuple[str, dict[str, Any]]:
        """The operator and its settings."""
        usable_source(context)
        return read_preset(Path(self.filepath))


def _shown(source: bpy.types.Object) -> str:
    """The operator of the object's look, or the one that ran last, or the first."""
    groups = {name: existing_group(source, name) for name in ROLES}
    looks = [name for name, group in groups.items() if group is not None and group.look != NO_LOOK]
    return next(iter([*looks, *(name for name in ROLES if name == jobs.state.kind), *ROLES]))


def read_preset(path: Path) -> tuple[str, dict[str, Any]]:
    """The operator and the settings that it knows. Raises BadInputError for what is no preset of ours."""
    try:
        lines = [found.groups() for found in map(LINE.fullmatch, path.read_text("utf-8").splitlines()) if found]
        operators = {operator for operator, _, _ in lines}
        if len(operators) != 1 or not operators <= set(ROLES):
            raise BadInputError(f"'{path.name}' is no look that Saddleback kept; remove it from the presets")
        (operator,) = operators
        values = {name: ast.literal_eval(value) for _, name, value in lines if name in PROPERTIES[operator]}
    except (OSError, UnicodeDecodeError, SyntaxError, ValueError) as error:
        raise BadInputError(f"'{path.name}' cannot be read as a look: {error}") from error
    return operator, values


CLASSES = (SADDLEBACK_OT_look_preset_add, SADDLEBACK_OT_run_preset)

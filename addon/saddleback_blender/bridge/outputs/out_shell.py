# SPDX-License-Identifier: GPL-3.0-or-later
"""The lamp shell as a mesh object."""

from __future__ import annotations

import math

import bpy
import numpy as np

from ... import compat, nodes
from ...core.results import CellsResult, LampShell
from ...core.settings import TessellateSettings
from ...finishes import material_of
from ...looks import NO_LOOK
from ..inputs.mesh_in import level_place
from .following import Follower
from .out_attributes import set_attribute
from .out_collection import replace_object

SHELL_ROLE = "shell"
WALL_ATTRIBUTE = "saddleback_wall"  # how thick the solid is, in world units
WHOLE, THIN = (0.6, 0.6, 0.6, 1.0), (0.79, 0.004, 0.002, 1.0)  # linear
CREASE_ANGLE = math.radians(50.0)  # of the ribs' sides against their faces


def write_shell(
    context: bpy.types.Context,
    source: bpy.types.Object,
    result: CellsResult,
    settings: TessellateSettings,
    follower: Follower | None = None,
) -> bpy.types.Object:
    """Makes or replaces the source's lamp shell; its lengths are world units whatever the source's scale."""
    assert result.shell is not None
    shell, place = result.shell, level_place(source)
    mesh = bpy.data.meshes.new("Saddleback Shell")
    mesh.vertices.add(len(shell.vertices))
    compat.write_positions(mesh, shell.vertices.astype(np.float32))
    compat.write_corners(mesh, shell.triangles)
    mesh.update(calc_edges=True)
    compat.shade_smooth_by_angle(mesh, CREASE_ANGLE)
    set_attribute(mesh, WALL_ATTRIBUTE, "POINT", shell.wall.astype(np.float32))
    material = material_of(settings.look, nodes.edges_material)
    _paint_thinner(mesh, shell, material.diffuse_color[:] if settings.look != NO_LOOK else WHOLE)
    mesh.materials.append(material)
    item = replace_object(context, source, SHELL_ROLE, mesh, place)
    if follower is not None:
        follower.take(item, place, shell.vertices, shell.feet)
    return item


def _paint_thinner(mesh: bpy.types.Mesh, shell: LampShell, whole: tuple[float, ...]) -> None:
    """Shows in Solid view where there was no room for the whole thickness: red there, `whole` (linear) elsewhere."""
    color = mesh.color_attributes.new(nodes.COLOR_ATTRIBUTE, "BYTE_COLOR", "POINT")
    rgba = np.where(shell.is_thinner[:, None], THIN, whole).astype(np.float32)
    color.data.foreach_set("color", rgba.ravel())
    compat.show_color(mesh, nodes.COLOR_ATTRIBUTE)

"""The lamp shell as a mesh object."""

from __future__ import annotations

import math

import bpy
import numpy as np

from ... import compat, nodes
from ...core.results import CellsResult
from ...core.settings import TessellateSettings
from ...finishes import material_of
from .following import Follower
from .out_collection import level_place, replace_object, to_place

SHELL_ROLE = "shell"
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
    compat.write_positions(mesh, to_place(place, shell.vertices).astype(np.float32))
    compat.write_corners(mesh, shell.triangles)
    mesh.update(calc_edges=True)
    compat.shade_smooth_by_angle(mesh, CREASE_ANGLE)
    mesh.materials.append(material_of(settings.look, nodes.edges_material))
    item = replace_object(context, source, SHELL_ROLE, mesh, place)
    if follower is not None:
        follower.take(item, place, shell.vertices, shell.feet)
    return item

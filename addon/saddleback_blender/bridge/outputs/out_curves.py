# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines along the surface as curve objects with tubes: isolines and shortest paths."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import bpy
import numpy as np

from ... import nodes
from ...core.results import PathsResult, Reals
from ...core.solids.level_lines import LevelLines
from ..inputs.mesh_in import level_place
from .following import Follower
from .out_collection import replace_object

ISOLINES_ROLE, PATHS_ROLE = "isolines", "paths"
LENGTH = "saddleback_length"  # custom property of the paths object: the sum of their lengths, world units


@dataclass(frozen=True)
class Lines:
    """Polylines, one after another."""

    points: Reals  # (n, 3)
    parts: tuple[tuple[slice, bool], ...]  # of each where its points are, and whether it is closed

    @classmethod
    def of(cls, lines: Iterable[tuple[Reals, bool]]) -> Lines:
        """Rows of places (n, 3), and whether each is closed."""
        rows = list(lines)
        ends = np.cumsum([0, *(len(points) for points, _ in rows)]).tolist()
        parts = [slice(begin, end) for begin, end in pairwise(ends)]
        return cls(
            np.concatenate([np.empty((0, 3)), *(points for points, _ in rows)]),
            tuple((part, closed) for part, (_, closed) in zip(parts, rows, strict=True)),
        )

    @classmethod
    def between(cls, points: Reals, paths: PathsResult) -> Lines:
        """The lines of paths, with their points moved to `points`; a line of one point is none."""
        ends = zip(paths.offsets[:-1], paths.offsets[1:], paths.closed, strict=True)
        return cls.of((points[begin:end], bool(closed)) for begin, end, closed in ends if end - begin > 1)


def write_lines(
    context: bpy.types.Context,
    source: bpy.types.Object,
    role: str,
    lines: Lines,
    radius: float,
    material: bpy.types.Material,
    follower: Follower | None = None,
    feet: Reals | None = None,
) -> bpy.types.Object:
    """Makes or replaces the source's curve object of a role, as tubes; the radius is in world units.

    `feet` (n, 3) are where the points stand on the surface, where that is not where they are.
    """
    place = level_place(source)
    curve = _new_curve(f"Saddleback {role.title()}", lines.points, lines.parts)
    curve.materials.append(material)
    item = replace_object(context, source, role, curve, place)
    if radius > 0:
        nodes.set_tubes(item, radius, item.data.materials[0])
    else:
        nodes.remove_tubes(item)
    if follower is not None:
        follower.take(item, place, lines.points, feet)
    return item


def _new_curve(name: str, points: Reals, parts: Iterable[tuple[slice, bool]]) -> bpy.types.Curve:
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions = "3D"
    places = np.column_stack([points, np.ones(len(points))]).astype(np.float32)
    for part, is_closed in parts:
        spline = curve.splines.new("POLY")
        spline.points.add(part.stop - part.start - 1)
        spline.points.foreach_set("co", places[part].ravel())
        spline.use_cyclic_u = is_closed
    return curve


def write_isolines(
    context: bpy.types.Context,
    source: bpy.types.Object,
    lines: LevelLines,
    radius: float,
    follower: Follower | None = None,
) -> bpy.types.Object:
    """Makes or replaces the source's isolines object; the radius is in world units whatever the source's scale."""
    drawn = Lines(lines.points, tuple(lines.lines()))
    return write_lines(context, source, ISOLINES_ROLE, drawn, radius, nodes.edges_material(), follower)


def write_paths(
    context: bpy.types.Context,
    source: bpy.types.Object,
    result: PathsResult,
    radius: float,
    lift: float,
    follower: Follower | None = None,
) -> bpy.types.Object:
    """Makes or replaces the source's paths object, `lift` (world units) above the surface."""
    lines, feet = (Lines.between(points, result) for points in (result.points + lift * result.normals, result.points))
    item = write_lines(context, source, PATHS_ROLE, lines, radius, nodes.paths_material(), follower, feet.points)
    item[LENGTH] = float(result.lengths.sum())
    return item

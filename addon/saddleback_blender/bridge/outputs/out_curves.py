"""Lines along the surface as curve objects with a round bevel: isolines and shortest paths."""

from __future__ import annotations

from collections.abc import Iterable

import bpy
import numpy as np

from ... import nodes
from ...core.results import PathsResult, Reals
from ...core.solids.level_lines import LevelLines
from .out_collection import level_place, replace_object, to_place

ISOLINES_ROLE, PATHS_ROLE = "isolines", "paths"
LENGTH = "saddleback_length"  # custom property of the paths object: the sum of their lengths, world units
BEVEL_RESOLUTION = 2


def new_curve(name: str, lines: Iterable[tuple[Reals, bool]], radius: float) -> bpy.types.Curve:
    """A curve of poly splines, each a row of places (n, 3) and whether it is closed."""
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions = "3D"
    curve.bevel_depth = radius
    curve.bevel_resolution = BEVEL_RESOLUTION
    curve.use_fill_caps = True
    for points, is_closed in lines:
        spline = curve.splines.new("POLY")
        spline.points.add(len(points) - 1)
        spline.points.foreach_set("co", np.column_stack([points, np.ones(len(points))]).astype(np.float32).ravel())
        spline.use_cyclic_u = is_closed
    return curve


def write_isolines(
    context: bpy.types.Context, source: bpy.types.Object, lines: LevelLines, radius: float
) -> bpy.types.Object:
    """Makes or replaces the source's isolines object; the radius is in world units whatever the source's scale."""
    place = level_place(source)
    points = to_place(place, lines.points)
    curve = new_curve("Saddleback Isolines", ((points[part], closed) for part, closed in lines.lines()), radius)
    curve.materials.append(nodes.edges_material())
    return replace_object(context, source, ISOLINES_ROLE, curve, place)


def write_paths(
    context: bpy.types.Context, source: bpy.types.Object, result: PathsResult, radius: float, lift: float
) -> bpy.types.Object:
    """Makes or replaces the source's paths object, `lift` (world units) above the surface."""
    place = level_place(source)
    points = to_place(place, result.points + lift * result.normals)
    ends = zip(result.offsets[:-1], result.offsets[1:], result.closed, strict=True)
    lines = ((points[begin:end], bool(closed)) for begin, end, closed in ends if end - begin > 1)
    curve = new_curve("Saddleback Paths", lines, radius)
    curve.materials.append(nodes.paths_material())
    item = replace_object(context, source, PATHS_ROLE, curve, place)
    item[LENGTH] = float(result.lengths.sum())
    return item

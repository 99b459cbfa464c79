# SPDX-License-Identifier: GPL-3.0-or-later
"""Lengths that are given as shares of a cell, or of the model where there are no cells, in world units."""

from __future__ import annotations

import math
from typing import Any

from . import native
from .errors import BadInputError
from .requests import Surface
from .settings import DistributeSettings, TessellateSettings, Voronoi2dSettings

MILLIMETERS = "_mm"  # ends the name of the setting that says a length in millimeters, whatever the unit
SHARE = "_share"  # ends the name of the setting that says a length in percent; the length's own name is before it
MOST_CELLS = 1_000_000  # that a size may ask for: a number is typed on purpose, a size may be off by the model's unit
RIB_SHARE = 0.125  # of a cell's size: the width of ribs where none is given
# The switch of the output that a length belongs to.
OUTPUTS = {
    "edge_radius": "make_edges",
    "gap": "make_cells",
    "inset": "make_cells",
    "thickness": "make_cells",
    "rib_width": "make_shell",
    "rib_thickness": "make_shell",
    "base_height": "make_shell",
    "isoline_radius": "make_isolines",
    "streamline_radius": "make_streamlines",
    "outline_radius": "make_outlines",
}


def millimeter(scale: float) -> float:
    """World units in a millimeter, where a world unit is `scale` meters."""
    return 0.001 / scale


def world_lengths(settings: Any, surface: Surface, count: int, scale: float = 1.0) -> dict[str, Any]:
    """Lengths by name in world units, those that the settings give as shares or in millimeters. `count` is the number
    of cells; a world unit is `scale` meters.
    """
    lengths: dict[str, Any] = {}
    if settings.lengths != "ABSOLUTE":
        lengths |= _lengths(settings, SHARE, _unit(settings, surface, count) / 100.0)
    if getattr(settings, "in_millimeters", False):
        lengths |= _lengths(settings, MILLIMETERS, millimeter(scale))
    return lengths


def _lengths(settings: Any, ending: str, unit: float) -> dict[str, Any]:
    names = [name for name in vars(settings) if name.endswith(ending)]
    return {name.removesuffix(ending): unit * getattr(settings, name) for name in names}


def _unit(settings: Any, surface: Surface, count: int) -> float:
    """The length that is 100 %: the side of a square as large as a cell, or the diagonal of the model's box."""
    if isinstance(settings, DistributeSettings) and settings.size > 0.0:
        return 2.0 * settings.size
    if isinstance(settings, (TessellateSettings, Voronoi2dSettings, DistributeSettings)):
        return math.sqrt(surface.area / max(count, 1))
    return surface.extent


def count_of_size(surface: Surface, size: float) -> int:
    """Number of cells of a size, the side of a square of their area. Raises BadInputError where there are too many."""
    count = max(1, round(surface.area / size**2))
    if count > MOST_CELLS:
        raise BadInputError(f"'{surface.name}' would have {count:,} cells of size {size:g}; make them larger")
    return count


def count_for_parts(surface: Surface, count: int) -> int:
    """The number of cells itself or, where parts of the surface would be without one, one for each part besides."""
    parts = int(native.load().connected_parts(surface.triangles, len(surface.vertices)).max(initial=-1)) + 1
    return count if parts <= count else count + parts


def told_lengths(
    settings: Any, lengths: dict[str, float], chosen: dict[str, float], labels: dict[str, str]
) -> list[str]:
    """Lines that tell the lengths of the outputs that were made, those of 0 left out, and what the run chose."""
    used = [
        f"{labels[name]} {value:.3g}"
        for name, value in lengths.items()
        if value > 0.0 and getattr(settings, OUTPUTS.get(name, ""), True)
    ]
    found = [f"{labels[name]} {value:.3g}" for name, value in chosen.items()]
    lines = {"In world units": used, "Automatic": found}
    return [f"{title}: {', '.join(told)}" for title, told in lines.items() if told]

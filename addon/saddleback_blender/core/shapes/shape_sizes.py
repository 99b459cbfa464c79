# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds how large shapes are: by their count, by a density."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import native
from ..results import Reals
from .shape_templates import ShapeTemplate

# Share of the surface that shapes cover: a loose scatter, and full of shapes laid at random, and side by side.
LOOSE, FULL, PACKED = 0.40, 0.55, 0.70
# Where the count is to fill the surface: by which share of it the number may differ.
TOLERANCE = 0.05
MOST_TRIALS = 7
# The power of the size by which the count falls: 2 where all is wide, another, as two trials tell, where it is not.
POWER, LEAST_POWER, MOST_POWER = 2.0, 1.0, 4.0
STEADY = 0.5  # no trial is smaller than the one before by more, lest shapes become so small that millions fit
MOST_ROOM = 2_000_000  # shapes that may fit: the search looks at room for all of them, however few are wanted
SHRINK = 0.97  # more than what the count asks for, where shapes do not find room: by this once, twice, ...
MOST_OVER = 1.3  # of the count, laid to see how many fit
PROBES = 120  # places all over the surface where shapes are tried alone, before all are laid: that takes milliseconds
LEAST_LAID = 0.25  # share of them where the surface must not bend too much: where it is less, trials take minutes
FINER = 0.9  # from one size that is probed to the next
LEAST_PROBED = 0.002  # of the size that was wanted
ROUGH = 0.6  # of that size: where shapes have to be smaller, so many do not fill the surface
PLACES_EACH = 2  # tried for a shape there: more make shapes larger, by little, and uneven
HIGH = 0.98  # share of the vertices below a density that counts as high
MOST_GROWTH = 4.0  # of a size by the density, up or down


@dataclass(frozen=True)
class Placed:
    """The library's distribution at one size."""

    size: float
    result: Any
    key: tuple[str, ...]  # in the cache


@dataclass(frozen=True)
class Laid:
    """Holds what the library answered, and what it was asked with."""

    mesh: Any
    templates: tuple[ShapeTemplate, ...]
    shapes: list[Any]
    size: float  # scale of the largest
    result: Any
    key: tuple[str, ...]
    is_about: bool  # so many as the count asks for are as many as fill the surface, more or less
    warnings: tuple[str, ...] = ()


def size_of(
    count: int, packing: float, fills: bool, area: float, shapes: Sequence[Any], templates: Sequence[ShapeTemplate]
) -> float:
    """The scale at which so many shapes cover a fair share of the area."""
    shares = np.array([template.share for template in templates])
    mean = float((shares * [shape.area for shape in shapes]).sum() / shares.sum())
    cover = FULL + packing**3 * (PACKED - FULL) if fills else LOOSE  # half packed is little more than by chance
    return float(np.sqrt(cover * area / (count * mean)))


def fitted_to_count(
    place: Callable[[float, int | None], Placed], first: float, count: int, fills: bool, maximal: bool
) -> Placed:
    """The distribution whose number of shapes is nearest to the count, at sizes tried from the first on.

    Where shapes are to fill the surface they are as large as that so many of them do; else so small that all of them
    find room. Each trial lays all shapes, so the next one makes use of what the last two tell.
    """
    most = None if maximal else int(MOST_OVER * count) + 1 if fills else count
    size, best, least = first, None, count + 1
    power, before = POWER, (0.0, 0)
    for turn in range(MOST_TRIALS):
        trial = place(size, most)
        found = len(trial.result.placements)
        if best is None or abs(found - count) < least:
            best, least = trial, abs(found - count)
        if least <= (max(1.0, TOLERANCE * count) if fills else 0):
            break
        if fills and 0 < found != most and 0 < before[1] != most and size != before[0]:
            told = -float(np.log(found / before[1]) / np.log(size / before[0]))
            power = min(max(told, LEAST_POWER), MOST_POWER)
        before = size, found
        size *= max(STEADY, (found / count) ** (1.0 / power) * (1.0 if fills else SHRINK ** (turn + 1)))
    assert best is not None
    return best


def laid_out(mesh: Any, shapes: Sequence[Any], first: float, threads: int, job: Any) -> float:
    """The first size, or the largest tried below it at which enough of the surface bends little enough for shapes."""
    sb = native.load()
    turns = np.arange(PROBES)
    center = sb.sample(mesh, PROBES)
    size = first
    while True:
        angles, scales, mirrored = turns.astype(np.float64), np.full(PROBES, size), np.zeros(PROBES, bool)
        probes = sb.Placements((turns % len(shapes)).astype(np.int32), center, angles, scales, mirrored)
        failures = sb.map_shapes(mesh, shapes, probes, threads=threads, job=job).failures
        odd = [why for why in failures.values() if why != "boundary"]
        if len(odd) <= (1.0 - LEAST_LAID) * PROBES or size < LEAST_PROBED * first:
            return size
        size *= FINER


def sizes(mesh: Any, size: float, density: Reals | None) -> float | Reals:
    """One scale, or one a vertex: by the density's square root, so that shapes fill the same share everywhere."""
    if density is None:
        return size
    middle = float(np.average(density, weights=_vertex_areas(mesh)))
    shrunk = np.sqrt(middle / np.maximum(density, middle / MOST_GROWTH**2))
    found: Reals = size * np.maximum(shrunk, 1.0 / MOST_GROWTH)
    return found


def room(area: float, size: float | Reals, smallest: float, shapes: Sequence[Any]) -> float:
    """Returns about how many of the smallest shapes the area has room for. `smallest`: share of the size."""
    least = float(np.min(size)) * smallest
    return float(area / (least**2 * min(shape.area for shape in shapes)))


def crowding(mesh: Any, density: Reals) -> float:
    """Returns how many more than on average are where the density is high."""
    high = float(np.quantile(density, HIGH))
    return max(1.0, high / float(np.average(density, weights=_vertex_areas(mesh))))


def painted_share(mesh: Any, density: Reals) -> float:
    """Returns the share of the surface where shapes may be centered."""
    areas = _vertex_areas(mesh)
    return float(areas[density > 0].sum() / areas.sum())


def _vertex_areas(mesh: Any) -> Reals:
    thirds = np.repeat(np.asarray(mesh.face_areas, np.float64) / 3.0, 3)
    areas: Reals = np.bincount(mesh.triangles.ravel(), thirds, minlength=len(mesh.vertices)).astype(np.float64)
    return areas

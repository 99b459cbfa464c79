# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes that overlap like scales: laid by footprints that touch no other, drawn longer, rising from root to tip.

A footprint is the shape made shorter along the field, and a little narrower, so that the tips of those behind reach
over it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from .. import native
from ..results import Indices, Reals
from ..surfaces.quaternions import quaternions_of, turned
from .shape_templates import Parts, ShapeTemplate, Solid

SIDEWAYS = 1.0 / 6.0  # of the overlap along the field: how much shapes overlap across it
FLATTER = 0.5  # by which shapes of ours are flatter where they overlap, which brings the tip of one clear of the next
SHRINK = 0.85  # a shape that the surface bends too much for is drawn smaller by this, once, twice, ...


def footprints(parts: Parts, overlap: float) -> Parts:
    """The outlines that are laid without touching each other."""
    shorter = np.array([1.0 - overlap, 1.0 - SIDEWAYS * overlap])
    return tuple(tuple(loop * shorter for loop in part) for part in parts)


def tilted(template: ShapeTemplate, tilt: float) -> ShapeTemplate:
    """The template with its solid rising along x by an angle (radians), its root where it was.

    One of ours is flatter and closed from below, since its tip stands free.
    """
    solid = template.solid
    if solid is None:
        return template
    x = solid.vertices[:, 0]
    flat = 1.0 if template.source else FLATTER
    rise = np.column_stack([0.0 * x, 0.0 * x, (x - x.min()) * np.tan(tilt)])
    solid = replace(solid, vertices=solid.vertices * (1.0, 1.0, flat) + rise)
    return replace(template, solid=solid if template.source else _closed(solid))


def _closed(solid: Solid) -> Solid:
    """With a fan below the border, about the middle of that."""
    parted = solid.corners[solid.parted()]
    begin, end = parted.ravel(), np.roll(parted, -1, axis=1).ravel()
    size = len(solid.vertices)
    lone = ~np.isin(begin.astype(np.int64) * size + end, end.astype(np.int64) * size + begin)
    begin, end = begin[lone], end[lone]
    fan = np.stack([end, begin, np.full(len(begin), size)], axis=1).astype(np.int32)
    return Solid(
        vertices=np.concatenate([solid.vertices, solid.vertices[begin].mean(axis=0)[None]]),
        corners=np.concatenate([solid.corners, fan.ravel()]),
        offsets=np.append(solid.offsets, solid.offsets[-1] + 3 * np.arange(1, len(fan) + 1)).astype(np.int32),
        uv=np.concatenate([solid.uv, np.full((3 * len(fan), 2), 0.5)]),
        smooth=np.append(solid.smooth, np.zeros(len(fan), bool)),
        material=np.append(solid.material, np.zeros(len(fan), np.int32)),
    )


def map_whole(
    mesh: Any, shapes: Sequence[Any], placements: Any, field: Any, overlap: float, threads: int, job: Any
) -> Any:
    """Maps the whole shapes where their footprints were laid, smaller where the surface bends too much for them.

    At (1 - overlap) of its size a shape lies within its footprint, which has found its place.
    """
    sb = native.load()
    factor, least = np.ones(len(placements)), 1.0 - overlap
    while True:
        scaled = sb.Placements(
            placements.shape, placements.center, placements.angle, factor * placements.scale, placements.mirrored
        )
        mapped = sb.map_shapes(mesh, shapes, scaled, field, threads=threads, job=job)
        failed = np.array([number for number in mapped.failures if factor[number] > least], np.int64)
        if not len(failed):
            return mapped
        factor[failed] = np.maximum(SHRINK * factor[failed], least)


def tilted_frames(
    templates: Sequence[ShapeTemplate], shape: Indices, frames: tuple[Reals, Reals, Reals], tilt: float
) -> tuple[Reals, Reals, Reals]:
    """Places (n, 3), turns (n, 4) and scales (n, 3) of rigid copies, turned about their roots by the tilt (radians)."""
    points, turns, scales = frames
    root = np.array([min(loop[:, 0].min() for part in template.parts for loop in part) for template in templates])
    x, y, z = (turned(turns, np.tile(axis, (len(turns), 1))) for axis in np.eye(3))
    points = points - (root[shape] * scales[:, 0] * np.sin(tilt))[:, None] * z
    cos, sin = np.cos(tilt), np.sin(tilt)
    return points, quaternions_of(cos * x + sin * z, y, cos * z - sin * x), scales

# SPDX-License-Identifier: GPL-3.0-or-later
"""A field as flat arrows on the surface: darts, lenses or stars; and balls where it is singular."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..results import FieldResult, Indices, Reals

# Outlines along and across the direction, for a length of 1, counter-clockwise seen from outside.
DART = [(-0.5, -0.03), (0.1, -0.075), (0.04, -0.2), (0.5, 0.0), (0.04, 0.2), (0.1, 0.075), (-0.5, 0.03)]
LENS = [(-0.5, 0.0), (-0.2, -0.08), (0.2, -0.08), (0.5, 0.0), (0.2, 0.08), (-0.2, 0.08)]
STAR = [(0.5, 0.0), (0.07, 0.07), (0.0, 0.5), (-0.07, 0.07), (-0.5, 0.0), (-0.07, -0.07), (0.0, -0.5), (0.07, -0.07)]
OUTLINES = {1: np.array(DART), 2: np.array(LENS), 4: np.array(STAR)}
LIFT = 0.06  # of the length, above the surface
BALL_RADIUS = 0.3  # of the length
RINGS, SEGMENTS = 8, 16
ARROW, SOURCE, SADDLE = 0, 1, 2  # material numbers: arrows, balls of a positive index, of a negative one


@dataclass(frozen=True)
class ArrowMesh:
    """Polygon i runs through corners[offsets[i]:offsets[i + 1]]."""

    vertices: Reals
    feet: Reals  # where on the surface the arrow or ball of each vertex stands
    corners: Indices
    offsets: Indices
    materials: Indices  # (p,)
    smooth: Indices  # (p,) 1 for the balls


def arrow_mesh(field: FieldResult) -> ArrowMesh:
    """The arrows of a field and its singularities as one mesh."""
    arrows = field.arrows
    assert arrows is not None
    outline = OUTLINES[field.symmetry] * arrows.length
    across = np.cross(arrows.normals, arrows.directions)
    flat = outline[None, :, :1] * arrows.directions[:, None] + outline[None, :, 1:] * across[:, None]
    vertices = (arrows.points + LIFT * arrows.length * arrows.normals)[:, None] + flat
    count, sides = len(arrows.points), len(outline)
    ball, quads = _ball(BALL_RADIUS * arrows.length)
    balls = field.singular_points[:, None] + ball[None]
    first = count * sides + len(ball) * np.arange(len(field.singular_points))
    kinds = np.where(field.singular_indices > 0, SOURCE, SADDLE)
    sizes = np.concatenate([np.full(count, sides), np.full(len(first) * len(quads), 4)])
    return ArrowMesh(
        vertices=np.concatenate([vertices.reshape(-1, 3), balls.reshape(-1, 3)]),
        feet=np.concatenate(
            [np.repeat(arrows.points, sides, axis=0), np.repeat(field.singular_points, len(ball), axis=0)]
        ),
        corners=np.concatenate([np.arange(count * sides), (first[:, None, None] + quads).ravel()]).astype(np.int32),
        offsets=np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32),
        materials=np.concatenate([np.full(count, ARROW), np.repeat(kinds, len(quads))]).astype(np.int32),
        smooth=np.concatenate([np.zeros(count), np.ones(len(first) * len(quads))]).astype(np.int32),
    )


def _ball(radius: float) -> tuple[Reals, Indices]:
    """A sphere of quads without its poles' tips, which are too small to be seen."""
    up = np.linspace(0.02, np.pi - 0.02, RINGS + 1)[:, None]
    around = np.arange(SEGMENTS) * 2 * np.pi / SEGMENTS
    ring = np.stack([np.sin(up) * np.cos(around), np.sin(up) * np.sin(around), -np.cos(up) + 0 * around], axis=-1)
    number = np.arange((RINGS + 1) * SEGMENTS).reshape(RINGS + 1, SEGMENTS)
    onward = np.roll(number, -1, axis=1)
    quads = np.stack([number[:-1], onward[:-1], onward[1:], number[1:]], axis=-1).reshape(-1, 4)
    return radius * ring.reshape(-1, 3), quads.astype(np.int32)

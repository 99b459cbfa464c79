# SPDX-License-Identifier: MIT
"""Makes super-patches.svg, a turned part and a bent tube as patches by two errors: python make_patches_plot.py."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import saddleback as sb

SIZE, GAP = 260, 16
Floats = NDArray[np.float64]


def turned(profile: Floats, around: int = 64) -> sb.Mesh:
    """A closed profile (n, 2) of radii and heights, turned about z."""
    angle = 2 * np.pi * np.arange(around) / around
    radius, height = profile.T[:, :, None]
    vertices = np.stack(np.broadcast_arrays(radius * np.cos(angle), radius * np.sin(angle), height), axis=-1).reshape(
        -1, 3
    )
    row, column = np.divmod(np.arange(len(profile) * around), around)
    onward, up = (column + 1) % around, (row + 1) % len(profile)
    a, b, c, d = (r * around + k for r, k in ((row, column), (row, onward), (up, onward), (up, column)))
    return sb.Mesh(vertices, np.vstack([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]))


def knob() -> sb.Mesh:
    """A bored knob: a foot, a neck that swings out, a rim."""
    swing = np.linspace(0, np.pi, 25)
    neck = np.column_stack([0.75 - 0.2 * np.sin(swing), 0.35 + 0.8 * swing / np.pi])
    corners = np.array([[0.3, 0.0], [1.0, 0.0], [1.0, 0.25], [0.75, 0.25]])
    top = np.array([[0.95, 1.25], [0.95, 1.5], [0.3, 1.5]])
    line = np.vstack([corners, neck, top, corners[:1]])
    fine = [np.linspace(a, b, max(2, int(np.linalg.norm(b - a) / 0.05)) + 1)[:-1] for a, b in pairwise(line)]
    return turned(np.vstack(fine))


def ring() -> sb.Mesh:
    """A torus whose tube is thicker on one side."""
    turn = 2 * np.pi * np.arange(40) / 40
    mesh = turned(np.column_stack([1 + 0.4 * np.cos(turn), 0.4 * np.sin(turn)]))
    vertices = mesh.vertices.copy()
    thick = 1 + 0.35 * vertices[:, :1] / 1.4
    center = vertices[:, :2] / np.linalg.norm(vertices[:, :2], axis=1, keepdims=True)
    vertices = np.column_stack([center + thick * (vertices[:, :2] - center), thick[:, 0] * vertices[:, 2]])
    return sb.Mesh(vertices, mesh.triangles)


def drawn(mesh: sb.Mesh, share: float, left: float, top: float) -> list[str]:
    """The patches from a corner above, the nearer over the farther."""
    extent = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    patches = sb.super_patches(mesh, error=share * extent)
    print(
        f"{mesh.face_count} faces, {share:.1%}: {len(patches)} patches, {patches.hausdorff(mesh).distance / extent:.2%}"
    )
    view = np.array([0.55, -0.62, 0.56]) / np.linalg.norm([0.55, -0.62, 0.56])
    right = np.cross([0, 0, 1], view)
    right /= np.linalg.norm(right)
    frame = np.stack([right, np.cross(view, right)])
    flat = (patches.polygons.vertices - mesh.vertices.mean(axis=0)) @ frame.T * (1.25 * SIZE / extent)
    places = flat * [1, -1] + [left + SIZE / 2, top + SIZE / 2]
    corners = patches.polygons.vertices[patches.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    depth = corners.mean(axis=1) @ view
    light = 0.5 + 0.5 * patches.normals @ (np.array([0.2, -0.5, 0.85]) / np.linalg.norm([0.2, -0.5, 0.85]))
    diagonals = np.sort(np.stack([patches.triangles, np.roll(patches.triangles, -1, axis=1)], axis=2), axis=2)
    after = np.arange(1, len(patches.polygons.corners) + 1)
    after[patches.polygons.offsets[1:] - 1] = patches.polygons.offsets[:-1]
    pairs = np.sort(np.stack([patches.polygons.corners, patches.polygons.corners[after]], axis=1), axis=1)
    sharp = {
        tuple(pair): bool(is_sharp) for pair, is_sharp in zip(pairs.tolist(), patches.polygons.is_barrier, strict=True)
    }
    lines = []
    of_patch = np.bincount(patches.triangle_patch, depth) / np.bincount(patches.triangle_patch)
    for patch in np.argsort(of_patch, kind="stable"):
        seen = np.flatnonzero((patches.triangle_patch == patch) & (normals @ view > 0))
        if not len(seen):
            continue
        color = "#{:02x}{:02x}{:02x}".format(
            *(int(255 * min(1, 0.28 + 0.75 * light[patch] * c)) for c in (0.8, 0.9, 1))
        )
        fill = "".join(f"M{joined(places[patches.triangles[t]])}z" for t in seen)
        lines.append(f'<path d="{fill}" fill="{color}" stroke="{color}"/>')
        pairs_seen = [pair for t in seen for pair in diagonals[t].tolist()]
        for is_sharp in (False, True):
            sides = "".join(f"M{joined(places[pair])}" for pair in pairs_seen if sharp.get(tuple(pair)) is is_sharp)
            if sides:
                lines.append(f'<path d="{sides}" class="{"s" if is_sharp else "p"}"/>')
    return lines


def joined(points: Floats) -> str:
    """A line through places, to half a unit."""
    return "L".join(f"{x:g} {y:g}" for x, y in np.round(2 * points) / 2)


width, height = 4 * SIZE + 3 * GAP, SIZE
picture = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}">']
picture.append("<style>path{stroke-width:.6;stroke-linecap:round}.p{stroke:#2a6fdb;stroke-width:.8}")
picture.append(".s{stroke:#10305c;stroke-width:1.6}</style>")
for i, (mesh, share) in enumerate(((knob(), 0.03), (knob(), 0.01), (ring(), 0.03), (ring(), 0.01))):
    picture += drawn(mesh, share, i * (SIZE + GAP), 0)
(Path(__file__).parent / "super-patches.svg").write_text("\n".join([*picture, "</svg>", ""]), encoding="utf-8")

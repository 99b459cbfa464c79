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
    for t in np.argsort(depth, kind="stable"):
        if normals[t] @ view <= 0:
            continue
        shade = light[patches.triangle_patch[t]]
        color = "#{:02x}{:02x}{:02x}".format(*(int(255 * min(1, 0.28 + 0.75 * shade * c)) for c in (0.80, 0.90, 1.0)))
        points = " ".join(f"{x:.1f},{y:.1f}" for x, y in places[patches.triangles[t]])
        lines.append(f'<polygon points="{points}" fill="{color}" stroke="{color}" stroke-width="0.6"/>')
        for pair in diagonals[t].tolist():
            if tuple(pair) in sharp:
                (x, y), (u, v) = places[pair]
                width, ink = (1.6, "#10305c") if sharp[tuple(pair)] else (0.8, "#2a6fdb")
                lines.append(
                    f'<line x1="{x:.1f}" y1="{y:.1f}" x2="{u:.1f}" y2="{v:.1f}" stroke="{ink}" stroke-width="{width}"'
                    ' stroke-linecap="round"/>'
                )
    return lines


width, height = 4 * SIZE + 3 * GAP, SIZE
picture = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}">']
for i, (mesh, share) in enumerate(((knob(), 0.03), (knob(), 0.01), (ring(), 0.03), (ring(), 0.01))):
    picture += drawn(mesh, share, i * (SIZE + GAP), 0)
(Path(__file__).parent / "super-patches.svg").write_text("\n".join([*picture, "</svg>", ""]), encoding="utf-8")

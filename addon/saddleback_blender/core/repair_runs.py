# SPDX-License-Identifier: GPL-3.0-or-later
"""Repairs as artists ask for them: cracks closed by the distance that it takes, holes filled, what is left told."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import native
from .progress import Progress
from .requests import Surface
from .results import Indices, RepairResult
from .settings import RepairSettings

# Copies at one place are joined and split again on the way by any repair: no change.
ON_THE_WAY = ("vertices_welded", "vertices_split", "edges_non_manifold")


def repair(surface: Surface, settings: RepairSettings, progress: Progress) -> RepairResult:
    """The library's repair of any surface. Raises its MeshError if nothing is left."""
    library, stitch = native.load().repair, settings.close_cracks
    with progress.stage(0.5, "repairing the mesh") as job:
        given = surface.vertices, surface.triangles
        mesh, report = library(*given, weld_distance=settings.weld_distance, stitch=stitch, job=job)
        changes = _counts(report)
    if stitch and not settings.weld_distance and report.joining_distance:
        with progress.stage(0.8, "joining borders") as job:
            mesh, report = library(*given, weld_distance=report.joining_distance, stitch=True, job=job)
            changes = _counts(report)
    text, vertex_map, face_map = _changes_of(report), report.vertex_map, report.face_map
    filled = np.empty(0, np.int32)
    if settings.fill_holes:
        with progress.stage(0.98, "filling holes") as job:
            mesh, report = library(mesh.vertices, mesh.triangles, fill_holes=settings.fill_holes, job=job)
        counts = _counts(report)
        if counts.get("holes_filled"):
            filled = np.setdiff1d(np.arange(len(mesh.triangles)), report.face_map).astype(np.int32)
        vertex_map, face_map = _follow(vertex_map, report.vertex_map), _follow(face_map, report.face_map)
        changes |= {kind: count for kind, count in counts.items() if kind not in (*ON_THE_WAY, "holes_left")}
        text = ", ".join(filter(None, (text, _holes_of(counts))))
    advice = _advice(report, settings, _counts(report).get("holes_left", 0))
    return RepairResult(mesh.vertices, mesh.triangles, vertex_map, face_map, changes, text, filled, advice)


def _counts(report: Any) -> dict[str, int]:
    return {str(kind): int(count) for kind, count in report.changes.items() if count}


def _follow(first: Indices, then: Indices) -> Indices:
    """Returns where two maps lead one after the other; -1 = gone."""
    return np.where(first >= 0, then[first], -1).astype(np.int32)


def _changes_of(report: Any) -> str:
    """Returns what was done, without the advice, which speaks of the library's arguments."""
    return str(report).split("; ")[0] if report.changes else ""


def _holes_of(counts: dict[str, int]) -> str:
    filled = counts.get("holes_filled", 0)
    return f"{filled} hole{'s' * (filled != 1)} filled" if filled else ""


def _advice(report: Any, settings: RepairSettings, holes_left: int) -> tuple[str, ...]:
    """Returns what would join the borders that nearly meet, and fill the holes that are left."""
    near, amid = report.near_border_vertices, report.t_junctions
    told = []
    if near:
        distance = f"a Weld Distance of {report.joining_distance:.3g}"
        how = distance if settings.close_cracks else f"Close Cracks, or {distance},"
        told.append(f"{_border_vertices(near)} close to another border without touching it: {how} joins them")
    if amid:
        how = "a larger Weld Distance" if settings.close_cracks else "Close Cracks"
        told.append(f"{_border_vertices(amid)} amid the edge of another border: {how} joins them")
    if holes_left:
        told.append(
            f"{holes_left} {'holes are' if holes_left > 1 else 'hole is'} left open, with more than "
            f"{settings.fill_holes} edges or where filling would repeat an edge"
        )
    return tuple(told)


def _border_vertices(count: int) -> str:
    return f"{count} border vertices lie" if count > 1 else "1 border vertex lies"

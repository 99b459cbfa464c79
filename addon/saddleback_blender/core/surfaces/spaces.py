# SPDX-License-Identifier: GPL-3.0-or-later
"""The plane that a diagram is made in: a flat mesh's own, its UV map's, or the disk that a surface is laid into."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from .. import native
from ..cache import Cache
from ..errors import BadInputError
from ..graphs import MESH_BYTES_PER_FACE, mesh_of_surface
from ..progress import Progress
from ..requests import Voronoi2dRequest, digest
from ..results import Reals
from .plane_frame import PlaneFrame, plane_of

UNIT_SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
BYTES_PER_FACE = 200  # of a chart: corners, boxes and the tree over them

Value = TypeVar("Value")


@dataclass(frozen=True)
class Space:
    """The library's mesh and chart, and the domain: an outline (n, 2) and holes. A flat mesh has a frame."""

    mesh: Any
    chart: Any
    loops: list[Reals]
    frame: PlaneFrame | None = None

    @property
    def box(self) -> tuple[Reals, Reals]:
        """Lower left and upper right corner (2,) of the domain."""
        return self.loops[0].min(axis=0), self.loops[0].max(axis=0)


def space_of(request: Voronoi2dRequest, progress: Progress, cache: Cache) -> Space:
    """The space that the settings ask for, from the cache or new."""
    space = request.settings.space
    mesh = mesh_of_surface(request.surface, progress, cache)
    key = ("space", space, request.surface.key, digest(request.uv, request.is_mirrored))
    size = len(mesh.triangles) * (BYTES_PER_FACE + MESH_BYTES_PER_FACE)
    make = {"OUTLINE": _outline, "UV": _uv, "DISK": _disk}[space]
    return cache.get(key, lambda: make(request, mesh, progress), lambda _: size)


def _outline(request: Voronoi2dRequest, mesh: Any, progress: Progress) -> Space:
    name, parts = request.surface.name, int(mesh.components.max()) + 1
    if parts > 1:
        raise BadInputError(f"'{name}' is in {parts} parts; the domain is one: join them, or separate one of them")
    frame = plane_of(request.surface)
    places = frame.to_plane(mesh.vertices)
    chart = _told(request, "; flatten it", lambda: _chart(mesh, places, progress))
    loops = [places[np.asarray(loop)] for loop in mesh.boundary_loops]
    loops.sort(key=lambda loop: -abs(_twice_area(loop)))
    return Space(mesh, chart, loops, frame)


def _uv(request: Voronoi2dRequest, mesh: Any, progress: Progress) -> Space:
    assert request.uv is not None
    mirror = (-1.0, 1.0) if request.is_mirrored else (1.0, 1.0)
    chart = _told(request, "", lambda: _chart(mesh, request.uv * np.array(mirror), progress))
    square = UNIT_SQUARE - (1.0, 0.0) if request.is_mirrored else UNIT_SQUARE
    return Space(mesh, chart, [square])


def _disk(request: Voronoi2dRequest, mesh: Any, progress: Progress) -> Space:
    def lay() -> Reals:
        with progress.stage(0.3, "laying the surface into a disk") as job:
            places: Reals = native.load().harmonic_map(mesh, job=job)
        return places

    places = _told(request, "", lay)
    chart = _told(request, "", lambda: _chart(mesh, places, progress))
    return Space(mesh, chart, [places[np.asarray(mesh.boundary_loops[0])]])


def _chart(mesh: Any, places: Reals, progress: Progress) -> Any:
    with progress.stage(0.4, "checking the map") as job:
        return native.load().Chart(mesh, places, job=job)


def _twice_area(loop: Reals) -> float:
    x, y = (loop - loop[0]).T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())


def _told(request: Voronoi2dRequest, remedy: str, call: Callable[[], Value]) -> Value:
    """Returns what the library refuses, about the object instead of an argument and with Blender's numbers of faces."""
    try:
        return call()
    except native.load().InputError as error:
        text = re.sub(r"^\w+: ", "", str(error))
        text = re.sub(
            r"(?<=\bface )\d+|(?<=\bfaces )\d+|(?<= and )\d+(?= overlap)", lambda m: _polygon(request, m), text
        )
        if remedy:
            text = text.split(";")[0] + remedy
        raise BadInputError(f"'{request.surface.name}': {text}") from error


def _polygon(request: Voronoi2dRequest, found: re.Match[str]) -> str:
    return str(int(request.polygons[int(found[0])]))

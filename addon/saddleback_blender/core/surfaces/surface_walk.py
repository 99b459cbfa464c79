# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of a surface in their order -> curves on it, each straight from point to point within a face.

Neighbors in one face are joined as they are, those in faces with a common edge through that edge. Between others the
middle of the way through space is brought to the surface, again and again; what then has no common edge is joined
through the common vertex. Where points leap, as from one fold to another, the curve is cut. A line along an edge of the
mesh trembles from face to face: where it soon comes back to a face it is taken not to have left it.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import native
from ..results import Indices, Reals

MOST_HALVINGS = 8


def joined(mesh: Any, faces: Indices, barycentric: Reals, starts: NDArray[np.bool_], longest: float) -> list[list[Any]]:
    """Returns of each line the library's SurfacePoints of its pieces between leaps, of two points or more.

    Lines follow each other in `faces` (n,) and `barycentric` (n, 3); `starts` (n,) is True where one begins. `longest`:
    a step through space that is longer is a leap, a way out of a face and back that is longer was meant. O(n) for close
    points.
    """
    places = _places(mesh, faces, barycentric)
    leaps = np.append(False, np.linalg.norm(np.diff(places, axis=0), axis=1) > longest)
    line = np.cumsum(starts) - 1
    faces, barycentric, begins, line = _halved(mesh, faces, barycentric, starts | leaps, line)
    lines: list[list[Any]] = [[] for _ in range(int(starts.sum()))]
    for begin, end in pairwise([*np.flatnonzero(begins).tolist(), len(faces)]):
        lines[line[begin]] += _pieces(mesh, faces[begin:end], barycentric[begin:end], longest)
    return lines


def _places(mesh: Any, faces: Indices, barycentric: Reals) -> Reals:
    places: Reals = (barycentric[:, :, None] * mesh.vertices[mesh.triangles[faces]]).sum(axis=1)
    return places


def _pieces(mesh: Any, faces: Indices, barycentric: Reals, longest: float) -> list[Any]:
    """One line without leaps, cut where neighbors have nothing in common after all."""
    triangles, vertices = mesh.triangles, mesh.vertices
    kept = _without_returns(faces, _places(mesh, faces, barycentric), longest)
    faces, barycentric = faces[kept], barycentric[kept]
    if len(faces) < 2:
        return []
    common = _common(triangles, faces)
    count = common.sum(axis=(1, 2))
    slots = [0, *(np.flatnonzero(count == 0) + 1).tolist(), len(faces)]
    between_faces, between = _between(vertices, triangles, faces, barycentric, common, count)
    needs = (count == 1) | (count == 2)
    sb, pieces = native.load(), []
    for begin, end in pairwise(slots):
        # Each point, followed by the one put between it and the next where there is one.
        order = np.repeat(np.arange(begin, end), 1 + np.append(needs[begin : end - 1], False))
        is_put = np.zeros(len(order), bool)
        is_put[1:] = order[1:] == order[:-1]
        piece_faces = np.where(is_put, between_faces[np.minimum(order, len(between) - 1)], faces[order])
        piece = np.where(is_put[:, None], between[np.minimum(order, len(between) - 1)], barycentric[order])
        places = _places(mesh, piece_faces, piece)
        moves = np.append(True, (places[1:] != places[:-1]).any(axis=1))
        if moves.sum() >= 2:
            pieces.append(sb.SurfacePoints(piece_faces[moves].astype(np.int32), piece[moves]))
    return pieces


def _common(triangles: Indices, faces: Indices) -> NDArray[np.bool_]:
    """(n - 1, 3, 3) whether corner i of a point's face is corner j of the next point's face."""
    corners = triangles[faces]
    equal: NDArray[np.bool_] = corners[:-1, :, None] == corners[1:, None, :]
    return equal


def _halved(
    mesh: Any, faces: Indices, barycentric: Reals, begins: NDArray[np.bool_], line: NDArray[np.int64]
) -> tuple[Indices, Reals, NDArray[np.bool_], NDArray[np.int64]]:
    """The points with others between them, until neighbors' faces have an edge in common, where that can be."""
    for _ in range(MOST_HALVINGS):
        far = np.flatnonzero((_common(mesh.triangles, faces).sum(axis=(1, 2)) < 2) & ~begins[1:])
        if not len(far):
            break
        places = _places(mesh, faces, barycentric)
        middles = native.load().project(mesh, 0.5 * (places[far] + places[far + 1]))
        faces = np.insert(faces, far + 1, middles.faces)
        barycentric = np.insert(barycentric, far + 1, middles.barycentric, axis=0)
        begins = np.insert(begins, far + 1, False)
        line = np.insert(line, far + 1, line[far])
    return faces, barycentric, begins, line


def _without_returns(faces: Indices, places: Reals, longest: float) -> list[int]:
    """The numbers of the points without those on a short way out of a face and back into it."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1))]).tolist()
    kept: list[int] = []
    last_in: dict[int, int] = {}  # face -> where in `kept` its last point is; points taken back leave theirs behind
    for number, face in enumerate(faces.tolist()):
        at = last_in.get(face, -1)
        if 0 <= at < len(kept) and faces[kept[at]] == face and along[number] - along[kept[at]] <= longest:
            del kept[at + 1 :]
        last_in[face] = len(kept)
        kept.append(number)
    return kept


def _between(
    vertices: Reals,
    triangles: Indices,
    faces: Indices,
    barycentric: Reals,
    common: NDArray[np.bool_],
    count: NDArray[np.int64],
) -> tuple[Indices, Reals]:
    """(n - 1,) and (n - 1, 3) the point between each and the next: on the common edge, or at the common vertex."""
    ours: NDArray[np.bool_] = np.asarray(common.any(axis=2))
    point = np.where(ours, 1.0, 0.0)
    is_edge = count == 2
    if is_edge.any():
        here, there = faces[:-1][is_edge], faces[1:][is_edge]
        corners = triangles[here]
        shared = ours[is_edge]
        a = shared.argmax(axis=1)
        b = 2 - shared[:, ::-1].argmax(axis=1)
        rows = np.arange(len(here))
        begin, end = vertices[corners[rows, a]], vertices[corners[rows, b]]
        one = _along_and_off(vertices, triangles, here, barycentric[:-1][is_edge], begin, end)
        other = _along_and_off(vertices, triangles, there, barycentric[1:][is_edge], begin, end)
        # Where the straight line crosses the edge once both faces are laid flat.
        off = one[1] + other[1]
        share = np.divide(one[0] * other[1] + other[0] * one[1], off, out=0.5 * (one[0] + other[0]), where=off > 0)
        share = np.clip(share, 0.0, 1.0)
        on_edge = np.zeros((len(here), 3))
        on_edge[rows, a], on_edge[rows, b] = 1.0 - share, share
        point[is_edge] = on_edge
    return faces[:-1], point


def _along_and_off(
    vertices: Reals, triangles: Indices, faces: Indices, barycentric: Reals, begin: Reals, end: Reals
) -> tuple[Reals, Reals]:
    """Returns of points in faces: where they lie along an edge, as a share of it, and how far off it."""
    places = (barycentric[:, :, None] * vertices[triangles[faces]]).sum(axis=1)
    edge, away = end - begin, places - begin
    square = np.einsum("ij,ij->i", edge, edge)
    along = np.einsum("ij,ij->i", away, edge) / np.where(square > 0, square, 1.0)
    return along, np.linalg.norm(away - along[:, None] * edge, axis=1)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Leads from a repair of triangles to a repair of polygons: which stay, which turn round, which give way to triangles.

The library repairs triangles and says which old vertex and face became which new one. An artist's mesh has polygons
with layers of data on them, so as much of it as possible is kept: a polygon whose triangles all survive stays a
polygon (perhaps of other vertices, perhaps turned round); of any other only the new triangles are taken over.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..results import Indices, Reals

# The ways in which three corners can match three others: first those that keep the orientation.
PERMUTATIONS = ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2))


@dataclass(frozen=True)
class RepairPlan:
    """Holds where each new vertex comes from, and what happens to each polygon that does not stay exactly as it is."""

    vertex_origin: Indices  # (n,) old vertex that gives its data; for a made vertex that of a neighbor
    vertex_is_copy: NDArray[np.bool_]  # (n,) made new: a split copy or the middle of a divided edge
    kept: dict[int, tuple[Indices, bool]]  # polygon -> new vertex of each corner, and whether it turns round
    replaced: dict[int, list[int]]  # polygon -> new triangles in its place
    dropped: list[int]  # polygons of which nothing is left
    filled: dict[int, int]  # new triangle that fills a hole -> the polygon beside it that gives its data
    changes_nothing: bool  # the new triangles are the old ones, perhaps of vertices numbered otherwise


def plan_repair(
    triangles: Indices,
    triangle_polygon: Indices,
    polygon_corners: list[Indices],
    new_vertices: Reals,
    new_triangles: Indices,
    vertex_map: Indices,
    face_map: Indices,
    filled: Indices,
) -> RepairPlan:
    """`polygon_corners`: old vertices around each polygon; `filled`: new triangles in holes, which no old one is.

    The rest as given to and got from the library's repair.

    O(F) in numpy, plus plain Python for each polygon that does not stay exactly as it is; those are in no list.
    """
    origin, root = _origins(new_vertices, vertex_map)
    claimed = _first_claims(face_map, len(new_triangles))
    corner_vertex, turned, matches = _match_corners(triangles, new_triangles, vertex_map, root, claimed)
    same = matches & ~turned & (origin[corner_vertex] == triangles).all(axis=1)
    order = np.argsort(triangle_polygon, kind="stable")
    starts = np.searchsorted(triangle_polygon[order], np.arange(len(polygon_corners) + 1))
    kept: dict[int, tuple[Indices, bool]] = {}
    replaced: dict[int, list[int]] = {}
    dropped: list[int] = []
    for polygon in np.unique(triangle_polygon[~same]).tolist():
        members = order[starts[polygon] : starts[polygon + 1]]
        survivors = claimed[members]
        if (survivors < 0).all():
            dropped.append(polygon)
            continue
        around = None
        if matches[members].all() and (turned[members] == turned[members[0]]).all():
            around = _corners_of(polygon_corners[polygon], triangles[members], corner_vertex[members])
        if around is not None:
            kept[polygon] = around, bool(turned[members[0]])
        else:
            replaced[polygon] = [int(face) for face in survivors if face >= 0]
    _give_parts(new_triangles, claimed, triangle_polygon, replaced, filled)
    home = np.full(len(new_triangles), -1, np.int32)
    home[claimed[claimed >= 0]] = triangle_polygon[claimed >= 0]
    for polygon, faces in replaced.items():
        home[faces] = polygon
    nothing = bool(matches.all() and not turned.any()) and not len(filled)
    nothing = nothing and _is_renumbering(triangles, corner_vertex, len(new_vertices))
    lenders = _lenders(new_triangles, filled, home)
    return RepairPlan(_fill_origins(origin, root, new_triangles), origin < 0, kept, replaced, dropped, lenders, nothing)


def _is_renumbering(triangles: Indices, corner_vertex: Indices, new_count: int) -> bool:
    """Tells whether corners with one old vertex have one new vertex and the other way round.

    So it is where vertices at one place are joined and then split again as they were.
    """
    pairs = np.unique(np.stack([triangles.ravel(), corner_vertex.ravel()]), axis=1)
    old, new = (len(np.unique(side)) for side in pairs)
    return bool(pairs.shape[1] == old == new == new_count)


def _origins(new_vertices: Reals, vertex_map: Indices) -> tuple[Indices, Indices]:
    """Old vertex of each new one (-1 for made ones), and its root: the first copy at its place (-1 = a new place)."""
    count = len(new_vertices)
    origin = np.full(count, -1, np.int32)
    old = np.nonzero(vertex_map >= 0)[0][::-1]  # the smallest number is written last and stays
    origin[vertex_map[old]] = old
    root = np.where(origin >= 0, np.arange(count), -1).astype(np.int32)
    made = np.nonzero(origin < 0)[0]
    if len(made):
        # No two first copies share a place, since the repair welds them; a split copy has exactly the place of its own.
        places = {new_vertices[vertex].tobytes(): vertex for vertex in np.nonzero(origin >= 0)[0]}
        for vertex in made:
            root[vertex] = places.get(new_vertices[vertex].tobytes(), -1)
    return origin, root


def _first_claims(face_map: Indices, new_count: int) -> Indices:
    """`face_map` with every new face given to one old face only, the first."""
    first = np.full(new_count, -1, np.int64)
    old = np.nonzero(face_map >= 0)[0][::-1]
    first[face_map[old]] = old
    claims = np.full(len(face_map), -1, np.int32)
    faces = np.nonzero(first >= 0)[0]
    claims[first[faces]] = faces
    return claims


def _match_corners(
    triangles: Indices, new_triangles: Indices, vertex_map: Indices, root: Indices, claimed: Indices
) -> tuple[Indices, NDArray[np.bool_], NDArray[np.bool_]]:
    """Finds for each old triangle the new vertex of each corner, whether it turned round, and whether it matches at
    all.
    """
    count = len(triangles)
    corner_vertex = np.full((count, 3), -1, np.int32)
    turned, matches = np.zeros(count, bool), np.zeros(count, bool)
    alive = np.nonzero(claimed >= 0)[0]
    wanted = vertex_map[triangles[alive]]
    found = new_triangles[claimed[alive]]
    open_ = np.ones(len(alive), bool)
    for number, permutation in enumerate(PERMUTATIONS):
        candidate = found[:, permutation]
        fits = open_ & (root[candidate] == wanted).all(axis=1)
        corner_vertex[alive[fits]] = candidate[fits]
        turned[alive[fits]] = number >= 3
        matches[alive[fits]] = True
        open_ &= ~fits
    return corner_vertex, turned, matches


def _corners_of(corners: Indices, members: Indices, new_corners: Indices) -> Indices | None:
    """New vertex of each corner of a polygon, or None where its triangles do not agree or leave one out."""
    lookup: dict[int, int] = {}
    for old, new in zip(members.ravel().tolist(), new_corners.ravel().tolist(), strict=True):
        if lookup.setdefault(old, new) != new:
            return None
    around = [lookup.get(corner, -1) for corner in corners.tolist()]
    if min(around) < 0 or len(set(around)) < len(around):
        return None
    return np.array(around, np.int32)


def _give_parts(
    new_triangles: Indices,
    claimed: Indices,
    triangle_polygon: Indices,
    replaced: dict[int, list[int]],
    filled: Indices,
) -> None:
    """Gives each new triangle that no old one claims (a further part of a divided one) to the polygon beside it."""
    unclaimed = np.ones(len(new_triangles), bool)
    unclaimed[claimed[claimed >= 0]] = False
    unclaimed[filled] = False
    parts = np.nonzero(unclaimed)[0].tolist()
    home_of_edge: dict[frozenset[int], int] = {}

    def settle(face: int, polygon: int) -> None:
        for edge in _edges(new_triangles[face]):
            home_of_edge[edge] = polygon

    for polygon, faces in replaced.items() if parts else ():
        for face in faces:
            settle(face, polygon)
    while parts:
        waiting = []
        for face in parts:
            homes = [home_of_edge[edge] for edge in _edges(new_triangles[face]) if edge in home_of_edge]
            if homes:
                replaced[homes[0]].append(face)
                settle(face, homes[0])
            else:
                waiting.append(face)
        if len(waiting) == len(parts):
            # A part has the first part of its own face beside it, or another part that has; so this is never reached
            # with the library's maps. With others the faces still come over, and only their data is a guess.
            replaced.setdefault(int(triangle_polygon[0]), []).extend(waiting)
            return
        parts = waiting


def _lenders(new_triangles: Indices, filled: Indices, home: Indices) -> dict[int, int]:
    """Finds for each triangle in a hole the polygon beside it, or beside the nearest of its hole that has one there.

    `home`: the polygon of every other new triangle.
    """
    rim = np.zeros(int(new_triangles.max(initial=-1)) + 1, bool)
    rim[new_triangles[filled]] = True
    waiting: dict[frozenset[int], list[int]] = {}  # edge -> triangles of the hole
    for face in filled.tolist():
        for edge in _edges(new_triangles[face]):
            waiting.setdefault(edge, []).append(face)
    lenders: dict[int, int] = {}
    beside = np.nonzero((home >= 0) & (rim[new_triangles].sum(axis=1) >= 2))[0]
    found = [(edge, int(home[face])) for face in beside.tolist() for edge in _edges(new_triangles[face])]
    while found:
        further = []
        for edge, polygon in found:
            for face in waiting.pop(edge, ()):
                if face not in lenders:
                    lenders[face] = polygon
                    further += [(other, polygon) for other in _edges(new_triangles[face])]
        found = further
    return lenders


def _edges(triangle: Indices) -> tuple[frozenset[int], ...]:
    a, b, c = triangle.tolist()
    return frozenset((a, b)), frozenset((b, c)), frozenset((c, a))


def _fill_origins(origin: Indices, root: Indices, new_triangles: Indices) -> Indices:
    """An old vertex for every new one: its own, its root's, or for the middle of an edge that of a neighbor."""
    filled = np.where(root >= 0, origin[np.maximum(root, 0)], -1).astype(np.int32)
    while (filled < 0).any():
        before = int((filled < 0).sum())
        near = new_triangles[(filled[new_triangles] < 0).any(axis=1)]
        for shift in (1, 2):
            take = (filled[near] < 0) & (filled[np.roll(near, shift, axis=1)] >= 0)
            filled[near[take]] = filled[np.roll(near, shift, axis=1)[take]]
        if int((filled < 0).sum()) == before:
            filled[filled < 0] = 0
    return filled

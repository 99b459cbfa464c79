# SPDX-License-Identifier: GPL-3.0-or-later
"""The mirror of an object whose mesh is alike to both sides: its half, and what was made there on the other side."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ..errors import BadInputError
from ..requests import Number, Points, Surface
from ..results import Anchors, Indices, Reals

SAME_PLACE = 1e-5  # of the mesh's extent: vertices that are nearer to each other's mirror are partners
ON_PLANE = 2e-5  # of the mesh's extent: points that are nearer to the plane are on it
FLIP = np.array([-1.0, 1.0, 1.0])
SINGLE_BITS = 22
SKEW = 1e-5  # cosine of the angle by which the plane may lean


def partners(places: Reals) -> Indices:
    """(V,) the vertex at the place (V, 3) mirrored in x, -1 where there is none. O(V log V)."""
    own, seen = places + 0.0, places * FLIP + 0.0  # without -0
    found = np.full(len(places), -1, np.int32)
    _meet(own, seen, found)
    cell = 4.0 * SAME_PLACE * float(np.ptp(places, axis=0).max(initial=0.0))
    # Of grids that are shifted by half a cell, one has both of two places that are a quarter of it apart in one cell.
    for shift in product((0.0, 0.5), repeat=3):
        if (found < 0).any() and cell > 0.0:
            _meet(np.floor(own / cell + shift), np.floor(seen / cell + shift), found)
    return found


def _meet(own: Reals, seen: Reals, found: Indices) -> None:
    """Fills in where a row of `seen` is a row of `own`."""
    left = np.flatnonzero(found < 0)
    _, numbers = np.unique(np.concatenate([own, seen[left]]), axis=0, return_inverse=True)
    numbers = numbers.ravel()
    owner = np.full(int(numbers.max(initial=0)) + 1, -1, np.int32)
    owner[numbers[: len(own)]] = np.arange(len(own), dtype=np.int32)
    found[left] = owner[numbers[len(own) :]]


def _told_apart(partner: Indices, triangles: Indices) -> Indices:
    """The same (V,), where of several vertices at one place, as along seams that are not joined, each has its own.

    An edge from v to u is the mirror of one from u's partner to v's: of the faces on both sides of a seam one has it so
    and the other not. `triangles` (F, 3), whose vertices all have partners. O(F log F).
    """
    place = partner[partner].astype(np.int64)
    corners = np.unique(triangles)
    if (place[corners] == corners).all():
        return partner
    starts, ends = triangles.ravel(), triangles[:, (1, 2, 0)].ravel()
    keys, first = np.unique(place[starts] * len(partner) + place[ends], return_index=True)
    wanted = partner[ends].astype(np.int64) * len(partner) + partner[starts]
    at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    known = np.flatnonzero(keys[at] == wanted)
    seen, found = first[at[known]], partner.copy()
    found[starts[known]], found[ends[known]] = ends[seen], starts[seen]
    return found


@dataclass(frozen=True)
class Mirror:
    """The plane x = 0 of a surface, and what lies to both sides of it."""

    whole: Surface
    half: Surface  # where x is not below 0
    partner: Indices  # (V,) of the Blender mesh's vertices
    reach: float  # how far from the plane points are on it

    @classmethod
    def of(cls, whole: Surface, part: Surface, places: Reals, scale: Reals) -> Mirror:
        """Raises BadInputError where the mesh with vertices (V, 3) at `places`, in the object's space, has no mirror.

        `part` of the whole is what patterns are to cover; `scale` (3, 3) leads from the object's space to the surface.
        """
        axes = scale / np.linalg.norm(scale, axis=0)
        if max(abs(axes[:, 0] @ axes[:, 1]), abs(axes[:, 0] @ axes[:, 2])) > SKEW:
            raise BadInputError(
                f"'{whole.name}' is sheared by its parent, so that it has no mirror; switch X Mirror off"
            )
        vertices = np.arange(whole.vertex_count) if whole.used is None else np.unique(whole.used)
        partner = partners(places)
        alone = int((partner[vertices] < 0).sum())
        if alone:
            raise BadInputError(
                f"'{whole.name}' is not the same to both sides of X: {alone:,} of its {len(vertices):,} vertices have "
                "no partner there; mirror the mesh (Mesh > Symmetrize), or switch X Mirror off"
            )
        partner = _told_apart(partner, whole.triangles if whole.used is None else whole.used[whole.triangles])
        side = places[:, 0][part.triangles if part.used is None else part.used[part.triangles]]
        near = SAME_PLACE * float(np.ptp(places, axis=0).max())
        crossing = int(((side > near).any(axis=1) & (side < -near).any(axis=1)).sum())
        if crossing:
            raise BadInputError(
                f"'{whole.name}': {crossing:,} triangles cross the mirror plane, X = 0; cut them there "
                "(Mesh > Bisect), or switch X Mirror off"
            )
        kept = np.flatnonzero((side >= -near).all(axis=1) & (side > near).any(axis=1)).astype(np.int32)
        if not len(kept):
            raise BadInputError(f"'{whole.name}' has no faces to cover where X is above 0; switch X Mirror off")
        return cls(whole, _half(part, kept), partner, ON_PLANE * whole.extent)

    def plane_edges(self) -> Indices:
        """(n, 2) vertices of the Blender mesh: edges of the half at the plane."""
        half = self.half
        on = np.abs(half.vertices[:, 0]) <= self.reach
        pairs = np.concatenate([half.triangles[:, (i, (i + 1) % 3)] for i in range(3)])
        pairs = pairs[on[pairs].all(axis=1)]
        edges: Indices = (pairs if half.used is None else half.used[pairs]).astype(np.int32)
        return edges

    def on_half(self, points: Points) -> Points:
        """Those of an artist's points that are on the half, the plane included."""
        if points.ndim == 1:
            return points[self.half.compact(points.astype(np.int32)) >= 0]
        return points[points[:, 0] >= -self.reach]

    def both(self, points: Reals, is_on: NDArray[np.bool_] | None = None) -> tuple[Reals, Reals]:
        """Places (n, 3), and those mirrored: alike to the bit in single precision.

        Those that are on the plane, as `is_on` or their places say, are equal.
        """
        # Steps that are wide beside rounding, and that single precision has wherever the object is.
        step = 2.0 ** (np.ceil(np.log2(self.whole.extent)) - SINGLE_BITS)
        seen = np.asarray(np.rint(points / step) * step)
        seen[np.abs(seen[:, 0]) <= self.reach if is_on is None else is_on, 0] = 0.0
        return seen, seen * FLIP + 0.0

    def is_on(self, points: Reals) -> NDArray[np.bool_]:
        """Tells which places (n, 3) are on the plane."""
        on: NDArray[np.bool_] = np.abs(points[:, 0]) <= self.reach
        return on

    def turned(self, directions: Reals) -> Reals:
        """Directions (n, 3), mirrored."""
        turned: Reals = directions * FLIP
        return turned

    def spread(self, values: NDArray[Number]) -> NDArray[Number]:
        """(V,) values that the half's vertices have -> those of both sides."""
        inside, other = self._sides()
        whole = values.copy()
        whole[other] = values[inside]
        return whole

    def spread_numbers(self, numbers: Indices, twins: Indices) -> Indices:
        """(V,) numbers that the half's vertices have, -1 for none -> those of both sides, where `twins` (n,) are."""
        inside, other = self._sides()
        whole = numbers.copy()
        there = numbers[inside]
        whole[other] = np.where(there >= 0, twins[there], there)
        return whole

    def _sides(self) -> tuple[Indices, Indices]:
        """Vertices of the half that are not on the plane, and their partners."""
        used = self.half.used
        assert used is not None
        inside = np.unique(used)
        inside = inside[self.partner[inside] != inside]
        return inside, self.partner[inside]

    def anchors(self, half: Anchors) -> Anchors:
        """Where points, and then those mirrored, stand."""
        return Anchors(
            np.concatenate([half.corners, self.partner[half.corners]]),
            np.tile(half.barycentric, (2, 1)),
            np.concatenate([half.offset, self.turned(half.offset)]),
        )


def _half(whole: Surface, kept: Indices) -> Surface:
    used, triangles = np.unique(whole.triangles[kept], return_inverse=True)
    numbers = used.astype(np.int32) if whole.used is None else whole.used[used]
    return replace(
        whole,
        vertices=np.ascontiguousarray(whole.vertices[used]),
        triangles=triangles.reshape(-1, 3).astype(np.int32),
        used=numbers,
        kept=whole.of_mesh(kept),
    )

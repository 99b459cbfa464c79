# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes that overlap like scales: laid by footprints that touch no other, drawn longer, rising from root to tip.

A footprint is the shape made shorter along the field, and a hair narrower, so that the tips of those behind reach over
it. Shapes side by side rise alike: what they share of their sides they would pass through, so they share hardly any.
Where shapes still pass through each other, since the surface bends or the field turns, one of them is drawn smaller,
and small ones fill the gaps.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import native
from ..results import Indices, Reals
from ..solids.crossings import find_crossings
from ..surfaces.quaternions import quaternions_of, turned
from .bent_copies import Bent, border, triangulated
from .filling import SIZES, Gaps
from .shape_templates import Parts, ShapeTemplate, Solid


class Slim(NamedTuple):
    """How much shapes of ours give up where they overlap."""

    sideways: float  # of the overlap along the field: how much shapes overlap across it
    flatter: float  # how thick they are: flat, the tip of one comes clear of the next


ROUND, THIN = Slim(1.0 / 6.0, 0.5), Slim(0.05, 0.3)
SHRINK = 0.85  # a shape that the surface bends too much for is drawn smaller by this, once, twice, ...
CLEARER = 0.9  # one that passes through others by this
GENTLY = 3  # so often; from then on by its square, its cube, ..., since next to nothing is left of most of them
LEAST = 0.1  # of their size: smaller ones that still pass through others are left out
LEAST_FILLER = 0.3  # of theirs: the next smaller ones are tried there


def footprints(parts: Parts, overlap: float, slim: Slim) -> Parts:
    """The outlines that are laid without touching each other."""
    shorter = np.array([1.0 - overlap, 1.0 - slim.sideways * overlap])
    return tuple(tuple(loop * shorter for loop in part) for part in parts)


def tilted(template: ShapeTemplate, tilt: float, slim: Slim) -> ShapeTemplate:
    """The template with its solid rising along x by an angle (radians), its root where it was.

    One of ours is flatter and closed from below, since its tip stands free.
    """
    solid = template.solid
    if solid is None:
        return template
    if not template.source:
        solid = _closed(replace(solid, vertices=solid.vertices * (1.0, 1.0, slim.flatter)))
    x = solid.vertices[:, 0]
    rise = np.column_stack([0.0 * x, 0.0 * x, (x - x.min()) * np.tan(tilt)])
    return replace(template, solid=replace(solid, vertices=solid.vertices + rise))


def _closed(solid: Solid) -> Solid:
    """With an underside in its plane, of the same faces, so that the two bend alike."""
    parted = solid.corners[solid.parted()]
    begin, _ = border(parted)
    size = len(solid.vertices)
    is_inner = np.ones(size, bool)
    is_inner[begin] = False
    below = np.arange(size)
    below[is_inner] = size + np.arange(np.count_nonzero(is_inner))
    return Solid(
        vertices=np.concatenate([solid.vertices, solid.vertices[is_inner] * (1.0, 1.0, 0.0)]),
        corners=np.concatenate([solid.corners, below[parted[:, ::-1]].ravel()]).astype(np.int32),
        offsets=np.append(solid.offsets, solid.offsets[-1] + 3 * np.arange(1, len(parted) + 1)).astype(np.int32),
        uv=np.concatenate([solid.uv, solid.uv[solid.parted()[:, ::-1]].reshape(-1, 2)]),
        smooth=np.append(solid.smooth, np.ones(len(parted), bool)),
        material=np.append(solid.material, np.zeros(len(parted), np.int32)),
    )


@dataclass(frozen=True)
class Order:
    """What is drawn: shapes, one of them at each place of a field, and their solids, bent as closely as `fit` says."""

    mesh: Any
    shapes: Sequence[Any]
    solids: Sequence[Solid | None]
    placements: Any
    field: Any
    fit: float
    threads: int

    def map(self, factor: Reals, chosen: NDArray[np.int64], job: Any) -> Any:
        """Maps those chosen, each smaller by its factor."""
        sb, all_of = native.load(), self.placements
        center = sb.SurfacePoints(all_of.center.faces[chosen], all_of.center.barycentric[chosen])
        scaled = sb.Placements(
            all_of.shape[chosen], center, all_of.angle[chosen], factor[chosen] * all_of.scale[chosen],
            all_of.mirrored[chosen],
        )  # fmt: skip
        return sb.map_shapes(self.mesh, self.shapes, scaled, self.field, threads=self.threads, job=job)

    def bend(self, mapped: Any, job: Any) -> Bent:
        """Bends the solids of what was mapped."""
        solids = [triangulated(solid) for solid in self.solids]
        return Bent.of(mapped.bend(solids, self.fit, threads=self.threads, job=job))


@dataclass(frozen=True)
class Whole:
    """Whole shapes as mapped: those that were laid, then those that fill gaps between them."""

    mapped: Any
    smaller: int = 0  # drawn so, to be clear of others
    missing: int = 0  # since no size was
    fillers: int = 0
    is_cut_short: bool = False  # more fillers would have too many faces
    left_out: tuple[int, ...] = ()  # of all that were mapped
    bent: Bent | None = None  # where they had to be bent to be cleared


def map_whole(order: Order, overlap: float, clears: bool, fill_to: int, job: Any) -> Whole:
    """Maps the whole shapes where their footprints were laid, smaller where the surface bends too much for them.

    At (1 - overlap) of its size a shape lies within its footprint, which has found its place. Where it `clears` them,
    no bent copy of one passes through that of another; small ones then fill gaps, to that many faces of all at most.
    """
    factor, mapped = _laid_out(order, 1.0 - overlap, job)
    if not clears:
        return Whole(mapped)
    clear, bent = _cleared(order, factor, order.bend(mapped, job), np.zeros(len(factor), bool), LEAST, 0, job)
    is_out = clear < LEAST
    smaller, missing = int(np.count_nonzero((clear < factor) & ~is_out)), int(np.count_nonzero(is_out))
    if not fill_to:
        mapped = order.map(clear, np.arange(len(clear)), job) if smaller or missing else mapped
        return Whole(mapped, smaller, missing, left_out=tuple(np.flatnonzero(is_out).tolist()), bent=bent)
    order, factor, is_out, bent, is_cut_short = _filled(order, mapped, bent, clear, is_out, fill_to, job)
    if smaller or missing or len(factor) > len(clear):
        mapped = order.map(factor, np.arange(len(factor)), job)
    fillers = int(np.count_nonzero(~is_out[len(clear) :]))
    return Whole(mapped, smaller, missing, fillers, is_cut_short, tuple(np.flatnonzero(is_out).tolist()), bent)


def _laid_out(order: Order, least: float, job: Any) -> tuple[Reals, Any]:
    """(n,) factors, `least` or more, at which the surface does not bend too much, and the shapes as mapped."""
    everything = np.arange(len(order.placements))
    factor = np.ones(len(everything))
    mapped, tried = order.map(factor, everything, job), everything
    failures = mapped.failures
    while len(tried := np.array([tried[row] for row in failures if factor[tried[row]] > least], np.int64)):
        factor[tried] = np.maximum(SHRINK * factor[tried], least)
        failures = order.map(factor, tried, job).failures
    if (factor < 1.0).any():
        mapped = order.map(factor, everything, job)
    return factor, mapped


def _filled(
    order: Order, mapped: Any, bent: Bent, factor: Reals, is_out: NDArray[np.bool_], most: int, job: Any
) -> tuple[Order, Reals, NDArray[np.bool_], Bent, bool]:
    """With small shapes behind where there was bare skin: what was laid, how large, which of them not, the copies.

    And whether gaps are left, since all would have more than `most` faces: parts narrower than shapes take many.
    """
    each = np.array([0 if solid is None else len(solid.offsets) - 1 for solid in order.solids])
    solids = [solid.vertices for solid in order.solids if solid is not None]
    extents = np.array([(*np.ptp(solid[:, :2], axis=0), solid[:, 2].max()) for solid in solids])
    extent = np.append(extents[:, :2].min(axis=0), extents[:, 2].max())
    gaps, known = Gaps(order.mesh, order.placements, mapped.frames(), extent), 0
    for share in SIZES:
        is_new = (bent.triangle_copy >= known) & ~is_out[bent.triangle_copy]
        gaps.look(bent.vertices, bent.triangles[is_new], job)
        fillers = gaps.fillers(share)
        if fillers is None:
            break
        if each[order.placements.shape].sum() + each[fillers.shape].sum() > most:
            return order, factor, is_out, bent, True
        own, found = _laid_out(replace(order, placements=fillers), LEAST_FILLER, job)
        known, order = len(factor), replace(order, placements=_joined(order.placements, fillers))
        is_out = np.append(is_out, np.isin(np.arange(len(fillers)), list(found.failures)))
        copies = bent.joined(order.bend(found, job))
        factor, bent = _cleared(order, np.append(factor, own), copies, is_out, LEAST_FILLER, known, job)
        is_out[known:] |= factor[known:] < LEAST_FILLER
    return order, factor, is_out, bent, False


def _joined(first: Any, second: Any) -> Any:
    """Placements, one after the other."""
    sb, both = native.load(), (first, second)
    center = sb.SurfacePoints(
        *(np.concatenate([getattr(p.center, name) for p in both]) for name in ("faces", "barycentric"))
    )
    shape, angle, scale, mirrored = (
        np.concatenate([getattr(p, name) for p in both]) for name in ("shape", "angle", "scale", "mirrored")
    )
    return sb.Placements(shape, center, angle, scale, mirrored)


def _cleared(
    order: Order, factor: Reals, first: Bent, is_out: NDArray[np.bool_], least: float, fixed: int, job: Any
) -> tuple[Reals, Bent]:
    """(n,) factors at which no copy passes through another, below `least` it is to be left out; and the copies.

    Of each two that do, the one that meets more others, or else the larger, is made smaller; none of the `fixed` first.
    Those that are out meet none. O(T log T) for all T triangles once, then for those of the copies that change and of
    their neighbors.
    """
    factor, again = factor.copy(), []
    is_there = ~is_out[first.triangle_copy]
    points, triangles, owner = first.vertices, first.triangles[is_there], first.triangle_copy[is_there]
    middle = np.asarray(order.placements.center.positions(order.mesh))
    sizes = first.ends - first.begins
    rows = np.concatenate([np.arange(begin, end) for begin, end in zip(first.begins, first.ends, strict=True)])
    off = first.vertices[rows] - np.repeat(middle, sizes, axis=0)
    reach, laid, begins = np.zeros(len(factor)), sizes > 0, np.cumsum(sizes) - sizes
    reach[laid] = np.sqrt(np.maximum.reduceat(np.einsum("ij,ij->i", off, off), begins[laid]))
    among = None
    if fixed:
        near = _near(middle, reach, np.arange(fixed, len(factor)))[owner]
        triangles, owner = triangles[near], owner[near]
        among = np.flatnonzero(owner >= fixed).astype(np.int32)
    pairs = _pairs(points, triangles, owner, among, job)
    times = np.full(len(factor), GENTLY if fixed else 0)  # of fillers, which need not be as large as they can
    while len(pairs):
        chosen = _fewest(pairs, factor, fixed)
        times[chosen] += 1
        smaller = factor[chosen] * CLEARER ** np.maximum(times[chosen] - GENTLY + 1, 1)
        last = least / CLEARER  # none is left out that was not tried at this
        factor[chosen] = np.where(factor[chosen] > last, np.maximum(smaller, last), smaller)
        pairs = pairs[~np.isin(pairs, chosen).any(axis=1)]
        is_kept = np.ones(len(factor), bool)
        is_kept[chosen] = False
        triangles, owner = triangles[is_kept[owner]], owner[is_kept[owner]]
        chosen = chosen[factor[chosen] >= least]
        bent = order.bend(order.map(factor, chosen, job), job)
        again.append((bent, chosen))
        near = _near(middle, reach, chosen)[owner]
        around, fresh = triangles[near], bent.triangles + np.int32(len(points))
        points = np.concatenate([points, bent.vertices])
        whose = chosen.astype(np.int32)[bent.triangle_copy]
        found = _pairs(
            points, np.concatenate([around, fresh]), np.concatenate([owner[near], whose]),
            np.arange(len(around), len(around) + len(fresh), dtype=np.int32), job,
        )  # fmt: skip
        pairs = np.concatenate([pairs, found])
        triangles, owner = np.concatenate([triangles, fresh]), np.concatenate([owner, whose])
    return factor, first.with_again(again) if again else first


def _pairs(points: Reals, triangles: Indices, owner: Indices, among: Indices | None, job: Any) -> NDArray[np.int64]:
    """(k, 2) copies that pass through each other, given whose each triangle is; of those `among` the triangles only.

    As they are once Blender has rounded them.
    """
    found = find_crossings(points, triangles, among, job, owner)
    pairs: NDArray[np.int64] = np.unique(np.sort(owner[found].astype(np.int64), axis=1), axis=0)
    return pairs


def _near(middle: Reals, reach: Reals, chosen: NDArray[np.int64]) -> NDArray[np.bool_]:
    """(n,) which copies may meet those chosen, given their middles and how far they reach from there."""
    near, order = np.zeros(len(middle), bool), np.argsort(middle[:, 0])
    along, wide = middle[order, 0], reach[chosen] + reach.max(initial=0.0)
    begins = np.searchsorted(along, middle[chosen, 0] - wide, "left")
    ends = np.searchsorted(along, middle[chosen, 0] + wide, "right")
    for number, begin, end in zip(chosen, begins, ends, strict=True):
        rows = order[begin:end]
        near[rows] |= np.linalg.norm(middle[rows] - middle[number], axis=1) <= reach[rows] + reach[number]
    return near


def _fewest(pairs: NDArray[np.int64], factor: Reals, fixed: int) -> NDArray[np.int64]:
    """Some of those in pairs (k, 2), one of each pair at least: always the one in most pairs next, then the largest,
    and never one of the `fixed` first, of which no two meet.
    """
    found = []
    while len(pairs):
        number, count = np.unique(pairs, return_counts=True)
        found.append(number[np.lexsort((-factor[number], np.where(number < fixed, 0, -count)))[0]])
        pairs = pairs[(pairs != found[-1]).all(axis=1)]
    return np.sort(np.array(found, np.int64))


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

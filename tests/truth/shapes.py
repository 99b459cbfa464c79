# SPDX-License-Identifier: MIT
"""Truths about shapes on surfaces: which overlap, by polygons of the plane in fractions on surfaces that unroll."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay

import saddleback as sb
from tests import meshes
from tests.truth.distances import area_between
from tests.truth.registry import guards

Floats = NDArray[np.float64]
Random = np.random.Generator
Loops = list[Floats]
Point = tuple[Fraction, Fraction]

# --- polygons in fractions --------------------------------------------------------------------------------------------


def as_fractions(loop: Floats) -> list[Point]:
    return [(Fraction(x), Fraction(y)) for x, y in loop.tolist()]


def turn(a: Point, b: Point, c: Point) -> int:
    value = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    return (value > 0) - (value < 0)


def is_on(a: Point, b: Point, p: Point) -> bool:
    return turn(a, b, p) == 0 and all(min(a[i], b[i]) <= p[i] <= max(a[i], b[i]) for i in (0, 1))


def segments_meet(a: Point, b: Point, c: Point, d: Point) -> bool:
    if turn(a, b, c) * turn(a, b, d) < 0 and turn(c, d, a) * turn(c, d, b) < 0:
        return True
    return is_on(a, b, c) or is_on(a, b, d) or is_on(c, d, a) or is_on(c, d, b)


def contains(loops: Loops, point: Floats) -> bool:
    """Even and odd crossings of the ray to the right."""
    (p,) = as_fractions(point[None])
    inside = False
    for loop in map(as_fractions, loops):
        for a, b in zip(loop, loop[1:] + loop[:1], strict=True):
            if (a[1] > p[1]) != (b[1] > p[1]) and (turn(a, b, p) > 0) == (b[1] > a[1]):
                inside = not inside
    return inside


def outlines_meet(one: Loops, other: Loops) -> bool:
    for first in one:
        ends = np.roll(first, -1, axis=0)
        low, high = np.minimum(first, ends), np.maximum(first, ends)
        for second in other:
            other_ends = np.roll(second, -1, axis=0)
            near = (low[:, None] <= np.maximum(second, other_ends)[None]).all(axis=2)
            near &= (high[:, None] >= np.minimum(second, other_ends)[None]).all(axis=2)
            for i, j in np.argwhere(near).tolist():
                if segments_meet(*(as_fractions(np.array([first[i], ends[i]]))), *as_fractions(
                    np.array([second[j], other_ends[j]])
                )):  # fmt: skip
                    return True
    return False


def overlap(one: Loops, other: Loops) -> bool:
    """Whether two shapes, each of loops that do not cross, have a point in common."""
    if outlines_meet(one, other):
        return True
    return any(contains(other, loop[0]) for loop in one) or any(contains(one, loop[0]) for loop in other)


def sure_overlap(one: Loops, other: Loops, rounding: float) -> bool | None:
    """The same, None where moving one of them by the rounding changes the answer."""
    low, high = np.vstack(one).min(axis=0) - rounding, np.vstack(one).max(axis=0) + rounding
    if (np.vstack(other) < low).all(axis=0).any() or (np.vstack(other) > high).all(axis=0).any():
        return False
    steps = rounding * np.array([(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1)])
    answers = {overlap(one, [loop + step for loop in other]) for step in steps}
    return answers.pop() if len(answers) == 1 else None


# --- surfaces that unroll ---------------------------------------------------------------------------------------------


class Unrolled:
    """A mesh that was rolled up out of a rectangle of the plane, face by face without stretch."""

    def __init__(self, rng: Random, width: float = 2.0, height: float = 1.0) -> None:
        columns, rows = (int(n) for n in rng.integers(2, 14, 2))
        self.size = np.array([width, height])
        if rng.random() < 0.5:  # flat, of any triangles
            inner = rng.random((columns * rows, 2)) * self.size
            rim = [(0.0, 0.0), (width, 0.0), (0.0, height), (width, height)]
            self.plane: Floats = np.vstack([inner, rim])
            triangles = Delaunay(self.plane).simplices.astype(np.int32)
            vertices = np.column_stack([self.plane, np.zeros(len(self.plane))])
        else:  # bent along the lines between columns
            grid, triangles = meshes.grid(columns, rows)
            lines = np.concatenate([[0], np.sort(rng.random(columns - 2)), [1]])[: len(np.unique(grid[:, 0]))]
            at = np.searchsorted(np.unique(grid[:, 0]), grid[:, 0])
            self.plane = np.column_stack([lines[at] * width, grid[:, 1] * height])
            bend = np.cumsum(rng.uniform(-0.7, 0.7, len(lines)))[:-1]
            steps = np.diff(lines * width)[:, None] * np.column_stack([np.cos(bend), np.sin(bend)])
            profile = np.vstack([(0, 0), np.cumsum(steps, axis=0)])[at]
            vertices = np.column_stack([profile[:, 0], self.plane[:, 1], -profile[:, 1]])
        a, b, c = (self.plane[triangles[:, i]] for i in range(3))
        area = area_between(b - a, c - a)
        triangles = np.where((area < 0)[:, None], triangles[:, ::-1], triangles)[abs(area) > 1e-9]
        used, numbers = np.unique(triangles, return_inverse=True)
        self.plane = self.plane[used]
        self.mesh = sb.Mesh(vertices[used], numbers.reshape(-1, 3).astype(np.int32))

    def locate(self, point: Floats) -> tuple[int, Floats, float]:
        """The face, the weights, and the direction of the face's first edge."""
        corners = self.plane[self.mesh.triangles]
        a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
        area = area_between(b - a, c - a)
        weights = np.column_stack([area_between(u - point, v - point) for u, v in ((b, c), (c, a), (a, b))])
        weights /= area[:, None]
        face = int(weights.min(axis=1).argmax())
        along = b[face] - a[face]
        inside = np.maximum(weights[face], 0)
        return face, inside / inside.sum(), float(np.arctan2(along[1], along[0]))


def regular(count: int, radius: float, center: tuple[float, float] = (0, 0), phase: float = 0.0) -> Floats:
    angle = phase + 2 * np.pi * np.arange(count) / count
    return radius * np.column_stack([np.cos(angle), np.sin(angle)]) + center


def random_shapes(rng: Random) -> list[sb.Shape]:
    """Of one part and of several, with holes, with parts in holes."""
    spikes = 2 * int(rng.integers(3, 9))
    star = regular(spikes, 1.0) * np.where(np.arange(spikes) % 2 == 0, 1.0, rng.uniform(0.2, 0.8))[:, None]
    n = int(rng.integers(3, 16))
    return [
        sb.Shape([regular(n, 1.0)]),
        sb.Shape([star]),
        sb.Shape([regular(n, 1.0), regular(n, float(rng.uniform(0.3, 0.9)))]),
        sb.Shape(regular(n, 0.4), regular(n, 0.2, (0.8, 0.3))),
        sb.Shape([regular(12, 1.0), regular(12, 0.8)], regular(n, 0.3), regular(n, 0.05, (0.5, 0))),
    ]


class Layout:
    """Shapes laid out in the plane that a surface was rolled up from."""

    def __init__(self, surface: Unrolled, shapes: list[sb.Shape]) -> None:
        self.surface, self.shapes = surface, shapes
        self.poses: list[tuple[int, Floats, float, float, bool]] = []

    def add(self, shape: int, center: Floats, angle: float, scale: float, mirrored: bool = False) -> Loops:
        self.poses.append((shape, center, angle, scale, mirrored))
        return self.loops(len(self.poses) - 1)

    def loops(self, i: int) -> Loops:
        shape, center, angle, scale, mirrored = self.poses[i]
        c, s = np.cos(angle), np.sin(angle)
        move = scale * np.array([[c, -s], [s, c]]) @ np.diag([1, -1 if mirrored else 1])
        return [loop @ move.T + center for loop in self.shapes[shape].loops]

    def is_inside(self, i: int) -> bool:
        corners = np.vstack(self.loops(i))
        return bool((corners > 1e-6).all() and (corners < self.surface.size - 1e-6).all())

    def mapped(self) -> sb.MappedShapes:
        found = [self.surface.locate(center) for _, center, _, _, _ in self.poses]
        shape, _, angle, scale, mirrored = zip(*self.poses, strict=True)
        centers = sb.SurfacePoints([face for face, _, _ in found], np.array([weights for _, weights, _ in found]))
        angles = np.array(angle) - [along for _, _, along in found]
        return sb.map_shapes(self.surface.mesh, self.shapes, sb.Placements(shape, centers, angles, scale, mirrored))

    def overlapping(self, rounding: float) -> tuple[set[tuple[int, int]], set[tuple[int, int]]]:
        """The pairs that overlap, and those of which rounding decides."""
        sure, unsure = set(), set()
        for i, j in combinations(range(len(self.poses)), 2):
            answer = sure_overlap(self.loops(i), self.loops(j), rounding)
            if answer is None:
                unsure.add((i, j))
            elif answer:
                sure.add((i, j))
        return sure, unsure


def random_layout(rng: Random, count: int, innocent: bool) -> Layout:
    """Shapes at random, large and small ones, each well inside the rectangle; innocent: only those that find room."""
    layout = Layout(Unrolled(rng), random_shapes(rng))
    kept: list[Loops] = []
    for _ in range(8 * count):
        if len(kept) == count:
            break
        pose = (int(rng.integers(0, 5)), rng.random(2) * layout.surface.size, float(rng.uniform(0, 6.28)))
        loops = layout.add(*pose, float(np.exp(rng.uniform(np.log(0.02), np.log(0.4)))), bool(rng.random() < 0.5))
        fits = layout.is_inside(len(kept))
        if fits and (not innocent or all(sure_overlap(loops, other, 1e-7) is False for other in kept)):
            kept.append(loops)
        else:
            layout.poses.pop()
    return layout


def plant(layout: Layout, sort: str, rng: Random) -> bool:
    """A copy that overlaps one of those there in a given way; False where there is no room for that."""
    i = int(rng.integers(0, len(layout.poses)))
    shape, center, angle, scale, mirrored = layout.poses[i]
    loops = layout.loops(i)
    loop = loops[int(rng.integers(0, len(loops)))]
    if sort == "twin":
        layout.add(shape, center, angle, scale, mirrored)
    elif sort == "nested":  # about a point within, too small to reach the outline, unless that is near
        layout.add(0, within(loops, rng), float(rng.uniform(0, 6)), scale * 10 ** float(rng.uniform(-4, -1)))
    elif sort == "part":  # one part of another in it, the rest wherever it comes to lie
        small = scale * 10 ** float(rng.uniform(-2, -1))
        layout.add(3, within(loops, rng) - small * np.array([0.8, 0.3]), 0.0, small)
    elif sort == "hull":  # a larger one around all of it
        layout.add(0, center, angle, 2.5 * scale)
    elif sort == "touch":  # a tip that reaches in by a millionth of the size
        k = int(rng.integers(0, len(loop)))
        ends = loop[k], loop[(k + 1) % len(loop)]
        along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
        out = np.array([along[1], -along[0]])  # shapes lie on the left, in holes' loops as well; mirrored on the right
        out = -out if mirrored else out
        small = 0.3 * float(np.linalg.norm(ends[1] - ends[0]))
        tip = 0.5 * (ends[0] + ends[1]) - 1e-6 * small * out
        layout.add(1, tip + small * out, float(np.arctan2(-out[1], -out[0])), small)
    else:  # across the outline: one that holds its own center
        layout.add(int(rng.choice([0, 1, 3, 4])), loop[0], float(rng.uniform(0, 6)), scale * float(rng.uniform(0.1, 1)))
    if layout.is_inside(len(layout.poses) - 1):
        return True
    layout.poses.pop()
    return False


def within(loops: Loops, rng: Random) -> Floats:
    corners = np.vstack(loops)
    while True:
        point = rng.uniform(corners.min(axis=0), corners.max(axis=0))
        if contains(loops, point):
            return np.array(point)


SORTS = ("across", "nested", "part", "hull", "touch", "twin")

# --- the checks -------------------------------------------------------------------------------------------------------


def check_layout(layout: Layout, samples: int = 500) -> int:
    """The checker names exactly the guilty pairs, and the cut refuses one of them or adds up; gives their number."""
    mapped = layout.mapped()
    assert not mapped.failures, mapped.failures
    guilty, unsure = layout.overlapping(2e-11)
    mesh = layout.surface.mesh
    report = sb.check_distribution(mesh, mapped, samples=samples)
    assert {fault[0] for fault in report.faults} <= {"crossing", "nesting", "covered_twice"}, report.faults
    named = {(fault[1], fault[2]) for fault in report.faults}
    assert guilty <= named, f"not found: {guilty - named}"
    assert named <= guilty | unsure, f"innocent: {named - guilty - unsure}"
    if guilty:
        try:
            mapped.cut()
        except sb.InputError as refusal:
            words = str(refusal).split()
            assert words[0] == "shapes" and (int(words[1]), int(words[3])) in guilty | unsure, str(refusal)
        else:
            raise AssertionError(f"cut, though these overlap: {guilty}")
    elif not unsure:
        check_areas(layout, mapped.cut())
    return len(guilty)


def check_areas(layout: Layout, cut: sb.CutSurface) -> None:
    corners = cut.vertices[cut.triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    whole = layout.surface.mesh.area
    assert abs(areas.sum() - whole) <= 1e-9 * whole
    for i, (shape, _, _, scale, _) in enumerate(layout.poses):
        wanted = layout.shapes[shape].area * scale**2
        assert abs(areas[cut.triangle_shape == i].sum() - wanted) <= 1e-9 * whole, f"shape {i}"


@guards("check_distribution", "CheckReport", "map_shapes", "MappedShapes.cut", "CutSurface", on="nothing")
def random_overlaps(rng: Random) -> None:
    """Random shapes where a surface unrolls, against polygons in fractions."""
    check_layout(random_layout(rng, int(rng.integers(2, 9)), innocent=False))


@guards("check_distribution", "MappedShapes.cut", on="nothing")
def planted_overlaps(rng: Random) -> None:
    """Collisions planted among innocent shapes, of every sort."""
    layout = random_layout(rng, int(rng.integers(1, 6)), innocent=True)
    if layout.poses and plant(layout, SORTS[int(rng.integers(0, len(SORTS)))], rng):
        assert check_layout(layout) >= 1


@guards("check_distribution", "MappedShapes.cut", on="nothing")
def innocent_shapes(rng: Random) -> None:
    """Shapes that do not overlap, some in the holes of others."""
    layout = random_layout(rng, int(rng.integers(1, 10)), innocent=True)
    if layout.poses:
        assert check_layout(layout) == 0

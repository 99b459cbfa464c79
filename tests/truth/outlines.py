# SPDX-License-Identifier: MIT
"""Truths about shapes in their plane: closed forms of the presets, exact polygons, masks by counting pixels."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np

import saddleback as sb
from tests.truth.registry import guards
from tests.truth.shapes import Floats, Loops, Random, as_fractions, contains, is_on, overlap, random_shapes, regular


def exact_area(loops: Loops) -> float:
    """Of loops that run with the inside on their left, by the shoelace formula, rounded once."""
    total = Fraction(0)
    for loop in map(as_fractions, loops):
        total += sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(loop, loop[1:] + loop[:1], strict=True))
    return float(total / 2)


def random_shape(rng: Random) -> sb.Shape:
    """A preset or one of several parts, somewhere, of any size."""
    n = int(rng.integers(3, 20))
    shapes = [
        *random_shapes(rng),
        sb.Shape.star(n),
        sb.Shape.needle(float(rng.uniform(1, 30))),
        sb.Shape.leaf(float(rng.uniform(1.1, 9)), max(n, 8)),
        sb.Shape.drop(float(rng.uniform(0.2, 0.9)), max(n, 8)),
        sb.Shape.crescent(0.8, 0.4, 12),
    ]
    return shapes[rng.integers(len(shapes))]


@guards("Shape.disk", "Shape.star", "Shape.needle", "Shape.leaf", "Shape.drop", "Shape.crescent", on="nothing")
def presets(rng: Random) -> None:
    """Corners and areas of the presets by closed forms; of arcs by what their chords may leave out."""
    n = int(rng.integers(8, 200))
    disk = sb.Shape.disk(n)
    np.testing.assert_allclose(disk.loops[0], regular(n, 1.0), atol=1e-15)
    inner, points = float(rng.uniform(0.05, 0.9)), int(rng.integers(3, 30))
    inner *= math.cos(math.pi / points)  # beyond the sides of the polygon of the tips there are none
    star = sb.Shape.star(points, inner)
    tips = regular(2 * points, 1.0) * np.where(np.arange(2 * points) % 2 == 0, 1.0, inner)[:, None]
    np.testing.assert_allclose(star.loops[0], tips, atol=1e-15)
    aspect = float(rng.uniform(1.5, 50))
    needle = sb.Shape.needle(aspect)
    rim = {(1.0, 0.0), (0.0, 1 / aspect), (-1.0, 0.0), (0.0, -1 / aspect)}
    assert {tuple(np.round(corner, 14) + 0.0) for corner in needle.loops[0]} == {tuple(np.round(c, 14)) for c in rim}
    check_leaf(aspect, n)
    check_drop(float(rng.uniform(0.15, 0.95)), n)
    check_crescent(float(rng.uniform(0.3, 0.9)), float(rng.uniform(0.15, 0.9)), n)


def check_leaf(aspect: float, n: int) -> None:
    radius = (1 + aspect**2) / (2 * aspect)  # through both tips and (0, 1 / aspect)
    half = math.asin(1 / radius)
    corners = sb.Shape.leaf(aspect, n).loops[0]
    off = np.hypot(corners[:, 0], abs(corners[:, 1]) + radius - 1 / aspect) - radius
    assert abs(off).max() < 1e-13 * radius
    assert {-1.0, 1.0} <= set(np.round(corners[:, 0], 14).tolist())
    whole = 2 * radius**2 * (half - math.sin(half) * math.cos(half))
    assert whole * (1 - 45 / n**2) <= sb.Shape.leaf(aspect, n).area <= whole * (1 + 1e-12)


def check_drop(r: float, n: int) -> None:
    """Two tangents from (1, 0) to the circle of radius r about (r - 1, 0)."""
    drop = sb.Shape.drop(r, n)
    corners = drop.loops[0]
    is_tip = np.hypot(corners[:, 0] - 1, corners[:, 1]) < 1e-13
    assert is_tip.sum() == 1
    assert abs(np.hypot(corners[~is_tip, 0] - (r - 1), corners[~is_tip, 1]) - r).max() < 1e-13
    tangent = math.acos(r / (2 - r))
    whole = r * r * (math.pi - tangent) + r * math.sqrt((2 - r) ** 2 - r * r)
    assert whole * (1 - 45 / n**2) <= drop.area <= whole * (1 + 1e-12)


def check_crescent(inner: float, shift: float, n: int) -> None:
    """The unit disk less a lens, or less a disk that cuts its rim."""
    if shift + inner <= 1.05:  # a disk that does not reach the rim makes no crescent
        return
    crescent = sb.Shape.crescent(inner, shift, n)
    corners = np.vstack(crescent.loops)
    on_rim, on_bite = abs(np.hypot(*corners.T) - 1), abs(np.hypot(corners[:, 0] - shift, corners[:, 1]) - inner)
    assert np.minimum(on_rim, on_bite).max() < 1e-12
    x = (1 - inner**2 + shift**2) / (2 * shift)
    lens = math.acos(x) - x * math.sqrt(1 - x * x)
    y = (shift - x) / inner
    lens += inner**2 * (math.acos(y) - y * math.sqrt(1 - y * y))
    assert abs(crescent.area - (math.pi - lens)) <= 90 * (1 + inner**2) / n**2


@guards("Shape", "Shape.contains", on="nothing")
def insides(rng: Random) -> None:
    """Radii, area and what lies inside, by all sides and in fractions; a loop that crosses itself is refused."""
    shape = random_shape(rng).moved(float(np.exp(rng.normal())), float(rng.uniform(0, 7)), rng.normal(size=2))
    corners = np.vstack(shape.loops)
    size = np.hypot(*corners.T).max()
    assert abs(shape.circumradius - size) <= 1e-15 * size
    assert abs(shape.area - exact_area(shape.loops)) <= 1e-14 * size**2
    sides = [(a, b) for loop in shape.loops for a, b in zip(loop, np.roll(loop, -1, axis=0), strict=True)]
    reach = min(distance_to_side(np.zeros(2), a, b) for a, b in sides)
    wanted = reach if contains(shape.loops, np.zeros(2)) else 0.0
    assert abs(shape.inradius - wanted) <= 1e-13 * size, f"inradius {shape.inradius} for {wanted}"
    low, high = corners.min(axis=0), corners.max(axis=0)
    middles = np.array([(a + b) / 2 for a, b in sides[:6]])
    some = np.vstack([rng.uniform(low, high, (12, 2)), middles, rng.uniform(2 * low - high, 2 * high - low, (3, 2))])
    for point, inside in zip(some, shape.contains(some), strict=True):
        p = as_fractions(point[None])[0]
        if not any(is_on(*as_fractions(np.array(side)), p) for side in sides):
            assert inside == contains(shape.loops, point), f"{point.tolist()} is {inside}"
    loop = regular(int(rng.integers(4, 12)), 1.0)
    loop[[0, 1]] = loop[[1, 0]]
    try:
        sb.Shape(loop)
    except sb.InputError:
        return
    raise AssertionError("a loop that crosses itself made a shape")


def distance_to_side(p: Floats, a: Floats, b: Floats) -> float:
    share = min(max(float((p - a) @ (b - a)) / float((b - a) @ (b - a)), 0.0), 1.0)
    return float(np.hypot(*(a + share * (b - a) - p)))


def least_distance(one: Loops, other: Loops) -> float:
    """Between outlines that do not cross: of corners to sides."""
    return min(
        distance_to_side(p, a, b)
        for first, second in ((one, other), (other, one))
        for p in np.vstack(first)
        for loop in second
        for a, b in zip(loop, np.roll(loop, -1, axis=0), strict=True)
    )


@guards("Shape.moved", "Shape.mirrored", "Shape.centered", on="nothing")
def moves(rng: Random) -> None:
    """Moved corner by corner; of a centered shape the farthest corners leave no half of the circle empty."""
    shape = random_shape(rng)
    scale, angle, shift = float(np.exp(rng.normal())), float(rng.uniform(-7, 7)), rng.normal(size=2)
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    moved = shape.moved(scale, angle, shift)
    for before, after in zip(shape.loops, moved.loops, strict=True):
        np.testing.assert_allclose(after, scale * before @ turn.T + shift, atol=1e-14 * (scale + 3))
    for before, after in zip(shape.loops, moved.mirrored().loops, strict=True):
        flipped = (scale * before @ turn.T + shift) * (1, -1)
        nearest = np.linalg.norm(after[:, None] - flipped, axis=2).min(axis=1)
        assert len(after) == len(before)
        assert nearest.max() <= 1e-14 * (scale + 3)
    assert abs(moved.mirrored().area - moved.area) <= 1e-12 * moved.circumradius**2
    radius = float(np.exp(rng.normal()))
    centered = np.vstack(moved.centered(radius).loops)
    distances = np.hypot(*centered.T)
    assert abs(distances.max() - radius) <= 1e-9 * radius
    ends = np.sort(np.arctan2(*centered[distances > radius * (1 - 1e-7)].T[::-1]))
    assert np.diff(np.append(ends, ends[0] + 2 * np.pi)).max() <= np.pi + 1e-3, "a smaller circle holds it"


@guards("Shape.overlaps", on="nothing")
def flat_overlaps(rng: Random) -> None:
    """Two shapes of the plane against all pairs of sides in fractions; touching counts, and one within the other."""
    one = random_shape(rng)
    scale = float(rng.choice([0.05, 0.3, 1.0]))
    other = random_shape(rng).moved(scale, float(rng.uniform(0, 7)), 1.2 * rng.normal(size=2))
    if rng.random() < 0.3:  # corner on corner, exactly
        loops = [loop - other.loops[0][0] for loop in other.loops]
        loops = [np.round(loop * 2**20) / 2**20 for loop in loops]
        other = sb.Shape(*([part[0] + one.loops[0][0]] for part in [loops]))
    assert one.overlaps(other) == other.overlaps(one) == overlap(one.loops, other.loops)


@guards("Shape.from_mask", on="nothing")
def masks(rng: Random) -> None:
    """Every set pixel is inside; the area is that of marching squares, by counting corners, or more."""
    rows, columns = (int(n) for n in rng.integers(3, 14, 2))
    image = rng.random((rows, columns)) < rng.choice([0.1, 0.4])
    image[rows // 2, columns // 2] = True
    most = int(rng.choice([12, 24, 64, 1000]))
    try:
        shape = sb.Shape.from_mask(image, most, centered=False)
    except sb.InputError as refusal:
        assert "are too few" in str(refusal), str(refusal)
        return
    assert sum(len(loop) for loop in shape.loops) <= most
    row, column = np.nonzero(image)
    assert shape.contains(np.column_stack([column, -row]).astype(float)).all()
    padded = np.pad(image, 1)
    corners = [padded[i : rows + 1 + i, j : columns + 1 + j] for i in (0, 1) for j in (0, 1)]
    count = sum(corner.astype(int) for corner in corners)
    crossed = (count == 2) & (corners[0] == corners[3])
    least = np.choose(count, [0, 1 / 8, 1 / 2, 7 / 8, 1]) - crossed / 4
    most_area = least + crossed / 2
    assert shape.area >= least.sum() - 1e-9
    if most == 1000:
        assert shape.area <= most_area.sum() + 1e-9


@guards("SafeDistanceTable", "SafeDistanceTable.distance", on="nothing")
def safe_distances(rng: Random) -> None:
    """No shapes meet at that distance or beyond, in fractions; at it they are nearly in touch.

    Points of both in views and strips that the table has as one are that far from the center in sum: turned to the
    views asked for they are apart by no more than these ranges are wide.
    """
    a, b = random_shape(rng), random_shape(rng)
    table = sb.SafeDistanceTable(a, b, threads=1)
    scales = np.exp(rng.normal(size=2)) if rng.random() < 0.5 else np.ones(2)
    reach = float(scales @ (a.circumradius, b.circumradius))
    for alpha, beta in rng.uniform(-7, 7, (4, 2)):
        distance = table.distance(alpha, beta, *scales)
        toward = np.array([math.cos(alpha), math.sin(alpha)])
        mine = a.moved(scales[0]).loops
        for times in (1.0, 1 + float(rng.exponential())):
            other = b.moved(scales[1], alpha + math.pi - beta, times * (1 + 1e-12) * distance * toward)
            assert not overlap(mine, other.loops), f"at {times} of {distance}, angles {alpha}, {beta}, scales {scales}"
            if times == 1 and distance > 0:
                room = (2 * math.pi / 720 + 2 / 256 + 3e-6) * reach
                assert least_distance(mine, other.loops) <= room, f"{distance} is far, angles {alpha}, {beta}"

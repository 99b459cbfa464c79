# SPDX-License-Identifier: MIT
"""Shapes: what is accepted, what is refused in which words, and what is known about them."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_progress_and_cancel

SQUARE = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1.0]])

PRESETS = {
    "disk": sb.Shape.disk(),
    "star": sb.Shape.star(),
    "needle": sb.Shape.needle(),
    "leaf": sb.Shape.leaf(),
    "drop": sb.Shape.drop(),
    "crescent": sb.Shape.crescent(),
}


def turned(points: np.ndarray, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s], [-s, c]])


def test_a_frame_with_something_in_its_hole() -> None:
    shape = sb.Shape([2 * SQUARE, SQUARE], 0.5 * SQUARE)
    assert shape.area == pytest.approx(16 - 4 + 1) and shape.circumradius == pytest.approx(np.sqrt(8))
    assert shape.inradius == pytest.approx(0.5) and shape.has_half_turn
    assert [len(part) for part in shape.parts] == [2, 1]
    inside = shape.contains([[0, 0], [0.7, 0], [1.5, 0], [2.5, 0]])
    assert inside.tolist() == [True, False, True, False]


def test_outlines_run_with_the_shape_on_their_left() -> None:
    outline, hole = sb.Shape([2 * SQUARE[::-1], SQUARE]).loops
    assert [signed_area(outline), signed_area(hole)] == pytest.approx([16, -4])


def signed_area(loop: np.ndarray) -> float:
    after = np.roll(loop, -1, axis=0)
    return 0.5 * float(np.sum(loop[:, 0] * after[:, 1] - loop[:, 1] * after[:, 0]))


@pytest.mark.parametrize("name", PRESETS)
def test_presets_have_radius_one(name) -> None:
    shape = PRESETS[name]
    assert shape.circumradius == pytest.approx(1, abs=1e-12)
    assert shape.centered().circumradius == pytest.approx(1, abs=1e-9)
    assert shape.has_half_turn == (name in ("disk", "needle", "leaf"))
    assert sb.Shape(*shape.parts).area == shape.area == pytest.approx(shape.mirrored().area)


def test_areas_of_the_presets() -> None:
    assert PRESETS["disk"].area == pytest.approx(np.pi, rel=2e-3)
    assert PRESETS["needle"].area == pytest.approx(0.2)
    assert PRESETS["star"].area == pytest.approx(10 * 0.5 * 0.381966011250105 * np.sin(np.pi / 5))
    r = 0.6
    tangent = np.arccos(r / (2 - r))
    drop = sb.Shape.drop(r, 4000).area
    assert drop == pytest.approx(r * r * (np.pi - tangent) + r * np.sqrt((2 - r) ** 2 - r * r), rel=1e-5)
    leaf = sb.Shape.leaf(2.0, 4000).area
    radius = 0.5 * (1 + 0.25) / 0.5
    half = np.arcsin(1 / radius)
    assert leaf == pytest.approx(2 * radius**2 * (half - np.sin(half) * np.cos(half)), rel=1e-5)
    fine = sb.Shape.crescent(0.8, 0.4, 4000)
    xs, ys = np.meshgrid(np.linspace(-1, 1, 401), np.linspace(-1, 1, 401))
    share = ((xs**2 + ys**2 < 1) & ((xs - 0.4) ** 2 + ys**2 > 0.64)).mean() * 4
    assert fine.area == pytest.approx(share, rel=0.02)


def test_half_turns_are_found_at_any_angle_and_only_about_the_origin() -> None:
    outline = turned(PRESETS["leaf"].loops[0], 0.7)
    assert sb.Shape(np.roll(outline, 7, axis=0)).has_half_turn
    assert not sb.Shape(outline + [0.01, 0]).has_half_turn
    assert sb.Shape(SQUARE + [5, 0], SQUARE - [5, 0]).has_half_turn


def test_centered_is_the_smallest_circle() -> None:
    shape = sb.Shape([[10, 10], [14, 10], [14, 13]]).centered(2.5)
    assert np.linalg.norm(shape.loops[0], axis=1) == pytest.approx([2.5, 2.5, 2.5])
    blunt = sb.Shape([[0, 0], [10, 0], [5, 1]]).centered(1)
    assert blunt.loops[0][0] == pytest.approx([-1, 0])


def test_shapes_can_be_pickled() -> None:
    shape = sb.Shape([2 * SQUARE, SQUARE], 0.5 * SQUARE)
    again = pickle.loads(pickle.dumps(shape))
    assert all((a == b).all() for a, b in zip(shape.loops, again.loops, strict=True))


def bow() -> np.ndarray:
    return np.array([[0, 0], [1, 1], [1, 0], [0, 1.0]])


REFUSED = {
    "nothing": ((), "wanted an outline"),
    "no corners": ((np.empty((0, 2)),), "0 corners"),
    "two corners": ((SQUARE[:2],), "2 corners"),
    "not finite": ((np.array([[0, 0], [1, np.nan], [0, 1]]),), "nan.*corner 1"),
    "too large": ((SQUARE * 1e31,), "1e30"),
    "crosses itself": ((bow(),), "corner 0 of loop 0 of part 0 meets .* corner 2"),
    "no area": ((np.array([[0, 0], [1, 0], [2, 0.0]]),), "meets"),
    "hole outside": (([SQUARE, SQUARE * 0.1 + 5],), "loop 1 of part 0 is a hole outside"),
    "hole in hole": (([3 * SQUARE, 2 * SQUARE, SQUARE],), "hole within another hole"),
    "part in part": ((SQUARE, 0.5 * SQUARE), "part 1 lies within part 0"),
    "touching parts": ((SQUARE, SQUARE + [2, 0]), "part 1"),
    "hole crosses": (([SQUARE, SQUARE * 0.5 + 1],), "loop 1 of part 0"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_makes_no_shape_is_refused(case) -> None:
    parts, words = REFUSED[case]
    with pytest.raises(sb.InputError, match=words):
        sb.Shape(*parts)


@pytest.mark.parametrize(
    "call",
    [
        lambda: sb.Shape.disk(2),
        lambda: sb.Shape.star(5, 1.0),
        lambda: sb.Shape.needle(0.5),
        lambda: sb.Shape.leaf(1.0),
        lambda: sb.Shape.drop(0.0),
        lambda: sb.Shape.crescent(0.3, 0.1),
        lambda: sb.Shape.disk().centered(-1),
    ],
)
def test_presets_out_of_range_are_refused(call) -> None:
    with pytest.raises(sb.InputError):
        call()


def blob(seed: int, size: int) -> np.ndarray:
    """Smooth random values, over one half in 40 % of the image, with parts and holes."""
    rng = np.random.default_rng(seed)
    ys, xs = np.mgrid[0:size, 0:size] / size * 2 * np.pi
    waves = sum(
        a * np.cos(i * xs + j * ys + p)
        for i in range(4)
        for j in range(4)
        for a, p in [(rng.normal() / (1 + i + j), rng.uniform(0, 6))]
    )
    return 1 / (1 + np.exp(-2 * (waves - np.quantile(waves, 0.6))))


def test_a_mask_of_a_square_becomes_a_square() -> None:
    mask = np.zeros((40, 60), bool)
    mask[10:30, 20:40] = True
    shape = sb.Shape.from_mask(mask)
    assert len(shape.loops) == 1 and len(shape.loops[0]) <= 8 and shape.circumradius == pytest.approx(1)
    pixels = sb.Shape.from_mask(mask, centered=False)
    low, high = pixels.loops[0].min(axis=0), pixels.loops[0].max(axis=0)
    assert low == pytest.approx([19.5, -29.5]) and high == pytest.approx([39.5, -9.5])


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("corners", [48, 128])
def test_a_mask_is_covered_and_not_by_much(seed, corners) -> None:
    image = blob(seed, 90)
    try:
        shape = sb.Shape.from_mask(image, corners, centered=False)
    except sb.InputError as error:
        assert corners == 48 and "no clear mask" in str(error)
        return
    assert sum(map(len, shape.loops)) <= corners
    rows, columns = np.mgrid[0 : image.shape[0], 0 : image.shape[1]]
    covered = shape.contains(np.stack([columns.ravel(), -rows.ravel()], axis=1).astype(float)).reshape(image.shape)
    assert covered[image > 0.5].all()
    assert covered.mean() < (image > 0.5).mean() + (0.005 if corners == 128 else 0.2)


def test_masks_keep_holes_and_parts_and_take_alpha_and_bytes() -> None:
    ys, xs = np.mgrid[-50:51, -50:51]
    ring = np.hypot(xs, ys)
    mask = ((ring < 45) & (ring > 30)) | (ring < 12)
    shape = sb.Shape.from_mask(mask)
    assert [len(part) for part in shape.parts] == [2, 1]
    assert shape.area == pytest.approx(np.pi * (45**2 - 30**2 + 12**2) / 45**2, rel=0.05)
    rgba = np.zeros((*mask.shape, 4), np.uint8)
    rgba[..., 3] = 255 * mask
    assert sb.Shape.from_mask(rgba).area == shape.area == sb.Shape.from_mask(255 * mask.astype(np.uint8)).area


@pytest.mark.parametrize(
    ("image", "words"),
    [
        (np.zeros((5, 5)), "no clear mask, no pixel"),
        (np.ones((5, 5)), "no clear mask, every pixel"),
        (np.random.default_rng(0).integers(0, 2, (60, 60)), "no clear mask, it has [0-9]+ parts"),
        (np.full((5, 5), np.nan), "not finite"),
        (np.zeros(5), "image: wanted"),
        (np.zeros((3, 3, 3)), "image: wanted"),
        (np.zeros((0, 5)), "image has 0"),
    ],
)
def test_images_without_a_clear_mask_are_refused(image, words) -> None:
    with pytest.raises(sb.InputError, match=words):
        sb.Shape.from_mask(image)


def test_outlines_that_are_simplified_stop_before_they_touch_a_corner() -> None:
    """Where a new corner came to lie on another part's, the mask was refused as a shape that meets itself."""
    corner_to_corner = [[0, 0, 0, 0], [1, 0, 0, 0], [1, 0, 1, 1]]
    assert len(sb.Shape.from_mask(np.array(corner_to_corner, bool), 8, centered=False).parts) == 2
    for seed in range(300):
        mask = np.random.default_rng(seed).random((5, 5)) < 0.4
        mask[2, 2], mask[0, 0] = True, False
        assert 1 <= len(sb.Shape.from_mask(mask, 48, centered=False).parts) <= 13


def test_a_mask_tells_how_far_it_is_and_can_be_cancelled() -> None:
    mask = np.hypot(*np.mgrid[-50:51, -50:51]) < 40
    job = sb.Job()
    assert sb.Shape.from_mask(mask, job=job).area == sb.Shape.from_mask(mask).area and job.fraction == 1
    # Each part of the work: reading, outlines, taking corners away.
    image = np.kron(np.indices((150, 150)).sum(axis=0) % 2, np.ones((16, 16)))
    image *= np.random.default_rng(0).uniform(0.6, 1, image.shape)
    for fraction in (0.02, 0.3, 0.52):
        check_progress_and_cancel(lambda job: sb.Shape.from_mask(image, 50_000, job=job), fraction)


def test_masks_of_too_many_parts_are_refused_at_once() -> None:
    speckles = np.kron(np.indices((500, 500)).sum(axis=0) % 2, np.full((4, 4), 0.9))
    job = sb.Job()
    with pytest.raises(sb.InputError, match="it has 125000 parts and holes, for which 1000 corners are too few"):
        sb.Shape.from_mask(speckles, 1000, job=job)
    assert job.fraction <= 0.5  # before a corner is taken away


def test_placements_keep_what_they_are_given() -> None:
    points = sb.SurfacePoints([0, 1], [[1, 0, 0], [0.2, 0.3, 0.5]])
    placements = sb.Placements([0, 1], points, [0.1, 0.2], [1.0, 2.0], [True, False])
    assert len(placements) == 2 and placements.mirrored.tolist() == [True, False]
    assert placements.shape.tolist() == [0, 1] and placements.angle.tolist() == [0.1, 0.2]
    assert (placements.center.faces == points.faces).all() and placements.scale.tolist() == [1, 2]
    assert not sb.Placements([0, 1], points, [0, 0], [1, 1]).mirrored.any()


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (([0], [0, 0], [1, 1]), "shape has 1"),
        (([0, -1], [0, 0], [1, 1]), "negative"),
        (([0, 0], [0, np.inf], [1, 1]), r"angle: inf at \[1\]"),
        (([0, 0], [0, 0], [1, 0]), r"scale: 0 at \[1\]"),
    ],
)
def test_placements_refuse(values, words) -> None:
    shape, angle, scale = values
    mesh = sb.Mesh(*meshes.grid(3, 3))
    points = sb.sample(mesh, 2)
    with pytest.raises(sb.InputError, match=words):
        sb.Placements(shape, points, angle, scale)

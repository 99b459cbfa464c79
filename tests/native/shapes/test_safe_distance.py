# SPDX-License-Identifier: MIT
"""Safe distances: never too small against every corner and edge, hardly too large."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import saddleback as sb
from tests.native.cancelling import check_progress_and_cancel
from tests.native.plane_collisions import last_contact

SQUARE = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1.0]])
SHAPES = {
    "disk": sb.Shape.disk(32),
    "star": sb.Shape.star(),
    "needle": sb.Shape.needle(),
    "drop": sb.Shape.drop(0.5, 24),
    "crescent": sb.Shape.crescent(0.8, 0.4, 24),
    "frame and dot": sb.Shape([SQUARE * 2, SQUARE * 1.5], SQUARE * 0.3),
    "two apart": sb.Shape(SQUARE * 0.2 + [0.7, 0.2], SQUARE * 0.1 - [0.8, 0]),
}


def poses(count: int, seed: int) -> tuple[np.ndarray, ...]:
    rng = np.random.default_rng(seed)
    alpha, beta = rng.uniform(-7, 7, (2, count))
    return alpha, beta, rng.uniform(0.5, 1, count), 2.0 ** rng.uniform(-2, 2, count)


@pytest.mark.parametrize(("a", "b"), list(itertools.combinations_with_replacement(SHAPES, 2)))
def test_no_pose_is_nearer_than_safe(a, b) -> None:
    table = sb.SafeDistanceTable(SHAPES[a], SHAPES[b])
    alpha, beta, scale, ratio = poses(600, 1)
    for scale_b in (scale, scale * ratio):
        safe = table.distance(alpha, beta, scale, scale_b)
        contact = last_contact(SHAPES[a], SHAPES[b], alpha, beta, scale, scale_b)
        assert (safe >= contact).all()
        reach = scale * SHAPES[a].circumradius + scale_b * SHAPES[b].circumradius
        assert ((safe - contact) / reach).mean() < 0.015 and (safe <= reach * 1.00001).all()


def test_the_reference_agrees_with_exact_polygons() -> None:
    alpha, beta, scale, ratio = poses(60, 2)
    for a, b in itertools.combinations(SHAPES, 2):
        contact = last_contact(SHAPES[a], SHAPES[b], alpha, beta, scale, scale * ratio)
        for i, distance in enumerate(contact):
            first = SHAPES[a].moved(scale[i])
            away = np.array([np.cos(alpha[i]), np.sin(alpha[i])])

            def lies_at(d: float, i: int = i, b: str = b, away: np.ndarray = away) -> sb.Shape:
                return SHAPES[b].moved(scale[i] * ratio[i], alpha[i] + np.pi - beta[i], away * d)

            assert not first.overlaps(lies_at(distance + 1e-9))
            assert distance == 0 or first.overlaps(lies_at(distance - 1e-9))


def test_the_last_contact_is_found_beyond_a_gap() -> None:
    """A crescent takes a small disk into its bay: between the bay and the far side there is room."""
    crescent, dot = sb.Shape.crescent(), sb.Shape.disk(16).moved(0.1)
    table = sb.SafeDistanceTable(crescent, dot)
    assert table.distance(np.pi, 0.0) > 1.09
    assert not crescent.overlaps(dot.moved(1, 0, [0.3, 0]))
    assert table.distance(0.0, np.pi) == 0.0
    assert table.distance(0.86, np.pi) > 0.8


def test_threads_do_not_change_the_table() -> None:
    alpha, beta, scale, ratio = poses(20_000, 4)
    tables = [sb.SafeDistanceTable(SHAPES["star"], SHAPES["crescent"], threads=threads) for threads in (1, 2, 8)]
    for scale_b in (scale, scale * ratio):
        one, *others = (table.distance(alpha, beta, scale, scale_b).tobytes() for table in tables)
        assert all(other == one for other in others)


def test_a_table_of_many_corners_can_be_watched_and_stopped() -> None:
    job = sb.Job()
    sb.SafeDistanceTable(SHAPES["star"], SHAPES["needle"], job=job)
    assert job.fraction == 1
    fine = sb.Shape.disk(20_000)
    check_progress_and_cancel(lambda job: sb.SafeDistanceTable(fine, fine, threads=1, job=job), 0.1)


def test_disks_are_apart_at_the_sum_of_their_radii() -> None:
    fine = sb.Shape.disk(2000)
    table = sb.SafeDistanceTable(fine, fine)
    assert table.distance(0.3, 1.0) == pytest.approx(2, abs=1e-3)
    assert table.distance(0.3, 1.0, 0.5, 2.0) == pytest.approx(2.5, abs=2e-3)
    assert table.nbytes <= 3e6


def test_order_does_not_matter() -> None:
    ab = sb.SafeDistanceTable(SHAPES["star"], SHAPES["drop"])
    ba = sb.SafeDistanceTable(SHAPES["drop"], SHAPES["star"])
    alpha, beta, scale, ratio = poses(100, 3)
    there, back = ab.distance(alpha, beta, scale, scale * ratio), ba.distance(beta, alpha, scale * ratio, scale)
    assert np.allclose(there, back, rtol=0.02)
    assert isinstance(ab.distance(0, 1), float)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((np.nan, 0), "alpha is nan"),
        ((0, 0, 0), "scale_a is 0"),
        ((0, 0, 1, np.inf), "scale_b is inf"),
        (([0.0, 1], [0.0, 1, 2]), "beta has 3"),
    ],
)
def test_what_makes_no_pose_is_refused(arguments, words) -> None:
    table = sb.SafeDistanceTable(SHAPES["star"], SHAPES["star"])
    with pytest.raises(sb.InputError, match=words):
        table.distance(*arguments)


def test_only_shapes_are_taken() -> None:
    with pytest.raises(sb.InputError, match="b: wanted a Shape, got a str"):
        sb.SafeDistanceTable(SHAPES["star"], "star")

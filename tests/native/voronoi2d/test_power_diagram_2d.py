# SPDX-License-Identifier: MIT
"""Power diagrams: exact whatever the size, alike for any threads, and what is asked of them."""

from __future__ import annotations

import pickle
from fractions import Fraction

import numpy as np
import pytest

import saddleback as sb
from tests.native import plane_sites
from tests.native.cancelling import check_progress_and_cancel

SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
ARRAYS = ("vertices", "edges", "edge_sites", "delaunay", "site_of", "hidden", "areas")


def same(a: sb.Voronoi2d, b: sb.Voronoi2d) -> bool:
    return all(getattr(a, name).tobytes() == getattr(b, name).tobytes() for name in ARRAYS)


def whole(values: np.ndarray, bits: int) -> np.ndarray:
    """Doubles as Python integers, in a unit of 2^-bits, which they are multiples of."""
    fractions = [Fraction(float(value)) * 2**bits for value in values.ravel()]
    assert all(value.denominator == 1 for value in fractions)
    return np.array([int(value) for value in fractions], dtype=object).reshape(values.shape)


def turns(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    u, v = b - a, c - a
    return u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]


def above(points: np.ndarray, heights: np.ndarray, triangles: np.ndarray, sites: np.ndarray) -> np.ndarray:
    """How far lifted sites lie above the planes of lifted triangles that turn counter-clockwise, times their areas."""
    a, b, c = (points[triangles[:, k]] - points[sites] for k in range(3))
    za, zb, zc = (heights[triangles[:, k]] - heights[sites] for k in range(3))
    zero = np.zeros_like(a)
    return -(za * turns(zero, b, c) + zb * turns(zero, c, a) + zc * turns(zero, a, b))


@pytest.mark.parametrize("spread", [0.0, 0.3, 10.0])
def test_it_is_regular_in_whole_numbers(spread: float) -> None:
    """Local regularity of a triangulation of the hull, and every hidden site above it: no more is needed."""
    rng, count = np.random.default_rng(3), 3000
    sites = np.round(rng.random((count, 2)) * 2**20) / 2**20
    weights = np.round(rng.random(count) * spread / count * 2**40) / 2**40
    diagram = sb.power_diagram_2d(sites, weights)
    points = whole(sites, 20)
    heights = (points**2).sum(axis=1) - whole(weights, 40)
    triangles = diagram.delaunay
    areas = turns(*(points[triangles[:, k]] for k in range(3)))
    assert (areas > 0).all()
    sides = {tuple(side): k for k, t in enumerate(triangles.tolist()) for side in zip(t, t[1:] + t[:1], strict=True)}
    inner = [(k, sides[b, a]) for (a, b), k in sides.items() if (b, a) in sides]
    tips = [int(np.setdiff1d(triangles[k], triangles[j])[0]) for j, k in inner]
    assert (above(points, heights, triangles[[j for j, _ in inner]], np.array(tips)) >= 0).all()
    border = [side for side in sides if side[::-1] not in sides]
    assert sum(areas) == sum(points[a][0] * points[b][1] - points[a][1] * points[b][0] for a, b in border)
    for a, b in border:
        assert (turns(points[a], points[b], points) >= 0).all()
    assert np.setdiff1d(np.arange(count), triangles).tolist() == diagram.hidden.tolist()
    assert (diagram.hidden.size > 0) == (spread > 0)
    for site in diagram.hidden:
        within = np.flatnonzero(
            np.all(
                [
                    turns(points[triangles[:, k]], points[triangles[:, (k + 1) % 3]], points[site]) >= 0
                    for k in range(3)
                ],
                axis=0,
            )
        )
        assert within.size > 0
        assert (above(points, heights, triangles[within], np.full(within.size, site)) >= 0).all()


@pytest.mark.parametrize("kind", [kind for kind in plane_sites.KINDS if kind not in {"huge", "tiny"}])
@pytest.mark.parametrize("count", [2, 3, 7, 2000])
def test_without_differences_it_is_the_voronoi_diagram(kind: str, count: int) -> None:
    sites = plane_sites.KINDS[kind](count, np.random.default_rng(count))
    plain, alike = sb.voronoi_2d(sites), sb.power_diagram_2d(sites, np.full(len(sites), 0.25))
    for name in ("edges", "edge_sites", "site_of"):
        assert (getattr(plain, name) == getattr(alike, name)).all()
    assert alike.hidden.size == 0
    size = np.maximum(np.abs(sites).max(), np.abs(plain.vertices))
    assert (np.abs(plain.vertices - alike.vertices) <= 1e-13 * size).all()


@pytest.mark.parametrize("kind", [kind for kind in plane_sites.KINDS if kind not in {"huge", "tiny"}])
def test_it_depends_on_neither_threads_nor_a_power_of_two(kind: str) -> None:
    rng = np.random.default_rng(5)
    sites = plane_sites.KINDS[kind](20_000, rng)
    weights = float(np.ptp(sites) / 100) ** 2 * rng.random(len(sites))
    one = sb.power_diagram_2d(sites, weights, threads=1)
    assert same(one, sb.power_diagram_2d(sites, weights, threads=3))
    assert one.powers.tobytes() == weights.tobytes()
    assert (sb.power_diagram_2d(4 * sites, 16 * weights).edge_sites == one.edge_sites).all()


def test_a_circle_that_crosses_another_shares_their_chord() -> None:
    diagram = sb.power_diagram_2d([[0, 0], [4, 0]], [9, 1])
    assert diagram.edges.tolist() == [[-1, -1]]
    line = diagram.edge_polyline(0, 1e-3, 5)
    assert line[:, 0] == pytest.approx([3, 3])
    assert sorted(line[:, 1]) == pytest.approx([-5, 5])
    assert diagram.locate([[2.9, 7], [3, 0], [3.1, -7]]).tolist() == [0, 0, 1]


def test_rays_are_cut_off_beyond_vertex_and_middle() -> None:
    sites = np.array([[0, 0], [4, 0], [2, 3]], dtype=float)
    diagram = sb.power_diagram_2d(sites, [1, 2, 3])
    place = diagram.vertices[0]
    powers = ((place - sites) ** 2).sum(axis=1) - [1, 2, 3]
    assert np.ptp(powers) < 1e-12
    for edge, (left, right) in enumerate(diagram.edge_sites):
        line = diagram.edge_polyline(edge, 1e-3, 1.0)
        assert (line[0] == place).all()
        at = ((line[1] - sites) ** 2).sum(axis=1) - [1, 2, 3]
        assert at[left] == pytest.approx(at[right])
        assert at[left] == pytest.approx(at.min())
        assert np.hypot(*(line[1] - line[0])) >= 1.0 - 1e-12
        assert diagram.edge_directions[edge] @ (line[1] - line[0]) > 0


def test_of_sites_at_one_place_the_heaviest_has_the_cell() -> None:
    diagram = sb.power_diagram_2d([[0, 0], [0, 0], [5, 0], [0, 0], [2, 7]], [1, 2, 1, 2, 0])
    assert diagram.site_of.tolist() == [0, 1, 2, 1, 4]
    assert diagram.hidden.tolist() == [0]
    assert diagram.cell_vertices(0).tolist() == []
    assert diagram.cell_vertices(3).tolist() == diagram.cell_vertices(1).tolist() == [0, -1]


def test_cells_of_no_area_are_hidden_in_whatever_order_sites_come() -> None:
    corners = [[0, 0], [4, 0], [4, 4], [0, 4]]
    sites, weights = np.array([*corners, [2, 2], [1, 2], [2, 0]], dtype=float), np.array([0, 0, 0, 0, -8, -7, -4.0])
    for seed in range(20):
        order = np.random.default_rng(seed).permutation(len(sites))
        diagram = sb.power_diagram_2d(sites[order], weights[order])
        # The middle one's power at the center of the corners is theirs; so is that of the one on a side along its ray.
        assert sorted(order[diagram.hidden]) == [4, 5, 6]
        assert len(diagram.vertices) == 1
        assert len(diagram.edges) == 4


def test_domain_gap_and_lift() -> None:
    rng = np.random.default_rng(8)
    sites, weights = rng.random((200, 2)), 1e-3 * rng.random(200)
    diagram = sb.power_diagram_2d(sites, weights, SQUARE)
    assert diagram.clipped is not None
    assert diagram.clipped.areas.sum() == pytest.approx(1)
    assert (diagram.clipped.areas[diagram.hidden] == 0).all()
    inset = diagram.clip(SQUARE, gap=0.01)
    owners = np.repeat(inset.loop_sites, np.diff(inset.loop_offsets))
    across = sites[:, None] - sites[owners]
    # Each point keeps half the gap from where another's power is equal.
    excess = ((inset.points - sites[:, None]) ** 2).sum(axis=2) - weights[:, None]
    excess -= ((inset.points - sites[owners]) ** 2).sum(axis=1) - weights[owners]
    away = excess / (2 * np.linalg.norm(across, axis=2) + 1e-300)
    away[owners, np.arange(len(owners))] = np.inf
    away[diagram.hidden] = np.inf
    assert away.min() == pytest.approx(0.005, abs=1e-12)
    steps = np.arange(11) / 10
    x, y = np.meshgrid(steps, steps)
    vertices = np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()])
    first = (np.arange(10)[:, None] * 11 + np.arange(10)).ravel()
    triangles = np.concatenate(
        [np.stack([first, first + 1, first + 12], 1), np.stack([first, first + 12, first + 11], 1)]
    )
    lifted = sb.Chart(sb.Mesh(vertices, triangles), vertices[:, :2]).lift(diagram)
    assert np.abs(lifted.areas - diagram.clipped.areas).max() < 1e-12


def test_it_travels() -> None:
    rng = np.random.default_rng(9)
    diagram = sb.power_diagram_2d(rng.random((50, 2)), rng.random(50))
    again = pickle.loads(pickle.dumps(diagram))
    assert same(diagram, again)
    assert again.powers.tobytes() == diagram.powers.tobytes()
    assert (again.locate(rng.random((9, 2))) >= 0).all()


def test_nothing_and_extremes() -> None:
    assert sb.power_diagram_2d(np.zeros((0, 2)), np.zeros(0)).edges.shape == (0, 2)
    for unit in (1e-120, 1e120):
        diagram = sb.power_diagram_2d(np.array([[0, 0], [4, 0], [2, 3]]) * unit, np.array([1, 2, 3]) * unit * unit)
        assert diagram.vertices / unit == pytest.approx(
            sb.power_diagram_2d([[0, 0], [4, 0], [2, 3]], [1, 2, 3]).vertices
        )


@pytest.mark.parametrize(
    ("weights", "sentence"),
    [
        ([1.0], r"weights: wanted shape \(2,\) of real numbers, got \(1,\)"),
        ([1.0, np.nan], "weights: weight 1 is nan, wanted a finite number"),
        (
            [1.0, 1e-300],
            "weights: weight 1 is 1e-300, too different in size from the squares of the sites' coordinates",
        ),
        ([1e300, 1.0], r"weights: weight 0 is 1e\+300, too different in size"),
    ],
)
def test_bad_weights_are_refused(weights: list[float], sentence: str) -> None:
    with pytest.raises(sb.InputError, match=sentence):
        sb.power_diagram_2d([[0, 0], [1, 1]], weights)


def test_it_stops_when_told() -> None:
    rng = np.random.default_rng(1)
    sites, weights = rng.random((400_000, 2)), 1e-6 * rng.random(400_000)
    check_progress_and_cancel(lambda job: sb.power_diagram_2d(sites, weights, job=job), 0.3)

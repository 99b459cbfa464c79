# SPDX-License-Identifier: MIT
"""Curves pulled tight, and curves through few points, against closed forms."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes

Floats = NDArray[np.float64]
ROUND, ROWS = 24, 21


def lathe(radius_at: Floats, height: float = 2.0) -> sb.Mesh:
    """A tube of rings of ROUND vertices, every other one turned by half a step, with the given radii."""
    turn = 2 * np.pi / ROUND
    rows = []
    for i, radius in enumerate(radius_at):
        angles = (np.arange(ROUND) + i % 2 / 2) * turn
        heights = np.full(ROUND, height * i / (len(radius_at) - 1))
        rows.append(np.column_stack([radius * np.cos(angles), radius * np.sin(angles), heights]))
    triangles = []
    for i in range(len(radius_at) - 1):
        for j in range(ROUND):
            a, b = i * ROUND + j, i * ROUND + (j + 1) % ROUND
            c, d = a + ROUND, b + ROUND
            triangles += [(a, b, c), (b, d, c)] if i % 2 == 0 else [(a, b, d), (a, d, c)]
    return sb.Mesh(np.vstack(rows), np.array(triangles))


def ring(row: int) -> NDArray[np.int32]:
    return np.arange(row * ROUND, (row + 1) * ROUND, dtype=np.int32)


def chord_length(radius: float) -> float:
    return float(2 * ROUND * radius * np.sin(np.pi / ROUND))


def test_a_ring_slips_to_the_narrowest_place_of_a_neck() -> None:
    radii = 0.5 + np.linspace(-1, 1, ROWS) ** 2
    mesh = lathe(radii)
    tight = sb.shorten_curve(sb.SurfaceCurve(mesh, ring(18), closed=True))
    assert tight.length == pytest.approx(chord_length(0.5), rel=1e-12)
    assert tight.points[:, 2] == pytest.approx(1.0, abs=1e-12)


def test_a_ring_of_a_straight_tube_is_tight_where_it_is() -> None:
    mesh = lathe(np.ones(ROWS))
    waist = chord_length(1.0) * np.cos(np.pi / ROUND / 2)  # between the rings the tube is no cylinder
    tight = sb.shorten_curve(sb.SurfaceCurve(mesh, ring(10), closed=True))
    assert waist <= tight.length <= chord_length(1.0) * (1 + 1e-12)
    again = sb.shorten_curve(sb.SurfaceCurve(mesh, tight.surface, closed=True))
    assert again.length == pytest.approx(tight.length, rel=1e-12)


def test_a_ring_that_nothing_holds_contracts() -> None:
    """On a ball."""
    sphere = sb.Mesh(*meshes.icosphere(3))
    above = sphere.vertices[:, 2] > 0.6
    inner = [t for t in sphere.triangles.tolist() if all(above[v] for v in t)]
    sides = {(a, b) for t in inner for a, b in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0]))}
    after = {a: b for a, b in sides if (b, a) not in sides}
    rim = [next(iter(after))]
    while after[rim[-1]] != rim[0]:
        rim.append(after[rim[-1]])
    tight = sb.shorten_curve(sb.SurfaceCurve(sphere, rim, closed=True))
    assert len(tight.points) == 1
    assert tight.length == 0


@pytest.mark.parametrize("begin", [9, 14])
@pytest.mark.parametrize("end", [8, 11])
def test_ends_on_edges_lie_in_both_faces(begin: int, end: int) -> None:
    """Whichever they are given in, a curve all about vertex 5 becomes the straight line between them."""
    mesh = sb.Mesh(*meshes.grid(4, 4))
    on_edges = [(begin, 9, 10), (9, 9, 5), (1, 4, 5), (0, 0, 5), (0, 1, 5), (3, 6, 5), (end, 6, 10)]
    weights = [np.isin(mesh.triangles[face], edge) / 2 for face, *edge in on_edges]
    points = sb.SurfacePoints([face for face, *_ in on_edges], weights)
    tight = sb.shorten_curve(sb.SurfaceCurve(mesh, points))
    assert tight.length == pytest.approx(np.sqrt(2) / 6, rel=1e-14)


@pytest.mark.parametrize(
    ("arrays", "walk", "length"),
    [
        (meshes.cube(), [5, 7, 3], np.sqrt(2)),
        (meshes.icosphere(0), [8, 3, 9, 1], 4 / np.sqrt(10 + 2 * np.sqrt(5))),
        (meshes.tetrahedron(), [1, 3, 2, 1], 0),
    ],
)
def test_a_way_through_the_tip_of_a_cone_slips_off(arrays: meshes.Arrays, walk: list[int], length: float) -> None:
    """Laid out flat it is straight on one side, and on the other it has less than pi."""
    tight = sb.shorten_curve(sb.SurfaceCurve(sb.Mesh(*arrays), walk))
    assert tight.length == pytest.approx(length, abs=1e-14)


def test_a_ring_through_the_tips_of_two_cones_slips_off() -> None:
    """Straight in its strip, it lies doubled between the two, about each of which there is no more than pi."""
    walk = [3, 1, 3, 0, 3, 2, 1, 3, 1, 2, 3, 0, 3, 1]
    tight = sb.shorten_curve(sb.SurfaceCurve(sb.Mesh(*meshes.tetrahedron()), walk, closed=True))
    assert tight.length == 0


@pytest.mark.parametrize("turns", [1, 2, -3])
def test_a_helix_is_the_straight_line_of_the_unrolled_tube(turns: int) -> None:
    """A prism unrolls to a strip, on which a curve that winds so many times is a line to one point of many."""
    mesh = sb.Mesh(*meshes.cylinder(ROUND, ROWS))
    step = 1 if turns > 0 else -1
    walk = [10 * ROUND + step * j % ROUND for j in range(ROUND * abs(turns) + 1)]
    walk = [i * ROUND for i in range(5, 10)] + walk + [i * ROUND for i in range(11, 16)]
    tight = sb.shorten_curve(sb.SurfaceCurve(mesh, walk))
    assert tight.length == pytest.approx(np.hypot(1.0, turns * chord_length(1.0)), rel=1e-12)


@pytest.mark.parametrize("walk", [[0, 1, 0], [0, 1, 2, 1, 0]])
@pytest.mark.parametrize("closed", [False, True])
def test_there_and_back_is_a_point(walk: list[int], closed: bool) -> None:
    mesh = sb.Mesh(*meshes.grid(4, 4))
    tight = sb.shorten_curve(sb.SurfaceCurve(mesh, walk[:-1] if closed else walk, closed=closed))
    assert len(tight.points) == 1
    assert tight.length == 0


def test_curves_through_points() -> None:
    mesh = lathe(1.5 + 0.3 * np.sin(np.linspace(0, 6, ROWS)))
    graph = sb.SaddleVertexGraph(mesh)
    stops = [3, 200, 310, 480]
    corners = sb.curve_through(graph, stops)
    smooth = sb.curve_through(graph, stops, smooth=True, closed=True)
    assert corners.length == pytest.approx(
        sum(graph.path(a, b, shorten=True).length for a, b in itertools.pairwise(stops)), rel=1e-12
    )
    for curve in (corners, smooth):
        places = curve.points.positions(mesh)
        assert all(np.linalg.norm(places - mesh.vertices[v], axis=1).min() == 0 for v in stops)
    assert smooth.closed
    # The directions to and from a point are one line.
    places = smooth.points.positions(mesh)
    at = int(np.flatnonzero((places == mesh.vertices[310]).all(axis=1))[0])
    apart = [p for p in range(len(places)) if not (places[p] == places[at]).all()]
    before, after = max(p for p in apart if p < at), min(p for p in apart if p > at)
    back, ahead = places[before] - places[at], places[after] - places[at]
    assert back @ ahead / np.linalg.norm(back) / np.linalg.norm(ahead) < -0.97  # the surface itself is bent there


def test_bad_input_is_told() -> None:
    mesh = sb.Mesh(*meshes.grid(4, 4))
    graph = sb.SaddleVertexGraph(mesh)
    two = np.vstack([mesh.vertices, mesh.vertices + (0, 0, 1)])
    both = sb.SaddleVertexGraph(sb.Mesh(two, np.vstack([mesh.triangles, mesh.triangles + mesh.vertex_count])))
    with pytest.raises(sb.InputError, match="curve: wanted a SurfaceCurve"):
        sb.shorten_curve([0, 1])
    with pytest.raises(sb.InputError, match="points: wanted at least 2, got 1"):
        sb.curve_through(graph, [0])
    with pytest.raises(sb.InputError, match="points: wanted at least 3, got 2"):
        sb.curve_through(graph, [0, 5], closed=True)
    with pytest.raises(sb.InputError, match="points: points 1 and 2 are the same"):
        sb.curve_through(graph, [0, 5, 5])
    with pytest.raises(sb.InputError, match="controls: points 0 and 1 are on different components"):
        sb.bezier_curve(both, [0, mesh.vertex_count])
    with pytest.raises(sb.InputError, match="halvings: wanted 0 to 10, got 11"):
        sb.bezier_curve(graph, [0, 5], halvings=11)
    with pytest.raises(sb.InputError, match="graph: wanted a SaddleVertexGraph"):
        sb.bezier_curve(mesh, [0, 5])


def test_a_curve_of_few_pieces_may_pass_over_thousands_of_vertices():
    """Around a corner of a large flat grid: steps were counted by pieces, and ended half-way."""
    side = 120
    mesh = sb.Mesh(*meshes.grid(side, side, jitter=0.3))
    index = np.arange(side * side, dtype=np.int32).reshape(side, side)
    walk = np.concatenate([index[1, 1:-1], index[2:-1, -2]])
    tight = sb.shorten_curve(sb.SurfaceCurve(mesh, walk))
    assert tight.length == pytest.approx(np.linalg.norm(mesh.vertices[walk[-1]] - mesh.vertices[walk[0]]), rel=1e-12)

# SPDX-License-Identifier: MIT
"""Voronoi diagrams of the plane: exact topology for any finite sites."""

from __future__ import annotations

import time
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import Delaunay

import saddleback as sb
from tests.native import plane_sites
from tests.native.cancelling import check_it_stops_when_silent, check_progress_and_cancel


@pytest.mark.parametrize("kind", plane_sites.KINDS)
@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 7, 12, 40, 300, 3000])
def test_every_kind_of_sites_is_exactly_right(kind, n):
    sites = plane_sites.KINDS[kind](n, np.random.default_rng(n))
    assert plane_sites.faults(sb.voronoi_2d(sites)) == []


@pytest.mark.parametrize("step", [1.0, 0.75, 2.0**-11, 2.0**-40])
@pytest.mark.parametrize("place", [(0.5, 0.5), (-40.5, 2.0), (-(2.0**20), -(2.0**33))])
def test_grids_that_doubles_just_tell_or_just_do_not(step, place):
    grid = np.stack(np.meshgrid(np.arange(25.0), np.arange(31.0)), axis=-1).reshape(-1, 2)
    sites = place + step * grid
    rng = np.random.default_rng(1)
    moved = rng.random(len(sites)) < 0.1  # some by the last digit of their coordinate
    sites[moved] = np.nextafter(sites[moved], rng.choice([-np.inf, np.inf], size=(moved.sum(), 2)))
    assert plane_sites.faults(sb.voronoi_2d(sites, threads=1)) == []


# Few values, near each other and far apart: many sites on common lines and circles, many nearly so.
coordinates = st.one_of(
    st.integers(-3, 3).map(float),
    st.integers(-4, 4).map(lambda i: 1.0 + i * 2.0**-52),
    st.floats(-10, 10, allow_subnormal=False).filter(lambda x: x == 0 or abs(x) > 1e-30),
)


@settings(max_examples=300, deadline=None)
@given(st.lists(st.tuples(coordinates, coordinates), max_size=14))
def test_any_few_sites_are_exactly_right(points):
    assert plane_sites.faults(sb.voronoi_2d(np.array(points).reshape(-1, 2))) == []


def test_the_proof_finds_faults():
    class Wrong:
        sites = np.array([[0.0, 0], [2, 0], [1, 0.5], [1, -0.5]])
        site_of = np.arange(4)
        delaunay = np.array([[0, 1, 2], [0, 3, 1]])
        vertices, edges = np.zeros((2, 2)), np.zeros((5, 2))

    assert plane_sites.faults(Wrong) == ["1 edges are not Delaunay's"]


@pytest.mark.parametrize("n", [10, 1000, 20000])
def test_triangles_are_those_of_qhull(n):
    sites = plane_sites.uniform(n, np.random.default_rng(n))
    ours, theirs = (
        np.unique(np.sort(t, axis=1), axis=0) for t in (sb.voronoi_2d(sites).delaunay, Delaunay(sites).simplices)
    )
    assert np.array_equal(ours, theirs)


def test_vertices_are_equally_far_from_their_sites():
    sites = plane_sites.uniform(500, np.random.default_rng(1))
    diagram = sb.voronoi_2d(sites)
    for site in range(len(sites)):
        corners = diagram.vertices[[v for v in diagram.cell_vertices(site) if v >= 0]]
        to_all = np.linalg.norm(corners[:, None] - sites, axis=2)
        assert np.allclose(to_all[:, site], to_all.min(axis=1), rtol=1e-9)


def test_a_flat_triangle_has_its_vertex_where_fractions_say():
    sites = [(0.0, 0.0), (1.0, 1e-17), (2.0, 0.0)]
    (x, y) = sb.voronoi_2d(sites).vertices[0]
    h = Fraction(1e-17)  # equally far from (0, 0) and (1, h) at x = 1: y^2 + 1 = (y - h)^2
    assert x == pytest.approx(1, rel=1e-12)
    assert y == pytest.approx(float((h * h - 1) / (2 * h)), rel=1e-12)


def test_a_square_has_one_vertex_of_four_cells():
    diagram = sb.voronoi_2d([[0, 0], [1, 0], [1, 1], [0, 1]])
    assert diagram.vertices.tolist() == [[0.5, 0.5]]
    assert (diagram.edges == [0, -1]).all()
    assert len(diagram.edges) == 4
    assert diagram.delaunay.tolist() == [[0, 1, 2], [0, 2, 3]]


def test_a_star_of_integers_on_one_circle_has_one_vertex():
    directions = [(3, 4), (4, 3), (5, 0), (0, 5)]
    sites = sorted({(a * x, b * y) for x, y in directions for a in (-1, 1) for b in (-1, 1)})
    diagram = sb.voronoi_2d(np.array(sites) * 0.25 + 10)
    assert diagram.vertices.tolist() == [[10, 10]]
    assert len(diagram.edges) == len(sites) == 12
    assert (diagram.delaunay[:, 0] == 0).all()


def test_two_sites_are_parted_by_a_line():
    diagram = sb.voronoi_2d([[0, 0], [2, 0]])
    assert diagram.edges.tolist() == [[-1, -1]]
    (left, right), direction = diagram.edge_sites[0], diagram.edge_directions[0]
    assert abs(direction[1]) == 1
    across = diagram.sites[left] - diagram.sites[right]
    assert direction[0] * across[1] - direction[1] * across[0] > 0


def test_rays_leave_along_their_direction():
    sites = plane_sites.uniform(50, np.random.default_rng(3))
    diagram = sb.voronoi_2d(sites)
    rays = diagram.edges[:, 1] < 0
    far = diagram.vertices[diagram.edges[rays, 0]] + 1e4 * diagram.edge_directions[rays]
    two_nearest = np.sort(np.argsort(np.linalg.norm(far[:, None] - sites, axis=2), axis=1)[:, :2], axis=1)
    assert np.array_equal(two_nearest, np.sort(diagram.edge_sites[rays], axis=1))


def test_edges_have_their_sites_at_their_sides():
    sites = plane_sites.uniform(200, np.random.default_rng(4))
    diagram = sb.voronoi_2d(sites)
    left, right = sites[diagram.edge_sites.T]
    across, along = right - left, diagram.edge_directions
    assert np.allclose(np.linalg.norm(along, axis=1), 1)
    assert (along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0] < 0).all()
    both = (diagram.edges >= 0).all(axis=1)
    span = np.diff(diagram.vertices[diagram.edges[both]], axis=1)[:, 0]
    long = np.linalg.norm(span, axis=1) > 1e-9
    assert (np.einsum("ij,ij->i", span, along[both])[long] > 0).all()


def test_cells_list_their_edges_before_their_vertices():
    diagram = sb.voronoi_2d(plane_sites.grid(400, np.random.default_rng(5)))
    for site in range(400):
        vertices, edges = diagram.cell_vertices(site), diagram.cell_edges(site)
        for k, edge in enumerate(edges):
            assert site in diagram.edge_sites[edge]
            assert {vertices[k - 1], vertices[k]} == set(diagram.edges[edge])


def test_no_sites_and_one():
    none, one = sb.voronoi_2d(np.zeros((0, 2))), sb.voronoi_2d([[1.5, 2]])
    for diagram in (none, one):
        assert [len(part) for part in (diagram.vertices, diagram.edges, diagram.delaunay)] == [0, 0, 0]
    assert one.cell_vertices(0).tolist() == []


def test_equal_sites_share_the_smallest_index():
    diagram = sb.voronoi_2d([[1, 0], [0, 0], [1, 0], [-0.0, 0], [0, 1]])
    assert diagram.site_of.tolist() == [0, 1, 0, 1, 4]
    assert diagram.delaunay.tolist() == [[0, 4, 1]]
    assert diagram.cell_vertices(3).tolist() == diagram.cell_vertices(1).tolist()


def test_numbering_does_not_depend_on_the_order_of_equal_calls():
    sites = plane_sites.small_integers(500, np.random.default_rng(6))
    first, second = sb.voronoi_2d(sites), sb.voronoi_2d(sites)
    for name in ("vertices", "edges", "edge_sites", "delaunay"):
        assert getattr(first, name).tobytes() == getattr(second, name).tobytes()


@pytest.mark.parametrize("sites", [[[0, 0], [1, np.nan]], [[0, 0], [np.inf, 1]]])
def test_sites_that_are_not_finite_are_named(sites):
    with pytest.raises(sb.InputError, match="site 1"):
        sb.voronoi_2d(sites)


def test_sites_too_different_in_size_are_named():
    with pytest.raises(sb.InputError, match="site 2"):
        sb.voronoi_2d([[1e300, 0], [0, 1e300], [1e-300, 1e-300]])


@pytest.mark.parametrize(("argument", "value"), [("circles", -1), ("threads", -1), ("device", "gpu")])
def test_wrong_options_are_named(argument, value):
    with pytest.raises(sb.InputError, match=argument):
        sb.voronoi_2d([[0, 0]], **{argument: value})


def test_progress_and_cancel():
    sites = plane_sites.uniform(1000, np.random.default_rng(7))
    job = sb.Job()
    sb.voronoi_2d(sites, job=job)
    assert job.fraction == 1
    job.cancel()
    with pytest.raises(sb.Cancelled):
        sb.voronoi_2d(sites, job=job)


@pytest.mark.parametrize("kind", plane_sites.KINDS)
def test_the_same_bytes_for_any_circles_and_threads(kind):
    sites = plane_sites.KINDS[kind](3000, np.random.default_rng(8))
    results = set()
    for circles, threads in ((1, 1), (7, 1), (100, 2)):
        diagram = sb.voronoi_2d(sites, circles=circles, threads=threads)
        arrays = ("vertices", "edges", "edge_sites", "site_of", "delaunay")
        results.add(tuple(getattr(diagram, name).tobytes() for name in arrays))
    assert len(results) == 1


def rings(n: int) -> plane_sites.Points:
    around = plane_sites.circle(n // 6, np.random.default_rng(n))
    return np.vstack([around * (1 + 0.3 * ring) for ring in range(6)])


def spiral(n: int) -> plane_sites.Points:
    away = np.sqrt(np.linspace(0.01, 1, n))
    return np.column_stack([away * np.cos(40 * away), away * np.sin(40 * away)])


def parabola(n: int) -> plane_sites.Points:
    x = np.linspace(-1, 1, n)
    return np.column_stack([x, x * x])


@pytest.mark.parametrize("n", [60, 600, 6000])
@pytest.mark.parametrize("curves", [rings, spiral, parabola])
def test_sites_along_curves_are_exactly_right(curves, n):
    """Halves of a ring have nothing but sites of their borders in common with the whole within it."""
    sites = curves(n)
    whole = sb.voronoi_2d(sites, circles=1)
    assert plane_sites.faults(whole) == []
    for circles in (2, 3, n // 20, n // 4):
        parts = sb.voronoi_2d(sites, circles=circles, threads=1)
        assert parts.edges.tobytes() == whole.edges.tobytes()
        assert parts.edge_sites.tobytes() == whole.edge_sites.tobytes()


def test_rings_take_about_as_long_as_any_sites():
    """Not the square of their number: that would be a hundred times as long."""

    def seconds(sites: plane_sites.Points) -> float:
        best = float("inf")
        for _ in range(3):
            start = time.perf_counter()
            sb.voronoi_2d(sites, threads=1)
            best = min(best, time.perf_counter() - start)
        return best

    rng = np.random.default_rng(2)
    assert seconds(plane_sites.two_rings(80_000, rng)) < 15 * seconds(plane_sites.uniform(80_000, rng))


def test_a_million_sites_stop_within_a_moment():
    sites = plane_sites.uniform(10**6, np.random.default_rng(9))
    check_progress_and_cancel(lambda job: sb.voronoi_2d(sites, job=job), 0.3)


def crowded(n: int, scales: int) -> plane_sites.Points:
    """All but a few sites share the smallest square that the box of all is divided into, and again."""
    sites = np.random.default_rng(n).random((n, 2))
    sites[:scales] = 10.0 ** (6 * (1 + np.arange(scales)))[:, None]
    return sites


@pytest.mark.parametrize("scales", [1, 3])
def test_sites_that_crowd_in_one_square_have_their_diagram(scales):
    assert not plane_sites.faults(sb.voronoi_2d(crowded(20_000, scales)))


def test_a_million_sites_in_one_square_stop_within_a_moment():
    sites = crowded(10**6, 1)
    check_progress_and_cancel(lambda job: sb.voronoi_2d(sites, threads=1, job=job), 0.639)


def test_millions_of_sites_on_one_line_stop_within_a_moment():
    sites = plane_sites.collinear(4 * 10**6, np.random.default_rng(3))
    check_progress_and_cancel(lambda job: sb.voronoi_2d(sites, threads=1, job=job), 0.7)


def circle_and_center(n: int) -> plane_sites.Points:
    return np.vstack([plane_sites.circle(n - 1, np.random.default_rng(n)), [[0, 0]]])


@pytest.mark.parametrize(
    ("curve", "fraction"),
    [(parabola, 0.6), (circle_and_center, 0.6), (circle_and_center, 0.75)],
    ids=["parabola, joining halves", "circle and center, joining halves", "circle and center, the widest cell"],
)
def test_millions_of_sites_along_curves_stop_at_once(curve, fraction):
    """One join takes them half a second, and so does one cell."""
    sites = curve(4 * 10**6)
    check_it_stops_when_silent(lambda job: sb.voronoi_2d(sites, threads=1, job=job), fraction)


def test_diagrams_of_sizes_nearly_alike_come_and_go() -> None:
    """Freed memory serves arrays of any size that it does for; whoever frees it last must know whence it came."""
    rng = np.random.default_rng(5)

    def diagrams(n: int) -> list[sb.Voronoi2d]:
        return [sb.voronoi_2d(rng.random((n, 2)), threads=1) for _ in range(24)]

    full, less = diagrams(1 << 14), diagrams(15_500)  # 64 KiB of numbers, and a little less
    del full
    again = diagrams(15_600)
    full = diagrams(1 << 14)
    del less, again
    less = diagrams(15_700)
    assert all(len(diagram.sites) == 15_700 for diagram in less)
    assert all(len(diagram.sites) == 1 << 14 for diagram in full)


def test_more_sites_than_32_bits_number_the_half_edges_of_are_refused() -> None:
    """At once: no page of these zeros is ever there."""
    with pytest.raises(sb.InputError, match="sites: wanted up to 250000000, got 250000001"):
        sb.voronoi_2d(np.zeros((250_000_001, 2)), device="cpu")

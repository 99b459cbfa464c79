# SPDX-License-Identifier: MIT
"""Additively weighted Voronoi diagrams: exact topology for any finite disks."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import saddleback as sb
from tests.native import plane_sites, weighted_sites
from tests.native.cancelling import check_it_stops_when_silent, check_progress_and_cancel
from tests.native.weighted_sites import KINDS, weighted_distances

SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1]]


def shoelace(loop):
    x, y = (loop - loop[0]).T
    return 0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1))


def size_of(sites):
    return np.abs(sites).max(initial=0) or 1.0


def faults(diagram, sites, weights):
    """What is wrong with a diagram by brute force over all sites; empty: nothing."""
    wrong = []
    hidden = weighted_sites.hidden(sites, weights)
    if diagram.hidden.tolist() != hidden:
        wrong.append("hidden sites")
    own = (diagram.site_of == np.arange(len(sites))) & ~np.isin(np.arange(len(sites)), hidden)
    cells = np.count_nonzero(own)
    # Cells are star-shaped, so that edges, vertices and infinity hang together.
    if cells and len(diagram.edges) != len(diagram.vertices) + cells - 1:
        wrong.append("Euler's formula")
    size = size_of(sites)
    if cells >= 3 and len(diagram.vertices):
        distances = np.sort(weighted_distances(diagram.vertices, sites[own], weights[own]), axis=1)
        if (np.ptp(distances[:, :3], axis=1) > 1e-9 * (size + np.abs(diagram.vertices).max(axis=1))).any():
            wrong.append("a vertex is not nearest to three sites")
    for edge, (left, right) in enumerate(diagram.edge_sites):
        line = diagram.edge_polyline(edge, 1e-3 * size, 0.1 * size)
        for point in (line[0], line[-1]):
            distances = weighted_distances(point[None], sites, weights)[0]
            if np.abs(distances[[left, right]] - distances.min()).max() > 1e-9 * (size + np.abs(point).max()):
                wrong.append(f"edge {edge} is not nearest to its sites")
        along, across = line[1] - line[0], sites[right] - sites[left]
        is_long = len(line) == 2 and np.hypot(*along) > 1e-9 * (size + np.abs(line).max())
        if is_long and along[0] * across[1] - along[1] * across[0] > 1e-9 * np.hypot(*along) * np.hypot(*across):
            wrong.append(f"edge {edge} has its sites on the wrong sides")
    return wrong


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("n", [1, 2, 3, 4, 7, 12, 40, 150])
def test_every_kind_of_disks_is_right(kind, n):
    sites, weights = KINDS[kind](n, np.random.default_rng(n))
    scaled = plane_sites.scaled(sites)
    scale = size_of(scaled) / size_of(sites)
    assert faults(sb.voronoi_2d(scaled, weights * scale), scaled, weights * scale) == []


# Few values, near each other and far apart: disks that touch, lie in each other or nearly so, and many on one circle.
coordinates = st.one_of(st.integers(-3, 3).map(float), st.integers(-2, 2).map(lambda i: 1.0 + i * 2.0**-52))
radii = st.one_of(st.integers(-2, 2).map(float), st.integers(-2, 2).map(lambda i: 1.0 + i * 2.0**-52))


@settings(max_examples=200, deadline=None)
@given(st.lists(st.tuples(coordinates, coordinates, radii), min_size=1, max_size=12))
def test_any_few_disks_are_right(disks):
    rows = np.array(disks)
    assert faults(sb.voronoi_2d(rows[:, :2], rows[:, 2]), rows[:, :2], rows[:, 2]) == []


@pytest.mark.parametrize("kind", KINDS)
def test_the_same_bytes_for_any_circles_and_threads(kind):
    sites, weights = KINDS[kind](700 if kind != "one_ring" else 60, np.random.default_rng(8))
    results = set()
    for circles, threads in ((1, 1), (7, 1), (100, 2), (0, 2)):
        diagram = sb.voronoi_2d(sites, weights, circles=circles, threads=threads)
        arrays = ("vertices", "edges", "edge_sites", "site_of", "hidden", "delaunay")
        results.add(tuple(getattr(diagram, name).tobytes() for name in arrays))
    assert len(results) == 1


def test_many_disks_side_by_side_are_right():
    """Threads exchange triangles of different sites, then those between them: a quarter of the disks are hidden."""
    count, rng = 40_000, np.random.default_rng(12)
    sites, weights = rng.random((count, 2)), 1.2 * rng.random(count) / np.sqrt(count)
    diagram = sb.voronoi_2d(sites, weights, threads=1)
    for vertex in rng.choice(len(diagram.vertices), 500, replace=False):
        about = np.unique(diagram.edge_sites[(diagram.edges == vertex).any(axis=1)])
        distances = weighted_distances(diagram.vertices[vertex][None], sites, weights)[0]
        assert len(about) >= 3
        assert np.abs(distances[about] - distances.min()).max() <= 1e-9
    assert len(diagram.hidden) > count / 10
    for threads in (2, 3, 8):
        other = sb.voronoi_2d(sites, weights, threads=threads)
        for name in ("vertices", "edges", "edge_sites", "site_of", "hidden"):
            assert getattr(other, name).tobytes() == getattr(diagram, name).tobytes()
        assert [part.tobytes() for part in other.cells] == [part.tobytes() for part in diagram.cells]


@pytest.mark.parametrize("weight", [0, -3.5, 1e6])
def test_equal_weights_are_none(weight):
    sites = plane_sites.grid(400, np.random.default_rng(1))
    ours, plain = sb.voronoi_2d(sites, np.full(400, weight)), sb.voronoi_2d(sites)
    for name in ("vertices", "edges", "edge_sites", "delaunay"):
        assert getattr(ours, name).tobytes() == getattr(plain, name).tobytes()


def test_nearly_equal_weights_have_the_topology_of_none():
    sites = plane_sites.uniform(2000, np.random.default_rng(2))
    weights = np.zeros(2000)
    weights[0] = 1e-18
    ours, plain = sb.voronoi_2d(sites, weights), sb.voronoi_2d(sites)
    assert sorted(map(sorted, ours.delaunay.tolist())) == sorted(map(sorted, plain.delaunay.tolist()))
    assert np.allclose(np.sort(ours.vertices, axis=0), np.sort(plain.vertices, axis=0), rtol=1e-12, atol=1e-12)


def test_only_differences_of_weights_matter():
    sites, weights = KINDS["random_disks"](500, np.random.default_rng(3))
    weights = np.round(weights * 2**20) / 2**20
    first, second = sb.voronoi_2d(sites, weights), sb.voronoi_2d(sites, weights - 64)
    assert first.vertices.tobytes() == second.vertices.tobytes()
    assert first.edges.tobytes() == second.edges.tobytes()


def test_three_circles_that_touch_have_soddys_between_them():
    diagram = sb.voronoi_2d([[0, 0], [3, 0], [0, 4]], [1, 2, 3])
    assert len(diagram.vertices) == 1
    distances = weighted_distances(diagram.vertices, diagram.sites, diagram.weights)
    assert np.allclose(distances, 6 / 23, rtol=1e-14)


def test_a_light_site_between_two_heavy_ones():
    diagram = sb.voronoi_2d([[-2, 0], [2, 0], [0, 0]], [1, 1, -0.5])
    assert sorted(diagram.vertices[:, 1]) == pytest.approx([-7 / 12, 7 / 12], rel=1e-15)
    assert diagram.vertices[:, 0].tolist() == [0, 0]
    assert sorted(map(sorted, diagram.edge_sites.tolist())) == [[0, 1], [0, 1], [0, 2], [1, 2]]
    assert len(diagram.cell_vertices(2)) == len(diagram.cell_edges(2)) == 2
    rays = (diagram.edges == -1).any(axis=1)
    assert np.count_nonzero(rays) == 2
    assert np.allclose(np.abs(diagram.edge_directions[rays]), [[0, 1], [0, 1]])


def test_cells_without_vertices():
    diagram = sb.voronoi_2d([[0, 0], [10, 0], [-10, 0]], [0, -9, -9])
    assert len(diagram.vertices) == 0
    assert diagram.edges.tolist() == [[-1, -1], [-1, -1]]
    assert diagram.cell_vertices(0).tolist() == [-1, -1]
    assert diagram.cell_vertices(1).tolist() == [-1]
    assert np.isinf(diagram.areas).all()


def test_many_edges_between_two_cells():
    light = np.column_stack([np.zeros(9), np.arange(9) * 5.0 - 20])
    diagram = sb.voronoi_2d(np.vstack([[[-40, 0], [40, 0]], light]), [0, 0] + [-39.5] * 9)
    pairs = sorted(map(sorted, diagram.edge_sites.tolist()))
    assert pairs.count([0, 1]) == 8  # six between light cells, two rays
    assert faults(diagram, diagram.sites, diagram.weights) == []


@pytest.mark.parametrize(("weight", "hides"), [(5 - 2**-50, False), (5, True), (5 + 2**-50, True)])
def test_a_disk_that_touches_another_from_inside_is_hidden(weight, hides):
    diagram = sb.voronoi_2d([[1, 1], [4, 5], [9, 9]], [weight, 0, 0])
    assert diagram.hidden.tolist() == ([1] if hides else [])
    assert diagram.site_of.tolist() == [0, 1, 2]
    if hides:
        assert diagram.cell_vertices(1).tolist() == []
        assert diagram.areas[1] == 0


def test_a_disk_that_nearly_touches_a_larger_one_from_inside_near_a_line():
    rows = np.array(
        [
            [0.27019392520477026, 8.940986559087143e-10, 0.00029478817356649466],
            [0.1198973410860541, 1.7764376949126581e-10, 6.939155081855426e-05],
            [0.025449388364391257, 4.662960410111777e-10, 0.00043183444711671613],
            [0.8959032346430146, 7.441054593343151e-10, 0.00019837702901230738],
            [0.11954397950976936, 3.446975444786802e-10, 0.0004225873899825667],
        ]
    )
    diagram = sb.voronoi_2d(rows[:, :2], rows[:, 2])
    # The heavy one's cell lies between lines, but for the last site far away and the light one's narrow cell inside.
    pairs = sorted(map(sorted, diagram.edge_sites.tolist()))
    assert pairs == [[0, 1], [0, 3], [0, 4], [0, 4], [1, 4], [2, 4], [3, 4], [3, 4]]
    assert len(diagram.vertices) == 4


def test_sites_at_one_place():
    diagram = sb.voronoi_2d([[0, 0], [9, 9], [0, 0], [0, 0], [9, 9], [0, 0]], [1, 0, 2, 2, 0, 1])
    assert diagram.site_of.tolist() == [0, 1, 2, 2, 1, 0]
    assert diagram.hidden.tolist() == [0, 5]


def test_no_sites_and_one():
    assert len(sb.voronoi_2d(np.zeros((0, 2)), []).edges) == 0
    assert sb.voronoi_2d([[1, 2]], [3]).cell_vertices(0).tolist() == []
    assert sb.voronoi_2d([[0, 0], [0, 1]], [0, 3]).hidden.tolist() == [0]


@pytest.mark.parametrize("kind", KINDS)
def test_the_nearest_site_of_any_point(kind):
    rng = np.random.default_rng(4)
    sites, weights = KINDS[kind](400, rng) if kind != "one_ring" else KINDS[kind](60, rng)
    low, high = sites.min(axis=0), sites.max(axis=0)
    points = low + (high - low) * (1.5 * rng.random((1500, 2)) - 0.25)
    found = sb.voronoi_2d(sites, weights).locate(points)
    distances = weighted_distances(points, sites, weights)
    assert (distances[np.arange(len(points)), found] - distances.min(axis=1)).max() <= 1e-13 * size_of(sites)


def test_equally_near_sites_give_the_smallest_index():
    diagram = sb.voronoi_2d([[0, 5], [4, 0], [-4, 0], [0, -2], [0, 20]], [4, 3, 3, 1, 0])
    assert diagram.locate([[0, 0], [0, -0.25], [0, 0.25]]).tolist() == [0, 3, 0]
    assert sb.voronoi_2d([[0, 0], [1, 0], [1, 1], [0, 1]]).locate([[0.5, 0.5]]).tolist() == [0]


def edge_points(diagram, tolerance):
    return [diagram.edge_polyline(edge, tolerance) for edge in range(len(diagram.edges))]


def test_polylines_stay_within_their_tolerance():
    sites, weights = KINDS["random_disks"](60, np.random.default_rng(5))
    diagram = sb.voronoi_2d(sites, weights)
    for tolerance in (1e-2, 1e-4):
        for (left, right), line in zip(diagram.edge_sites, edge_points(diagram, tolerance), strict=True):
            shares = np.linspace(0, 1, 9)[:, None, None]
            chords = (line[:-1] * (1 - shares) + line[1:] * shares).reshape(-1, 2)
            for points, bound in ((line, 1e-12), (chords, 2 * tolerance)):
                distances = weighted_distances(points, sites[[left, right]], weights[[left, right]])
                assert np.abs(np.diff(distances, axis=1)).max() <= bound


def test_polylines_lead_from_vertex_to_vertex_and_out():
    sites, weights = KINDS["random_disks"](60, np.random.default_rng(6))
    diagram = sb.voronoi_2d(sites, weights)
    for (first, second), line in zip(diagram.edges, edge_points(diagram, 1e-3), strict=True):
        assert first == -1 or (line[0] == diagram.vertices[first]).all()
        assert second == -1 or (line[-1] == diagram.vertices[second]).all()
    rays = np.nonzero(diagram.edges[:, 1] < 0)[0]
    for ray in rays:
        line = diagram.edge_polyline(ray, 1e-3, 1e4)
        assert np.allclose((line[-1] - line[-2]) / np.linalg.norm(line[-1] - line[-2]), diagram.edge_directions[ray],
                           atol=1e-3)  # fmt: skip


def test_a_straight_edge_has_two_points():
    diagram = sb.voronoi_2d([[0, 0], [2, 0], [1, 3]])
    assert [len(line) for line in edge_points(diagram, 1e-6)] == [2, 2, 2]
    (line,) = edge_points(sb.voronoi_2d([[0, 0], [2, 0]]), 1e-6)
    assert np.allclose(np.abs(line), [[1, 4], [1, 4]])


def test_areas_and_centroids_of_bounded_cells():
    sites, weights = KINDS["random_disks"](200, np.random.default_rng(7))
    diagram = sb.voronoi_2d(sites, weights)
    angles = 2 * np.pi * np.arange(20000) / 20000
    u = np.column_stack([np.cos(angles), np.sin(angles)])
    visible = np.setdiff1d(np.arange(200), diagram.hidden)
    for site in visible[:60]:
        others = visible[visible != site]
        way, e = sites[others] - sites[site], weights[others] - weights[site]
        height = ((u @ way.T + e) / ((way**2).sum(axis=1) - e**2)).max(axis=1)
        if height.min() <= 0.05:
            continue
        reach = 0.5 / height
        area = np.pi * np.mean(reach**2)
        assert diagram.areas[site] == pytest.approx(area, rel=1e-5)
        centroid = sites[site] + 2 * np.pi / 3 * (reach[:, None] ** 3 * u).mean(axis=0) / area
        assert np.allclose(diagram.centroids[site], centroid, atol=1e-5 * area**0.5)


@pytest.mark.parametrize("n", [1, 2, 3, 50, 500])
@pytest.mark.parametrize("kind", ["random_disks", "heavy_and_light", "steep", "clustered_disks"])
def test_clipped_areas_sum_to_the_domain(kind, n):
    sites, weights = KINDS[kind](n, np.random.default_rng(n))
    holes = [SQUARE, [[0.2, 0.2], [0.4, 0.2], [0.4, 0.4], [0.2, 0.4]], [[0.6, 0.5], [0.9, 0.6], [0.5, 0.9]]]
    comb = [[0, 0], [1, 0], *([[1 - k * 0.1 - d, y] for k in range(9) for d, y in ((0, 1), (0.02, 0.1))]), [0, 1]]
    diagram = sb.voronoi_2d(sites, weights)
    for domain in (SQUARE, holes, comb):
        loops = [np.array(loop) for loop in (domain if np.ndim(domain[0][0]) else [domain])]
        clipped = diagram.clip(domain)
        area = abs(shoelace(loops[0])) - sum(abs(shoelace(hole)) for hole in loops[1:])
        assert clipped.areas.sum() == pytest.approx(area, rel=1e-12)
        assert clipped.areas.min() >= -1e-15
        owners = np.repeat(clipped.loop_sites, np.diff(clipped.loop_offsets))
        distances = weighted_distances(clipped.points, sites, weights)
        mean_width = (abs(shoelace(loops[0])) / n) ** 0.5
        assert (distances[np.arange(len(owners)), owners] - distances.min(axis=1)).max() < 4e-3 * mean_width


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("seed", range(40))
def test_clipped_cells_of_disks_nearly_in_line_fill_the_domain(seed, size):
    """Their vertices are up to 1e16 times as far away as the sites are from each other."""
    rng = np.random.default_rng(seed)
    sites, weights = weighted_sites.in_line(int(rng.integers(3, 12)), rng)
    low, width = sites.min(axis=0), np.ptp(sites, axis=0).max() / size
    diagram = sb.voronoi_2d((sites - low) / width, weights / width)
    clipped = diagram.clip(size * np.array([(0, 0), (1, 0), (1, 1), (0, 1)]), tolerance=1e-5 * size)
    assert abs(clipped.areas.sum() / size**2 - 1) < 1e-9
    seen = clipped.areas > 0
    moment = clipped.areas[seen] @ clipped.centroids[seen]
    assert abs(moment / size**3 - 0.5).max() < 1e-9


def test_clipped_cells_approach_the_curved_ones():
    sites, weights = KINDS["random_disks"](100, np.random.default_rng(9))
    diagram = sb.voronoi_2d(sites, weights)
    clipped = diagram.clip([[-9, -9], [9, -9], [9, 9], [-9, 9]], tolerance=1e-8)
    inner = (diagram.areas > 0) & (diagram.areas < 0.1)
    assert np.count_nonzero(inner) > 40
    assert np.allclose(clipped.areas[inner], diagram.areas[inner], rtol=0, atol=1e-8)
    assert np.allclose(clipped.centroids[inner], diagram.centroids[inner], rtol=0, atol=1e-6)


@pytest.mark.parametrize(
    ("weights", "text"),
    [
        ([1, 2], "weights: wanted shape"),
        ([[1, 2, 3]], "weights: wanted shape"),
        ([0, 1, np.nan], "weight 2 is nan"),
        ([0, -np.inf, 0], "weight 1 is -inf"),
        ([0, 1e300, 0], "weight 1 is 1e.300, too different in size"),
        ("abc", "weights"),
    ],
)
def test_wrong_weights_are_named(weights, text):
    with pytest.raises(sb.InputError, match=text):
        sb.voronoi_2d([[0, 0], [1, 0], [0, 1]], weights)


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ((3, 0.1), "edge"),
        ((-1, 0.1), "edge"),
        ((0, 0), "tolerance"),
        ((0, np.nan), "tolerance"),
        ((0, 1, -1), "extent"),
    ],
)
def test_wrong_polylines_are_named(arguments, text):
    with pytest.raises(sb.InputError, match=text):
        sb.voronoi_2d([[0, 0], [2, 0], [1, 3]], [0, 0.5, 0]).edge_polyline(*arguments)


def test_progress_and_cancel():
    sites, weights = KINDS["random_disks"](1000, np.random.default_rng(7))
    job = sb.Job()
    sb.voronoi_2d(sites, weights, job=job)
    assert job.fraction == 1
    job.cancel()
    with pytest.raises(sb.Cancelled):
        sb.voronoi_2d(sites, weights, job=job)


def test_many_disks_stop_within_a_moment():
    sites, weights = KINDS["random_disks"](10**5, np.random.default_rng(9))
    check_progress_and_cancel(lambda job: sb.voronoi_2d(sites, weights, job=job), 0.4)


def test_a_disk_with_thousands_of_sides_stops_at_once():
    """Its cell alone takes seconds."""
    sites = np.vstack([plane_sites.circle(19_999, np.random.default_rng(1)), [[0, 0]]])
    weights = np.zeros(20_000)
    weights[-1] = 0.5
    check_it_stops_when_silent(lambda job: sb.voronoi_2d(sites, weights=weights, threads=1, job=job), 0.7)


def test_equal_sites_have_the_same_area_and_center() -> None:
    """Where the second of two lay between heavier cells, its sides were taken as those of another's."""
    rng = np.random.default_rng(8)
    sites = rng.random((40, 2))
    weights = np.where(np.arange(40) % 9 == 0, 0.2, 0.0)
    diagram = sb.voronoi_2d(np.vstack([sites, sites[::-1]]), np.r_[weights, weights[::-1]])
    assert np.isfinite(diagram.areas).sum() > 20
    assert np.array_equal(diagram.areas[:40], diagram.areas[:39:-1])
    assert np.array_equal(diagram.centroids[:40], diagram.centroids[:39:-1], equal_nan=True)


@pytest.mark.parametrize("step", [0.125, 0.25])
def test_cells_that_touch_the_domain_in_a_corner_are_whole(step: float) -> None:
    """On lattices, however they are turned; ways in and out were confused there, and cells lost."""
    axis = np.arange(0, 1 + step, step)
    lattice = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    sites = np.vstack([lattice, lattice + step / 2]) - 0.5
    square = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
    for heavy in range(len(sites)):
        weights = np.where(np.arange(len(sites)) == heavy, 3 * step, 0.0)
        areas = [
            sb.voronoi_2d(sites @ turn, weights).clip(square).areas
            for turn in (np.array([[x, 0], [0, y]])[:, ::order] for x in (1, -1) for y in (1, -1) for order in (1, -1))
        ]
        np.testing.assert_allclose(np.sum(areas, axis=1), 1, rtol=1e-12)
        np.testing.assert_allclose(areas, [areas[0]] * 8, atol=1e-4 * step**2)

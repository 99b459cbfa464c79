# SPDX-License-Identifier: MIT
"""What is asked of a diagram of the plane: areas, nearest sites, cells within polygons."""

from __future__ import annotations

import time

import numpy as np
import pytest
from scipy.spatial import cKDTree

import saddleback as sb
from tests.native import plane_sites

SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1]]
L_SHAPE = [[0, 0], [1, 0], [1, 0.3], [0.4, 0.3], [0.4, 1], [0, 1]]
COMB = [[0, 0], [1, 0], *([[1 - k * 0.1 - d, y] for k in range(9) for d, y in ((0, 1), (0.02, 0.1))]), [0, 1]]
HOLES = [SQUARE, [[0.2, 0.2], [0.4, 0.2], [0.4, 0.4], [0.2, 0.4]], [[0.6, 0.5], [0.9, 0.6], [0.5, 0.9]]]
DOMAINS = {"square": SQUARE, "l_shape": L_SHAPE, "comb": COMB, "holes": HOLES}


def shoelace(loop):
    x, y = (np.asarray(loop, dtype=float) - np.asarray(loop, dtype=float)[0]).T
    return 0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1))


def area_of(domain):
    loops = domain if np.ndim(domain[0][0]) else [domain]
    return abs(shoelace(loops[0])) - sum(abs(shoelace(hole)) for hole in loops[1:])


@pytest.mark.parametrize("domain", DOMAINS)
@pytest.mark.parametrize("kind", ["uniform", "clusters", "duplicates", "nearly_collinear", "circle"])
@pytest.mark.parametrize("n", [1, 2, 3, 50, 2000])
def test_clipped_areas_sum_to_the_domain(domain, kind, n):
    sites = plane_sites.KINDS[kind](n, np.random.default_rng(n))
    clipped = sb.voronoi_2d(sites).clip(DOMAINS[domain])
    assert clipped.areas.min() >= -1e-15
    assert clipped.areas.sum() == pytest.approx(area_of(DOMAINS[domain]), rel=1e-12)


def test_clipped_loops_have_the_areas_told():
    sites = plane_sites.uniform(300, np.random.default_rng(1))
    diagram = sb.voronoi_2d(sites, domain=HOLES)
    clipped, areas = diagram.clipped, np.zeros(300)
    for i, site in enumerate(clipped.loop_sites):
        areas[site] += shoelace(clipped.points[clipped.loop_offsets[i] : clipped.loop_offsets[i + 1]])
    assert np.allclose(areas, clipped.areas, rtol=1e-9, atol=1e-15)
    assert (np.diff(clipped.loop_sites) >= 0).all()


def test_clipped_points_are_nearest_to_their_site():
    sites = plane_sites.uniform(400, np.random.default_rng(2))
    clipped = sb.voronoi_2d(sites).clip(COMB)
    owners = np.repeat(clipped.loop_sites, np.diff(clipped.loop_offsets))
    nearest = cKDTree(sites).query(clipped.points)[0]
    assert np.allclose(np.linalg.norm(clipped.points - sites[owners], axis=1), nearest, atol=1e-12)


def test_one_site_owns_the_domain_with_its_holes():
    clipped = sb.voronoi_2d([[5, 5]], domain=HOLES).clipped
    assert np.diff(clipped.loop_offsets).tolist() == [4, 4, 3]
    assert [shoelace(clipped.points[a:b]) > 0 for a, b in ((0, 4), (4, 8), (8, 11))] == [True, False, False]


def test_a_cell_may_fall_into_parts():
    u_shape = [[0, 0], [3, 0], [3, 2], [2, 2], [2, 1], [1, 1], [1, 2], [0, 2]]
    clipped = sb.voronoi_2d([[1.5, 10], [1.5, -7]]).clip(u_shape)  # parted at y = 1.5
    assert clipped.loop_sites.tolist() == [0, 0, 1]
    assert clipped.areas.tolist() == [1.0, 4.0]


def test_areas_and_centroids_of_bounded_cells():
    diagram = sb.voronoi_2d(plane_sites.grid(100, np.random.default_rng(3)))
    inner = ((diagram.sites > 0) & (diagram.sites < 9)).all(axis=1)
    assert np.allclose(diagram.areas[inner], 1)
    assert np.isinf(diagram.areas[~inner]).all()
    assert np.allclose(diagram.centroids[inner], diagram.sites[inner])
    assert np.isnan(diagram.centroids[~inner]).all()


@pytest.mark.parametrize("kind", plane_sites.KINDS)
def test_the_nearest_site_of_any_point(kind):
    rng = np.random.default_rng(4)
    sites = plane_sites.scaled(plane_sites.KINDS[kind](800, rng))
    low, high = sites.min(axis=0), sites.max(axis=0)
    points = np.vstack([low + (high - low) * (1.5 * rng.random((1500, 2)) - 0.25), sites])
    found = sb.voronoi_2d(sites).locate(points)
    scale = np.abs(sites).max()
    squared = ((points[:, None] - sites) / scale) ** 2
    distances = squared.sum(axis=2)
    assert (distances[np.arange(len(points)), found] <= distances.min(axis=1) * (1 + 1e-12)).all()


def test_equally_near_sites_give_the_smallest_index():
    sites = [[1, 1], [0, 0], [1, 0], [0, 1], [0, 0]]
    assert sb.voronoi_2d(sites).locate([[0.5, 0.5], [0.5, 0], [0, 0.5], [0, -1]]).tolist() == [0, 1, 1, 1]


def test_a_million_points_find_their_sites():
    rng = np.random.default_rng(5)
    sites, points = rng.random((20000, 2)), rng.random((10**6, 2))
    distances, nearest = cKDTree(sites).query(points)
    found = sb.voronoi_2d(sites).locate(points)
    differ = found != nearest
    assert np.allclose(np.linalg.norm(points[differ] - sites[found[differ]], axis=1), distances[differ], rtol=1e-15)


@pytest.mark.parametrize(
    ("domain", "text"),
    [
        ([[0, 0], [1, 0]], "2 corners"),
        ([[0, 0], [1, 1], [1, 0], [0, 1]], "meets"),
        ([[0, 0], [2, 0], [1, 0], [1, 1]], "meets"),
        ([SQUARE, [[2, 2], [3, 2], [3, 3]]], "outside"),
        ([SQUARE, [[0.5, 0.5], [2, 0.5], [0.5, 0.6]]], "meets"),
        ([[0, 0], [1, 0], [np.nan, 1]], "corner 2"),
        ([[0, 0], [1, np.nan], [1, 1]], "corner 1"),
        ([SQUARE, [[0.1, 0.1], [0.9, 0.1], [0.5, 0.9]], [[0.4, 0.2], [0.6, 0.2], [0.5, 0.4]]], "loop 1"),
    ],
)
def test_domains_that_are_no_simple_polygons_are_named(domain, text):
    with pytest.raises(sb.InputError, match=text):
        sb.voronoi_2d([[0, 0]], domain=domain)


def test_a_polygon_is_refused_by_its_name():
    diagram = sb.voronoi_2d([[0, 0]])
    for polygon in ([1, 2], [[0, 0], [1, 0]], [[0, 0], [1, 1], [1, 0], [0, 1]], []):
        with pytest.raises(sb.InputError, match=r"^polygon: "):
            diagram.clip(polygon)


def test_time_does_not_grow_with_holes_or_corners_times_cells():
    """A sheet with holes took loops squared, and each cell away from the outline one look at every corner."""
    turn = 2 * np.pi * np.arange(16) / 16
    ring = 0.3 * np.column_stack([np.cos(turn), np.sin(turn)])
    holes = [ring + [i + 0.5, j + 0.5] for i in range(50) for j in range(50)]
    start = time.perf_counter()
    plate = sb.voronoi_2d([[1, 1]], domain=[[[0, 0], [50, 0], [50, 50], [0, 50]], *holes]).clipped
    assert plate.areas.sum() == pytest.approx(2500 * (1 - abs(shoelace(ring))), rel=1e-12)
    assert time.perf_counter() - start < 2  # was 15
    turn = 2 * np.pi * np.arange(20_000) / 20_000
    disk = np.column_stack([np.cos(turn), np.sin(turn)])
    sites = 0.9 * plane_sites.uniform(100_000, np.random.default_rng(6))  # far from the outline
    diagram = sb.voronoi_2d(np.vstack([sites, 3 * disk[::500]]))
    start = time.perf_counter()
    areas = diagram.clip(0.001 * disk + sites.mean(axis=0)).areas
    assert areas.sum() == pytest.approx(1e-6 * shoelace(disk), rel=1e-9)
    areas = diagram.clip(4 * disk).areas
    assert areas.sum() == pytest.approx(16 * shoelace(disk), rel=1e-10)
    assert time.perf_counter() - start < 2


def test_locate_refuses_what_it_cannot_answer():
    with pytest.raises(sb.InputError, match="point 1"):
        sb.voronoi_2d([[0, 0]]).locate([[0, 0], [np.nan, 0]])
    with pytest.raises(sb.InputError, match="no sites"):
        sb.voronoi_2d(np.zeros((0, 2))).locate([[0, 0]])


def test_all_cells_at_once():
    diagram = sb.voronoi_2d(plane_sites.duplicates(300, np.random.default_rng(6)))
    offsets, vertices = diagram.cells
    for site, first in enumerate(diagram.site_of):
        cell = vertices[offsets[site] : offsets[site + 1]]
        assert cell.tolist() == (diagram.cell_vertices(site).tolist() if first == site else [])


@pytest.mark.parametrize("domain", DOMAINS)
def test_cells_a_gap_apart(domain):
    """Every corner keeps half the gap from all bisectors of its cell; what is lost are strips along the edges."""
    sites = np.random.default_rng(9).random((60, 2))
    diagram, gap = sb.voronoi_2d(sites), 0.02
    domain = DOMAINS[domain]
    whole, apart = diagram.clip(domain), diagram.clip(domain, gap=gap)
    assert diagram.clip(domain, gap=0.0).points.tobytes() == whole.points.tobytes()
    site = np.repeat(apart.loop_sites, np.diff(apart.loop_offsets))
    away = sites[site][:, None] - sites
    length = np.linalg.norm(away, axis=2)
    middle = 0.5 * (sites[site][:, None] + sites)
    distance = ((apart.points[:, None] - middle) * away).sum(axis=2) / np.where(length > 0, length, np.inf)
    assert (distance[length > 0] >= gap / 2 - 1e-12).all()
    assert (apart.areas <= whole.areas).all()
    lost = whole.areas - apart.areas
    edges = np.linalg.norm(np.diff(whole.points, axis=0), axis=1).sum()
    assert 0 < lost.sum() < edges * gap / 2 * 1.01
    with pytest.raises(sb.InputError, match="gap"):
        diagram.clip(domain, gap=-1.0)


@pytest.mark.parametrize(
    ("domain", "area"),
    [
        ([(0, 0), (0, 0), (1, 0), (1, 1), (1, 1), (1, 1), (0, 1), (0, 0)], 1.0),  # repeated corners
        ([(0, 0), (0.25, 0), (0.5, 0), (1, 0), (1, 0.5), (1, 1), (0, 1), (0, 0.125)], 1.0),  # in a row
        ([SQUARE[::-1], [(0.25, 0.25), (0.5, 0.25), (0.5, 0.5)]], 1 - 1 / 32),  # in any direction
        ([SQUARE, [(0.5, 0), (0.75, 0.5), (0.25, 0.5)]], 0.875),  # a corner on a side
        ([SQUARE, [(0, 0), (0.5, 0.25), (0.25, 0.5)]], 1 - 3 / 32),  # in a corner
        ([SQUARE, [(0.5, 0), (1, 0.5), (0.5, 1), (0, 0.5)]], 0.5),  # on all sides
        ([SQUARE, [(0.125, 0.125), (0.5, 0.5), (0.125, 0.5)], [(0.5, 0.5), (0.875, 0.875), (0.5, 0.875)]], 55 / 64),
        ([L_SHAPE, [(0.4, 0.3), (0.2, 0.3), (0.2, 0.2)]], 0.58 - 0.01),  # in a reflex corner
    ],
)
@pytest.mark.parametrize("weighted", [False, True])
def test_domains_that_touch_themselves_in_points(domain, area, weighted):
    """Also where sites have their bisectors through these points."""
    rng = np.random.default_rng(11)
    for n in (1, 2, 7, 60):
        sites = np.round(8 * rng.random((n, 2))) / 8 if n < 60 else rng.random((n, 2))
        diagram = sb.voronoi_2d(sites, 0.1 * rng.random(n) / n if weighted else None)
        clipped = diagram.clip(domain)
        assert clipped.areas.min() >= 0
        assert clipped.areas.sum() == pytest.approx(area, rel=1e-12)
        owners = np.repeat(clipped.loop_sites, np.diff(clipped.loop_offsets))
        distances = np.linalg.norm(clipped.points[:, None] - sites, axis=2) - (
            diagram.weights if weighted and n > 1 else 0
        )
        assert (distances[np.arange(len(owners)), owners] <= distances.min(axis=1) + 2e-3).all()


@pytest.mark.parametrize(
    ("domain", "text"),
    [
        ([SQUARE, [(0.5, 0), (0.75, -0.5), (0.25, -0.5)]], "not a hole"),  # touches from outside
        ([SQUARE, [(0, 0), (0.5, 0), (0.25, 0.5)]], "meets"),  # part of a side in common
        ([SQUARE, [(0.5, 0.5), (1, 0.5), (1.5, 0.75), (0.5, 0.75)]], "meets"),  # through
        ([SQUARE, [(0.5, 0.5), (1, 0.25), (1.5, 0.5), (1, 0.75)]], "meets"),  # through in corners on a side
        ([SQUARE, [(0.25, 0.25), (0.75, 0.25), (0.5, 0.75)], [(0.25, 0.25), (0.5, 0.25), (0.5, 0.5)]], "meets"),
        ([SQUARE, [(0.25, 0.25), (0.75, 0.25), (0.5, 0.75)], [(0.25, 0.25), (0.5, 0.375), (0.5, 0.5)]], "loop 1"),
        ([(0, 0), (0, 0), (1, 1), (1, 1)], "2 corners"),
    ],
)
def test_domains_that_do_more_than_touch_are_named(domain, text):
    with pytest.raises(sb.InputError, match=text):
        sb.voronoi_2d([[0, 0]], domain=domain)

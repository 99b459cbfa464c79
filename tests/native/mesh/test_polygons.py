# SPDX-License-Identifier: MIT
"""Polygons of files cut into triangles: what they cover, whatever their form."""

import time
import warnings

import numpy as np
import pytest

import saddleback as sb
from tests.truth import files


def triangles_of(tmp_path, points, corners=None):
    path = tmp_path / "polygon.obj"
    path.write_text(files.obj_of(points, range(len(points)) if corners is None else corners))
    vertices, triangles = sb.read_arrays(path)
    assert np.array_equal(vertices, points)
    return triangles


def one_way(edges):
    return {(a, b) for a, b in edges if (b, a) not in edges}


def check_disk(points, corners, triangles):
    """They cover the polygon once, all turned as it is, and its edges are theirs."""
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    areas = 0.5 * np.cross(b - a, c - a)[:, 2]
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(files.shoelace_area(points[list(corners)]), rel=1e-13)
    edges = [(t[i], t[(i + 1) % 3]) for t in triangles.tolist() for i in range(3)]
    sides = zip(corners, [*corners[1:], corners[0]], strict=True)
    assert len(set(edges)) == len(edges)
    assert one_way(set(edges)) == one_way(set(sides))


U = [(0, 0), (3, 0), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3)]
E = [(0, 0), (5, 0), (5, 1), (1, 1), (1, 2), (5, 2), (5, 3), (1, 3), (1, 4), (5, 4), (5, 5), (0, 5)]
HOOK = [(0, 0), (6, 0), (6, 6), (1, 6), (1, 2), (4, 2), (4, 4), (3, 4), (3, 3), (2, 3), (2, 5), (5, 5), (5, 1), (0, 1)]
SPLIT_SIDES = [(0, 0), (1, 0), (2, 0), (3, 0), (3, 1), (3, 2), (3, 3), (2, 3), (1, 3), (0, 3), (0, 2), (0, 1)]
STAR = [((1 + i % 2) * np.cos(i * np.pi / 40), (1 + i % 2) * np.sin(i * np.pi / 40)) for i in range(80)]


@pytest.mark.parametrize("outline", [U, E, HOOK, SPLIT_SIDES, STAR], ids=["U", "E", "hook", "split sides", "star"])
def test_concave_polygons_are_covered_once(tmp_path, outline):
    points = np.c_[outline, np.zeros(len(outline))]
    for turn in range(0, len(points), max(len(points) // 12, 1)):
        corners = np.roll(np.arange(len(points)), turn).tolist()
        triangles = triangles_of(tmp_path, points, corners)
        assert len(triangles) == len(points) - 2
        check_disk(points, corners, triangles)


def test_convex_polygons_are_fans(tmp_path):
    for n in (4, 5, 64, 300):
        angles = 2 * np.pi * np.arange(n) / n
        triangles = triangles_of(tmp_path, np.c_[np.cos(angles), np.sin(angles), 0.1 * np.cos(2 * angles)])
        assert np.array_equal(triangles, [(0, i, i + 1) for i in range(1, n - 1)])


def test_holes_behind_keyholes(tmp_path):
    """A wall with two windows, each reached by an edge that is gone there and back."""
    wall = [(0, 0), (3, 0), (8, 0), (12, 0), (12, 6), (0, 6)]
    points = np.array([*wall, (2, 2), (4, 2), (4, 4), (2, 4), (7, 2), (9, 2), (8, 4)], float)
    corners = [0, 1, 6, 9, 8, 7, 6, 1, 2, 10, 12, 11, 10, 2, 3, 4, 5]
    points = np.c_[points, np.zeros(len(points))]
    triangles = triangles_of(tmp_path, points, corners)
    assert files.shoelace_area(points[corners]) == 72 - 4 - 2
    check_disk(points, corners, triangles)
    mesh = sb.Mesh(points, triangles)
    assert (mesh.component_count, mesh.genus, len(mesh.boundary_loops)) == (1, 0, 3)


def test_polygons_that_touch_themselves(tmp_path):
    """Two lobes that share a corner: each is covered, and nothing lies between."""
    points = np.array([(0, 0), (2, -1), (1.5, 0), (2, 1), (-2, 1), (-1.5, 0), (-2, -1)], float)
    points = np.c_[points, np.zeros(7)]
    corners = [0, 1, 2, 3, 0, 4, 5, 6]
    triangles = triangles_of(tmp_path, points, corners)
    check_disk(points, corners, triangles)
    assert len(triangles) == 4


def test_bent_polygons_are_covered_along_their_mean_normal(tmp_path):
    rng = np.random.default_rng(3)
    for _ in range(20):
        frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        for outline in (U, E, HOOK):
            flat = np.c_[outline, 0.2 * rng.normal(size=len(outline))]
            points = flat @ frame.T * 10.0 ** rng.integers(-30, 30)
            triangles = triangles_of(tmp_path, points)
            normal = np.sum(np.cross(points, np.roll(points, -1, axis=0)), axis=0)
            normal /= np.linalg.norm(normal)
            a, b, c = np.moveaxis(points[triangles], 1, 0)
            shadows = 0.5 * np.cross(b - a, c - a) @ normal
            assert (shadows > 0).all()


def test_polygons_that_cross_themselves_are_told(tmp_path):
    square = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0)]
    crossed = [(0, 0), (4, 4), (4, 0), (0, 4), (-1, 2)]
    path = tmp_path / "a.obj"
    vertices = "".join("v {} {} {}\n".format(*p) for p in square + [(x, y, 0) for x, y in crossed])
    path.write_text(vertices + "f 1 2 3 4\nf 5 6 7 8 9\nf 1 3 2 4\nf 1 2 1 2\n")
    with pytest.warns(UserWarning, match=r"a\.obj, face 1 and 2 more cross themselves or have no area"):
        triangles = sb.read_arrays(path)[1]
    assert len(triangles) == 2 + 3 + 2 + 2
    path.write_text(vertices + "f 1 3 2 4\n")
    for read in (sb.read_arrays, sb.read_mesh):
        with warnings.catch_warnings(), pytest.raises(UserWarning, match="face 0 crosses itself or has no area"):
            warnings.simplefilter("error")
            read(path)


def test_thin_triangles_are_avoided(tmp_path):
    """Corners on a slanted straight side, straight but for rounding, get triangles that are none of them thin."""
    rng = np.random.default_rng(1)
    for _ in range(50):
        frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        points = np.c_[SPLIT_SIDES, np.zeros(12)] @ frame.T + rng.normal(size=3)
        a, b, c = np.moveaxis(points[triangles_of(tmp_path, points)], 1, 0)
        assert np.linalg.norm(np.cross(b - a, c - a), axis=1).min() > 0.5


def test_a_comb_of_ten_thousand_corners(tmp_path):
    teeth = 2500
    top = [(x, y) for i in range(teeth, 0, -1) for x, y in ((2 * i, 9), (2 * i - 1, 9), (2 * i - 1, 1), (2 * i - 2, 1))]
    points = np.array([(0, 0), (2 * teeth, 0), *top], float)
    points = np.c_[points, np.zeros(len(points))]
    begin = time.process_time()
    triangles = triangles_of(tmp_path, points)
    assert time.process_time() - begin < 1
    check_disk(points, list(range(len(points))), triangles)

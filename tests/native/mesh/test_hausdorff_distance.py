# SPDX-License-Identifier: MIT
"""Distance of two surfaces: closed forms, and never less than samples say."""

from __future__ import annotations

from time import process_time

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_progress_and_cancel


def test_a_tent_over_a_square() -> None:
    """Farthest is the ridge; of the square, the points below it, which are nearest to its slopes."""
    square = np.array([(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0)], dtype=float)
    flat = sb.Mesh(square, [(0, 1, 2), (0, 2, 3)])
    ridge = np.array([(1, 0, 1), (1, 2, 1)], dtype=float)
    tent = sb.Mesh(np.vstack([square, ridge]), [(0, 4, 5), (0, 5, 3), (4, 1, 2), (4, 2, 5)])
    found = sb.hausdorff_distance(tent, flat, 1e-7)
    assert found.from_first == pytest.approx(1, abs=1e-6)
    assert found.from_second == pytest.approx(np.sqrt(0.5), abs=1e-6)
    assert found.distance == found.from_first
    assert found.farthest_of_first.positions(tent)[0, 2] == pytest.approx(1, abs=1e-6)
    assert found.farthest_of_second.positions(flat)[0, 0] == pytest.approx(1, abs=1e-5)


def test_inside_a_triangle() -> None:
    """The farthest point of a large triangle from a ring is its middle, far from every vertex."""
    triangle = sb.Mesh([(0, 0, 0), (4, 0, 0), (2, 2 * np.sqrt(3), 0)], [(0, 1, 2)])
    corners = triangle.vertices
    strips = [np.vstack([corners[i], corners[(i + 1) % 3], corners[i] + [0, 0, 0.1]]) for i in range(3)]
    ring = sb.Mesh(np.vstack(strips), np.arange(9).reshape(3, 3))
    found = sb.hausdorff_distance(triangle, ring, 1e-6)
    assert found.from_first == pytest.approx(2 / np.sqrt(3), abs=1e-5)  # the radius of the inscribed circle
    np.testing.assert_allclose(found.farthest_of_first.positions(triangle)[0], corners.mean(axis=0), atol=1e-2)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4])
def test_never_less_than_samples(tolerance: float) -> None:
    fine, coarse = sb.Mesh(*meshes.torus(48, 20)), sb.Mesh(*meshes.torus(17, 9))
    found = sb.hausdorff_distance(fine, coarse, tolerance)
    slack = 2 * tolerance * np.linalg.norm(np.ptp(fine.vertices, axis=0))
    for a, b, most in ((fine, coarse, found.from_first), (coarse, fine, found.from_second)):
        places = sb.sample(a, 20000, seed=1).positions(a)
        sampled = np.linalg.norm(sb.project(b, places).positions(b) - places, axis=1).max()
        assert sampled <= most + slack
        assert most <= 1.2 * sampled
    place = found.farthest_of_second.positions(coarse)
    foot = sb.project(fine, place).positions(fine)
    assert np.linalg.norm(foot - place) == pytest.approx(found.from_second, rel=1e-9)


def test_of_itself_it_is_nothing() -> None:
    mesh = sb.Mesh(*meshes.double_torus())
    assert sb.hausdorff_distance(mesh, mesh).distance < 1e-12
    moved = sb.Mesh(mesh.vertices + [0, 0, 1e-3], mesh.triangles)
    assert sb.hausdorff_distance(mesh, moved, 1e-6).distance == pytest.approx(1e-3, rel=1e-2)


def test_where_surfaces_are_the_same_one_look_is_enough() -> None:
    """One of 10,201 vertices moved a little: no face but those about it is divided, whatever the tolerance."""
    mesh = sb.Mesh(*meshes.grid(101, 101))
    moved = mesh.vertices.copy()
    moved[len(moved) // 2, 2] += 1e-5
    edited = sb.Mesh(moved, mesh.triangles)

    def seconds(tolerance: float) -> float:
        start = process_time()
        assert sb.hausdorff_distance(mesh, edited, tolerance, threads=1).distance == pytest.approx(1e-5, rel=1e-9)
        return process_time() - start

    assert min(seconds(1e-7) for _ in range(3)) < 4 * min(seconds(1e-2) for _ in range(3))  # 13 times before


def turned(vertices: np.ndarray, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(vertices @ [[c, s, 0], [-s, c, 0], [0, 0, 1]])


def nearly_the_same() -> list[tuple[str, float, sb.Mesh, sb.Mesh]]:
    torus, noise = meshes.torus(48, 20), 1e-5 * np.random.default_rng(3).normal(size=(960, 3))
    return [
        ("flat", 1e-4, sb.Mesh(*meshes.grid(14, 14)), sb.Mesh(*meshes.grid(19, 11))),
        ("turned", 1e-5, sb.Mesh(*torus), sb.Mesh(turned(torus[0], 1e-3), torus[1])),
        ("moved", 1e-5, sb.Mesh(*torus), sb.Mesh(torus[0] + noise, torus[1])),
        ("finer", 1e-5, sb.Mesh(*meshes.cylinder(12, 9, 1, 2)), sb.Mesh(*meshes.cylinder(24, 17, 1, 2))),
    ]


@pytest.mark.parametrize(
    ("name", "tolerance", "a", "b"), nearly_the_same(), ids=lambda value: value if type(value) is str else ""
)
def test_where_surfaces_are_nearly_the_same_few_looks_are_enough(
    name: str, tolerance: float, a: sb.Mesh, b: sb.Mesh
) -> None:
    """However their faces lie on each other, and without loss: by samples of both, the middles of edges among them."""

    def seconds(wanted: float) -> float:
        start = process_time()  # which ticks 64 times a second on Windows
        for _ in range(10):
            sb.hausdorff_distance(a, b, wanted, threads=1)
        return (process_time() - start) / 10

    found = sb.hausdorff_distance(a, b, tolerance)
    slack = tolerance * np.linalg.norm(np.ptp(a.vertices, axis=0))
    for of, other, most in ((a, b, found.from_first), (b, a, found.from_second)):
        places = [of.vertices, of.vertices[of.edges].mean(axis=1), sb.sample(of, 20000, seed=1).positions(of)]
        on_other = other.vertices[other.edges].reshape(-1, 3)
        places.append(sb.project(of, on_other).positions(of))
        all_places = np.concatenate(places)
        sampled = np.linalg.norm(sb.project(other, all_places).positions(other) - all_places, axis=1).max()
        assert sampled <= most + 1.01 * slack
    assert min(seconds(tolerance) for _ in range(3)) < 10 * min(seconds(1e-1) for _ in range(3)) + 0.01


def test_threads_change_nothing() -> None:
    a, b = sb.Mesh(*meshes.icosphere(3)), sb.Mesh(*meshes.icosphere(1))
    one, many = (sb.hausdorff_distance(a, b, threads=n) for n in (1, 8))
    assert (one.from_first, one.from_second) == (many.from_first, many.from_second)


def test_bad_tolerance_and_cancel() -> None:
    mesh = sb.Mesh(*meshes.torus(200, 90))
    with pytest.raises(sb.InputError, match="tolerance"):
        sb.hausdorff_distance(mesh, mesh, 0)
    other = sb.Mesh(*meshes.torus(150, 80))
    check_progress_and_cancel(lambda job: sb.hausdorff_distance(mesh, other, 1e-7, job=job), 0.02)


@pytest.mark.parametrize("seed", range(8))
def test_a_limit_tells_whether_something_is_farther(seed: int) -> None:
    rng = np.random.default_rng(seed)
    vertices, triangles = meshes.icosphere(3)
    mesh, moved = sb.Mesh(vertices, triangles), sb.Mesh(vertices + 0.05 * rng.normal(size=vertices.shape), triangles)
    tolerance = 1e-4
    whole = sb.hausdorff_distance(mesh, moved, 1e-5)
    slack = tolerance * np.linalg.norm(np.ptp(np.vstack([mesh.vertices, moved.vertices]), axis=0))
    for share in (0.3, 0.9, 1.1, 3.0):
        limit = share * whole.distance
        told = sb.hausdorff_distance(mesh, moved, tolerance, limit=limit)
        for of, mine in ((whole.from_first, told.from_first), (whole.from_second, told.from_second)):
            assert mine <= of + slack
            assert mine > limit - slack or of <= limit + slack
    with pytest.raises(sb.InputError, match="limit: wanted a length of 0 or more, got -1"):
        sb.hausdorff_distance(mesh, moved, limit=-1)

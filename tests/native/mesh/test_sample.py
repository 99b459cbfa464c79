# SPDX-License-Identifier: MIT
"""Sampling: numbers follow mass, points keep apart, every component gets its share, seeds repeat."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy import stats  # type: ignore[import-untyped]
from scipy.spatial import cKDTree  # type: ignore[import-untyped]

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_progress_and_cancel

Floats = NDArray[np.float64]


def masses(mesh: sb.Mesh, density: Floats | None = None) -> Floats:
    """Integral of the linear density over each face."""
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    areas: Floats = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    if density is not None:
        areas *= density[mesh.triangles].mean(axis=1)
    return areas


@pytest.mark.parametrize("case", meshes.good(), ids=str)
@pytest.mark.parametrize("painted", [False, True])
def test_each_face_gets_its_share_to_within_one(case: meshes.Case, painted: bool) -> None:
    mesh = case.mesh
    density = np.random.default_rng(3).uniform(0, 1, len(mesh.vertices)) ** 4 if painted else None
    count = 4 * len(mesh.triangles) + 1
    points = sb.sample(mesh, count, density, seed=7)
    assert len(points) == count
    expected = masses(mesh, density)
    expected *= count / expected.sum()
    found = np.bincount(points.faces, minlength=len(mesh.triangles))
    assert np.abs(found - expected).max() <= 1 + 1e-6


def test_within_a_face_the_points_follow_the_linear_density() -> None:
    """Chi-square over 64 equal parts of one triangle whose density falls from 5 to 0."""
    mesh = sb.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    density = np.array([5.0, 0.0, 1.0])
    points = sb.sample(mesh, 20_000, density, seed=1)
    x, y = points.positions(mesh)[:, :2].T
    column, row = np.floor(8 * x).astype(int), np.floor(8 * y).astype(int)
    upper = (8 * x - column) + (8 * y - row) > 1
    expected: dict[tuple[int, int, bool], float] = {}
    for i in range(8):
        for j in range(8 - i):
            for flag, center in ((False, (i + 1 / 3, j + 1 / 3)), (True, (i + 2 / 3, j + 2 / 3))):
                if flag and i + j == 7:
                    continue
                u, w = center[0] / 8, center[1] / 8
                expected[i, j, flag] = 5 * (1 - u - w) + 0 * u + 1 * w
    keys = list(expected)
    index = {key: n for n, key in enumerate(keys)}
    found = np.bincount(
        [index[k] for k in zip(column.tolist(), row.tolist(), upper.tolist(), strict=True)], minlength=64
    )
    wanted = np.array([expected[key] for key in keys])
    assert stats.chisquare(found, wanted * len(points) / wanted.sum()).pvalue > 0.01


def test_a_ramp_on_a_fine_grid_is_followed() -> None:
    mesh = sb.Mesh(*meshes.grid(60, 60, 0.3))
    density = 1 + 7 * mesh.vertices[:, 0]
    points = sb.sample(mesh, 2000, density)
    x = points.positions(mesh)[:, 0]
    found, edges = np.histogram(x, bins=20, range=(0, 1))
    wanted = np.diff(edges + 3.5 * edges**2)
    wanted *= len(points) / wanted.sum()
    assert stats.chisquare(found, wanted).pvalue > 0.01
    assert np.corrcoef(found, wanted)[0, 1] > 0.98


def test_nothing_lands_where_the_density_is_zero() -> None:
    mesh = sb.Mesh(*meshes.grid(21, 21))
    density = (mesh.vertices[:, 0] > 0.5).astype(float)
    points = sb.sample(mesh, 3000, density)
    assert points.positions(mesh)[:, 0].min() > 0.5 - 1e-12


@pytest.mark.parametrize("arrays", [meshes.grid(2, 2), meshes.grid(12, 12), meshes.grid(90, 90, 0.3)])
def test_points_are_more_even_than_random_ones(arrays: meshes.Arrays) -> None:
    """Mean distance to the nearest other point, in units of the mean spacing: 0.5 for random points."""
    mesh = sb.Mesh(*arrays)
    for seed in range(3):
        positions = sb.sample(mesh, 1500, seed=seed).positions(mesh)
        nearest = cKDTree(positions).query(positions, k=2)[0][:, 1]
        assert nearest.mean() * np.sqrt(len(positions) / mesh.area) > 0.55


@given(st.integers(0, 2**64 - 1), st.integers(1, 300))
def test_the_seed_decides(seed: int, count: int) -> None:
    mesh = meshes.closed()[3].mesh
    first, again = sb.sample(mesh, count, seed=seed), sb.sample(mesh, count, seed=seed)
    assert len(first) == count
    assert (first.faces == again.faces).all()
    assert (first.barycentric == again.barycentric).all()
    other = sb.sample(mesh, count, seed=seed ^ 1)
    assert (first.barycentric != other.barycentric).any()


def test_any_offset_is_as_likely() -> None:
    """Over many seeds a single point falls on each face in proportion to its area."""
    mesh = sb.Mesh(*meshes.holes())
    found = np.bincount([sb.sample(mesh, 1, seed=s).faces[0] for s in range(3000)], minlength=len(mesh.triangles))
    expected = masses(mesh)
    groups = np.arange(len(expected)) // 8
    wanted = np.bincount(groups, expected * 3000 / expected.sum())
    assert stats.chisquare(np.bincount(groups, found), wanted).pvalue > 0.001


def many_parts() -> sb.Mesh:
    """One large sphere and nine tiny ones."""
    spheres = []
    for i in range(10):
        vertices, triangles = meshes.icosphere(1)
        spheres.append((vertices * (1.0 if i == 4 else 0.01) + [3.0 * i, 0, 0], triangles))
    return sb.Mesh(*meshes.merge(*spheres))


@pytest.mark.parametrize("count", [10, 11, 50, 1000])
def test_each_component_gets_a_point_when_asked(count: int) -> None:
    mesh = many_parts()
    part = sb.sample(mesh, count, one_per_component=True).faces // (len(mesh.triangles) // 10)
    found = np.bincount(part, minlength=10)
    assert found.sum() == count
    assert found.min() >= 1
    assert found[4] == count - 9
    alone = sb.sample(mesh, 10).faces // (len(mesh.triangles) // 10)
    assert (alone == 4).all()


def test_components_without_density_get_one_point_too() -> None:
    mesh = many_parts()
    density = np.zeros(len(mesh.vertices))
    density[: len(density) // 10] = 2.0
    part = sb.sample(mesh, 100, density, one_per_component=True).faces // (len(mesh.triangles) // 10)
    assert np.bincount(part).tolist() == [91] + [1] * 9


def test_shares_of_components_are_proportional() -> None:
    spheres = [meshes.icosphere(2, radius) for radius in (1.0, 2.0, 3.0)]
    moved = [(v + np.array([10.0 * i, 0, 0]), t) for i, (v, t) in enumerate(spheres)]
    mesh = sb.Mesh(*meshes.merge(*moved))
    part = sb.sample(mesh, 1400, one_per_component=True).faces // (len(mesh.triangles) // 3)
    assert np.bincount(part).tolist() == [100, 400, 900]


@pytest.mark.parametrize("scale", [5e-324, 1e-300, 1e300])
def test_only_ratios_of_the_density_matter(scale: float) -> None:
    mesh = sb.Mesh(*meshes.torus())
    plain = sb.sample(mesh, 100, np.full(len(mesh.vertices), 1.0))
    scaled = sb.sample(mesh, 100, np.full(len(mesh.vertices), scale))
    assert (plain.faces == scaled.faces).all()
    assert (plain.barycentric == scaled.barycentric).all()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"count": 0}, "count is 0, but must be at least 1"),
        ({"count": -5}, "count is -5"),
        ({"count": 2.5}, "count: wanted an integer"),
        ({"count": 5, "density": np.ones(7)}, r"density: wanted shape \(8,\) of real numbers, got \(7,\)"),
        (
            {"count": 5, "density": np.array([1, 1, 1, np.nan, 1, 1, 1, 1])},
            r"density: value nan at \[3\] is not finite",
        ),
        ({"count": 5, "density": np.array([1, -0.5, 1, 1, 1, 1, 1, 1])}, r"density: value -0.5 at \[1\] is negative"),
        (
            {"count": 5, "density": np.array([1, 1, 1, 1, 1, 1, 1, np.inf])},
            r"density: value inf at \[7\] is not finite",
        ),
        ({"count": 5, "density": np.zeros(8)}, "density is zero everywhere"),
        ({"count": 5, "seed": -1}, "seed"),
    ],
)
def test_bad_input_is_named(arguments: dict[str, object], sentence: str) -> None:
    with pytest.raises(sb.InputError, match=sentence):
        sb.sample(sb.Mesh(*meshes.cube()), **arguments)  # type: ignore[arg-type]


def test_fewer_points_than_components_is_named() -> None:
    with pytest.raises(sb.InputError, match="count is 9, fewer than the 10 connected components"):
        sb.sample(many_parts(), 9, one_per_component=True)


def test_progress_rises_and_cancel_is_quick() -> None:
    mesh = sb.Mesh(*meshes.icosphere(4))
    check_progress_and_cancel(lambda job: sb.sample(mesh, 20_000_000, job=job), 0.3)

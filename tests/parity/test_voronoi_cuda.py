# SPDX-License-Identifier: MIT
"""Voronoi diagrams of the plane that a CUDA device finds are the processor's, to the bit."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

import saddleback as sb
from tests.native import plane_sites
from tests.parity.cancelling import expect_to_stop_within_a_moment

DEVICES = ("cuda", "cuda:0,0,0", "cuda:all")  # one, one in three parts, and all, a part each
ARRAYS = ("sites", "site_of", "vertices", "edges", "edge_sites", "edge_directions", "delaunay", "areas", "centroids")
WEIGHTED_ARRAYS = (*(name for name in ARRAYS if name != "delaunay"), "weights", "hidden")
SIZES = (1, 2, 3, 4, 5, 7, 12, 40, 300, 3000, 30000)


def make(kind: str, n: int, seed: int) -> np.ndarray:
    return plane_sites.KINDS[kind](n, np.random.default_rng(seed))


def expect_twins(sites: np.ndarray, weights: np.ndarray | None = None) -> sb.Voronoi2d:
    own = sb.voronoi_2d(sites, weights, device="cpu")
    for device in DEVICES:
        twin = sb.voronoi_2d(sites, weights, device=device)
        for name in ARRAYS if weights is None else WEIGHTED_ARRAYS:
            assert getattr(twin, name).tobytes() == getattr(own, name).tobytes(), (device, name)
        for mine, other in zip(twin.cells, own.cells, strict=True):
            assert mine.tobytes() == other.tobytes()
    return twin


@pytest.mark.parametrize("n", SIZES)
@pytest.mark.parametrize("kind", plane_sites.KINDS)
def test_the_same_diagram(kind: str, n: int) -> None:
    expect_twins(make(kind, n, seed=n))


@pytest.mark.parametrize("seed", range(20))
def test_the_same_diagram_of_few_integers(seed: int) -> None:
    rng = np.random.default_rng(seed)
    expect_twins(rng.integers(-4, 5, (int(rng.integers(3, 200)), 2)).astype(float))


@pytest.mark.parametrize("kind", ["uniform", "clusters", "grid", "duplicates"])
def test_the_device_itself_finds_large_ones(kind: str) -> None:
    twin = expect_twins(make(kind, 300_000, seed=7))
    assert twin.device == "cuda"
    times = twin.device_times
    assert times is not None and times["find"] > 0 and times["by_processor"] == 0


def test_a_cell_of_hundreds_of_neighbors() -> None:
    rng = np.random.default_rng(11)
    angles = np.arange(700) * (2 * np.pi / 700)
    ring = np.stack((np.cos(angles), np.sin(angles)), axis=1) * (1 + 1e-7 * rng.random((700, 1)))
    twin = expect_twins(np.concatenate((np.zeros((1, 2)), ring)))
    assert twin.device == "cuda"
    offsets, _ = twin.cells
    assert np.diff(offsets).max() == 700


WEIGHTS = {
    "small": lambda mean, rng, n: 0.2 * mean * rng.random(n),
    "large": lambda mean, rng, n: mean * rng.random(n),
    "many hidden": lambda mean, rng, n: 4 * mean * rng.random(n) ** 4,
    "few sizes": lambda mean, rng, n: 0.3 * mean * rng.integers(-1, 2, n),
    "one heavy": lambda mean, rng, n: np.where(np.arange(n) == n // 2, 6 * mean, 0.0),
}


def weights_of(kind: str, sites: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Radii in parts of the mean distance of sites."""
    extent = float(np.ptp(sites, axis=0).max()) if len(sites) else 1.0
    return np.asarray(WEIGHTS[kind](extent / np.sqrt(max(len(sites), 1)), rng, len(sites)), float)


@pytest.mark.parametrize("n", SIZES[:-1])  # circles of more take the processor too long
@pytest.mark.parametrize("kind", plane_sites.KINDS)
@pytest.mark.parametrize("weights", WEIGHTS)
def test_the_same_weighted_diagram(kind: str, weights: str, n: int) -> None:
    sites = make(kind, n, seed=n)
    expect_twins(sites, weights_of(weights, sites, np.random.default_rng(n)))


@pytest.mark.parametrize("kind", ["uniform", "clusters", "grid"])
@pytest.mark.parametrize("weights", ["small", "large", "many hidden"])
def test_the_device_itself_finds_large_weighted_ones(kind: str, weights: str) -> None:
    sites = make(kind, 200_000, seed=7)
    twin = expect_twins(sites, weights_of(weights, sites, np.random.default_rng(8)))
    assert twin.device == "cuda"
    times = twin.device_times
    assert times is not None and times["find"] > 0


def test_edges_shared_twice_and_cells_of_two_sides() -> None:
    """Small disks between large ones cut their edges in two, and have no third neighbor."""
    rng = np.random.default_rng(11)
    large = np.column_stack([k.ravel() for k in np.meshgrid(np.arange(40.0), np.arange(40.0))])
    large += rng.uniform(-0.05, 0.05, large.shape)
    small = 0.5 * (large[:-1] + large[1:]) + rng.uniform(-0.01, 0.01, (len(large) - 1, 2))
    sites = np.concatenate([large, small])
    weights = np.concatenate([rng.uniform(0.4, 0.45, len(large)), rng.uniform(-0.02, 0.02, len(small))])
    twin = expect_twins(sites, weights)
    assert twin.device == "cuda"
    _, counts = np.unique(np.sort(twin.edge_sites, axis=1), axis=0, return_counts=True)
    assert (counts > 1).any()


def test_weights_that_are_wrong_are_refused_in_the_same_words() -> None:
    sites = make("uniform", 100, seed=1)
    for weights in (np.ones(99), np.where(np.arange(100) == 7, np.nan, 1.0)):
        messages = []
        for device in ("cpu", "cuda"):
            with pytest.raises(sb.InputError) as caught:
                sb.voronoi_2d(sites, weights, device=device)
            messages.append(str(caught.value))
        assert messages[0] == messages[1]


def expect_kept(kept: sb.DeviceVoronoi2d, own: sb.Voronoi2d) -> None:
    for name in ("vertices", "edges", "edge_sites", "site_of"):
        assert getattr(kept, name).numpy().tobytes() == getattr(own, name).tobytes(), name
    offsets, places = kept.cell_offsets.numpy(), kept.cell_places.numpy()
    corners, sides = kept.corner_vertices.numpy(), kept.side_edges.numpy()
    for site in np.flatnonzero(own.site_of == np.arange(len(places)))[:2000]:
        cell = slice(*offsets[places[site] : places[site] + 2])
        assert kept.cell_sites.numpy()[places[site]] == site
        np.testing.assert_array_equal(corners[cell], own.cell_vertices(site))
        np.testing.assert_array_equal(sides[cell], own.cell_edges(site))


@pytest.mark.parametrize("n", [300, 3000])
@pytest.mark.parametrize("kind", ["uniform", "clusters", "grid", "duplicates"])
def test_what_stays_on_the_device_is_the_same(kind: str, n: int) -> None:
    sites = make(kind, n, seed=n)
    own = sb.voronoi_2d(sites, device="cpu")
    expect_kept(sb.voronoi_2d_on_device(sites), own)
    assert sb.voronoi_2d_on_device(sites, only_triangles=True).triangles.numpy().tobytes() == own.delaunay.tobytes()


def test_the_triangles_alone_of_a_large_one() -> None:
    sites = make("uniform", 300_000, seed=8)
    kept = sb.voronoi_2d_on_device(sites, only_triangles=True)
    np.testing.assert_array_equal(kept.triangles.numpy(), sb.voronoi_2d(sites, device="cpu").delaunay)
    assert len(kept.vertices) == len(kept.cell_offsets) == 0


class There:
    """Numbers that are on a device, as others tell of them."""

    def __init__(self, array: sb.DeviceArray) -> None:
        self.__cuda_array_interface__ = array.__cuda_array_interface__


def test_sites_that_are_there_already() -> None:
    dual = sb.voronoi_2d_on_device(make("grid", 20_000, seed=9))
    sites = dual.vertices.numpy()
    expect_kept(sb.voronoi_2d_on_device(There(dual.vertices)), sb.voronoi_2d(sites, device="cpu"))


TAKES = """
import numpy as np
import {library}
import saddleback as sb

kept = sb.voronoi_2d_on_device(np.random.default_rng(10).random((5000, 2)))
for array in (kept.vertices, kept.edges, kept.cell_offsets):
    for taken in ({library}.{take}, {library}.from_dlpack(array)):
        assert tuple(taken.shape) == array.shape
        np.testing.assert_array_equal(taken.{back}(), array.numpy())
vertices, copy = {library}.from_dlpack(kept.vertices), kept.vertices.numpy()
del kept, array, taken  # what was taken lives on
np.testing.assert_array_equal(vertices.{back}(), copy)
"""


@pytest.mark.parametrize(
    ("library", "take", "back"),
    [("cupy", "asarray(array)", "get"), ("torch", "as_tensor(array, device='cuda')", "cpu().numpy")],
)
def test_other_libraries_take_what_stays(library: str, take: str, back: str) -> None:
    code = TAKES.format(library=library, take=take, back=back)
    subprocess.run([sys.executable, "-c", code], check=True, timeout=120)


def test_what_a_device_is_not_made_for_does_not_stay() -> None:
    for sites in (make("collinear", 50, seed=1), [[0, 0], [1, 0]], [[0, 0], [1, np.nan], [2, 1]]):
        with pytest.raises(sb.DeviceError, match="not made for such sites"):
            sb.voronoi_2d_on_device(sites)


@pytest.mark.parametrize("scale", [1e-60, 1e60, 1e-80])
def test_any_scale(scale: float) -> None:
    expect_twins(scale * make("uniform", 5000, seed=3))


def test_far_from_the_origin() -> None:
    expect_twins(1e6 + make("uniform", 50_000, seed=4))


def test_a_cluster_within_a_cluster() -> None:
    rng = np.random.default_rng(5)
    expect_twins(np.concatenate([rng.random((20_000, 2)), 0.5 + 1e-9 * rng.random((20_000, 2)), [[0.5, 0.5]]]))


@pytest.mark.parametrize("sites", [[[0, 0], [1, np.nan], [2, 1]], [[0, 0], [np.inf, 1], [2, 2], [3, 1]]])
def test_what_the_processor_refuses_is_refused_in_the_same_words(sites: list[list[float]]) -> None:
    with pytest.raises(sb.InputError) as own:
        sb.voronoi_2d(sites, device="cpu")
    with pytest.raises(sb.InputError) as twin:
        sb.voronoi_2d(sites, device="cuda")
    assert str(own.value) == str(twin.value)


def test_too_little_memory_is_told_before_anything_runs() -> None:
    sites = make("uniform", 100_000, seed=1)
    sb.limit_device_memory(1 << 20)
    try:
        with pytest.raises(sb.DeviceError, match=r"the diagram needs about \d+ MB of the device's memory, and 1 MB"):
            sb.voronoi_2d(sites, device="cuda")
        assert sb.voronoi_2d(sites, device="auto").device == "cpu"
    finally:
        sb.limit_device_memory(0)


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize(("kind", "count"), [("uniform", 5_000_000), ("two_rings", 400_000)])
def test_cancelled_within_a_moment(kind: str, count: int, device: str) -> None:
    sites = make(kind, count, seed=2)
    uniform = make("uniform", 100_000, seed=2)
    sb.voronoi_2d(uniform, device=device)  # the device is awake
    expect_to_stop_within_a_moment(lambda job: sb.voronoi_2d(sites, device=device, job=job), after=0.05)

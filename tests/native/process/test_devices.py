# SPDX-License-Identifier: MIT
"""What happens where there is no CUDA module, or one that does not fit; tests/parity has the rest."""

from __future__ import annotations

import importlib
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import saddleback as sb
from tests import meshes


@pytest.fixture
def mesh() -> sb.Mesh:
    return sb.Mesh(*meshes.icosphere(2))


def use_module(monkeypatch: pytest.MonkeyPatch, module: Any) -> None:
    def find(name: str) -> Any:
        if isinstance(module, Exception):
            raise module
        return module

    monkeypatch.setattr(importlib, "import_module", find)


def module_with(usable: int, reason: str = "") -> Any:
    one = [
        SimpleNamespace(name=f"card {i}", memory=1 << 30, compute_major=9, compute_minor=0, index=i)
        for i in range(usable)
    ]
    return SimpleNamespace(cuda_devices=lambda: SimpleNamespace(usable=one, reason=reason), twins=None)


@pytest.mark.parametrize(
    ("module", "words"),
    [
        (ModuleNotFoundError("gone"), "no CUDA module"),
        (ImportError("libcuda.so.1: cannot open"), r"cannot be loaded: libcuda\.so\.1"),
        (module_with(0, "CUDA finds no device: no driver"), "finds no device: no driver"),
        (SimpleNamespace(), "cannot be asked"),
    ],
    ids=["no_module", "unloadable", "no_device", "broken"],
)
def test_without_a_device_the_reason_is_told_and_auto_takes_the_processor(
    mesh: sb.Mesh, module: Any, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    use_module(monkeypatch, module)
    with pytest.raises(sb.DeviceError, match=words):
        sb.SaddleVertexGraph(mesh, device="cuda")
    assert sb.SaddleVertexGraph(mesh, device="auto").device == "cpu"
    assert [device.kind for device in sb.devices()] == ["cpu"]


def test_queries_without_a_device_run_on_the_processor_unless_one_is_asked_for(
    mesh: sb.Mesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    use_module(monkeypatch, None)
    graph = sb.SaddleVertexGraph(mesh)
    for query in (graph.distances, graph.nearest, graph.fields):
        with pytest.raises(sb.DeviceError):
            query([0], device="cuda")
        with pytest.raises(sb.InputError, match="device: wanted 'auto'"):
            query([0], device="gpu")
        np.testing.assert_array_equal(query([0]), query([0], device="cpu"))
    assert graph.query_times is None


def test_cells_without_a_device_are_the_processors_unless_one_is_asked_for(
    mesh: sb.Mesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    use_module(monkeypatch, None)
    graph = sb.SaddleVertexGraph(mesh)
    for find in (sb.geodesic_voronoi, sb.centroidal_voronoi):
        with pytest.raises(sb.DeviceError):
            find(graph, [0, 1], device="cuda")
        with pytest.raises(sb.InputError, match="device: wanted 'auto'"):
            find(graph, [0, 1], device="gpu")
    assert sb.geodesic_voronoi(graph, [0, 1]).device == "cpu"
    assert sb.centroidal_voronoi(graph, [0, 1]).cells.device == "cpu"


def test_what_stays_on_a_device_needs_one(monkeypatch: pytest.MonkeyPatch) -> None:
    use_module(monkeypatch, None)
    sites = np.random.default_rng(0).random((10, 2))
    with pytest.raises(sb.DeviceError):
        sb.voronoi_2d_on_device(sites)
    for device in ("cpu", "auto", "gpu"):
        with pytest.raises(sb.InputError, match="device: wanted"):
            sb.voronoi_2d_on_device(sites, device=device)
    with pytest.raises(sb.InputError, match="sites: wanted"):
        sb.voronoi_2d_on_device(sites.ravel())


class OnSomeDevice:
    """Describes an array as CuPy would."""

    def __init__(self, **described: Any) -> None:
        self.__cuda_array_interface__ = {"data": (4096, False), "version": 3} | described


@pytest.mark.parametrize(
    "described",
    [
        {"shape": (9,), "typestr": "<f8"},
        {"shape": (9, 3), "typestr": "<f8"},
        {"shape": (9, 2), "typestr": "<f4"},
        {"shape": (9, 2), "typestr": "<f8", "strides": (8, 72)},
    ],
)
def test_sites_on_a_device_have_the_right_shape_and_type(described: dict[str, Any]) -> None:
    with pytest.raises(sb.InputError, match=r"sites: wanted an \(n, 2\) float64 array"):
        sb.voronoi_2d_on_device(OnSomeDevice(**described))


def test_sites_on_a_device_have_an_address(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(sb.InputError, match="sites: their address"):
        sb.voronoi_2d_on_device(OnSomeDevice(shape=(9, 2), typestr="<f8", data=(None, False)))
    use_module(monkeypatch, None)  # a right one is read, and only then is the device asked for
    with pytest.raises(sb.DeviceError):
        sb.voronoi_2d_on_device(OnSomeDevice(shape=(9, 2), typestr="<f8"))


def test_a_device_number_that_does_not_exist_is_named(mesh: sb.Mesh, monkeypatch: pytest.MonkeyPatch) -> None:
    use_module(monkeypatch, module_with(2))
    with pytest.raises(sb.DeviceError, match=r"no CUDA device 7; the usable ones are 0 to 1"):
        sb.SaddleVertexGraph(mesh, device="cuda:7")
    with pytest.raises(sb.DeviceError, match=r"no CUDA device 2; the usable ones are 0 to 1"):
        sb.SaddleVertexGraph(mesh, device="cuda:0,2")


@pytest.mark.parametrize(
    "word", ["gpu", "CUDA", "cuda:", "cuda:-1", "cuda:x", "cuda:1x", "cuda:0,", "cuda:,1", "cuda:0 1", ""]
)
def test_any_other_word_is_refused(mesh: sb.Mesh, word: str) -> None:
    with pytest.raises(sb.InputError, match="device: wanted 'auto'"):
        sb.SaddleVertexGraph(mesh, device=word)


@pytest.mark.parametrize("wrong", [-1, 1.5, "1 GB", None])
def test_the_memory_limit_is_a_number_of_bytes(wrong: Any) -> None:
    with pytest.raises(sb.InputError, match="bytes"):
        sb.limit_device_memory(wrong)


def test_without_a_device_nothing_is_pinned_and_nothing_else_changes(
    mesh: sb.Mesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    use_module(monkeypatch, None)
    sites = np.random.default_rng(1).random((500, 2))
    for weights in (None, 0.01 * np.random.default_rng(2).random(500)):
        own, pinned = sb.voronoi_2d(sites, weights), sb.voronoi_2d(sites, weights, pinned=True)
        assert pinned.device == "cpu"
        for name in ("sites", "vertices", "edges", "edge_sites", "site_of"):
            assert getattr(pinned, name).tobytes() == getattr(own, name).tobytes()
    graph = sb.SaddleVertexGraph(mesh, pinned=True)
    np.testing.assert_array_equal(graph.distances([0]), sb.SaddleVertexGraph(mesh).distances([0]))
    sb.release_pinned_memory()
    with pytest.raises(sb.DeviceError):
        sb.voronoi_2d(sites, device="cuda", pinned=True)


def test_sites_are_copied() -> None:
    sites = np.random.default_rng(1).random((500, 2))
    for weights in (None, np.arange(500.0)):
        diagram = sb.voronoi_2d(sites, weights)
        given = sites.copy()
        sites += 1
        np.testing.assert_array_equal(diagram.sites, given)

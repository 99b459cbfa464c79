# SPDX-License-Identifier: GPL-3.0-or-later
"""Where graphs are built."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import saddleback as sb
from saddleback_blender.core import devices
from saddleback_blender.core.progress import Progress
from tests import meshes


@pytest.fixture(autouse=True)
def as_before() -> Iterator[None]:
    yield
    devices.choose(devices.AUTO)


def progress() -> Progress:
    return Progress(sb.Job, sb.Cancelled)


def build(watched: Progress) -> Any:
    mesh = sb.Mesh(*meshes.icosphere(2))
    with watched.stage(1.0, "building") as job:
        return devices.build_graph(mesh, {"k": 10}, 1, watched, job)


@pytest.mark.parametrize(
    ("kind", "index", "word"), [(devices.AUTO, 3, "auto"), (devices.CPU, 3, "cpu"), (devices.CUDA, 3, "cuda:3")]
)
def test_a_choice_is_what_the_library_calls_it(kind: str, index: int, word: str) -> None:
    devices.choose(kind, index)
    assert devices.chosen() == word


@pytest.mark.parametrize("kind", [devices.AUTO, devices.CPU])
def test_nobody_is_told_what_is_as_it_should_be(kind: str) -> None:
    devices.choose(kind)
    watched = progress()
    assert build(watched).device == "cpu"
    assert watched.notes == []


def diagram(watched: Progress, weights: Any = None) -> Any:
    sites = np.random.default_rng(1).random((50, 2))
    with watched.stage(1.0, "finding") as job:
        return devices.plane_diagram(sites, weights, 1, watched, job)


def weighted_diagram(watched: Progress) -> Any:
    return diagram(watched, np.random.default_rng(2).uniform(0, 0.05, 50))


@pytest.mark.parametrize("work", [build, diagram, weighted_diagram])
def test_where_the_device_fails_the_processor_does_it_and_the_user_is_told(work: Callable[[Progress], Any]) -> None:
    devices.choose(devices.CUDA, 63)
    watched = progress()
    assert work(watched).device == "cpu"
    (note,) = watched.notes
    assert note.startswith("Done by the processor instead: ")
    assert "device:" not in note


def test_the_status_is_a_sentence() -> None:
    assert devices.status() == sb.cuda_status() != ""

# SPDX-License-Identifier: MIT
"""Thousands of sites, sources or copies in few faces: a face takes long then, and heeds who cancels all the same."""

from __future__ import annotations

from collections.abc import Callable
from time import process_time

import pytest

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_it_stops_when_silent

MESH = sb.Mesh(*meshes.tetrahedron())
CUBE = sb.Mesh(*meshes.cube())
GRAPH = sb.SaddleVertexGraph(MESH, threads=1)


@pytest.mark.parametrize(
    ("call", "count", "fraction"),
    [
        (lambda sites, job: sb.exact_distances(MESH, sites, job=job), 30_000, 0.0),
        (lambda sites, job: sb.geodesic_voronoi(GRAPH, sites, threads=1, job=job), 20_000, 0.0),
        (lambda sites, job: sb.geodesic_voronoi(GRAPH, sites, exact=True, threads=1, job=job), 10_000, 0.35),
    ],
    ids=["exact distances", "cells", "exact cells"],
)
def test_it_stops_at_once(call: Callable[[sb.SurfacePoints, sb.Job], object], count: int, fraction: float) -> None:
    sites = sb.sample(MESH, count, seed=2)
    check_it_stops_when_silent(lambda job: call(sites, job), fraction)


def test_tiny_copies_are_laid_as_fast_on_large_faces() -> None:
    """What a copy may hold is looked for about it, not all over its face: four times as many took 11 times longer."""

    def seconds_each(size: float) -> float:
        start = process_time()
        laid = sb.distribute(CUBE, sb.Shape.disk(), size=size, maximal=True, threads=1)
        return (process_time() - start) / len(laid.placements)

    assert seconds_each(0.005) <= 2 * seconds_each(0.01)

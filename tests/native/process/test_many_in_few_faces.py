# SPDX-License-Identifier: MIT
"""Thousands of sites or sources in four faces: a face takes long then, and heeds who cancels all the same."""

from __future__ import annotations

from collections.abc import Callable

import pytest

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_it_stops_when_silent

MESH = sb.Mesh(*meshes.tetrahedron())
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

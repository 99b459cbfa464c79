# SPDX-License-Identifier: MIT
"""Diagrams on a torus: the same as of many copies, whatever the box, and refused where there is none."""

from __future__ import annotations

import pickle
from itertools import product

import numpy as np
import pytest

import saddleback as sb
from tests.native import plane_sites
from tests.native.cancelling import check_progress_and_cancel

KINDS = [kind for kind in plane_sites.KINDS if kind not in {"huge", "tiny"}]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("count", [2, 5, 300, 3000])
@pytest.mark.parametrize("box", [[(0, 0), (1, 1)], [(-3, 2), (0.5, 2.25)]])
def test_it_closes(kind: str, count: int, box: list[tuple[float, float]]) -> None:
    sites = plane_sites.KINDS[kind](count, np.random.default_rng(count))
    if not len(sites):
        return
    diagram = sb.periodic_voronoi_2d(sites, box)
    size = diagram.box[1] - diagram.box[0]
    own = diagram.site_of == np.arange(len(sites))
    assert diagram.areas[own].sum() == pytest.approx(size.prod(), rel=1e-12)
    assert len(diagram.vertices) - len(diagram.edges) + own.sum() == 0
    assert len(diagram.delaunay) == 2 * own.sum()
    assert (diagram.vertices >= diagram.box[0]).all()
    assert (diagram.vertices < diagram.box[1]).all()
    corners = diagram.sites[diagram.delaunay] + diagram.delaunay_shifts * size
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    assert (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum() == pytest.approx(2 * size.prod())
    offsets, places = diagram.cells
    assert (places == diagram.vertices[diagram.corner_vertices] + diagram.corner_shifts * size).all()
    assert offsets[-1] == len(places) == 2 * len(diagram.edges)


@pytest.mark.parametrize("weighted", [False, True])
def test_it_is_the_diagram_of_all_copies(weighted: bool) -> None:
    rng = np.random.default_rng(4)
    sites = rng.random((400, 2))
    weights = 1e-3 * rng.random(400) if weighted else None
    diagram = sb.periodic_voronoi_2d(sites, weights=weights)
    copies = np.concatenate([diagram.sites + shift for shift in [(0, 0), *product((-1, 0, 1), repeat=2)]])
    copies = np.concatenate([copies[:400], np.delete(copies[400:], slice(1600, 2000), axis=0)])
    plain = sb.voronoi_2d(copies) if weights is None else sb.power_diagram_2d(copies, np.tile(weights, 9))
    assert np.abs(diagram.areas - plain.areas[:400]).max() < 1e-15
    assert np.nanmax(np.abs(diagram.centroids - plain.centroids[:400])) < 1e-12
    assert (diagram.hidden.size > 0) == weighted
    points = rng.random((500, 2))
    assert (diagram.locate(points) == plain.locate(points) % 400).all()
    assert (diagram.locate(points + [3, -7]) == diagram.locate(points)).mean() > 0.99


def test_one_site_has_the_box_and_touches_itself() -> None:
    diagram = sb.periodic_voronoi_2d([[5.2, -0.7]])
    assert diagram.sites == pytest.approx(np.array([[0.2, 0.3]]))
    assert len(diagram.vertices) == 1
    assert diagram.edge_sites.tolist() == [[0, 0], [0, 0]]
    assert diagram.areas.tolist() == [1]
    assert diagram.cells[1] == pytest.approx(np.array([[-0.3, -0.2], [0.7, -0.2], [0.7, 0.8], [-0.3, 0.8]]))


def test_where_the_box_begins_changes_no_cell() -> None:
    rng = np.random.default_rng(6)
    sites = np.round(rng.random((200, 2)) * 2**20) / 2**20
    here, there = (sb.periodic_voronoi_2d(sites, [low, low + 1]) for low in (np.zeros(2), np.array([0.25, -0.5])))
    assert np.abs(here.areas - there.areas).max() < 1e-15
    assert len(here.edges) == len(there.edges)


def test_lloyd_on_a_torus_comes_near_to_hexagons() -> None:
    sites = np.random.default_rng(2).random((100, 2))
    for _ in range(150):
        sites = sb.periodic_voronoi_2d(sites).centroids
    assert sb.periodic_voronoi_2d(sites).areas.std() < 2e-3


def test_threads_and_travel_change_nothing() -> None:
    sites = np.random.default_rng(7).random((30_000, 2))
    one, three = (sb.periodic_voronoi_2d(sites, threads=threads) for threads in (1, 3))
    again = pickle.loads(pickle.dumps(one))
    for name in (
        "vertices",
        "edges",
        "edge_shifts",
        "edge_sites",
        "edge_site_shifts",
        "corner_shifts",
        "delaunay",
        "areas",
    ):
        assert getattr(one, name).tobytes() == getattr(three, name).tobytes() == getattr(again, name).tobytes()
    assert (again.locate(sites[:9]) == np.arange(9)).all()


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"sites": np.zeros((0, 2))}, "sites: wanted at least one site"),
        ({"sites": [[0.1, np.inf]]}, "sites: coordinates of site 0"),
        ({"box": [(0, 0)]}, "box: wanted two corners, got 1"),
        ({"box": [(0, 0), (1, 0)]}, r"box: wanted a lower left and an upper right corner, got \(0, 0\) and \(1, 0\)"),
        ({"box": [(0, 0), (1, np.nan)]}, "box: wanted finite corners"),
        ({"box": [(0, 0), (1, 1e-14)]}, "box: it is 1 by .*, too thin"),
        ({"box": [(1e20, 0), (1e20 + 1e5, 1)]}, "box: it is .*, too thin"),
        ({"weights": [1, 2, 3]}, r"weights: wanted shape \(1,\)"),
        ({"weights": [np.nan]}, "weights: weight 0 is nan"),
    ],
)
def test_what_makes_no_sense_is_refused(options: dict[str, object], sentence: str) -> None:
    with pytest.raises(sb.InputError, match=sentence):
        sb.periodic_voronoi_2d(**{"sites": [[0.5, 0.5]], **options})  # type: ignore[arg-type]


def test_it_stops_when_told() -> None:
    sites = np.random.default_rng(1).random((400_000, 2))
    check_progress_and_cancel(lambda job: sb.periodic_voronoi_2d(sites, job=job), 0.1)

# SPDX-License-Identifier: MIT
"""Relaxation with curves: sites that are held on them slide along, and all parts keep a site."""

from __future__ import annotations

import threading
import time
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import saddleback as sb
from tests import meshes


def square_sides(mesh: sb.Mesh) -> list[sb.SurfaceCurve]:
    """The sides of the unit square as open curves along the boundary."""
    loop = mesh.boundary_loops[0]
    places = mesh.vertices[loop]
    corners = [i for i, p in enumerate(places) if set(p[:2]) <= {0.0, 1.0}]
    loop = np.roll(loop, -corners[0])
    ends = np.append(np.array(corners) - corners[0], len(loop))
    loop = np.append(loop, loop[0])
    return [sb.SurfaceCurve(mesh, loop[a : b + 1]) for a, b in pairwise(ends)]


@pytest.mark.parametrize("method", ["lbfgs", "lloyd"])
def test_held_sites_slide_along_their_curves(method: str) -> None:
    """A square remeshed: its corners stay, its sides keep their sites, none of which crowd."""
    mesh = sb.Mesh(*meshes.grid(30, 30))
    graph = sb.SaddleVertexGraph(mesh, k=40)
    relaxed = sb.centroidal_voronoi(graph, count=90, curves=square_sides(mesh), max_iterations=25, method=method)
    assert (np.diff(relaxed.energy) <= 0).all()
    assert len(relaxed.sites) == len(relaxed.held) == 90
    places = relaxed.sites.positions(mesh)[:, :2]
    sides = [places[:, 1] == 0, places[:, 0] == 1, places[:, 1] == 1, places[:, 0] == 0]
    on_sides = np.logical_or.reduce(sides)
    assert np.array_equal(on_sides, relaxed.held >= 0)
    for corner in ((0, 0), (1, 0), (1, 1), (0, 1)):
        assert (places == corner).all(axis=1).sum() == 1
    for side, across in zip(sides, (0, 1, 0, 1), strict=True):
        gaps = np.diff(np.sort(places[side, across]))
        assert len(gaps) in range(6, 12)
        assert gaps.max() < 1.6 * gaps.min()
    dual = relaxed.cells.dual("strict")
    assert not dual.issues
    corners = dual.vertices[dual.triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    assert areas.sum() == pytest.approx(1, rel=1e-9)  # nothing cut off


def test_a_closed_curve_holds_given_sites() -> None:
    mesh = sb.Mesh(*meshes.torus(60, 24))
    graph = sb.SaddleVertexGraph(mesh, k=40)
    outside = np.flatnonzero(np.abs(mesh.vertices[:, 2]) < 1e-12)
    outside = outside[np.linalg.norm(mesh.vertices[outside], axis=1) > 1]
    outside = outside[np.argsort(np.arctan2(mesh.vertices[outside, 1], mesh.vertices[outside, 0]))]
    curve = sb.SurfaceCurve(mesh, outside, closed=True)
    start = sb.sample(mesh, 40, seed=1)
    held = np.where(np.arange(40) < 9, 0, -1)
    relaxed = sb.centroidal_voronoi(graph, sites=start, curves=[curve], held=held, max_iterations=15)
    places = relaxed.sites.positions(mesh)
    np.testing.assert_allclose(places[:9, 2], 0, atol=1e-12)
    assert (np.linalg.norm(places[:9, :2], axis=1) > 1.34 * np.cos(np.pi / 60)).all()
    assert np.array_equal(relaxed.held, held)
    assert (np.diff(relaxed.energy) <= 0).all()
    counted = sb.centroidal_voronoi(graph, count=60, curves=[curve], max_iterations=20)
    on_curve = counted.sites.positions(mesh)[counted.held == 0]
    angles = np.sort(np.arctan2(on_curve[:, 1], on_curve[:, 0]))
    gaps = np.append(np.diff(angles), angles[0] + 2 * np.pi - angles[-1])
    assert len(gaps) > 10
    assert gaps.max() < 2.2 * gaps.min()  # a free site may have come between two


@pytest.mark.parametrize("spare", [-1, 0, 1, 30])
def test_parts_beside_curves_keep_a_site(spare: int) -> None:
    """Specks beside the side of a square, each nearer to its sites than all else: their only sites are not left out."""
    vertices, triangles = meshes.grid(10, 10)
    specks = 12
    corners = np.array([[0.0, 0, 0], [1e-3, 0, 0], [0, 1e-3, 0]])
    more = [corners + [(i + 0.5) / specks, -1e-2, 0] for i in range(specks)]
    ends = np.arange(3 * specks).reshape(-1, 3) + len(vertices)
    mesh = sb.Mesh(np.vstack([vertices, *more]), np.vstack([triangles, ends]).astype(np.int32))
    sides = square_sides(mesh)
    graph = sb.SaddleVertexGraph(mesh, k=10)
    with pytest.raises(sb.InputError, match=r"count: the curves (and the parts without any )?need") as refusal:
        sb.centroidal_voronoi(graph, count=specks + 4, curves=sides, max_iterations=3)
    needed = int(str(refusal.value).split("need ")[1].split()[0])
    count = next(
        count for count in range(needed, needed + 100) if "need" not in refusal_of(graph, count=count, curves=sides)
    )
    if spare < 0:
        assert "need" in refusal_of(graph, count=count - 1, curves=sides)
        return
    relaxed = sb.centroidal_voronoi(graph, count=count + spare, curves=sides, max_iterations=3)
    assert len(relaxed.sites) == count + spare
    parts = mesh.components[mesh.triangles[relaxed.sites.faces, 0]]
    assert set(parts.tolist()) == set(range(specks + 1))
    assert relaxed.cells.areas.sum() == pytest.approx(mesh.area, rel=1e-9)


def refusal_of(graph: sb.SaddleVertexGraph, **arguments: Any) -> str:
    try:
        sb.centroidal_voronoi(graph, max_iterations=0, **arguments)
    except sb.InputError as refusal:
        return str(refusal)
    return ""


def lines_of_grid(n: int, step: int) -> tuple[sb.Mesh, list[sb.SurfaceCurve]]:
    """A grid of n x n vertices, and every edge of each step-th row and column between two crossings as a curve."""
    mesh = sb.Mesh(*meshes.grid(n, n))
    number = np.arange(n * n).reshape(n, n)
    rows, columns = number[::step], number[:, ::step]
    ends = [(rows[:, :-1], rows[:, 1:]), (columns[:-1], columns[1:])]
    edges = np.concatenate([np.stack([a.ravel(), b.ravel()], axis=1) for a, b in ends]).astype(np.int32)
    return mesh, sb.feature_curves(mesh, np.pi, edges=edges)


def test_free_sites_are_those_of_the_sample_that_are_far_from_curves() -> None:
    mesh, curves = lines_of_grid(40, 13)
    found = sb.centroidal_voronoi(sb.SaddleVertexGraph(mesh, k=10), count=900, curves=curves, max_iterations=0)
    places, on_curves = found.sites.positions(mesh), found.held >= 0
    sampled = sb.sample(mesh, 900, seed=0).positions(mesh)
    away = np.linalg.norm(sampled[:, None] - places[on_curves], axis=2).min(axis=1)
    kept = np.sort(np.argsort(away, kind="stable")[on_curves.sum() :])
    np.testing.assert_allclose(places[~on_curves], sampled[kept], atol=1e-12)


def test_many_short_curves_take_about_as_long_as_none() -> None:
    """Their ends were held against each other one by one: fourteen times as long, and nothing could be stopped."""
    mesh, curves = lines_of_grid(150, 1)
    graph, seconds = sb.SaddleVertexGraph(mesh, k=10), []
    assert len(curves) > 40_000
    for chosen in ([], curves):
        begin = time.process_time()
        sb.centroidal_voronoi(graph, count=70_000, curves=chosen or None, max_iterations=0)
        seconds.append(time.process_time() - begin)
    assert seconds[1] < 5 * seconds[0]
    job = sb.Job()
    timer = threading.Timer(0.2, job.cancel)
    timer.start()
    begin = time.perf_counter()
    with pytest.raises(sb.Cancelled):
        sb.centroidal_voronoi(graph, count=70_000, curves=curves, max_iterations=0, job=job)
    assert time.perf_counter() - begin < 2.0


def test_bad_curves() -> None:
    mesh = sb.Mesh(*meshes.grid(10, 10))
    graph = sb.SaddleVertexGraph(mesh, k=10)
    curve = sb.SurfaceCurve(mesh, [0, 1, 2])
    other = sb.SurfaceCurve(sb.Mesh(*meshes.cube()), [0, 1])
    for arguments, words in (
        (
            {"sites": [5, 6], "curves": [curve], "held": [0]},
            "held: wanted a curve or -1 for each of the 2 sites, got 1",
        ),
        ({"sites": [5, 6], "curves": [curve], "held": [0, 1]}, "held: wanted -1 to 0, got 1 for site 1"),
        ({"sites": [5, 6], "held": [0, -1]}, "held"),
        ({"sites": [5], "curves": [other], "held": [0]}, "curve 0 lies on another mesh"),
        ({"count": 5, "curves": [curve], "held": [0] * 5}, "held: wanted sites"),
        ({"count": 3, "curves": square_sides(mesh)}, "the curves need"),
        ({"count": 3, "curves": [7]}, "SurfaceCurve"),
    ):
        with pytest.raises(sb.InputError, match=words):
            sb.centroidal_voronoi(graph, **arguments)


def test_a_part_that_a_held_site_leaves_bare_is_told() -> None:
    """Vertices without a label were counted before the list of labels began."""
    mesh = sb.Mesh(*meshes.two_components())
    first, other = (np.flatnonzero(mesh.components == part)[:4] for part in (0, 1))
    ring = mesh.triangles[np.isin(mesh.triangles, other[0]).any(axis=1)][0]
    curve = sb.SurfaceCurve(mesh, ring[:2])
    graph = sb.SaddleVertexGraph(mesh)
    with pytest.raises(
        sb.InputError, match="sites: once held ones are on their curves, 1 of the mesh's 2 separate parts"
    ):
        sb.centroidal_voronoi(graph, sites=[first[0], *other], curves=[curve], held=[0, -1, -1, -1, -1])
    kept = sb.centroidal_voronoi(graph, sites=[*first, *other], curves=[curve], held=[0, *[-1] * 7], max_iterations=2)
    assert (kept.cells.areas > 0).all()


def test_annealing_holds_what_is_held_and_depends_on_no_thread() -> None:
    mesh = sb.Mesh(*meshes.grid(30, 30))
    graph = sb.SaddleVertexGraph(mesh, k=40)
    sides = square_sides(mesh)
    start = sb.sample(mesh, 60, seed=1)
    held = np.repeat(np.array([0, -1], np.int32), [8, 52])

    def annealed(threads: int) -> sb.CentroidalVoronoi:
        return sb.centroidal_voronoi(
            graph, sites=start, annealing=20, max_iterations=4, fixed=[50, 55], curves=sides, held=held, threads=threads
        )

    first = annealed(1)
    for threads in (2, 8):
        again = annealed(threads)
        assert again.sites.barycentric.tobytes() == first.sites.barycentric.tobytes()
        assert again.energy.tobytes() == first.energy.tobytes()
    places, begun = first.sites.positions(mesh), start.positions(mesh)
    np.testing.assert_array_equal(places[[50, 55]], begun[[50, 55]])
    side = sides[0].points.positions(mesh)
    flat = int(np.argmin(np.ptp(side[:, :2], axis=0)))
    np.testing.assert_allclose(places[:8, flat], side[0, flat], atol=1e-9)
    assert (np.linalg.norm((places - begun)[8:50], axis=1) > 0).all()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Requests become results: the numbers of the Blender mesh, the cache, sentences, cancel."""

import threading
import time

import meshes_of_core as shapes
import numpy as np
import pytest

import saddleback as sb
from saddleback_blender.core import runs
from saddleback_blender.core.cache import Cache
from saddleback_blender.core.errors import BadInputError
from saddleback_blender.core.graphs import mesh_of_surface
from saddleback_blender.core.requests import DistanceRequest, Surface, TessellateRequest
from saddleback_blender.core.settings import DistanceSettings, TessellateSettings

QUICK = {"count": 8, "iterations": 3, "k": 20}


def tessellate(surface, cache, density=None, sites=None, **settings):
    request = TessellateRequest(surface, TessellateSettings(**{**QUICK, **settings}), density, sites)
    return runs.tessellate(request, runs.new_progress(), cache)


def area(vertices, triangles):
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


@pytest.fixture
def cache():
    return Cache(2**30)


def test_checking_a_mesh_is_watched(monkeypatch, cache):
    """It takes seconds where there are millions of faces."""
    mesh, jobs = sb.Mesh, []

    def checked(*arrays, job=None):
        jobs.append(job)
        return mesh(*arrays, job=job)

    monkeypatch.setattr(sb, "Mesh", checked)
    mesh_of_surface(shapes.grid(4), runs.new_progress(), cache)
    assert [job.fraction for job in jobs] == [1.0]


def test_cells_of_a_surface_with_loose_vertices(cache):
    surface = shapes.grid(12, loose=3)
    result = tessellate(surface, cache, make_cells=True)
    assert result.count == 8 and result.vertex_cell.shape == (surface.vertex_count,)
    assert (result.vertex_cell[:3] == -1).all() and np.isinf(result.vertex_distance[:3]).all()
    assert (result.vertex_cell[3:] >= 0).all() and np.isfinite(result.vertex_distance[3:]).all()
    assert result.cell_area.sum() == pytest.approx(1.0, rel=1e-9)
    # The cut mesh: as large as the surface, each cell as large as said.
    sums = np.bincount(result.mesh.triangle_cell, area(result.mesh.vertices, result.mesh.triangles), minlength=8)
    np.testing.assert_allclose(sums, result.cell_area, atol=1e-9)
    np.testing.assert_allclose(result.sites_normal, np.tile([0.0, 0.0, 1.0], (8, 1)), atol=1e-12)
    assert (np.diff(result.energy) <= 0).all() and result.iterations <= 3 and result.stop_reason


def test_edges_join_the_cells_that_they_name(cache):
    result = tessellate(shapes.grid(12), cache)
    assert result.edge_offsets[0] == 0 and result.edge_offsets[-1] == len(result.edge_points)
    for edge, (left, right) in enumerate(result.edge_cells):
        points = result.edge_points[result.edge_offsets[edge] : result.edge_offsets[edge + 1]]
        assert len(points) >= 2 and left != right
        # In the plane every point of a bisector is as far from one site as from the other.
        to_left, to_right = (np.linalg.norm(points - result.sites_position[site], axis=1) for site in (left, right))
        np.testing.assert_allclose(to_left, to_right, atol=0.02)


def test_fixed_sites_stay_and_settings_of_the_count_do_not_matter(cache):
    surface = shapes.grid(12, loose=2)
    sites = np.array([2, 14, 170], np.int32)
    first = tessellate(surface, cache, sites=sites)
    np.testing.assert_allclose(first.sites_position, surface.vertices[sites - 2], atol=1e-12)
    assert first.iterations == 0 and len(first.energy) == 0
    tessellate(surface, cache, sites=sites, seed=5, count=3, iterations=9)
    assert cache.builds["cells"] == 1
    tessellate(surface, cache, sites=sites, relax_sites=True)
    assert cache.builds["cells"] == 2


def test_of_several_starts_the_best_is_taken(cache):
    surface = shapes.grid(16)
    alone = [tessellate(surface, cache, count=20, iterations=6, seed=seed) for seed in (4, 5, 6)]
    best = tessellate(surface, cache, count=20, iterations=6, seed=4, starts=3)
    assert best.energy[-1] == min(result.energy[-1] for result in alone)
    # Sites that are given begin where they are.
    sites = np.array([2, 14, 170], np.int32)
    kept = [tessellate(surface, cache, sites=sites, relax_sites=True, starts=starts) for starts in (1, 3)]
    np.testing.assert_array_equal(kept[0].sites_position, kept[1].sites_position)


def test_annealed_before_the_iterations(cache):
    """Where sites move; those that stay are the same cells, found once."""
    surface = shapes.grid(16)
    plain, annealed = (tessellate(surface, cache, count=20, iterations=6, seed=4, annealing=steps) for steps in (0, 30))
    assert annealed.energy[-1] < plain.energy[-1]
    assert annealed.iterations <= 6
    assert cache.builds["cells"] == 2
    sites = np.array([2, 14, 170], np.int32)
    for steps in (0, 30):
        tessellate(surface, cache, sites=sites, annealing=steps)
    assert cache.builds["cells"] == 3
    moved = tessellate(surface, cache, sites=sites, relax_sites=True, annealing=30)
    assert cache.builds["cells"] == 4
    assert (moved.sites_position != surface.vertices[sites]).any()


def test_more_cells_than_vertices(cache):
    surface = shapes.grid(3, loose=1)
    result = tessellate(surface, cache, count=90, iterations=8, k=15, make_cells=True)
    assert len(result.sites_position) == 90
    assert len(np.unique(result.vertex_cell[1:])) <= 16
    areas = np.bincount(result.mesh.triangle_cell, area(result.mesh.vertices, result.mesh.triangles), minlength=90)
    assert (areas > 0).all()
    whole = area(surface.vertices, surface.triangles).sum()
    assert areas.sum() == pytest.approx(whole, rel=1e-6)
    assert areas.max() < 4 * areas.min()


def test_places_in_the_world_come_to_the_nearest_point(cache):
    result = tessellate(shapes.grid(12), cache, sites=np.array([[0.2, 0.2, 0.7], [0.8, 0.8, -0.3]]))
    np.testing.assert_allclose(result.sites_position, [[0.2, 0.2, 0], [0.8, 0.8, 0]], atol=1e-12)


def test_no_iterations_leaves_the_sites_to_chance_and_seed(cache):
    surface = shapes.grid(12)
    first, second = (tessellate(surface, cache, iterations=0, seed=seed) for seed in (1, 2))
    assert first.iterations == 0 and not np.allclose(first.sites_position, second.sites_position)
    again = tessellate(surface, Cache(2**30), iterations=0, seed=1)
    np.testing.assert_array_equal(again.sites_position, first.sites_position)


def test_the_quick_method_is_the_default_and_gets_lower_in_as_many_steps(cache):
    surface = shapes.grid(20)
    quick, lloyd = (
        tessellate(surface, cache, count=30, iterations=12, **method) for method in ({}, {"method": "LLOYD"})
    )
    assert cache.builds["cells"] == 2 and quick.energy[0] == lloyd.energy[0]
    assert quick.energy[-1] < lloyd.energy[-1]
    tessellate(surface, cache, count=30, iterations=0)
    tessellate(surface, cache, count=30, iterations=0, method="LLOYD")
    assert cache.builds["cells"] == 3  # without steps there is no method


def test_equal_density_draws_equal_numbers_of_cells_and_ramps_do_not(cache):
    surface = shapes.grid(30)
    ramp = 1 + 7 * surface.vertices[:, 0]
    painted = tessellate(surface, cache, density=ramp, count=80, iterations=20)
    left = (painted.sites_position[:, 0] < 0.5).sum()
    # Painted 1 to 8: the left half holds the integral of 1 + 7 x over [0, 1/2] against that over [0, 1].
    assert left / 80 == pytest.approx((0.5 + 7 / 8) / 4.5, abs=0.06)


def test_each_object_gets_its_own_loose_vertices_from_one_cached_solve(cache):
    bare, loose = shapes.grid(8), shapes.grid(8, loose=4)
    assert bare.key == loose.key
    first, second = tessellate(bare, cache), tessellate(loose, cache)
    assert cache.builds == {"mesh": 1, "graph": 1, "cells": 1, "dual": 1}
    np.testing.assert_array_equal(first.vertex_cell, second.vertex_cell[4:])


def test_without_room_in_the_cache_everything_is_still_right():
    surface = shapes.grid(8)
    kept, bare = tessellate(surface, Cache(2**30), make_cells=True), tessellate(surface, Cache(0), make_cells=True)
    np.testing.assert_array_equal(kept.vertex_cell, bare.vertex_cell)
    np.testing.assert_array_equal(kept.mesh.triangles, bare.mesh.triangles)


def test_distances_to_the_nearest_source_within_a_limit(cache):
    surface = shapes.grid(20, loose=1)
    sources = np.array([1, 441], np.int32)
    request = DistanceRequest(surface, DistanceSettings(limit=0.4, k=50), sources)
    values = runs.distance(request, runs.new_progress(), cache).vertex_distance
    exact = np.min([np.linalg.norm(surface.vertices - surface.vertices[s - 1], axis=1) for s in sources], axis=0)
    assert np.isinf(values[0])
    reached = np.isfinite(values[1:])
    np.testing.assert_allclose(values[1:][reached], exact[reached], rtol=0.02)
    assert reached[exact < 0.39].all() and not reached[exact > 0.41].any()


def test_sentences_name_the_object(cache):
    surface = shapes.grid(3, loose=1)
    with pytest.raises(BadInputError, match="'Shape': the site at vertex 0 belongs to no face"):
        tessellate(surface, cache, sites=np.array([0, 3], np.int32))
    bad = Surface("Shape", surface.vertices, np.concatenate([surface.triangles, surface.triangles[:1]]), 17)
    with pytest.raises(sb.MeshError):
        tessellate(bad, cache)
    assert not cache.builds


def test_cancel_ends_a_run_within_a_tenth_of_a_second(cache):
    progress = runs.new_progress()
    request = TessellateRequest(shapes.grid(150), TessellateSettings(count=100, iterations=50, k=60))
    raised = []

    def work():
        try:
            runs.tessellate(request, progress, cache)
        except sb.Cancelled as error:
            raised.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    time.sleep(0.3)
    asked = time.perf_counter()
    progress.cancel()
    thread.join()
    assert time.perf_counter() - asked < 0.1 and raised
    assert "cells" not in cache.builds


def test_distance_to_the_edge_is_the_distance_to_the_bisector(cache):
    surface = shapes.grid(10, loose=2)
    result = tessellate(surface, cache, sites=np.array([[0.25, 0.5, 0], [0.75, 0.5, 0]]), write_edge_distance=True)
    np.testing.assert_allclose(result.edge_distance[2:], abs(surface.vertices[:, 0] - 0.5), atol=1e-9)
    assert np.isinf(result.edge_distance[:2]).all() and cache.builds["edge distance"] == 1
    assert tessellate(surface, cache).edge_distance is None


def test_chosen_lines_hold_sites_and_are_part_of_what_is_kept(cache):
    surface = shapes.grid(16, loose=3)
    places = surface.vertices[:, :2]
    middle = np.flatnonzero(np.abs(places[:, 0] - 0.5) < 1e-9)
    middle = middle[np.argsort(places[middle, 1])]
    line = np.stack([middle[:-1], middle[1:]], axis=1)
    in_blender = surface.used[line].astype(np.int32)
    loose = np.array([[0, 1], [0, in_blender[0, 0]]], np.int32)  # no face has these

    def sites(marked, **settings):
        wanted = TessellateSettings(**{**QUICK, "count": 40, **settings})
        request = TessellateRequest(surface, wanted, marked_edges=marked)
        return runs.tessellate(request, runs.new_progress(), cache).sites_position[:, :2]

    def on_border(found):
        return int((np.minimum(found, 1 - found).min(axis=1) < 1e-12).sum())

    free = sites(None)
    assert on_border(free) == 0
    held = sites(np.concatenate([in_blender, loose]))
    assert (np.abs(held[:, 0] - 0.5) < 1e-12).sum() >= 5 and on_border(held) == 2  # the line's ends
    bordered = sites(None, hold_boundary=True)
    assert on_border(bordered) >= 16
    assert {tuple(corner) for corner in bordered} >= {(0, 0), (1, 0), (0, 1), (1, 1)}
    np.testing.assert_array_equal(sites(None), free)
    assert cache.builds["cells"] == 3

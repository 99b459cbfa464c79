# SPDX-License-Identifier: GPL-3.0-or-later
"""The dual mesh of a run: what carries over from the surface, faults in words, figures."""

import meshes_of_core as shapes
import numpy as np
import pytest

from saddleback_blender.core import runs
from saddleback_blender.core.cache import Cache
from saddleback_blender.core.figures import faults_of, lines_of
from saddleback_blender.core.requests import Surface, TessellateRequest
from saddleback_blender.core.results import Dual, Figures
from saddleback_blender.core.settings import TessellateSettings
from saddleback_blender.core.surfaces.carried import Anchors
from tests import synthetic_cells

QUICK = {"iterations": 5, "k": 40, "make_dual": True}


def run(surface, cache=None, **settings):
    request = TessellateRequest(surface, TessellateSettings(**{**QUICK, **settings}))
    return runs.tessellate(request, runs.new_progress(), cache or Cache(2**30))


def ball(levels=4):
    vertices, triangles = synthetic_cells.sphere(levels)
    return Surface("Ball", vertices, triangles, len(vertices))


def euler(triangles):
    edges = np.unique(np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    return len(np.unique(triangles)) - len(edges) + len(triangles)


def test_the_dual_of_a_ball_is_a_ball_with_a_vertex_for_each_site():
    result = run(ball(), count=60)
    dual = result.dual
    np.testing.assert_array_equal(dual.vertices, result.sites_position)
    assert dual.added == 0 and not dual.issues
    assert euler(dual.triangles) == 2 and len(dual.triangles) == 2 * 60 - 4
    a, b, c = (dual.vertices[dual.triangles[:, i]] for i in range(3))
    assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), a + b + c) > 0).all()  # seen from outside
    surface = ball()
    places = (dual.barycentric[:, :, None] * surface.vertices[surface.triangles[dual.faces]]).sum(axis=1)
    np.testing.assert_allclose(places, dual.vertices, atol=1e-12)


def test_figures_are_there_with_and_without_the_mesh_and_say_how_even_cells_are():
    with_dual, without = run(ball(), count=60), run(ball(), count=60, make_dual=False)
    assert without.dual is None and with_dual.figures == without.figures
    rough = run(ball(), count=60, iterations=0)
    assert rough.figures.energy is None or rough.figures.energy > with_dual.figures.energy
    assert 0 < rough.figures.triangle_quality < with_dual.figures.triangle_quality < 1
    assert np.radians(40) < with_dual.figures.least_angle < np.radians(60)
    assert 1.0 < with_dual.figures.energy < 1.2


def test_too_few_cells_are_told_when_strict_and_mended_by_repair():
    surface = ball(3)
    cache = Cache(2**30)
    strict, repaired = (run(surface, cache, count=2, dual_policy=policy) for policy in ("STRICT", "REPAIR"))
    assert cache.builds["cells"] == 1 and cache.builds["dual"] == 2
    assert strict.count == 2 and len(strict.dual.vertices) == 2 and len(strict.dual.triangles) == 0
    assert strict.dual.issues and strict.figures is None and not lines_of(None)
    (told,) = faults_of(strict.dual, "STRICT")
    assert "too large" in told and strict.dual.issues[0] in told and "choose Repair" in told
    assert "choose Repair" not in faults_of(strict.dual, "REPAIR")[0]  # of a look, which has tried
    assert repaired.dual.added == len(repaired.dual.vertices) - 2 > 0
    assert not repaired.dual.issues and not faults_of(repaired.dual, "REPAIR") and euler(repaired.dual.triangles) == 2


def needle():
    vertices, triangles = synthetic_cells.sphere(4)
    return Surface("Needle", vertices * (0.15, 0.15, 2.0), triangles, len(vertices))


@pytest.mark.parametrize("policy", ["STRICT", "REPAIR"])
def test_the_count_is_kept_by_cells_that_move_to_where_the_mesh_needs_them(policy):
    cache = Cache(2**30)
    wanted = {"count": 60, "iterations": 20, "k": 60, "dual_policy": policy}
    plain, kept = (run(needle(), cache, keep_count=keep, **wanted) for keep in (False, True))
    assert cache.builds["cells"] == 2
    assert plain.exchanged == 0 and (plain.dual.issues if policy == "STRICT" else plain.dual.added)
    assert kept.exchanged > 0 and not kept.dual.issues and kept.dual.added == 0
    np.testing.assert_array_equal(kept.dual.vertices, kept.sites_position)
    assert len(np.unique(kept.dual.triangles)) == 60 and euler(kept.dual.triangles) == 2


def test_sites_are_moved_for_a_dual_mesh_only_and_only_where_they_may_move():
    cache = Cache(2**30)
    wanted = {"count": 60, "iterations": 20, "k": 60}
    without = run(needle(), cache, make_dual=False, **wanted)
    plain = run(needle(), cache, keep_count=False, **wanted)
    np.testing.assert_array_equal(without.sites_position, plain.sites_position)
    assert cache.builds["cells"] == 1
    at_random = run(needle(), cache, **{**wanted, "iterations": 0})
    assert at_random.exchanged == 0 and at_random.dual.added > 0


def test_only_some_faults_are_told_one_by_one():
    none = np.empty((0, 3))
    dual = Dual(none, none.astype(np.int32), none, none, 0, 0, tuple(f"fault {i}" for i in range(5)))
    (told,) = faults_of(dual, "STRICT")
    assert "fault 2; and 2 more" in told and "fault 3" not in told


def test_figures_in_words():
    lines = lines_of(Figures(0.9213, np.radians(54.06), 0.123, 1.0219))
    assert lines[0].endswith("quality 0.921, least angle 54.1\N{DEGREE SIGN}, 12 % irregular")
    assert "1.022" in lines[1]
    assert len(lines_of(Figures(0.9, 0.9, 0.1, None))) == 1


@pytest.mark.parametrize("width", [None, 2, 3])
def test_linear_functions_carry_over_exactly(width):
    surface = shapes.grid(10)
    random = np.random.default_rng(0)
    faces = random.integers(0, len(surface.triangles), 50)
    weights = random.dirichlet((1, 1, 1), 50)
    corners = np.arange(3 * len(surface.triangles)).reshape(-1, 3)
    anchors = Anchors(surface.triangles[faces], corners[faces], faces // 2, weights)
    places = (weights[:, :, None] * surface.vertices[surface.triangles[faces]]).sum(axis=1)
    slope = np.array([3.0, -2.0, 1.0]) if width is None else random.random((3, width))
    values = surface.vertices @ slope
    np.testing.assert_allclose(anchors.values(values, "POINT"), places @ slope, atol=1e-12)
    at_corners = values[surface.triangles.ravel()]
    np.testing.assert_allclose(anchors.values(at_corners, "CORNER"), places @ slope, atol=1e-12)
    polygons = np.arange(len(surface.triangles) // 2)
    np.testing.assert_array_equal(anchors.values(polygons, "FACE"), faces // 2)


def test_whole_numbers_are_those_of_the_nearest_corner():
    anchors = Anchors(np.array([[4, 5, 6]]), np.array([[0, 1, 2]]), np.array([0]), np.array([[0.2, 0.5, 0.3]]))
    assert anchors.values(np.arange(10, dtype=np.int32), "POINT") == [5]
    assert anchors.values(np.array([True, False, True]), "CORNER") == [False]

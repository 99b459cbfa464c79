# SPDX-License-Identifier: MIT
"""Values spread from a few places, curvatures, densities from distances."""

from __future__ import annotations

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_progress_and_cancel

METHODS = ("harmonic", "biharmonic")


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_values_meet_the_given_ones_and_keep_their_range(case: meshes.Case, method: str) -> None:
    rng = np.random.default_rng(2)
    places = rng.choice(case.mesh.vertex_count, min(5, case.mesh.vertex_count), replace=False).astype(np.int32)
    values = rng.uniform(1, 8, len(places))
    spread = sb.spread_values(case.mesh, places, values, method)
    np.testing.assert_allclose(spread[places], values, atol=1e-5)
    assert values.min() <= spread.min() and spread.max() <= values.max()


def test_harmonic_values_rise_evenly_along_a_cylinder() -> None:
    mesh = sb.Mesh(*meshes.cylinder(24, 15, height=3.0))
    height = mesh.vertices[:, 2]
    ends = np.flatnonzero((height == 0) | (height == 3)).astype(np.int32)
    np.testing.assert_allclose(sb.spread_values(mesh, ends, height[ends], "harmonic"), height, atol=1e-6)


def test_biharmonic_values_are_smooth_where_harmonic_ones_have_cusps() -> None:
    mesh = sb.Mesh(*meshes.icosphere(4))
    poles = mesh.vertices[:, 2].argsort()[[0, -1]].astype(np.int32)
    smooth, cusped = (sb.spread_values(mesh, poles, [0, 1], method) for method in ("biharmonic", "harmonic"))
    height = mesh.vertices[:, 2]
    for spread in (smooth, cusped):
        around = np.abs(height) < 1e-9
        np.testing.assert_allclose(spread[around], 0.5, atol=1e-3)
    near = np.linalg.norm(mesh.vertices - mesh.vertices[poles[1]], axis=1) < 1.5 * mesh.mean_edge_length
    assert 1 - smooth[near].min() < 0.02 < 0.1 < 1 - cusped[near].min()


def test_places_inside_faces_and_places_that_say_the_same() -> None:
    mesh = sb.Mesh(*meshes.icosphere(3))
    places = sb.SurfacePoints([5, 5, 400], [[0.2, 0.3, 0.5], [0.2, 0.3, 0.5], [1, 0, 0]])
    spread = sb.spread_values(mesh, places, [1, 3, 5.0])
    assert spread[mesh.triangles[5]] @ [0.2, 0.3, 0.5] == pytest.approx(2, abs=1e-3)
    assert spread[mesh.triangles[400][0]] == pytest.approx(5, abs=1e-3)
    harmonic = sb.spread_values(mesh, places[:2], [1, 3.0], "harmonic")
    np.testing.assert_allclose(harmonic, 2)


def test_places_at_the_first_vertex_meet_at_their_mean() -> None:
    spread = sb.spread_values(sb.Mesh(*meshes.icosphere(2)), [0, 0], [1, 3.0])
    np.testing.assert_allclose(spread, 2)


def test_a_long_strip_beside_it_does_not_loosen_a_sphere() -> None:
    strip, sphere = meshes.grid(1001, 2), meshes.icosphere(2)
    mesh = sb.Mesh(*meshes.merge((strip[0] * (1000, 1, 1), strip[1]), (sphere[0] + [0, 0, 50], sphere[1])))
    first = len(strip[0])
    places, values = np.array([0, 1000, first, first + 1, first + 100]), np.array([0, 1, 0, 1, 0.5])
    np.testing.assert_allclose(sb.spread_values(mesh, places, values)[places], values, atol=1e-6)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("factor", "shift"), [(1, 1e9), (1e-200, 0), (1e-3, -1e6), (1e300, -5e299)])
def test_a_range_far_from_zero_or_small_is_met_as_any_other(method: str, factor: float, shift: float) -> None:
    mesh, places, values = sb.Mesh(*meshes.icosphere(2)), [0, 20, 40, 60], np.arange(4) - 1.0
    wanted = factor * sb.spread_values(mesh, places, values, method) + shift
    found = sb.spread_values(mesh, places, factor * values + shift, method)
    np.testing.assert_allclose(found, wanted, rtol=1e-15, atol=1e-5 * factor)


@pytest.mark.parametrize("method", METHODS)
def test_values_near_the_largest_number(method: str) -> None:
    values = np.array([1.7e308, -1.7e308, 1.6e308, 1.5e308])
    spread = sb.spread_values(sb.Mesh(*meshes.icosphere(2)), [0, 40, 80, 120], values, method)
    np.testing.assert_allclose(spread[[0, 40, 80, 120]] / 1e308, values / 1e308, atol=1e-5)


@pytest.mark.parametrize("method", METHODS)
def test_components_without_a_place_have_the_mean(method: str) -> None:
    mesh = sb.Mesh(*meshes.two_components())
    spread = sb.spread_values(mesh, [0, 5], [1, 4], method)
    assert np.abs(spread[mesh.components == 1] - 2.5).max() < 1e-7  # systems are solved to 1e-8
    assert sb.spread_values(mesh, [0], [7], method).tolist() == [7.0] * mesh.vertex_count


@pytest.mark.parametrize("method", METHODS)
def test_many_components(method: str) -> None:
    mesh = sb.Mesh(*meshes.soup())
    spread = sb.spread_values(mesh, [0, 3, 4], [1, 5, 7], method)
    np.testing.assert_allclose(spread[[0, 3, 4]], [1, 5, 7], atol=1e-4)
    assert np.abs(spread[mesh.components > 1] - 13 / 3).max() < 1e-6


@pytest.mark.parametrize("method", METHODS)
def test_values_do_not_depend_on_scale_and_place(method: str) -> None:
    vertices, triangles = meshes.torus(40, 16)
    first = sb.spread_values(sb.Mesh(vertices, triangles), [3, 200, 500], [1, 2, 5], method)
    second = sb.spread_values(sb.Mesh(500 * vertices[:, [1, 2, 0]] - 3, triangles), [3, 200, 500], [1, 2, 5], method)
    np.testing.assert_allclose(first, second, atol=1e-5)


@pytest.mark.parametrize("unit", [1e-9, 1e-6, 1e-3, 1e5, 1e6, 1e9])
@pytest.mark.parametrize("method", METHODS)
def test_values_do_not_depend_on_the_unit(method: str, unit: float) -> None:
    """Also of several parts of different sizes, and at places inside faces."""
    for vertices, triangles in (meshes.grid(9, 9), meshes.torus(30, 12), meshes.two_components()):
        mesh = sb.Mesh(vertices, triangles)
        places = sb.sample(mesh, 6, seed=1, one_per_component=True)
        values = np.arange(len(places)) ** 2 + 1.0
        wanted = sb.spread_values(mesh, places, values, method)
        found = sb.spread_values(sb.Mesh(unit * vertices, triangles), places, values, method)
        np.testing.assert_allclose(found, wanted, atol=1e-5 * values.max())


# --- curvature --------------------------------------------------------------------------------------------------------


def test_curvatures_in_closed_form() -> None:
    smallest, largest, _ = sb.principal_curvatures(sb.Mesh(*meshes.icosphere(4, radius=2.0)))
    assert np.abs(2 * np.array([smallest, largest]) - 1).max() < 0.05
    assert np.abs(2 * np.array([smallest, largest]) - 1).mean() < 0.01
    tube = sb.Mesh(*meshes.cylinder(60, 30, radius=0.5))
    inner = np.setdiff1d(np.arange(tube.vertex_count), tube.boundary_vertices)
    smallest, largest, direction = (found[inner] for found in sb.principal_curvatures(tube))
    np.testing.assert_allclose(smallest, 0, atol=0.02)
    np.testing.assert_allclose(largest, 2, rtol=0.01)
    assert np.abs(direction[:, 2]).max() < 1e-6


def test_curvature_of_a_torus_converges() -> None:
    errors = []
    for around, tube in ((60, 24), (120, 48)):
        mesh = sb.Mesh(*meshes.torus(around, tube, 1.0, 0.35))
        smallest, largest, _ = sb.principal_curvatures(mesh)
        ring = np.hypot(mesh.vertices[:, 0], mesh.vertices[:, 1])
        across = (ring - 1) / 0.35 / ring
        errors.append(max(np.abs(largest - 1 / 0.35).max(), np.abs(smallest - across).max()))
    assert errors[1] < errors[0] / 2.5 and errors[1] < 0.05


@pytest.mark.parametrize("columns", [3, 4, 5, 6])
@pytest.mark.parametrize("tilt", [0.0, 1e-17, 0.3])
def test_curvature_of_sheets_folded_onto_themselves_is_finite(columns: int, tilt: float) -> None:
    """Normals about a fold cancel: exactly, or but for rounding."""
    vertices, triangles = meshes.grid(columns, 3)
    vertices[:, 0] = np.abs((vertices[:, 0] * (columns - 1)).round() % 2 - 1)
    vertices[:, 1] *= 2
    vertices[:, 2] += tilt * vertices[:, 0]
    smallest, largest, direction = sb.principal_curvatures(sb.Mesh(vertices, triangles))
    assert np.isfinite([smallest, largest]).all()
    np.testing.assert_allclose(np.linalg.norm(direction, axis=1), 1)


# --- from distances ---------------------------------------------------------------------------------------------------


def test_blended_values() -> None:
    mesh = sb.Mesh(*meshes.icosphere(3))
    graph = sb.SaddleVertexGraph(mesh, k=20)
    distances = graph.fields([0, 100, 300])
    blended = sb.blend_by_distance(distances, [1, 2, 7])
    np.testing.assert_allclose(blended[[0, 100, 300]], [1, 2, 7])
    assert blended.min() == 1 and blended.max() == 7
    cells = sb.blend_by_distance(distances, [1, 2, 7], power=200)
    clear = np.sort(distances, axis=0)
    inside = clear[1] > 1.1 * clear[0]
    np.testing.assert_allclose(cells[inside], np.array([1, 2, 7])[distances.argmin(axis=0)[inside]], atol=1e-6)
    assert sb.blend_by_distance([[np.inf, 0], [np.inf, 1]], [2, 4]).tolist() == [3, 2]


def test_ramps() -> None:
    ramp = sb.ramp_by_distance([0, 0.25, 0.5, 1, 3, np.inf], 8, 1, 1.0)
    assert ramp[[0, 2, 3, 4, 5]].tolist() == [8, 4.5, 1, 1, 1] and 4.5 < ramp[1] < 8


def test_density_by_curvature() -> None:
    assert (sb.density_by_curvature(sb.Mesh(*meshes.grid())) == 1).all()
    vertices, triangles = meshes.icosphere(4)
    bent = vertices * (1, 1, 3)
    density = sb.density_by_curvature(sb.Mesh(bent, triangles), 9.0)
    assert density.max() <= 3 and density.min() >= 1 / 3
    tip, middle = np.abs(vertices[:, 2]) > 0.95, np.abs(vertices[:, 2]) < 0.2
    assert density[tip].min() > 1.5 * density[middle].max()
    np.testing.assert_allclose(sb.density_by_curvature(sb.Mesh(100 * bent, triangles), 9.0), density, rtol=1e-6)


# --- bad input --------------------------------------------------------------------------------------------------------


def test_bad_input_is_told() -> None:
    mesh = sb.Mesh(*meshes.grid(5, 5))
    for message, call in {
        "places: wanted at least one": lambda: sb.spread_values(mesh, [], []),
        "vertex 30 at": lambda: sb.spread_values(mesh, [30], [1]),
        "one for each of the 2 places, got 1": lambda: sb.spread_values(mesh, [1, 2], [1]),
        r"value nan at \[1\] is not finite": lambda: sb.spread_values(mesh, [1, 2], [1, np.nan]),
        'method: wanted "biharmonic" or "harmonic", got 3': lambda: sb.spread_values(mesh, [1], [1], 3),
        "mesh: wanted a Mesh": lambda: sb.principal_curvatures(3),
        "distances: wanted one row": lambda: sb.blend_by_distance([[1, 2]], [1, 2]),
        r"distances: -1.0 at \[0, 1\]": lambda: sb.blend_by_distance([[1, -1]], [1]),
        r"value at \[0\] is not finite": lambda: sb.blend_by_distance([[1, 1]], [np.inf]),
        "power is 0": lambda: sb.blend_by_distance([[1, 1]], [1], 0),
        r"nan at \[1\] is no distance": lambda: sb.ramp_by_distance([1, np.nan], 1, 2, 3),
        "reach is 0": lambda: sb.ramp_by_distance([1], 1, 2, 0),
        "at and beyond must be finite": lambda: sb.ramp_by_distance([1], 1, np.inf, 1),
        "range_ is 0.5": lambda: sb.density_by_curvature(mesh, 0.5),
        "contrast is nan": lambda: sb.density_by_curvature(mesh, contrast=np.nan),
    }.items():
        with pytest.raises(sb.InputError, match=message):
            call()


def test_progress_and_cancel() -> None:
    mesh = sb.Mesh(*meshes.torus(500, 200))
    places = np.arange(0, 90000, 9000)
    check_progress_and_cancel(lambda job: sb.spread_values(mesh, places, np.arange(10.0), job=job), 0.3)

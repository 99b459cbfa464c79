# SPDX-License-Identifier: GPL-3.0-or-later
"""The ribs between cells and the solid made of them."""

from dataclasses import replace

import meshes_of_core as shapes
import numpy as np
import pytest

import saddleback as sb
from saddleback_blender.core import runs
from saddleback_blender.core.errors import BadInputError
from saddleback_blender.core.figures import shell_faults_of, shell_of
from saddleback_blender.core.requests import Surface, TessellateRequest
from saddleback_blender.core.results import LampShell
from saddleback_blender.core.settings import TessellateSettings
from saddleback_blender.core.solids.rib_surface import RibShape, rib_surface
from saddleback_blender.core.solids.shell_solid import thicken
from tests import meshes, synthetic_cells
from tests.synthetic_cells import triangle_areas

NONE = np.empty((0, 2), np.int32)


def square_cells(n=8):
    """The unit square, with sites that make the line x = 1/2 the only one between cells."""
    surface = shapes.grid(n)
    mesh = sb.Mesh(surface.vertices, surface.triangles)
    graph = sb.SaddleVertexGraph(mesh, k=min(40, len(surface.vertices)))
    sites = sb.project(mesh, np.array([[0.25, 0.5, 0.0], [0.75, 0.5, 0.0]]))
    return mesh, sb.geodesic_voronoi(graph, sites)


def ribs_of(mesh, cells, width):
    return rib_surface("Shape", mesh, cells, RibShape(width), runs.new_progress())


def areas(ribs):
    whole = triangle_areas(ribs.vertices, ribs.triangles)
    return whole[ribs.is_rib].sum(), whole.sum()


@pytest.mark.parametrize("n", [2, 8, 40])
@pytest.mark.parametrize("width", [0.02, 0.1])
def test_ribs_are_as_wide_as_asked_however_coarse_the_mesh_is(n, width):
    rib, whole = areas(ribs_of(*square_cells(n), width))
    # The border's rib is half as wide, since the rest would lie outside. Straight cuts across a corner take a little.
    frame = 1 - (1 - width) ** 2
    assert whole == pytest.approx(1, rel=1e-12)
    assert rib == pytest.approx(frame + width * (1 - width), abs=8 * width**2 / 4)


def test_edges_near_ribs_are_no_longer_than_half_a_rib_and_far_ones_stay():
    mesh, cells = square_cells(4)
    ribs = ribs_of(mesh, cells, 0.04)
    sides = ribs.vertices[ribs.triangles] - np.roll(ribs.vertices[ribs.triangles], -1, axis=1)
    longest = np.linalg.norm(sides, axis=2).max(axis=1)
    assert longest[ribs.is_rib].max() <= 0.02 + 1e-12
    assert longest.max() > 0.05


def test_the_solid_is_closed_oriented_and_has_the_volume_of_the_ribs():
    mesh, cells = square_cells()
    ribs = ribs_of(mesh, cells, 0.1)
    shell = thicken(ribs, 0.05, lambda *_: NONE, runs.new_progress())
    edges = np.stack([shell.triangles, np.roll(shell.triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    ways, uses = np.unique(edges, axis=0, return_counts=True)
    assert (uses == 1).all() and np.array_equal(ways, np.unique(edges[:, ::-1], axis=0))
    a, b, c = (shell.vertices[shell.triangles[:, i]] for i in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    assert volume == pytest.approx(0.05 * areas(ribs)[0], rel=1e-9)
    assert (shell.pieces, shell.thinner, shell.crossing) == (1, 0.0, 0)


def test_a_place_that_crosses_becomes_thinner_and_no_other():
    mesh, cells = square_cells()
    ribs = ribs_of(mesh, cells, 0.1)
    asked = []

    def crossings(vertices, *_):
        asked.append(vertices)
        return NONE if len(asked) == 3 else np.array([[0, 1]], np.int32)

    shell = thicken(ribs, 0.05, crossings, runs.new_progress())
    height = np.unique(np.round(np.abs(shell.vertices[:, 2]), 9))
    assert 0 < shell.thinner < 0.05 and shell.crossing == 0
    np.testing.assert_allclose(height, [0.025 * 0.36, 0.025], atol=1e-9)


def test_what_crosses_is_always_among_what_has_moved():
    """So that looking at that alone changes nothing."""
    vertices, triangles = synthetic_cells.sphere(4)
    mesh = sb.Mesh(vertices, triangles)
    graph = sb.SaddleVertexGraph(mesh, k=30)
    ribs = ribs_of(mesh, sb.centroidal_voronoi(graph, count=30).cells, 0.1)

    def too_high(vertices, triangles, among, _):
        """Triangles that reach beyond a slope: fewer each time, and some only after the vertices have moved."""
        high = np.linalg.norm(vertices, axis=1) > 1.02 + 0.02 * vertices[:, 0]
        counts.append(len(among))
        found = np.flatnonzero(high[triangles].any(axis=1))
        assert np.isin(found, among).all()
        return found.astype(np.int32)

    counts: list[int] = []
    shell = thicken(ribs, 0.1, too_high, runs.new_progress())
    assert min(counts) < 0.9 * counts[0] == 0.9 * len(shell.triangles) and not shell.crossing


def test_what_cannot_be_mended_is_told():
    mesh, cells = square_cells()
    always = np.array([[0, 1]], np.int32)
    shell = thicken(ribs_of(mesh, cells, 0.1), 0.05, lambda *_: always, runs.new_progress())
    assert shell.crossing == 2 and np.isfinite(shell.vertices).all()
    (told,) = shell_faults_of(shell)
    assert "2 faces of the lamp shell pass through others" in told
    assert "Remesh modifier" in told and "repair" not in told  # which would change nothing


def test_pieces_are_counted():
    vertices, triangles = synthetic_cells.sphere(3)
    both = Surface(
        "Two", np.concatenate([vertices, vertices + 5]), np.concatenate([triangles, triangles + len(vertices)]),
        2 * len(vertices),
    )  # fmt: skip
    settings = TessellateSettings(count=20, iterations=2, k=30, make_shell=True, rib_width=0.2, rib_thickness=0.1)
    request = TessellateRequest(both, settings)
    shell = runs.tessellate(request, runs.new_progress()).shell
    assert shell.pieces == 2 and "2 pieces" in shell_faults_of(shell)[0]


def test_cells_around_a_leg_get_others_beside_them_so_that_no_ring_is_loose():
    vertices, triangles = synthetic_cells.sphere(4)
    leg = Surface("Leg", vertices * (0.1, 0.1, 3.0), triangles, len(vertices))
    settings = TessellateSettings(count=12, iterations=10, k=30, make_shell=True)
    shell = runs.tessellate(TessellateRequest(leg, settings), runs.new_progress()).shell
    assert shell.pieces == 1 and shell.added > 0 and not shell_faults_of(shell)
    assert f"{shell.added} cells added so that it hangs together" in shell_of(shell, str, str)
    sites = np.linspace(0, len(vertices) - 1, 12).astype(np.int32)
    kept = runs.tessellate(replace(TessellateRequest(leg, settings), sites=sites), runs.new_progress()).shell
    assert kept.added == 0  # what was placed by hand stays


def test_walls_without_any_thickness_are_no_length_of_zero():
    none = np.zeros((3, 3))
    shell = LampShell(none, np.zeros((0, 3), np.int32), 1, 0.1, np.ones(3, bool), 0, none, np.array([1e-6, 0.1, 0.1]))
    assert "(next to nothing at the least" in shell_of(shell, "{:.3f} m".format, str)


def test_ribs_are_as_wide_as_the_cells_let_them_be():
    """At any size of the model: no width is given."""
    square = shapes.grid(8)
    settings = TessellateSettings(count=20, iterations=2, k=30, make_shell=True)
    shells = []
    for scale in (1.0, 64.0):
        scaled = Surface("Square", scale * square.vertices, square.triangles, len(square.vertices))
        request = TessellateRequest(scaled, settings)
        shells.append(runs.tessellate(request, runs.new_progress()).shell)
    small, large = shells
    assert np.array_equal(small.triangles, large.triangles)
    np.testing.assert_allclose(large.vertices, 64 * small.vertices, rtol=1e-12)
    assert np.ptp(small.vertices[:, 2]) == pytest.approx(np.sqrt(1 / 20) / 8, rel=1e-9)


def test_without_lines_or_with_ribs_like_hairs_there_is_a_sentence():
    vertices, triangles = synthetic_cells.sphere(2)
    mesh = sb.Mesh(vertices, triangles)
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=30), np.array([0], np.int32))
    with pytest.raises(BadInputError, match="'Shape': there are no lines between cells"):
        ribs_of(mesh, cells, 0.1)
    with pytest.raises(BadInputError, match="'Shape': ribs of width 1e-06 are too narrow"):
        ribs_of(*square_cells(), 1e-6)


def test_a_sound_shell_has_nothing_to_tell():
    none = np.empty((0, 3))
    sound = LampShell(none, none.astype(np.int32), 1, 0.1, np.zeros(0, bool), 0, none, np.empty(0))
    assert shell_faults_of(sound) == []


@pytest.mark.parametrize("profile", ["SQUARE", "ROUND"])
def test_ribs_of_a_cylinder_have_room_everywhere(profile):
    vertices, triangles = meshes.cylinder(48, 10, radius=0.05, height=0.14)
    settings = TessellateSettings(
        count=60, iterations=10, make_shell=True, rib_width=0.005, rib_thickness=0.004, rib_profile=profile,
        base_height=0.02,
    )  # fmt: skip
    request = TessellateRequest(Surface("Shade", vertices, triangles, len(vertices)), settings)
    shell = runs.tessellate(request, runs.new_progress()).shell
    assert (shell.pieces, shell.thinner, shell.crossing) == (1, 0.0, 0)
    np.testing.assert_allclose(shell.wall, 0.004, rtol=1e-3)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields of directions as the add-on asks for them: strokes, singularities, what is drawn of them."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

import saddleback as sb
from saddleback_blender.core import field_runs, runs
from saddleback_blender.core.cache import Cache
from saddleback_blender.core.errors import BadInputError
from saddleback_blender.core.fields.arrow_mesh import arrow_mesh
from saddleback_blender.core.fields.singular_names import index_of_name
from saddleback_blender.core.requests import DirectionFieldRequest, SingularPlace, StrokeLine, Surface
from saddleback_blender.core.settings import DirectionFieldSettings
from saddleback_blender.core.surfaces.point_grid import PointGrid, even_points
from saddleback_blender.core.surfaces.surface_walk import joined
from tests import meshes

BALL = meshes.icosphere(4)
POLES = (np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, -1.0]))


def surface_of(vertices, triangles):
    return Surface("Thing", np.asarray(vertices, np.float64), np.asarray(triangles, np.int32), len(vertices))


def run(settings=None, arrays=BALL, cache=None, **options):
    request = DirectionFieldRequest(surface_of(*arrays), settings or DirectionFieldSettings(), **options)
    return field_runs.direction_field(request, runs.new_progress(), cache or Cache(2**28))


def equator(count=40, share=0.3, lift=0.01):
    turn = np.linspace(0.0, share * 2 * np.pi, count)
    return (1 + lift) * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)


def stroke(points, hard=False):
    return StrokeLine(points, False, hard, "a stroke of 'Ink'")


def singular(*places, index=None):
    return tuple(SingularPlace(place, index, f"E{number}") for number, place in enumerate(places))


def angles_to_the_equator(directions, places, symmetry=1):
    east = np.stack([-places[:, 1], places[:, 0], 0 * places[:, 0]], axis=1)
    north = np.cross(places, east)
    angle = np.arctan2((directions * north).sum(1), (directions * east).sum(1))
    return np.abs(np.angle(np.exp(1j * symmetry * angle))) / symmetry


@pytest.mark.parametrize("hard", [False, True])
def test_a_field_follows_a_stroke_about_given_poles(hard):
    result = run(strokes=(stroke(equator(), hard),), singularities=singular(*POLES))
    assert sorted(result.singular_indices) == [1, 1] and result.stroke_count == 1
    np.testing.assert_allclose(np.sort(result.singular_points[:, 2]), [-1, 1], atol=1e-9)
    np.testing.assert_allclose(result.singular_normals, result.singular_points, atol=0.02)
    near = np.abs(BALL[0][:, 2]) < 0.5
    assert np.degrees(angles_to_the_equator(result.directions[near], BALL[0][near]).max()) < 3
    turned = run(DirectionFieldSettings(turn=np.pi / 2), strokes=(stroke(equator()),), singularities=singular(*POLES))
    assert np.degrees(np.abs(angles_to_the_equator(turned.directions[near], BALL[0][near]) - np.pi / 2).max()) < 3


def test_directions_lie_on_the_surface_on_vertices_and_faces():
    vertices, triangles = BALL
    on_vertices = run().directions
    on_faces = run(DirectionFieldSettings(domain="FACE"), polygons=np.arange(len(triangles), dtype=np.int32) // 2)
    assert on_vertices.shape == vertices.shape and len(on_faces.directions) == len(triangles) // 2
    for found in (on_vertices, on_faces.directions):
        np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1, atol=1e-9)
    assert np.abs((on_vertices * vertices).sum(axis=1)).max() < 0.1


def test_a_stroke_beside_the_surface_is_left_out_and_none_near_it_is_refused():
    far = stroke(3 * equator())
    result = run(strokes=(stroke(equator()), far), singularities=singular(*POLES))
    same = run(strokes=(stroke(equator()),), singularities=singular(*POLES))
    np.testing.assert_array_equal(result.directions, same.directions)
    with pytest.raises(BadInputError, match=r"'Thing': no stroke comes within .* of the surface"):
        run(strokes=(far,))
    run(DirectionFieldSettings(stroke_reach=3.0), strokes=(far,))


def test_what_is_wrong_with_singularities_is_told_in_the_artists_words():
    with pytest.raises(
        BadInputError, match=r"'Thing': the indices of part 1 .* sum to 1 but must sum to 2: 1 is missi"
    ):
        run(singularities=singular(POLES[0]))
    with pytest.raises(BadInputError, match="'E0' and 'E1' are at the same vertex"):
        run(singularities=singular(POLES[0], POLES[0]))
    with pytest.raises(BadInputError, match="'E0' has the index 1/2, but vectors have whole indices"):
        run(singularities=singular(*POLES, index=Fraction(1, 2)))
    with pytest.raises(BadInputError, match="'E0' lies at the border"):
        run(arrays=meshes.grid(6, 6), singularities=singular(np.zeros(3)))
    with pytest.raises(BadInputError, match="choose Lines or Crosses"):
        run(DirectionFieldSettings(align="CURVATURE"))
    crossing = [stroke(equator(), True), stroke(equator(41, 0.4) @ [[0, 0, 1], [0.3, 0.95, 0], [1, 0, 0]], True)]
    with pytest.raises(
        BadInputError, match=r"hard strokes \(a stroke of 'Ink'\) and \(a stroke of 'Ink'\) cross, where"
    ):
        run(strokes=tuple(crossing))


def test_an_empty_without_a_number_has_one_unit_of_the_symmetry():
    four = [np.array(place) for place in ((1.0, 0, 0), (-1.0, 0, 0), (0, 1.0, 0), (0, -1.0, 0))]
    result = run(DirectionFieldSettings(symmetry="2"), singularities=singular(*four))
    np.testing.assert_array_equal(result.singular_indices, [0.5] * 4)


@pytest.mark.parametrize(
    ("name", "index"),
    [("Empty", None), ("Empty.001", None), ("index 1", 1), ("-1/2.003", Fraction(-1, 2)),
     ("Whirl +0.25", Fraction(1, 4)), ("a 1 / 4 b", Fraction(1, 4)), ("half 1/0", None), ("\u22121", -1)],
)  # fmt: skip
def test_indices_in_names(name, index):
    assert index_of_name(name) == index


def test_only_what_changed_is_computed():
    cache = Cache(2**28)
    first = run(cache=cache)
    run(DirectionFieldSettings(make_arrows=False), cache=cache)
    assert cache.builds["field"] == 1
    other = run(strokes=(stroke(equator()),), cache=cache)
    assert cache.builds["field"] == 2 and cache.builds["field editor"] == 1 and cache.builds["mesh"] == 1
    assert not np.array_equal(first.directions, other.directions)


def test_loose_vertices_have_no_direction():
    vertices, triangles = meshes.grid(6, 6)
    padded = np.concatenate([[[9.0, 9.0, 9.0]], vertices])
    used = np.arange(1, len(padded), dtype=np.int32)
    surface = replace(surface_of(vertices, triangles), vertex_count=len(padded), used=used)
    request = DirectionFieldRequest(surface, DirectionFieldSettings(make_arrows=False))
    directions = field_runs.direction_field(request, runs.new_progress(), Cache(2**28)).directions
    assert not directions[0].any()
    np.testing.assert_allclose(np.linalg.norm(directions[1:], axis=1), 1)


@pytest.mark.parametrize("symmetry", ["1", "2", "4"])
def test_arrows_lie_along_the_field_and_balls_at_singularities(symmetry):
    result = run(DirectionFieldSettings(symmetry=symmetry, arrow_count=300, arrow_length=0.05))
    arrows = result.arrows
    assert 240 < len(arrows.points) < 400
    gaps = np.linalg.norm(arrows.points[:, None] - arrows.points[None], axis=2) + 9 * np.eye(len(arrows.points))
    assert gaps.min() > 0.7 * np.sqrt(4 * np.pi / 300)
    made = arrow_mesh(result)
    sides = {"1": 7, "2": 6, "4": 8}[symmetry]
    assert (np.diff(made.offsets)[: len(arrows.points)] == sides).all() and made.offsets[-1] == len(made.corners)
    outlines = made.vertices[: len(arrows.points) * sides].reshape(-1, sides, 3)
    along = np.einsum("ijk,ik->ij", outlines - arrows.points[:, None], arrows.directions)
    np.testing.assert_allclose(along.max(axis=1), 0.025, rtol=0.02)  # seen a little askew
    normals = np.cross(outlines[:, 1] - outlines[:, 0], outlines[:, 2] - outlines[:, 0])
    assert ((normals * arrows.normals).sum(axis=1) != 0).all()
    assert set(made.materials) == ({0, 1} if (result.singular_indices > 0).all() else {0, 1, 2})


def test_streamlines_keep_their_distance():
    settings = DirectionFieldSettings(make_streamlines=True, streamline_spacing=0.1, make_arrows=False)
    lines = run(settings, strokes=(stroke(equator()),), singularities=singular(*POLES)).streamlines
    assert len(lines.lengths) > 20 and not lines.closed.any()
    np.testing.assert_allclose(np.linalg.norm(lines.points, axis=1), 1, atol=0.01)
    middles = np.array([lines.points[(a + b) // 2] for a, b in zip(lines.offsets[:-1], lines.offsets[1:], strict=True)])
    for number, (a, b) in enumerate(zip(lines.offsets[:-1], lines.offsets[1:], strict=True)):
        away = np.linalg.norm(lines.points[a:b, None] - np.delete(middles, number, axis=0)[None], axis=2)
        assert away.min() > 0.045


def test_points_in_order_become_curves_that_can_be_walked():
    mesh = sb.Mesh(*BALL)
    places = np.concatenate([equator(9), -equator(9)])  # far apart: with a leap between the halves
    points = sb.project(mesh, places)
    starts = np.arange(18) == 0
    (pieces,) = joined(mesh, points.faces, points.barycentric, starts, 0.5)
    lengths = [sb.SurfaceCurve(mesh, piece).length for piece in pieces]
    np.testing.assert_allclose(lengths, [0.6 * np.pi] * 2, rtol=0.005)
    flat = sb.Mesh(*meshes.two_components())
    ends = sb.SurfacePoints(np.array([0, len(flat.triangles) - 1], np.int32), np.full((2, 3), 1 / 3))
    assert joined(flat, ends.faces, ends.barycentric, np.array([True, False]), 0.5) == [[]]


def test_even_points_keep_their_distance():
    mesh = sb.Mesh(*BALL)
    places = even_points(mesh, 200, 3).positions(mesh)
    grid = PointGrid(0.5)
    grid.add(places[:1])
    np.testing.assert_array_equal(grid.is_free(places), np.linalg.norm(places - places[0], axis=1) >= 0.5)

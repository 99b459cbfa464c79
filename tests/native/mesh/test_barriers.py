# SPDX-License-Identifier: MIT
"""Barriers: what they part, where their sides meet, what goes back and forth, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_it_stops_when_silent
from tests.truth.mazes import curve_through

MESH = sb.Mesh(*meshes.grid(9, 9))  # the unit square, cells of an eighth
ROW = 4 * 9 + np.arange(9)  # the vertices at y = 0.5


def line(*places: tuple[float, float]) -> sb.SurfaceCurve:
    return curve_through(MESH, np.array(places))


def distance_from(barred: sb.BarredMesh, source: int) -> NDArray[np.float64]:
    return barred.least(sb.exact_distances(barred.mesh, barred.to_barred([source])[0]))


def test_without_barriers_the_mesh_is_as_it_was() -> None:
    barred = sb.add_barriers(MESH)
    assert barred.mesh == MESH
    assert barred.whole is MESH
    assert np.array_equal(barred.vertex_origin, np.arange(MESH.vertex_count))
    assert np.array_equal(barred.face_origin, np.arange(MESH.face_count))


def test_a_slit_has_two_sides_that_meet_at_its_ends() -> None:
    barred = sb.add_barriers(MESH, edges=np.column_stack([ROW[2:6], ROW[3:7]]))
    assert barred.mesh.vertex_count == MESH.vertex_count + 3
    assert np.array_equal(barred.vertex_origin[-3:], ROW[3:6])
    assert barred.mesh.component_count == 1
    assert [len(loop) for loop in barred.mesh.boundary_loops] == [32, 8]
    below, above = 4, 8 * 9 + 4  # the middles of two sides of the square: around an end of the slit is a quarter away
    assert distance_from(barred, below)[above] == pytest.approx(2 * math.hypot(0.25, 0.5), abs=1e-12)


def test_a_single_edge_is_a_barrier() -> None:
    edge = ROW[4:6]
    barred = sb.add_barriers(MESH, edges=[edge])
    assert barred.mesh.vertex_count == MESH.vertex_count + 2  # its middle, once for each side
    assert barred.vertex_origin.tolist()[-2:] == [-1, -1]
    middle = barred.vertex_points.positions(MESH)[-2:]
    assert np.array_equal(middle, MESH.vertices[edge].mean(axis=0)[None].repeat(2, axis=0))
    assert [len(loop) for loop in barred.mesh.boundary_loops] == [32, 4]


def test_curves_may_be_made_on_the_way() -> None:
    """Those of a generator, which nobody else keeps."""
    ends = [((0.1, y), (0.9, y)) for y in (0.2, 0.4, 0.6, 0.8)]
    barred = sb.add_barriers(MESH, curves=(line(*pair) for pair in ends))
    assert barred == sb.add_barriers(MESH, curves=[line(*pair) for pair in ends])
    with pytest.raises(sb.InputError, match=r"curves: wanted SurfaceCurves, got a .*\.SurfaceCurve"):
        sb.add_barriers(MESH, curves=line(*ends[0]))


def test_what_is_enclosed_is_not_reached() -> None:
    barred = sb.add_barriers(MESH, edges=np.column_stack([ROW[:-1], ROW[1:]]))
    assert barred.mesh.component_count == 2
    assert repr(barred) == "<saddleback.BarredMesh: 90 vertices, 128 faces, 2 parts>"
    found = distance_from(barred, 0)
    beyond = MESH.vertices[:, 1] > 0.5
    assert np.isinf(found[beyond]).all()
    straight = np.linalg.norm(MESH.vertices, axis=1)
    assert np.abs(found - straight)[~beyond].max() < 1e-14  # the barrier's vertices are on this side, too


def test_a_curve_that_ends_on_another_leaves_no_slit() -> None:
    across = line((0.03, 0.41), (0.97, 0.43))
    places = across.points.positions(MESH)[:, :2]
    stem = places[7]
    up, down = line(tuple(stem), (stem[0], 0.99)), line(tuple(stem), (stem[0] + 0.1, 0.01))
    for curves in ([across, up, down], [up, down, across]):
        barred = sb.add_barriers(MESH, curves=curves)
        copies = np.isclose(barred.mesh.vertices[:, :2], stem, atol=1e-8).all(axis=1)
        assert copies.sum() == 4


def test_closed_curve_on_a_sphere_parts_it_in_two() -> None:
    mesh = sb.Mesh(*meshes.icosphere(3))
    graph = sb.SaddleVertexGraph(mesh, exact=True)
    corners = [int((mesh.vertices @ direction).argmax()) for direction in np.eye(3)]
    ways = [graph.path(corners[i], corners[(i + 1) % 3], shorten=True).surface for i in range(3)]
    faces = np.concatenate([way.faces[:-1] for way in ways])
    weights = np.concatenate([way.barycentric[:-1] for way in ways])
    barred = sb.add_barriers(mesh, curves=[sb.SurfaceCurve(mesh, sb.SurfacePoints(faces, weights), closed=True)])
    assert barred.mesh.component_count == 2
    assert barred.mesh.area == pytest.approx(mesh.area, rel=1e-12)
    sites, index = barred.to_barred(sb.sample(mesh, 12, seed=3))
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(barred.mesh), sites)
    part = barred.mesh.components[barred.mesh.triangles[sites.faces, 0]]
    assert (part[cells.vertex_cell] == barred.mesh.components).all()  # no cell crosses
    labels = index[cells.vertex_cell[barred.least_copies(cells.vertex_distance)]]
    assert set(labels.tolist()) == set(range(12))


def test_points_as_float32_give_close_a_curve() -> None:
    """A curve whose points are off the edges by the rounding of float32 is a barrier without gaps."""
    curve = line((0.03, 0.41), (0.97, 0.43))
    rounded = curve.points.barycentric.astype(np.float32).astype(np.float64)
    rounded = np.maximum(rounded, 3e-7)
    rough = sb.SurfaceCurve(MESH, sb.SurfacePoints(curve.points.faces, rounded / rounded.sum(axis=1, keepdims=True)))
    for barred in (sb.add_barriers(MESH, curves=[one]) for one in (curve, rough)):
        ends = [barred.mesh.vertices[loop] for loop in barred.mesh.boundary_loops[1:]]
        assert len(ends) == 1
        assert np.ptp(ends[0][:, 0]) == pytest.approx(0.94, abs=1e-5)


def test_faces_that_are_left_out() -> None:
    inner = np.flatnonzero((np.abs(MESH.vertices[MESH.triangles].mean(axis=1)[:, :2] - 0.5) < 0.25).all(axis=1))
    flags = np.isin(np.arange(MESH.face_count), inner)
    barred = sb.add_barriers(MESH, faces=inner)
    assert barred == sb.add_barriers(MESH, faces=flags)
    assert np.array_equal(barred.face_origin, np.flatnonzero(~flags))
    found = distance_from(barred, 0)
    assert np.isinf(found[ROW[4]])  # in the middle of nothing
    assert found[80] == pytest.approx(2 * math.hypot(0.25, 0.75), abs=1e-12)
    assert barred.least_copies(np.zeros(barred.mesh.vertex_count))[ROW[4]] == -1


def test_points_on_a_barrier_are_there_on_both_sides() -> None:
    barred = sb.add_barriers(MESH, edges=np.column_stack([ROW[2:6], ROW[3:7]]))
    places = [[0.45, 0.5, 0], [0.45, 0.51, 0], [0.1, 0.5, 0], [0.25, 0.5, 0], [0.375, 0.5, 0]]
    given = sb.project(MESH, places)
    points, index = barred.to_barred(given)
    assert index.tolist() == [0, 0, 1, 2, 3, 4, 4]
    assert np.abs(barred.to_whole(points).positions(MESH) - np.array(places)[index]).max() < 1e-15


def test_a_graph_of_the_barred_mesh_is_a_graph() -> None:
    mesh = sb.Mesh(*meshes.icosphere(3))
    barred = sb.add_barriers(mesh, edges=mesh.edges[::7])
    graph = sb.SaddleVertexGraph(barred.mesh, accuracy=1e-3)
    exact = sb.exact_distances(barred.mesh, [0])
    assert (graph.distances([0]) <= exact * (1 + 1e-3) + 1e-12).all()


@pytest.mark.parametrize(
    ("barriers", "sentence"),
    [
        ({"edges": [(0, 1), (0, 80)]}, "edges: no edge of the mesh joins vertices 0 and 80 of edge 1"),
        ({"edges": [(0, 81)]}, "edges: wanted vertices from 0 to 80, got 81 in edge 0"),
        ({"faces": np.ones(128, bool)}, "faces: all 128 faces are left out; keep some"),
        ({"faces": np.ones(3, bool)}, "faces: wanted one for each of 128 faces, got 3"),
        ({"faces": [0, 128]}, r"faces: face 128 at \[1\] is out of range, the mesh has 128 faces"),
        ({"curves": [sb.SurfaceCurve(sb.Mesh(*meshes.grid(3, 3)), [0, 1])]}, "curves: curve 0 lies on another mesh"),
        ({"curves": [3]}, "curves: wanted SurfaceCurves, got a int"),
    ],
)
def test_bad_barriers_are_refused(barriers: dict[str, object], sentence: str) -> None:
    with pytest.raises(sb.InputError, match=f"^{sentence}"):
        sb.add_barriers(MESH, **barriers)  # type: ignore[arg-type]


def test_a_curve_that_crosses_itself_is_refused_with_the_place() -> None:
    loop = line((0.2, 0.3), (0.8, 0.7), (0.8, 0.3), (0.2, 0.7))
    with pytest.raises(sb.InputError, match=r"^curves: curve 1 crosses or touches itself at \(0\.5, 0\.5") as refused:
        sb.add_barriers(MESH, curves=[line((0.1, 0.1), (0.3, 0.1)), loop])
    assert str(refused.value).endswith("give it as two curves")
    assert sb.add_barriers(MESH, curves=[line((0.2, 0.3), (0.8, 0.7)), line((0.8, 0.3), (0.2, 0.7))]).mesh.area == 1


def test_a_point_that_is_left_out_is_refused() -> None:
    barred = sb.add_barriers(MESH, faces=[5])
    points = sb.SurfacePoints([4, 5], [[0.2, 0.3, 0.5], [0.2, 0.3, 0.5]])
    with pytest.raises(sb.InputError, match=r"^points: point 1 lies in face 5, which is left out"):
        barred.to_barred(points)
    with pytest.raises(sb.InputError, match=r"^values: wanted one for each of"):
        barred.least([1.0])


def test_a_curve_that_winds_through_few_faces_is_stopped_at_once() -> None:
    mesh = sb.Mesh(*meshes.tetrahedron())
    curve = sb.SurfaceCurve(mesh, sb.trace(mesh, 0, 0.3, 20_000.0).surface)
    check_it_stops_when_silent(lambda job: sb.add_barriers(mesh, curves=[curve], job=job), 0.0)


def test_a_cancelled_call_changes_nothing() -> None:
    job = sb.Job()
    job.cancel()
    with pytest.raises(sb.Cancelled):
        sb.add_barriers(MESH, edges=[(0, 1)], job=job)

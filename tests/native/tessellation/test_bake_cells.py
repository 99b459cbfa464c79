# SPDX-License-Identifier: MIT
"""Images of cells: closed forms of the plane, unfolding by hand elsewhere, margins, tiles, bad input."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_progress_and_cancel
from tests.truth.baked import Unfolded, atlas, surface_points, weights_at

Floats = NDArray[np.float64]


@dataclass
class Baked:
    """Texels that triangles hold."""

    image: sb.BakedCells
    rows: NDArray[np.int64]
    columns: NDArray[np.int64]
    points: sb.SurfacePoints

    def of(self, name: str) -> Any:
        return np.asarray(getattr(self.image, name))[self.rows, self.columns]


def cells_on(mesh: sb.Mesh, count: int = 12, seed: int = 1, **options: Any) -> sb.GeodesicVoronoi:
    graph = sb.SaddleVertexGraph(mesh, accuracy=5e-3, threads=1)
    return sb.geodesic_voronoi(graph, sb.sample(mesh, count, seed=seed), threads=1, **options)


def bake(cells: sb.GeodesicVoronoi, uv: Floats, size: tuple[int, int], **options: Any) -> Baked:
    image = sb.bake_cells(cells, uv, size=size, threads=1, **options)
    rows, columns = np.nonzero(image.triangle >= 0)
    places = (np.column_stack([columns, rows]) + 0.5) / size
    faces = image.triangle[rows, columns]
    return Baked(image, rows, columns, surface_points(faces, weights_at(uv, faces, places)))


def plane() -> tuple[sb.Mesh, Floats]:
    """The unit square, and its own places as a UV map."""
    mesh = sb.Mesh(*meshes.grid(9, 9, jitter=0.3))
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    return mesh, ((mesh.vertices - low) / (high - low).max())[mesh.triangles].reshape(-1, 3)[:, :2]


def test_in_the_plane_all_is_as_the_diagram_of_the_plane_says() -> None:
    mesh, uv = plane()
    cells = cells_on(mesh)
    sites = cells.sites.positions(mesh)[:, :2]
    baked = bake(cells, uv, (200, 200), axes=np.tile([0.0, 1.0, 0.0], (len(sites), 1)))
    assert len(baked.rows) == 200 * 200
    places = baked.points.positions(mesh)[:, :2]
    to_sites = np.linalg.norm(places[:, None] - sites, axis=2)
    own = baked.of("cell")
    each = np.arange(len(own))
    np.testing.assert_allclose(to_sites[each, own], to_sites.min(axis=1), atol=1e-12)
    # From a point of a cell, the bisector with another site is that far.
    between = np.linalg.norm(sites[own][:, None] - sites, axis=2)
    between[each, own] = 1.0
    room = (to_sites**2 - to_sites[each, own][:, None] ** 2) / (2 * between)
    room[each, own] = np.inf
    # The nearest bisector is met within the square, but for texels beside its border.
    nearest = room.argmin(axis=1)
    foot = places + room[each, nearest][:, None] * (sites[nearest] - sites[own]) / between[each, nearest][:, None]
    inside = ((foot >= mesh.vertices.min(axis=0)[:2]) & (foot <= mesh.vertices.max(axis=0)[:2])).all(axis=1)
    assert inside.mean() > 0.9
    np.testing.assert_allclose(baked.of("edge_distance")[inside], room.min(axis=1)[inside], atol=1e-6)
    assert (baked.of("edge_distance") > room.min(axis=1) - 1e-6).all()
    offset = places - sites[own]
    np.testing.assert_allclose(baked.of("local_uv"), np.column_stack([offset[:, 1], -offset[:, 0]]), atol=1e-6)


@pytest.mark.parametrize("exact", [False, True])
@pytest.mark.parametrize(
    "arrays",
    [
        pytest.param(meshes.torus(18, 9), id="torus"),
        pytest.param(meshes.saddle(9), id="saddle"),
        pytest.param(meshes.cube(), id="cube"),
        pytest.param(meshes.spikes(7), id="spikes"),
    ],
)
def test_texels_are_what_unfolding_the_faces_about_them_says(arrays: meshes.Arrays, exact: bool) -> None:
    mesh = sb.Mesh(*arrays)
    cells = cells_on(mesh, 7, exact=exact)
    rng = np.random.default_rng(3)
    baked = bake(cells, atlas(mesh.face_count, rng), (256, 256))
    some = rng.choice(len(baked.rows), 80, replace=False)
    faces, weights = baked.points.faces[some], baked.points.barycentric[some]
    truth = Unfolded(mesh, cells)
    wanted = [truth.distance(int(f), w) for f, w in zip(faces, weights, strict=True)]
    np.testing.assert_allclose(baked.of("edge_distance")[some], wanted, atol=1e-6 * np.sqrt(mesh.area))
    own = baked.of("cell")[some]
    sure = baked.of("edge_distance")[some] > 1e-3
    assert (own == cells.cells_at(sb.SurfacePoints(faces, weights)))[sure].all()
    length = np.linalg.norm(baked.of("local_uv")[some], axis=1)
    for cell in np.unique(own):
        site = sb.SurfacePoints(cells.sites.faces[[cell]], cells.sites.barycentric[[cell]])
        here = own == cell
        exact_lengths = sb.ExactField(mesh, site).distance_to(sb.SurfacePoints(faces[here], weights[here]))
        np.testing.assert_allclose(length[here], exact_lengths, atol=1e-6 * np.sqrt(mesh.area))


def test_local_places_lead_from_vertices_back_to_the_texels() -> None:
    mesh = sb.Mesh(*meshes.icosphere(2))  # no vertex bends a way
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, threads=1), np.array([0, 5, 40, 100]), threads=1)
    baked = bake(cells, atlas(mesh.face_count, np.random.default_rng(1)), (128, 128))
    places, uv, own = baked.points.positions(mesh), baked.of("local_uv").astype(float), baked.of("cell")
    for cell in range(4):
        here = np.flatnonzero(own == cell)
        ends = sb.exp_map(mesh, sb.SurfacePoints(cells.sites.faces[[cell]], cells.sites.barycentric[[cell]]), uv[here])
        off = np.linalg.norm(ends.positions(mesh) - places[here], axis=1)
        assert np.quantile(off, 0.99) < 1e-5  # but for ways that end beside another that is as long


def test_farthest_places_are_those_of_the_texels() -> None:
    mesh, uv = plane()
    baked = bake(cells_on(mesh), uv, (64, 64))
    distance, cell = baked.of("edge_distance"), baked.of("cell")
    assert baked.image.farthest.tolist() == [distance[cell == number].max() for number in range(12)]
    assert not sb.bake_cells(cells_on(mesh, 1), uv, size=(8, 8)).farthest.any()


def test_values_are_linear_in_triangles() -> None:
    mesh, uv = plane()
    baked = bake(cells_on(mesh), uv, (64, 32), values=np.column_stack([uv, uv[:, :1] + 2 * uv[:, 1:]]))
    x, y = (baked.columns + 0.5) / 64, (baked.rows + 0.5) / 32
    np.testing.assert_allclose(baked.of("values"), np.column_stack([x, y, x + 2 * y]), atol=1e-6)


def test_many_cells_within_a_face() -> None:
    mesh = sb.Mesh(*meshes.cube())
    cells = cells_on(mesh, 400)
    baked = bake(cells, atlas(mesh.face_count, np.random.default_rng(2)), (400, 300))
    assert len(np.unique(baked.of("cell"))) > 380
    sure = baked.of("edge_distance") > 1e-9
    assert (baked.of("cell") == cells.cells_at(baked.points))[sure].all()


def test_number_of_threads_changes_nothing() -> None:
    mesh = sb.Mesh(*meshes.torus())
    cells, uv = cells_on(mesh, 30), atlas(mesh.face_count, np.random.default_rng(0))
    one, four = (sb.bake_cells(cells, uv, size=(300, 200), threads=threads) for threads in (1, 4))
    for name in ("triangle", "cell", "edge_distance", "local_uv"):
        assert np.array_equal(getattr(one, name), getattr(four, name))


def test_margin_has_the_nearest_texel() -> None:
    mesh = sb.Mesh(*meshes.torus())
    cells, uv = cells_on(mesh, 30), atlas(mesh.face_count, np.random.default_rng(0))
    bare, wide = (sb.bake_cells(cells, uv, size=(90, 110), margin=margin) for margin in (0, 3))
    drawn = bare.triangle >= 0
    assert np.array_equal(drawn, wide.triangle >= 0)
    assert ((bare.cell >= 0) == drawn).all()
    rows, columns = np.nonzero(drawn)
    for y, x in np.argwhere(~drawn):
        squares = (rows - y) ** 2 + (columns - x) ** 2
        nearest = squares == squares.min()
        if squares.min() > 9:
            assert wide.cell[y, x] == -1
            assert not wide.edge_distance[y, x]
        else:
            assert wide.edge_distance[y, x] in bare.edge_distance[rows[nearest], columns[nearest]]
            assert wide.cell[y, x] in bare.cell[rows[nearest], columns[nearest]]


def test_a_tile_shows_its_square() -> None:
    mesh, uv = plane()
    cells = cells_on(mesh)
    here = sb.bake_cells(cells, uv, size=(64, 64))
    there = sb.bake_cells(cells, uv + np.array([3, 2]), size=(64, 64), tile=(3, 2))
    assert np.array_equal(here.cell, there.cell)
    away = sb.bake_cells(cells, uv + np.array([3, 2]), size=(64, 64))
    assert (away.cell == -1).all()
    assert len(away.outside) == mesh.face_count
    halves = sb.bake_cells(cells, uv + np.array([0.5, 0]), size=(64, 64))
    assert np.array_equal(halves.cell[:, 32:], here.cell[:, :32])


def test_faces_are_seen_where_they_are_asked_for() -> None:
    mesh, uv = plane()
    cells = cells_on(mesh)
    some = np.arange(0, mesh.face_count, 2)
    baked = sb.bake_cells(cells, uv.reshape(-1, 3, 2)[some].reshape(-1, 2), some, size=(100, 100), margin=0)
    whole = sb.bake_cells(cells, uv, size=(100, 100), margin=0)
    seen = baked.triangle >= 0
    assert np.array_equal(seen, whole.triangle % 2 == 0)
    assert np.array_equal(some[baked.triangle[seen]], whole.triangle[seen])
    assert np.array_equal(baked.edge_distance[seen], whole.edge_distance[seen])
    mirrored = uv.reshape(-1, 3, 2) * np.array([-1.0, 1.0]) + np.array([2.0, 0.0])
    both = np.concatenate([uv.reshape(-1, 3, 2), mirrored]).reshape(-1, 2) * np.array([0.5, 1.0])
    twice = sb.bake_cells(cells, both, np.tile(np.arange(mesh.face_count), 2), size=(200, 100))
    assert np.array_equal(twice.cell[:, :100], twice.cell[:, :99:-1])


def test_a_cell_without_an_edge_is_endlessly_far_from_it() -> None:
    mesh, uv = plane()
    baked = sb.bake_cells(cells_on(mesh, 1), uv, size=(32, 32))
    assert np.isinf(baked.edge_distance).all()
    assert (baked.cell == 0).all()


def test_what_is_not_wanted_is_not_there() -> None:
    mesh, uv = plane()
    baked = sb.bake_cells(cells_on(mesh), uv, size=(8, 8), edge_distance=False, local_uv=False)
    assert baked.edge_distance is None
    assert baked.local_uv is None
    assert baked.values is None


def test_overlapping_triangles_are_refused_with_their_number() -> None:
    mesh, uv = plane()
    cells, folded = cells_on(mesh), uv.copy()
    folded[:9] = folded[-9:]
    with pytest.raises(sb.InputError, match="uv: 6 triangles overlap others, number 0 is the first"):
        sb.bake_cells(cells, folded, size=(256, 256))
    baked = sb.bake_cells(cells, folded, size=(256, 256), allow_overlaps=True)
    assert baked.overlapping.tolist() == [0, 1, 2, *range(mesh.face_count - 3, mesh.face_count)]
    assert not np.isin(baked.triangle, baked.overlapping[3:]).any()


def test_triangles_without_area_are_told() -> None:
    mesh, uv = plane()
    flat = uv.copy()
    flat[3:6] = flat[3]
    flat[12:15] = np.linspace(flat[12], flat[13], 3)
    baked = sb.bake_cells(cells_on(mesh), flat, size=(64, 64))
    assert baked.without_area.tolist() == [1, 4]
    assert not np.isin(baked.triangle, [1, 4]).any()


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"size": (0, 8)}, "width: wanted 1 to 16384, got 0"),
        ({"size": (8, 16385)}, "height: wanted 1 to 16384, got 16385"),
        ({"size": 8}, "size: wanted two integers"),
        ({"margin": -1}, "margin: wanted 0 to 1024, got -1"),
        ({"faces": [0, 1]}, "uv: wanted 6 places"),
        ({"uv": np.full((384, 2), np.nan)}, "uv: triangle 0 has a place that is not finite"),
        ({"values": np.zeros(7)}, "values: wanted an array"),
        ({"axes": np.zeros((3, 3))}, "axes: wanted one for each of the 12 sites, got 3"),
    ],
)
def test_bad_input(options: dict[str, Any], text: str) -> None:
    mesh, uv = plane()
    uv = options.pop("uv", uv)[: len(uv)]
    with pytest.raises(sb.InputError, match=text):
        sb.bake_cells(cells_on(mesh), uv, **({"size": (8, 8)} | options))


def test_faces_off_the_mesh_are_refused() -> None:
    mesh, uv = plane()
    with pytest.raises(sb.InputError, match="faces: number 1 is 999; wanted 0 to 127"):
        sb.bake_cells(cells_on(mesh), uv[:6], [0, 999], size=(8, 8))
    with pytest.raises(sb.InputError, match="cells: wanted a GeodesicVoronoi"):
        sb.bake_cells(mesh, uv, size=(8, 8))  # type: ignore[arg-type]


@pytest.mark.parametrize("count", [2, 200])
def test_progress_and_cancel(count: int) -> None:
    mesh = sb.Mesh(*meshes.cube() if count == 2 else meshes.torus(60, 30))
    cells, uv = cells_on(mesh, count), atlas(mesh.face_count, np.random.default_rng(0))
    for fraction in (0.02, 0.3, 0.92):
        check_progress_and_cancel(lambda job: sb.bake_cells(cells, uv, size=(2048, 4096), job=job), fraction)

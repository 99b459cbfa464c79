# SPDX-License-Identifier: MIT
"""Plane diagrams on surfaces: maps, what is refused, and every point of the surface against its nearest site."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import saddleback as sb
from saddleback._saddleback import predicates
from tests import meshes
from tests.native import plane_sites
from tests.native.cancelling import check_progress_and_cancel


def hemisphere() -> meshes.Arrays:
    vertices, triangles = meshes.icosphere(4)
    above = (vertices[triangles][:, :, 2] > -1e-9).all(axis=1)
    return meshes.without_unused(vertices, triangles[above])


def tube(length: float) -> meshes.Arrays:
    """A cylinder with a lid: a disk whose border is short."""
    vertices, triangles = meshes.cylinder(24, 40, 1.0, length)
    lid = np.array([(24 * 39 + i, 24 * 39 + (i + 1) % 24, len(vertices)) for i in range(24)], np.int32)
    return np.vstack([vertices, [(0, 0, 1.02 * length)]]), np.vstack([triangles, lid])


DISKS = {"saddle": meshes.saddle(25), "cone": meshes.cone(), "hemisphere": hemisphere()}


def unrolled(columns: int, rows: int, arrays: meshes.Arrays) -> tuple[meshes.Arrays, np.ndarray]:
    """Corner places of a surface whose vertex (i, j) is j * columns + i, closed in one or both directions."""
    _vertices, triangles = arrays
    along = triangles // columns
    around = triangles % columns
    closed = along.max() == rows - 1 and (along.max(axis=1) - along.min(axis=1)).max() > 1
    around = np.where((around == 0) & (around.max(axis=1, keepdims=True) == columns - 1), columns, around)
    if closed:
        along = np.where((along == 0) & (along.max(axis=1, keepdims=True) == rows - 1), rows, along)
    uv = np.stack([around / columns, along / rows], axis=-1).reshape(-1, 2)
    a, b, c = uv[:3]
    is_turned = (b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0])
    return arrays, uv if is_turned else uv * (-1, 1) + (1, 0)


def atlas() -> tuple[meshes.Arrays, np.ndarray]:
    """A cube, each side an island of its own, turned and scaled differently."""
    vertices, triangles = meshes.cube()
    for _ in range(3):
        vertices, triangles = meshes.subdivide(vertices, triangles)
    normals = np.cross(*(vertices[triangles[:, k]] - vertices[triangles[:, 0]] for k in (1, 2)))
    axis = np.abs(normals).argmax(axis=1)
    side = np.sign(normals[np.arange(len(axis)), axis])
    uv = np.empty((len(triangles), 3, 2))
    for k in range(3):
        for number, sign in enumerate((-1, 1)):
            mine = (axis == k) & (side == sign)
            u, v = np.eye(3)[(k + 1) % 3], np.eye(3)[(k + 2) % 3] * sign
            places = np.stack([vertices[triangles[mine]] @ u, vertices[triangles[mine]] @ v], axis=-1)
            turn = 0.3 * (2 * k + number)
            matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]) * (1 - 0.1 * k)
            uv[mine] = places @ matrix.T + (3 * k, 3 * number)
    return (vertices, triangles), uv.reshape(-1, 2) / 9


UV_MAPPED = {
    "cylinder": unrolled(24, 9, meshes.cylinder()),
    "torus": unrolled(14, 36, meshes.torus()),
    "atlas": atlas(),
}


def chart_of(name: str) -> sb.Chart:
    if name in DISKS:
        mesh = sb.Mesh(*DISKS[name])
        return sb.Chart(mesh, sb.harmonic_map(mesh))
    arrays, uv = UV_MAPPED[name]
    return sb.Chart(sb.Mesh(*arrays), uv)


def mesh_of(name: str) -> sb.Mesh:
    return sb.Mesh(*(DISKS[name] if name in DISKS else UV_MAPPED[name][0]))


ALL = [*DISKS, *UV_MAPPED]


def sites_in(name: str, count: int, seed: int = 3) -> np.ndarray:
    return chart_of(name).places(sb.sample(mesh_of(name), count, seed=seed))


def nearest(sites: np.ndarray, places: np.ndarray) -> np.ndarray:
    return np.concatenate(
        [((block[:, None] - sites) ** 2).sum(axis=2).argmin(axis=1) for block in np.array_split(places, 40)]
    )


@pytest.mark.parametrize("name", ALL)
def test_each_point_of_the_surface_has_its_nearest_site(name):
    chart, sites = chart_of(name), sites_in(name, 150)
    lifted = chart.lift(sb.voronoi_2d(sites))
    points = sb.sample(mesh_of(name), 100_000, seed=8)
    cells = lifted.locate(points)
    assert np.count_nonzero(cells != nearest(sites, chart.places(points))) == 0
    assert lifted.areas.sum() == pytest.approx(mesh_of(name).area, rel=1e-12)
    shares = np.bincount(cells, minlength=len(sites)) / len(points)
    np.testing.assert_allclose(lifted.areas / lifted.areas.sum(), shares, atol=2e-3)


@pytest.mark.parametrize("name", ALL)
def test_edges_are_as_far_from_both_sites_and_run_on_the_surface(name):
    mesh, chart, sites = mesh_of(name), chart_of(name), sites_in(name, 60)
    diagram = sb.voronoi_2d(sites)
    lifted = chart.lift(diagram)
    offsets, surface = lifted.edge_offsets, lifted.edge_surface
    places = chart.places(surface)
    np.testing.assert_allclose(lifted.edge_points, surface.positions(mesh), atol=1e-15)
    assert (lifted.edge_cells == diagram.edge_sites[lifted.edge_of]).all() and (np.diff(lifted.edge_of) >= 0).all()
    cells = np.repeat(lifted.edge_cells, np.diff(offsets), axis=0)
    positions = surface.positions(mesh)
    for begin, end in itertools.pairwise(offsets):
        sb.SurfaceCurve(mesh, surface[begin:end])  # refuses what leaves the faces that points share
        steps = np.linalg.norm(np.diff(positions[begin:end], axis=0), axis=1)
        assert steps.max() > 0
    corners = chart.corners.reshape(-1, 3, 2)
    # A place on a seam has another on the other side, so each point is placed by the face that it was found in.
    barycentric = np.asarray(surface.barycentric)
    np.testing.assert_allclose((barycentric[:, :, None] * corners[surface.faces]).sum(axis=1), places)
    to_sites = [np.linalg.norm(places - sites[cells[:, k]], axis=1) for k in (0, 1)]
    np.testing.assert_allclose(to_sites[0], to_sites[1], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("name", ALL)
def test_the_cut_mesh_is_the_surface(name):
    mesh, lifted = mesh_of(name), chart_of(name).lift(sb.voronoi_2d(sites_in(name, 80)))
    split = lifted.split()
    a, b, c = (split.vertices[split.triangles[:, k]] for k in range(3))
    areas = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    np.testing.assert_allclose(np.bincount(split.triangle_cell, areas, minlength=80), lifted.areas, atol=1e-12)
    assert (split.vertex_origin[: mesh.vertex_count] == np.arange(mesh.vertex_count)).all()
    if name in DISKS:  # without seams the cut mesh is a surface again, of the same shape
        used, triangles = np.unique(split.triangles, return_inverse=True)
        whole = sb.Mesh(split.vertices[used], triangles.reshape(-1, 3))
        assert (whole.genus, len(whole.boundary_loops), whole.components.max()) == (0, 1, 0)


def test_a_flat_map_of_a_flat_mesh_gives_the_diagram_itself():
    vertices, triangles = meshes.grid(9, 9, jitter=0.3, seed=5)
    chart = sb.Chart(sb.Mesh(vertices, triangles), vertices[:, :2])
    assert chart.area == pytest.approx(1)
    sites = np.random.default_rng(1).random((70, 2))
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    clipped = sb.voronoi_2d(sites).clip(square)
    lifted = chart.lift(sb.voronoi_2d(sites))
    np.testing.assert_allclose(lifted.areas, clipped.areas, atol=1e-14)
    np.testing.assert_allclose(lifted.centroids, clipped.centroids, atol=1e-12)


@pytest.mark.parametrize("size", [2, 5, 9])
def test_edges_on_mesh_edges_and_through_vertices(size):
    """Sites on a grid: every edge of the diagram runs along mesh edges, and four cells meet in mesh vertices."""
    vertices, triangles = meshes.grid(2 * size + 1, 2 * size + 1)
    ticks = (np.arange(size) + 0.5) / size
    sites = np.stack(np.meshgrid(ticks, ticks), axis=-1).reshape(-1, 2)
    lifted = sb.Chart(sb.Mesh(vertices, triangles), vertices[:, :2]).lift(sb.voronoi_2d(sites))
    points, offsets = lifted.edge_points, lifted.edge_offsets
    lengths = [np.linalg.norm(np.diff(points[a:b], axis=0), axis=1).sum() for a, b in itertools.pairwise(offsets)]
    assert len(lengths) == 2 * size * (size - 1)
    np.testing.assert_allclose(lengths, 1 / size)
    np.testing.assert_allclose(lifted.areas, 1 / size**2)


def hard_sites(kind: str, vertices: np.ndarray, triangles: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Sites whose edges run along mesh edges, through vertices, and meet on them."""
    if kind == "vertices":
        return vertices[rng.permutation(len(vertices))[:40]]
    if kind == "on edges":
        ends, share = triangles[rng.integers(len(triangles), size=40)], rng.choice([0, 0.25, 0.5])
        return (1 - share) * vertices[ends[:, 0]] + share * vertices[ends[:, 1]]
    sites = plane_sites.KINDS[kind](60, rng)
    if kind in ("circle", "regular_polygon"):
        return 0.5 + 0.25 * sites
    return sites / np.abs(sites).max()


def clipped_edge_length(clipped: sb.ClippedCells) -> float:
    """Of all edges in the unit square, each told by both its cells."""
    onward = np.arange(1, len(clipped.points) + 1)
    onward[clipped.loop_offsets[1:] - 1] = clipped.loop_offsets[:-1]
    a, b = clipped.points, clipped.points[onward]
    on_border = [(abs(a[:, k] - side) < 1e-13) & (abs(b[:, k] - side) < 1e-13) for k in (0, 1) for side in (0, 1)]
    return 0.5 * np.linalg.norm(b - a, axis=1)[~np.any(on_border, axis=0)].sum()


@pytest.mark.parametrize(
    "kind", ["vertices", "on edges", "grid", "small_integers", "collinear", "circle", "regular_polygon", "duplicates"]
)
def test_every_edge_is_there_whatever_it_runs_along(kind):
    rng = np.random.default_rng(6)
    for size in (2, 3, 5, 9):
        for jitter in (0.0, 0.2):
            vertices, triangles = meshes.grid(size, size, jitter=jitter, seed=size)
            diagram = sb.voronoi_2d(hard_sites(kind, vertices[:, :2], triangles, rng))
            clipped = diagram.clip([(0, 0), (1, 0), (1, 1), (0, 1)])
            lifted = sb.Chart(sb.Mesh(vertices, triangles), vertices[:, :2]).lift(diagram)
            np.testing.assert_allclose(lifted.areas, clipped.areas, atol=1e-13)
            steps = np.linalg.norm(np.diff(lifted.edge_points, axis=0), axis=1)
            steps[lifted.edge_offsets[1:-1] - 1] = 0
            assert steps.sum() == pytest.approx(clipped_edge_length(clipped), abs=1e-10)


def test_one_site_owns_everything():
    lifted = chart_of("saddle").lift(sb.voronoi_2d([(0.1, 0.2)]))
    assert (lifted.face_cell == 0).all() and len(lifted.edge_of) == 0


def test_many_cells_in_one_face():
    """More sites than vertices: all of them in two triangles."""
    vertices, triangles = meshes.grid(2, 2)
    sites = np.random.default_rng(2).random((2000, 2))
    lifted = sb.Chart(sb.Mesh(vertices, triangles), vertices[:, :2]).lift(sb.voronoi_2d(sites))
    np.testing.assert_allclose(lifted.areas, sb.voronoi_2d(sites).clip([(0, 0), (1, 0), (1, 1), (0, 1)]).areas)


@pytest.mark.parametrize("name", ALL)
def test_locate_and_places_undo_each_other(name):
    mesh, chart = mesh_of(name), chart_of(name)
    points = sb.sample(mesh, 500, seed=2)
    found, inside = chart.locate(chart.places(points))
    assert inside.all()
    np.testing.assert_allclose(found.positions(mesh), points.positions(mesh), atol=1e-9)
    _, inside = chart.locate([(50, 50), *chart.places(points)[:2]])
    assert inside.tolist() == [False, True, True]


def test_any_number_of_threads_gives_the_same():
    chart, diagram = chart_of("torus"), sb.voronoi_2d(sites_in("torus", 200))
    one, two = (chart.lift(diagram, threads=threads) for threads in (1, 2))
    for name in ("areas", "centroids", "edge_points", "edge_offsets", "edge_of", "face_cell"):
        assert getattr(one, name).tobytes() == getattr(two, name).tobytes()
    assert one.split().triangles.tobytes() == two.split().triangles.tobytes()


# --- the harmonic map -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("arrays", [*DISKS.values(), meshes.needles(), tube(4)], ids=[*DISKS, "needles", "tube"])
def test_no_face_flips(arrays):
    mesh = sb.Mesh(*arrays)
    places = sb.harmonic_map(mesh)
    assert (predicates.orient_2d(*(places[mesh.triangles[:, k]] for k in range(3))) == 1).all()
    border = np.array(mesh.boundary_loops[0])
    np.testing.assert_allclose(np.linalg.norm(places[border], axis=1), 1)
    sb.Chart(mesh, places)  # and none overlaps another


def test_a_flat_disk_keeps_its_shape():
    """Harmonic functions that are linear on the border are linear inside, up to the weights that were raised."""
    turns = [2 * np.pi * (np.arange(6 * k) / (6 * k) + 0.01 * k) for k in range(1, 9)]
    rings = [(k / 8) * (np.cos(turn) + 1j * np.sin(turn)) for k, turn in enumerate(turns, 1)]
    flat = np.concatenate([[0], *rings])
    plane = np.column_stack([flat.real, flat.imag])
    triangles = sb.voronoi_2d(plane).delaunay
    mesh = sb.Mesh(np.column_stack([plane, np.zeros(len(plane))]), triangles)
    places = sb.harmonic_map(mesh) @ (1, 1j)
    np.testing.assert_allclose(places * flat[-1] / places[-1], flat, atol=1e-3)


@pytest.mark.parametrize(
    ("arrays", "text"),
    [
        (meshes.icosphere(1), "got 1 part, 0 borders and 0 handles"),
        (meshes.cylinder(), "got 1 part, 2 borders and 0 handles"),
        (meshes.merge(meshes.grid(3, 3), meshes.grid(3, 3)), "got 2 parts, 2 borders and 0 handles"),
        (tube(400), r"face \d+ vanishes in the disk"),
    ],
    ids=["closed", "two borders", "two parts", "too deep"],
)
def test_what_is_no_disk_is_refused(arrays, text):
    with pytest.raises(sb.InputError, match=text):
        sb.harmonic_map(sb.Mesh(*arrays))


# --- what is refused --------------------------------------------------------------------------------------------------


def square_and_places():
    vertices, triangles = meshes.grid(5, 5)
    return sb.Mesh(vertices, triangles), vertices[:, :2].copy()


def test_a_flipped_face_is_named():
    mesh, uv = square_and_places()
    with pytest.raises(sb.InputError, match="face 0 is flipped"):
        sb.Chart(mesh, uv * (-1, 1))
    uv[12] = (0.9, 0.5)
    with pytest.raises(sb.InputError, match=r"face \d+ is flipped"):
        sb.Chart(mesh, uv)
    uv[12] = uv[13]
    with pytest.raises(sb.InputError, match=r"face \d+ has no area"):
        sb.Chart(mesh, uv)


def test_overlapping_islands_are_named():
    vertices, triangles = meshes.cube()
    corners = np.tile([(0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)], (6, 1)).astype(float)
    with pytest.raises(sb.InputError, match="faces 0 and 2 overlap"):
        sb.Chart(sb.Mesh(vertices, triangles), corners)
    corners[18:] += (2, 0)
    corners[6:18] += (5, 0)
    corners[12:18] += (0.999, 0)
    with pytest.raises(sb.InputError, match=r"faces \d+ and \d+ overlap"):
        sb.Chart(sb.Mesh(vertices, triangles), corners)


def test_islands_that_touch_up_to_float32_do_not_overlap():
    vertices, triangles = meshes.cube()
    corners = np.tile([(0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)], (6, 1)).astype(float)
    corners += np.repeat([(k % 3, k // 3) for k in range(6)], 6, axis=0)
    places = (corners / 3 + 0.1).astype(np.float32).astype(np.float64)
    places[::6] += 1e-8  # rounding that differs from side to side
    sb.Chart(sb.Mesh(vertices, triangles), places)
    with pytest.raises(sb.InputError, match="overlap"):
        sb.Chart(sb.Mesh(vertices, triangles), corners / 3 * np.where(np.arange(36) < 6, 1.001, 1)[:, None] + 0.1)


def test_wrong_numbers_of_places():
    mesh, uv = square_and_places()
    with pytest.raises(sb.InputError, match="25 vertices or the 96 corners of faces, got 24"):
        sb.Chart(mesh, uv[:-1])
    uv[3, 1] = np.nan
    with pytest.raises(sb.InputError, match=r"corner \d of face \d+"):
        sb.Chart(mesh, uv)
    with pytest.raises(sb.InputError, match="diagram"):
        chart_of("saddle").lift(3)
    with pytest.raises(sb.InputError, match="no sites"):
        chart_of("saddle").lift(sb.voronoi_2d(np.zeros((0, 2))))


def test_lifting_can_be_cancelled():
    vertices, triangles = meshes.grid(400, 400)
    chart = sb.Chart(sb.Mesh(vertices, triangles), vertices[:, :2])
    diagram = sb.voronoi_2d(np.random.default_rng(0).random((200_000, 2)))
    check_progress_and_cancel(lambda job: chart.lift(diagram, job=job), 0.3)


def test_maps_can_be_cancelled():
    vertices, triangles = meshes.grid(450, 450, jitter=0.2)
    mesh = sb.Mesh(vertices, triangles)
    check_progress_and_cancel(lambda job: sb.harmonic_map(mesh, job=job), 0.3)
